#include "navmesh/build/scene_sieve.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <locale>

namespace forewalk::navmesh {

namespace {

/// from_chars takes no plus sign.
std::string_view withoutPlus(std::string_view word) {
  const bool plus = word.size() > 1 && word[0] == '+' && word[1] != '-';
  return word.substr(plus ? 1 : 0);
}

}  // namespace

bool isSpace(char c) { return c == ' ' || (c >= '\t' && c <= '\r'); }

void splitWords(std::string_view line, std::vector<std::string_view>& words) {
  words.clear();
  for (std::size_t i = 0; i < line.size();) {
    while (i < line.size() && isSpace(line[i])) ++i;
    const std::size_t start = i;
    while (i < line.size() && !isSpace(line[i])) ++i;
    if (i > start) words.push_back(line.substr(start, i - start));
  }
}

bool isFinite(std::string_view word) {
  word = withoutPlus(word);
  double value = 0.0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (end != word.data() + word.size()) return false;
  if (error == std::errc::result_out_of_range) {
    // Out of a double's range: too small is as good as 0.
    return word.find("e-") != word.npos || word.find("E-") != word.npos;
  }
  return error == std::errc{} && std::abs(value) <= std::numeric_limits<float>::max();
}

bool toInteger(std::string_view word, std::int64_t& value) {
  word = withoutPlus(word);
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  return error == std::errc{} && end == word.data() + word.size();
}

tl::unexpected<Error> badNumber(const std::string& where, std::uint64_t vertex, int axis,
                                std::string_view value) {
  return damaged(
      fmt::format("{}: vertex {} has {} {}, a finite number is needed. Export it again or "
                  "remove the vertex.",
                  where, vertex, "xyz"[axis], value));
}

tl::unexpected<Error> badIndex(const std::string& where, std::uint64_t face, std::string_view value,
                               std::uint64_t vertices) {
  return damaged(
      fmt::format("{}: face {} names vertex {}, the file has {}. Export it again or remove "
                  "the face.",
                  where, face, value, vertices));
}

tl::unexpected<Error> badCorners(const std::string& where, std::uint64_t face,
                                 std::int64_t corners) {
  if (corners > kFaceCornersMost) {
    return refuse(ErrorCode::kTooLarge,
                  fmt::format("{}: face {} has {} corners, at most {} are read. Triangulate it.",
                              where, face, corners, kFaceCornersMost));
  }
  return damaged(
      fmt::format("{}: face {} has {} corners, at least 3 are needed. Export it again or "
                  "remove the face.",
                  where, face, corners));
}

tl::unexpected<Error> endsEarly(const std::string& where, std::string_view element,
                                std::uint64_t had, std::uint64_t count) {
  return damaged(fmt::format("{}: ends early, after {} of {} {}. Copy or export it again.", where,
                             had, count, element));
}

char localePoint() { return std::use_facet<std::numpunct<char>>(std::locale()).decimal_point(); }

}  // namespace forewalk::navmesh
