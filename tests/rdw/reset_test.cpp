#include "rdw/reset.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "navmesh/random.h"
#include "rdw/redirector.h"

namespace forewalk::rdw {
namespace {

Motion walking(glm::dvec2 direction, double speed = 1.0, double turn = 0.0) {
  Motion motion;
  motion.dt = 1.0 / 60.0;
  motion.step = direction * speed / 60.0;
  motion.distance = speed / 60.0;
  motion.speed = speed;
  motion.walking = speed > 0.3;
  if (motion.walking) motion.walkingDirection = direction;
  motion.turn = turn;
  motion.turnRate = turn * 60.0;
  return motion;
}

Motion turning(double turn) { return walking({0, 1}, 0.0, turn); }

const TrackedSpace kRoom = *TrackedSpace::rectangle(6, 6);

TEST(ResetTrigger, LeavesAStandingUserAloneAnywhereInside) {
  Reset reset;
  for (double x = 0.0; x <= 3.0; x += 0.1) {
    EXPECT_FALSE(reset.frame(walking({1, 0}, 0.0), {x, 0}, kRoom).began);
  }
  EXPECT_EQ(reset.count(), 0u);
}

TEST(ResetTrigger, StopsAWalkerInTimeAtAnySpeed) {
  const ResetSettings settings;
  for (double speed : {0.4, 1.0, 1.5, 2.5, 4.0}) {
    Reset reset;
    double x = -3.0;
    while (!reset.frame(walking({1, 0}, speed), {x, 0}, kRoom).began) {
      x += speed / 60.0;
      ASSERT_LT(x, 3.0) << speed;
    }
    // Walks on while reacting, then brakes.
    const double stands =
        x + speed * settings.reactionTime + speed * speed / (2 * settings.deceleration);
    EXPECT_LE(stands, 3.0 - settings.clearance + 1e-9) << speed;
    EXPECT_GE(stands, 3.0 - settings.clearance - 2 * speed / 60.0 - 1e-9)
        << speed << ": no earlier than needed";
  }
}

TEST(ResetTrigger, WarnsBefore) {
  Reset reset;
  int warned = 0;
  for (double x = 0.0; x < 3.0; x += 1.0 / 60.0) {
    const Reset::Step step = reset.frame(walking({1, 0}), {x, 0}, kRoom);
    if (step.began) break;
    warned += (step.flags & kBorderNear) != 0;
  }
  EXPECT_NEAR(warned, 60, 2);  // warningTime is a second
}

TEST(ResetTrigger, LooksAlongTheWalkAndNotOnlyAtThePlace) {
  const auto begins = [](glm::dvec2 place, double heading) {
    Reset reset;
    return reset.frame(walking(directionOf(heading)), place, kRoom).began;
  };
  const double right = -kPi / 2;  // toward +x
  EXPECT_TRUE(begins({2.5, 0}, right));
  EXPECT_FALSE(begins({2.9, 0}, right + kPi));  // near the wall, walking away
  EXPECT_FALSE(begins({2.9, 0}, 0.0));          // along it
  EXPECT_FALSE(begins({2.9, 0}, 0.03));         // along it, a little away
  EXPECT_TRUE(begins({2.9, 0}, -0.2));          // grazing into it
  EXPECT_FALSE(begins({2.0, 0}, -0.2));         // the same from further away
  EXPECT_TRUE(begins({2.7, 2.7}, -kPi / 4));    // into the corner
}

TEST(ResetTrigger, DoesNotTurnSomebodyBackAndForthInACorner) {
  // Close to the upper wall, heading slightly into it, the right wall close behind.
  Reset reset;
  EXPECT_FALSE(reset.frame(walking(directionOf(85 * kPi / 180)), {2.75, 2.86}, kRoom).began);
}

TEST(ResetTrigger, StopsWhoeverSetsOffTowardTheBorderBesideThem) {
  // What the motion tracker says of somebody who speeds up by 2 m/s^2 from standing.
  const auto walkedBefore = [](double x, double towards) {
    Reset reset;
    MotionTracker tracker;
    double walked = 0.0, speed = 0.0;
    for (int i = 0; i < 60; ++i) {
      const glm::dvec2 place(x + towards * walked, 0.0);
      HeadPose head;
      head.position = navmesh::toSpace(glm::vec2(place), 1.7f);
      if (reset.frame(tracker.frame(head, i / 60.0), place, kRoom).began) return walked;
      speed = std::min(1.0, speed + 2.0 / 60.0);
      walked += speed / 60.0;
    }
    return walked;
  };
  EXPECT_LT(walkedBefore(2.9, 1.0), 0.02);
  EXPECT_LT(walkedBefore(2.8, 1.0), 0.02);
  EXPECT_LT(walkedBefore(2.75, 1.0), 0.07);
  EXPECT_GT(walkedBefore(2.9, -1.0), 0.5) << "away from it";
}

TEST(ResetTrigger, LetsAHeadSwayBesideTheBorder) {
  Reset reset;
  for (double speed : {0.0, 0.05, 0.09}) {
    EXPECT_FALSE(reset.frame(walking({1, 0}, speed), {2.95, 0}, kRoom).began) << speed;
  }
}

TEST(ResetTrigger, OutsideItLetsThoseBeWhoWalkBack) {
  Reset reset;
  Reset::Step step = reset.frame(walking({-1, 0}), {3.5, 0}, kRoom);
  EXPECT_FALSE(step.began);
  EXPECT_NE(step.flags & kOutsideSpace, 0u);
  EXPECT_EQ(reset.state().instruction, ResetInstruction::kWalkBack);
  EXPECT_FALSE(reset.frame(walking({1, 0}, 0.0), {3.5, 0}, kRoom).began);  // stands
  EXPECT_TRUE(reset.frame(walking({1, 0}), {3.5, 0}, kRoom).began);
}

TEST(ResetTrigger, SeesAPillar) {
  const std::vector<glm::dvec2> border{{-3, -3}, {3, -3}, {3, 3}, {-3, 3}};
  const std::vector<std::vector<glm::dvec2>> holes{
      {{-0.5, -0.5}, {0.5, -0.5}, {0.5, 0.5}, {-0.5, 0.5}}};
  const TrackedSpace room = *TrackedSpace::polygon(border, holes);
  Reset reset;
  EXPECT_FALSE(reset.frame(walking({1, 0}), {-2, 0}, room).began);
  EXPECT_TRUE(reset.frame(walking({1, 0}), {-1, 0}, room).began);
}

/// Turns a user after a trigger by the given steps; returns what was injected.
double injectedBy(Reset& reset, const std::vector<double>& turns) {
  EXPECT_TRUE(reset.frame(walking({1, 0}), {2.9, 0}, kRoom).began);
  double yaw = 0.0;
  for (double turn : turns) yaw += reset.frame(turning(turn), {2.9, 0}, kRoom).yaw;
  return yaw;
}

TEST(ResetTurn, TurnsTheWorldByExactlyPiEitherWayWhateverTheSteps) {
  std::mt19937_64 rng(1);
  for (double side : {-1.0, 1.0}) {
    for (int round = 0; round < 50; ++round) {
      Reset reset;
      ASSERT_TRUE(reset.frame(walking({1, 0}), {2.9, 0}, kRoom).began);
      double injected = 0.0, turned = 0.0;
      bool ended = false;
      while (!ended) {
        const double turn =
            side * navmesh::uniform(rng, -0.02, 0.09);  // now and then back a little
        const Reset::Step step = reset.frame(turning(turn), {2.9, 0}, kRoom);
        injected += step.yaw;
        turned += turn;
        ended = step.ended;
        if (!ended) {
          EXPECT_NEAR(injected, turned, 1e-9);  // seen: twice the body's turn
        }
      }
      EXPECT_NEAR(injected, side * kPi, 1e-9);
      EXPECT_GE(std::abs(turned), kPi - 1e-9);
      EXPECT_FALSE(reset.state().turning);
    }
  }
}

TEST(ResetTurn, TellsHowFarAndWhichWay) {
  Reset reset;
  EXPECT_NEAR(injectedBy(reset, {0.5, 0.5}), 1.0, 1e-12);
  EXPECT_TRUE(reset.state().turning);
  EXPECT_EQ(reset.state().direction, 1);
  EXPECT_NEAR(reset.state().remaining, kPi - 1.0, 1e-12);
  EXPECT_EQ(reset.state().instruction, ResetInstruction::kKeepTurning);
  EXPECT_FALSE(sentenceOf(reset.state().instruction).empty());
  EXPECT_NEAR(reset.frame(turning(-1.5), {2.9, 0}, kRoom).yaw, -1.5,
              1e-12);  // turned back, other way round
  EXPECT_EQ(reset.state().direction, -1);
}

TEST(ResetTurn, IgnoresFramesWithoutMotionAndPassesSteps) {
  Reset reset;
  injectedBy(reset, {1.0});
  Motion jump;
  jump.flags = kTrackingJump;
  EXPECT_EQ(reset.frame(jump, {0, 0}, kRoom).yaw, 0.0);
  EXPECT_TRUE(reset.state().turning);
  const Reset::Step walked = reset.frame(walking({1, 0}, 1.0, 0.1), {2.95, 0}, kRoom);
  EXPECT_NEAR(walked.yaw, 0.1, 1e-12);
  EXPECT_EQ(reset.count(), 1u);
}

TEST(ResetTurn, DoesNotBeginAgainForWhoWalksAwayAfterwards) {
  Reset reset;
  double x = 2.5;
  ASSERT_TRUE(reset.frame(walking({1, 0}), {x, 0}, kRoom).began);
  while (reset.state().turning) reset.frame(turning(0.05), {x, 0}, kRoom);
  for (; x > 0.0; x -= 1.0 / 60.0)
    ASSERT_FALSE(reset.frame(walking({-1, 0}), {x, 0}, kRoom).began) << x;
  EXPECT_EQ(reset.count(), 1u);
}

TEST(ResetTurn, KeepsTheVirtualPlaceAndLookExactly) {
  Redirector redirector(Redirection{0.4, {10, 20}, 0});
  Reset reset;
  const glm::dvec2 place(2.9, 0.0);
  PlanarPose body{place, -kPi / 2};
  const PlanarPose before = redirector.redirection().toVirtual(body);
  ASSERT_TRUE(reset.frame(walking({1, 0}), place, kRoom).began);
  bool ended = false;
  while (!ended) {
    const double turn = std::min(0.03, reset.state().remaining);
    body.heading += turn;
    const Reset::Step step = reset.frame(turning(turn), place, kRoom);
    redirector.turnWorld({navmesh::toSpace(glm::vec2(place), 1.7f), {1, 0, 0, 0}}, step.yaw);
    ended = step.ended;
  }
  const PlanarPose after = redirector.redirection().toVirtual(body);
  EXPECT_NEAR(wrapAngle(after.heading - before.heading), 0.0, 1e-9);  // 360 degrees seen
  EXPECT_NEAR(glm::distance(after.position, before.position), 0.0, 1e-6);
  EXPECT_NEAR(wrapAngle(body.heading - kPi / 2), 0.0, 1e-9);  // 180 turned
}

}  // namespace
}  // namespace forewalk::rdw
