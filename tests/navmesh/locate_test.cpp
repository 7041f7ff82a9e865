#include "navmesh/locate.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "navmesh/plan.h"
#include "navmesh/random.h"
#include "tests/support/random_mesh.h"

namespace forewalk::navmesh {

// Beside Location, where gtest finds it.
void PrintTo(const Location& place, std::ostream* out) {
  *out << "polygon " << index(place.polygon) << " at " << place.plan.x << ", " << place.plan.y
       << " height " << place.height << (place.snapped ? " snapped" : "");
}

namespace {

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();

struct World {
  explicit World(const PolygonMesh& mesh)
      : graph(*makeNavGraph(mesh)), index(makeLocationIndex(graph)) {}

  NavGraph graph;
  LocationIndex index;
};

glm::vec2 randomPlan(std::mt19937_64& rng, glm::vec2 low, glm::vec2 high) {
  const auto x = static_cast<float>(uniform(rng));
  const auto y = static_cast<float>(uniform(rng));
  return low + glm::vec2(x, y) * (high - low);
}

// A walker who turns at random, a frame at a time.
class RandomWalk {
 public:
  RandomWalk(std::uint64_t seed, glm::vec2 start, float step)
      : rng_(seed), plan_(start), step_(step) {}

  glm::vec2 next() {
    heading_ += static_cast<float>(uniform(rng_, -0.3, 0.3));
    plan_ += step_ * directionOf(heading_);
    return plan_;
  }
  void goTo(glm::vec2 plan) {
    plan_ = plan;
    heading_ += 1.0f;
  }

 private:
  std::mt19937_64 rng_;
  glm::vec2 plan_;
  float step_;
  float heading_ = 0.0f;
};

TEST(Locate, FindsNothingWhereThereIsNothing) {
  const NavGraph graph;
  const LocationIndex index = makeLocationIndex(graph);
  EXPECT_FALSE(locate(graph, index, {0.0f, 0.0f, 0.0f}));
  EXPECT_FALSE(locateFrom(graph, index, Location{}, {0.0f, 0.0f, 0.0f}));
}

TEST(Locate, FindsNothingAtCoordinatesThatAreNotFinite) {
  const World world(testing::gridMesh(4, 4));
  const Location last{PolygonId{5}, {1.5f, 1.5f}, 0.0f, false};
  for (const float wild : {kNaN, kInfinity, -kInfinity}) {
    for (int axis = 0; axis < 3; ++axis) {
      glm::vec3 position = toSpace({1.5f, 1.5f}, 1.7f);
      position[axis] = wild;
      EXPECT_FALSE(locate(world.graph, world.index, position));
      EXPECT_FALSE(locateFrom(world.graph, world.index, last, position));
    }
  }
  EXPECT_FALSE(locate(world.graph, world.index, {1e30f, 0.0f, -1e30f}));
}

TEST(Locate, TakesTheSmallestIdWhereSeveralPolygonsMeet) {
  const World world(testing::gridMesh(2, 2));
  EXPECT_EQ(locate(world.graph, world.index, toSpace({1.0f, 1.0f}, 0.0f))->polygon, PolygonId{0});
  EXPECT_EQ(locate(world.graph, world.index, toSpace({1.0f, 1.5f}, 0.0f))->polygon, PolygonId{2});
}

// The nearest point of a polygon, in double precision.
glm::dvec2 nearestInPolygon(const NavGraph& graph, PolygonId polygon, glm::vec2 plan) {
  const glm::dvec2 p(plan);
  if (contains(graph, polygon, plan)) return p;
  const auto ring = graph.ringOf(polygon);
  glm::dvec2 nearest(ring[0]);
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const glm::dvec2 a(ring[i]), b(ring[(i + 1) % ring.size()]);
    const double t = std::clamp(glm::dot(p - a, b - a) / glm::dot(b - a, b - a), 0.0, 1.0);
    const glm::dvec2 point = glm::mix(a, b, t);
    if (glm::distance(point, p) < glm::distance(nearest, p)) nearest = point;
  }
  return nearest;
}

double distanceToPolygon(const NavGraph& graph, PolygonId polygon, glm::vec2 plan) {
  return glm::distance(nearestInPolygon(graph, polygon, plan), glm::dvec2(plan));
}

TEST(Locate, AgreesWithBruteForceOnAndBesideTheNavmesh) {
  testing::RandomMeshOptions holes;
  holes.holeShare = 0.4;
  const auto ground = [](glm::dvec2 plan) { return 0.2 * plan.x - 0.1 * plan.y; };
  int compared = 0;
  for (std::uint64_t seed = 0; seed < 6; ++seed) {
    PolygonMesh mesh = testing::joinedAlong(testing::randomMesh(seed, 9, 8, holes),
                                            testing::randomMesh(seed + 50, 7, 8, holes));
    for (glm::vec3& v : mesh.vertices) v.y = static_cast<float>(ground(glm::dvec2(toPlan(v))));
    const World world(mesh);
    std::mt19937_64 rng(seed);
    for (int i = 0; i < 1500; ++i) {
      const glm::vec2 plan = randomPlan(rng, {-1.5f, -1.5f}, {17.5f, 9.5f});
      const glm::vec3 position = toSpace(plan, static_cast<float>(uniform(rng, -1.5, 6.0)));
      SnapLimits limits;
      limits.distance = static_cast<float>(uniform(rng, 0.0, 3.0));
      const auto place = locate(world.graph, world.index, position, limits);

      double best = std::numeric_limits<double>::infinity();
      bool clear = true;  // of the limits, by more than rounding
      for (std::uint32_t p = 0; p < world.graph.polygonCount(); ++p) {
        const glm::dvec2 nearest = nearestInPolygon(world.graph, PolygonId{p}, plan);
        const double room =
            static_cast<double>(limits.distance) - glm::distance(nearest, glm::dvec2(plan));
        const double above = ground(nearest) - static_cast<double>(position.y);
        const double below = -above;
        const double roomAbove = static_cast<double>(limits.above) - above;
        const double roomBelow = static_cast<double>(limits.below) - below;
        clear = clear && std::abs(room) > 1e-5 && std::abs(roomAbove) > 1e-5 &&
                std::abs(roomBelow) > 1e-5;
        if (room >= 0.0 && roomAbove >= 0.0 && roomBelow >= 0.0) {
          best = std::min(best, glm::distance(nearest, glm::dvec2(plan)));
        }
      }
      if (!clear) continue;
      ++compared;
      ASSERT_EQ(place.has_value(), std::isfinite(best));
      if (!place) continue;
      EXPECT_NEAR(glm::distance(glm::dvec2(plan), glm::dvec2(place->plan)), best, 1e-5);
      EXPECT_EQ(place->snapped, best > 0.0);
      EXPECT_TRUE(contains(world.graph, place->polygon, place->plan, 1e-5f));
      EXPECT_NEAR(place->height, ground(glm::dvec2(place->plan)), 1e-4);
    }
  }
  EXPECT_GT(compared, 8000);
}

TEST(Locate, MovesNobodyFartherThanTheSnappingDistance) {
  const World world(testing::gridMesh(3, 3));
  SnapLimits limits;
  for (const float distance : {0.0f, 0.1f, 0.5f, 2.0f}) {
    limits.distance = distance;
    EXPECT_TRUE(locate(world.graph, world.index, toSpace({1.5f, 3.0f + distance}, 0.0f), limits));
    EXPECT_FALSE(
        locate(world.graph, world.index, toSpace({1.5f, 3.001f + distance}, 0.0f), limits));
  }
}

TEST(Locate, FindsTheOwnFloorOfAHeadAndOfAFoot) {
  std::mt19937_64 rng(4);
  for (const float storey : {2.6f, 2.8f, 3.0f}) {
    const PolygonMesh floor = testing::randomMesh(1, 8, 8, {.holeShare = 0.1});
    PolygonMesh building = floor;
    for (int level = 1; level < 4; ++level) {
      building =
          testing::together(building, floor, {0.0f, storey * static_cast<float>(level), 0.0f});
    }
    const World world(building);
    const std::uint32_t polygons = world.graph.polygonCount() / 4;
    for (int i = 0; i < 2000; ++i) {
      const int level = uniformInt(rng, 4);
      const float ground = storey * static_cast<float>(level);
      // A foot on the floor to a tall person's head.
      const float height = static_cast<float>(uniform(rng, -0.1, 2.0));
      const glm::vec2 plan = randomPlan(rng, {0, 0}, {8, 8});
      const auto place = locate(world.graph, world.index, toSpace(plan, ground + height));
      if (!place) continue;
      EXPECT_EQ(index(place->polygon) / polygons, static_cast<std::uint32_t>(level)) << height;
      EXPECT_NEAR(place->height, ground, 1e-5f);
    }
  }
}

TEST(Locate, PrefersTheFloorNearestInHeight) {
  const PolygonMesh floor = testing::gridMesh(2, 2);
  const World world(testing::together(floor, floor, {0.0f, 1.0f, 0.0f}));
  SnapLimits both;
  both.below = both.above = 5.0f;
  const auto heightFrom = [&](float height) {
    return locate(world.graph, world.index, toSpace({0.5f, 0.5f}, height), both)->height;
  };
  EXPECT_EQ(heightFrom(0.4f), 0.0f);
  EXPECT_EQ(heightFrom(0.6f), 1.0f);
  EXPECT_EQ(heightFrom(0.5f), 0.0f);  // equally near: the smaller id
}

TEST(LocateFrom, FollowsAWalkerFromPolygonToPolygon) {
  testing::RandomMeshOptions whole;
  whole.holeShare = 0.0;
  for (std::uint64_t seed = 0; seed < 6; ++seed) {
    const World world(testing::joinedAlong(testing::randomMesh(seed, 12, 12, whole),
                                           testing::randomMesh(seed + 1, 8, 12, whole)));
    for (const float step : {0.0155f, 0.3f, 2.5f}) {  // 1.4 m/s at 90 Hz, and two leaps
      RandomWalk walk(seed, {6.0f, 6.0f}, step);
      auto last = locate(world.graph, world.index, toSpace({6.0f, 6.0f}, 1.7f));
      for (int frame = 0; frame < 3000; ++frame) {
        ASSERT_TRUE(last);
        const glm::vec2 plan = walk.next();
        if (plan.x < 0.0f || plan.y < 0.0f || plan.x > 20.0f || plan.y > 12.0f) {
          walk.goTo(last->plan);
          continue;
        }
        last = locateFrom(world.graph, world.index, *last, toSpace(plan, 1.7f));
        ASSERT_TRUE(last);
        ASSERT_TRUE(contains(world.graph, last->polygon, plan));
        ASSERT_EQ(last->plan, plan);
        ASSERT_FALSE(last->snapped);
        ASSERT_NEAR(last->height, heightAt(world.graph, last->polygon, plan), 0.0f);
      }
    }
  }
}

TEST(LocateFrom, WalksAlongPortalsAndThroughCorners) {
  // Every position lies on a grid line or a grid corner, where rounding has the last word.
  const World world(testing::joinedGrids(4, 6, 4, 6.0f));
  for (const glm::vec2 step :
       {glm::vec2(0.25f, 0.0f), glm::vec2(0.0f, 0.25f), glm::vec2(0.25f, 0.25f),
        glm::vec2(0.5f, 0.25f), glm::vec2(-0.25f, 0.25f)}) {
    for (float along = 0.0f; along <= 6.0f; along += 0.5f) {
      glm::vec2 plan = step.x < 0.0f                     ? glm::vec2(10.0f - along, 0.0f)
                       : step.y > 0.0f && step.x == 0.0f ? glm::vec2(along, 0.0f)
                                                         : glm::vec2(0.0f, along);
      auto last = locate(world.graph, world.index, toSpace(plan, 1.0f));
      ASSERT_TRUE(last);
      for (; plan.x >= 0.0f && plan.x <= 10.0f && plan.y >= 0.0f && plan.y <= 6.0f; plan += step) {
        last = locateFrom(world.graph, world.index, *last, toSpace(plan, 1.0f));
        ASSERT_TRUE(last);
        EXPECT_TRUE(contains(world.graph, last->polygon, plan));
        EXPECT_FALSE(last->snapped);
      }
    }
  }
}

TEST(LocateFrom, KeepsAWalkerWhoLeansThroughWallsOnTheNavmesh) {
  testing::RandomMeshOptions holes;
  holes.holeShare = 0.35;
  for (std::uint64_t seed = 0; seed < 6; ++seed) {
    const World world(testing::randomMesh(seed, 12, 12, holes));
    std::mt19937_64 rng(seed);
    auto last = locate(world.graph, world.index, toSpace({6.0f, 6.0f}, 1.7f), {.distance = 9.0f});
    ASSERT_TRUE(last);
    const std::uint32_t component = world.graph.component[index(last->polygon)];
    RandomWalk walk(seed, last->plan, 0.0155f);
    std::size_t snapped = 0;
    for (int frame = 0; frame < 20000; ++frame) {
      const glm::vec2 plan = walk.next();
      const auto place = locateFrom(world.graph, world.index, *last, toSpace(plan, 1.7f));
      ASSERT_TRUE(place);
      ASSERT_TRUE(contains(world.graph, place->polygon, place->plan, 1e-5f));
      ASSERT_EQ(world.graph.component[index(place->polygon)], component);
      const float moved = glm::distance(plan, place->plan);
      ASSERT_LE(moved, SnapLimits{}.distance);
      ASSERT_EQ(place->snapped, moved > 0.0f);
      // Never farther than the polygon that the walker was on.
      ASSERT_LE(static_cast<double>(moved),
                distanceToPolygon(world.graph, last->polygon, plan) + 1e-5);
      snapped += place->snapped ? 1 : 0;
      last = place;
      if (moved > 0.3f) walk.goTo(place->plan);
    }
    EXPECT_GT(snapped, 100u);
    EXPECT_LT(snapped, 19900u);
  }
}

TEST(LocateFrom, StaysInItsRoomWhereAThinWallStandsBetween) {
  // Two rooms with a wall of 0.3 m between them, joined nowhere.
  const PolygonMesh room = testing::gridMesh(3, 3);
  const World world(testing::together(room, room, {3.3f, 0.0f, 0.0f}));
  const Location last = *locate(world.graph, world.index, toSpace({2.9f, 1.5f}, 1.7f));
  for (const float x : {3.1f, 3.2f, 3.29f, 3.35f, 3.45f}) {
    const auto place = locateFrom(world.graph, world.index, last, toSpace({x, 1.5f}, 1.7f));
    ASSERT_TRUE(place);
    EXPECT_EQ(place->polygon, last.polygon) << x;
    EXPECT_EQ(place->plan, glm::vec2(3.0f, 1.5f));
    EXPECT_TRUE(place->snapped);
  }
  // Beyond the snapping distance it is a jump into the other room.
  EXPECT_EQ(locateFrom(world.graph, world.index, last, toSpace({3.9f, 1.5f}, 1.7f)),
            locate(world.graph, world.index, toSpace({3.9f, 1.5f}, 1.7f)));
}

TEST(LocateFrom, StaysOnItsFloorBelowALowGallery) {
  // Heads nearly touch the gallery: from nothing, it is the nearer floor.
  const PolygonMesh floor = testing::gridMesh(6, 6);
  const World world(testing::together(floor, floor, {0.0f, 1.9f, 0.0f}));
  const glm::vec3 head = toSpace({0.5f, 0.5f}, 1.7f);
  EXPECT_EQ(locate(world.graph, world.index, head)->height, 1.9f);
  std::optional<Location> last = locate(world.graph, world.index, toSpace({0.5f, 0.5f}, 0.0f));
  for (float x = 0.5f; x < 6.3f; x += 0.1f) {  // a little into the wall, too
    last = locateFrom(world.graph, world.index, *last, toSpace({x, 0.5f * x}, 1.7f));
    ASSERT_TRUE(last);
    EXPECT_EQ(last->height, 0.0f);
  }
}

TEST(LocateFrom, JumpsAsIfFromNothing) {
  const World world(testing::randomMesh(2, 40, 40));
  std::mt19937_64 rng(2);
  for (int i = 0; i < 1000; ++i) {
    const auto from =
        locate(world.graph, world.index, toSpace(randomPlan(rng, {0, 0}, {40, 40}), 1.7f));
    const glm::vec3 position = toSpace(randomPlan(rng, {-3, -3}, {43, 43}), 1.7f);
    if (!from) continue;
    const auto there = locateFrom(world.graph, world.index, *from, position);
    const auto afresh = locate(world.graph, world.index, position);
    ASSERT_EQ(there.has_value(), afresh.has_value());
    if (!there) continue;
    // A walk may end at another side of the same wall or portal, never farther off.
    if (there->snapped) continue;
    EXPECT_TRUE(contains(world.graph, there->polygon, toPlan(position)));
    EXPECT_FALSE(afresh->snapped);
  }
  // From no place at all, and from a place of another navmesh.
  const glm::vec3 here = toSpace({20.2f, 20.2f}, 1.7f);
  EXPECT_EQ(locateFrom(world.graph, world.index, Location{}, here),
            locate(world.graph, world.index, here));
  EXPECT_EQ(locateFrom(world.graph, world.index, Location{PolygonId{1u << 30}}, here),
            locate(world.graph, world.index, here));
}

TEST(LocateFrom, ChangesFloorsWithoutStairsByAJumpOnly) {
  const PolygonMesh floor = testing::gridMesh(2, 2);
  const World world(testing::together(floor, floor, {0.0f, 3.0f, 0.0f}));
  const Location below = *locate(world.graph, world.index, toSpace({0.5f, 0.5f}, 1.7f));
  const auto above = locateFrom(world.graph, world.index, below, toSpace({0.5f, 0.5f}, 4.7f));
  ASSERT_TRUE(above);
  EXPECT_EQ(above->height, 3.0f);
}

TEST(LocationIndex, HasAboutAsManyCellsAsPolygons) {
  for (const auto& [columns, rows] : {std::pair(1, 1), std::pair(30, 30), std::pair(500, 1)}) {
    const World world(testing::gridMesh(columns, rows));
    const std::size_t cells = std::size_t{world.index.columns} * world.index.rows;
    EXPECT_LE(cells, 3u * static_cast<std::size_t>(columns * rows) + 1);
    EXPECT_EQ(world.index.cellStart.size(), cells + 1);
    EXPECT_EQ(world.index.cellStart.back(), world.index.polygons.size());
    for (std::size_t c = 0; c < cells; ++c) {
      EXPECT_TRUE(std::is_sorted(world.index.polygons.begin() + world.index.cellStart[c],
                                 world.index.polygons.begin() + world.index.cellStart[c + 1]));
    }
  }
}

TEST(LocationIndex, StaysSmallForPolygonsThatAreAllLong) {
  // Slats, each as long as the whole, at a slant: every one covers a band of cells.
  PolygonMesh mesh;
  for (int i = 0; i < 400; ++i) {
    const float y = 0.1f * static_cast<float>(i);
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    for (const glm::vec2 p : {glm::vec2(0, y), glm::vec2(40, y + 40), glm::vec2(40, y + 40.05f),
                              glm::vec2(0, y + 0.05f)}) {
      mesh.vertices.push_back(toSpace(p, 0.0f));
    }
    mesh.ring.insert(mesh.ring.end(), {first, first + 1, first + 2, first + 3});
    mesh.ringStart.push_back(static_cast<std::uint32_t>(mesh.ring.size()));
  }
  const World world(mesh);
  EXPECT_LE(world.index.polygons.size(), 16u * 400u);
  for (std::uint32_t p = 0; p < world.graph.polygonCount(); ++p) {
    EXPECT_EQ(locate(world.graph, world.index, toSpace(world.graph.centroid[p], 0.0f))->polygon,
              PolygonId{p});
  }
}

}  // namespace
}  // namespace forewalk::navmesh
