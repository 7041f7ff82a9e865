// The MSET importer on any bytes, and the Detour tile reader on the same bytes as one tile.
#include <string>

#include "navmesh/build/build.h"
#include "navmesh/build/detour_tiles.h"
#include "navmesh/nav_graph.h"
#include "tests/fuzz/fuzz.h"
#include "tests/support/block_scene.h"
#include "tests/support/mset.h"

using forewalk::testing::require;
using forewalk::testing::requireSentence;
using namespace forewalk::navmesh;

namespace {

std::vector<std::uint8_t> seedOf(const Scene& scene, float side) {
  BuildSettings settings;
  settings.tile = side;
  const auto tiles = buildTiles(scene, settings);
  require(tiles.has_value(), "seeds are sound");
  std::vector<std::uint8_t> seed;
  for (const std::byte b : forewalk::testing::msetOf(*tiles)) {
    seed.push_back(std::to_integer<std::uint8_t>(b));
  }
  return seed;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::vector<std::uint8_t> input(data, data + size);
  const auto bytes = std::as_bytes(std::span(input));
  const auto navMesh = importMset(bytes, "fuzz");
  if (!navMesh) {
    requireSentence(navMesh.error().message, "fuzz: ");
  } else {
    require(makeNavGraph(flatten(*navMesh)).has_value(), "what was imported makes a navgraph");
  }

  // Behind the headers of the set and of its first tile.
  constexpr std::size_t kFirstTile = 48;
  if (size <= kFirstTile) return 0;
  const DetourTile tile(bytes.begin() + kFirstTile, bytes.end());
  const auto polygons = polygonsFromTiles(std::span(&tile, 1), 0.25f, "fuzz");
  if (!polygons) requireSentence(polygons.error().message, "fuzz: ");
  return 0;
}

std::vector<std::vector<std::uint8_t>> seedCorpus() {
  return {seedOf(forewalk::testing::twoRooms(0.9f), 6.4f),
          seedOf(forewalk::testing::twoRooms(0.9f), 0.0f),
          seedOf(forewalk::testing::islands(), 0.0f)};
}
