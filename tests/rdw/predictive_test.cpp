#include "rdw/predictive.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "navmesh/random.h"
#include "navmesh/world.h"
#include "prediction/predict.h"
#include "tests/support/count_allocations.h"
#include "tests/support/motions.h"
#include "tests/support/random_mesh.h"

namespace forewalk::rdw {
namespace {

using navmesh::uniform;
using testing::turningOnTheSpot;
using testing::walking;

const GainLimits kLaboratory = *gainLimitsByName("laboratory");

Gains steered(Controller& controller, const Motion& motion, const PlanarPose& body,
              const TrackedSpace& space, const prediction::PredictionGraph* graph = nullptr,
              int frames = 60) {
  Gains gains;
  const Redirection map;
  controller.prepare(space, kLaboratory);
  testing::allocationsSince();
  for (int i = 0; i < frames; ++i) {
    gains = controller.steer({motion, body, body, space, kLaboratory, map, graph});
  }
  EXPECT_EQ(testing::allocationsSince(), 0u);
  return gains;
}

TEST(WaysAhead, AreOneStraightWayWithoutAGraph) {
  const WaysAhead ahead = waysAhead(nullptr, {}, {0, 1}, {0, 1}, {});
  ASSERT_EQ(ahead.count, 1);
  EXPECT_EQ(ahead.ways[0].weight, 1.0);
  EXPECT_EQ(ahead.meanDirection, glm::dvec2(0, 1));
  double length = 0.0;
  for (int i = 0; i < ahead.ways[0].count; ++i) {
    length += ahead.ways[0].pieces[static_cast<std::size_t>(i)].length;
    EXPECT_NEAR(ahead.ways[0].pieces[static_cast<std::size_t>(i)].turn, 0.0, 1e-12);
  }
  EXPECT_NEAR(length, WaysAheadSettings{}.reach, 1e-9);
}

TEST(WaysAhead, WeighTogetherToOneAndAgreeWithTheWalk) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    auto graph = navmesh::makeNavGraph(testing::randomMesh(seed, 12, 12));
    ASSERT_TRUE(graph);
    prediction::Scratch scratch(*graph);
    std::mt19937_64 rng(seed);
    for (int i = 0; i < 20; ++i) {
      const auto polygon = static_cast<navmesh::PolygonId>(
          navmesh::uniformInt(rng, static_cast<int>(graph->polygonCount())));
      const navmesh::Location source{polygon, graph->centroid[navmesh::index(polygon)], 0.0f,
                                     false};
      const prediction::PredictionGraph& ways = prediction::predict(*graph, source, 8.0f, scratch);
      const glm::dvec2 direction = directionOf(uniform(rng, -3, 3));
      const WaysAhead ahead = waysAhead(&ways, {}, direction, direction, {});
      ASSERT_GE(ahead.count, 1);
      double weight = 0.0;
      for (int w = 0; w < ahead.count; ++w) {
        const LikelyWay& way = ahead.ways[static_cast<std::size_t>(w)];
        weight += way.weight;
        EXPECT_GT(way.count, 0);
        double length = 0.0;
        for (int p = 0; p < way.count; ++p) {
          const LikelyWay::Piece& piece = way.pieces[static_cast<std::size_t>(p)];
          EXPECT_GT(piece.length, 0.0);
          EXPECT_LE(piece.length, 2.0 + 1e-9);
          length += piece.length;
        }
        EXPECT_LE(length, WaysAheadSettings{}.reach + 1e-6);
      }
      EXPECT_NEAR(weight, 1.0, 1e-9);
    }
  }
}

/// A corridor along plan x, 2 m wide, 10 m long, then 10 m up plan y (`side` 1) or down (-1): an L
/// of three rectangles.
navmesh::NavGraph corridor(float side = 1.0f) {
  navmesh::PolygonMesh mesh;
  for (glm::vec2 p : {glm::vec2(0, -1), glm::vec2(10, -1), glm::vec2(12, -1), glm::vec2(12, 1),
                      glm::vec2(10, 1), glm::vec2(0, 1), glm::vec2(12, 11), glm::vec2(10, 11)}) {
    mesh.vertices.push_back(navmesh::toSpace(glm::vec2(p.x, side * p.y), 0.0f));
  }
  mesh.ring = side > 0.0f ? std::vector<std::uint32_t>{0, 1, 4, 5, 1, 2, 3, 4, 4, 3, 6, 7}
                          : std::vector<std::uint32_t>{5, 4, 1, 0, 4, 3, 2, 1, 7, 6, 3, 4};
  mesh.ringStart = {0, 4, 8, 12};
  auto graph = navmesh::makeNavGraph(mesh);
  EXPECT_TRUE(graph);
  return std::move(*graph);
}

navmesh::Location inCorridor(float x) { return {navmesh::PolygonId{0}, {x, 0.0f}, 0.0f, false}; }

TEST(WaysAhead, KnowTheCornerOfACorridor) {
  for (const float side : {1.0f, -1.0f}) {
    const navmesh::NavGraph graph = corridor(side);
    prediction::Scratch scratch(graph);
    const prediction::PredictionGraph& ways =
        prediction::predict(graph, inCorridor(8.0f), 9.0f, scratch);
    const WaysAhead there = waysAhead(&ways, {}, {1, 0}, {1, 0}, {});
    EXPECT_GT(there.meanTurn * static_cast<double>(side), 0.5) << "round the corner";
    EXPECT_GT(glm::dot(there.meanDirection, glm::dvec2(1, 0)), 0.9);
  }
}

TEST(Predictive, LeavesAStandingUserAlone) {
  const TrackedSpace room;
  for (SteerRule rule : {SteerRule::kCentre, SteerRule::kOrbit}) {
    auto controller = makePredictive(rule);
    EXPECT_EQ(steered(*controller, turningOnTheSpot(0.0), {{2, 2}, 0}, room), Gains{});
  }
}

TEST(Predictive, CurvesAwayFromTheNearerWall) {
  const TrackedSpace room = *TrackedSpace::rectangle(6, 6);
  for (SteerRule rule : {SteerRule::kCentre, SteerRule::kOrbit}) {
    for (double side : {-1.0, 1.0}) {
      auto controller = makePredictive(rule);
      // Along the wall at x = side * 3, from one end.
      const Gains gains = steered(*controller, walking({0, 1}), {{side * 2.4, -2.6}, 0.0}, room);
      EXPECT_NEAR(static_cast<double>(gains.curvature), side / 7.5, 0.01);
      EXPECT_EQ(gains.rotation, 1.0f);
    }
  }
}

/// Gains for somebody in the corridor's bend (or well before it), whose body is at `place` heading
/// the way that they see as plan x.
Gains steeredInCorridor(Controller& controller, double side, float x, glm::dvec2 place,
                        double heading, bool turning) {
  const TrackedSpace room = *TrackedSpace::rectangle(6, 6);
  const navmesh::NavGraph graph = corridor(static_cast<float>(side));
  prediction::Scratch scratch(graph);
  const prediction::PredictionGraph& ways =
      prediction::predict(graph, inCorridor(x), 9.0f, scratch);
  const PlanarPose body{place, heading};
  const PlanarPose seen{glm::dvec2(ways.source.plan), headingOf(glm::dvec2(1, 0))};
  const Redirection map = alignment(body, seen);
  controller.restart();
  Gains gains;
  for (int i = 0; i < 60; ++i) {
    gains =
        controller.steer({turning ? turningOnTheSpot(side * 0.02) : walking(directionOf(heading)),
                          body, seen, room, kLaboratory, map, &ways});
  }
  return gains;
}

TEST(Predictive, TurnsTheBodyTowardTheFreeSideInABend) {
  // Facing the wall at y = 3 from near by. In the bend the eyes turn by about 90 degrees: turned
  // further, the body faces the room; turned less, the wall.
  for (SteerRule rule : {SteerRule::kCentre, SteerRule::kOrbit}) {
    auto controller = makePredictive(rule);
    controller->prepare(*TrackedSpace::rectangle(6, 6), kLaboratory);
    for (double side : {1.0, -1.0}) {
      const Gains gains = steeredInCorridor(*controller, side, 9.7f, {0.0, 2.6}, 0.0, true);
      EXPECT_LT(gains.rotation, 0.9f) << side;
      EXPECT_EQ(gains.curvature, 0.0f);
    }
  }
}

TEST(Predictive, SteersAMirroredWalkTheMirroredWay) {
  for (SteerRule rule : {SteerRule::kCentre, SteerRule::kOrbit}) {
    auto controller = makePredictive(rule);
    controller->prepare(*TrackedSpace::rectangle(6, 6), kLaboratory);
    for (const glm::dvec2 place : {glm::dvec2(2.2, -2.4), glm::dvec2(-1.9, 1.0)}) {
      for (const bool turning : {false, true}) {
        controller->restart();
        const Gains left = steeredInCorridor(*controller, 1.0, 6.0f, place, 0.3, turning);
        controller->restart();
        const Gains right =
            steeredInCorridor(*controller, -1.0, 6.0f, {-place.x, place.y}, -0.3, turning);
        EXPECT_EQ(left.rotation, right.rotation);
        EXPECT_EQ(left.curvature, -right.curvature);
      }
    }
  }
}

TEST(RoomValue, IsTheSameFromTheMirroredPose) {
  const TrackedSpace room = *TrackedSpace::rectangle(6, 4);
  const RoomValue value(room, kLaboratory, SteerRule::kCentre);
  std::mt19937_64 rng(4);
  for (int i = 0; i < 200; ++i) {
    const glm::dvec2 place(uniform(rng, -2.7, 2.7), uniform(rng, -1.7, 1.7));
    const double heading = uniform(rng, -3, 3);
    EXPECT_NEAR(value.at(place, heading), value.at({-place.x, place.y}, -heading), 0.06);
    EXPECT_NEAR(value.at(place, heading), value.at(-place, heading + kPi), 0.06);
  }
}

TEST(RoomValue, IsWorstBeforeAWallAndLessInALargerRoom) {
  const RoomValue value(*TrackedSpace::rectangle(6, 6), kLaboratory, SteerRule::kCentre);
  const RoomValue larger(*TrackedSpace::rectangle(12, 12), kLaboratory, SteerRule::kCentre);
  EXPECT_GT(value.at({0.0, 2.6}, 0.0), value.at({0.0, 2.6}, kPi) + 0.3);
  EXPECT_GT(value.at({0.0, 0.0}, 0.0), larger.at({0.0, 0.0}, 0.0) + 0.3);
}

TEST(RoomValue, IsFiniteInTheSmallestAndOddestRooms) {
  for (const TrackedSpace& room :
       {*TrackedSpace::rectangle(0.1, 0.1), *TrackedSpace::rectangle(200, 0.3),
        *TrackedSpace::circle(0.2)}) {
    for (const char* preset : {"laboratory", "steinicke"}) {
      const RoomValue value(room, *gainLimitsByName(preset), SteerRule::kOrbit);
      for (double heading = -10.0; heading < 10.0; heading += 0.7) {
        const double resets = value.at({heading, 1.0}, heading);
        EXPECT_TRUE(std::isfinite(resets) && resets >= 0.0) << resets;
      }
    }
  }
}

TEST(Predictive, KeepsWithinTheLimitsAndNeverSpendsBothGainsAtOnce) {
  std::mt19937_64 rng(9);
  auto graph = navmesh::makeNavGraph(testing::randomMesh(3, 12, 12));
  ASSERT_TRUE(graph);
  prediction::Scratch scratch(*graph);
  const TrackedSpace room = *TrackedSpace::rectangle(6, 6);
  for (SteerRule rule : {SteerRule::kCentre, SteerRule::kOrbit}) {
    auto controller = makePredictive(rule);
    controller->prepare(room, kLaboratory);
    for (int i = 0; i < 2000; ++i) {
      const auto polygon = static_cast<navmesh::PolygonId>(
          navmesh::uniformInt(rng, static_cast<int>(graph->polygonCount())));
      const navmesh::Location source{polygon, graph->centroid[navmesh::index(polygon)], 0.0f,
                                     false};
      const prediction::PredictionGraph& ways = prediction::predict(*graph, source, 6.0f, scratch);
      const double heading = uniform(rng, -3, 3);
      const Motion motion = i % 2 == 0 ? walking(directionOf(heading), uniform(rng, -0.01, 0.01))
                                       : turningOnTheSpot(uniform(rng, -0.05, 0.05));
      const PlanarPose body{{uniform(rng, -3.2, 3.2), uniform(rng, -3.2, 3.2)}, heading};
      const PlanarPose seen{glm::dvec2(source.plan), heading};
      const Redirection map = alignment(body, seen);
      const Gains gains = controller->steer({motion, body, seen, room, kLaboratory, map, &ways});
      EXPECT_EQ(clamped(gains, kLaboratory), gains);
      EXPECT_TRUE(gains.rotation == 1.0f || gains.curvature == 0.0f);
    }
  }
}

}  // namespace
}  // namespace forewalk::rdw
