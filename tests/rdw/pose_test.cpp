#include "rdw/pose.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "navmesh/random.h"

namespace forewalk::rdw {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

glm::quat yawPitchRoll(double yaw, double pitch, double roll) {
  const auto about = [](double angle, glm::dvec3 axis) {
    return glm::dquat(std::cos(angle / 2), std::sin(angle / 2) * axis);
  };
  return glm::quat(about(yaw, {0, 1, 0}) * about(pitch, {1, 0, 0}) * about(roll, {0, 0, 1}));
}

TEST(Heading, IsTheYawWhateverThePitch) {
  for (double yaw : {-3.0, -1.0, 0.0, 0.5, 2.0, 3.1}) {
    for (double pitch : {-kPi / 2, -1.5, -1.2, -0.4, 0.0, 0.4, 1.2, 1.5, kPi / 2}) {
      EXPECT_NEAR(wrapAngle(headingOf(yawPitchRoll(yaw, pitch, 0.0)) - yaw), 0.0, 1e-5)
          << "yaw " << yaw << " pitch " << pitch;
    }
  }
}

TEST(Heading, DoesNotJumpWhileNoddingThroughTheVerticalWithATiltedHead) {
  for (double roll : {-0.3, 0.0, 0.3}) {
    double last = headingOf(yawPitchRoll(0.7, -1.7, roll));
    for (double pitch = -1.7; pitch < 1.7; pitch += 0.01) {
      const double now = headingOf(yawPitchRoll(0.7, pitch, roll));
      EXPECT_LT(std::abs(wrapAngle(now - last)), 0.1) << "pitch " << pitch << " roll " << roll;
      last = now;
    }
  }
}

TEST(Heading, AgreesWithThePlan) {
  EXPECT_NEAR(headingOf(yawPitchRoll(kPi / 2, 0, 0)), kPi / 2, 1e-6);  // left is -X, plan -x
  EXPECT_NEAR(directionOf(kPi / 2).x, -1.0, 1e-12);
  std::mt19937_64 rng(1);
  for (int i = 0; i < 1000; ++i) {
    const double heading = navmesh::uniform(rng, -kPi, kPi);
    EXPECT_NEAR(wrapAngle(headingOf(directionOf(heading)) - heading), 0.0, 1e-12);
    const double turn = navmesh::uniform(rng, -3.1, 3.1);
    EXPECT_NEAR(angleBetween(directionOf(heading), directionOf(heading + turn)), turn, 1e-12);
    const glm::dvec2 turned = rotated(directionOf(heading), turn);
    EXPECT_NEAR(glm::distance(turned, directionOf(heading + turn)), 0.0, 1e-12);
  }
  EXPECT_EQ(headingOf(glm::dvec2(0.0)), 0.0);
  EXPECT_EQ(angleBetween(glm::dvec2(0.0), glm::dvec2(1.0, 0.0)), 0.0);
}

TEST(WrapAngle, StaysInItsHalfOpenRange) {
  EXPECT_EQ(wrapAngle(kPi), kPi);
  EXPECT_EQ(wrapAngle(-kPi), kPi);
  EXPECT_NEAR(wrapAngle(7.0 * kPi + 0.1), -kPi + 0.1, 1e-12);
}

TEST(Cleaned, LeavesASoundPoseToTheBit) {
  const HeadPose pose{{1.25f, 1.7f, -3.5f}, yawPitchRoll(0.3, 0.2, 0.1)};
  std::uint32_t flags = 0;
  const HeadPose same = cleaned(pose, {}, flags);
  EXPECT_EQ(flags, 0u);
  EXPECT_EQ(same.position, pose.position);
  EXPECT_EQ(same.orientation, pose.orientation);
}

TEST(Cleaned, MendsWhatItCanAndFallsBackWhereItCannot) {
  const HeadPose fallback{{1, 2, 3}, yawPitchRoll(1.0, 0, 0)};
  std::uint32_t flags = 0;
  HeadPose pose = cleaned({{0, kNan, 0}, {2, 0, 0, 0}}, fallback, flags);
  EXPECT_EQ(flags, kPoseNotFinite | kOrientationNotUnit);
  EXPECT_EQ(pose.position, fallback.position);
  EXPECT_EQ(pose.orientation, glm::quat(1, 0, 0, 0));

  for (const glm::quat bad :
       {glm::quat(0, 0, 0, 0), glm::quat(kNan, 0, 0, 1), glm::quat(INFINITY, 0, 0, 0)}) {
    flags = 0;
    pose = cleaned({{0, 0, 0}, bad}, fallback, flags);
    EXPECT_EQ(flags, static_cast<std::uint32_t>(kOrientationUnusable));
    EXPECT_EQ(pose.orientation, fallback.orientation);
  }
  flags = 0;
  EXPECT_EQ(cleaned({{3e6f, 0, 0}, {1, 0, 0, 0}}, fallback, flags).position, fallback.position);
  EXPECT_EQ(flags, static_cast<std::uint32_t>(kPoseNotFinite));
}

}  // namespace
}  // namespace forewalk::rdw
