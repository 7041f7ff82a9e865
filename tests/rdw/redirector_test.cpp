#include "rdw/redirector.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>

#include "navmesh/random.h"

namespace forewalk::rdw {
namespace {

using navmesh::uniform;

HeadPose at(glm::dvec2 plan, double heading, double height = 1.7) {
  return {navmesh::toSpace(glm::vec2(plan), static_cast<float>(height)),
          glm::quat(glm::dquat(std::cos(heading / 2), 0, std::sin(heading / 2), 0))};
}

Motion moved(glm::dvec2 step, double turn = 0.0) {
  Motion motion;
  motion.dt = 1.0 / 60.0;
  motion.step = step;
  motion.distance = glm::length(step);
  motion.turn = turn;
  motion.turnRate = turn / motion.dt;
  return motion;
}

/// Walks straight on in virtual space for `metres` under `gains`; the body follows through the map.
PlanarPose walkStraight(const Gains& gains, double metres, double step,
                        const std::function<void(const PlanarPose&)>& look = {}) {
  Redirector redirector;
  PlanarPose body;
  const int steps = static_cast<int>(std::lround(metres / step));
  for (int i = 0; i < steps; ++i) {
    body.heading = -redirector.redirection().yaw;  // faces virtual forward
    const glm::dvec2 way = step * directionOf(body.heading);
    body.position += way;
    redirector.frame(moved(way), at(body.position, body.heading), gains);
    if (look) look(body);
  }
  body.heading = -redirector.redirection().yaw;
  return body;
}

TEST(Redirector, LeavesEveryBitAloneUnderNeutralGains) {
  std::mt19937_64 rng(1);
  Redirector redirector;
  for (int i = 0; i < 1000; ++i) {
    const HeadPose head{
        {static_cast<float>(uniform(rng, -3, 3)), 1.7f, static_cast<float>(uniform(rng, -3, 3))},
        glm::normalize(glm::quat(static_cast<float>(uniform(rng, -1, 1)), 0.1f, 0.2f,
                                 static_cast<float>(uniform(rng, -1, 1))))};
    const Applied applied = redirector.frame(moved({0.02, 0.01}, 0.01), head, Gains{});
    EXPECT_EQ(applied.virtualPose.position, head.position);
    EXPECT_EQ(applied.virtualPose.orientation, head.orientation);
    EXPECT_EQ(applied.injectedYaw, 0.0);
  }
  EXPECT_EQ(redirector.redirection(), Redirection{});

  const Redirection some{0.7, {3, 4}, 1.5};
  Redirector other(some);
  other.frame(moved({0.02, 0.01}, 0.01), at({1, 1}, 0.2), Gains{});
  EXPECT_EQ(other.redirection(), some);
}

TEST(Redirector, BendsAStraightVirtualWalkIntoACircleOfTheGainsRadius) {
  for (float curvature : {1.0f / 7.5f, -1.0f / 7.5f, 1.0f / 22.0f}) {
    const double radius = 1.0 / static_cast<double>(curvature);
    // The body starts facing plan +y; the circle's centre lies to its left for positive curvature.
    const glm::dvec2 centre(-radius, 0.0);
    double worst = 0.0;
    walkStraight({1, 1, curvature, 1}, 50.0, 1.0 / 90.0, [&](const PlanarPose& body) {
      worst = std::max(worst, std::abs(glm::distance(body.position, centre) - std::abs(radius)));
    });
    EXPECT_LT(worst, 0.006) << curvature;  // half a step
  }
}

TEST(Redirector, TurnsTheBodyByLengthOverRadius) {
  for (double length : {1.0, 5.0, 20.0}) {
    const PlanarPose body = walkStraight({1, 1, 1.0f / 7.5f, 1}, length, 0.01);
    EXPECT_NEAR(wrapAngle(body.heading - length / 7.5), 0.0, 1e-5) << length;
  }
}

TEST(Redirector, RotationGainScalesATurnAboutTheHead) {
  for (float gain : {0.67f, 1.24f, 2.0f}) {
    Redirector redirector;
    const glm::dvec2 place(1.5, -0.5);
    double physical = 0.0;
    for (int i = 0; i < 90; ++i) {
      physical += 0.01;
      const Applied applied =
          redirector.frame(moved({0, 0}, 0.01), at(place, physical), {1, gain, 0, 1});
      EXPECT_NEAR(applied.injectedYaw, (static_cast<double>(gain) - 1.0) * 0.01, 1e-12);
      EXPECT_NEAR(applied.virtualPose.position.x, 1.5f,
                  1e-6f);  // about the head: it stays in place
    }
    EXPECT_NEAR(redirector.redirection().toVirtual(PlanarPose{place, physical}).heading,
                static_cast<double>(gain) * 0.9, 1e-9);
  }
}

TEST(Redirector, TranslationGainScalesTheStepInVirtualSpace) {
  Redirector redirector(Redirection{1.0, {5, 5}, 0.0});
  glm::dvec2 body(0.0);
  const glm::dvec2 before = redirector.redirection().toVirtual(body);
  for (int i = 0; i < 100; ++i) {
    const glm::dvec2 step(0.01, 0.005);
    body += step;
    redirector.frame(moved(step), at(body, 0.0), {1.26f, 1, 0, 1});
  }
  const glm::dvec2 walked = redirector.redirection().toVirtual(body) - before;
  EXPECT_NEAR(glm::distance(walked, 1.26 * rotated(body, 1.0)), 0.0, 1e-6);
}

TEST(Redirector, BendingIsTheRatioOfRadii) {
  // The body walks a circle; under a bending gain b the virtual circle is b times as wide.
  for (float bending : {0.5f, 2.0f}) {
    for (float curvature : {0.0f, 0.05f}) {
      Redirector redirector;
      const double physicalTurn = 0.004, step = 0.01;
      PlanarPose body;
      for (int i = 0; i < 200; ++i) {
        body.heading += physicalTurn;
        const glm::dvec2 way = step * directionOf(body.heading);
        body.position += way;
        Motion motion = moved(way, physicalTurn);
        motion.travelTurn = physicalTurn;
        redirector.frame(motion, at(body.position, body.heading), {1, 1, curvature, bending});
      }
      const double virtualTurn = body.heading + redirector.redirection().yaw;
      const double k = static_cast<double>(curvature) * 0.01 * 200;
      EXPECT_NEAR(body.heading - k, static_cast<double>(bending) * virtualTurn, 1e-6);
    }
  }
}

TEST(Redirector, ActsOnNoFrameWithoutMotion) {
  for (FrameFlags flag :
       {kFirstFrame, kTimeStoodStill, kTimeRanBackwards, kTimeGap, kTrackingJump}) {
    Redirector redirector(Redirection{0.3, {1, 2}, 0});
    Motion motion = moved({0.5, 0.5}, 0.5);
    motion.flags = flag;
    EXPECT_EQ(redirector.frame(motion, at({1, 1}, 0), {1.2f, 1.2f, 0.1f, 1}).injectedYaw, 0.0);
    EXPECT_EQ(redirector.redirection(), (Redirection{0.3, {1, 2}, 0}));
  }
}

TEST(Redirector, DoesNotDriftOverAMillionFrames) {
  // A walk to and fro under constant changes of gain that undo each other: the map must come home.
  Redirector redirector;
  const HeadPose left = at({-2, 1}, 0);
  const HeadPose right = at({2, -1}, 0);
  for (int i = 0; i < 250000; ++i) {
    redirector.turnWorld(left, 0.01);
    redirector.turnWorld(right, 0.02);
    redirector.turnWorld(right, -0.02);
    redirector.turnWorld(left, -0.01);
  }
  EXPECT_NEAR(redirector.redirection().yaw, 0.0, 1e-8);
  EXPECT_NEAR(glm::length(redirector.redirection().offset), 0.0, 1e-7);
}

TEST(Redirection, IsUndoneByItsInverse) {
  std::mt19937_64 rng(2);
  for (int i = 0; i < 200; ++i) {
    const Redirection map{
        uniform(rng, -3, 3), {uniform(rng, -50, 50), uniform(rng, -50, 50)}, uniform(rng, -5, 5)};
    const glm::dvec2 p(uniform(rng, -3, 3), uniform(rng, -3, 3));
    const glm::dvec2 q(uniform(rng, -3, 3), uniform(rng, -3, 3));
    EXPECT_NEAR(glm::distance(map.toPhysical(map.toVirtual(p)), p), 0.0, 1e-12);
    EXPECT_NEAR(glm::distance(map.toVirtual(p), map.toVirtual(q)), glm::distance(p, q),
                1e-12);  // rigid
    const HeadPose head = at(p, 0.3);
    const HeadPose back = map.toPhysical(map.toVirtual(head));
    EXPECT_NEAR(glm::distance(back.position, head.position), 0.0f, 2e-5f);
    EXPECT_NEAR(wrapAngle(headingOf(map.toVirtual(head).orientation) - 0.3 - map.yaw), 0.0, 1e-5);
    const PlanarPose body{p, uniform(rng, -3, 3)};
    const PlanarPose goal{q, uniform(rng, -3, 3)};
    const PlanarPose there = alignment(body, goal).toVirtual(body);
    EXPECT_NEAR(glm::distance(there.position, goal.position), 0.0, 1e-12);
    EXPECT_NEAR(wrapAngle(there.heading - goal.heading), 0.0, 1e-12);
  }
}

}  // namespace
}  // namespace forewalk::rdw
