// OBJ: `v` and `f` pass, everything else is about looks.
#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "navmesh/build/scene_sieve.h"

namespace forewalk::navmesh {
namespace {

class ObjSieve {
 public:
  ObjSieve(std::string_view text, const std::string& name) : name_(name), lines_(text) {
    out_.text.reserve(text.size() / 2);
  }

  tl::expected<Sieved, Error> run() {
    while (nextStatement()) {
      tl::expected<void, Error> passed;
      if (words_[0] == "v") passed = passVertex();
      if (words_[0] == "f") passed = passFace();
      if (!passed) return tl::unexpected(passed.error());
    }
    if (highest_.vertex > static_cast<std::int64_t>(out_.vertices)) {
      return badIndex(fmt::format("{}:{}", name_, highest_.line), highest_.face,
                      fmt::format("{}", highest_.vertex), out_.vertices);
    }
    return std::move(out_);
  }

 private:
  /// The words of the next statement that has any; it may run over several lines.
  bool nextStatement() {
    std::string_view line;
    while (lines_.next(line)) {
      line_ = lines_.number();
      if (line.ends_with('\\')) line = joined(line);
      splitWords(line.substr(0, line.find('#')), words_);
      if (!words_.empty()) return true;
    }
    return false;
  }

  std::string_view joined(std::string_view line) {
    joined_.assign(line.substr(0, line.size() - 1));
    while (lines_.next(line)) {
      const bool more = line.ends_with('\\');
      joined_ += ' ';
      joined_ += more ? line.substr(0, line.size() - 1) : line;
      if (!more) break;
    }
    return joined_;
  }

  tl::expected<void, Error> passVertex() {
    out_.text += "v ";
    ++out_.vertices;
    return passPosition(
        std::span(words_).subspan(1), [&] { return where(); }, out_.vertices, point_, out_.text);
  }

  tl::expected<void, Error> passFace() {
    const std::uint64_t face = ++out_.faces;
    const auto corners = static_cast<std::int64_t>(words_.size()) - 1;
    if (!isFaceSize(corners)) return badCorners(where(), face, corners);
    if (auto read = readRing(); !read) return read;
    if (ring_.size() < 3) return {};  // a line or a point: nothing to stand on
    // OpenMesh drops a vertex that a ring passes twice, wherever that is.
    sorted_ = ring_;
    std::sort(sorted_.begin(), sorted_.end());
    const auto twice = std::adjacent_find(sorted_.begin(), sorted_.end());
    if (twice != sorted_.end()) {
      return refuse(ErrorCode::kFormatUnsupported,
                    fmt::format("{}: face {} passes vertex {} twice. Triangulate it in the program "
                                "that made it.",
                                where(), face, *twice));
    }
    out_.text += 'f';
    for (const std::int64_t vertex : ring_)
      fmt::format_to(std::back_inserter(out_.text), " {}", vertex);
    out_.text += '\n';
    return {};
  }

  /// The face's vertices from 1, equal neighbours once.
  tl::expected<void, Error> readRing() {
    ring_.clear();
    const auto soFar = static_cast<std::int64_t>(out_.vertices);
    for (std::size_t i = 1; i < words_.size(); ++i) {
      const std::string_view word = words_[i].substr(0, words_[i].find('/'));
      std::int64_t vertex = 0;
      const bool sound = toInteger(word, vertex) && vertex != 0 && vertex >= -soFar &&
                         vertex <= static_cast<std::int64_t>(kElementsMost);
      if (!sound) return badIndex(where(), out_.faces, inQuotes(words_[i]), out_.vertices);
      if (vertex < 0) vertex += soFar + 1;  // -1: the last so far
      if (vertex > highest_.vertex) highest_ = {vertex, out_.faces, line_};
      if (ring_.empty() || ring_.back() != vertex) ring_.push_back(vertex);
    }
    while (ring_.size() > 1 && ring_.front() == ring_.back()) ring_.pop_back();
    return {};
  }

  std::string where() const { return fmt::format("{}:{}", name_, line_); }

  const std::string& name_;
  Lines lines_;
  Sieved out_;
  const char point_ = localePoint();
  std::size_t line_ = 0;  ///< where the statement begins
  std::string joined_;
  std::vector<std::string_view> words_;
  std::vector<std::int64_t> ring_, sorted_;
  /// OBJ may name a vertex before it gives it, so the highest index is judged at the end.
  struct {
    std::int64_t vertex = 0;
    std::uint64_t face = 0;
    std::size_t line = 0;
  } highest_;
};

}  // namespace

tl::expected<Sieved, Error> sieveObj(std::string_view text, const std::string& name) {
  return ObjSieve(text, name).run();
}

}  // namespace forewalk::navmesh
