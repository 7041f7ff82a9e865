#include "rdw/steer_to.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>
#include <vector>

#include "navmesh/random.h"

namespace forewalk::rdw {
namespace {

using navmesh::uniform;

const GainLimits kToolkit = *gainLimitsByName("toolkit");

Motion moved(glm::dvec2 step, double turn, double dt = 1.0 / 60.0) {
  Motion motion;
  motion.dt = dt;
  motion.step = step;
  motion.distance = glm::length(step);
  motion.turn = turn;
  motion.turnRate = turn / dt;
  motion.speed = motion.distance / dt;
  motion.walking = motion.speed > 0.3;
  if (motion.walking) motion.walkingDirection = step / motion.distance;
  return motion;
}

TEST(SteerToCore, DoesNothingForSomebodyWhoStands) {
  SteerToCore core;
  const Steering none = core.steer(moved({0.001, 0}, 0.0001), {0, 0}, {0, 1}, {1, 0}, kToolkit);
  EXPECT_EQ(none.by, Steering::By::kNothing);
  EXPECT_EQ(none.yaw, 0.0);
  EXPECT_EQ(asGains(none, moved({0, 0}, 0), kToolkit), Gains{});
}

TEST(SteerToCore, TurnsTheWorldAwayFromTheTargetSoThatTheBodyTurnsTowardIt) {
  for (const double side : {-1.0, 1.0}) {
    SteerToCore core;
    Steering steering;
    const Motion motion = moved({0, 1.0 / 60.0}, 0.0);
    for (int i = 0; i < 200; ++i)
      steering = core.steer(motion, {0, 0}, {0, 1}, {side * -3, 0.0}, kToolkit);
    EXPECT_EQ(steering.by, Steering::By::kCurvature);
    // side = 1: the target lies to the left (plan -x), the body shall turn left, curvature
    // positive.
    EXPECT_NEAR(static_cast<double>(asGains(steering, motion, kToolkit).curvature), side / 7.5,
                1e-6);
  }
}

TEST(SteerToCore, SpendsMoreOnTurnsWithTheWorldThanAgainst) {
  const double turn = 0.02;  // left, 69 degrees/s
  for (const GainLimits& limits : {kToolkit, GainLimits{}}) {
    SteerToCore core;
    Steering steering;
    for (int i = 0; i < 300; ++i)
      steering = core.steer(moved({0, 0}, turn), {0, 0}, {0, 1}, {4, 0}, limits);
    // Target on the right: the world turns left, with the head: the larger gain, up to 30
    // degrees/s.
    EXPECT_EQ(steering.by, Steering::By::kRotation);
    EXPECT_NEAR(steering.yaw,
                std::min(turn * (static_cast<double>(limits.rotationMax) - 1), 30 * kPi / 180 / 60),
                1e-9);
    core.restart();
    for (int i = 0; i < 300; ++i)
      steering = core.steer(moved({0, 0}, turn), {0, 0}, {0, 1}, {-4, 0}, limits);
    EXPECT_NEAR(
        steering.yaw,
        -std::min(turn * (1 - static_cast<double>(limits.rotationMin)), 30 * kPi / 180 / 60), 1e-9);
  }
}

TEST(SteerToCore, IsMirroredInAMirror) {
  std::mt19937_64 rng(3);
  SteerToCore left, right;
  for (int i = 0; i < 500; ++i) {
    const glm::dvec2 step(uniform(rng, -0.02, 0.02), uniform(rng, -0.02, 0.02));
    const double turn = uniform(rng, -0.02, 0.02);
    const glm::dvec2 p(uniform(rng, -3, 3), uniform(rng, -3, 3)),
        target(uniform(rng, -3, 3), uniform(rng, -3, 3));
    const glm::dvec2 h = directionOf(uniform(rng, -3, 3));
    const auto mirrored = [](glm::dvec2 v) { return glm::dvec2(-v.x, v.y); };
    const Steering a = left.steer(moved(step, turn), p, h, target, kToolkit);
    const Steering b = right.steer(moved(mirrored(step), -turn), mirrored(p), mirrored(h),
                                   mirrored(target), kToolkit);
    EXPECT_NEAR(a.yaw, -b.yaw, 1e-15);
    EXPECT_EQ(a.by, b.by);
  }
}

TEST(SteerToCore, KeepsEveryGainWithinTheLimits) {
  std::mt19937_64 rng(4);
  for (const GainPreset& preset : gainPresets()) {
    SteerToCore core;
    for (int i = 0; i < 2000; ++i) {
      const Motion motion = moved({uniform(rng, -0.03, 0.03), uniform(rng, -0.03, 0.03)},
                                  i % 3 == 0 ? uniform(rng, -0.1, 0.1) : uniform(rng, -1e-6, 1e-6));
      const Gains gains = asGains(
          core.steer(motion, {0, 0}, directionOf(uniform(rng, -3, 3)), {2, 1}, preset.limits),
          motion, preset.limits);
      EXPECT_EQ(clamped(gains, preset.limits), gains);
      EXPECT_TRUE(gains.rotation == 1.0f ||
                  gains.curvature == 0.0f);  // one of the two, never the sum
    }
  }
}

/// Walks straight on in virtual space under a controller; 1 m/s.
PlanarPose steered(Controller& controller, const TrackedSpace& space, const GainLimits& limits,
                   double rate, double seconds,
                   const std::function<void(const PlanarPose&)>& look = {}) {
  Redirector redirector;
  PlanarPose body;
  double lastHeading = 0.0;
  for (int i = 0; i < static_cast<int>(seconds * rate); ++i) {
    body.heading = wrapAngle(-redirector.redirection().yaw);
    const glm::dvec2 step = directionOf(body.heading) / rate;
    body.position += step;
    const Motion motion = moved(step, wrapAngle(body.heading - lastHeading), 1.0 / rate);
    lastHeading = body.heading;
    const PlanarPose seen = redirector.redirection().toVirtual(body);
    const Gains gains =
        controller.steer({motion, body, seen, space, limits, redirector.redirection(), nullptr});
    const HeadPose head{
        navmesh::toSpace(glm::vec2(body.position), 1.7f),
        glm::quat(glm::dquat(std::cos(body.heading / 2), 0, std::sin(body.heading / 2), 0))};
    redirector.frame(motion, head, gains);
    if (look) look(body);
  }
  return body;
}

TEST(ReactiveS2C, WalksTheClosedFormCircleAndReachesTwoRadii) {
  const TrackedSpace space = *TrackedSpace::rectangle(100, 100);
  auto controller = makeReactive(SteerRule::kCentre);
  double furthest = 0.0;
  steered(*controller, space, kToolkit, 60.0, 120.0, [&](const PlanarPose& body) {
    furthest = std::max(furthest, glm::length(body.position));
  });
  // 15 m, and what the smoothing and the rise from the exact centre cost.
  EXPECT_GT(furthest, 14.9);
  EXPECT_LT(furthest, 15.9);
}

TEST(ReactiveS2O, SettlesOnACircleOfTheCurvatureRadius) {
  const TrackedSpace space = *TrackedSpace::rectangle(100, 100);
  auto controller = makeReactive(SteerRule::kOrbit);
  double least = 1e9, most = 0.0;
  int frame = 0;
  steered(*controller, space, kToolkit, 60.0, 300.0, [&](const PlanarPose& body) {
    if (++frame < 60 * 200) return;
    least = std::min(least, glm::length(body.position));
    most = std::max(most, glm::length(body.position));
  });
  // A circle of radius R whose centre stays a little beside the room's.
  EXPECT_NEAR(0.5 * (most + least), 7.5, 0.2);
  EXPECT_LT(most - least, 2.0);
}

TEST(Reactive, WalksTheSameWayAtAnyFrameRate) {
  const TrackedSpace space = *TrackedSpace::rectangle(20, 20);
  for (SteerRule rule : {SteerRule::kCentre, SteerRule::kOrbit}) {
    std::vector<PlanarPose> ends;
    for (double rate : {30.0, 60.0, 90.0, 120.0}) {
      auto controller = makeReactive(rule);
      ends.push_back(steered(*controller, space, kToolkit, rate, 8.0));
    }
    for (const PlanarPose& end : ends) {
      EXPECT_LT(glm::distance(end.position, ends.back().position), 0.15);
      EXPECT_LT(std::abs(wrapAngle(end.heading - ends.back().heading)), 0.05);
    }
  }
}

TEST(CentreTarget, SwitchesToTheSideOfTheCentreOnlyWhileItLiesBehind) {
  const TrackedSpace space = *TrackedSpace::rectangle(20, 20);
  CentreTarget rule;
  EXPECT_EQ(rule.target({0, 5}, {1, 0}, space), space.centre());
  // Walking away from the centre, which lies behind on the left.
  const glm::dvec2 heading = directionOf(-0.1);
  const glm::dvec2 aside = rule.target({0, 5}, heading, space);
  EXPECT_NEAR(glm::distance(
                  aside, glm::dvec2(0, 5) +
                             4.0 * rotated(heading, angleBetween(heading, {0, -5}) > 0 ? kPi / 2
                                                                                       : -kPi / 2)),
              0.0, 1e-12);
  // It stays where it was chosen, though the user moves on, and goes when the centre is no longer
  // behind.
  EXPECT_EQ(rule.target({0, 6}, directionOf(-0.2), space), aside);
  EXPECT_EQ(rule.target({0, 6}, {1, 0}, space), space.centre());
}

TEST(OrbitTargets, TouchTheOrbitFromOutside) {
  const TrackedSpace space = *TrackedSpace::rectangle(40, 40);
  EXPECT_EQ(orbitRadius(space), 5.0);
  EXPECT_DOUBLE_EQ(orbitRadius(*TrackedSpace::rectangle(6, 8)), 1.2);
  std::mt19937_64 rng(5);
  for (int i = 0; i < 200; ++i) {
    const glm::dvec2 p = uniform(rng, 5.1, 19.0) * directionOf(uniform(rng, -3, 3));
    const OrbitTargets targets = orbitTargets(p, {0, 1}, space);
    for (const glm::dvec2 t : {targets.counterClockwise, targets.clockwise}) {
      EXPECT_NEAR(glm::length(t), 5.0, 1e-9);
      EXPECT_NEAR(glm::dot(t, t - p), 0.0, 1e-9);  // a tangent
    }
    // Heading for the counter-clockwise one keeps the centre on the left.
    EXPECT_GT(angleBetween(targets.counterClockwise - p, -p), 0.0);
    EXPECT_LT(angleBetween(targets.clockwise - p, -p), 0.0);
  }
}

TEST(OrbitTargets, AreDefinedAtTheCentreItself) {
  const TrackedSpace space = *TrackedSpace::rectangle(6, 6);
  const glm::dvec2 target = orbitTarget({0, 0}, {0, 1}, space);
  EXPECT_NEAR(glm::length(target), 1.2, 1e-12);
  const OrbitTargets both = orbitTargets({0, 0}, {0, 1}, space);
  EXPECT_NEAR(std::abs(angleBetween({0, 1}, both.clockwise)),
              std::abs(angleBetween({0, 1}, both.counterClockwise)), 1e-12);
}

TEST(Controllers, AreMadeByNameAndUnknownNamesListTheKnown) {
  for (std::string_view name : controllerNames()) {
    auto controller = makeController(name);
    ASSERT_TRUE(controller) << name;
    EXPECT_EQ((*controller)->name(), name);
    const bool plans = name.find("predictive") != name.npos || name == "foresight" ||
                       name == "mpcred" || name == "force";
    EXPECT_EQ((*controller)->wantsPrediction(), plans) << name;
  }
  auto unknown = makeController("s2x");
  ASSERT_FALSE(unknown);
  EXPECT_NE(unknown.error().message.find("s2o-predictive"), std::string::npos);
  EXPECT_EQ(steered(**makeController("none"), TrackedSpace(), kToolkit, 60, 3).heading, 0.0);
}

}  // namespace
}  // namespace forewalk::rdw
