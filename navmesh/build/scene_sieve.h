// What mesh files pass before OpenMesh reads them, which believes what it reads.
//
// OpenMesh 9.0 skips lines it cannot parse, takes any index, follows OBJ's mtllib to other files,
// loses its place at PLY lists it does not know, reads numbers in the program's locale and prints
// to stderr. So every file passes a sieve first: it checks each statement, names what is wrong by
// line or element, and hands on only what a scene needs (positions and faces) in the words of the
// file's own format.
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <tl/expected.hpp>
#include <vector>

#include "navmesh/build/scene_readers.h"
#include "navmesh/file_text.h"

namespace forewalk::navmesh {

/// What passed, for OpenMesh.
struct Sieved {
  std::string text;
  bool binary = false;         ///< binary STL, which OpenMesh has to be told
  std::uint64_t vertices = 0;  ///< 0 for STL, which has none of its own
  std::uint64_t faces = 0;
};

/// A sieve a format. `name` stands for the file in messages. Each fails where the file is damaged,
/// ends early, or says what we do not read: kDataDamaged, kFormatUnknown, kFormatUnsupported,
/// kSceneEmpty, kTooLarge. Costs O(size).
[[nodiscard]] tl::expected<Sieved, Error> sieveObj(std::string_view text, const std::string& name);
[[nodiscard]] tl::expected<Sieved, Error> sieveOff(std::string_view text, const std::string& name);
[[nodiscard]] tl::expected<Sieved, Error> sievePly(std::string_view bytes, const std::string& name);
[[nodiscard]] tl::expected<Sieved, Error> sieveStl(std::string_view bytes, const std::string& name);

// ---- What the sieves share.

inline constexpr std::uint64_t kElementsMost =
    std::numeric_limits<std::int32_t>::max();           // OpenMesh handles
inline constexpr std::int64_t kFaceCornersMost = 4096;  // ear clipping is quadratic in them

bool isSpace(char c);

/// The words of one line.
void splitWords(std::string_view line, std::vector<std::string_view>& words);

/// Whether a word is a number that a float holds. Never looks at the locale.
bool isFinite(std::string_view word);

bool toInteger(std::string_view word, std::int64_t& value);

tl::unexpected<Error> badNumber(const std::string& where, std::uint64_t vertex, int axis,
                                std::string_view value);
tl::unexpected<Error> badIndex(const std::string& where, std::uint64_t face, std::string_view value,
                               std::uint64_t vertices);
tl::unexpected<Error> badCorners(const std::string& where, std::uint64_t face,
                                 std::int64_t corners);
tl::unexpected<Error> endsEarly(const std::string& where, std::string_view element,
                                std::uint64_t had, std::uint64_t count);

inline bool isFaceSize(std::int64_t corners) { return corners >= 3 && corners <= kFaceCornersMost; }

/// The decimal point of those readers of OpenMesh (OBJ, text STL) that read numbers in the
/// program's locale.
char localePoint();

/// Appends "x y z\n", the first three of `words`, to `text`; `point` stands for the decimal point.
/// `where()` is the place in the file, asked for only where one of them is no finite number.
template <typename Where>
tl::expected<void, Error> passPosition(std::span<const std::string_view> words, const Where& where,
                                       std::uint64_t vertex, char point, std::string& text) {
  for (int axis = 0; axis < 3; ++axis) {
    const auto at = static_cast<std::size_t>(axis);
    if (at >= words.size()) return badNumber(where(), vertex, axis, "missing");
    if (!isFinite(words[at])) return badNumber(where(), vertex, axis, inQuotes(words[at]));
    for (const char c : words[at]) text += c == '.' ? point : c;
    text += axis < 2 ? ' ' : '\n';
  }
  return {};
}

}  // namespace forewalk::navmesh
