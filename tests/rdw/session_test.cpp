#include "rdw/session.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "tests/support/count_allocations.h"

namespace forewalk::rdw {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

/// Rectangles of plan x from row to row; `height(x)` of their corners. Width 40 m in plan y.
std::shared_ptr<const navmesh::World> stripWorld(const std::vector<float>& xs,
                                                 const std::vector<float>& heights) {
  navmesh::PolygonMesh mesh;
  for (std::size_t i = 0; i < xs.size(); ++i) {
    mesh.vertices.push_back({xs[i], heights[i], 20.0f});   // plan y = -20
    mesh.vertices.push_back({xs[i], heights[i], -20.0f});  // plan y = 20
  }
  for (std::uint32_t i = 0; i + 1 < xs.size(); ++i) {
    for (std::uint32_t corner : {2 * i, 2 * i + 2, 2 * i + 3, 2 * i + 1})
      mesh.ring.push_back(corner);
    mesh.ringStart.push_back(static_cast<std::uint32_t>(mesh.ring.size()));
  }
  auto graph = navmesh::makeNavGraph(mesh);
  EXPECT_TRUE(graph) << (graph ? "" : graph.error().message);
  return std::make_shared<const navmesh::World>(navmesh::makeWorld(std::move(*graph)));
}

std::shared_ptr<const navmesh::World> flatWorld() {
  return stripWorld({-20, -10, 0, 10, 20}, {0, 0, 0, 0, 0});
}

HeadPose at(glm::dvec2 plan, double heading = 0.0, float height = 1.7f) {
  return {navmesh::toSpace(glm::vec2(plan), height),
          glm::quat(glm::dquat(std::cos(heading / 2), 0, std::sin(heading / 2), 0))};
}

Session made(std::shared_ptr<const navmesh::World> world, SessionSettings settings = {}) {
  auto session = Session::make(std::move(world), std::move(settings));
  EXPECT_TRUE(session) << (session ? "" : session.error().message);
  return std::move(*session);
}

SessionSettings with(const std::string& controller) {
  SessionSettings settings;
  settings.controller = controller;
  settings.limits = *gainLimitsByName("laboratory");
  return settings;
}

/// Somebody who walks straight on in virtual space at 1 m/s and turns round when told to.
struct StraightWalker {
  PlanarPose body;
  double t = 0.0;

  const FrameResult& step(Session& session, double rate = 60.0) {
    t += 1.0 / rate;
    if (session.result().reset.turning) {
      body.heading += 2.0 / rate;
    } else {
      body.heading = goal_ - session.redirection().yaw;
      body.position += directionOf(body.heading) / rate;
    }
    return session.frame(at(body.position, body.heading), t);
  }

  double goal_ = 0.0;
};

TEST(Session, RefusesSettingsThatCannotWork) {
  const auto refused = [](SessionSettings settings, const std::string& saying) {
    auto session = Session::make(flatWorld(), std::move(settings));
    ASSERT_FALSE(session) << saying;
    EXPECT_NE(session.error().message.find(saying), std::string::npos) << session.error().message;
  };
  refused(with("s2z"), "s2z");
  for (float persistence : {-0.1f, 200.0f, kNan}) {
    SessionSettings settings;
    settings.front.persistence = persistence;
    refused(settings, "persistence");
  }
  for (float horizon : {0.0f, -1.0f, 2000.0f, kNan}) {
    SessionSettings settings;
    settings.horizon = horizon;
    refused(settings, "horizon");
  }
  SessionSettings settings;
  settings.limits.translationMin = 2.0f;
  refused(settings, "translation");
  settings = {};
  settings.motion.timeConstant = 0.0;
  refused(settings, "time constant");
  settings = {};
  settings.reset.deceleration = 0.0;
  refused(settings, "deceleration");
  settings = {};
  settings.start = VirtualStart{{100, 0, 0}, 0};
  refused(settings, "(100, 0, 0)");
  settings.start = VirtualStart{{0, 9, 0}, 0};
  refused(settings, "walkable floor");
  settings.start = VirtualStart{{0, 0, 0}, kNan};
  refused(settings, "nan");
}

TEST(Session, GivesThePhysicalPoseToTheBitWithoutSteering) {
  Session session = made(flatWorld(), with("none"));
  for (int i = 0; i < 200; ++i) {
    const HeadPose head =
        at({0.01 * i, 0.3 * std::sin(0.1 * i)}, 0.02 * i, 1.7f + 0.02f * static_cast<float>(i % 5));
    const FrameResult& result = session.frame(head, i / 60.0);
    EXPECT_EQ(result.virtualPose.position, head.position);
    EXPECT_EQ(result.virtualPose.orientation, head.orientation);
    EXPECT_EQ(result.gains, Gains{});
  }
}

TEST(Session, PutsTheFirstLookAtTheStart) {
  SessionSettings settings = with("none");
  settings.start = VirtualStart{{5.0f, 0.0f, -3.0f}, 1.0f};
  Session session = made(flatWorld(), settings);
  const FrameResult& result = session.frame(at({-1, 2}, -0.4), 0.0);
  EXPECT_NEAR(result.virtualPose.position.x, 5.0f, 1e-5f);
  EXPECT_NEAR(result.virtualPose.position.y, 1.7f, 1e-5f);
  EXPECT_NEAR(result.virtualPose.position.z, -3.0f, 1e-5f);
  EXPECT_NEAR(headingOf(result.virtualPose.orientation), 1.0, 1e-5);
  EXPECT_EQ(result.flags, static_cast<std::uint32_t>(kFirstFrame));
}

TEST(Session, RisesWithTheVirtualFloorWhileTheRealOneIsFlat) {
  // Level to x = 2, then up 3 m over 6 m.
  auto world = stripWorld({-20, 2, 8, 20}, {0, 0, 3, 3});
  SessionSettings settings = with("none");
  settings.space = *TrackedSpace::rectangle(100, 100);
  Session session = made(world, settings);
  for (int i = 0; i <= 900; ++i) {
    const double x = i / 90.0;
    const FrameResult& result = session.frame(at({x, 0.1}, -kPi / 2, 1.6f), i / 90.0);
    const double floor = std::clamp((x - 2) / 2, 0.0, 3.0);
    EXPECT_NEAR(static_cast<double>(result.virtualPose.position.y), floor + 1.6, 2e-3) << x;
    EXPECT_NEAR(static_cast<double>(result.location.height), floor, 2e-3);
    EXPECT_EQ(result.flags & kOffNavMesh, 0u);
  }
}

TEST(Session, StaysUsableWhateverItIsFed) {
  Session session = made(flatWorld(), with("s2c-predictive"));
  session.frame(at({0, 0}), 0.0);
  EXPECT_NE(session.frame(at({kNan, 0}), 0.02).flags & kPoseNotFinite, 0u);
  EXPECT_EQ(session.result().virtualPose.position, at({0, 0}).position);
  HeadPose bad = at({0.02, 0});
  bad.orientation = glm::quat(0, 0, 0, 0);
  EXPECT_NE(session.frame(bad, 0.04).flags & kOrientationUnusable, 0u);
  bad.orientation = glm::quat(3, 0, 0, 0);
  EXPECT_NE(session.frame(bad, 0.06).flags & kOrientationNotUnit, 0u);
  EXPECT_NE(session.frame(at({0.02, 0}), 0.06).flags & kTimeStoodStill, 0u);
  EXPECT_NE(session.frame(at({0.02, 0}), 0.01).flags & kTimeRanBackwards, 0u);
  EXPECT_NE(session.frame(at({0.02, 0}), static_cast<double>(kNan)).flags & kTimeRanBackwards, 0u);
  session.frame(at({0.02, 0}), 1.0);
  EXPECT_NE(session.frame(at({2.02, 0}), 1.02).flags & kTrackingJump, 0u);
  EXPECT_NE(session.frame(at({2.0, 0}), 9.0).flags & kTimeGap, 0u);
  const FrameResult& sound = session.frame(at({1.99, 0}), 9.02);
  EXPECT_EQ(sound.flags & ~static_cast<std::uint32_t>(kBorderNear), 0u);
  EXPECT_TRUE(std::isfinite(sound.virtualPose.position.x));
}

TEST(Session, CarriesTheVirtualPoseAlongRigidlyWhenTrackingJumps) {
  Session session = made(flatWorld(), with("s2c"));
  StraightWalker walker;
  for (int i = 0; i < 90; ++i) walker.step(session);
  const Redirection before = session.redirection();
  const FrameResult& result = session.frame(at({-1.5, -1.0}, 0.5), walker.t + 0.02);
  EXPECT_NE(result.flags & kTrackingJump, 0u);
  EXPECT_EQ(result.injectedYaw, 0.0);
  EXPECT_EQ(session.redirection(), before);
  EXPECT_NEAR(glm::distance(result.virtualPlan.position, before.toVirtual(glm::dvec2(-1.5, -1.0))),
              0.0, 1e-6);
}

TEST(Session, KeepsTheLastPlaceBesideTheNavMesh) {
  SessionSettings settings = with("s2c-predictive");
  settings.start = VirtualStart{{19.8f, 0, 0}, static_cast<float>(-kPi / 2)};
  settings.space = *TrackedSpace::rectangle(30, 30);
  Session session = made(flatWorld(), settings);
  StraightWalker walker;
  walker.goal_ = -kPi / 2;  // off the edge at x = 20
  std::uint32_t seen = 0;
  for (int i = 0; i < 120; ++i) seen |= walker.step(session).flags;
  EXPECT_NE(seen & kSnapped, 0u);
  EXPECT_NE(session.result().flags & kOffNavMesh, 0u);
  EXPECT_NEAR(session.result().location.plan.x, 20.0f, 0.01f);
  EXPECT_TRUE(std::isfinite(session.result().virtualPose.position.x));
}

TEST(Session, StopsTheWalkerInsideAndGoesOnWhereTheyLooked) {
  for (std::string_view controller : controllerNames()) {
    SessionSettings settings = with(std::string(controller));
    settings.horizon = 8.0f;
    Session session = made(flatWorld(), settings);
    StraightWalker walker;
    double virtualWalked = 0.0;
    bool warned = false;
    PlanarPose atBegin;
    for (int i = 0; i < 60 * 60 && virtualWalked < 15.0; ++i) {
      const bool wasTurning = session.result().reset.turning;
      const FrameResult& result = walker.step(session);
      ASSERT_GT(settings.space.signedDistance(walker.body.position), 0.0) << controller;
      if (result.resetBegan) {
        EXPECT_TRUE(warned) << controller;
        atBegin = result.virtualPlan;
      }
      warned = (result.flags & kBorderNear) != 0;
      if (wasTurning && !result.reset.turning) {
        EXPECT_LT(glm::distance(result.virtualPlan.position, atBegin.position), 1e-5) << controller;
      }
      if (!result.reset.turning) virtualWalked += 1.0 / 60.0;
      EXPECT_EQ(clamped(result.gains, settings.limits).curvature, result.gains.curvature);
    }
    EXPECT_GT(session.result().resetCount, 0u) << controller;
    EXPECT_GE(virtualWalked, 15.0) << controller;
  }
}

TEST(Session, SaysWhatItInjects) {
  Session session = made(flatWorld(), with("s2o"));
  StraightWalker walker;
  walker.step(session);
  for (int i = 0; i < 300; ++i) {
    const Redirection before = session.redirection();
    const FrameResult& result = walker.step(session);
    EXPECT_NEAR(wrapAngle(session.redirection().yaw - before.yaw - result.injectedYaw), 0.0, 1e-12);
    EXPECT_NEAR(
        glm::distance(result.virtualPlan.position,
                      before.toVirtual(result.physical.position) + result.injectedTranslation),
        0.0, 1e-12);
  }
}

TEST(Session, IsTheSameInThreeSteps) {
  Session whole = made(flatWorld(), with("s2o-predictive"));
  Session parts = made(flatWorld(), with("s2o-predictive"));
  StraightWalker walker;
  for (int i = 0; i < 600; ++i) {
    walker.step(whole);
    parts.locate(at(walker.body.position, walker.body.heading), walker.t);
    parts.predict();
    const FrameResult& result = parts.steer();
    ASSERT_EQ(result.virtualPose.position, whole.result().virtualPose.position) << i;
    ASSERT_EQ(result.virtualPose.orientation, whole.result().virtualPose.orientation);
    ASSERT_EQ(parts.redirection(), whole.redirection());
  }
}

TEST(Session, AllocatesNothingInAFrame) {
  for (std::string_view controller : controllerNames()) {
    SessionSettings settings = with(std::string(controller));
    settings.horizon = 12.0f;
    Session session = made(flatWorld(), settings);
    StraightWalker walker;
    for (int i = 0; i < 60 * 20; ++i) walker.step(session);  // buffers grow to what the world needs
    testing::allocationsSince();
    for (int i = 0; i < 60 * 20; ++i) walker.step(session);
    EXPECT_EQ(testing::allocationsSince(), 0u) << controller;
  }
}

TEST(Session, PredictsByFrontsWhereSetSo) {
  const auto world = stripWorld({-20, -4, 0, 3, 20}, {0, 0, 0, 0, 0});
  SessionSettings settings = with("s2c-predictive");
  settings.method = prediction::Method::kFront;
  settings.front.persistence = 0.5f;
  settings.frontIndex = makeFrontIndex(*world);
  Session shares = made(world, settings);
  EXPECT_EQ(settings.frontIndex.use_count(), 2);
  settings.frontIndex = nullptr;
  Session owns = made(world, settings);
  const auto index = makeFrontIndex(*world);
  prediction::FrontScratch scratch(world->graph, *index);
  StraightWalker walker;
  for (int i = 0; i < 300; ++i) {
    const FrameResult& result = walker.step(shares);
    owns.frame(at(walker.body.position, walker.body.heading), walker.t);
    const auto& expected =
        prediction::predictFronts(world->graph, result.location, 10.0f, scratch, {0.5f});
    ASSERT_EQ(result.graph->method, prediction::Method::kFront);
    ASSERT_EQ(hashOf(*result.graph), hashOf(expected)) << i;
    ASSERT_EQ(hashOf(*owns.result().graph), hashOf(expected));
    ASSERT_EQ(owns.redirection(), shares.redirection());
  }
}

TEST(Session, AllocatesNothingInAFrameByFronts) {
  SessionSettings settings = with("s2c-predictive");
  settings.method = prediction::Method::kFront;
  settings.horizon = 12.0f;
  Session session = made(flatWorld(), settings);
  StraightWalker walker;
  for (int i = 0; i < 60 * 20; ++i) walker.step(session);  // buffers grow to what the world needs
  testing::allocationsSince();
  for (int i = 0; i < 60 * 20; ++i) walker.step(session);
  EXPECT_EQ(testing::allocationsSince(), 0u);
}

TEST(Session, TeleportsOntoTheNavMeshOnly) {
  Session session = made(flatWorld(), with("none"));
  session.frame(at({0, 0}), 0.0);
  EXPECT_FALSE(session.teleport({{500, 0, 0}, 0}));
  EXPECT_TRUE(session.teleport({{-5, 0, 5}, 2.0f}));
  const FrameResult& result = session.frame(at({0.01, 0}), 0.02);
  EXPECT_NEAR(result.virtualPose.position.x, -5.0f, 1e-5f);
  EXPECT_NEAR(headingOf(result.virtualPose.orientation), 2.0, 1e-5);
}

}  // namespace
}  // namespace forewalk::rdw
