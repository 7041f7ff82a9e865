// PLY: of the elements, `vertex` and `face`; of their properties, x, y, z and the list of corners.
#include <fmt/format.h>

#include <bit>
#include <cmath>
#include <iterator>
#include <optional>

#include "navmesh/build/scene_sieve.h"

namespace forewalk::navmesh {
namespace {

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

struct PlyTypeFacts {
  std::string_view word, oldWord;
  std::size_t size;  ///< bytes
  bool isInteger;
};

constexpr PlyTypeFacts kPlyTypes[] = {  // in the order of PlyType
    {"int8", "char", 1, true},      {"uint8", "uchar", 1, true},    {"int16", "short", 2, true},
    {"uint16", "ushort", 2, true},  {"int32", "int", 4, true},      {"uint32", "uint", 4, true},
    {"float32", "float", 4, false}, {"float64", "double", 8, false}};

const PlyTypeFacts& factsOf(PlyType type) { return kPlyTypes[static_cast<std::size_t>(type)]; }
std::size_t sizeOf(PlyType type) { return factsOf(type).size; }
bool isInteger(PlyType type) { return factsOf(type).isInteger; }

bool toPlyType(std::string_view word, PlyType& type) {
  for (std::size_t i = 0; i < std::size(kPlyTypes); ++i) {
    if (word != kPlyTypes[i].word && word != kPlyTypes[i].oldWord) continue;
    type = static_cast<PlyType>(i);
    return true;
  }
  return false;
}

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
    const double value = type == PlyType::kFloat
                             ? std::bit_cast<float>(static_cast<std::uint32_t>(bits))
                             : std::bit_cast<double>(bits);
    if (std::abs(value) <= std::numeric_limits<float>::max()) return std::nullopt;
    return fmt::format("{}", value);
  }
  /// "file" or "file:line".
  std::string where(const std::string& name) const {
    return text_ ? fmt::format("{}:{}", name, line_) : name;
  }
  bool isText() const { return text_; }

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

// ---- The header.

struct PlyHeader {
  std::string format;
  std::vector<PlyElement> elements;
};

/// The statements of a header, one a line.
class HeaderReader {
 public:
  HeaderReader(Lines& lines, const std::string& name) : lines_(lines), name_(name) {}

  tl::expected<PlyHeader, Error> read() {
    if (!lines_.next(line_) || (line_ != "ply" && line_ != "PLY")) {
      return refuse(
          ErrorCode::kFormatUnknown,
          fmt::format("{}:1: begins with {}, a PLY file begins with ply. Check its ending.", name_,
                      inQuotes(line_)));
    }
    while (lines_.next(line_)) {
      splitWords(line_, words_);
      if (words_.empty() || words_[0] == "comment" || words_[0] == "obj_info") continue;
      if (words_[0] == "end_header") {
        if (!header_.format.empty()) return std::move(header_);
        return damaged(fmt::format("{}: no format line in the header. Export it again.", where()));
      }
      auto taken = words_[0] == "format"     ? takeFormat()
                   : words_[0] == "element"  ? takeElement()
                   : words_[0] == "property" ? takeProperty()
                                             : malformed();
      if (!taken) return tl::unexpected(taken.error());
    }
    return damaged(
        fmt::format("{}: ends early, inside the header. Copy or export it again.", where()));
  }

 private:
  using Taken = tl::expected<void, Error>;

  Taken takeFormat() {
    if (words_.size() != 3 || words_[2] != "1.0" ||
        (words_[1] != "ascii" && words_[1] != "binary_little_endian" &&
         words_[1] != "binary_big_endian")) {
      return refuse(
          ErrorCode::kFormatUnsupported,
          fmt::format("{}: {} is not read. Export PLY 1.0, ascii, binary_little_endian or "
                      "binary_big_endian.",
                      where(), inQuotes(line_)));
    }
    header_.format = words_[1];
    return {};
  }

  Taken takeElement() {
    std::int64_t count = 0;
    if (words_.size() != 3 || !toInteger(words_[2], count)) return malformed();
    if (count < 0 || count > static_cast<std::int64_t>(kElementsMost)) {
      return damaged(
          fmt::format("{}: element {} has a count of {}, 0 to {} can be read. Export it "
                      "again.",
                      where(), inQuotes(words_[1]), count, kElementsMost));
    }
    header_.elements.push_back({std::string(words_[1]), static_cast<std::uint64_t>(count), {}});
    return {};
  }

  /// `property TYPE NAME` or `property list COUNT_TYPE TYPE NAME`.
  Taken takeProperty() {
    PlyProperty property;
    property.isList = words_.size() == 5 && words_[1] == "list";
    const bool sound = !header_.elements.empty() && (property.isList || words_.size() == 3) &&
                       toPlyType(words_[words_.size() - 2], property.type) &&
                       (!property.isList || (toPlyType(words_[2], property.countType) &&
                                             isInteger(property.countType)));
    if (!sound) return malformed();
    property.name = words_.back();
    header_.elements.back().properties.push_back(std::move(property));
    return {};
  }

  Taken malformed() const {
    return damaged(
        fmt::format("{}: header line {} is malformed. Export it again.", where(), inQuotes(line_)));
  }
  std::string where() const { return fmt::format("{}:{}", name_, lines_.number()); }

  Lines& lines_;
  const std::string& name_;
  std::string_view line_;
  std::vector<std::string_view> words_;
  PlyHeader header_;
};

/// Where in the file that stands which a scene needs.
struct Layout {
  const PlyElement* vertex = nullptr;
  const PlyElement* face = nullptr;
  std::size_t axes[3];  ///< x, y, z among the vertex's properties
  std::size_t corners;  ///< among the face's
};

constexpr std::size_t kNowhere = std::numeric_limits<std::size_t>::max();

tl::expected<void, Error> findElements(const PlyHeader& header, const std::string& name,
                                       Layout& layout) {
  for (const PlyElement& element : header.elements) {
    const PlyElement** kept = element.name == "vertex" ? &layout.vertex
                              : element.name == "face" ? &layout.face
                                                       : nullptr;
    if (kept == nullptr) continue;
    if (*kept != nullptr) {
      return damaged(fmt::format("{}: element {} is declared twice. Export it again.", name,
                                 inQuotes(element.name)));
    }
    *kept = &element;
  }
  if (layout.vertex == nullptr || layout.face == nullptr) {
    return refuse(ErrorCode::kSceneEmpty,
                  fmt::format("{}: the header declares no element {}. Export it as a mesh.", name,
                              layout.vertex == nullptr ? "vertex" : "face"));
  }
  return {};
}

tl::expected<void, Error> findAxes(const std::string& name, Layout& layout) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    layout.axes[axis] = kNowhere;
    for (std::size_t p = 0; p < layout.vertex->properties.size(); ++p) {
      const PlyProperty& property = layout.vertex->properties[p];
      if (property.name.size() != 1 || property.name[0] != "xyz"[axis]) continue;
      if (property.isList || isInteger(property.type) || layout.axes[axis] != kNowhere) {
        return refuse(
            ErrorCode::kFormatUnsupported,
            fmt::format("{}: vertex property {} is an integer, a list or there twice. Export "
                        "coordinates as float or double.",
                        name, property.name));
      }
      layout.axes[axis] = p;
    }
    if (layout.axes[axis] == kNowhere) {
      return damaged(
          fmt::format("{}: vertices have no property {}. Export it again.", name, "xyz"[axis]));
    }
  }
  return {};
}

tl::expected<void, Error> findCorners(const std::string& name, Layout& layout) {
  layout.corners = kNowhere;
  for (std::size_t p = 0; p < layout.face->properties.size(); ++p) {
    const PlyProperty& property = layout.face->properties[p];
    if (property.name != "vertex_indices" && property.name != "vertex_index") continue;
    if (!property.isList || !isInteger(property.type) || layout.corners != kNowhere) {
      return refuse(
          ErrorCode::kFormatUnsupported,
          fmt::format("{}: face property {} is no list of integers or there twice. Export it "
                      "again.",
                      name, property.name));
    }
    layout.corners = p;
  }
  if (layout.corners == kNowhere) {
    return damaged(
        fmt::format("{}: faces have no property vertex_indices. Export it again.", name));
  }
  return {};
}

tl::expected<Layout, Error> layoutOf(const PlyHeader& header, const std::string& name) {
  Layout layout;
  auto found = findElements(header, name, layout);
  if (found) found = findAxes(name, layout);
  if (found) found = findCorners(name, layout);
  if (!found) return tl::unexpected(found.error());
  return layout;
}

// ---- The body.

/// Reads the elements in the file's order and keeps the two that matter.
class BodySieve {
 public:
  BodySieve(const Layout& layout, const std::string& name, PlyBody body)
      : layout_(layout), name_(name), body_(body) {}

  /// Positions in the order x, y, z whatever theirs was, and the rings, in the file's own encoding.
  std::string vertices, faces;

  tl::expected<void, Error> pass(const PlyElement& element) {
    if (element.properties.empty()) return {};
    for (std::uint64_t i = 0; i < element.count; ++i) {
      for (std::size_t p = 0; p < element.properties.size(); ++p) {
        auto passed =
            element.properties[p].isList ? passList(element, i, p) : passValue(element, i, p);
        if (!passed) return passed;
      }
      if (&element != layout_.vertex) continue;
      for (const std::string_view coordinate : position_) keep(vertices, coordinate);
    }
    return {};
  }

 private:
  tl::expected<void, Error> passValue(const PlyElement& element, std::uint64_t i, std::size_t p) {
    const PlyProperty& property = element.properties[p];
    std::string_view raw;
    if (!body_.next(property.type, raw)) return ended(element, i);
    for (std::size_t axis = 0; &element == layout_.vertex && axis < 3; ++axis) {
      if (layout_.axes[axis] != p) continue;
      if (const auto value = body_.notFinite(property.type, raw)) {
        return badNumber(where(), i, static_cast<int>(axis), *value);
      }
      position_[axis] = raw;
    }
    return {};
  }

  tl::expected<void, Error> passList(const PlyElement& element, std::uint64_t i, std::size_t p) {
    const PlyProperty& property = element.properties[p];
    std::string_view raw;
    std::int64_t count = 0;
    if (!body_.next(property.countType, raw)) return ended(element, i);
    if (!body_.toInteger(property.countType, raw, count) || count < 0) {
      return damaged(fmt::format("{}: list {} of {} {} has a count of {}. Export it again.",
                                 where(), inQuotes(property.name), inQuotes(element.name), i,
                                 shown(raw, count)));
    }
    const bool isRing = &element == layout_.face && p == layout_.corners;
    if (isRing) {
      if (!isFaceSize(count)) return badCorners(where(), i, count);
      keep(faces, raw);
    }
    for (std::int64_t c = 0; c < count; ++c) {
      if (!body_.next(property.type, raw)) return ended(element, i);
      if (!isRing) continue;
      std::int64_t vertex = 0;
      if (!body_.toInteger(property.type, raw, vertex) || vertex < 0 ||
          static_cast<std::uint64_t>(vertex) >= layout_.vertex->count) {
        return badIndex(where(), i, shown(raw, vertex), layout_.vertex->count);
      }
      keep(faces, raw);
    }
    return {};
  }

  void keep(std::string& kept, std::string_view raw) const {
    kept += raw;
    if (body_.isText()) kept += ' ';
  }
  std::string shown(std::string_view raw, std::int64_t value) const {
    return body_.isText() ? inQuotes(raw) : fmt::format("{}", value);
  }
  tl::unexpected<Error> ended(const PlyElement& element, std::uint64_t i) const {
    return endsEarly(where(), "elements " + inQuotes(element.name), i, element.count);
  }
  std::string where() const { return body_.where(name_); }

  const Layout& layout_;
  const std::string& name_;
  PlyBody body_;
  std::string_view position_[3];  ///< of the vertex that is being read
};

std::string plainHeader(const PlyHeader& header, const Layout& layout) {
  std::string text =
      fmt::format("ply\nformat {} 1.0\nelement vertex {}\n", header.format, layout.vertex->count);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    text +=
        fmt::format("property {} {}\n",
                    factsOf(layout.vertex->properties[layout.axes[axis]].type).word, "xyz"[axis]);
  }
  const PlyProperty& ring = layout.face->properties[layout.corners];
  text += fmt::format("element face {}\nproperty list {} {} vertex_indices\nend_header\n",
                      layout.face->count, countWord(ring.countType), factsOf(ring.type).word);
  return text;
}

}  // namespace

tl::expected<Sieved, Error> sievePly(std::string_view bytes, const std::string& name) {
  Lines lines(bytes);
  const auto header = HeaderReader(lines, name).read();
  if (!header) return tl::unexpected(header.error());
  const auto layout = layoutOf(*header, name);
  if (!layout) return tl::unexpected(layout.error());

  BodySieve body(*layout, name,
                 PlyBody(lines.rest(), header->format == "ascii",
                         header->format == "binary_big_endian", lines.number() + 1));
  for (const PlyElement& element : header->elements) {
    if (auto passed = body.pass(element); !passed) return tl::unexpected(passed.error());
  }
  Sieved out;
  out.vertices = layout->vertex->count;
  out.faces = layout->face->count;
  out.text = plainHeader(*header, *layout) + body.vertices + body.faces;
  return out;
}

}  // namespace forewalk::navmesh
