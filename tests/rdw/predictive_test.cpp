#include "rdw/predictive.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "navmesh/random.h"
#include "navmesh/world.h"
#include "prediction/predict.h"
#include "tests/support/random_mesh.h"

namespace forewalk::rdw {
namespace {

using navmesh::uniform;

const GainLimits kLaboratory = *gainLimitsByName("laboratory");

Motion walking(glm::dvec2 direction, double turn = 0.0) {
  Motion motion;
  motion.dt = 1.0 / 60.0;
  motion.step = direction / 60.0;
  motion.distance = 1.0 / 60.0;
  motion.speed = 1.0;
  motion.walking = true;
  motion.walkingDirection = direction;
  motion.turn = turn;
  motion.turnRate = turn * 60.0;
  return motion;
}

Motion turningOnTheSpot(double turn) {
  Motion motion;
  motion.dt = 1.0 / 60.0;
  motion.turn = turn;
  motion.turnRate = turn * 60.0;
  return motion;
}

Gains steered(Controller& controller, const Motion& motion, const PlanarPose& body,
              const TrackedSpace& space, const prediction::PredictionGraph* graph = nullptr,
              int frames = 60) {
  Gains gains;
  const Redirection map;
  for (int i = 0; i < frames; ++i) {
    gains = controller.steer({motion, body, body, space, kLaboratory, map, graph});
  }
  return gains;
}

TEST(WaysAhead, AreOneStraightWayWithoutAGraph) {
  const WaysAhead ahead = waysAhead(nullptr, {0, 1}, {0, 1}, {});
  ASSERT_EQ(ahead.count, 1);
  EXPECT_EQ(ahead.ways[0].weight, 1.0);
  EXPECT_EQ(ahead.meanDirection, glm::dvec2(0, 1));
  double length = 0.0;
  for (int i = 0; i < ahead.ways[0].count; ++i) {
    length += ahead.ways[0].pieces[static_cast<std::size_t>(i)].length;
    EXPECT_NEAR(ahead.ways[0].pieces[static_cast<std::size_t>(i)].turn, 0.0, 1e-12);
  }
  EXPECT_NEAR(length, PredictiveSettings{}.reach, 1e-9);
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
      const WaysAhead ahead = waysAhead(&ways, direction, direction, {});
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
        EXPECT_LE(length, PredictiveSettings{}.reach + 1e-6);
      }
      EXPECT_NEAR(weight, 1.0, 1e-9);
    }
  }
}

TEST(WaysAhead, KnowTheCornerOfACorridor) {
  // A corridor along plan x, 2 m wide, 10 m long, then 10 m up plan y: an L of three rectangles.
  navmesh::PolygonMesh mesh;
  for (const glm::vec2 p :
       {glm::vec2(0, 0), glm::vec2(10, 0), glm::vec2(12, 0), glm::vec2(12, 2), glm::vec2(10, 2),
        glm::vec2(0, 2), glm::vec2(12, 12), glm::vec2(10, 12)}) {
    mesh.vertices.push_back(navmesh::toSpace(p, 0.0f));
  }
  mesh.ring = {0, 1, 4, 5, 1, 2, 3, 4, 4, 3, 6, 7};
  mesh.ringStart = {0, 4, 8, 12};
  auto graph = navmesh::makeNavGraph(mesh);
  ASSERT_TRUE(graph) << graph.error().message;
  prediction::Scratch scratch(*graph);
  const navmesh::Location source{navmesh::PolygonId{0}, {6.0f, 1.0f}, 0.0f, false};
  const prediction::PredictionGraph& ways = prediction::predict(*graph, source, 9.0f, scratch);
  const WaysAhead there = waysAhead(&ways, {1, 0}, {1, 0}, {});
  EXPECT_GT(there.meanTurn, 1.0);  // left round the corner
  EXPECT_GT(glm::dot(there.meanDirection, glm::dvec2(1, 0)), 0.9);
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

TEST(Predictive, KeepsWithinTheLimitsAndNeverSpendsBothGainsAtOnce) {
  std::mt19937_64 rng(9);
  auto graph = navmesh::makeNavGraph(testing::randomMesh(3, 12, 12));
  ASSERT_TRUE(graph);
  prediction::Scratch scratch(*graph);
  const TrackedSpace room = *TrackedSpace::rectangle(6, 6);
  for (SteerRule rule : {SteerRule::kCentre, SteerRule::kOrbit}) {
    auto controller = makePredictive(rule);
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
