// OBJ, OFF, PLY and STL through OpenMesh's readers, which believe what they read.
//
// OpenMesh 9.0 skips lines it cannot parse, takes any index, follows OBJ's mtllib to other files,
// loses its place at PLY lists it does not know, writes to stderr, reads numbers in the program's
// locale, and keeps state in its readers. So every file passes a sieve first: it checks each
// statement, names what is wrong by line or element, and hands on, as it stands, only what a scene
// needs (positions and faces). OpenMesh then meets nothing that it gets wrong.
#include <fmt/format.h>

#include <OpenMesh/Core/IO/IOManager.hh>
#include <OpenMesh/Core/IO/importer/BaseImporter.hh>
#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <locale>
#include <mutex>
#include <sstream>
#include <vector>

#include "navmesh/build/scene_readers.h"

namespace forewalk::navmesh {
namespace {

constexpr std::uint64_t kElementsMost =
    std::numeric_limits<std::int32_t>::max();  // OpenMesh handles
constexpr std::uint64_t kCornersMost = 4096;   // ear clipping is quadratic in the corners of a face

// ---------------------------------------------------------------------------------------------------
// What OpenMesh hands over: vertices and faces as they come, without half-edges, so that no face is
// refused for sharing an edge with two others.

class Soup final : public OpenMesh::IO::BaseImporter {
 public:
  using Vec2f = OpenMesh::Vec2f;
  using Vec3f = OpenMesh::Vec3f;
  using Vec4f = OpenMesh::Vec4f;
  using Vec3d = OpenMesh::Vec3d;
  using Vec3uc = OpenMesh::Vec3uc;
  using Vec4uc = OpenMesh::Vec4uc;
  using VertexHandle = OpenMesh::VertexHandle;
  using HalfedgeHandle = OpenMesh::HalfedgeHandle;
  using EdgeHandle = OpenMesh::EdgeHandle;
  using FaceHandle = OpenMesh::FaceHandle;
  using StatusInfo = OpenMesh::Attributes::StatusInfo;

  std::vector<glm::vec3> vertices;
  std::vector<std::size_t> faceStart{0};
  std::vector<std::uint32_t> corners;

  VertexHandle add_vertex(const Vec3f& p) override {
    vertices.emplace_back(p[0], p[1], p[2]);
    return VertexHandle(static_cast<int>(vertices.size() - 1));
  }
  VertexHandle add_vertex(const Vec3d& p) override { return add_vertex(Vec3f(p)); }
  VertexHandle add_vertex() override { return add_vertex(Vec3f(0.0f, 0.0f, 0.0f)); }
  void set_point(VertexHandle v, const Vec3f& p) override {
    vertices[static_cast<std::size_t>(v.idx())] = {p[0], p[1], p[2]};
  }
  FaceHandle add_face(const VHandles& ring) override {
    for (const VertexHandle v : ring) corners.push_back(static_cast<std::uint32_t>(v.idx()));
    faceStart.push_back(corners.size());
    return FaceHandle(static_cast<int>(faceStart.size() - 2));
  }
  std::size_t n_vertices() const override { return vertices.size(); }
  std::size_t n_faces() const override { return faceStart.size() - 1; }
  std::size_t n_edges() const override { return 0; }

  // The rest of the interface is about half-edges, normals, colours and textures, which the sieve
  // never lets through.
  HalfedgeHandle add_edge(VertexHandle, VertexHandle) override { return HalfedgeHandle(); }
  FaceHandle add_face(HalfedgeHandle) override { return FaceHandle(); }
  void add_face_texcoords(FaceHandle, VertexHandle, const std::vector<Vec2f>&) override {}
  void add_face_texcoords(FaceHandle, VertexHandle, const std::vector<Vec3f>&) override {}
  void set_face_texindex(FaceHandle, int) override {}
  void set_halfedge(VertexHandle, HalfedgeHandle) override {}
  void set_normal(VertexHandle, const Vec3f&) override {}
  void set_normal(VertexHandle, const Vec3d&) override {}
  void set_color(VertexHandle, const Vec3uc&) override {}
  void set_color(VertexHandle, const Vec4uc&) override {}
  void set_color(VertexHandle, const Vec3f&) override {}
  void set_color(VertexHandle, const Vec4f&) override {}
  void set_texcoord(VertexHandle, const Vec2f&) override {}
  void set_status(VertexHandle, const StatusInfo&) override {}
  void set_next(HalfedgeHandle, HalfedgeHandle) override {}
  void set_face(HalfedgeHandle, FaceHandle) override {}
  void request_face_texcoords2D() override {}
  void set_texcoord(HalfedgeHandle, const Vec2f&) override {}
  void set_texcoord(VertexHandle, const Vec3f&) override {}
  void set_texcoord(HalfedgeHandle, const Vec3f&) override {}
  void set_status(HalfedgeHandle, const StatusInfo&) override {}
  void set_color(EdgeHandle, const Vec3uc&) override {}
  void set_color(EdgeHandle, const Vec4uc&) override {}
  void set_color(EdgeHandle, const Vec3f&) override {}
  void set_color(EdgeHandle, const Vec4f&) override {}
  void set_status(EdgeHandle, const StatusInfo&) override {}
  void set_normal(FaceHandle, const Vec3f&) override {}
  void set_normal(FaceHandle, const Vec3d&) override {}
  void set_color(FaceHandle, const Vec3uc&) override {}
  void set_color(FaceHandle, const Vec4uc&) override {}
  void set_color(FaceHandle, const Vec3f&) override {}
  void set_color(FaceHandle, const Vec4f&) override {}
  void set_status(FaceHandle, const StatusInfo&) override {}
  void add_texture_information(int, std::string) override {}
};

// ---------------------------------------------------------------------------------------------------
// Faces of more than three corners.

double cross(glm::dvec2 a, glm::dvec2 b) { return a.x * b.y - a.y * b.x; }

bool inTriangle(glm::dvec2 p, glm::dvec2 a, glm::dvec2 b, glm::dvec2 c) {
  return cross(b - a, p - a) >= 0.0 && cross(c - b, p - b) >= 0.0 && cross(a - c, p - c) >= 0.0;
}

/// The ring seen along its normal (Newell's, which any planar or nearly planar ring has), counter-
/// clockwise. Empty where the ring has no area.
std::vector<glm::dvec2> flattened(std::span<const std::uint32_t> ring,
                                  const std::vector<glm::vec3>& vertices) {
  const glm::dvec3 origin(vertices[ring[0]]);
  glm::dvec3 normal(0.0);
  for (std::size_t i = 0; i < ring.size(); ++i) {
    normal += glm::cross(glm::dvec3(vertices[ring[i]]) - origin,
                         glm::dvec3(vertices[ring[(i + 1) % ring.size()]]) - origin);
  }
  // Dropping the normal's largest coordinate keeps the ring's shape up to a stretch, and stays
  // finite.
  const glm::dvec3 size = glm::abs(normal);
  const int drop = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  if (!(size[drop] > 0.0) || !std::isfinite(size[drop])) return {};
  const int u = (drop + 1) % 3;
  const int v = (drop + 2) % 3;
  std::vector<glm::dvec2> flat;
  flat.reserve(ring.size());
  for (const std::uint32_t corner : ring) {
    const glm::dvec3 p = glm::dvec3(vertices[corner]) - origin;
    flat.push_back(normal[drop] > 0.0 ? glm::dvec2(p[u], p[v]) : glm::dvec2(p[v], p[u]));
  }
  return flat;
}

/// Appends `ring` as triangles of the same winding: a fan where it is convex, by cutting ears where
/// it is not. A ring that crosses itself has no right answer; it becomes a fan of what is left.
void triangulate(std::span<const std::uint32_t> ring, const std::vector<glm::vec3>& vertices,
                 std::vector<glm::uvec3>& triangles) {
  if (ring.size() == 3) {
    triangles.emplace_back(ring[0], ring[1], ring[2]);
    return;
  }
  const std::vector<glm::dvec2> flat = flattened(ring, vertices);
  std::vector<std::size_t> left(ring.size());
  for (std::size_t i = 0; i < left.size(); ++i) left[i] = i;
  const auto turn = [&](std::size_t at) {
    const std::size_t n = left.size();
    const glm::dvec2 here = flat[left[at]];
    return cross(here - flat[left[(at + n - 1) % n]], flat[left[(at + 1) % n]] - here);
  };
  const auto convex = [&] {
    for (std::size_t at = 0; at < left.size(); ++at) {
      if (turn(at) < 0.0) return false;
    }
    return true;
  };
  const auto isEar = [&](std::size_t at) {
    const std::size_t n = left.size();
    if (turn(at) <= 0.0) return false;
    const glm::dvec2 a = flat[left[(at + n - 1) % n]];
    const glm::dvec2 b = flat[left[at]];
    const glm::dvec2 c = flat[left[(at + 1) % n]];
    for (std::size_t other = 2; other < n - 1; ++other) {
      const glm::dvec2 p = flat[left[(at + other) % n]];
      // Keyhole rings pass a corner twice: that one does not block its own ear.
      if (p != a && p != b && p != c && inTriangle(p, a, b, c)) return false;
    }
    return true;
  };
  if (!flat.empty() && !convex()) {
    std::size_t at = 0;
    std::size_t refused = 0;
    while (left.size() > 3 && refused < left.size()) {
      const std::size_t n = left.size();
      at %= n;
      if (isEar(at)) {
        triangles.emplace_back(ring[left[(at + n - 1) % n]], ring[left[at]],
                               ring[left[(at + 1) % n]]);
        left.erase(left.begin() + static_cast<std::ptrdiff_t>(at));
        refused = 0;
      } else {
        ++at;
        ++refused;
      }
    }
  }
  for (std::size_t i = 1; i + 1 < left.size(); ++i) {
    triangles.emplace_back(ring[left[0]], ring[left[i]], ring[left[i + 1]]);
  }
}

// ---------------------------------------------------------------------------------------------------
// The parts of a sieve.

/// What passed the sieve, in the words of the file's own format.
struct Sieved {
  std::string text;
  std::uint64_t vertices = 0;
  std::uint64_t faces = 0;
};

std::string_view asText(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

bool isSpace(char c) { return c == ' ' || (c >= '\t' && c <= '\r'); }

/// The words of one line.
void splitWords(std::string_view line, std::vector<std::string_view>& words) {
  words.clear();
  for (std::size_t i = 0; i < line.size();) {
    while (i < line.size() && isSpace(line[i])) ++i;
    const std::size_t start = i;
    while (i < line.size() && !isSpace(line[i])) ++i;
    if (i > start) words.push_back(line.substr(start, i - start));
  }
}

/// Lines of a text, with their numbers, ended by \n or \r\n.
class Lines {
 public:
  explicit Lines(std::string_view text) : rest_(text) {}

  bool next(std::string_view& line) {
    if (rest_.empty()) return false;
    const std::size_t end = rest_.find('\n');
    line = rest_.substr(0, end);
    rest_.remove_prefix(end == std::string_view::npos ? rest_.size() : end + 1);
    if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
    ++number_;
    return true;
  }
  std::size_t number() const { return number_; }
  std::string_view rest() const { return rest_; }

 private:
  std::string_view rest_;
  std::size_t number_ = 0;
};

/// A word as a number that a float holds. Never looks at the locale.
bool isFinite(std::string_view word) {
  if (!word.empty() && word.front() == '+') word.remove_prefix(1);
  if (!word.empty() && word.front() == '+') return false;
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
  if (word.size() > 1 && word[0] == '+' && word[1] != '-') word.remove_prefix(1);
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  return error == std::errc{} && end == word.data() + word.size();
}

tl::unexpected<Error> damaged(std::string message) {
  return refuse(ErrorCode::kDataDamaged, std::move(message));
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

tl::expected<void, Error> checkCorners(const std::string& where, std::uint64_t face,
                                       std::int64_t corners) {
  if (corners < 3) {
    return damaged(
        fmt::format("{}: face {} has {} corners, at least 3 are needed. Export it again or "
                    "remove the face.",
                    where, face, corners));
  }
  if (corners > static_cast<std::int64_t>(kCornersMost)) {
    return refuse(ErrorCode::kTooLarge,
                  fmt::format("{}: face {} has {} corners, at most {} are read. Triangulate it.",
                              where, face, corners, kCornersMost));
  }
  return {};
}

tl::unexpected<Error> endsEarly(const std::string& where, std::string_view element,
                                std::uint64_t had, std::uint64_t count) {
  return damaged(fmt::format("{}: ends early, after {} of {} {}. Copy or export it again.", where,
                             had, count, element));
}

/// Appends a number for those readers of OpenMesh that read it in the program's locale.
void appendInLocale(std::string& text, std::string_view number, char point) {
  const std::size_t start = text.size();
  text += number;
  if (point != '.')
    std::replace(text.begin() + static_cast<std::ptrdiff_t>(start), text.end(), '.', point);
}

char localePoint() { return std::use_facet<std::numpunct<char>>(std::locale()).decimal_point(); }

// ---------------------------------------------------------------------------------------------------
// OBJ: `v` and `f` pass, everything else is about looks.

tl::expected<Sieved, Error> sieveObj(std::string_view text, const std::string& name) {
  Sieved out;
  out.text.reserve(text.size() / 2);
  const char point = localePoint();
  Lines lines(text);
  std::string_view line;
  std::string joined;
  std::vector<std::string_view> words;
  std::vector<std::int64_t> ring;
  // OBJ may name a vertex before it gives it, so the highest index is judged at the end.
  struct {
    std::int64_t vertex = 0;
    std::uint64_t face = 0;
    std::size_t line = 0;
  } highest;

  while (lines.next(line)) {
    const std::size_t number = lines.number();
    if (!line.empty() && line.back() == '\\') {
      joined.assign(line.substr(0, line.size() - 1));
      while (lines.next(line)) {
        const bool more = !line.empty() && line.back() == '\\';
        joined += ' ';
        joined += more ? line.substr(0, line.size() - 1) : line;
        if (!more) break;
      }
      line = joined;
    }
    line = line.substr(0, line.find('#'));
    splitWords(line, words);
    if (words.empty()) continue;
    if (words[0] == "v") {
      const std::string where = fmt::format("{}:{}", name, number);
      out.text += 'v';
      for (int axis = 0; axis < 3; ++axis) {
        const std::size_t at = static_cast<std::size_t>(axis) + 1;
        if (at >= words.size()) return badNumber(where, out.vertices + 1, axis, "missing");
        if (!isFinite(words[at]))
          return badNumber(where, out.vertices + 1, axis, inQuotes(words[at]));
        out.text += ' ';
        appendInLocale(out.text, words[at], point);
      }
      out.text += '\n';
      ++out.vertices;
    } else if (words[0] == "f") {
      const std::string where = fmt::format("{}:{}", name, number);
      const std::uint64_t face = out.faces + 1;
      if (auto sound = checkCorners(where, face, static_cast<std::int64_t>(words.size()) - 1);
          !sound) {
        return tl::unexpected(sound.error());
      }
      ring.clear();
      for (std::size_t i = 1; i < words.size(); ++i) {
        const std::string_view word = words[i].substr(0, words[i].find('/'));
        std::int64_t vertex = 0;
        if (!toInteger(word, vertex) || vertex == 0 ||
            vertex > static_cast<std::int64_t>(kElementsMost)) {
          return badIndex(where, face, inQuotes(words[i]), out.vertices);
        }
        if (vertex < 0)
          vertex += static_cast<std::int64_t>(out.vertices) + 1;  // -1: the last so far
        if (vertex < 1) return badIndex(where, face, inQuotes(words[i]), out.vertices);
        if (vertex > highest.vertex) highest = {vertex, face, number};
        if (ring.empty() || ring.back() != vertex) ring.push_back(vertex);
      }
      while (ring.size() > 1 && ring.front() == ring.back()) ring.pop_back();
      ++out.faces;
      if (ring.size() < 3) continue;  // a line or a point: nothing to stand on
      // OpenMesh drops a vertex that a ring passes twice, wherever that is.
      std::vector<std::int64_t> sorted(ring);
      std::sort(sorted.begin(), sorted.end());
      const auto twice = std::adjacent_find(sorted.begin(), sorted.end());
      if (twice != sorted.end()) {
        return refuse(
            ErrorCode::kFormatUnsupported,
            fmt::format("{}: face {} passes vertex {} twice. Triangulate it in the program "
                        "that made it.",
                        where, face, *twice));
      }
      out.text += 'f';
      for (const std::int64_t vertex : ring)
        fmt::format_to(std::back_inserter(out.text), " {}", vertex);
      out.text += '\n';
    }
  }
  if (highest.vertex > static_cast<std::int64_t>(out.vertices)) {
    return badIndex(fmt::format("{}:{}", name, highest.line), highest.face,
                    fmt::format("{}", highest.vertex), out.vertices);
  }
  return out;
}

// ---------------------------------------------------------------------------------------------------
// OFF: a line a vertex, a line a face; colours, normals and comments stay behind.

tl::expected<Sieved, Error> sieveOff(std::string_view text, const std::string& name) {
  Sieved out;
  Lines lines(text);
  std::string_view line;
  std::vector<std::string_view> words;
  const auto nextWords = [&] {
    while (lines.next(line)) {
      splitWords(line.substr(0, line.find('#')), words);
      if (!words.empty()) return true;
    }
    words.clear();
    return false;
  };
  const auto where = [&] { return fmt::format("{}:{}", name, lines.number()); };

  if (!nextWords() || !words[0].ends_with("OFF")) {
    return refuse(ErrorCode::kFormatUnknown,
                  fmt::format("{}: begins with {}, an OFF file begins with OFF. Check its ending.",
                              where(), inQuotes(words.empty() ? std::string_view{} : words[0])));
  }
  // Prefixes: texture coordinates, colours and normals follow the position; 4 and n change it.
  const std::string_view prefix = words[0].substr(0, words[0].size() - 3);
  if ((prefix != "" && prefix != "ST" && prefix != "C" && prefix != "N" && prefix != "CN" &&
       prefix != "STC" && prefix != "STN" && prefix != "STCN") ||
      (words.size() > 1 && words[1] == "BINARY")) {
    return refuse(ErrorCode::kFormatUnsupported,
                  fmt::format("{}: header {} is not read. Export three-dimensional OFF as text.",
                              where(), inQuotes(line)));
  }
  words.erase(words.begin());
  if (words.empty()) nextWords();
  std::int64_t vertices = 0;
  std::int64_t faces = 0;
  for (std::size_t i = 0; i < 2; ++i) {
    std::int64_t& count = i == 0 ? vertices : faces;
    if (i >= words.size() || !toInteger(words[i], count) || count < 0 ||
        count > static_cast<std::int64_t>(kElementsMost)) {
      return damaged(
          fmt::format("{}: {} count is {}, a number from 0 to {} is needed. Export it again.",
                      where(), i == 0 ? "vertex" : "face",
                      i < words.size() ? inQuotes(words[i]) : "missing", kElementsMost));
    }
  }
  out.text = fmt::format("OFF\n{} {} 0\n", vertices, faces);
  for (std::int64_t i = 0; i < vertices; ++i) {
    if (!nextWords()) {
      return endsEarly(where(), "vertices", static_cast<std::uint64_t>(i),
                       static_cast<std::uint64_t>(vertices));
    }
    for (int axis = 0; axis < 3; ++axis) {
      const std::size_t at = static_cast<std::size_t>(axis);
      const auto vertex = static_cast<std::uint64_t>(i);
      if (at >= words.size()) return badNumber(where(), vertex, axis, "missing");
      if (!isFinite(words[at])) return badNumber(where(), vertex, axis, inQuotes(words[at]));
      out.text += words[at];
      out.text += axis < 2 ? ' ' : '\n';
    }
  }
  for (std::int64_t i = 0; i < faces; ++i) {
    const auto face = static_cast<std::uint64_t>(i);
    if (!nextWords()) {
      return endsEarly(where(), "faces", face, static_cast<std::uint64_t>(faces));
    }
    std::int64_t corners = 0;
    if (!toInteger(words[0], corners)) corners = 0;
    if (auto sound = checkCorners(where(), face, corners); !sound) {
      return tl::unexpected(sound.error());
    }
    if (words.size() < static_cast<std::size_t>(corners) + 1) {
      return damaged(
          fmt::format("{}: face {} has {} corners, the line names {}. Export it again or "
                      "remove the face.",
                      where(), face, corners, words.size() - 1));
    }
    fmt::format_to(std::back_inserter(out.text), "{}", corners);
    for (std::size_t c = 1; c <= static_cast<std::size_t>(corners); ++c) {
      std::int64_t vertex = 0;
      if (!toInteger(words[c], vertex) || vertex < 0 || vertex >= vertices) {
        return badIndex(where(), face, inQuotes(words[c]), static_cast<std::uint64_t>(vertices));
      }
      fmt::format_to(std::back_inserter(out.text), " {}", vertex);
    }
    out.text += '\n';
  }
  out.vertices = static_cast<std::uint64_t>(vertices);
  out.faces = static_cast<std::uint64_t>(faces);
  return out;
}

// ---------------------------------------------------------------------------------------------------
// STL: corners of triangles, as text or as 50 bytes each.

constexpr std::size_t kStlHeader = 84;
constexpr std::size_t kStlTriangle = 50;

template <typename T>
T loadLittle(std::string_view bytes, std::size_t at) {
  unsigned char raw[sizeof(T)];
  std::memcpy(raw, bytes.data() + at, sizeof(T));
  std::uint64_t value = 0;
  for (std::size_t i = 0; i < sizeof(T); ++i) value |= std::uint64_t{raw[i]} << (8 * i);
  if constexpr (sizeof(T) == 4) {
    const auto bits = static_cast<std::uint32_t>(value);
    T result;
    std::memcpy(&result, &bits, sizeof(T));
    return result;
  } else {
    T result;
    std::memcpy(&result, &value, sizeof(T));
    return result;
  }
}

bool isBinaryStl(std::string_view text) {
  if (text.size() >= kStlHeader &&
      text.size() ==
          kStlHeader + kStlTriangle * std::uint64_t{loadLittle<std::uint32_t>(text, 80)}) {
    return true;
  }
  // The first word decides nothing: binary headers say "solid" too. But text has no zero bytes, and
  // the triangle count of a binary file that was cut or padded has some.
  return text.substr(0, 512).find('\0') != text.npos;
}

tl::expected<Sieved, Error> sieveBinaryStl(std::string_view bytes, const std::string& name) {
  if (bytes.size() < kStlHeader) {
    return damaged(
        fmt::format("{}: ends early, {} bytes, a binary STL has {} before its first triangle. "
                    "Copy or export it again.",
                    name, bytes.size(), kStlHeader));
  }
  const std::uint64_t triangles = loadLittle<std::uint32_t>(bytes, 80);
  const std::uint64_t held = (bytes.size() - kStlHeader) / kStlTriangle;
  if (held < triangles) return endsEarly(name, "triangles", held, triangles);
  if (3 * triangles > kElementsMost) {
    return refuse(ErrorCode::kTooLarge,
                  fmt::format("{}: {} triangles, at most {} are read. Split it.", name, triangles,
                              kElementsMost / 3));
  }
  for (std::uint64_t i = 0; i < triangles; ++i) {
    for (int k = 0; k < 9; ++k) {
      const std::size_t at = kStlHeader + static_cast<std::size_t>(i) * kStlTriangle + 12 +
                             4 * static_cast<std::size_t>(k);
      const float value = loadLittle<float>(bytes, at);
      if (!std::isfinite(value)) {
        return badNumber(fmt::format("{}: triangle {}", name, i), static_cast<std::uint64_t>(k / 3),
                         k % 3, fmt::format("{}", value));
      }
    }
  }
  Sieved out;
  out.text.assign(bytes.substr(0, kStlHeader + static_cast<std::size_t>(triangles) * kStlTriangle));
  out.faces = triangles;
  return out;
}

tl::expected<Sieved, Error> sieveTextStl(std::string_view text, const std::string& name) {
  Sieved out;
  const char point = localePoint();
  Lines lines(text);
  std::string_view line;
  std::vector<std::string_view> words;
  const auto lower = [](std::string_view word) {
    std::string result(word);
    for (char& c : result) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
    return result;
  };
  enum class Open { kNothing, kSolid, kFacet, kLoop } open = Open::kNothing;
  std::uint64_t corner = 0;
  while (lines.next(line)) {
    splitWords(line, words);
    if (words.empty()) continue;
    const std::string where = fmt::format("{}:{}", name, lines.number());
    const std::string word = lower(words[0]);
    const auto step = [&](Open from, Open to) {
      const bool fits = open == from;
      open = to;
      return fits;
    };
    bool fits = true;
    if (word == "solid") {
      fits = step(Open::kNothing, Open::kSolid);
    } else if (word == "facet") {
      fits = step(Open::kSolid, Open::kFacet);
    } else if (word == "outer") {
      fits = step(Open::kFacet, Open::kLoop);
      corner = 0;
      out.text += "outer loop\n";
    } else if (word == "vertex") {
      fits = step(Open::kLoop, Open::kLoop) && corner < 3;
      out.text += "vertex";
      for (int axis = 0; fits && axis < 3; ++axis) {
        const std::size_t at = static_cast<std::size_t>(axis) + 1;
        const std::string face = fmt::format("{}: triangle {}", where, out.faces);
        if (at >= words.size()) return badNumber(face, corner, axis, "missing");
        if (!isFinite(words[at])) return badNumber(face, corner, axis, inQuotes(words[at]));
        out.text += ' ';
        appendInLocale(out.text, words[at], point);
      }
      out.text += '\n';
      ++corner;
    } else if (word == "endloop") {
      fits = step(Open::kLoop, Open::kFacet) && corner == 3;
      ++out.faces;
    } else if (word == "endfacet") {
      fits = step(Open::kFacet, Open::kSolid);
    } else if (word == "endsolid") {
      fits = step(Open::kSolid, Open::kNothing);
    } else {
      fits = false;
    }
    if (!fits) {
      return damaged(
          fmt::format("{}: {} does not belong here, after {} whole triangles. Export it "
                      "again.",
                      where, inQuotes(line), out.faces));
    }
  }
  if (open != Open::kNothing) {
    return damaged(
        fmt::format("{}:{}: ends early, after {} triangles and without endsolid. Copy or "
                    "export it again.",
                    name, lines.number(), out.faces));
  }
  return out;
}

// ---------------------------------------------------------------------------------------------------
// PLY: of the elements, `vertex` and `face`; of their properties, x, y, z and the list of corners.

enum class PlyType { kInt8, kUint8, kInt16, kUint16, kInt32, kUint32, kFloat, kDouble };

struct PlyProperty {
  std::string name;
  PlyType type = PlyType::kFloat;
  bool isList = false;
  PlyType countType = PlyType::kUint8;
};

struct PlyElement {
  std::string name;
  std::uint64_t count = 0;
  std::vector<PlyProperty> properties;
};

bool toPlyType(std::string_view word, PlyType& type) {
  struct Name {
    std::string_view word;
    PlyType type;
  };
  static constexpr Name kNames[] = {
      {"char", PlyType::kInt8},     {"int8", PlyType::kInt8},     {"uchar", PlyType::kUint8},
      {"uint8", PlyType::kUint8},   {"short", PlyType::kInt16},   {"int16", PlyType::kInt16},
      {"ushort", PlyType::kUint16}, {"uint16", PlyType::kUint16}, {"int", PlyType::kInt32},
      {"int32", PlyType::kInt32},   {"uint", PlyType::kUint32},   {"uint32", PlyType::kUint32},
      {"float", PlyType::kFloat},   {"float32", PlyType::kFloat}, {"double", PlyType::kDouble},
      {"float64", PlyType::kDouble}};
  for (const Name& name : kNames) {
    if (name.word == word) {
      type = name.type;
      return true;
    }
  }
  return false;
}

std::size_t sizeOf(PlyType type) {
  switch (type) {
    case PlyType::kInt8:
    case PlyType::kUint8:
      return 1;
    case PlyType::kInt16:
    case PlyType::kUint16:
      return 2;
    case PlyType::kInt32:
    case PlyType::kUint32:
    case PlyType::kFloat:
      return 4;
    case PlyType::kDouble:
      return 8;
  }
  return 8;
}

bool isInteger(PlyType type) { return type != PlyType::kFloat && type != PlyType::kDouble; }

/// A list's count type in one of the four words that OpenMesh knows. The bytes are the same for
/// every count that is not negative.
std::string_view countWord(PlyType type) {
  switch (sizeOf(type)) {
    case 1:
      return "uint8";
    case 2:
      return "uint16";
    default:
      return "int";
  }
}

std::string_view valueWord(PlyType type) {
  switch (type) {
    case PlyType::kInt8:
      return "int8";
    case PlyType::kUint8:
      return "uint8";
    case PlyType::kInt16:
      return "int16";
    case PlyType::kUint16:
      return "uint16";
    case PlyType::kInt32:
      return "int32";
    case PlyType::kUint32:
      return "uint32";
    case PlyType::kFloat:
      return "float32";
    case PlyType::kDouble:
      return "float64";
  }
  return "";
}

/// The body of a PLY file, value by value: words of a text or bytes of either order.
class PlyBody {
 public:
  PlyBody(std::string_view body, bool text, bool bigEndian, std::size_t line)
      : rest_(body), text_(text), bigEndian_(bigEndian), line_(line) {}

  /// The next value as it stands in the file; false where the file ends first.
  bool next(PlyType type, std::string_view& raw) {
    if (!text_) {
      if (rest_.size() < sizeOf(type)) return false;
      raw = rest_.substr(0, sizeOf(type));
      rest_.remove_prefix(raw.size());
      return true;
    }
    std::size_t i = 0;
    while (i < rest_.size() && isSpace(rest_[i])) line_ += rest_[i++] == '\n';
    const std::size_t start = i;
    while (i < rest_.size() && !isSpace(rest_[i])) ++i;
    raw = rest_.substr(start, i - start);
    rest_.remove_prefix(i);
    return !raw.empty();
  }
  bool toInteger(PlyType type, std::string_view raw, std::int64_t& value) const {
    if (text_) return navmesh::toInteger(raw, value);
    const std::uint64_t bits = load(raw);
    switch (type) {
      case PlyType::kInt8:
        value = static_cast<std::int8_t>(bits);
        return true;
      case PlyType::kInt16:
        value = static_cast<std::int16_t>(bits);
        return true;
      case PlyType::kInt32:
        value = static_cast<std::int32_t>(bits);
        return true;
      case PlyType::kFloat:
      case PlyType::kDouble:
        return false;
      default:
        value = static_cast<std::int64_t>(bits);
        return true;
    }
  }
  /// A coordinate as a message shows it, if it is not finite.
  std::optional<std::string> notFinite(PlyType type, std::string_view raw) const {
    if (text_) return isFinite(raw) ? std::nullopt : std::optional(inQuotes(raw));
    const std::uint64_t bits = load(raw);
    double value = 0.0;
    if (type == PlyType::kFloat) {
      const auto low = static_cast<std::uint32_t>(bits);
      float single = 0.0f;
      std::memcpy(&single, &low, sizeof single);
      value = static_cast<double>(single);
    } else {
      std::memcpy(&value, &bits, sizeof value);
    }
    if (std::abs(value) <= std::numeric_limits<float>::max()) return std::nullopt;
    return fmt::format("{}", value);
  }
  /// "file" or "file:line".
  std::string where(const std::string& name) const {
    return text_ ? fmt::format("{}:{}", name, line_) : name;
  }
  bool isText() const { return text_; }
  std::size_t bytesLeft() const { return rest_.size(); }

 private:
  std::uint64_t load(std::string_view raw) const {
    std::uint64_t bits = 0;
    for (std::size_t i = 0; i < raw.size(); ++i) {
      const std::size_t at = bigEndian_ ? i : raw.size() - 1 - i;
      bits = bits << 8 | static_cast<unsigned char>(raw[at]);
    }
    return bits;
  }

  std::string_view rest_;
  bool text_;
  bool bigEndian_;
  std::size_t line_;
};

struct PlyHeader {
  std::string format;
  std::vector<PlyElement> elements;
};

tl::expected<PlyHeader, Error> readPlyHeader(Lines& lines, const std::string& name) {
  PlyHeader header;
  std::string_view line;
  std::vector<std::string_view> words;
  if (!lines.next(line) || (line != "ply" && line != "PLY")) {
    return refuse(ErrorCode::kFormatUnknown,
                  fmt::format("{}:1: begins with {}, a PLY file begins with ply. Check its ending.",
                              name, inQuotes(line)));
  }
  while (lines.next(line)) {
    splitWords(line, words);
    if (words.empty() || words[0] == "comment" || words[0] == "obj_info") continue;
    const std::string where = fmt::format("{}:{}", name, lines.number());
    const auto malformed = [&] {
      return damaged(
          fmt::format("{}: header line {} is malformed. Export it again.", where, inQuotes(line)));
    };
    if (words[0] == "end_header") {
      if (header.format.empty()) {
        return damaged(fmt::format("{}: no format line in the header. Export it again.", where));
      }
      return header;
    }
    if (words[0] == "format") {
      if (words.size() != 3 || words[2] != "1.0" ||
          (words[1] != "ascii" && words[1] != "binary_little_endian" &&
           words[1] != "binary_big_endian")) {
        return refuse(
            ErrorCode::kFormatUnsupported,
            fmt::format("{}: {} is not read. Export PLY 1.0, ascii, binary_little_endian or "
                        "binary_big_endian.",
                        where, inQuotes(line)));
      }
      header.format = words[1];
    } else if (words[0] == "element") {
      std::int64_t count = 0;
      if (words.size() != 3 || !toInteger(words[2], count)) return malformed();
      if (count < 0 || count > static_cast<std::int64_t>(kElementsMost)) {
        return damaged(
            fmt::format("{}: element {} has a count of {}, 0 to {} can be read. Export it "
                        "again.",
                        where, inQuotes(words[1]), count, kElementsMost));
      }
      header.elements.push_back({std::string(words[1]), static_cast<std::uint64_t>(count), {}});
    } else if (words[0] == "property") {
      if (header.elements.empty()) return malformed();
      PlyProperty property;
      property.isList = words.size() == 5 && words[1] == "list";
      if (!property.isList && words.size() != 3) return malformed();
      property.name = words.back();
      if (!toPlyType(words[words.size() - 2], property.type)) return malformed();
      if (property.isList &&
          (!toPlyType(words[2], property.countType) || !isInteger(property.countType))) {
        return malformed();
      }
      header.elements.back().properties.push_back(std::move(property));
    } else {
      return malformed();
    }
  }
  return damaged(fmt::format("{}:{}: ends early, inside the header. Copy or export it again.", name,
                             lines.number()));
}

tl::expected<Sieved, Error> sievePly(std::string_view text, const std::string& name) {
  Lines lines(text);
  const auto header = readPlyHeader(lines, name);
  if (!header) return tl::unexpected(header.error());

  const PlyElement* vertexElement = nullptr;
  const PlyElement* faceElement = nullptr;
  for (const PlyElement& element : header->elements) {
    const PlyElement** kept = element.name == "vertex" ? &vertexElement
                              : element.name == "face" ? &faceElement
                                                       : nullptr;
    if (kept == nullptr) continue;
    if (*kept != nullptr) {
      return damaged(fmt::format("{}: element {} is declared twice. Export it again.", name,
                                 inQuotes(element.name)));
    }
    *kept = &element;
  }
  if (vertexElement == nullptr || faceElement == nullptr) {
    return refuse(ErrorCode::kSceneEmpty,
                  fmt::format("{}: the header declares no element {}. Export it as a mesh.", name,
                              vertexElement == nullptr ? "vertex" : "face"));
  }

  // Where x, y, z and the corners stand among the properties.
  constexpr std::size_t kNowhere = std::numeric_limits<std::size_t>::max();
  std::size_t axes[3] = {kNowhere, kNowhere, kNowhere};
  for (std::size_t p = 0; p < vertexElement->properties.size(); ++p) {
    const PlyProperty& property = vertexElement->properties[p];
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (property.name.size() != 1 || property.name[0] != "xyz"[axis]) continue;
      if (property.isList || isInteger(property.type) || axes[axis] != kNowhere) {
        return refuse(
            ErrorCode::kFormatUnsupported,
            fmt::format("{}: vertex property {} is an integer, a list or there twice. Export "
                        "coordinates as float or double.",
                        name, property.name));
      }
      axes[axis] = p;
    }
  }
  std::size_t corners = kNowhere;
  for (std::size_t p = 0; p < faceElement->properties.size(); ++p) {
    const PlyProperty& property = faceElement->properties[p];
    if (property.name != "vertex_indices" && property.name != "vertex_index") continue;
    if (!property.isList || !isInteger(property.type) || corners != kNowhere) {
      return refuse(
          ErrorCode::kFormatUnsupported,
          fmt::format("{}: face property {} is no list of integers or there twice. Export it "
                      "again.",
                      name, property.name));
    }
    corners = p;
  }
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (axes[axis] == kNowhere) {
      return damaged(
          fmt::format("{}: vertices have no property {}. Export it again.", name, "xyz"[axis]));
    }
  }
  if (corners == kNowhere) {
    return damaged(
        fmt::format("{}: faces have no property vertex_indices. Export it again.", name));
  }

  // Positions go out in the order x, y, z whatever theirs was; vertices before faces.
  std::string vertexText;
  std::string faceText;
  PlyBody body(lines.rest(), header->format == "ascii", header->format == "binary_big_endian",
               lines.number() + 1);
  const auto keep = [&](std::string& kept, std::string_view raw) {
    kept += raw;
    if (body.isText()) kept += ' ';
  };
  std::string_view raw;
  for (const PlyElement& element : header->elements) {
    if (element.properties.empty()) continue;
    const bool isVertex = &element == vertexElement;
    const bool isFace = &element == faceElement;
    for (std::uint64_t i = 0; i < element.count; ++i) {
      std::string_view position[3];
      for (std::size_t p = 0; p < element.properties.size(); ++p) {
        const PlyProperty& property = element.properties[p];
        const auto ended = [&] {
          return endsEarly(body.where(name), "elements " + inQuotes(element.name), i,
                           element.count);
        };
        if (!property.isList) {
          if (!body.next(property.type, raw)) return ended();
          for (std::size_t axis = 0; isVertex && axis < 3; ++axis) {
            if (axes[axis] != p) continue;
            if (const auto value = body.notFinite(property.type, raw)) {
              return badNumber(body.where(name), i, static_cast<int>(axis), *value);
            }
            position[axis] = raw;
          }
          continue;
        }
        std::int64_t count = 0;
        if (!body.next(property.countType, raw)) return ended();
        if (!body.toInteger(property.countType, raw, count) || count < 0) {
          return damaged(fmt::format("{}: list {} of {} {} has a count of {}. Export it again.",
                                     body.where(name), inQuotes(property.name),
                                     inQuotes(element.name), i,
                                     body.isText() ? inQuotes(raw) : fmt::format("{}", count)));
        }
        const bool isRing = isFace && p == corners;
        if (isRing) {
          if (auto sound = checkCorners(body.where(name), i, count); !sound) {
            return tl::unexpected(sound.error());
          }
          keep(faceText, raw);
        }
        for (std::int64_t c = 0; c < count; ++c) {
          if (!body.next(property.type, raw)) return ended();
          if (!isRing) continue;
          std::int64_t vertex = 0;
          if (!body.toInteger(property.type, raw, vertex) || vertex < 0 ||
              static_cast<std::uint64_t>(vertex) >= vertexElement->count) {
            return badIndex(body.where(name), i,
                            body.isText() ? inQuotes(raw) : fmt::format("{}", vertex),
                            vertexElement->count);
          }
          keep(faceText, raw);
        }
      }
      if (isVertex) {
        for (const std::string_view coordinate : position) keep(vertexText, coordinate);
      }
    }
  }

  Sieved out;
  out.vertices = vertexElement->count;
  out.faces = faceElement->count;
  out.text = fmt::format("ply\nformat {} 1.0\nelement vertex {}\n", header->format, out.vertices);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    out.text += fmt::format("property {} {}\n",
                            valueWord(vertexElement->properties[axes[axis]].type), "xyz"[axis]);
  }
  const PlyProperty& ring = faceElement->properties[corners];
  out.text += fmt::format("element face {}\nproperty list {} {} vertex_indices\nend_header\n",
                          out.faces, countWord(ring.countType), valueWord(ring.type));
  out.text += vertexText;
  out.text += faceText;
  return out;
}

}  // namespace

tl::expected<Scene, Error> readMeshFile(std::span<const std::byte> bytes, SceneFormat format,
                                        const std::string& name) {
  const std::string_view text = asText(bytes);
  const bool binaryStl = format == SceneFormat::kStl && isBinaryStl(text);
  const auto sieve = [&]() -> tl::expected<Sieved, Error> {
    switch (format) {
      case SceneFormat::kObj:
        return sieveObj(text, name);
      case SceneFormat::kOff:
        return sieveOff(text, name);
      case SceneFormat::kPly:
        return sievePly(text, name);
      default:
        return binaryStl ? sieveBinaryStl(text, name) : sieveTextStl(text, name);
    }
  };
  auto sieved = sieve();
  if (!sieved) return tl::unexpected(sieved.error());

  if (sieved->faces == 0) {
    return refuse(
        ErrorCode::kSceneEmpty,
        fmt::format("{}: no face in it. Export the meshes as faces, not as points or lines.",
                    name));
  }

  const char* ending = format == SceneFormat::kObj   ? "obj"
                       : format == SceneFormat::kOff ? "off"
                       : format == SceneFormat::kPly ? "ply"
                                                     : "stl";
  OpenMesh::IO::Options options;
  if (binaryStl) options += OpenMesh::IO::Options::Binary;
  Soup soup;
  bool read = false;
  {
    // OpenMesh's readers are singletons that keep what they read about a file.
    static std::mutex oneAtATime;
    const std::lock_guard lock(oneAtATime);
    std::istringstream stream(std::move(sieved->text), std::ios::in | std::ios::binary);
    stream.imbue(std::locale::classic());
    read = OpenMesh::IO::IOManager().read(stream, ending, soup, options);
  }
  // STL joins equal corners, and it and OBJ leave out faces without area.
  const bool joins = format == SceneFormat::kStl;
  const bool drops = joins || format == SceneFormat::kObj;
  const std::uint64_t faces = soup.n_faces();
  if (!read || (!joins && soup.n_vertices() != sieved->vertices) ||
      (drops ? faces > sieved->faces : faces != sieved->faces)) {
    return damaged(
        fmt::format("{}: OpenMesh read {} vertices and {} faces, the file has {} and {}. "
                    "Export it again.",
                    name, soup.n_vertices(), faces, sieved->vertices, sieved->faces));
  }

  Scene scene;
  scene.name = name;
  scene.vertices = std::move(soup.vertices);
  scene.triangles.reserve(soup.corners.size() / 3);
  for (std::size_t face = 0; face + 1 < soup.faceStart.size(); ++face) {
    const std::span<const std::uint32_t> ring(soup.corners.data() + soup.faceStart[face],
                                              soup.faceStart[face + 1] - soup.faceStart[face]);
    triangulate(ring, scene.vertices, scene.triangles);
  }
  return scene;
}

}  // namespace forewalk::navmesh
