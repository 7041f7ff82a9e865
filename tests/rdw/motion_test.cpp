#include "rdw/motion.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <utility>
#include <vector>

namespace forewalk::rdw {
namespace {

HeadPose at(glm::dvec2 plan, double heading = 0.0, double height = 1.7) {
  return {navmesh::toSpace(glm::vec2(plan), static_cast<float>(height)),
          glm::quat(glm::dquat(std::cos(heading / 2), 0, std::sin(heading / 2), 0))};
}

/// Runs a tracker at `rate` along a path; calls `look` every frame.
void run(double rate, double seconds, const std::function<HeadPose(double)>& path,
         const std::function<void(double, const Motion&)>& look) {
  MotionTracker tracker;
  for (int i = 0; i <= static_cast<int>(seconds * rate); ++i) {
    const double t = i / rate;
    look(t, tracker.frame(path(t), t));
  }
}

TEST(Motion, HasNoneInTheFirstFrame) {
  MotionTracker tracker;
  const Motion& motion = tracker.frame(at({5, 5}), 1e6);
  EXPECT_EQ(motion.flags, static_cast<std::uint32_t>(kFirstFrame));
  EXPECT_FALSE(motion.usable());
  EXPECT_EQ(motion.distance, 0.0);
}

TEST(Motion, FollowsTheDirectionOfTravelAndNotOfFacing) {
  for (double rate : {22.0, 60.0, 120.0}) {
    for (double facing : {0.0, 1.5, 3.0}) {  // sidestep and walk backwards
      run(
          rate, 2.0,
          [&](double t) {
            return at({1.2 * t, 0}, facing);
          },
          [&](double t, const Motion& motion) {
            if (t < 1.0) return;
            EXPECT_TRUE(motion.walking);
            EXPECT_NEAR(motion.walkingDirection.x, 1.0, 1e-3);
            EXPECT_NEAR(motion.speed, 1.2, 0.02);
            EXPECT_NEAR(motion.turn, 0.0, 1e-6);
          });
    }
  }
}

TEST(Motion, HeadBobAndSwayDoNotBendTheWalk) {
  // 3 cm to either side at 0.9 Hz, 4 cm up and down at 1.8 Hz: a usual gait.
  const auto path = [](double t) {
    return at({0.03 * std::sin(2 * kPi * 0.9 * t), 1.2 * t}, 0.05 * std::sin(5 * t),
              1.7 + 0.04 * std::sin(2 * kPi * 1.8 * t));
  };
  for (double rate : {30.0, 90.0}) {
    run(rate, 6.0, path, [&](double t, const Motion& motion) {
      if (t < 1.0) return;
      EXPECT_TRUE(motion.walking);
      EXPECT_LT(std::abs(angleBetween({0, 1}, motion.walkingDirection)), 7.0 * kPi / 180);
    });
  }
}

TEST(Motion, SwayingAndLookingAroundIsStanding) {
  // A head 10 cm before the neck, turned to and fro by 60 degrees, on a body that sways.
  const auto path = [](double t) {
    const double yaw = 1.05 * std::sin(2 * kPi * 0.4 * t);
    return at(0.1 * directionOf(yaw) + glm::dvec2(0.02 * std::sin(2 * t), 0.02 * std::sin(1.3 * t)),
              yaw);
  };
  for (double rate : {22.0, 60.0, 120.0}) {
    run(rate, 10.0, path, [&](double t, const Motion& motion) {
      EXPECT_FALSE(motion.walking) << "at " << t << " s, " << motion.speed << " m/s";
      EXPECT_EQ(motion.walkingDirection, glm::dvec2(0.0));
    });
  }
}

TEST(Motion, StartsAndStopsWithHysteresis) {
  for (const auto& [before, expected] : {std::pair{0.0, false}, std::pair{1.0, true}}) {
    // 0.22 m/s lies between the two thresholds: what it is called depends on what was before.
    run(
        60.0, 4.0,
        [&](double t) {
          return at({t < 2 ? before * t : before * 2 + 0.22 * (t - 2), 0});
        },
        [&](double t, const Motion& motion) {
          if (t > 3.5) {
            EXPECT_EQ(motion.walking, expected);
          }
        });
  }
}

TEST(Motion, SmoothsTheSameAtAnyFrameRate) {
  const auto path = [](double t) { return at({t, 0.5 * t * t}); };
  std::vector<double> angles;
  for (double rate : {30.0, 60.0, 90.0, 120.0}) {
    double angle = 0.0;
    run(rate, 1.0, path, [&](double, const Motion& motion) {
      angle = angleBetween({1, 0}, motion.walkingDirection);
    });
    angles.push_back(angle);
  }
  for (double angle : angles) EXPECT_NEAR(angle, angles.back(), 0.02);
}

TEST(Motion, LosesNothingWhileTimeStandsStill) {
  MotionTracker tracker;
  tracker.frame(at({0, 0}), 1.0);
  const Motion still = tracker.frame(at({0.01, 0}), 1.0);
  EXPECT_EQ(still.flags, static_cast<std::uint32_t>(kTimeStoodStill));
  EXPECT_EQ(still.distance, 0.0);
  EXPECT_NEAR(tracker.frame(at({0.02, 0}), 1.02).distance, 0.02, 1e-7);
}

TEST(Motion, StartsAgainWhereTimeRunsBackwardsOrIsNoNumber) {
  MotionTracker tracker;
  tracker.frame(at({0, 0}), 1.0);
  EXPECT_EQ(tracker.frame(at({0.01, 0}), 0.5).flags, static_cast<std::uint32_t>(kTimeRanBackwards));
  const Motion after = tracker.frame(at({0.03, 0}), 0.52);
  EXPECT_TRUE(after.usable());
  EXPECT_NEAR(after.distance, 0.02, 1e-7);
  EXPECT_EQ(tracker.frame(at({0.03, 0}), NAN).flags, static_cast<std::uint32_t>(kTimeRanBackwards));
  EXPECT_EQ(tracker.frame(at({0.03, 0}), 0.6).flags, static_cast<std::uint32_t>(kFirstFrame));
  EXPECT_TRUE(tracker.frame(at({0.03, 0}), 0.62).usable());
}

TEST(Motion, CallsAJumpLostTracking) {
  MotionTracker tracker;
  tracker.frame(at({0, 0}), 0.0);
  EXPECT_TRUE(tracker.frame(at({0.999, 0}), 0.1).usable());
  const Motion jump = tracker.frame(at({2.1, 0}), 0.2);
  EXPECT_EQ(jump.flags, static_cast<std::uint32_t>(kTrackingJump));
  EXPECT_EQ(jump.distance, 0.0);
  EXPECT_FALSE(jump.walking);
  EXPECT_NEAR(tracker.frame(at({2.11, 0}), 0.21).distance, 0.01, 1e-6);
}

TEST(Motion, DoesNotIntegrateOverAPause) {
  MotionTracker tracker;
  tracker.frame(at({0, 0}), 0.0);
  EXPECT_EQ(tracker.frame(at({0.5, 0}), 2.0).flags, static_cast<std::uint32_t>(kTimeGap));
}

TEST(Motion, TurnsTheShortWayAcrossPi) {
  MotionTracker tracker;
  tracker.frame(at({0, 0}, kPi - 0.01), 0.0);
  EXPECT_NEAR(tracker.frame(at({0, 0}, -kPi + 0.01), 0.02).turn, 0.02, 1e-5);
}

}  // namespace
}  // namespace forewalk::rdw
