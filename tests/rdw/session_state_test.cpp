// A session's state travels: another session goes on from it.
#include "rdw/session.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <memory>
#include <string_view>
#include <utility>

#include "navmesh/build/build.h"

namespace forewalk::rdw {
namespace {

std::shared_ptr<const navmesh::World> office() {
  static const auto world = [] {
    const auto scene = navmesh::importScene(FOREWALK_ASSETS "/scenes/office.obj").value();
    auto graph = navmesh::makeNavGraph(navmesh::flatten(navmesh::buildNavMesh(scene).value()));
    return std::make_shared<const navmesh::World>(navmesh::makeWorld(std::move(*graph)));
  }();
  return world;
}

SessionSettings settingsWith(const char* controller,
                             std::string_view reset = resetNames().front()) {
  SessionSettings settings;
  settings.resetPolicy = reset;
  settings.controller = controller;
  settings.start = VirtualStart{{7.0f, 0.0f, 12.0f}, 0.4f};
  return settings;
}

// Back and forth in the room, looking about, now and then up against its border; turns on the spot
// while there is a reset.
struct Body {
  glm::dvec2 position{0.0};
  double heading = 0.0, seconds = 0.0;

  HeadPose step(const FrameResult& last, int frame) {
    constexpr double kDt = 1.0 / 90.0;
    seconds += kDt;
    if (last.reset.turning && last.reset.back > 0.0) {
      position -= 0.7 * kDt * directionOf(heading);
    } else if (last.reset.turning) {
      heading += (last.reset.wanted < 0 ? -1.6 : 1.6) * kDt;
    } else {
      heading += 0.3 * std::sin(0.01 * frame) * kDt;
      position += 1.1 * kDt * directionOf(heading);
    }
    HeadPose head;
    head.position = navmesh::toSpace(glm::vec2(position), 1.7f);
    head.orientation =
        glm::quat(glm::dquat(std::cos(0.5 * heading), 0.0, std::sin(0.5 * heading), 0.0));
    return head;
  }
};

bool same(const FrameResult& a, const FrameResult& b) {
  return a.virtualPose.position == b.virtualPose.position &&
         a.virtualPose.orientation == b.virtualPose.orientation && a.gains == b.gains &&
         a.flags == b.flags && a.reset.turning == b.reset.turning &&
         a.reset.progress == b.reset.progress && a.reset.remaining == b.reset.remaining &&
         a.reset.back == b.reset.back && a.reset.wanted == b.reset.wanted &&
         a.reset.instruction == b.reset.instruction && a.resetCount == b.resetCount &&
         a.location == b.location;
}

TEST(SessionState, GoesOnToTheBitInAnotherSession) {
  // Without a controller all state travels: exchanged every 61 frames, through walks and resets of
  // every kind.
  for (const std::string_view reset : resetNames()) {
    const SessionSettings settings = settingsWith("none", reset);
    Session whole = Session::make(office(), settings).value();
    Session parts = Session::make(office(), settings).value();
    Session spare = Session::make(office(), settings).value();
    Body body;
    int exchangedInResets = 0;
    for (int frame = 0; frame < 4000; ++frame) {
      const HeadPose head = body.step(whole.result(), frame);
      whole.frame(head, body.seconds);
      parts.frame(head, body.seconds);
      ASSERT_TRUE(same(whole.result(), parts.result())) << reset << ", frame " << frame;
      if (frame % 61 != 60) continue;
      exchangedInResets += whole.result().reset.turning ? 1 : 0;
      // The one that takes over has memories of its own, of 61 frames ago; at first none.
      ASSERT_TRUE(spare.resume(parts.state())) << reset;
      std::swap(parts, spare);
    }
    EXPECT_GE(whole.result().resetCount, 5u) << reset;
    EXPECT_GE(exchangedInResets, 5) << reset;
  }
}

TEST(SessionState, MovesNobodyWhateverTheController) {
  for (const char* controller : {"s2c", "s2o", "s2c-predictive"}) {
    Session session = Session::make(office(), settingsWith(controller)).value();
    Body body;
    for (int frame = 0; frame < 2000; ++frame) {
      const HeadPose head = body.step(session.result(), frame);
      session.frame(head, body.seconds);
      if (frame % 499 != 498) continue;
      Session next = Session::make(office(), settingsWith(controller)).value();
      ASSERT_TRUE(next.resume(session.state()));
      EXPECT_EQ(next.redirection(), session.redirection());
      // The same head at the same time: time stands still, and so does what the user sees.
      const HeadPose before = session.result().virtualPose;
      const FrameResult& after = next.frame(head, body.seconds);
      EXPECT_EQ(after.virtualPose.position, before.position) << controller << " " << frame;
      EXPECT_EQ(after.virtualPose.orientation, before.orientation);
      EXPECT_EQ(after.flags & kFirstFrame, 0u);
      session = std::move(next);
    }
  }
}

TEST(SessionState, IsRefusedWhereItCannotBe) {
  Session session = Session::make(office(), settingsWith("none")).value();
  Body body;
  for (int frame = 0; frame < 10; ++frame) {
    session.frame(body.step(session.result(), frame), body.seconds);
  }
  const SessionState sound = session.state();
  Session other = Session::make(office(), settingsWith("none")).value();
  const auto refused = [&](auto change) {
    SessionState state = sound;
    change(state);
    return !other.resume(state);
  };
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(refused([](SessionState& s) { s.redirection.yaw = kNan; }));
  EXPECT_TRUE(refused([](SessionState& s) { s.redirection.offset.x = 1e300; }));
  EXPECT_TRUE(refused([](SessionState& s) { s.reset.state.progress = 1e3; }));
  EXPECT_TRUE(refused([](SessionState& s) { s.motion.seconds = INFINITY; }));
  EXPECT_TRUE(refused([](SessionState& s) { s.reset.state.progress = kNan; }));
  EXPECT_TRUE(refused([](SessionState& s) { s.reset.plan.left = -1.0; }));
  EXPECT_TRUE(refused([](SessionState& s) { s.reset.plan.left = kNan; }));
  EXPECT_TRUE(
      refused([](SessionState& s) { s.reset.plan.left = s.reset.plan.right = ResetPlan::kNever; }));
  EXPECT_TRUE(refused([](SessionState& s) { s.reset.state.back = kNan; }));
  EXPECT_TRUE(refused([](SessionState& s) { s.reset.backward = 1e3; }));
  EXPECT_TRUE(refused([](SessionState& s) { s.physical.position.x = NAN; }));
  EXPECT_TRUE(refused([](SessionState& s) { s.location.plan = {1e4f, 0.0f}; }));
  EXPECT_TRUE(refused([](SessionState& s) { s.location.plan.x = NAN; }));
  EXPECT_TRUE(refused([](SessionState& s) { s.location.polygon = navmesh::PolygonId{1u << 30}; }));
  EXPECT_TRUE(other.resume(sound));
}

}  // namespace
}  // namespace forewalk::rdw
