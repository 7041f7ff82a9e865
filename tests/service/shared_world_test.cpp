// Users in rooms of their own who share a virtual world: they meet there and make way.
#include "service/shared_world.h"

#include <gtest/gtest.h>

#include <utility>
#include <vector>

#include "rdw/simulation.h"

namespace forewalk::service {
namespace {

/// Walks straight along x from `from` to `to` in a room of 30 m x 30 m.
rdw::SimulationConfig along(float from, float to) {
  rdw::SimulationConfig config;
  config.session.space = *rdw::TrackedSpace::rectangle(30, 30);
  config.session.controller = "none";
  config.user.plan = rdw::Waypoints{{{from, 0.0f, 0.0f}, {to, 0.0f, 0.0f}}, false};
  config.rate = 30.0;
  config.stop.seconds = 40.0;
  return config;
}

std::vector<rdw::SimulationResult> walked(const std::vector<rdw::SimulationConfig>& users) {
  SharedWorld shared(nullptr, 0.25f, users.front().rate, users.size());
  auto results =
      rdw::simulateTogether(nullptr, users, rdw::Sharing::kWorld, {}, shared.companies());
  EXPECT_TRUE(results) << results.error().message;
  return std::move(*results);
}

TEST(SharedWorld, UsersWhoMeetHeadOnMakeWay) {
  const std::vector<rdw::SimulationConfig> users{along(0, 10), along(10, 0)};
  const auto results = walked(users);
  for (const rdw::SimulationResult& result : results) {
    EXPECT_EQ(result.summary.end, rdw::WalkEnd::kFinished);
    ASSERT_TRUE(result.summary.company);
    EXPECT_EQ(result.summary.company->others, 1u);
    EXPECT_EQ(result.summary.company->collisions, 0u);
    EXPECT_LT(result.summary.company->minimumSeparation, 1.0) << "they did meet";
  }
  // Without each other they would have walked through one another.
  const auto blind = rdw::simulateTogether(nullptr, users, rdw::Sharing::kWorld);
  ASSERT_TRUE(blind);
  EXPECT_NEAR((*blind)[0].summary.virtualMetres, 10.0, 0.1);
  EXPECT_GT(results[0].summary.virtualMetres, 10.01);
}

TEST(SharedWorld, ItMakesNoDifferenceWhoIsAskedFirst) {
  std::vector<rdw::SimulationConfig> users{along(0, 10), along(9, -1)};
  const auto there = walked(users);
  std::swap(users[0], users[1]);
  const auto back = walked(users);
  EXPECT_EQ(there[0].summary.traceHash, back[1].summary.traceHash);
  EXPECT_EQ(there[1].summary.traceHash, back[0].summary.traceHash);
}

TEST(SharedWorld, WhoIsDoneIsNoLongerThere) {
  // The second has arrived, in the middle of the first's way, long before the first comes by.
  const std::vector<rdw::SimulationConfig> users{along(0, 10), along(6, 5)};
  const auto results = walked(users);
  EXPECT_EQ(results[0].summary.end, rdw::WalkEnd::kFinished);
  EXPECT_NEAR(results[0].summary.virtualMetres, 10.0, 0.1);
  EXPECT_EQ(results[0].summary.company->collisions, 0u);
}

}  // namespace
}  // namespace forewalk::service
