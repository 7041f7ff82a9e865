// Bodies stay in the room, and nobody is stopped on the spot again and again: every reset, rooms of
// every shape, alone and with somebody else in the same room.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "navmesh/random.h"
#include "rdw/controllers/border_force.h"
#include "rdw/potential_field.h"
#include "rdw/reset.h"
#include "rdw/room_shapes.h"
#include "rdw/simulation.h"

namespace forewalk::rdw {
namespace {

using Rooms = std::vector<std::pair<std::string, TrackedSpace>>;

Rooms smallRooms() {
  Rooms rooms;
  for (const std::string_view shape : roomShapeNames())
    rooms.emplace_back(shape, *roomShape(shape, 16.0));
  const std::vector<glm::dvec2> border{{-3, -3}, {3, -3}, {3, 0}, {0.5, 0}, {0.5, 4}, {-3, 4}};
  const std::vector<std::vector<glm::dvec2>> pillar{
      {{-2, -1.5}, {-1.2, -1.5}, {-1.2, -0.7}, {-2, -0.7}}};
  rooms.emplace_back("L with a pillar", *TrackedSpace::polygon(border, pillar));
  return rooms;
}

/// People, as walkers are by default, each with turns of one kind.
std::vector<SimulationConfig> usersIn(const TrackedSpace& room, std::size_t count,
                                      std::string_view reset, std::uint64_t seed) {
  const auto places = placesInRoom(room, count);
  EXPECT_TRUE(places);
  std::vector<SimulationConfig> users;
  for (std::size_t i = 0; i < count; ++i) {
    SimulationConfig config;
    config.session.space = room;
    config.session.limits = *gainLimitsByName("toolkit");
    config.session.controller = "p2r";
    config.session.resetPolicy = reset;
    config.user.plan = seed % 2 == 1 ? Legs{1.0, 6.0, kPi / 2, true} : Legs{1.0, 6.0, kPi, false};
    config.stop.virtualMetres = 80.0;
    config.stop.seconds = 600.0;
    config.rate = 30.0;
    config.seed = seedOfUser(seed, i);
    config.start.physical = (*places)[i];
    users.push_back(std::move(config));
  }
  return users;
}

/// The most resets that followed each other within a foot.
int mostOnTheSpot(const SimulationResult& walk) {
  int most = 0, inARow = 0;
  glm::dvec2 last(INFINITY);
  bool before = false;
  for (const FrameRecord& frame : walk.frames) {
    if (frame.reset && !before) {
      inARow = glm::distance(frame.physicalPosition, last) < 0.3 ? inARow + 1 : 1;
      last = frame.physicalPosition;
      most = std::max(most, inARow);
    }
    before = frame.reset;
  }
  return most;
}

TEST(StaysInside, ByLessThanIsWalkedBeforeASignIsAnsweredAndIsNotStoppedOnTheSpot) {
  for (const auto& [name, room] : smallRooms()) {
    for (const std::string_view reset : resetNames()) {
      for (const std::size_t count : {1, 2}) {
        for (std::uint64_t seed = 1; seed <= 2; ++seed) {
          const auto users = usersIn(room, count, reset, seed);
          const auto walks = simulateTogether(nullptr, users, Sharing::kRoom);
          ASSERT_TRUE(walks) << walks.error().message;
          for (const SimulationResult& walk : *walks) {
            SCOPED_TRACE(::testing::Message()
                         << name << ", " << reset << ", " << count << " users, seed " << seed);
            const WalkerSettings& walker = users[0].user.walker;
            EXPECT_LT(walk.summary.violationDepth, walker.speed * walker.reactionTime);
            EXPECT_NE(walk.summary.end, WalkEnd::kStuck);
            EXPECT_GT(walk.summary.resets, 5u) << "else this says nothing";
            // Who steps back walks up to the same wall again: that is what this reset is.
            if (reset != "freeze-backup") {
              EXPECT_LE(mostOnTheSpot(walk), count == 1 ? 6 : 10);
            }
          }
        }
      }
    }
  }
}

// Two walks in which somebody once got a centimetre outside, was turned outward by the field, and
// again, for 58 and 15 metres.
TEST(StaysInside, WhoGotOutIsTurnedBackIn) {
  struct Case {
    std::string_view controller, reset, shape;
    std::uint64_t seed;
  };
  for (const Case& each :
       {Case{"p2r", "r2g", "trapezoid", 1}, Case{"dynamic-apf", "sfr2g", "triangle", 2}}) {
    auto users = usersIn(*roomShape(each.shape, 16.0), 2, each.reset, each.seed);
    for (SimulationConfig& user : users) {
      user.session.controller = each.controller;
      user.stop = {150.0, 1000.0};
      user.rate = 60.0;
    }
    const auto walks = simulateTogether(nullptr, users, Sharing::kRoom);
    ASSERT_TRUE(walks) << walks.error().message;
    for (const SimulationResult& walk : *walks) {
      EXPECT_LT(walk.summary.violationDepth, 0.25) << each.reset;
      EXPECT_LT(walk.summary.violationMetres, 2.0) << each.reset;
    }
  }
}

/// A point up to two metres outside the free floor.
glm::dvec2 outside(const TrackedSpace& room, std::mt19937_64& rng) {
  for (;;) {
    const glm::dvec2 point(
        navmesh::uniform(rng, room.lowerBound().x - 2.0, room.upperBound().x + 2.0),
        navmesh::uniform(rng, room.lowerBound().y - 2.0, room.upperBound().y + 2.0));
    if (room.signedDistance(point) < -0.001) return point;
  }
}

TEST(StaysInside, FieldsPushWhoeverIsOutsideBackIn) {
  std::mt19937_64 rng(1);
  for (const auto& [name, room] : smallRooms()) {
    BorderForce border;
    border.prepare(room);
    const OtherUser other{room.centre()};
    for (int i = 0; i < 200; ++i) {
      const glm::dvec2 point = outside(room, rng);
      const double nearer = 0.5 * std::min(0.1, -room.signedDistance(point));
      for (const glm::dvec2 force : {repulsion(room, {}, point),
                                     repulsion(room, {&other, 1}, point), border.at(point, room)}) {
        const glm::dvec2 moved = point + nearer * glm::normalize(force);
        EXPECT_NEAR(room.signedDistance(moved), room.signedDistance(point) + nearer, 1e-9)
            << name << " from " << point.x << ", " << point.y;
      }
    }
  }
}

Motion stepping(glm::dvec2 direction, double speed, bool walking) {
  Motion motion;
  motion.dt = 1.0 / 60.0;
  motion.step = direction * speed * motion.dt;
  motion.distance = speed * motion.dt;
  motion.speed = walking ? speed : 0.1;
  motion.walking = walking;
  if (walking) motion.walkingDirection = direction;
  return motion;
}

// By the time that the smoothed speed is one of walking they would be a foot further out.
TEST(StaysInside, WhoSetsOffOutwardFromOutsideIsStoppedAtTheFirstStep) {
  const TrackedSpace room = *TrackedSpace::rectangle(4, 4);
  Reset reset;
  EXPECT_FALSE(reset.frame(stepping({1, 0}, 0.05, false), {2.01, 0}, room).began) << "sways";
  EXPECT_FALSE(reset.frame(stepping({-1, 0}, 0.5, false), {2.01, 0}, room).began) << "goes back";
  EXPECT_TRUE(reset.frame(stepping({1, 0}, 0.5, false), {2.01, 0}, room).began);
}

TEST(StaysInside, EveryResetOfSomebodyOutsideEndsFacingTheFloor) {
  std::mt19937_64 rng(2);
  const GainLimits limits;
  for (const auto& [name, room] : smallRooms()) {
    for (const std::string_view each : resetNames()) {
      auto policy = *makeReset(each);
      policy->prepare(room, limits);
      for (int i = 0; i < 40; ++i) {
        const PlanarPose pose{outside(room, rng), 0.0};
        const glm::dvec2 inward = room.nearestBorder(pose.position).inward;
        const glm::dvec2 out = rotated(-inward, navmesh::uniform(rng, -1.5, 1.5));
        Reset reset;
        ASSERT_TRUE(
            reset
                .frame({stepping(out, 1.0, true), pose, pose, room, limits, Redirection{}, nullptr},
                       *policy)
                .began);
        const ResetPlan plan = reset.memory().plan;
        for (const double turn : {plan.left, -plan.right}) {
          if (!std::isfinite(turn)) continue;
          EXPECT_GT(glm::dot(rotated(out, turn), inward), 0.0) << name << ", " << each;
        }
        EXPECT_EQ(plan.back, 0.0) << each;
      }
    }
  }
}

// The 2:1 turn sends people back along their line; not for ever along one too short to walk.
TEST(StaysInside, WhoIsSentToAndFroIsTurnedToWhereTheyCanWalk) {
  const TrackedSpace room = *TrackedSpace::rectangle(4, 4);
  const GainLimits limits;
  for (const std::string_view each : {"two-one-turn", "freeze-turn"}) {
    auto policy = *makeReset(each);
    Reset reset;
    double angles[3];
    glm::dvec2 way = directionOf(0.25 * kPi);  // across a corner
    for (double& angle : angles) {
      const PlanarPose pose{{1.6, 1.6}, headingOf(way)};
      ASSERT_TRUE(
          reset
              .frame({stepping(way, 1.0, true), pose, pose, room, limits, Redirection{}, nullptr},
                     *policy)
              .began);
      angle = std::min(reset.memory().plan.left, reset.memory().plan.right);
      way = rotated(way, std::isfinite(reset.memory().plan.left) ? reset.memory().plan.left
                                                                 : -reset.memory().plan.right);
      while (reset.state().turning) {
        Motion motion = stepping({0, 1}, 0.0, false);
        motion.turn = 0.1 * (reset.state().wanted != 0 ? reset.state().wanted : 1);
        reset.frame({motion, pose, pose, room, limits, Redirection{}, nullptr}, *policy);
      }
    }
    EXPECT_DOUBLE_EQ(angles[0], kPi) << each;
    EXPECT_DOUBLE_EQ(angles[1], kPi) << each;
    EXPECT_GT(room.distanceAlong({1.6, 1.6}, way), 2.0) << each;
  }
}

// Stopped at a corner of a table and turned back, they have passed it by the time that they stand:
// turned back again they are stopped at it again (455 times per 100 m, once).
TEST(StaysInside, WhoPassesACornerToAndFroIsTurnedAwayFromIt) {
  const std::vector<glm::dvec2> border{{-3, -3}, {3, -3}, {3, 3}, {-3, 3}};
  const std::vector<std::vector<glm::dvec2>> table{
      {{1.2, 1.0}, {2.4, 1.0}, {2.4, 1.8}, {1.2, 1.8}}};
  const TrackedSpace room = *TrackedSpace::polygon(border, table);
  const GainLimits limits;
  const glm::dvec2 ends[] = {{1.2044, 1.8056}, {1.1930, 1.7715}};
  auto policy = *makeReset("two-one-turn");
  Reset reset;
  glm::dvec2 faced(0.0);
  for (int i = 0; i < 3; ++i) {
    const glm::dvec2 from = ends[i % 2], to = ends[(i + 1) % 2];
    const glm::dvec2 way = glm::normalize(to - from);
    const PlanarPose pose{from, headingOf(way)};
    ASSERT_TRUE(
        reset
            .frame({stepping(way, 0.3, false), pose, pose, room, limits, Redirection{}, nullptr},
                   *policy)
            .began)
        << i;
    const ResetPlan plan = reset.memory().plan;
    faced = rotated(way, std::isfinite(plan.left) ? plan.left : -plan.right);
    while (reset.state().turning) {
      Motion motion = stepping({0, 1}, 0.0, false);
      motion.turn = 0.1 * (reset.state().wanted != 0 ? reset.state().wanted : 1);
      const PlanarPose standing{to, 0.0};
      reset.frame({motion, standing, standing, room, limits, Redirection{}, nullptr}, *policy);
    }
  }
  EXPECT_GT(room.distanceAlong(ends[1], faced), 1.0);
}

// Two centimetres outside, and a little inward along the wall: past a corner that leads 30 cm out.
TEST(StaysInside, WhoWalksPastACornerFromOutsideIsStopped) {
  const TrackedSpace room = *TrackedSpace::rectangle(4, 4);
  const GainLimits limits;
  auto policy = *makeReset("ahead");
  const glm::dvec2 way = glm::normalize(glm::dvec2(1.0, 0.09));
  for (const auto& [x, stopped] : {std::pair(1.85, true), std::pair(0.0, false)}) {
    Reset reset;
    const PlanarPose pose{{x, -2.02}, headingOf(way)};
    const auto step = reset.frame(
        {stepping(way, 1.0, true), pose, pose, room, limits, Redirection{}, nullptr}, *policy);
    EXPECT_EQ(step.began, stopped) << x;
  }
}

// Nobody walks backwards in a straight line; nor was the way behind looked at again.
TEST(StaysInside, SteppingBackEndsBeforeABorder) {
  const TrackedSpace room = *TrackedSpace::rectangle(4, 4);
  const GainLimits limits;
  auto policy = *makeReset("freeze-backup");
  Reset reset;
  PlanarPose pose{{1.6, 0.0}, 0.0};
  ASSERT_TRUE(
      reset
          .frame({stepping({1, 0}, 1.0, true), pose, pose, room, limits, Redirection{}, nullptr},
                 *policy)
          .began);
  const glm::dvec2 askew = glm::normalize(glm::dvec2(-0.3, 1.0));
  while (reset.state().turning) {
    const Motion motion = stepping(askew, 1.0, true);
    pose.position += motion.step;
    ASSERT_TRUE(room.contains(pose.position));
    reset.frame({motion, pose, pose, room, limits, Redirection{}, nullptr}, *policy);
  }
  EXPECT_GT(room.signedDistance(pose.position), 0.15);
}

}  // namespace
}  // namespace forewalk::rdw
