// Sessions in worlds that move: another world is entered between two frames.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "navmesh/build/live_mesh.h"
#include "navmesh/random.h"
#include "rdw/session.h"
#include "tests/support/block_scene.h"
#include "tests/support/count_allocations.h"
#include "tests/support/random_obstacle.h"

namespace forewalk::rdw {
namespace {

using navmesh::LiveMesh;
using navmesh::Obstacle;
using navmesh::ObstacleChange;
using navmesh::ObstacleId;
using WorldPtr = std::shared_ptr<const navmesh::World>;

/// A hall of 20 m x 20 m in the middle of the world, with a gallery 3 m above it.
LiveMesh hall() {
  navmesh::BuildSettings settings;
  settings.tile = 5.0f;
  return std::move(*LiveMesh::make(
      testing::BlockScene("hall").floor({-10, -10, 10, 10}).floor({-10, -10, 10, 10}, 3.0f).scene(),
      settings));
}

WorldPtr with(LiveMesh& mesh, const std::vector<Obstacle>& obstacles) {
  std::vector<ObstacleChange> changes;
  for (std::uint32_t i = 0; i < 16; ++i) {
    changes.push_back(
        {ObstacleId{i}, i < obstacles.size() ? std::optional(obstacles[i]) : std::nullopt});
  }
  return mesh.apply(changes)->world;
}

Session made(WorldPtr world, float startHeight = 0.0f) {
  SessionSettings settings;
  settings.start = VirtualStart{{0.0f, startHeight, 0.0f}, 0.0f};
  settings.controller = "none";
  return std::move(*Session::make(std::move(world), settings));
}

HeadPose head(double x, double z) {
  return {{static_cast<float>(x), 1.7f, static_cast<float>(z)}, glm::quat(1, 0, 0, 0)};
}

Obstacle pillar(double x, double z, double radius, double foot = 0.0) {
  return navmesh::CylinderObstacle{
      glm::vec3(static_cast<float>(x), static_cast<float>(foot), static_cast<float>(z)),
      static_cast<float>(radius), 2.0f};
}

void enter(Session& session, WorldPtr world) {
  PreparedWorld next = prepareWorld(std::move(world), session.settings().prediction);
  session.enter(next);
}

TEST(SessionWorld, MayChangeBeforeTheFirstFrame) {
  LiveMesh mesh = hall();
  Session session = made(mesh.world());
  const WorldPtr changed = with(mesh, {pillar(5, 5, 1)});
  enter(session, changed);
  EXPECT_EQ(&session.world(), changed.get());
  const FrameResult& result = session.frame(head(0, 0), 0.0);
  EXPECT_EQ(result.flags & (kOffNavMesh | kSnapped | kGroundTaken), 0u);
  EXPECT_NEAR(result.virtualPose.position.x, 0.0f, 1e-5f);
}

TEST(SessionWorld, LeavesTheOldOneToItsOwner) {
  LiveMesh mesh = hall();
  std::weak_ptr<const navmesh::World> old = mesh.world();
  Session session = made(mesh.world());
  session.frame(head(0, 0), 0.0);
  PreparedWorld next = prepareWorld(with(mesh, {pillar(5, 5, 1)}), session.settings().prediction);
  session.enter(next);
  EXPECT_EQ(session.result().graph, nullptr);
  EXPECT_EQ(next.world, old.lock());
  ASSERT_FALSE(old.expired());
  next = {};
  EXPECT_TRUE(old.expired());
}

TEST(SessionWorld, IsTheSameWalkWhereNothingNearChanged) {
  LiveMesh mesh = hall();
  const WorldPtr one = with(mesh, {pillar(8, 8, 0.5)}), other = with(mesh, {pillar(-8, 8, 0.5)});
  Session still = made(one), moved = made(one);
  for (int i = 0; i < 300; ++i) {
    const double t = i / 60.0;
    const HeadPose pose = head(2.0 * std::sin(t), -2.0 * t);
    if (i % 3 == 0) enter(moved, i % 2 == 0 ? other : one);
    const FrameResult& a = still.frame(pose, t);
    const FrameResult& b = moved.frame(pose, t);
    ASSERT_EQ(a.virtualPose.position, b.virtualPose.position);
    ASSERT_EQ(a.location.plan, b.location.plan);
    ASSERT_EQ(a.flags, b.flags);
    // The location is of the world the session is in now.
    ASSERT_TRUE(navmesh::contains(moved.world().graph, b.location.polygon, b.location.plan));
  }
}

TEST(SessionWorld, ClosesDoorsAroundSomebodyWhoStands) {
  LiveMesh mesh = hall();
  const WorldPtr world = mesh.world();
  Session session = made(world);
  const std::size_t open = session.frame(head(0, 0), 0.0).graph->nodes.size();
  EXPECT_EQ(session.frame(head(0, 0), 0.1).graph->nodes.size(), open);
  // All but the user's own polygon.
  std::vector<navmesh::PolygonId> others;
  for (std::uint32_t i = 0; i < world->graph.polygonCount(); ++i) {
    const navmesh::PolygonId polygon{i};
    if (polygon != session.result().location.polygon) others.push_back(polygon);
  }
  auto closed = std::make_shared<navmesh::PolygonStates>();
  ASSERT_TRUE(navmesh::setCost(world->graph, others, navmesh::kClosed, *closed));
  std::shared_ptr<const navmesh::PolygonStates> states = closed;
  session.setStates(states);
  EXPECT_LT(session.frame(head(0, 0), 0.2).graph->nodes.size(), open);
  session.setStates(states);
  EXPECT_EQ(session.frame(head(0, 0), 0.3).graph->nodes.size(), open);
}

TEST(SessionWorld, PutsAUserInsideAnObstacleOnTheNearestGroundAndSaysSo) {
  std::mt19937_64 rng(9);
  LiveMesh mesh = hall();
  for (int trial = 0; trial < 40; ++trial) {
    const bool upstairs = trial % 2 == 1;
    const double floor = upstairs ? 3.0 : 0.0;
    Session session = made(with(mesh, {}), static_cast<float>(floor));
    session.frame(head(0, 0), 0.0);
    const double x = navmesh::uniform(rng, -1, 1), z = navmesh::uniform(rng, -1, 1);
    const double radius = navmesh::uniform(rng, 1.5, 6.0);
    const WorldPtr changed = with(mesh, {pillar(x, z, radius, floor)});
    enter(session, changed);
    for (int frame = 1; frame <= 3; ++frame) {
      const FrameResult& result = session.frame(head(0, 0), frame / 60.0);
      EXPECT_NE(result.flags & kGroundTaken, 0u);
      EXPECT_EQ(result.flags & kOffNavMesh, 0u);
      // Nobody is moved: only the place they are searched from is another.
      EXPECT_NEAR(result.virtualPose.position.x, 0.0f, 1e-4f);
      EXPECT_NEAR(result.location.height, floor, 0.06);
      ASSERT_NE(result.graph, nullptr);
      EXPECT_GT(result.graph->nodes.size(), 1u);
      double nearest = 1e9;  // by looking at every polygon's ring
      const navmesh::NavGraph& graph = changed->graph;
      for (std::uint32_t p = 0; p < graph.polygonCount(); ++p) {
        if (std::abs(graph.centroidHeight[p] - floor) > 1.0) continue;
        const auto ring = graph.ringOf(navmesh::PolygonId{p});
        for (std::size_t i = 0; i < ring.size(); ++i) {
          const glm::dvec2 a(ring[i]), b(ring[(i + 1) % ring.size()]);
          const double share = glm::clamp(glm::dot(-a, b - a) / glm::dot(b - a, b - a), 0.0, 1.0);
          nearest = std::min(nearest, glm::length(a + share * (b - a)));
        }
      }
      EXPECT_NEAR(glm::length(glm::dvec2(result.location.plan)), nearest, 1e-3);
    }
    // It goes again, and all is as before.
    enter(session, with(mesh, {}));
    const FrameResult& result = session.frame(head(0, 0), 0.1);
    EXPECT_EQ(result.flags & (kGroundTaken | kSnapped | kOffNavMesh), 0u);
    EXPECT_NEAR(glm::length(result.location.plan), 0.0f, 1e-4f);
  }
}

TEST(SessionWorld, StopsSayingSoWhenTheUserHasWalkedOut) {
  LiveMesh mesh = hall();
  Session session = made(mesh.world());
  session.frame(head(0, 0), 0.0);
  enter(session, with(mesh, {pillar(0, 0, 2)}));
  int inside = 0, outside = 0;
  for (int i = 1; i <= 240; ++i) {
    const double x = i / 60.0;  // 1 m/s
    const FrameResult& result = session.frame(head(x, 0), i / 60.0);
    EXPECT_EQ(result.flags & kOffNavMesh, 0u) << x;
    const bool taken = (result.flags & kGroundTaken) != 0;
    (taken ? inside : outside) += 1;
    if (x < 2.0) {
      EXPECT_TRUE(taken) << x;
    }
    if (x > 2.5) {
      EXPECT_FALSE(taken) << x;
    }
    EXPECT_GE(result.location.plan.x, 0.0f) << "the nearest ground is ahead";
  }
  EXPECT_GT(inside, 100);
  EXPECT_GT(outside, 80);
}

TEST(SessionWorld, KeepsGoingWhereAllGroundIsGone) {
  LiveMesh mesh = hall();
  Session session = made(mesh.world());
  session.frame(head(0, 0), 0.0);
  const navmesh::PrismObstacle flood{{{-20, -20}, {20, -20}, {20, 20}, {-20, 20}}, -1.0f, 6.0f};
  enter(session, with(mesh, {flood}));
  for (int i = 1; i < 10; ++i) {
    const FrameResult& result = session.frame(head(0.01 * i, 0), i / 60.0);
    EXPECT_NE(result.flags & kOffNavMesh, 0u);
    EXPECT_NE(result.flags & kGroundTaken, 0u);
    EXPECT_NEAR(result.virtualPose.position.x, 0.01f * static_cast<float>(i), 1e-4f);
    EXPECT_NEAR(result.virtualPose.position.y, 1.7f, 1e-3f);
  }
  enter(session, with(mesh, {}));
  const FrameResult& result = session.frame(head(0.1, 0), 0.5);
  EXPECT_EQ(result.flags & (kOffNavMesh | kGroundTaken), 0u);
  EXPECT_NEAR(result.location.height, 0.0f, 0.06f);
}

TEST(SessionWorld, IsEnteredWithoutAnAllocationAndSoAreTheFramesAfter) {
  LiveMesh mesh = hall();
  SessionSettings settings;
  settings.start = VirtualStart{};
  settings.controller = "s2c-predictive";
  Session session = std::move(*Session::make(mesh.world(), settings));
  std::vector<PreparedWorld> worlds;
  std::mt19937_64 rng(10);
  for (int i = 0; i < 40; ++i) {
    std::vector<Obstacle> obstacles;
    for (int k = 0; k < 12; ++k) {
      obstacles.push_back(testing::randomObstacle(rng, {{-9, 1, -9}, {9, 1, 9}}, 3.0));
    }
    worlds.push_back(prepareWorld(with(mesh, obstacles), settings.prediction));
  }
  int frame = 0;
  const auto step = [&] {
    const double t = frame++ / 60.0;
    session.frame(head(2.0 * std::sin(0.5 * t), 2.0 * std::cos(0.5 * t) - 2.0), t);
  };
  for (int i = 0; i < 60; ++i) step();
  testing::allocationsSince();
  for (PreparedWorld& world : worlds) {
    session.enter(world);
    for (int i = 0; i < 5; ++i) step();
  }
  EXPECT_EQ(testing::allocationsSince(), 0u);
}

TEST(SessionWorld, MayChangeWithGraphsByFronts) {
  LiveMesh mesh = hall();
  SessionSettings settings;
  settings.start = VirtualStart{{0.0f, 0.0f, 8.0f}, 0.0f};  // near a wall: the front is no loop
  settings.controller = "none";
  settings.method = prediction::Method::kFront;
  Session session = std::move(*Session::make(mesh.world(), settings));
  session.frame(head(0.0, 0.0), 0.0);
  const auto joins = [&] {
    const auto& nodes = session.result().graph->nodes;
    return std::count_if(nodes.begin(), nodes.end(), [](const prediction::Node& node) {
      return node.kind == prediction::NodeKind::kJoin;
    });
  };
  EXPECT_EQ(joins(), 0);
  const WorldPtr world = with(mesh, {pillar(0.0, 3.0, 1.0)});
  PreparedWorld next = prepareWorld(world, settings.prediction, settings.method);
  session.enter(next);
  session.frame(head(0.0, 0.0), 0.02);
  EXPECT_EQ(session.result().graph->method, prediction::Method::kFront);
  EXPECT_EQ(joins(), 1) << "behind the pillar";
  session.enter(next);
  session.frame(head(0.0, 0.0), 0.04);
  EXPECT_EQ(joins(), 0);
}

}  // namespace
}  // namespace forewalk::rdw
