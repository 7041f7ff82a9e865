#include "navmesh/build/build.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <filesystem>
#include <limits>
#include <map>
#include <numbers>
#include <numeric>
#include <optional>
#include <random>
#include <regex>
#include <set>
#include <thread>

#include "navmesh/nav_graph.h"
#include "navmesh/plan.h"
#include "navmesh/random.h"
#include "tests/support/block_scene.h"

namespace forewalk::navmesh {
namespace {

using forewalk::testing::BlockScene;
using ::testing::AllOf;
using ::testing::HasSubstr;

constexpr Partition kPartitions[] = {Partition::kWatershed, Partition::kMonotone,
                                     Partition::kLayers};

Scene flatFloor(float width = 10.0f, float depth = 8.0f) {
  return BlockScene("floor").floor({0.0f, 0.0f, width, depth}).scene();
}

NavGraph graphOf(const Scene& scene, const BuildSettings& settings = {}) {
  const auto tiles = buildTiles(scene, settings);
  if (!tiles) throw std::runtime_error(tiles.error().message);
  const auto polygons = polygonsFromTiles(*tiles, settings.climb, scene.name);
  if (!polygons) throw std::runtime_error(polygons.error().message);
  auto graph = makeNavGraph(*polygons);
  if (!graph) throw std::runtime_error(graph.error().message);
  return *graph;
}

Error errorOf(const Scene& scene, const BuildSettings& settings = {}) {
  const auto navMesh = buildNavMesh(scene, settings);
  if (navMesh) throw std::runtime_error("the build succeeded");
  return navMesh.error();
}

double areaOf(const NavGraph& graph) {
  double area = 0.0;
  for (std::uint32_t p = 0; p < graph.polygonCount(); ++p) area += areaOf(graph, PolygonId{p});
  return area;
}

/// The polygon under a place by looking at all of them; the surface within 0.5 m of its height.
std::optional<PolygonId> polygonAt(const NavGraph& graph, glm::vec3 place, float tolerance = 0.0f) {
  for (std::uint32_t p = 0; p < graph.polygonCount(); ++p) {
    const glm::vec2 plan = toPlan(place);
    if (contains(graph, PolygonId{p}, plan, tolerance) &&
        std::abs(heightAt(graph, PolygonId{p}, plan) - place.y) < 0.5f) {
      return PolygonId{p};
    }
  }
  return std::nullopt;
}

bool connected(const NavGraph& graph, glm::vec3 a, glm::vec3 b) {
  const auto from = polygonAt(graph, a), to = polygonAt(graph, b);
  if (!from || !to) return false;
  return graph.component[index(*from)] == graph.component[index(*to)];
}

/// A place well inside a random polygon.
glm::vec3 randomPlace(const NavGraph& graph, std::mt19937_64& rng) {
  const PolygonId polygon{
      static_cast<std::uint32_t>(uniformInt(rng, static_cast<int>(graph.polygonCount())))};
  glm::vec2 plan(0.0f);
  float sum = 0.0f;
  for (const glm::vec2 corner : graph.ringOf(polygon)) {
    const auto weight = static_cast<float>(uniform(rng, 0.01, 1.0));
    plan += weight * corner;
    sum += weight;
  }
  plan /= sum;
  return toSpace(plan, heightAt(graph, polygon, plan));
}

/// Places of one navmesh lie on the other, and what is connected in one is connected in the other.
void expectSameWalkableWorld(const NavGraph& one, const NavGraph& other, float cell) {
  EXPECT_NEAR(areaOf(one), areaOf(other), 0.02 * areaOf(one));
  EXPECT_EQ(one.componentCount, other.componentCount);
  std::mt19937_64 rng(7);
  std::map<std::uint32_t, std::uint32_t> partner;
  std::set<std::uint32_t> taken;
  for (int i = 0; i < 400; ++i) {
    const bool fromOne = i % 2 == 0;
    const glm::vec3 place = randomPlace(fromOne ? one : other, rng);
    // Contours are simplified by up to 1.3 cells, in each navmesh in its own way.
    const auto a = polygonAt(one, place, 2.0f * cell), b = polygonAt(other, place, 2.0f * cell);
    ASSERT_TRUE(a && b) << place.x << " " << place.y << " " << place.z;
    const std::uint32_t mine = one.component[index(*a)], theirs = other.component[index(*b)];
    const auto [entry, isNew] = partner.try_emplace(mine, theirs);
    EXPECT_EQ(entry->second, theirs);
    if (isNew) {
      EXPECT_TRUE(taken.insert(theirs).second);
    }
  }
}

Scene turnedByQuarter(Scene scene) {
  for (glm::vec3& vertex : scene.vertices) vertex = {vertex.z, vertex.y, -vertex.x};
  return scene;
}

Scene mirrored(Scene scene) {
  for (glm::vec3& vertex : scene.vertices) vertex.x = -vertex.x;
  for (glm::uvec3& triangle : scene.triangles) std::swap(triangle.y, triangle.z);
  return scene;
}

/// The number in `message` that `pattern` captures.
float numberIn(const std::string& message, const char* pattern) {
  std::smatch match;
  if (!std::regex_search(message, match, std::regex(pattern))) {
    throw std::runtime_error("no such number in: " + message);
  }
  return std::stof(match[1]);
}

void inReverse(std::size_t count, const std::function<void(std::size_t)>& work) {
  for (std::size_t i = count; i-- > 0;) work(i);
}

void shuffled(std::size_t count, const std::function<void(std::size_t)>& work) {
  std::vector<std::size_t> order(count);
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::mt19937_64 rng(3);
  for (std::size_t i = count; i > 1; --i) {
    std::swap(order[i - 1], order[static_cast<std::size_t>(uniformInt(rng, static_cast<int>(i)))]);
  }
  for (const std::size_t i : order) work(i);
}

void onFourThreads(std::size_t count, const std::function<void(std::size_t)>& work) {
  std::atomic<std::size_t> next{0};
  std::vector<std::thread> threads;
  for (int t = 0; t < 4; ++t) {
    threads.emplace_back([&] {
      for (std::size_t i = next++; i < count; i = next++) work(i);
    });
  }
  for (std::thread& thread : threads) thread.join();
}

// ---- What cannot be built

TEST(BuildNavMesh, RefusesASceneWithoutTriangles) {
  Scene scene;
  scene.name = "nothing.obj";
  EXPECT_EQ(errorOf(scene).code, ErrorCode::kSceneEmpty);
  EXPECT_THAT(errorOf(scene).message, HasSubstr("nothing.obj"));
  scene.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 0, 1}};
  EXPECT_EQ(errorOf(scene).code, ErrorCode::kSceneEmpty);
}

TEST(BuildNavMesh, RefusesVerticesThatAreNoPlaces) {
  for (const float bad :
       {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
    for (int axis = 0; axis < 3; ++axis) {
      Scene scene = flatFloor();
      scene.vertices[2][axis] = bad;
      EXPECT_EQ(errorOf(scene).code, ErrorCode::kDataDamaged);
      EXPECT_THAT(errorOf(scene).message, HasSubstr("vertex 2"));
    }
  }
}

TEST(BuildNavMesh, RefusesTrianglesThatNameVerticesTheSceneDoesNotHave) {
  Scene scene = flatFloor();
  scene.triangles[1].y = 4;
  EXPECT_EQ(errorOf(scene).code, ErrorCode::kDataDamaged);
  EXPECT_THAT(errorOf(scene).message, AllOf(HasSubstr("triangle 1"), HasSubstr("vertex 4")));
}

TEST(BuildNavMesh, NamesEverySettingThatIsOutOfItsRange) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const float infinity = std::numeric_limits<float>::infinity();
  struct Case {
    const char* name;
    float BuildSettings::*setting;
    std::vector<float> bad;
  };
  const Case cases[] = {
      {"radius", &BuildSettings::radius, {-0.1f, nan, infinity}},
      {"height", &BuildSettings::height, {0.0f, -1.0f, nan, infinity}},
      {"climb", &BuildSettings::climb, {-0.1f, 1.8f, nan, infinity}},
      {"slope", &BuildSettings::slope, {-0.1f, 1.5708f, nan, infinity}},
      {"cell", &BuildSettings::cell, {0.0f, -0.1f, 1e-4f, nan, infinity}},
      {"cellHeight", &BuildSettings::cellHeight, {0.0f, -0.1f, 1e-4f, 1.0f, nan, infinity}},
      {"regionMin", &BuildSettings::regionMin, {-0.1f, nan, infinity}},
      {"regionMerge", &BuildSettings::regionMerge, {-0.1f, nan, infinity}},
      {"edgeMax", &BuildSettings::edgeMax, {-0.1f, nan, infinity}},
      {"edgeError", &BuildSettings::edgeError, {-0.1f, nan, infinity}},
      {"detailSample", &BuildSettings::detailSample, {-0.1f, 0.05f, nan, infinity}},
      {"detailError", &BuildSettings::detailError, {-0.1f, nan, infinity}},
      {"tile", &BuildSettings::tile, {-1.0f, 0.5f, 1e6f, nan, infinity}},
  };
  for (const Case& c : cases) {
    for (const float bad : c.bad) {
      BuildSettings settings;
      settings.*c.setting = bad;
      const Error error = errorOf(flatFloor(), settings);
      EXPECT_EQ(error.code, ErrorCode::kSettingOutOfRange) << c.name << " " << bad;
      EXPECT_EQ(error.message.rfind(std::string(c.name) + " is ", 0), 0u) << error.message;
      EXPECT_FALSE(checkSettings(settings));
    }
  }
  for (const std::uint32_t corners : {0u, 2u, 7u}) {
    BuildSettings settings;
    settings.cornersMax = corners;
    EXPECT_THAT(errorOf(flatFloor(), settings).message, HasSubstr("cornersMax"));
  }
  BuildSettings settings;
  settings.partition = static_cast<Partition>(3);
  EXPECT_THAT(errorOf(flatFloor(), settings).message, HasSubstr("partition"));
  EXPECT_TRUE(checkSettings(BuildSettings{}));
}

TEST(BuildNavMesh, AcceptsTheEndsOfEveryRange) {
  BuildSettings settings;
  settings.radius = settings.climb = settings.slope = settings.regionMin = settings.regionMerge =
      settings.edgeMax = settings.edgeError = settings.detailSample = settings.detailError = 0.0f;
  settings.cornersMax = 3;
  EXPECT_TRUE(buildNavMesh(flatFloor(), settings));
}

TEST(BuildNavMesh, NamesCellAndTileWhereTheGridIsTooLarge) {
  const Error solo = errorOf(flatFloor(5000.0f, 5000.0f));
  EXPECT_EQ(solo.code, ErrorCode::kTooLarge);
  EXPECT_THAT(solo.message, AllOf(HasSubstr("cell"), HasSubstr("tile")));
  const Error world = errorOf(flatFloor(1e6f, 10.0f));
  EXPECT_EQ(world.code, ErrorCode::kTooLarge);
  EXPECT_THAT(world.message, HasSubstr("cell"));
  BuildSettings settings;
  settings.tile = 6.4f;
  const Error tiled = errorOf(flatFloor(9000.0f, 9000.0f), settings);
  EXPECT_EQ(tiled.code, ErrorCode::kTooLarge);
  EXPECT_THAT(tiled.message, HasSubstr("tile"));
}

TEST(BuildNavMesh, NamesTheCellHeightThatATowerNeeds) {
  const Scene tower =
      BlockScene("tower").floor({0, 0, 10, 10}).floor({0, 0, 10, 10}, 1000.0f).scene();
  const Error error = errorOf(tower);
  EXPECT_EQ(error.code, ErrorCode::kTooLarge);
  BuildSettings settings;
  settings.cellHeight = numberIn(error.message, "cellHeight to ([0-9.]+) m");
  EXPECT_TRUE(buildNavMesh(tower, settings));
}

// ---- Nothing walkable: the message names the setting, and the value it names opens the scene

TEST(NothingWalkable, IsTheSlopeWhereAllGroundIsSteep) {
  const Scene steep =
      BlockScene("ramp").ramp({0.0f, 0.0f, 5.0f, 4.0f}, 0.0f, 5.0f * std::sqrt(3.0f)).scene();
  BuildSettings settings;
  settings.cellHeight = 0.1f;
  settings.climb = 0.6f;
  const Error error = errorOf(steep, settings);
  EXPECT_EQ(error.code, ErrorCode::kNothingWalkable);
  EXPECT_THAT(error.message, HasSubstr("slope 45.0 degrees"));
  const float flattest = numberIn(error.message, "has ([0-9.]+) degrees");
  EXPECT_NEAR(flattest, 60.0f, 0.05f);
  settings.slope = (flattest + 0.1f) * std::numbers::pi_v<float> / 180.0f;
  EXPECT_TRUE(buildNavMesh(steep, settings));
}

TEST(NothingWalkable, IsTheWindingWhereNothingFacesUp) {
  Scene scene = flatFloor();
  for (glm::uvec3& triangle : scene.triangles) std::swap(triangle.x, triangle.y);
  const Error error = errorOf(scene);
  EXPECT_EQ(error.code, ErrorCode::kNothingWalkable);
  EXPECT_THAT(error.message, HasSubstr("faces up"));
}

TEST(NothingWalkable, IsTheHeightUnderALowCeiling) {
  const Scene crawlway = BlockScene("crawlway")
                             .floor({0, 0, 10, 10})
                             .ramp({-1, -1, 11, 11}, 1.2f, 14.0f)  // steep, and above all ground
                             .scene();
  BuildSettings settings;
  settings.height = 20.0f;
  settings.cellHeight = 0.1f;
  const Error error = errorOf(crawlway, settings);
  EXPECT_EQ(error.code, ErrorCode::kNothingWalkable);
  EXPECT_THAT(error.message, HasSubstr("height 20.00 m"));
  settings.height = numberIn(error.message, "above it is ([0-9.]+) m") - 2.0f;
  EXPECT_TRUE(buildNavMesh(crawlway, settings));
}

TEST(NothingWalkable, IsTheClimbWhereAllGroundIsARampSteeperThanAStep) {
  const Scene ramp = BlockScene("ramp").ramp({0, 0, 8, 4}, 0.0f, 4.0f).scene();
  BuildSettings settings;
  settings.climb = 0.0f;
  const Error error = errorOf(ramp, settings);
  EXPECT_EQ(error.code, ErrorCode::kNothingWalkable);
  EXPECT_THAT(error.message, HasSubstr("climb 0.00 m"));
  settings.climb = numberIn(error.message, "([0-9.]+) m would open it");
  EXPECT_TRUE(buildNavMesh(ramp, settings)) << error.message;
}

TEST(NothingWalkable, IsTheRadiusInANarrowCorridor) {
  for (const float tile : {0.0f, 6.4f}) {
    const Scene corridor = flatFloor(30.0f, 1.1f);
    BuildSettings settings;
    settings.tile = tile;
    settings.radius = 0.65f;
    const Error error = errorOf(corridor, settings);
    EXPECT_EQ(error.code, ErrorCode::kNothingWalkable);
    EXPECT_THAT(error.message, HasSubstr("radius 0.65 m"));
    const float fits = numberIn(error.message, "place ([0-9.]+) m fits");
    settings.radius = fits;
    EXPECT_TRUE(buildNavMesh(corridor, settings)) << error.message;
    settings.radius = fits + 0.05f;
    EXPECT_FALSE(buildNavMesh(corridor, settings)) << error.message;
  }
}

TEST(NothingWalkable, IsTheRegionSizeOnASmallIsland) {
  for (const Partition partition : kPartitions) {
    const Scene small = flatFloor(1.5f, 1.5f);
    BuildSettings settings;
    settings.partition = partition;
    settings.regionMin = 5.0f;
    const Error error = errorOf(small, settings);
    EXPECT_EQ(error.code, ErrorCode::kNothingWalkable);
    EXPECT_THAT(error.message, HasSubstr("regionMin 5.00 m^2"));
    const float piece = numberIn(error.message, "piece has ([0-9.]+) m");
    settings.regionMin = piece - 0.005f;
    EXPECT_TRUE(buildNavMesh(small, settings)) << error.message;
    settings.regionMin = piece + 0.02f;
    EXPECT_FALSE(buildNavMesh(small, settings)) << error.message;
  }
}

TEST(NothingWalkable, IsTheCellWhereAPlankIsNarrowerThanTwo) {
  BuildSettings settings;
  settings.radius = 0.0f;
  settings.regionMin = 0.0f;
  const Error error = errorOf(flatFloor(5.0f, 0.1f), settings);
  EXPECT_EQ(error.code, ErrorCode::kNothingWalkable);
  EXPECT_THAT(error.message, HasSubstr("cell 0.1 m"));
}

TEST(NothingWalkable, IsNoErrorWhileOneTileHasGround) {
  BuildSettings settings;
  settings.tile = 6.4f;
  const Scene spread =
      BlockScene("spread").floor({0, 0, 4, 4}).floor({100.0f, 100.0f, 100.2f, 100.2f}).scene();
  const auto tiles = buildTiles(spread, settings);
  ASSERT_TRUE(tiles);
  EXPECT_EQ(tiles->size(), 1u);
}

// ---- What is built

TEST(BuildNavMesh, LeavesOutTheWalkersRadiusAlongTheBorder) {
  for (const float radius : {0.0f, 0.2f, 0.5f, 1.0f}) {
    BuildSettings settings;
    settings.radius = radius;
    const NavGraph graph = graphOf(flatFloor(10.0f, 8.0f), settings);
    // The rim of cells falls to the ledge; the rest is exact.
    const double rim = std::max(radius, 0.1f);
    EXPECT_NEAR(areaOf(graph), (10.0 - 2.0 * rim) * (8.0 - 2.0 * rim), 0.2 * 36.0) << radius;
    EXPECT_LE(areaOf(graph), (10.0 - 2.0 * radius + 0.11) * (8.0 - 2.0 * radius + 0.11));
    EXPECT_EQ(graph.componentCount, 1u);
  }
}

TEST(BuildNavMesh, PutsFloorsWhereTheyAre) {
  for (const float y : {-7.0f, 0.0f, 1.0f, 3.3f}) {
    const Scene scene =
        BlockScene("floors").floor({0, 0, 6, 6}, y).floor({7, 0, 13, 6}, y + 3.15f).scene();
    const NavGraph graph = graphOf(scene);
    ASSERT_EQ(graph.componentCount, 2u);
    for (std::uint32_t p = 0; p < graph.polygonCount(); ++p) {
      const float expected = graph.centroid[p].x < 6.5f ? y : y + 3.15f;
      EXPECT_NEAR(heightAt(graph, PolygonId{p}, graph.centroid[p]), expected, 1e-3f);
    }
  }
}

TEST(BuildNavMesh, KeepsTheHeightOfUnevenGround) {
  const Scene hill =
      BlockScene("hill").ramp({0, 0, 8, 6}, 0.0f, 3.0f).ramp({8, 0, 16, 6}, 3.0f, 0.0f).scene();
  const NavGraph graph = graphOf(hill);
  std::mt19937_64 rng(5);
  for (int i = 0; i < 300; ++i) {
    const glm::vec3 place = randomPlace(graph, rng);
    const float truth = 3.0f / 8.0f * (place.x < 8.0f ? place.x : 16.0f - place.x);
    // A voxel, the rise over a cell, and detailError.
    EXPECT_NEAR(place.y, truth, 0.05f + 0.04f + 0.05f) << place.x;
  }
}

TEST(BuildNavMesh, WalksARampOf30DegreesButNotOf60) {
  for (const float angle : {30.0f, 60.0f}) {
    const float rise = 2.4f;
    const float run = rise / std::tan(angle * std::numbers::pi_v<float> / 180.0f);
    const Scene scene = BlockScene("ramp")
                            .floor({-5, 0, 0, 4})
                            .ramp({0, 0, run, 4}, 0.0f, rise)
                            .floor({run, 0, run + 5, 4}, rise)
                            .scene();
    const NavGraph graph = graphOf(scene);
    EXPECT_EQ(connected(graph, {-2, 0, 2}, {run + 2, rise, 2}), angle == 30.0f);
    EXPECT_EQ(graph.componentCount, angle == 30.0f ? 1u : 2u);
  }
}

TEST(BuildNavMesh, PassesADoorThatIsWiderThanTheWalkerAndNoOther) {
  for (const float tile : {0.0f, 3.2f}) {
    BuildSettings settings;
    settings.tile = tile;
    EXPECT_TRUE(connected(graphOf(testing::twoRooms(0.9f), settings), {2, 0, 2}, {10, 0, 2}));
    EXPECT_TRUE(connected(graphOf(testing::twoRooms(1.5f), settings), {2, 0, 2}, {10, 0, 2}));
    const NavGraph closed = graphOf(testing::twoRooms(0.45f), settings);
    EXPECT_EQ(closed.componentCount, 2u);
    EXPECT_FALSE(connected(closed, {2, 0, 2}, {10, 0, 2}));
    settings.radius = 0.5f;
    EXPECT_FALSE(connected(graphOf(testing::twoRooms(0.9f), settings), {2, 0, 2}, {10, 0, 2}));
  }
}

TEST(BuildNavMesh, ClimbsStairsToTheUpperStorey) {
  for (const Partition partition : kPartitions) {
    for (const float tile : {0.0f, 3.2f, 5.0f}) {
      BuildSettings settings;
      settings.partition = partition;
      settings.tile = tile;
      const NavGraph graph = graphOf(testing::twoStoreys(), settings);
      EXPECT_EQ(graph.componentCount, 1u);
      EXPECT_TRUE(connected(graph, {10, 0, 2}, {10, 3, 2}));
      settings.climb = 0.2f;  // the steps are 0.25 m
      const NavGraph apart = graphOf(testing::twoStoreys(), settings);
      EXPECT_FALSE(connected(apart, {10, 0, 2}, {10, 3, 2}));
    }
  }
}

TEST(BuildNavMesh, KeepsIslandsApartAndDropsTheSmallest) {
  for (const Partition partition : kPartitions) {
    BuildSettings settings;
    settings.partition = partition;
    EXPECT_EQ(graphOf(testing::islands(), settings).componentCount, 3u);
    settings.regionMin = 0.1f;
    EXPECT_EQ(graphOf(testing::islands(), settings).componentCount, 4u);
  }
}

TEST(BuildNavMesh, FindsTheSameGroundWhenTheSceneIsTurnedOrMirrored) {
  for (const Scene& scene : {testing::twoStoreys(), testing::twoRooms(0.9f), testing::islands()}) {
    const NavGraph graph = graphOf(scene);
    Scene turned = scene;
    for (int quarter = 0; quarter < 3; ++quarter) {
      turned = turnedByQuarter(turned);
      const NavGraph other = graphOf(turned);
      EXPECT_NEAR(areaOf(other), areaOf(graph), 0.02 * areaOf(graph));
      EXPECT_EQ(other.componentCount, graph.componentCount);
    }
    const NavGraph other = graphOf(mirrored(scene));
    EXPECT_NEAR(areaOf(other), areaOf(graph), 0.02 * areaOf(graph));
    EXPECT_EQ(other.componentCount, graph.componentCount);
  }
}

TEST(BuildNavMesh, GivesAValidNavMeshThatKnowsItsSettings) {
  for (const Scene& scene : {testing::twoStoreys(), testing::twoRooms(0.9f), testing::islands()}) {
    for (const float tile : {0.0f, 3.2f}) {
      BuildSettings settings;
      settings.tile = tile;
      const auto navMesh = buildNavMesh(scene, settings);
      ASSERT_TRUE(navMesh) << navMesh.error().message;
      EXPECT_EQ(navMesh->settings, settings);
      const auto valid = validate(*navMesh);
      EXPECT_TRUE(valid) << valid.error().message;
    }
  }
}

// ---- Tiles

TEST(Tiles, GiveTheWorldThatOnePieceGives) {
  for (const Scene& scene : {testing::twoStoreys(), testing::twoRooms(0.9f), testing::islands()}) {
    for (const Partition partition : kPartitions) {
      BuildSettings settings;
      settings.partition = partition;
      settings.regionMin = 0.1f;
      const NavGraph solo = graphOf(scene, settings);
      for (const float tile : {1.6f, 3.2f, 5.0f}) {
        settings.tile = tile;
        expectSameWalkableWorld(solo, graphOf(scene, settings), settings.cell);
      }
    }
  }
}

TEST(Tiles, AreTheSameBytesInAnyOrderAndOnAnyThreads) {
  BuildSettings settings;
  settings.tile = 1.6f;
  for (const Scene& scene : {testing::twoStoreys(), testing::islands()}) {
    const auto inTurn = buildTiles(scene, settings);
    ASSERT_TRUE(inTurn);
    ASSERT_GT(inTurn->size(), 4u);
    for (const ForEach& forEach : {ForEach(inReverse), ForEach(shuffled), ForEach(onFourThreads)}) {
      BuildRun run;
      run.forEach = forEach;
      const auto tiles = buildTiles(scene, settings, run);
      ASSERT_TRUE(tiles);
      EXPECT_EQ(*tiles, *inTurn);
    }
  }
}

TEST(Tiles, AreReportedOneByOne) {
  BuildSettings settings;
  settings.tile = 1.6f;
  for (const ForEach& forEach : {ForEach(), ForEach(shuffled), ForEach(onFourThreads)}) {
    BuildRun run;
    run.forEach = forEach;
    std::vector<std::size_t> reports;
    std::size_t all = 0;
    run.progress = [&](std::size_t done, std::size_t total) {
      reports.push_back(done);
      all = total;
    };
    ASSERT_TRUE(buildTiles(testing::twoStoreys(), settings, run));
    ASSERT_EQ(reports.size(), all);
    for (std::size_t i = 0; i < reports.size(); ++i) EXPECT_EQ(reports[i], i + 1);
  }
}

TEST(Tiles, BearTriangleSoupsWithoutComplaint) {
  std::mt19937_64 rng(11);
  for (int round = 0; round < 30; ++round) {
    Scene soup;
    soup.name = "soup";
    const int triangles = 1 + uniformInt(rng, 60);
    for (int i = 0; i < 3 * triangles; ++i) {
      soup.vertices.emplace_back(uniform(rng, -6.0, 6.0), uniform(rng, -1.0, 1.0),
                                 uniform(rng, -6.0, 6.0));
    }
    for (int i = 0; i < triangles; ++i) {
      const auto first = static_cast<std::uint32_t>(3 * i);
      soup.triangles.push_back({first, first + 1, first + 2});
      if (i % 7 == 0) soup.triangles.back().y = first;  // no area
    }
    BuildSettings settings;
    settings.partition = kPartitions[round % 3];
    settings.tile = round % 2 == 0 ? 0.0f : 2.5f;
    settings.radius = 0.1f * static_cast<float>(uniformInt(rng, 4));
    const auto navMesh = buildNavMesh(soup, settings);
    if (!navMesh) {
      EXPECT_EQ(navMesh.error().code, ErrorCode::kNothingWalkable) << navMesh.error().message;
      continue;
    }
    const auto valid = validate(*navMesh);
    EXPECT_TRUE(valid) << valid.error().message;
  }
}

TEST(Tiles, GiveTheWorldThatOnePieceGivesOnARealLevel) {
  const std::filesystem::path file =
      std::filesystem::path(FOREWALK_SHARED_DATA) / "scenes/nav_test.obj";
  if (!std::filesystem::exists(file)) GTEST_SKIP() << file << " is not here";
  const auto scene = importScene(file);
  ASSERT_TRUE(scene) << scene.error().message;
  BuildSettings settings;
  settings.cell = 0.2f;
  settings.cellHeight = 0.1f;
  settings.climb = 0.4f;
  settings.edgeError = 0.26f;
  const NavGraph solo = graphOf(*scene, settings);
  for (const Partition partition : kPartitions) {
    settings.partition = partition;
    settings.tile = 12.8f;
    expectSameWalkableWorld(solo, graphOf(*scene, settings), settings.cell);
    const auto navMesh = buildNavMesh(*scene, settings);
    ASSERT_TRUE(navMesh) << navMesh.error().message;
    const auto valid = validate(*navMesh);
    EXPECT_TRUE(valid) << valid.error().message;
  }
}

}  // namespace
}  // namespace forewalk::navmesh
