// A session's state travels: another session goes on from it.
#include "rdw/session.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <memory>

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

SessionSettings settingsWith(const char* controller) {
  SessionSettings settings;
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
    if (last.reset.turning) {
      heading += 1.6 * kDt;
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
         a.reset.progress == b.reset.progress && a.resetCount == b.resetCount &&
         a.location == b.location;
}

TEST(SessionState, GoesOnToTheBitInAnotherSession) {
  // Without a controller all state travels: exchanged every 97 frames, through walks and resets.
  Session whole = Session::make(office(), settingsWith("none")).value();
  Session parts = Session::make(office(), settingsWith("none")).value();
  Body body;
  std::uint64_t resets = 0;
  for (int frame = 0; frame < 6000; ++frame) {
    const HeadPose head = body.step(whole.result(), frame);
    whole.frame(head, body.seconds);
    parts.frame(head, body.seconds);
    ASSERT_TRUE(same(whole.result(), parts.result())) << "frame " << frame;
    resets = whole.result().resetCount;
    if (frame % 97 != 96) continue;
    Session next = Session::make(office(), settingsWith("none")).value();
    ASSERT_TRUE(next.resume(parts.state()));
    parts = std::move(next);
  }
  EXPECT_GE(resets, 5u);
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
  EXPECT_TRUE(refused([](SessionState& s) { s.physical.position.x = NAN; }));
  EXPECT_TRUE(refused([](SessionState& s) { s.location.plan = {1e4f, 0.0f}; }));
  EXPECT_TRUE(refused([](SessionState& s) { s.location.plan.x = NAN; }));
  EXPECT_TRUE(refused([](SessionState& s) { s.location.polygon = navmesh::PolygonId{1u << 30}; }));
  EXPECT_TRUE(other.resume(sound));
}

}  // namespace
}  // namespace forewalk::rdw
