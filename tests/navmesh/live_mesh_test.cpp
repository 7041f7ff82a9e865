#include "navmesh/build/live_mesh.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <random>
#include <set>

#include "navmesh/plan.h"
#include "navmesh/random.h"
#include "tests/support/block_scene.h"
#include "tests/support/random_obstacle.h"
#include "tests/support/same_graph.h"

namespace forewalk::navmesh {
namespace {

using forewalk::testing::BlockScene;
using forewalk::testing::differences;
using ::testing::HasSubstr;

BuildSettings tiled(float tile, float cell = 0.1f) {
  BuildSettings settings;
  settings.tile = tile;
  settings.cell = cell;
  settings.edgeError = 1.3f * cell;
  settings.detailSample = 6.0f * cell;
  return settings;
}

Scene flatFloor(float width, float depth) {
  return BlockScene("floor").floor({0.0f, 0.0f, width, depth}).scene();
}

LiveMesh made(Scene scene, const BuildSettings& settings,
              const std::vector<Obstacle>& outlines = {}) {
  auto mesh = LiveMesh::make(std::move(scene), settings, outlines);
  if (!mesh) throw std::runtime_error(mesh.error().message);
  return std::move(*mesh);
}

LiveUpdate applied(LiveMesh& mesh, const std::vector<ObstacleChange>& changes) {
  auto update = mesh.apply(changes);
  if (!update) throw std::runtime_error(update.error().message);
  return *update;
}

ObstacleChange put(std::uint32_t id, Obstacle obstacle) {
  return {ObstacleId{id}, std::move(obstacle)};
}
ObstacleChange gone(std::uint32_t id) { return {ObstacleId{id}, std::nullopt}; }

/// A world without any of LiveMesh's bookkeeping: the pipeline of a static build.
World staticWorld(const Scene& scene, const BuildSettings& settings) {
  const auto tiles = buildTiles(scene, settings);
  if (!tiles) throw std::runtime_error(tiles.error().message);
  return makeWorld(*makeNavGraph(*polygonsFromTiles(*tiles, settings.climb, scene.name)));
}

/// The same with every tile built around the obstacles given.
World rebuilt(const Scene& scene, const BuildSettings& settings,
              const std::map<ObstacleId, Obstacle>& obstacles) {
  const TileSource source = *TileSource::make(scene, settings);
  std::vector<std::shared_ptr<const GridObstacle>> placed;
  std::vector<const GridObstacle*> all;
  for (const auto& [id, obstacle] : obstacles) placed.push_back(source.place(obstacle));
  for (const auto& obstacle : placed) all.push_back(obstacle.get());
  std::vector<DetourTile> tiles;
  for (std::size_t tile = 0; tile < source.tileCount(); ++tile) {
    DetourTile bytes = *source.build(tile, all);
    if (!bytes.empty()) tiles.push_back(std::move(bytes));
  }
  if (tiles.empty()) return makeWorld(NavGraph{});
  return makeWorld(*makeNavGraph(*polygonsFromTiles(tiles, settings.climb, scene.name)));
}

double areaOf(const World& world) {
  double area = 0.0;
  for (std::uint32_t p = 0; p < world.graph.polygonCount(); ++p) {
    area += areaOf(world.graph, PolygonId{p});
  }
  return area;
}

bool onGround(const World& world, glm::vec3 place) {
  const SnapLimits exact{0.0f, 0.3f, 0.3f};
  return locate(world.graph, world.locations, place, exact).has_value();
}

bool connected(const World& world, glm::vec3 a, glm::vec3 b) {
  const auto from = locate(world.graph, world.locations, a);
  const auto to = locate(world.graph, world.locations, b);
  if (!from || !to) return false;
  const std::vector<std::uint32_t>& component = world.graph.component;
  return component[index(from->polygon)] == component[index(to->polygon)];
}

/// Metres on the plan from a place to an obstacle's outline, 0 inside.
double distanceTo(const Obstacle& obstacle, glm::vec2 plan) {
  const ObstacleOutline outline = outlineOf(obstacle);
  const glm::dvec2 place(plan);
  if (outline.corners.empty()) {
    return std::max(0.0, glm::distance(place, outline.centre) - outline.radius);
  }
  bool inside = true;
  double nearest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < outline.corners.size(); ++i) {
    const glm::dvec2 a = outline.corners[i];
    const glm::dvec2 edge = outline.corners[(i + 1) % outline.corners.size()] - a;
    const glm::dvec2 to = place - a;
    if (edge.x * to.y - edge.y * to.x < 0.0) inside = false;
    const double share = std::clamp(glm::dot(to, edge) / glm::dot(edge, edge), 0.0, 1.0);
    nearest = std::min(nearest, glm::length(to - share * edge));
  }
  return inside ? 0.0 : nearest;
}

const BoxObstacle kCrate{{3.0f, 0.5f, 2.0f}, {0.4f, 0.5f, 0.4f}, 0.0f};

TEST(LiveMesh, FailsWhereTheStaticBuildFails) {
  const auto empty = LiveMesh::make(Scene{}, tiled(4.0f));
  ASSERT_FALSE(empty);
  EXPECT_EQ(empty.error().code, ErrorCode::kSceneEmpty);
  const auto fine = LiveMesh::make(flatFloor(4.0f, 4.0f), tiled(0.01f));
  ASSERT_FALSE(fine);
  EXPECT_EQ(fine.error().code, ErrorCode::kSettingOutOfRange);
  const auto narrow = LiveMesh::make(flatFloor(0.4f, 0.4f), tiled(4.0f));
  ASSERT_FALSE(narrow);
  EXPECT_EQ(narrow.error().code, ErrorCode::kNothingWalkable);
  const auto outlines = LiveMesh::make(flatFloor(4.0f, 4.0f), tiled(4.0f),
                                       std::vector<Obstacle>(63, Obstacle(kCrate)));
  ASSERT_FALSE(outlines);
  EXPECT_EQ(outlines.error().code, ErrorCode::kTooLarge);
}

TEST(LiveMesh, EqualsTheStaticBuildWhereNothingStands) {
  const Scene scene = *importScene(std::filesystem::path(FOREWALK_ASSETS "/scenes/two_storey.obj"));
  for (const float tile : {0.0f, 6.0f}) {
    LiveMesh mesh = made(scene, tiled(tile));
    EXPECT_EQ(differences(*mesh.world(), staticWorld(scene, tiled(tile))), "");
    // What never was may go, and nothing is built for it.
    const auto before = mesh.world();
    const LiveUpdate update = applied(mesh, {gone(7)});
    EXPECT_EQ(update.tilesBuilt, 0u);
    EXPECT_EQ(update.world, before);
  }
}

TEST(LiveMesh, ForgetsAnObstacleThatHasGone) {
  LiveMesh mesh = made(flatFloor(9.0f, 9.0f), tiled(3.0f));
  const auto before = mesh.world();
  const auto during = applied(mesh, {put(1, kCrate)}).world;
  EXPECT_NE(differences(*before, *during), "");
  EXPECT_LT(areaOf(*during), areaOf(*before) - 0.8 * 0.8);
  EXPECT_FALSE(onGround(*during, {3.0f, 0.0f, 2.0f}));
  EXPECT_TRUE(onGround(*before, {3.0f, 0.0f, 2.0f})) << "a world that was handed out never changes";
  EXPECT_EQ(differences(*applied(mesh, {gone(1)}).world, *before), "");
  EXPECT_EQ(mesh.obstacleCount(), 0u);
}

TEST(LiveMesh, BuildsOnlyTheTilesThatAnObstacleTouches) {
  LiveMesh mesh = made(flatFloor(20.0f, 20.0f), tiled(5.0f));
  EXPECT_EQ(mesh.tileCount(), 25u);  // the grid begins half a cell before the floor
  CylinderObstacle pillar{{7.5f, 0.0f, 7.5f}, 0.3f, 2.0f};
  EXPECT_EQ(applied(mesh, {put(1, pillar)}).tilesBuilt, 1u);
  EXPECT_EQ(applied(mesh, {put(1, pillar)}).tilesBuilt, 0u) << "it did not move";
  pillar.foot = {10.0f, 0.0f, 10.0f};
  EXPECT_EQ(applied(mesh, {put(1, pillar)}).tilesBuilt, 4u)
      << "four at its corner, one of them old";
  pillar.foot = {100.0f, 0.0f, 100.0f};
  EXPECT_EQ(applied(mesh, {put(1, pillar)}).tilesBuilt, 4u);
  pillar.foot = {-100.0f, 0.0f, 3.0f};
  EXPECT_EQ(applied(mesh, {put(1, pillar)}).tilesBuilt, 0u);
}

TEST(LiveMesh, KeepsTheWalkersRadiusFromAnyObstacle) {
  std::mt19937_64 rng(6);
  const BuildSettings settings = tiled(4.0f);
  const double clearance = settings.radius - settings.edgeError;
  double nearest = std::numeric_limits<double>::infinity();
  for (int trial = 0; trial < 12; ++trial) {
    LiveMesh mesh = made(flatFloor(8.0f, 8.0f), settings);
    std::vector<Obstacle> obstacles;
    std::vector<ObstacleChange> changes;
    for (std::uint32_t i = 0; i < 6; ++i) {
      obstacles.push_back(testing::randomObstacle(rng, {{1, 0.8f, 1}, {7, 0.8f, 7}}, 1.5));
      changes.push_back(put(i, obstacles.back()));
    }
    const auto world = applied(mesh, changes).world;
    for (int i = 0; i < 3000; ++i) {
      const glm::vec2 plan{uniform(rng, 0.5, 7.5), -uniform(rng, 0.5, 7.5)};
      double away = std::numeric_limits<double>::infinity();
      for (const Obstacle& obstacle : obstacles) {
        const ObstacleOutline outline = outlineOf(obstacle);
        if (outline.top > settings.climb) away = std::min(away, distanceTo(obstacle, plan));
      }
      if (onGround(*world, toSpace(plan, 0.0f))) {
        nearest = std::min(nearest, away);
        ASSERT_GE(away, clearance) << trial << ": " << plan.x << ", " << plan.y;
      } else {
        // No more is taken than the radius, rounded up to cells, with its cells and border error.
        ASSERT_LE(away, settings.radius + 3.0 * settings.cell + settings.edgeError) << trial;
      }
    }
  }
  EXPECT_LT(nearest, settings.radius + settings.cell) << "the walker comes close";
}

TEST(LiveMesh, LetsTheWalkerStepOverPassUnderAndStayOnAnotherStorey) {
  BuildSettings settings = tiled(4.0f);
  const Scene scene = BlockScene("storeys")
                          .floor({0.0f, 0.0f, 8.0f, 8.0f})
                          .floor({0.0f, 0.0f, 8.0f, 8.0f}, 3.0f)
                          .scene();
  LiveMesh mesh = made(scene, settings);
  const auto takes = [&](float bottom, float top, float ground) {
    const PrismObstacle slab{{{3, -5}, {5, -5}, {5, -3}, {3, -3}}, bottom, top};
    const bool taken = !onGround(*applied(mesh, {put(1, slab)}).world, {4.0f, ground, 4.0f});
    applied(mesh, {gone(1)});
    return taken;
  };
  EXPECT_TRUE(takes(0.0f, 1.0f, 0.0f));
  EXPECT_FALSE(takes(0.0f, 1.0f, 3.0f)) << "the floor above stays";
  EXPECT_FALSE(takes(3.0f, 4.0f, 0.0f)) << "the floor below stays";
  EXPECT_TRUE(takes(3.0f, 4.0f, 3.0f));
  EXPECT_FALSE(takes(0.0f, settings.climb, 0.0f)) << "as high as a step";
  EXPECT_TRUE(takes(0.0f, settings.climb + 0.05f, 0.0f));
  EXPECT_FALSE(takes(settings.height, 2.5f, 0.0f)) << "as high as the walker";
  EXPECT_TRUE(takes(settings.height - 0.05f, 2.5f, 0.0f));
  EXPECT_TRUE(takes(-9.0f, 9.0f, 0.0f) && takes(-9.0f, 9.0f, 3.0f));
}

TEST(LiveMesh, ClosesADoorWhileSomebodyStandsInIt) {
  LiveMesh mesh = made(testing::twoRooms(1.2f), tiled(4.0f));
  const glm::vec3 here{3.0f, 0.0f, 2.0f}, there{9.0f, 0.0f, 2.0f};
  ASSERT_TRUE(connected(*mesh.world(), here, there));
  const CylinderObstacle person{{6.1f, 0.0f, 2.0f}, 0.3f, 1.8f};
  EXPECT_FALSE(connected(*applied(mesh, {put(1, person)}).world, here, there));
  EXPECT_TRUE(connected(*applied(mesh, {gone(1)}).world, here, there));
}

TEST(LiveMesh, MayLoseAllGroundAndGetItBack) {
  LiveMesh mesh = made(flatFloor(6.0f, 6.0f), tiled(3.0f));
  const auto before = mesh.world();
  const PrismObstacle flood{{{-9, -9}, {9, -9}, {9, 9}, {-9, 9}}, -1.0f, 2.0f};
  const auto none = applied(mesh, {put(1, flood)}).world;
  EXPECT_EQ(none->graph.polygonCount(), 0u);
  EXPECT_FALSE(locate(none->graph, none->locations, {3.0f, 0.0f, 3.0f}).has_value());
  EXPECT_EQ(differences(*applied(mesh, {gone(1)}).world, *before), "");
}

TEST(LiveMesh, RefusesASetOfChangesAsAWhole) {
  LiveMesh mesh = made(flatFloor(6.0f, 6.0f), tiled(3.0f));
  const auto before = mesh.world();
  CylinderObstacle flat;
  flat.height = 0.0f;
  const auto refused = mesh.apply(std::vector<ObstacleChange>{put(1, kCrate), put(2, flat)});
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().message, HasSubstr("height is 0 m"));
  EXPECT_EQ(mesh.world(), before);
  EXPECT_EQ(mesh.obstacleCount(), 0u);
}

TEST(LiveMesh, CutsTheGroundAlongItsOutlines) {
  const PrismObstacle doorway{
      {{5.5f, -3.1f}, {6.7f, -3.1f}, {6.7f, -0.9f}, {5.5f, -0.9f}}, -0.5f, 2.0f};
  for (const Partition partition : {Partition::kWatershed, Partition::kMonotone}) {
    BuildSettings settings = tiled(5.0f);
    settings.partition = partition;
    LiveMesh mesh = made(testing::twoRooms(1.4f), settings, {doorway});
    const NavGraph& graph = mesh.world()->graph;
    EXPECT_TRUE(connected(*mesh.world(), {3.0f, 0.0f, 2.0f}, {9.0f, 0.0f, 2.0f}));
    const LiveMesh uncut = made(testing::twoRooms(1.4f), settings);
    EXPECT_NEAR(areaOf(*mesh.world()), areaOf(*uncut.world()), 0.2);
    int inside = 0;
    for (std::uint32_t p = 0; p < graph.polygonCount(); ++p) {
      // No corner on one side of the outline while the centroid is well on the other.
      const bool in = distanceTo(doorway, graph.centroid[p]) == 0.0;
      inside += in ? 1 : 0;
      for (const glm::vec2 corner : graph.ringOf(PolygonId{p})) {
        if (in) {
          EXPECT_LE(distanceTo(doorway, corner), settings.edgeError + settings.cell);
        } else {
          const float within =
              std::min({corner.x - 5.5f, 6.7f - corner.x, corner.y + 3.1f, -0.9f - corner.y});
          EXPECT_LE(within, settings.edgeError + settings.cell)
              << "partition " << static_cast<int>(partition) << ", polygon " << p << " at "
              << corner.x << ", " << corner.y;
        }
      }
    }
    EXPECT_GT(inside, 0);
  }
  BuildSettings layers = tiled(5.0f);
  layers.partition = Partition::kLayers;
  const auto refused =
      LiveMesh::make(testing::twoRooms(1.4f), layers, std::vector<Obstacle>{doorway});
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().message, HasSubstr("watershed or monotone"));
}

TEST(LiveMesh, IsTheSameWhateverTheOrderOfChangesAndThreads) {
  std::mt19937_64 rng(7);
  const Scene scene = testing::twoStoreys();
  std::vector<ObstacleChange> changes;
  for (std::uint32_t i = 0; i < 12; ++i) {
    changes.push_back(put(i, testing::randomObstacle(rng, {{1, 0, 1}, {13, 4, 9}}, 1.5)));
  }
  LiveMesh atOnce = made(scene, tiled(4.0f));
  applied(atOnce, changes);
  LiveMesh oneByOne = made(scene, tiled(4.0f));
  std::reverse(changes.begin(), changes.end());
  for (const ObstacleChange& change : changes) applied(oneByOne, {change});
  EXPECT_EQ(differences(*atOnce.world(), *oneByOne.world()), "");
  LiveMesh backwards = made(scene, tiled(4.0f));
  BuildRun run;
  run.forEach = [](std::size_t count, const std::function<void(std::size_t)>& work) {
    for (std::size_t i = count; i-- > 0;) work(i);
  };
  ASSERT_TRUE(backwards.apply(changes, run));
  EXPECT_EQ(differences(*atOnce.world(), *backwards.world()), "");
}

// The law of the whole file: after any number of changes nothing is left of the way there. Coarse
// cells, so that ten thousand changes are seconds.
TEST(LiveMesh, EqualsARebuildAfterTenThousandRandomChangesAndLeaksNothing) {
  constexpr int kChanges = 10000;
  std::mt19937_64 rng(8);
  const Scene scene = testing::twoStoreys();
  const BuildSettings settings = tiled(4.0f, 0.2f);
  LiveMesh mesh = made(scene, settings);
  std::map<ObstacleId, Obstacle> there;
  std::vector<std::weak_ptr<const World>> worlds{mesh.world()};
  int done = 0, sets = 0;
  while (done < kChanges) {
    std::vector<ObstacleChange> changes;
    for (int n = 1 + uniformInt(rng, 12); n > 0; --n) {
      const auto id = static_cast<std::uint32_t>(uniformInt(rng, 16));
      if (uniformInt(rng, 3) == 0) {
        changes.push_back(gone(id));
        there.erase(ObstacleId{id});
      } else {
        changes.push_back(put(id, testing::randomObstacle(rng, {{0, 0, 0}, {14, 4, 10}}, 1.5)));
        there.insert_or_assign(ObstacleId{id}, *changes.back().obstacle);
      }
    }
    done += static_cast<int>(changes.size());
    const auto world = applied(mesh, changes).world;
    if (worlds.back().lock() != world) worlds.push_back(world);
    if (++sets % 100 == 0 || done >= kChanges) {
      ASSERT_EQ(differences(*world, rebuilt(scene, settings, there)), "") << done << " changes";
      LiveMesh fresh = made(scene, settings);
      std::vector<ObstacleChange> all;
      for (const auto& [id, obstacle] : there) all.push_back({id, obstacle});
      ASSERT_EQ(differences(*world, *applied(fresh, all).world), "") << done << " changes";
    }
  }
  EXPECT_EQ(mesh.obstacleCount(), there.size());
  const auto alive = std::count_if(worlds.begin(), worlds.end(),
                                   [](const auto& world) { return !world.expired(); });
  EXPECT_EQ(alive, 1) << "of " << worlds.size() << " worlds";
}

}  // namespace
}  // namespace forewalk::navmesh
