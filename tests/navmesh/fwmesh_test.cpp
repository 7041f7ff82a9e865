#include "navmesh/build/fwmesh.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>

#include "navmesh/plan.h"
#include "navmesh/random.h"
#include "tests/support/random_mesh.h"

namespace forewalk::navmesh {
namespace {

using ::testing::HasSubstr;
using Bytes = std::vector<std::byte>;

constexpr std::size_t kHeaderSize = 32;
constexpr std::size_t kEntrySize = 24;

std::uint32_t numberAt(const Bytes& bytes, std::size_t at) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    value |= std::to_integer<std::uint32_t>(bytes[at + i]) << (8 * i);
  }
  return value;
}

void setNumber(Bytes& bytes, std::size_t at, std::uint32_t value) {
  for (std::size_t i = 0; i < 4; ++i) bytes[at + i] = static_cast<std::byte>(value >> (8 * i));
}

// CRC-32 bit by bit, to stand against the table in fwmesh.cpp.
std::uint32_t crc32(const Bytes& bytes, std::size_t count) {
  std::uint32_t crc = 0xffffffffu;
  for (std::size_t i = 0; i < count; ++i) {
    crc ^= std::to_integer<std::uint32_t>(bytes[i]);
    for (int bit = 0; bit < 8; ++bit) crc = (crc >> 1) ^ ((crc & 1u) != 0 ? 0xedb88320u : 0u);
  }
  return ~crc;
}

// What an attacker would do: sizes and checksum fit the bytes again.
Bytes resealed(Bytes bytes) {
  setNumber(bytes, 24, static_cast<std::uint32_t>(bytes.size()));
  setNumber(bytes, 28, 0);
  setNumber(bytes, bytes.size() - 4, crc32(bytes, bytes.size() - 4));
  return bytes;
}

std::size_t entryOf(std::uint32_t section) { return kHeaderSize + (section - 1) * kEntrySize; }
std::size_t offsetOf(const Bytes& bytes, std::uint32_t section) {
  return numberAt(bytes, entryOf(section) + 8);
}

PolygonMesh tileBorder() {
  PolygonMesh mesh = testing::joinedGrids(2, 2, 3, 3.0f);
  mesh.heightStart.assign(1, 0);
  for (std::uint32_t p = 0; p < mesh.polygonCount(); ++p) {
    const auto corner = [&](std::uint32_t i) {
      return mesh.vertices[mesh.ring[mesh.ringStart[p] + i]];
    };
    mesh.heightTriangles.push_back({corner(0), corner(1), corner(2)});
    mesh.heightStart.push_back(p + 1);
  }
  return mesh;
}

BuildSettings unusualSettings() {
  BuildSettings settings;
  float value = 0.01f;
  for (float* field :
       {&settings.radius, &settings.height, &settings.climb, &settings.slope, &settings.cell,
        &settings.cellHeight, &settings.regionMin, &settings.regionMerge, &settings.edgeMax,
        &settings.edgeError, &settings.detailSample, &settings.detailError, &settings.tile}) {
    *field = value += 0.013f;  // each field its own value, so that no two can be exchanged unseen
  }
  settings.cornersMax = 5;
  settings.partition = Partition::kLayers;
  return settings;
}

NavMesh made(const PolygonMesh& polygons, const BuildSettings& settings = {}) {
  auto navMesh = makeNavMesh(polygons, settings);
  if (!navMesh) {
    ADD_FAILURE() << navMesh.error().message;
    return {};
  }
  return *std::move(navMesh);
}

Error refusal(const Bytes& bytes) {
  const auto navMesh = loadFwmesh(bytes, "test.fwmesh");
  if (navMesh) return {ErrorCode{}, "accepted"};
  return navMesh.error();
}

// ---- What is refused

TEST(LoadFwmesh, RefusesNothingAtAll) { EXPECT_EQ(refusal({}).code, ErrorCode::kFormatUnknown); }

TEST(LoadFwmesh, RefusesOtherFiles) {
  const Error error = refusal(Bytes(4000, std::byte{'o'}));
  EXPECT_EQ(error.code, ErrorCode::kFormatUnknown);
  EXPECT_THAT(error.message, HasSubstr("test.fwmesh: byte 0: no .fwmesh begins like this"));
}

TEST(LoadFwmesh, RefusesEveryTruncatedLength) {
  const Bytes bytes = saveFwmesh(made(tileBorder()));
  for (std::size_t length = 0; length < bytes.size(); ++length) {
    // A copy of exactly this length, so that the sanitizer sees the first byte read past its end.
    const Bytes shortened(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(length));
    const Error error = refusal(shortened);
    EXPECT_NE(error.message, "accepted") << length << " bytes";
    EXPECT_EQ(error.code, length == 0 ? ErrorCode::kFormatUnknown : ErrorCode::kDataDamaged);
  }
}

TEST(LoadFwmesh, RefusesBytesAfterTheEnd) {
  Bytes bytes = saveFwmesh(made(tileBorder()));
  const std::size_t size = bytes.size();
  bytes.push_back(std::byte{0});
  EXPECT_THAT(refusal(bytes).message, HasSubstr(std::to_string(size) + " bytes"));
}

TEST(LoadFwmesh, RefusesEveryFlippedBitAndEveryChangedByte) {
  const Bytes bytes = saveFwmesh(made(tileBorder()));
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    for (int bit = 0; bit <= 8; ++bit) {
      Bytes changed = bytes;
      changed[i] ^= static_cast<std::byte>(bit == 8 ? 0xff : 1 << bit);
      EXPECT_NE(refusal(changed).message, "accepted") << "byte " << i << " bit " << bit;
    }
  }
}

TEST(LoadFwmesh, NamesTheByteAndBothChecksums) {
  Bytes bytes = saveFwmesh(made(tileBorder()));
  bytes[300] ^= std::byte{1};
  const Error error = refusal(bytes);
  EXPECT_EQ(error.code, ErrorCode::kDataDamaged);
  EXPECT_THAT(error.message,
              HasSubstr("byte " + std::to_string(bytes.size() - 4) + ": the checksum is"));
}

TEST(LoadFwmesh, RefusesALaterVersionWhateverElseItHolds) {
  Bytes bytes = saveFwmesh(made(tileBorder()));
  setNumber(bytes, 8, 2);
  for (const Bytes& later : {bytes, resealed(bytes), Bytes(bytes.begin(), bytes.begin() + 40)}) {
    const Error error = refusal(later);
    EXPECT_EQ(error.code, ErrorCode::kFormatUnsupported);
    EXPECT_THAT(error.message, HasSubstr(".fwmesh version 2, this program reads up to 1"));
  }
  setNumber(bytes, 8, 0);
  EXPECT_EQ(refusal(resealed(bytes)).code, ErrorCode::kDataDamaged);
}

TEST(LoadFwmesh, RefusesAFileOfTheOtherByteOrder) {
  Bytes bytes = saveFwmesh(made(tileBorder()));
  std::reverse(bytes.begin() + 12, bytes.begin() + 16);
  EXPECT_THAT(refusal(resealed(bytes)).message, HasSubstr("byte order mark"));
}

// Counts, sizes and offsets that the bytes cannot justify, with a checksum that fits: whatever is
// claimed, the reader stays inside the file and allocates no more than its bytes can fill. (The
// sanitizer refuses allocations of this size.)
TEST(LoadFwmesh, RefusesAbsurdCountsAndOffsetsWithARightChecksum) {
  const Bytes bytes = saveFwmesh(made(tileBorder()));
  const std::size_t tableEnd = kHeaderSize + 7 * kEntrySize;
  for (std::size_t at = 12; at < tableEnd; at += 4) {
    if (at == 24 || at == 28) continue;  // the file's size, which resealed() mends
    for (const std::uint32_t value : {0x7fffffffu, 0x80000000u, 0xfffffff0u, 0xffffffffu}) {
      Bytes absurd = bytes;
      setNumber(absurd, at, value);
      const bool isId = at >= kHeaderSize && (at - kHeaderSize) % kEntrySize == 0;
      const std::size_t section = at >= kHeaderSize ? (at - kHeaderSize) / kEntrySize + 1 : 0;
      const Error error = refusal(resealed(absurd));
      // A border or height section under an unknown id is as good as absent; all else cannot be.
      if (isId && section == 5) continue;
      EXPECT_NE(error.message, "accepted") << "byte " << at << " value " << value;
    }
  }
}

TEST(LoadFwmesh, SurvivesEveryNumberReplacedWithARightChecksum) {
  const NavMesh navMesh = made(tileBorder());
  const Bytes bytes = saveFwmesh(navMesh);
  for (std::size_t at = 8; at + 8 <= bytes.size(); at += 4) {
    for (const std::uint32_t value : {0u, 1u, 0x7fffffffu, 0xffffffffu, 0x7fc00000u, 0x7f800000u,
                                      0x7f7fffffu, numberAt(bytes, at) + 1}) {
      Bytes changed = bytes;
      setNumber(changed, at, value);
      const auto loaded = loadFwmesh(resealed(changed), "test.fwmesh");
      if (!loaded) {
        EXPECT_FALSE(loaded.error().message.empty());
        EXPECT_EQ(loaded.error().message.find('\n'), std::string::npos);
        continue;
      }
      EXPECT_TRUE(validate(*loaded)) << "byte " << at;  // a few centimetres off, but a navmesh
    }
  }
}

TEST(LoadFwmesh, SurvivesRandomDamageWithARightChecksum) {
  std::mt19937_64 rng(17);
  const Bytes bytes = saveFwmesh(made(tileBorder()));
  for (int trial = 0; trial < 4000; ++trial) {
    Bytes changed = bytes;
    for (int i = uniformInt(rng, 6); i >= 0; --i) {
      const int span =
          trial % 2 == 0 ? static_cast<int>(bytes.size()) : 200;  // the table, half the time
      changed[static_cast<std::size_t>(uniformInt(rng, span))] =
          static_cast<std::byte>(uniformInt(rng, 256));
    }
    if (trial % 3 == 0) {
      changed.resize(36 +
                     static_cast<std::size_t>(uniformInt(rng, static_cast<int>(bytes.size()))));
    }
    const auto loaded = loadFwmesh(resealed(changed), "test.fwmesh");
    EXPECT_TRUE(!loaded || validate(*loaded)) << "trial " << trial;
  }
}

TEST(LoadFwmesh, RefusesASectionThatIsMissingOrComesTwice) {
  const Bytes bytes = saveFwmesh(made(tileBorder()));
  for (const std::uint32_t section : {1u, 2u, 3u, 4u}) {
    Bytes changed = bytes;
    setNumber(changed, entryOf(section), 77);
    EXPECT_THAT(refusal(resealed(changed)).message, HasSubstr("is missing"));
    setNumber(changed, entryOf(section), section == 4 ? 3 : section + 1);
    EXPECT_THAT(refusal(resealed(changed)).message, HasSubstr("comes twice"));
  }
}

TEST(LoadFwmesh, RefusesPolygonsThatAreNoNavMesh) {
  Bytes bytes = saveFwmesh(made(tileBorder()));
  setNumber(bytes, offsetOf(bytes, 4), 4000);
  const Error error = refusal(resealed(bytes));
  EXPECT_EQ(error.code, ErrorCode::kDataDamaged);
  EXPECT_THAT(error.message, HasSubstr("test.fwmesh: polygon 0 names vertex 4000"));
  bytes = saveFwmesh(made(tileBorder()));
  setNumber(bytes, offsetOf(bytes, 2), 0x7fc00000u);
  EXPECT_THAT(refusal(resealed(bytes)).message, HasSubstr("test.fwmesh: vertex 0 is (nan"));
  bytes = saveFwmesh(made(tileBorder()));
  setNumber(bytes, offsetOf(bytes, 1), 0x7fc00000u);
  EXPECT_THAT(refusal(resealed(bytes)).message, HasSubstr("test.fwmesh: setting radius is nan"));
  bytes = saveFwmesh(made(tileBorder()));
  setNumber(bytes, offsetOf(bytes, 1) + 13 * 4,
            0x00000100u);  // a partition that 8 bits would read as 0
  EXPECT_THAT(refusal(resealed(bytes)).message, HasSubstr("setting partition is 255"));
}

// ---- What comes back

TEST(Fwmesh, GivesBackWhatWasSaved) {
  for (std::uint64_t seed = 0; seed < 30; ++seed) {
    testing::RandomMeshOptions options;
    options.heights = 0.3f;
    const PolygonMesh polygons =
        testing::randomMesh(seed, 2 + static_cast<int>(seed % 9), 7, options);
    const auto loaded = loadFwmesh(saveFwmesh(made(polygons, unusualSettings())), "test.fwmesh");
    ASSERT_TRUE(loaded) << loaded.error().message;
    EXPECT_EQ(flatten(*loaded), polygons);
    EXPECT_EQ(loaded->settings, unusualSettings());
  }
}

TEST(Fwmesh, GivesBackBorderPortalsAndHeights) {
  const PolygonMesh polygons = tileBorder();
  ASSERT_FALSE(polygons.borderPortals.empty());
  ASSERT_FALSE(polygons.heightTriangles.empty());
  const auto loaded = loadFwmesh(saveFwmesh(made(polygons)), "test.fwmesh");
  ASSERT_TRUE(loaded) << loaded.error().message;
  EXPECT_EQ(flatten(*loaded), polygons);
}

TEST(Fwmesh, HasTheSameBytesForTheSameNavMesh) {
  const NavMesh navMesh = made(tileBorder(), unusualSettings());
  const Bytes bytes = saveFwmesh(navMesh);
  EXPECT_EQ(saveFwmesh(navMesh), bytes);
  const auto loaded = loadFwmesh(bytes, "test.fwmesh");
  ASSERT_TRUE(loaded);
  EXPECT_EQ(saveFwmesh(*loaded), bytes);
}

TEST(Fwmesh, KeepsTheSignOfZeroAndTheSmallestNumbers) {
  PolygonMesh polygons = testing::gridMesh(1, 1);
  polygons.vertices[0] = {-0.0f, std::numeric_limits<float>::denorm_min(), 0.0f};
  const auto loaded = loadFwmesh(saveFwmesh(made(polygons)), "test.fwmesh");
  ASSERT_TRUE(loaded) << loaded.error().message;
  const PolygonMesh flat = flatten(*loaded);
  EXPECT_TRUE(std::signbit(flat.vertices[0].x));
  EXPECT_EQ(flat.vertices[0].y, std::numeric_limits<float>::denorm_min());
}

// The layout as navmesh/build/README.md says it, so that other programs can rely on it.
TEST(Fwmesh, HasTheLayoutThatIsWrittenDown) {
  const Bytes bytes = saveFwmesh(made(testing::gridMesh(1, 1), unusualSettings()));
  const char magic[] = "FWMSH\r\n\x1a";
  for (std::size_t i = 0; i < 8; ++i) EXPECT_EQ(std::to_integer<char>(bytes[i]), magic[i]);
  EXPECT_EQ(numberAt(bytes, 8), 1u);            // version
  EXPECT_EQ(numberAt(bytes, 12), 0x01020304u);  // byte order
  EXPECT_EQ(numberAt(bytes, 16), 32u);          // header
  EXPECT_EQ(numberAt(bytes, 20), 7u);           // sections
  EXPECT_EQ(numberAt(bytes, 24), bytes.size());
  const std::uint32_t recordSizes[] = {60, 12, 4, 4, 40, 4, 36};
  const std::uint32_t records[] = {1, 4, 2, 4, 0, 0, 0};
  std::uint32_t offset = 32 + 7 * 24;
  for (std::uint32_t section = 1; section <= 7; ++section) {
    const std::size_t entry = entryOf(section);
    const std::uint32_t size = recordSizes[section - 1] * records[section - 1];
    EXPECT_EQ(numberAt(bytes, entry), section);
    EXPECT_EQ(numberAt(bytes, entry + 4), recordSizes[section - 1]);
    EXPECT_EQ(numberAt(bytes, entry + 8), offset);
    EXPECT_EQ(numberAt(bytes, entry + 16), size);
    offset += size;
  }
  EXPECT_EQ(bytes.size(), offset + 4);
  EXPECT_EQ(numberAt(bytes, bytes.size() - 4), crc32(bytes, bytes.size() - 4));
}

// Later programs may add fields to a record's end and sections to a file; this one skips both.
TEST(Fwmesh, ReadsWhatALaterProgramAdded) {
  const PolygonMesh polygons = tileBorder();
  const Bytes bytes = saveFwmesh(made(polygons, unusualSettings()));
  Bytes grown(bytes.begin(), bytes.begin() + kHeaderSize);
  setNumber(grown, 20, 8);  // sections
  const std::size_t tableEnd = kHeaderSize + 8 * kEntrySize;
  grown.resize(tableEnd);
  for (std::uint32_t section = 1; section <= 8; ++section) {
    const std::size_t entry = entryOf(section);
    const bool isNew = section == 8;
    const std::uint32_t recordSize = isNew ? 1 : numberAt(bytes, entryOf(section) + 4);
    const std::uint32_t count = isNew ? 13 : numberAt(bytes, entryOf(section) + 16) / recordSize;
    setNumber(grown, entry, isNew ? 4711 : section);
    setNumber(grown, entry + 4, recordSize + 8);
    setNumber(grown, entry + 8, static_cast<std::uint32_t>(grown.size()));
    setNumber(grown, entry + 16, (recordSize + 8) * count);
    for (std::uint32_t i = 0; i < count; ++i) {
      for (std::uint32_t b = 0; b < recordSize; ++b) {
        grown.push_back(isNew ? std::byte{0xee}
                              : bytes[offsetOf(bytes, section) + i * recordSize + b]);
      }
      grown.insert(grown.end(), 8, std::byte{0xdd});
    }
  }
  grown.resize(grown.size() + 4);
  const auto loaded = loadFwmesh(resealed(grown), "test.fwmesh");
  ASSERT_TRUE(loaded) << loaded.error().message;
  EXPECT_EQ(flatten(*loaded), polygons);
  EXPECT_EQ(loaded->settings, unusualSettings());
}

}  // namespace
}  // namespace forewalk::navmesh
