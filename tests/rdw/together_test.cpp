// Several users at once: in rooms of their own they walk as alone, in one room they keep apart, and
// it makes no difference who is asked first.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <vector>

#include "rdw/other_user.h"
#include "rdw/room_shapes.h"
#include "rdw/simulation.h"

namespace forewalk::rdw {
namespace {

using ::testing::HasSubstr;

SimulationConfig walkerIn(double side, std::uint64_t seed, const char* controller = "s2c") {
  SimulationConfig config;
  config.session.space = *TrackedSpace::rectangle(side, side);
  config.session.controller = controller;
  config.user.plan = Legs{};
  config.stop.virtualMetres = 60.0;
  config.rate = 30.0;
  config.seed = seed;
  return config;
}

std::vector<SimulationConfig> usersIn(double side, std::size_t count,
                                      const char* controller = "s2c") {
  const auto places = placesInRoom(*TrackedSpace::rectangle(side, side), count);
  std::vector<SimulationConfig> users;
  for (std::size_t i = 0; i < count; ++i) {
    users.push_back(walkerIn(side, seedOfUser(5, i), controller));
    users.back().start.physical = (*places)[i];
  }
  return users;
}

std::vector<SimulationResult> walked(const std::vector<SimulationConfig>& users, Sharing sharing) {
  auto results = simulateTogether(nullptr, users, sharing);
  EXPECT_TRUE(results) << results.error().message;
  return std::move(*results);
}

/// The least distance between any two in any frame that both walked.
double nearest(const std::vector<SimulationResult>& results) {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t a = 0; a < results.size(); ++a) {
    for (std::size_t b = 0; b < a; ++b) {
      const std::size_t frames = std::min(results[a].frames.size(), results[b].frames.size());
      for (std::size_t k = 0; k < frames; ++k) {
        least = std::min(least, glm::distance(results[a].frames[k].physicalPosition,
                                              results[b].frames[k].physicalPosition));
      }
    }
  }
  return least;
}

TEST(WalkTogether, RefusesNobodyAndACrowd) {
  const auto none = simulateTogether(nullptr, {}, Sharing::kRoom);
  ASSERT_FALSE(none);
  EXPECT_THAT(none.error().message, HasSubstr("0 walk together, 1 to 16 can"));
  const std::vector<SimulationConfig> crowd(kMostOthers + 2, walkerIn(30, 1));
  EXPECT_FALSE(simulateTogether(nullptr, crowd, Sharing::kRoom));
  std::vector<SimulationConfig> rates(2, walkerIn(30, 1));
  rates[1].rate = 60.0;
  const auto refused = simulateTogether(nullptr, rates, Sharing::kRoom);
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().message, HasSubstr("30 and 60 frames a second"));
}

TEST(WalkTogether, InRoomsOfTheirOwnEverybodyWalksAsAlone) {
  const std::vector<SimulationConfig> users = usersIn(8, 3);
  const auto together = walked(users, Sharing::kWorld);
  for (std::size_t i = 0; i < users.size(); ++i) {
    const auto alone = simulate(nullptr, users[i]);
    ASSERT_TRUE(alone);
    EXPECT_EQ(together[i].summary.traceHash, alone->summary.traceHash) << i;
    EXPECT_EQ(together[i].frames.size(), alone->frames.size()) << i;
  }
}

TEST(WalkTogether, InOneRoomItMakesNoDifferenceWhoIsAskedFirst) {
  for (const char* controller : {"s2c", "p2r", "messinger", "dynamic-apf"}) {
    std::vector<SimulationConfig> users = usersIn(8, 2, controller);
    const auto there = walked(users, Sharing::kRoom);
    std::swap(users[0], users[1]);
    const auto back = walked(users, Sharing::kRoom);
    EXPECT_EQ(there[0].summary.traceHash, back[1].summary.traceHash) << controller;
    EXPECT_EQ(there[1].summary.traceHash, back[0].summary.traceHash) << controller;
    EXPECT_NE(there[0].summary.traceHash, there[1].summary.traceHash) << "seeds differ";
  }
}

TEST(WalkTogether, InOneRoomBodiesKeepApart) {
  const std::vector<SimulationConfig> users = usersIn(8, 3);
  const auto blind = walked(users, Sharing::kWorld);
  const auto seeing = walked(users, Sharing::kRoom);
  EXPECT_LT(nearest(blind), 0.25) << "else this says nothing";
  EXPECT_GT(nearest(seeing), 0.3);
  for (const SimulationResult& result : seeing) {
    EXPECT_EQ(result.summary.end, WalkEnd::kMetres);
    EXPECT_EQ(result.summary.violations, 0u);
  }
}

TEST(WalkTogether, WhoIsDoneLeavesTheRoom) {
  std::vector<SimulationConfig> users = usersIn(8, 2);
  users[1].stop = {};
  users[1].stop.seconds = 1.0;
  const auto results = walked(users, Sharing::kRoom);
  EXPECT_EQ(results[1].summary.frames, 31u);
  EXPECT_GT(results[0].summary.frames, 300u);
  // From then on the first walks as alone: standing in its middle, the other would stop it.
  EXPECT_GT(results[0].summary.virtualMetres, 59.0);
}

TEST(PlacesInRoom, AreInsideApartAndLookInwards) {
  for (const std::string_view shape : roomShapeNames()) {
    const TrackedSpace room = *roomShape(shape, 60.0);
    for (std::size_t users = 2; users <= 6; ++users) {
      const auto places = placesInRoom(room, users);
      ASSERT_TRUE(places) << shape << users << places.error().message;
      ASSERT_EQ(places->size(), users);
      for (std::size_t i = 0; i < users; ++i) {
        const PlanarPose& place = (*places)[i];
        EXPECT_GT(room.signedDistance(place.position), 0.25) << shape << users;
        const glm::dvec2 toCentre = room.centre() - place.position;
        EXPECT_GE(glm::dot(directionOf(place.heading), toCentre), 0.0);
        for (std::size_t j = 0; j < i; ++j) {
          EXPECT_GE(glm::distance(place.position, (*places)[j].position), 1.0) << shape << users;
        }
      }
    }
  }
}

TEST(PlacesInRoom, OfOneIsTheCentreAndTooManyAreRefused) {
  const TrackedSpace room = *TrackedSpace::rectangle(3, 2);
  const auto one = placesInRoom(room, 1);
  ASSERT_TRUE(one);
  EXPECT_EQ((*one)[0].position, room.centre());
  EXPECT_EQ((*one)[0].heading, 0.0);
  const auto crowd = placesInRoom(room, 12);
  ASSERT_FALSE(crowd);
  EXPECT_THAT(crowd.error().message, HasSubstr("the room of 6.0 m^2 has no place for 12 users"));
}

TEST(SeedsOfUsers, AreTheWalksOwnForTheFirstAndAllDiffer) {
  std::set<std::uint64_t> seeds;
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    EXPECT_EQ(seedOfUser(seed, 0), seed);
    for (std::size_t user = 0; user < 16; ++user) seeds.insert(seedOfUser(seed, user));
  }
  EXPECT_EQ(seeds.size(), 50u * 16u);
}

}  // namespace
}  // namespace forewalk::rdw
