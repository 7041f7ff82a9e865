#include "navmesh/build/tile_join.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <numeric>
#include <random>
#include <stdexcept>
#include <string>

#include "navmesh/build/tile_source.h"
#include "navmesh/random.h"
#include "tests/support/block_scene.h"
#include "tests/support/random_obstacle.h"
#include "tests/support/same_graph.h"

namespace forewalk::navmesh {
namespace {

using forewalk::testing::differences;

Scene bundled(const std::string& name) {
  return *importScene(std::filesystem::path(FOREWALK_ASSETS "/scenes/" + name + ".obj"));
}

Scene moved(Scene scene, glm::vec3 by) {
  for (glm::vec3& vertex : scene.vertices) vertex += by;
  return scene;
}

BuildSettings tiled(float tile) {
  BuildSettings settings;
  settings.tile = tile;
  return settings;
}

/// The joint graph of all tiles by the long way.
NavGraph theLongWay(const std::vector<DetourTile>& tiles, const BuildSettings& settings) {
  std::vector<DetourTile> withGround;
  for (const DetourTile& tile : tiles) {
    if (!tile.empty()) withGround.push_back(tile);
  }
  if (withGround.empty()) return {};
  const auto mesh = polygonsFromTiles(withGround, settings.climb, "tiles");
  if (!mesh) throw std::runtime_error(mesh.error().message);
  return *makeNavGraph(*mesh);
}

std::vector<std::uint32_t> allNumbers(std::size_t count) {
  std::vector<std::uint32_t> numbers(count);
  std::iota(numbers.begin(), numbers.end(), 0u);
  return numbers;
}

struct Built {
  BuildSettings settings;
  TileSource source;
  std::vector<DetourTile> tiles;
  TileJoin join;
};

Built built(Scene scene, const BuildSettings& settings) {
  auto source = TileSource::make(std::move(scene), settings);
  if (!source) throw std::runtime_error(source.error().message);
  std::vector<DetourTile> tiles = source->takeTiles();
  TileJoin join(source->columnCount(), source->tileCount() / source->columnCount(), settings);
  join.replace(allNumbers(tiles.size()), tiles);
  return {settings, std::move(*source), std::move(tiles), std::move(join)};
}

void expectTheLongWay(const Built& world, const std::string& what) {
  const std::optional<NavGraph> joined = world.join.join();
  ASSERT_TRUE(joined.has_value()) << what;
  EXPECT_EQ(differences(*joined, theLongWay(world.tiles, world.settings)), "") << what;
}

TEST(TileJoin, IsEmptyWithoutTiles) {
  const TileJoin join(3, 2, tiled(5.0f));
  EXPECT_FALSE(join.hasGround());
  ASSERT_TRUE(join.join().has_value());
  EXPECT_EQ(join.join()->polygonCount(), 0u);
}

TEST(TileJoin, EqualsTheLongWayOnTheBundledScenes) {
  for (const std::string name : {"office", "museum", "two_storey", "corridor", "maze"}) {
    for (const float tile : {0.0f, 3.3f, 6.0f, 25.6f}) {
      expectTheLongWay(built(bundled(name), tiled(tile)), name + " " + std::to_string(tile));
    }
  }
}

TEST(TileJoin, EqualsTheLongWayOnRoughGround) {
  const std::string file = FOREWALK_SHARED_DATA "/scenes/nav_test.obj";
  if (!std::filesystem::exists(file)) GTEST_SKIP() << "there is no " << file;
  for (const float tile : {6.0f, 12.8f}) {
    expectTheLongWay(built(*importScene(std::filesystem::path(file)), tiled(tile)), "nav_test");
  }
}

// There floats are coarse, and the vertices of two tiles lie apart where they meet.
TEST(TileJoin, WeldsWhatRoundingHasPutApart) {
  for (const glm::vec3 by : {glm::vec3(-317.7f, 12.3f, 1234.5f), glm::vec3(3e3f, 0.0f, -7e3f)}) {
    BuildSettings settings = tiled(3.1f);
    settings.cell = 0.07f;  // no binary fraction of anything
    expectTheLongWay(built(moved(bundled("corridor"), by), settings), std::to_string(by.x));
  }
}

TEST(TileJoin, EqualsTheLongWayHoweverItsTilesWereReplaced) {
  std::mt19937_64 rng(11);
  for (const glm::vec3 by : {glm::vec3(0.0f), glm::vec3(-317.7f, 12.3f, 1234.5f)}) {
    Built world = built(moved(testing::twoStoreys(), by), tiled(2.6f));
    for (int round = 0; round < 120; ++round) {
      std::vector<std::uint32_t> numbers;
      std::vector<DetourTile> tiles;
      std::vector<std::shared_ptr<const GridObstacle>> placed;
      std::vector<const GridObstacle*> carved;
      for (int i = uniformInt(rng, 4); i > 0; --i) {
        placed.push_back(
            world.source.place(testing::randomObstacle(rng, {by, by + glm::vec3(14, 4, 10)}, 1.5)));
        carved.push_back(placed.back().get());
      }
      for (std::uint32_t tile = 0; tile < world.tiles.size(); ++tile) {
        if (uniformInt(rng, 6) != 0) continue;
        numbers.push_back(tile);
        // What does not fit its neighbours is joined as well as what does.
        tiles.push_back(uniformInt(rng, 8) == 0 ? DetourTile{} : *world.source.build(tile, carved));
        world.tiles[tile] = tiles.back();
      }
      world.join.replace(numbers, tiles);
      expectTheLongWay(world, "round " + std::to_string(round));
      if (HasFatalFailure() || HasNonfatalFailure()) return;
    }
  }
}

TEST(TileJoin, IsAValue) {
  const Built world = built(bundled("corridor"), tiled(6.0f));
  TileJoin changed = world.join;
  const std::vector<DetourTile> none(world.tiles.size());
  changed.replace(allNumbers(none.size()), none);
  EXPECT_FALSE(changed.hasGround());
  expectTheLongWay(world, "the original");
}

TEST(TileJoin, LeavesWhatItDoesNotExpectToTheLongWay) {
  // Vertices of one tile that may lie within reach of each other's welds.
  const Built corridor = built(bundled("corridor"), tiled(6.0f));
  BuildSettings fine = corridor.settings;
  fine.cell = 0.004f;
  TileJoin near(corridor.source.columnCount(),
                corridor.tiles.size() / corridor.source.columnCount(), fine);
  near.replace(allNumbers(corridor.tiles.size()), corridor.tiles);
  EXPECT_FALSE(near.join().has_value());
  EXPECT_EQ(near.tilesWithGround().size(), corridor.join.tilesWithGround().size());
  // Bytes that are no tile.
  Built broken = built(bundled("corridor"), tiled(6.0f));
  DetourTile cut = broken.join.tilesWithGround().front();
  cut.resize(cut.size() / 2);
  const std::vector<DetourTile> tiles{cut};
  broken.join.replace(std::vector<std::uint32_t>{0}, tiles);
  EXPECT_FALSE(broken.join.join().has_value());
}

}  // namespace
}  // namespace forewalk::navmesh
