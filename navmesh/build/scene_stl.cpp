// STL: corners of triangles, as text or as 50 bytes each.
#include <fmt/format.h>

#include <bit>
#include <cmath>

#include "navmesh/build/little_endian.h"
#include "navmesh/build/scene_sieve.h"

namespace forewalk::navmesh {
namespace {

constexpr std::size_t kHeader = 84;
constexpr std::size_t kCount = 80;  ///< where the number of triangles stands in it
constexpr std::size_t kTriangle = 50;
constexpr std::size_t kNormal = 12;

bool isBinary(std::string_view bytes) {
  if (bytes.size() >= kHeader &&
      bytes.size() == kHeader + kTriangle * std::uint64_t{loadLittle(bytes, kCount)}) {
    return true;
  }
  // The first word decides nothing: binary headers say "solid" too. But text has no zero bytes, and
  // the triangle count of a binary file that was cut or padded has some.
  return bytes.substr(0, 512).find('\0') != bytes.npos;
}

tl::expected<Sieved, Error> sieveBinary(std::string_view bytes, const std::string& name) {
  if (bytes.size() < kHeader) {
    return damaged(
        fmt::format("{}: ends early, {} bytes, a binary STL has {} before its first triangle. "
                    "Copy or export it again.",
                    name, bytes.size(), kHeader));
  }
  const std::uint64_t triangles = loadLittle(bytes, kCount);
  const std::uint64_t held = (bytes.size() - kHeader) / kTriangle;
  if (held < triangles) return endsEarly(name, "triangles", held, triangles);
  if (3 * triangles > kElementsMost) {
    return refuse(ErrorCode::kTooLarge,
                  fmt::format("{}: {} triangles, at most {} are read. Split it.", name, triangles,
                              kElementsMost / 3));
  }
  for (std::size_t i = 0; i < triangles; ++i) {
    for (std::size_t k = 0; k < 9; ++k) {
      const auto value = std::bit_cast<float>(
          loadLittle(bytes, kHeader + i * kTriangle + kNormal + sizeof(float) * k));
      if (!std::isfinite(value)) {
        return badNumber(fmt::format("{}: triangle {}", name, i), k / 3, static_cast<int>(k % 3),
                         fmt::format("{}", value));
      }
    }
  }
  Sieved out;
  out.text.assign(bytes.substr(0, kHeader + static_cast<std::size_t>(triangles) * kTriangle));
  out.binary = true;
  out.faces = triangles;
  return out;
}

std::string lower(std::string_view word) {
  std::string result(word);
  // Not std::tolower: it follows the locale.
  for (char& c : result) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  return result;
}

class TextSieve {
 public:
  TextSieve(std::string_view text, const std::string& name) : name_(name), lines_(text) {}

  tl::expected<Sieved, Error> run() {
    std::string_view line;
    while (lines_.next(line)) {
      splitWords(line, words_);
      if (words_.empty()) continue;
      const auto fits = passStatement(lower(words_[0]));
      if (!fits) return tl::unexpected(fits.error());
      if (!*fits) {
        return damaged(
            fmt::format("{}: {} does not belong here, after {} whole triangles. Export it "
                        "again.",
                        where(), inQuotes(line), out_.faces));
      }
    }
    if (open_ != Open::kNothing) {
      return damaged(
          fmt::format("{}: ends early, after {} triangles and without endsolid. Copy or "
                      "export it again.",
                      where(), out_.faces));
    }
    return std::move(out_);
  }

 private:
  enum class Open { kNothing, kSolid, kFacet, kLoop };

  /// Whether the statement may stand where it does.
  tl::expected<bool, Error> passStatement(std::string_view word) {
    if (word == "solid") return step(Open::kNothing, Open::kSolid);
    if (word == "facet") return step(Open::kSolid, Open::kFacet);
    if (word == "outer") {
      corner_ = 0;
      out_.text += "outer loop\n";
      return step(Open::kFacet, Open::kLoop);
    }
    if (word == "vertex") {
      if (open_ != Open::kLoop || corner_ == 3) return false;
      return passVertex().map([] { return true; });
    }
    if (word == "endloop") {
      if (!step(Open::kLoop, Open::kFacet) || corner_ != 3) return false;
      ++out_.faces;
      return true;
    }
    if (word == "endfacet") return step(Open::kFacet, Open::kSolid);
    if (word == "endsolid") return step(Open::kSolid, Open::kNothing);
    return false;
  }

  bool step(Open from, Open to) {
    const bool fits = open_ == from;
    open_ = to;
    return fits;
  }

  tl::expected<void, Error> passVertex() {
    out_.text += "vertex ";
    const auto triangle = [&] { return fmt::format("{}: triangle {}", where(), out_.faces); };
    return passPosition(std::span(words_).subspan(1), triangle, corner_++, point_, out_.text);
  }

  std::string where() const { return fmt::format("{}:{}", name_, lines_.number()); }

  const std::string& name_;
  Lines lines_;
  Sieved out_;
  const char point_ = localePoint();
  std::vector<std::string_view> words_;
  Open open_ = Open::kNothing;
  std::uint64_t corner_ = 0;  ///< of the triangle that is open
};

}  // namespace

tl::expected<Sieved, Error> sieveStl(std::string_view bytes, const std::string& name) {
  return isBinary(bytes) ? sieveBinary(bytes, name) : TextSieve(bytes, name).run();
}

}  // namespace forewalk::navmesh
