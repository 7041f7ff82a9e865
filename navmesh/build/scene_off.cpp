// OFF: a line a vertex, a line a face; colours, normals and comments stay behind.
#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "navmesh/build/scene_sieve.h"

namespace forewalk::navmesh {
namespace {

/// Texture coordinates, colours and normals follow the position; 4 and n would change it.
constexpr std::string_view kPrefixes[] = {"", "ST", "C", "N", "CN", "STC", "STN", "STCN"};

class OffSieve {
 public:
  OffSieve(std::string_view text, const std::string& name) : name_(name), lines_(text) {}

  tl::expected<Sieved, Error> run() {
    if (auto read = readHeader(); !read) return tl::unexpected(read.error());
    if (auto read = readCounts(); !read) return tl::unexpected(read.error());
    out_.text = fmt::format("OFF\n{} {} 0\n", out_.vertices, out_.faces);
    for (std::uint64_t i = 0; i < out_.vertices; ++i) {
      if (!nextWords()) return endsEarly(where(), "vertices", i, out_.vertices);
      auto passed = passPosition(
          words_, [&] { return where(); }, i, '.', out_.text);
      if (!passed) return tl::unexpected(passed.error());
    }
    for (std::uint64_t i = 0; i < out_.faces; ++i) {
      if (!nextWords()) return endsEarly(where(), "faces", i, out_.faces);
      if (auto passed = passFace(i); !passed) return tl::unexpected(passed.error());
    }
    return std::move(out_);
  }

 private:
  /// The words of the next line that has any; none at the end.
  bool nextWords() {
    while (lines_.next(line_)) {
      splitWords(line_.substr(0, line_.find('#')), words_);
      if (!words_.empty()) return true;
    }
    words_.clear();
    return false;
  }

  tl::expected<void, Error> readHeader() {
    constexpr std::string_view kOff = "OFF";
    if (!nextWords() || !words_[0].ends_with(kOff)) {
      return refuse(
          ErrorCode::kFormatUnknown,
          fmt::format("{}: begins with {}, an OFF file begins with OFF. Check its ending.", where(),
                      inQuotes(words_.empty() ? std::string_view{} : words_[0])));
    }
    const std::string_view prefix = words_[0].substr(0, words_[0].size() - kOff.size());
    const bool known =
        std::find(std::begin(kPrefixes), std::end(kPrefixes), prefix) != std::end(kPrefixes);
    if (!known || (words_.size() > 1 && words_[1] == "BINARY")) {
      return refuse(ErrorCode::kFormatUnsupported,
                    fmt::format("{}: header {} is not read. Export three-dimensional OFF as text.",
                                where(), inQuotes(line_)));
    }
    words_.erase(words_.begin());
    return {};
  }

  /// They may stand on the header's line.
  tl::expected<void, Error> readCounts() {
    if (words_.empty()) nextWords();
    for (std::size_t i = 0; i < 2; ++i) {
      std::int64_t count = 0;
      if (i >= words_.size() || !toInteger(words_[i], count) || count < 0 ||
          count > static_cast<std::int64_t>(kElementsMost)) {
        return damaged(
            fmt::format("{}: {} count is {}, a number from 0 to {} is needed. Export it again.",
                        where(), i == 0 ? "vertex" : "face",
                        i < words_.size() ? inQuotes(words_[i]) : "missing", kElementsMost));
      }
      (i == 0 ? out_.vertices : out_.faces) = static_cast<std::uint64_t>(count);
    }
    return {};
  }

  tl::expected<void, Error> passFace(std::uint64_t face) {
    std::int64_t corners = 0;
    if (!toInteger(words_[0], corners)) corners = 0;
    if (!isFaceSize(corners)) return badCorners(where(), face, corners);
    const auto last = static_cast<std::size_t>(corners);
    if (words_.size() <= last) {
      return damaged(
          fmt::format("{}: face {} has {} corners, the line names {}. Export it again or "
                      "remove the face.",
                      where(), face, corners, words_.size() - 1));
    }
    fmt::format_to(std::back_inserter(out_.text), "{}", corners);
    for (std::size_t c = 1; c <= last; ++c) {
      std::int64_t vertex = 0;
      if (!toInteger(words_[c], vertex) || vertex < 0 ||
          static_cast<std::uint64_t>(vertex) >= out_.vertices) {
        return badIndex(where(), face, inQuotes(words_[c]), out_.vertices);
      }
      fmt::format_to(std::back_inserter(out_.text), " {}", vertex);
    }
    out_.text += '\n';
    return {};
  }

  std::string where() const { return fmt::format("{}:{}", name_, lines_.number()); }

  const std::string& name_;
  Lines lines_;
  Sieved out_;
  std::string_view line_;
  std::vector<std::string_view> words_;
};

}  // namespace

tl::expected<Sieved, Error> sieveOff(std::string_view text, const std::string& name) {
  return OffSieve(text, name).run();
}

}  // namespace forewalk::navmesh
