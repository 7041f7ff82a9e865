// The .fwmesh reader on any bytes: as they come, and once more with size and checksum made to fit,
// so that mutations reach what lies behind the checksum.
#include <string>

#include "navmesh/build/fwmesh.h"
#include "navmesh/nav_graph.h"
#include "tests/fuzz/fuzz.h"

using forewalk::testing::require;
using forewalk::testing::requireSentence;
using namespace forewalk::navmesh;

namespace {

void setNumber(std::vector<std::uint8_t>& bytes, std::size_t at, std::uint32_t value) {
  for (std::size_t i = 0; i < 4; ++i) bytes[at + i] = static_cast<std::uint8_t>(value >> (8 * i));
}

// Bit by bit: slow, but no table that the reader's could agree with by mistake.
std::uint32_t crc32(const std::vector<std::uint8_t>& bytes, std::size_t count) {
  std::uint32_t crc = 0xffffffffu;
  for (std::size_t i = 0; i < count; ++i) {
    crc ^= bytes[i];
    for (int bit = 0; bit < 8; ++bit) crc = (crc >> 1) ^ ((crc & 1u) != 0 ? 0xedb88320u : 0u);
  }
  return ~crc;
}

void reseal(std::vector<std::uint8_t>& bytes) {
  constexpr std::size_t kSmallest = 36;  // header and checksum
  if (bytes.size() < kSmallest) return;
  setNumber(bytes, 24, static_cast<std::uint32_t>(bytes.size()));
  setNumber(bytes, 28, 0);
  setNumber(bytes, bytes.size() - 4, crc32(bytes, bytes.size() - 4));
}

void load(const std::vector<std::uint8_t>& bytes) {
  const auto navMesh = loadFwmesh(std::as_bytes(std::span(bytes)), "fuzz");
  if (!navMesh) {
    requireSentence(navMesh.error().message, "fuzz: ");
    return;
  }
  require(validate(*navMesh).has_value(), "what was loaded is valid");
  const PolygonMesh flat = flatten(*navMesh);
  require(makeNavGraph(flat).has_value(), "what was loaded makes a navgraph");
  const auto again = loadFwmesh(saveFwmesh(*navMesh), "fuzz");
  require(again && flatten(*again) == flat && again->settings == navMesh->settings,
          "what was loaded can be saved and loaded again");
}

std::vector<std::uint8_t> seedOf(const PolygonMesh& polygons) {
  const auto navMesh = makeNavMesh(polygons, BuildSettings{});
  require(navMesh.has_value(), "seeds are sound");
  std::vector<std::uint8_t> seed;
  for (const std::byte b : saveFwmesh(*navMesh)) seed.push_back(std::to_integer<std::uint8_t>(b));
  return seed;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::vector<std::uint8_t> bytes(data, data + size);
  load(bytes);
  reseal(bytes);
  load(bytes);
  return 0;
}

std::vector<std::vector<std::uint8_t>> seedCorpus() {
  // Two squares that share an edge, a triangle that touches one of them in a corner.
  PolygonMesh plain;
  plain.vertices = {{0, 0, 0}, {1, 0, 0},  {1, 0, -1}, {0, 0, -1},
                    {2, 0, 0}, {2, 0, -1}, {3, 0, -1}, {3, 0, -2}};
  plain.ring = {0, 1, 2, 3, 1, 4, 5, 2, 5, 6, 7};
  plain.ringStart = {0, 4, 8, 11};

  // Two squares across a tile border, half a metre of it in common, with heights.
  PolygonMesh border;
  border.vertices = {{0, 0, 0},     {1, 0, 0},     {1, 0, -1},    {0, 0, -1},
                     {1, 0, -0.5f}, {2, 0, -0.5f}, {2, 0, -1.5f}, {1, 0, -1.5f}};
  border.ring = {0, 1, 2, 3, 4, 5, 6, 7};
  border.ringStart = {0, 4, 8};
  border.borderPortals = {{PolygonId{0}, PolygonId{1}, 1, 3, {1, 0, -1}, {1, 0, -0.5f}}};
  border.heightStart = {0, 0, 1};
  border.heightTriangles = {{{1, 0, -0.5f}, {2, 0.1f, -0.5f}, {2, 0, -1.5f}}};
  return {seedOf(plain), seedOf(border)};
}
