#include "navmesh/build/fwmesh_flat.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <utility>

#include "navmesh/border_portals.h"

namespace forewalk::navmesh {
namespace {

// navmesh/build/README.md describes the layout; the numbers here are its numbers.
constexpr std::array<std::uint8_t, 8> kMagic{'F', 'W', 'M', 'S', 'H', 0x0d, 0x0a, 0x1a};
constexpr std::uint32_t kVersion = 1;
constexpr std::uint32_t kByteOrder = 0x01020304;
constexpr std::uint32_t kHeaderSize = 32;
constexpr std::uint32_t kEntrySize = 24;
constexpr std::uint32_t kChecksumSize = 4;

enum class Section : std::uint32_t {
  kSettings = 1,
  kVertices = 2,
  kRingStart = 3,
  kRing = 4,
  kBorderPortals = 5,
  kHeightStart = 6,
  kHeightTriangles = 7,
};

constexpr std::size_t slot(Section id) { return static_cast<std::size_t>(id); }
constexpr std::size_t kSectionCount = 7;
constexpr std::array<const char*, kSectionCount + 1> kSectionNames{
    "",     "settings",      "vertices",    "ringStart",
    "ring", "borderPortals", "heightStart", "heightTriangles"};

// CRC-32 as in zip and PNG, so that anybody can check a file: Python's zlib.crc32(data[:-4]).
constexpr std::array<std::uint32_t, 256> kCrcTable = [] {
  std::array<std::uint32_t, 256> table{};
  for (std::uint32_t i = 0; i < 256; ++i) {
    std::uint32_t crc = i;
    for (int bit = 0; bit < 8; ++bit) crc = (crc >> 1) ^ ((crc & 1u) != 0 ? 0xedb88320u : 0u);
    table[i] = crc;
  }
  return table;
}();

std::uint32_t checksum(std::span<const std::byte> bytes) {
  std::uint32_t crc = 0xffffffffu;
  for (const std::byte b : bytes) {
    crc = kCrcTable[(crc ^ std::to_integer<std::uint32_t>(b)) & 0xffu] ^ (crc >> 8);
  }
  return ~crc;
}

// std::bit_cast, which not all compilers of this part have.
std::uint32_t bitsOf(float value) {
  std::uint32_t bits;
  std::memcpy(&bits, &value, sizeof bits);
  return bits;
}
float realOf(std::uint32_t bits) {
  float value;
  std::memcpy(&value, &bits, sizeof value);
  return value;
}

// ---- Writing

class Writer {
 public:
  void number(std::uint32_t value) {
    for (int shift = 0; shift < 32; shift += 8) {
      bytes_.push_back(static_cast<std::byte>((value >> shift) & 0xffu));
    }
  }
  void longNumber(std::uint64_t value) {
    number(static_cast<std::uint32_t>(value));
    number(static_cast<std::uint32_t>(value >> 32));
  }
  void real(float value) { number(bitsOf(value)); }
  void point(glm::vec3 value) {
    real(value.x);
    real(value.y);
    real(value.z);
  }
  void append(const std::vector<std::byte>& bytes) {
    bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
  }
  std::vector<std::byte>& bytes() { return bytes_; }

 private:
  std::vector<std::byte> bytes_;
};

void write(Writer& out, std::uint32_t value) { out.number(value); }
void write(Writer& out, glm::vec3 value) { out.point(value); }
void write(Writer& out, const BorderPortal& portal) {
  out.number(index(portal.from));
  out.number(index(portal.to));
  out.number(portal.fromEdge);
  out.number(portal.toEdge);
  out.point(portal.left);
  out.point(portal.right);
}
void write(Writer& out, const HeightTriangle& triangle) {
  out.point(triangle.a);
  out.point(triangle.b);
  out.point(triangle.c);
}
void write(Writer& out, const BuildSettings& settings) {
  out.real(settings.radius);
  out.real(settings.height);
  out.real(settings.climb);
  out.real(settings.slope);
  out.real(settings.cell);
  out.real(settings.cellHeight);
  out.real(settings.regionMin);
  out.real(settings.regionMerge);
  out.real(settings.edgeMax);
  out.real(settings.edgeError);
  out.real(settings.detailSample);
  out.real(settings.detailError);
  out.number(settings.cornersMax);
  out.number(static_cast<std::uint32_t>(settings.partition));
  out.real(settings.tile);
}

// ---- Reading

// Reads a record's fields. The caller has made sure that the record is all there.
class Fields {
 public:
  explicit Fields(std::span<const std::byte> bytes) : rest_(bytes) {}

  std::uint32_t number() {
    std::uint32_t value = 0;
    for (std::size_t i = 0; i < 4; ++i) {
      value |= std::to_integer<std::uint32_t>(rest_[i]) << (8 * i);
    }
    rest_ = rest_.subspan(4);
    return value;
  }
  std::uint64_t longNumber() {
    const std::uint64_t low = number();
    return low | (static_cast<std::uint64_t>(number()) << 32);
  }
  float real() { return realOf(number()); }
  glm::vec3 point() {
    const float x = real();
    const float y = real();
    const float z = real();
    return {x, y, z};
  }

 private:
  std::span<const std::byte> rest_;
};

void read(Fields& in, std::uint32_t& value) { value = in.number(); }
void read(Fields& in, glm::vec3& value) { value = in.point(); }
void read(Fields& in, BorderPortal& portal) {
  portal.from = PolygonId{in.number()};
  portal.to = PolygonId{in.number()};
  portal.fromEdge = in.number();
  portal.toEdge = in.number();
  portal.left = in.point();
  portal.right = in.point();
}
void read(Fields& in, HeightTriangle& triangle) {
  triangle.a = in.point();
  triangle.b = in.point();
  triangle.c = in.point();
}
void read(Fields& in, BuildSettings& settings) {
  settings.radius = in.real();
  settings.height = in.real();
  settings.climb = in.real();
  settings.slope = in.real();
  settings.cell = in.real();
  settings.cellHeight = in.real();
  settings.regionMin = in.real();
  settings.regionMerge = in.real();
  settings.edgeMax = in.real();
  settings.edgeError = in.real();
  settings.detailSample = in.real();
  settings.detailError = in.real();
  settings.cornersMax = in.number();
  // What does not fit the enum becomes a value that validate() refuses.
  settings.partition = static_cast<Partition>(std::min(in.number(), 255u));
  settings.tile = in.real();
}

// Bytes of one record in the file, as this version writes it.
template <typename T>
std::uint32_t sizeInFile() {
  Writer out;
  write(out, T{});
  return static_cast<std::uint32_t>(out.bytes().size());
}

struct SectionBytes {
  std::uint32_t recordSize = 0;
  std::size_t offset = 0;
  std::span<const std::byte> bytes;
};

class File {
 public:
  File(std::span<const std::byte> bytes, const std::string& name) : bytes_(bytes), name_(name) {}

  // Everything that can be said before the records are looked at. `sections_` is filled.
  tl::expected<void, Error> open() {
    if (auto begins = checkHeader(); !begins) return begins;
    for (std::uint32_t i = 0; i < sectionCount_; ++i) {
      if (auto added = addSection(i); !added) return added;
    }
    return {};
  }

  bool has(Section id) const { return sections_[slot(id)].recordSize != 0; }

  // The section's records. One that is not there leaves `records` as they are.
  template <typename T>
  tl::expected<void, Error> readAll(Section id, std::vector<T>& records) const {
    const SectionBytes& section = sections_[slot(id)];
    if (!has(id)) return {};
    if (auto fits = checkRecords<T>(id, section); !fits) return fits;
    const std::size_t count = section.bytes.size() / section.recordSize;
    records.resize(count);  // no more than the file's bytes can fill
    for (std::size_t i = 0; i < count; ++i) {
      Fields fields(section.bytes.subspan(i * section.recordSize, section.recordSize));
      read(fields, records[i]);
    }
    return {};
  }

  tl::unexpected<Error> damaged(std::size_t byte, const std::string& what) const {
    return tl::unexpected(
        Error{ErrorCode::kDataDamaged,
              fmt::format("{}: byte {}: {}. Copy or build the file again.", name_, byte, what)});
  }

 private:
  tl::expected<void, Error> checkHeader() {
    const std::size_t known = std::min(bytes_.size(), kMagic.size());
    const bool isOurs = known > 0 && std::equal(kMagic.begin(), kMagic.begin() + known,
                                                bytes_.begin(), [](std::uint8_t a, std::byte b) {
                                                  return a == std::to_integer<std::uint8_t>(b);
                                                });
    if (!isOurs) {
      return tl::unexpected(Error{
          ErrorCode::kFormatUnknown,
          fmt::format(
              "{}: byte 0: no .fwmesh begins like this. Name a file that `forewalk build` wrote.",
              name_)});
    }
    if (bytes_.size() < kHeaderSize + kChecksumSize) {
      return damaged(bytes_.size(),
                     fmt::format("the file ends in its header, which has {} bytes", kHeaderSize));
    }
    Fields header(bytes_.subspan(kMagic.size(), kHeaderSize - kMagic.size()));
    const std::uint32_t version = header.number();
    const std::uint32_t byteOrder = header.number();
    const std::uint32_t headerSize = header.number();
    sectionCount_ = header.number();
    const std::uint64_t fileSize = header.longNumber();
    // A later version may place its checksum elsewhere, so it is named before anything else is
    // judged.
    if (version > kVersion) {
      return tl::unexpected(Error{
          ErrorCode::kFormatUnsupported,
          fmt::format(
              "{}: byte 8: .fwmesh version {}, this program reads up to {}. Update forewalk or "
              "build the file again.",
              name_, version, kVersion)});
    }
    if (fileSize != bytes_.size()) {
      return damaged(bytes_.size(),
                     fmt::format("the file ends here, its header says {} bytes", fileSize));
    }
    const std::size_t body = bytes_.size() - kChecksumSize;
    const std::uint32_t stated = Fields(bytes_.subspan(body)).number();
    const std::uint32_t found = checksum(bytes_.first(body));
    if (stated != found) {
      return damaged(
          body, fmt::format("the checksum is {:08x}, but the bytes before it have {:08x}", stated,
                            found));
    }
    if (version == 0) return damaged(8, "version 0 was never written");
    if (byteOrder != kByteOrder) {
      return damaged(12, fmt::format("the byte order mark is {:08x} instead of {:08x}", byteOrder,
                                     kByteOrder));
    }
    if (headerSize < kHeaderSize || headerSize > body) {
      return damaged(16, fmt::format("the header has {} bytes, {} to {} are possible", headerSize,
                                     kHeaderSize, body));
    }
    if (sectionCount_ > (body - headerSize) / kEntrySize) {
      return damaged(20, fmt::format("{} sections are announced, there is room for {}",
                                     sectionCount_, (body - headerSize) / kEntrySize));
    }
    table_ = headerSize;
    return {};
  }

  tl::expected<void, Error> addSection(std::uint32_t number) {
    const std::size_t at = table_ + std::size_t{number} * kEntrySize;
    Fields entry(bytes_.subspan(at, kEntrySize));
    const std::uint32_t id = entry.number();
    const std::uint32_t recordSize = entry.number();
    const std::uint64_t offset = entry.longNumber();
    const std::uint64_t size = entry.longNumber();
    const std::uint64_t body = bytes_.size() - kChecksumSize;
    const std::uint64_t first = table_ + std::uint64_t{sectionCount_} * kEntrySize;
    if (offset < first || offset > body || size > body - offset) {
      return damaged(
          at, fmt::format("section {} takes {} bytes from byte {}, sections lie between {} and "
                          "{}",
                          id, size, offset, first, body));
    }
    if (id == 0 || id >= sections_.size()) return {};  // added later: skipped
    if (sections_[id].recordSize != 0)
      return damaged(at, fmt::format("section {} ({}) comes twice", id, kSectionNames[id]));
    if (recordSize == 0 || size % recordSize != 0) {
      return damaged(at,
                     fmt::format("section {} ({}) has {} bytes, which records of {} bytes do not "
                                 "fill",
                                 id, kSectionNames[id], size, recordSize));
    }
    sections_[id] = {
        recordSize, static_cast<std::size_t>(offset),
        bytes_.subspan(static_cast<std::size_t>(offset), static_cast<std::size_t>(size))};
    return {};
  }

  // Records may have grown at their end, and the new fields are skipped; they never shrink.
  template <typename T>
  tl::expected<void, Error> checkRecords(Section id, const SectionBytes& section) const {
    const std::uint32_t least = sizeInFile<T>();
    if (section.recordSize >= least) return {};
    return damaged(section.offset,
                   fmt::format("the records of section {} ({}) have {} bytes, {} are "
                               "needed",
                               slot(id), kSectionNames[slot(id)], section.recordSize, least));
  }

  std::span<const std::byte> bytes_;
  const std::string& name_;
  std::uint32_t sectionCount_ = 0;
  std::size_t table_ = 0;
  std::array<SectionBytes, kSectionCount + 1> sections_;
};

// One section, ready to be placed.
struct Block {
  Section id;
  std::uint32_t recordSize;
  std::vector<std::byte> bytes;
};

template <typename T>
Block blockOf(Section id, std::span<const T> records) {
  Writer out;
  for (const T& record : records) write(out, record);
  return {id, sizeInFile<T>(), std::move(out.bytes())};
}

tl::expected<PolygonMesh, Error> readPolygons(const File& file) {
  PolygonMesh mesh;
  using Check = tl::expected<void, Error>;
  const Check checks[] = {file.readAll(Section::kVertices, mesh.vertices),
                          file.readAll(Section::kRingStart, mesh.ringStart),
                          file.readAll(Section::kRing, mesh.ring),
                          file.readAll(Section::kBorderPortals, mesh.borderPortals),
                          file.readAll(Section::kHeightStart, mesh.heightStart),
                          file.readAll(Section::kHeightTriangles, mesh.heightTriangles)};
  for (const Check& check : checks) {
    if (!check) return tl::unexpected(check.error());
  }
  return mesh;
}

tl::expected<BuildSettings, Error> readSettings(const File& file) {
  std::vector<BuildSettings> settings;
  if (auto read = file.readAll(Section::kSettings, settings); !read) {
    return tl::unexpected(read.error());
  }
  if (settings.size() != 1) {
    return file.damaged(
        kHeaderSize, fmt::format("there are {} records of settings, 1 is needed", settings.size()));
  }
  return settings[0];
}

}  // namespace

std::vector<std::byte> saveFlatFwmesh(const BuildSettings& settings, const PolygonMesh& flat) {
  const auto block = [](Section id, const auto& records) {
    return blockOf(id, std::span(records));
  };
  const Block blocks[] = {blockOf(Section::kSettings, std::span(&settings, 1)),
                          block(Section::kVertices, flat.vertices),
                          block(Section::kRingStart, flat.ringStart),
                          block(Section::kRing, flat.ring),
                          block(Section::kBorderPortals, flat.borderPortals),
                          block(Section::kHeightStart, flat.heightStart),
                          block(Section::kHeightTriangles, flat.heightTriangles)};
  std::uint64_t offset = kHeaderSize + std::size(blocks) * kEntrySize;
  Writer table;
  for (const Block& b : blocks) {
    table.number(static_cast<std::uint32_t>(b.id));
    table.number(b.recordSize);
    table.longNumber(offset);
    table.longNumber(b.bytes.size());
    offset += b.bytes.size();
  }
  Writer file;
  for (const std::uint8_t byte : kMagic) file.bytes().push_back(static_cast<std::byte>(byte));
  file.number(kVersion);
  file.number(kByteOrder);
  file.number(kHeaderSize);
  file.number(static_cast<std::uint32_t>(std::size(blocks)));
  file.longNumber(offset + kChecksumSize);
  file.append(table.bytes());
  for (const Block& b : blocks) file.append(b.bytes);
  file.number(checksum(file.bytes()));
  return std::move(file.bytes());
}

tl::expected<FlatNavMesh, Error> loadFlatFwmesh(std::span<const std::byte> bytes,
                                                const std::string& name) {
  File file(bytes, name);
  if (auto opened = file.open(); !opened) return tl::unexpected(opened.error());
  for (const Section id :
       {Section::kSettings, Section::kVertices, Section::kRingStart, Section::kRing}) {
    if (!file.has(id)) {
      return file.damaged(kHeaderSize, fmt::format("section {} ({}) is missing", slot(id),
                                                   kSectionNames[slot(id)]));
    }
  }
  auto settings = readSettings(file);
  if (!settings) return tl::unexpected(settings.error());
  auto polygons = readPolygons(file);
  if (!polygons) return tl::unexpected(polygons.error());
  const auto inFile = [&](const Error& error) {
    return tl::unexpected(Error{error.code, fmt::format("{}: {}", name, error.message)});
  };
  if (auto sound = validate(*settings); !sound) return inFile(sound.error());
  if (auto sound = validate(*polygons); !sound) return inFile(sound.error());
  if (auto sound = checkBorderPortals(*polygons, settings->climb); !sound)
    return inFile(sound.error());
  return FlatNavMesh{*settings, std::move(*polygons)};
}

}  // namespace forewalk::navmesh
