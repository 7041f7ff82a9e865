// Exact distances against a visibility graph, and the laws of a distance.
#include "prediction/distance_field.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "navmesh/build/build.h"
#include "navmesh/build/scene.h"
#include "navmesh/corridor.h"
#include "navmesh/funnel.h"
#include "prediction/predict.h"
#include "tests/support/count_allocations.h"
#include "tests/support/random_mesh.h"
#include "tests/support/random_start.h"
#include "tests/support/visibility.h"

namespace forewalk::prediction {
namespace {

using navmesh::Location;
using navmesh::NavGraph;
using navmesh::PolygonMesh;
using testing::PlanPlace;

NavGraph graphOf(const PolygonMesh& mesh) {
  auto graph = navmesh::makeNavGraph(mesh);
  if (!graph) throw std::runtime_error(graph.error().message);
  return std::move(*graph);
}

/// A graph and its distances.
struct Measured {
  explicit Measured(const PolygonMesh& mesh, std::uint32_t windows = 1u << 15)
      : graph(graphOf(mesh)), ends(makePortalEnds(graph)), field(graph, ends, {windows}) {}
  Measured(const Measured&) = delete;

  float at(const PlanPlace& place) const { return field.distanceAt(place.polygon, place.plan); }
  void runFrom(const PlanPlace& place, float horizon) {
    field.run({place.polygon, place.plan, 0.0f, false}, horizon);
  }
  std::vector<PlanPlace> places(int count, std::uint64_t seed) const {
    std::vector<PlanPlace> found;
    for (const Location& place : testing::randomStarts(graph, count, seed)) {
      found.push_back({place.polygon, place.plan});
    }
    return found;
  }

  NavGraph graph;
  PortalEnds ends;
  DistanceField field;
};

/// Holes, triangles, merged polygons; every third world on an exact grid.
testing::RandomMeshOptions optionsOf(int seed) {
  testing::RandomMeshOptions options;
  options.holeShare = 0.06 * (seed % 7);
  options.mergeShare = 0.1 * (seed % 9);
  options.splitShare = 0.15 * (seed % 5);
  if (seed % 3 == 0) options.jitter = 0.0;
  return options;
}

/// Joins polygons that touch at a point only by portals of no width there.
PolygonMesh pinched(PolygonMesh mesh) {
  const auto edgeAt = [&](std::uint32_t polygon, std::uint32_t vertex) {
    const auto begin = mesh.ring.begin() + mesh.ringStart[polygon];
    const auto end = mesh.ring.begin() + mesh.ringStart[polygon + 1];
    const auto at = std::find(begin, end, vertex);
    return at == end ? -1 : static_cast<int>(at - begin);
  };
  std::vector<navmesh::BorderPortal> portals;
  for (std::uint32_t a = 0; a < mesh.polygonCount(); ++a) {
    for (std::uint32_t b = a + 1; b < mesh.polygonCount(); ++b) {
      std::vector<std::uint32_t> shared;
      for (std::uint32_t i = mesh.ringStart[a]; i < mesh.ringStart[a + 1]; ++i) {
        if (edgeAt(b, mesh.ring[i]) >= 0) shared.push_back(mesh.ring[i]);
      }
      if (shared.size() != 1) continue;
      const glm::vec3 point = mesh.vertices[shared[0]];
      portals.push_back({PolygonId{a}, PolygonId{b},
                         static_cast<std::uint32_t>(edgeAt(a, shared[0])),
                         static_cast<std::uint32_t>(edgeAt(b, shared[0])), point, point});
    }
  }
  mesh.borderPortals.insert(mesh.borderPortals.end(), portals.begin(), portals.end());
  std::sort(mesh.borderPortals.begin(), mesh.borderPortals.end(), [](const auto& a, const auto& b) {
    return std::tie(a.from, a.fromEdge, a.to, a.toEdge) <
           std::tie(b.from, b.fromEdge, b.to, b.toEdge);
  });
  return mesh;
}

/// World number `seed`; every fourth has a tile border with partial portals, every fifth pinch
/// points.
PolygonMesh randomWorld(int seed, int columns = 8, int rows = 7) {
  const std::uint64_t number = static_cast<std::uint64_t>(seed);
  const testing::RandomMeshOptions options = optionsOf(seed);
  if (seed % 4 == 0) {
    return testing::joinedAlong(testing::randomMesh(number, columns / 2, rows, options),
                                testing::randomMesh(number + 5000, columns / 2, rows, options));
  }
  const PolygonMesh mesh = testing::randomMesh(number, columns, rows, options);
  return seed % 5 == 0 ? pinched(mesh) : mesh;
}

double relativeError(float length, float exact) {
  if (std::isinf(length) && std::isinf(exact)) return 0.0;
  return std::abs(static_cast<double>(length) - static_cast<double>(exact)) /
         std::max(1e-3, static_cast<double>(exact));
}

/// The largest error of the distances from `start` to `goals`.
double worstError(Measured& world, const testing::VisibilityGraph& exactly, const PlanPlace& start,
                  std::span<const PlanPlace> goals, float horizon = 100.0f) {
  world.runFrom(start, horizon);
  const std::vector<float> exact = exactly.shortest(start, goals);
  double worst = 0.0;
  for (std::size_t i = 0; i < goals.size(); ++i) {
    const float ours = world.at(goals[i]);
    if (exact[i] > horizon) {
      EXPECT_GE(ours, horizon * (1 - 1e-6f));
    } else {
      worst = std::max(worst, relativeError(ours, exact[i]));
    }
  }
  return worst;
}

TEST(DistanceField, KnowsOnlyTheUsersPolygonWhereThereIsNoWayOut) {
  Measured world(testing::gridMesh(1, 1));
  world.runFrom({PolygonId{0}, {0.25f, 0.5f}}, 10.0f);
  EXPECT_EQ(world.at({PolygonId{0}, {0.75f, 0.5f}}), 0.5f);
  EXPECT_EQ(world.at({PolygonId{0}, {0.25f, 0.5f}}), 0.0f);
  EXPECT_EQ(world.field.cornerBefore(PolygonId{0}, {0.75f, 0.5f}), 0u);
  EXPECT_EQ(world.field.polygons().size(), 1u);
  EXPECT_EQ(world.field.corners().size(), 1u);
  EXPECT_EQ(world.field.completeTo(), 10.0f);
}

TEST(DistanceField, NeedsNoCornerOnAnOpenFloorHoweverItIsCut) {
  for (const PolygonMesh& mesh :
       {testing::gridMesh(6, 6), testing::joinedGrids(3, 6, 5, 6.0f),
        testing::randomMesh(3, 6, 6, {0.0, 1.0, 0.0}), testing::randomMesh(4, 6, 6, {0.0})}) {
    Measured world(mesh);
    for (const PlanPlace& start : world.places(10, 1)) {
      world.runFrom(start, 20.0f);
      EXPECT_EQ(world.field.corners().size(), 1u);
      for (const PlanPlace& goal : world.places(50, 2)) {
        EXPECT_FLOAT_EQ(world.at(goal), glm::distance(start.plan, goal.plan));
      }
    }
  }
}

TEST(DistanceField, StartsFromPortalsAndTheirEndsAndFromTheCornersOfWalls) {
  for (int seed = 1; seed <= 30; ++seed) {
    Measured world(randomWorld(seed));
    const testing::VisibilityGraph exactly(world.graph);
    const std::vector<PlanPlace> goals = world.places(15, 7);
    for (std::uint32_t h = 0; h < world.graph.portalCount(); h += 17) {
      const PolygonId to = world.graph.portalTo[h];
      const navmesh::Portal& portal = world.graph.portals[h];
      for (const glm::vec2 start : {portal.left, portal.right, world.graph.portalMidpoint[h]}) {
        EXPECT_LE(worstError(world, exactly, {to, start}, goals), 1e-4) << "seed " << seed;
      }
    }
  }
}

TEST(DistanceField, AgreesWithAVisibilityGraphOnAThousandRandomWorlds) {
  std::size_t finite = 0, bent = 0;
  for (int seed = 1; seed <= 1000; ++seed) {
    Measured world(randomWorld(seed, 6, 7));
    const testing::VisibilityGraph exactly(world.graph);
    const std::uint64_t number = static_cast<std::uint64_t>(seed);
    const PlanPlace start = world.places(1, number)[0];
    std::vector<PlanPlace> goals = world.places(12, number + 1);
    for (std::uint32_t p = 0; p < world.graph.polygonCount(); p += 3) {
      const std::span<const glm::vec2> ring = world.graph.ringOf(PolygonId{p});
      goals.push_back({PolygonId{p}, ring[p % ring.size()]});
    }
    EXPECT_LE(worstError(world, exactly, start, goals), 1e-4) << "seed " << seed;
    EXPECT_FALSE(world.field.limitReached());
    for (const PlanPlace& goal : goals) {
      const float ours = world.at(goal);
      finite += std::isfinite(ours) ? 1 : 0;
      bent += std::isfinite(ours) && ours > 1.001f * glm::distance(start.plan, goal.plan) ? 1 : 0;
    }
    if (HasFailure()) return;
  }
  EXPECT_GT(finite, 12000u);
  EXPECT_GT(bent, 3000u);
}

TEST(DistanceField, AgreesWithAVisibilityGraphFarFromTheOriginAndAtOtherScales) {
  for (int seed = 1; seed <= 40; ++seed) {
    const PolygonMesh mesh = randomWorld(seed);
    for (const PolygonMesh& changed :
         {testing::turned(mesh, 0.1f * static_cast<float>(seed)), testing::mirrored(mesh),
          testing::scaled(mesh, 0.125f), testing::scaled(mesh, 3.7f),
          testing::together(testing::gridMesh(1, 1), mesh, {300.0f, 0.0f, -400.0f})}) {
      Measured world(changed);
      const testing::VisibilityGraph exactly(world.graph);
      for (const PlanPlace& start : world.places(3, 5)) {
        EXPECT_LE(worstError(world, exactly, start, world.places(20, 6)), 1e-4) << "seed " << seed;
      }
    }
  }
}

TEST(DistanceField, GivesTheSameDistancesInAMirror) {
  for (int seed = 1; seed <= 40; ++seed) {
    const PolygonMesh mesh = randomWorld(seed);
    Measured world(mesh), image(testing::mirrored(mesh));
    const auto seen = [](const PlanPlace& p) {
      return PlanPlace{p.polygon, {-p.plan.x, p.plan.y}};
    };
    for (const PlanPlace& start : world.places(3, 1)) {
      world.runFrom(start, 6.0f);
      image.runFrom(seen(start), 6.0f);
      EXPECT_EQ(world.field.corners().size(), image.field.corners().size());
      for (const PlanPlace& goal : world.places(30, 2)) {
        if (world.at(goal) > 6.0f) continue;
        EXPECT_FLOAT_EQ(world.at(goal), image.at(seen(goal)));
      }
    }
  }
}

TEST(DistanceField, DoesNotDependOnHowTheFloorIsCut) {
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    // The same seed has the same holes, however its cells are split and merged.
    Measured quads(testing::randomMesh(seed, 10, 10, {0.15, 0.0, 0.0}));
    Measured triangles(testing::randomMesh(seed, 10, 10, {0.15, 1.0, 0.0}));
    Measured merged(testing::randomMesh(seed, 10, 10, {0.15, 0.3, 1.0}));
    const auto placeIn = [](const Measured& world, glm::vec2 plan) {
      for (std::uint32_t p = 0; p < world.graph.polygonCount(); ++p) {
        if (contains(world.graph, PolygonId{p}, plan)) return PlanPlace{PolygonId{p}, plan};
      }
      return PlanPlace{navmesh::kNoPolygon, plan};
    };
    for (const PlanPlace& start : quads.places(3, seed)) {
      quads.runFrom(start, 50.0f);
      triangles.runFrom(placeIn(triangles, start.plan), 50.0f);
      merged.runFrom(placeIn(merged, start.plan), 50.0f);
      for (const PlanPlace& goal : quads.places(40, seed + 1)) {
        const float expected = quads.at(goal);
        EXPECT_LE(relativeError(triangles.at(placeIn(triangles, goal.plan)), expected), 1e-5);
        EXPECT_LE(relativeError(merged.at(placeIn(merged, goal.plan)), expected), 1e-5);
      }
    }
  }
}

/// Symmetric, zero only on the spot, the triangle inequality, and not shorter than straight.
void expectADistance(const NavGraph& graph, int count) {
  const PortalEnds ends = makePortalEnds(graph);
  DistanceField field(graph, ends);
  const std::vector<Location> places = testing::randomStarts(graph, count, 3);
  std::vector<std::vector<float>> between;
  for (const Location& from : places) {
    field.run(from, 500.0f);
    ASSERT_FALSE(field.limitReached());
    between.emplace_back();
    for (const Location& to : places) {
      between.back().push_back(field.distanceAt(to.polygon, to.plan));
    }
  }
  for (std::size_t a = 0; a < places.size(); ++a) {
    EXPECT_EQ(between[a][a], 0.0f);
    for (std::size_t b = 0; b < places.size(); ++b) {
      EXPECT_LE(relativeError(between[a][b], between[b][a]), 1e-5);
      EXPECT_GE(between[a][b] * 1.00001f, glm::distance(places[a].plan, places[b].plan));
      for (std::size_t c = 0; c < places.size(); ++c) {
        EXPECT_LE(between[a][c], (between[a][b] + between[b][c]) * 1.00001f);
      }
    }
  }
}

TEST(DistanceField, IsADistance) {
  for (int seed = 1; seed <= 40; ++seed) expectADistance(graphOf(randomWorld(seed, 12, 12)), 14);
}

TEST(DistanceField, AgreesWithItselfAtALongerHorizon) {
  for (int seed = 1; seed <= 40; ++seed) {
    Measured far(randomWorld(seed, 12, 12)), near(randomWorld(seed, 12, 12));
    for (const PlanPlace& start : far.places(4, 3)) {
      far.runFrom(start, 100.0f);
      for (const float horizon : {0.0f, 0.3f, 1.0f, 3.0f, 8.0f}) {
        near.runFrom(start, horizon);
        for (const PlanPlace& goal : far.places(60, 4)) {
          const float distance = far.at(goal);
          if (distance <= horizon) {
            EXPECT_FLOAT_EQ(near.at(goal), distance);
          } else {
            EXPECT_GT(near.at(goal) * 1.000001f, horizon);
          }
        }
        for (const Corner& corner : near.field.corners()) EXPECT_LE(corner.distance, horizon);
      }
    }
  }
}

TEST(DistanceField, HasTheShortestPathsAsATreeOfCorners) {
  for (int seed = 1; seed <= 100; ++seed) {
    Measured world(randomWorld(seed));
    const testing::VisibilityGraph exactly(world.graph);
    const PlanPlace start = world.places(1, 9)[0];
    world.runFrom(start, 30.0f);
    const std::span<const Corner> corners = world.field.corners();
    EXPECT_EQ(corners[0].previous, 0u);
    for (std::uint32_t c = 1; c < corners.size(); ++c) {
      const Corner& corner = corners[c];
      ASSERT_LT(corner.previous, c);
      EXPECT_GE(corner.distance, corners[c - 1].distance);
      EXPECT_NEAR(corner.distance,
                  corners[corner.previous].distance +
                      glm::distance(corner.plan, corners[corner.previous].plan),
                  1e-5f);
    }
    // Each end of a portal within the horizon: the distance that the field keeps of it, and that
    // of any polygon around.
    for (std::uint32_t h = 0; h < world.graph.portalCount(); h += 5) {
      const PlanPlace end{world.graph.portalTo[h], world.graph.portals[h].left};
      const float exact = exactly.shortest(start, end);
      EXPECT_LE(relativeError(world.field.endDistance(world.ends.ofPortal[h].left), exact), 1e-4);
      EXPECT_LE(relativeError(world.at(end), exact), 1e-4);
      const std::uint32_t before = world.field.cornerBefore(end.polygon, end.plan);
      if (std::isinf(exact)) {
        EXPECT_EQ(before, kNone);
      } else {
        ASSERT_LT(before, corners.size());
        EXPECT_NEAR(corners[before].distance + glm::distance(corners[before].plan, end.plan), exact,
                    1e-4f);
      }
    }
  }
}

TEST(DistanceField, SeesEveryPlaceWithinTheHorizonThroughAWindow) {
  for (int seed = 1; seed <= 60; ++seed) {
    Measured world(randomWorld(seed, 12, 12));
    for (const PlanPlace& start : world.places(3, 3)) {
      world.runFrom(start, 7.0f);
      for (const PlanPlace& goal : world.places(60, 4)) {
        const float distance = world.at(goal);
        if (distance > 7.0f) continue;
        bool seen = false;
        for (std::uint32_t w = world.field.firstWindow(goal.polygon); w != kNone;
             w = world.field.windows()[w].next) {
          const Window& window = world.field.windows()[w];
          ASSERT_EQ(window.polygon, goal.polygon);
          const Corner& root = world.field.corners()[window.corner];
          const glm::dvec2 ray = glm::dvec2(goal.plan) - glm::dvec2(root.plan);
          const auto turn = [](glm::dvec2 a, glm::dvec2 b) { return a.x * b.y - a.y * b.x; };
          const double slack = -1e-5 * glm::length(ray);
          const bool inside = window.portal == kNone ||
                              (turn(window.right, ray) >= slack * glm::length(window.right) &&
                               turn(ray, window.left) >= slack * glm::length(window.left));
          seen |= inside && root.distance + glm::distance(root.plan, goal.plan) < distance + 1e-5f;
        }
        EXPECT_TRUE(seen) << "seed " << seed;
      }
    }
  }
}

TEST(DistanceField, KeepsStoreysApart) {
  const PolygonMesh floor = testing::randomMesh(7, 9, 9);
  Measured one(floor), two(testing::together(floor, floor, {0.0f, 3.0f, 0.0f}));
  const std::uint32_t polygons = one.graph.polygonCount();
  for (const PlanPlace& start : one.places(5, 1)) {
    one.runFrom(start, 12.0f);
    two.runFrom(start, 12.0f);
    EXPECT_EQ(one.field.windows().size(), two.field.windows().size());
    for (const PlanPlace& goal : one.places(20, 2)) {
      EXPECT_EQ(two.at(goal), one.at(goal));
      EXPECT_EQ(two.at({PolygonId{index(goal.polygon) + polygons}, goal.plan}), INFINITY);
    }
  }
}

/// A spiral ramp of triangles or quads, `turns` times around, climbing; one polygon wide.
PolygonMesh spiral(int sectors, int turns, float inner, float outer) {
  PolygonMesh mesh;
  const auto add = [&](float radius, int step) {
    const float angle = 6.2831853f * static_cast<float>(step) / static_cast<float>(sectors);
    mesh.vertices.push_back(navmesh::toSpace({radius * std::cos(angle), radius * std::sin(angle)},
                                             0.2f * static_cast<float>(step)));
    return static_cast<std::uint32_t>(mesh.vertices.size() - 1);
  };
  const std::uint32_t pole = inner == 0.0f ? add(0.0f, 0) : 0;
  std::uint32_t in = inner == 0.0f ? pole : add(inner, 0);
  std::uint32_t out = add(outer, 0);
  for (int step = 1; step <= sectors * turns; ++step) {
    const std::uint32_t nextIn = inner == 0.0f ? pole : add(inner, step);
    const std::uint32_t nextOut = add(outer, step);
    mesh.ring.insert(mesh.ring.end(), {in, out, nextOut});
    if (inner != 0.0f) mesh.ring.push_back(nextIn);
    mesh.ringStart.push_back(static_cast<std::uint32_t>(mesh.ring.size()));
    in = nextIn;
    out = nextOut;
  }
  return mesh;
}

TEST(DistanceField, WindsUpASpiralStaircaseThatLiesAboveItself) {
  for (const float inner : {0.0f, 0.3f, 1.0f}) {
    for (const int sectors : {5, 8, 13}) {
      Measured world(spiral(sectors, 3, inner, 2.0f));
      navmesh::CorridorScratch scratch;
      std::vector<std::uint32_t> corridor;
      std::vector<glm::vec2> path;
      for (const PlanPlace& start : world.places(6, 1)) {
        world.runFrom(start, 100.0f);
        for (const PlanPlace& goal : world.places(30, 2)) {
          // One corridor leads there: its taut path is the shortest.
          const Location from{start.polygon, start.plan, 0.0f, false};
          const Location to{goal.polygon, goal.plan, 0.0f, false};
          ASSERT_TRUE(findCorridor(world.graph, from, to, scratch, corridor));
          pullString(world.graph, from.plan, to.plan, corridor, path);
          EXPECT_NEAR(world.at(goal), navmesh::lengthOf(path), 1e-4f);
        }
      }
    }
  }
}

NavGraph built(const std::string& file, float tile) {
  navmesh::BuildSettings settings;
  settings.tile = tile;
  const auto imported = navmesh::importScene(std::filesystem::path(file));
  return *navmesh::makeNavGraph(navmesh::flatten(*navmesh::buildNavMesh(*imported, settings)));
}

std::string bundled(const char* scene) {
  return std::string(FOREWALK_ASSETS "/scenes/") + scene + ".obj";
}

TEST(DistanceField, IsADistanceInBuildingsWithStairs) {
  for (const float tile : {0.0f, 6.4f}) {
    for (const char* scene : {"two_storey", "museum", "maze"}) {
      expectADistance(built(bundled(scene), tile), 25);
    }
  }
}

TEST(DistanceField, IsADistanceInASceneFromOutside) {
  const std::string file = FOREWALK_SHARED_DATA "/scenes/nav_test.obj";
  if (!std::filesystem::exists(file)) GTEST_SKIP() << file << " is not here";
  for (const float tile : {0.0f, 6.4f}) expectADistance(built(file, tile), 40);
}

TEST(DistanceField, IsNeverLongerThanTheTautPathsOfThePrediction) {
  const auto check = [](const NavGraph& graph, float horizon, std::uint64_t seed) {
    const PortalEnds ends = makePortalEnds(graph);
    DistanceField field(graph, ends);
    Scratch scratch(graph);
    for (const Location& start : testing::randomStarts(graph, 12, seed)) {
      field.run(start, horizon + 0.01f);  // ways that are cut end at the horizon itself
      ASSERT_FALSE(field.limitReached());
      const PredictionGraph& found = predict(graph, start, horizon, scratch);
      for (const Node& node : found.nodes) {
        EXPECT_LE(field.distanceAt(node.polygon, node.plan), node.distance + 1e-3f);
        EXPECT_GE(field.distanceAt(node.polygon, node.plan),
                  glm::distance(start.plan, node.plan) - 1e-3f);
      }
    }
  };
  for (int seed = 1; seed <= 40; ++seed) {
    if (seed % 5 == 0) continue;  // cut ways end beside their polygon where that has pinch points
    check(graphOf(randomWorld(seed, 14, 11)), 9.0f, static_cast<std::uint64_t>(seed));
  }
  for (const char* scene : {"two_storey", "office", "museum"}) {
    for (const float tile : {0.0f, 6.4f}) check(built(bundled(scene), tile), 25.0f, 1);
  }
}

TEST(DistanceField, AgreesWithAVisibilityGraphOnBuiltScenes) {
  for (const char* scene : {"office", "museum"}) {
    for (const float tile : {0.0f, 6.4f}) {
      if (tile > 0.0f && scene == std::string("museum")) continue;  // the reference takes its time
      const NavGraph graph = built(bundled(scene), tile);
      const PortalEnds ends = makePortalEnds(graph);
      DistanceField field(graph, ends);
      const testing::VisibilityGraph exactly(graph);
      std::vector<PlanPlace> goals;
      for (const Location& goal : testing::randomStarts(graph, 60, 2)) {
        goals.push_back({goal.polygon, goal.plan});
      }
      for (const Location& start : testing::randomStarts(graph, 5, 1)) {
        field.run(start, 30.0f);
        const std::vector<float> exact = exactly.shortest({start.polygon, start.plan}, goals);
        for (std::size_t i = 0; i < goals.size(); ++i) {
          if (exact[i] > 30.0f) continue;
          EXPECT_LE(relativeError(field.distanceAt(goals[i].polygon, goals[i].plan), exact[i]),
                    1e-4);
        }
      }
    }
  }
}

TEST(DistanceField, StaysRightOutToWhereTheWindowLimitStopsIt) {
  std::size_t stopped = 0;
  for (int seed = 1; seed <= 40; ++seed) {
    Measured whole(randomWorld(seed, 12, 12));
    for (const std::uint32_t limit : {1u, 2u, 10u, 60u, 200u}) {
      Measured cut(randomWorld(seed, 12, 12), limit);
      const PlanPlace start = whole.places(1, 3)[0];
      whole.runFrom(start, 20.0f);
      cut.runFrom(start, 20.0f);
      EXPECT_LE(cut.field.windows().size(), limit);
      EXPECT_EQ(cut.field.limitReached(), cut.field.completeTo() < 20.0f);
      stopped += cut.field.limitReached() ? 1 : 0;
      for (const PlanPlace& goal : whole.places(60, 4)) {
        const float distance = whole.at(goal);
        if (distance <= cut.field.completeTo()) {
          EXPECT_FLOAT_EQ(cut.at(goal), distance);
        } else {
          EXPECT_GE(cut.at(goal), distance);
        }
      }
    }
  }
  EXPECT_GT(stopped, 100u);
}

TEST(DistanceField, ReplaysToTheLastBitWhateverCameBefore) {
  const PolygonMesh mesh = randomWorld(2, 14, 14);
  Measured worn(mesh);
  // The same floor in a larger world.
  Measured large(testing::repeated(mesh, 3, 3));
  for (const PlanPlace& start : worn.places(40, 1)) {
    Measured fresh(mesh);
    fresh.runFrom(start, 8.0f);
    worn.runFrom(start, 8.0f);
    large.runFrom(start, 8.0f);
    for (Measured* other : {&worn, &large}) {
      ASSERT_EQ(fresh.field.windows().size(), other->field.windows().size());
      ASSERT_EQ(fresh.field.corners().size(), other->field.corners().size());
      for (std::size_t c = 0; c < fresh.field.corners().size(); ++c) {
        EXPECT_EQ(fresh.field.corners()[c].distance, other->field.corners()[c].distance);
        EXPECT_EQ(fresh.field.corners()[c].plan, other->field.corners()[c].plan);
        EXPECT_EQ(fresh.field.corners()[c].previous, other->field.corners()[c].previous);
      }
      ASSERT_TRUE(std::equal(fresh.field.polygons().begin(), fresh.field.polygons().end(),
                             other->field.polygons().begin(), other->field.polygons().end()));
    }
    for (const PlanPlace& goal : fresh.places(50, 2)) EXPECT_EQ(fresh.at(goal), worn.at(goal));
  }
}

TEST(DistanceField, AllocatesNothingFromTheFirstFrameOn) {
  Measured world(testing::randomMesh(2, 30, 30));
  const std::vector<PlanPlace> starts = world.places(100, 2);
  testing::allocationsSince();
  std::size_t windows = 0;
  for (const float horizon : {1.0f, 5.0f, 20.0f, 200.0f}) {
    for (const PlanPlace& start : starts) {
      world.runFrom(start, horizon);
      windows += world.field.windows().size();
    }
  }
  EXPECT_EQ(testing::allocationsSince(), 0u);
  EXPECT_GT(windows, 100000u);
}

}  // namespace
}  // namespace forewalk::prediction
