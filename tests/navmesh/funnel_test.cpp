#include "navmesh/funnel.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "navmesh/corridor.h"
#include "navmesh/plan.h"
#include "navmesh/random.h"
#include "tests/support/random_mesh.h"
#include "tests/support/visibility.h"
#include "tests/support/zigzag.h"

namespace forewalk::navmesh {
namespace {

using testing::Corridor;
using testing::zigzag;
using Path = std::vector<glm::vec2>;

Path pulled(const Corridor& corridor) {
  Path path{{9.0f, 9.0f}};  // what was there before must not matter
  pullString(corridor.start, corridor.goal, corridor.portals, path);
  return path;
}

template <typename Map>
Corridor mapped(const Corridor& corridor, const Map& map) {
  Corridor result{map(corridor.start), map(corridor.goal), {}};
  for (const Portal& p : corridor.portals) result.portals.push_back({map(p.left), map(p.right)});
  return result;
}

Corridor reversed(const Corridor& corridor) {
  Corridor back{corridor.goal, corridor.start, {}};
  for (const Portal& p : corridor.portals) back.portals.push_back({p.right, p.left});
  std::reverse(back.portals.begin(), back.portals.end());
  return back;
}

Corridor mirrored(const Corridor& corridor) {
  Corridor mirror = mapped(corridor, [](glm::vec2 p) { return glm::vec2(-p.x, p.y); });
  for (Portal& p : mirror.portals) std::swap(p.left, p.right);
  return mirror;
}

// Walks on random navmeshes: from random points along the A* corridor, with the corridor's
// polygons.
struct Walk {
  NavGraph graph;
  Location from, to;
  std::vector<std::uint32_t> halfPortals;
  Corridor corridor;
};

Location randomPlace(std::mt19937_64& rng, const NavGraph& graph) {
  const PolygonId polygon{
      static_cast<std::uint32_t>(uniformInt(rng, static_cast<int>(graph.polygonCount())))};
  const auto ring = graph.ringOf(polygon);
  glm::vec2 plan = graph.centroid[index(polygon)];
  // Corners and edges too: degenerate starts are where funnels break.
  const glm::vec2 corner =
      ring[static_cast<std::size_t>(uniformInt(rng, static_cast<int>(ring.size())))];
  const int kind = uniformInt(rng, 4);
  if (kind == 0) plan = corner;
  if (kind > 1) plan = glm::mix(plan, corner, static_cast<float>(uniform(rng)));
  return {polygon, plan, heightAt(graph, polygon, plan), false};
}

std::vector<Walk> randomWalks(std::uint64_t seeds, int walksEach,
                              const testing::RandomMeshOptions& options = {}) {
  std::vector<Walk> walks;
  for (std::uint64_t seed = 0; seed < seeds; ++seed) {
    std::mt19937_64 rng(seed);
    PolygonMesh mesh = testing::randomMesh(seed, 10, 8, options);
    if (seed % 3 == 2 && options.heights == 0.0f)
      mesh = testing::joinedAlong(mesh, testing::randomMesh(seed + 1, 6, 8, options));
    const NavGraph graph = *makeNavGraph(mesh);
    CorridorScratch scratch;
    for (int i = 0; i < walksEach; ++i) {
      Walk walk{graph, randomPlace(rng, graph), randomPlace(rng, graph), {}, {}};
      if (!findCorridor(graph, walk.from, walk.to, scratch, walk.halfPortals)) continue;
      walk.corridor = {walk.from.plan, walk.to.plan, {}};
      for (const std::uint32_t h : walk.halfPortals) {
        walk.corridor.portals.push_back(graph.portals[h]);
      }
      walks.push_back(std::move(walk));
    }
  }
  return walks;
}

double distanceToSegment(glm::dvec2 p, glm::dvec2 a, glm::dvec2 b) {
  const double length = glm::dot(b - a, b - a);
  const double t = length > 0.0 ? std::clamp(glm::dot(p - a, b - a) / length, 0.0, 1.0) : 0.0;
  return glm::distance(p, glm::mix(a, b, t));
}

TEST(PullString, StaysWhereStartAndGoalAreOnePoint) {
  EXPECT_EQ(pulled({{1, 2}, {1, 2}, {}}), (Path{{1, 2}}));
  EXPECT_EQ(pulled({{1, 2}, {1, 2}, {{{1, 3}, {1, 1}}}}), (Path{{1, 2}}));
}

TEST(PullString, GoesStraightWithoutPortals) {
  EXPECT_EQ(pulled({{0, 0}, {4, 0}, {}}), (Path{{0, 0}, {4, 0}}));
}

TEST(PullString, GoesStraightWhenTheGoalIsInSight) {
  EXPECT_EQ(pulled({{0, 0}, {4, 0}, {{{2, 1}, {2, -1}}}}), (Path{{0, 0}, {4, 0}}));
}

TEST(PullString, NamesNoCornerThatItOnlyTouches) {
  EXPECT_EQ(pulled({{0, 0}, {4, 0}, {{{1, 0}, {1, -1}}, {{2, 1}, {2, 0}}, {{3, 0}, {3, -1}}}}),
            (Path{{0, 0}, {4, 0}}));
}

TEST(PullString, BendsAtTheCornerInTheWay) {
  EXPECT_EQ(pulled({{0, 0}, {2, 2}, {{{1, 3}, {1, 2}}}}), (Path{{0, 0}, {1, 2}, {2, 2}}));
}

TEST(PullString, PassesThroughAPinchPoint) {
  EXPECT_EQ(pulled({{0, 0}, {2, 0}, {{{1, 1}, {1, 1}}}}), (Path{{0, 0}, {1, 1}, {2, 0}}));
  EXPECT_EQ(pulled({{0, 0}, {2, 0}, {{{1, 0}, {1, 0}}}}), (Path{{0, 0}, {2, 0}}));
  EXPECT_EQ(pulled({{0, 0}, {3, 0}, {{{1, 1}, {1, 1}}, {{2, -1}, {2, -1}}}}),
            (Path{{0, 0}, {1, 1}, {2, -1}, {3, 0}}));
}

TEST(PullString, NamesAStartOrGoalOnACornerOnce) {
  EXPECT_EQ(pulled({{1, 2}, {2, 2}, {{{1, 3}, {1, 2}}}}), (Path{{1, 2}, {2, 2}}));
  EXPECT_EQ(pulled({{0, 0}, {1, 2}, {{{1, 3}, {1, 2}}}}), (Path{{0, 0}, {1, 2}}));
  // A fan around the start, and one around the goal.
  const Corridor fan{{0, 0}, {-1, 1}, {{{0, 0}, {1, -1}}, {{0, 0}, {1, 1}}, {{0, 0}, {0, 1}}}};
  EXPECT_EQ(pulled(fan), (Path{{0, 0}, {-1, 1}}));
  EXPECT_EQ(pulled(reversed(fan)), (Path{{-1, 1}, {0, 0}}));
}

TEST(PullString, TurnsRoundACornerByMoreThanHalfACircle) {
  // Around the origin, counter-clockwise, by three quarters.
  const Corridor spiral{{1, -0.5f},
                        {0.5f, -1},
                        {{{0, 0}, {1, 0}},
                         {{0, 0}, {1, 1}},
                         {{0, 0}, {0, 1}},
                         {{0, 0}, {-1, 1}},
                         {{0, 0}, {-1, 0}},
                         {{0, 0}, {-1, -1}},
                         {{0, 0}, {0, -1}}}};
  EXPECT_EQ(pulled(spiral), (Path{{1, -0.5f}, {0, 0}, {0.5f, -1}}));
}

TEST(PullString, IsTheSamePathWalkedBackwards) {
  for (const int portals : {0, 1, 2, 7, 40}) {
    Path back = pulled(reversed(zigzag(portals)));
    std::reverse(back.begin(), back.end());
    EXPECT_EQ(pulled(zigzag(portals)), back) << portals << " portals";
  }
  for (const Walk& walk : randomWalks(12, 40)) {
    Path back = pulled(reversed(walk.corridor));
    std::reverse(back.begin(), back.end());
    EXPECT_EQ(pulled(walk.corridor), back);
  }
}

TEST(PullString, IsTheMirroredPathInTheMirroredCorridor) {
  for (const Walk& walk : randomWalks(12, 40)) {
    Path path = pulled(mirrored(walk.corridor));
    for (glm::vec2& p : path) p.x = -p.x;
    EXPECT_EQ(pulled(walk.corridor), path);
  }
}

TEST(PullString, ScalesWithItsCorridor) {
  for (const Walk& walk : randomWalks(6, 40)) {
    Path path = pulled(walk.corridor);
    for (glm::vec2& p : path) p *= 4.0f;
    EXPECT_EQ(pulled(mapped(walk.corridor, [](glm::vec2 p) { return 4.0f * p; })), path);
  }
}

TEST(PullString, KeepsItsLengthWhereverItsCorridorStands) {
  for (const Walk& walk : randomWalks(6, 40)) {
    const float length = lengthOf(pulled(walk.corridor));
    const float c = std::cos(2.0f), s = std::sin(2.0f);
    const Corridor turned = mapped(walk.corridor, [&](glm::vec2 p) {
      return glm::vec2(c * p.x - s * p.y + 30.0f, s * p.x + c * p.y - 10.0f);
    });
    EXPECT_NEAR(lengthOf(pulled(turned)), length, 1e-4f);
  }
}

TEST(PullString, IsAsShortAsBruteForceFindsInTheSameCorridor) {
  std::size_t bent = 0;
  for (const Walk& walk : randomWalks(30, 40)) {
    const Path path = pulled(walk.corridor);
    const float shortest = testing::visibilityShortestInCorridor(
        walk.corridor.portals, walk.corridor.start, walk.corridor.goal);
    ASSERT_NEAR(lengthOf(path), shortest, 1e-4f);
    bent += path.size() > 2 ? 1 : 0;
  }
  EXPECT_GT(bent, 300u);  // the corridors are worth the name
}

TEST(PullString, IsNeverShorterThanTheWayThroughTheWholeNavmesh) {
  std::size_t equal = 0;
  std::size_t all = 0;
  for (std::uint64_t seed = 0; seed < 4; ++seed) {
    std::mt19937_64 rng(seed);
    const NavGraph graph = *makeNavGraph(testing::randomMesh(seed, 8, 6));
    const testing::VisibilityGraph sight(graph);
    CorridorScratch scratch;
    std::vector<std::uint32_t> corridor;
    Path path;
    for (int i = 0; i < 60; ++i) {
      const Location from = randomPlace(rng, graph), to = randomPlace(rng, graph);
      const float shortest = sight.shortest({from.polygon, from.plan}, {to.polygon, to.plan});
      const bool found = findCorridor(graph, from, to, scratch, corridor);
      ASSERT_EQ(found, std::isfinite(shortest));
      if (!found) continue;
      pullString(graph, from.plan, to.plan, corridor, path);
      ASSERT_GE(lengthOf(path), shortest - 1e-4f);
      equal += lengthOf(path) < shortest + 1e-3f ? 1 : 0;
      ++all;
    }
  }
  // A* by midpoints finds the best corridor most of the time, even among so many holes.
  EXPECT_GT(equal, all * 7 / 10) << "of " << all;
}

TEST(PullString, CrossesEveryPortalInOrder) {
  for (const Walk& walk : randomWalks(10, 40)) {
    const Path path = pulled(walk.corridor);
    std::size_t leg = 1;  // the leg that ends in path[leg]
    for (const Portal& portal : walk.corridor.portals) {
      const auto touches = [&](std::size_t i) {
        // The nearest a leg comes to the portal: at one of the four ends, or where they cross.
        const glm::dvec2 a(path[i - 1]), b(path[i]), l(portal.left), r(portal.right);
        const auto side = [](glm::dvec2 p, glm::dvec2 q, glm::dvec2 x) {
          return (q.x - p.x) * (x.y - p.y) - (q.y - p.y) * (x.x - p.x);
        };
        const bool crosses =
            side(a, b, l) * side(a, b, r) <= 0 && side(l, r, a) * side(l, r, b) <= 0;
        return crosses || std::min({distanceToSegment(a, l, r), distanceToSegment(b, l, r),
                                    distanceToSegment(l, a, b), distanceToSegment(r, a, b)}) < 1e-6;
      };
      while (path.size() > 1 && leg < path.size() && !touches(leg)) ++leg;
      ASSERT_TRUE(path.size() == 1 || leg < path.size());
    }
  }
}

TEST(PullString, NamesOnlyCornersWhereThePathBends) {
  for (const Walk& walk : randomWalks(10, 40)) {
    const Path path = pulled(walk.corridor);
    EXPECT_EQ(path.front(), walk.corridor.start);
    EXPECT_EQ(path.back(), walk.corridor.goal);
    for (std::size_t i = 1; i < path.size(); ++i) EXPECT_NE(path[i - 1], path[i]);
    for (std::size_t i = 1; i + 1 < path.size(); ++i) {
      const glm::dvec2 in = glm::dvec2(path[i]) - glm::dvec2(path[i - 1]);
      const glm::dvec2 out = glm::dvec2(path[i + 1]) - glm::dvec2(path[i]);
      EXPECT_NE(in.x * out.y - in.y * out.x, 0.0);
    }
  }
}

TEST(PullString, TakesACorridorAsHalfPortalsToo) {
  for (const Walk& walk : randomWalks(4, 20)) {
    Path path;
    pullString(walk.graph, walk.from.plan, walk.to.plan, walk.halfPortals, path);
    EXPECT_EQ(path, pulled(walk.corridor));
  }
}

TEST(LengthOf, AddsUpTheLegs) {
  EXPECT_EQ(lengthOf(Path{}), 0.0f);
  EXPECT_EQ(lengthOf(Path{{1, 1}}), 0.0f);
  EXPECT_EQ(lengthOf(Path{{0, 0}, {3, 4}, {3, 5}}), 6.0f);
}

// What liftPath promises, whatever the surface: the same plan, heights on the surface, and no
// stretch of ground farther from the lifted path than the tolerance.
void expectLifted(const Walk& walk, float tolerance) {
  const Path path = pulled(walk.corridor);
  std::vector<glm::vec3> lifted{glm::vec3(7.0f)};
  liftPath(walk.graph, walk.from.polygon, walk.halfPortals, path, tolerance, lifted);
  ASSERT_FALSE(lifted.empty());
  ASSERT_EQ(toPlan(lifted.front()), path.front());
  ASSERT_EQ(toPlan(lifted.back()), path.back());
  Path plan;
  for (const glm::vec3 p : lifted) plan.push_back(toPlan(p));
  for (std::size_t i = 1; i < plan.size(); ++i) ASSERT_NE(plan[i - 1], plan[i]);
  // Every corner is there, in order, and what lies between is on its leg.
  std::size_t leg = 1;
  for (std::size_t i = 1; i < plan.size(); ++i) {
    ASSERT_LT(leg, path.size());
    ASSERT_LT(distanceToSegment(plan[i], path[leg - 1], path[leg]), 1e-5);
    if (plan[i] == path[leg]) ++leg;
  }
  ASSERT_EQ(leg, path.size());

  std::vector<PolygonId> polygons{walk.from.polygon};
  for (const std::uint32_t h : walk.halfPortals) polygons.push_back(walk.graph.portalTo[h]);
  for (std::size_t i = 1; i < lifted.size(); ++i) {
    for (int k = 0; k <= 8; ++k) {
      const glm::vec3 p = glm::mix(lifted[i - 1], lifted[i], static_cast<float>(k) / 8.0f);
      float apart = std::numeric_limits<float>::infinity();
      for (const PolygonId polygon : polygons) {
        if (!contains(walk.graph, polygon, toPlan(p), 1e-5f)) continue;
        apart = std::min(apart, std::abs(heightAt(walk.graph, polygon, toPlan(p)) - p.y));
      }
      ASSERT_LE(apart, tolerance + 1e-4f);
    }
  }
}

TEST(LiftPath, LiftsAPathOfOnePoint) {
  PolygonMesh mesh = testing::gridMesh(1, 1);
  for (glm::vec3& v : mesh.vertices) v.y = 3.0f;
  const NavGraph graph = *makeNavGraph(mesh);
  std::vector<glm::vec3> lifted;
  liftPath(graph, PolygonId{0}, {}, Path{{0.5f, 0.5f}}, 0.01f, lifted);
  EXPECT_EQ(lifted, (std::vector{toSpace({0.5f, 0.5f}, 3.0f)}));
  liftPath(graph, PolygonId{0}, {}, Path{}, 0.01f, lifted);
  EXPECT_TRUE(lifted.empty());
}

TEST(LiftPath, NamesThePlacesWhereStairsBeginAndEnd) {
  const std::vector<float> lengths{4.0f, 2.0f, 4.0f};
  PolygonMesh mesh = testing::corridorMesh(lengths);
  for (glm::vec3& v : mesh.vertices) v.y = std::clamp(v.x - 4.0f, 0.0f, 2.0f);
  const NavGraph graph = *makeNavGraph(mesh);
  const std::vector<std::uint32_t> corridor{graph.portalStart[0], graph.portalStart[1]};
  ASSERT_EQ(graph.portalTo[corridor[0]], PolygonId{1});
  ASSERT_EQ(graph.portalTo[corridor[1]], PolygonId{2});
  std::vector<glm::vec3> lifted;
  liftPath(graph, PolygonId{0}, corridor, Path{{0.5f, 0.5f}, {9.5f, 0.5f}}, 0.01f, lifted);
  EXPECT_EQ(lifted, (std::vector{toSpace({0.5f, 0.5f}, 0.0f), toSpace({4.0f, 0.5f}, 0.0f),
                                 toSpace({6.0f, 0.5f}, 2.0f), toSpace({9.5f, 0.5f}, 2.0f)}));
  liftPath(graph, PolygonId{0}, corridor, Path{{0.5f, 0.5f}, {9.5f, 0.5f}}, 5.0f, lifted);
  EXPECT_EQ(lifted.size(), 2u);
}

TEST(LiftPath, StaysWithinTheToleranceOfTheGround) {
  testing::RandomMeshOptions uneven;
  uneven.heights = 0.6f;
  const std::vector<Walk> walks = randomWalks(8, 20, uneven);
  for (const float tolerance : {0.0f, 0.02f, 0.2f}) {
    for (const Walk& walk : walks) expectLifted(walk, tolerance);
  }
}

TEST(LiftPath, FollowsHeightTriangles) {
  PolygonMesh mesh = testing::gridMesh(3, 1, 2.0f);
  mesh.heightStart = {0, 0, 4, 4};
  const glm::vec3 a = toSpace({2, 0}, 0.0f), b = toSpace({4, 0}, 0.0f), c = toSpace({4, 2}, 0.0f),
                  d = toSpace({2, 2}, 0.0f), top = toSpace({3, 1}, 1.0f);
  mesh.heightTriangles = {{a, b, top}, {b, c, top}, {c, d, top}, {d, a, top}};
  Walk walk{
      *makeNavGraph(mesh), {PolygonId{0}, {0.5f, 0.9f}}, {PolygonId{2}, {5.5f, 1.1f}}, {}, {}};
  CorridorScratch scratch;
  ASSERT_TRUE(findCorridor(walk.graph, walk.from, walk.to, scratch, walk.halfPortals));
  walk.corridor = {walk.from.plan, walk.to.plan, {}};
  for (const std::uint32_t h : walk.halfPortals) {
    walk.corridor.portals.push_back(walk.graph.portals[h]);
  }
  for (const float tolerance : {0.0f, 0.05f, 0.5f}) expectLifted(walk, tolerance);
  std::vector<glm::vec3> lifted;
  liftPath(walk.graph, walk.from.polygon, walk.halfPortals, pulled(walk.corridor), 0.01f, lifted);
  EXPECT_EQ(lifted.size(), 5u);  // up, over the top, down
}

}  // namespace
}  // namespace forewalk::navmesh
