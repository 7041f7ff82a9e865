#include "agents/models/social_forces.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "agents/crowd.h"
#include "agents/overlaps.h"
#include "agents/scenes.h"
#include "navmesh/random.h"

namespace forewalk::agents {
namespace {

TEST(SocialForces, FrictionNeverAddsEnergyNorTurnsTheSlipRound) {
  std::mt19937_64 rng(1);
  for (int k = 0; k < 100000; ++k) {
    const glm::vec2 slip(navmesh::uniform(rng, -5.0, 5.0), navmesh::uniform(rng, -5.0, 5.0));
    const float push = static_cast<float>(navmesh::uniform(rng, 0.0, 1000.0));
    const float seconds = static_cast<float>(navmesh::uniform(rng, 0.001, 0.1));
    // Two bodies of equal mass, each with its half.
    const glm::vec2 after = slip + 2.0f * seconds * frictionOf(slip, push, 1.0f, 0.5f, seconds);
    ASSERT_LE(glm::length(after), glm::length(slip) * 1.00001f);
    ASSERT_GE(glm::dot(after, slip), -1e-4f);
  }
  EXPECT_EQ(frictionOf({0.0f, 0.0f}, 100.0f, 1.0f, 1.0f, 0.02f), glm::vec2(0.0f));
}

TEST(SocialForces, TakesAsManySubStepsAsItsStiffnessNeeds) {
  EXPECT_LT(stableSubStep(1500.0f), 2.0f / std::sqrt(2.0f * 1500.0f));
  Crowd crowd;
  const CrowdScene scene = headOnScene();
  populate(scene, crowd.addModel(makeSocialForces()), crowd);
  EXPECT_EQ(crowd.step(0.1f).subSteps, 5u);
  EXPECT_EQ(crowd.step(0.02f).subSteps, 1u);
}

TEST(SocialForces, CrossesTheCirclesOf100And250WithoutOverlap) {
  for (const std::uint32_t count : {100u, 250u}) {
    const CrowdScene scene = circleScene(count);
    Crowd crowd;
    const std::vector<AgentId> ids = populate(scene, crowd.addModel(makeSocialForces()), crowd);
    OverlapCounter counter;
    OverlapCount overlaps;
    double seconds = 0.0;
    while (!allArrived(scene, ids, crowd) && seconds < 200.0) {
      crowd.step(scene.seconds);
      seconds += 0.1;
      overlaps += counter.count(crowd.view());
    }
    EXPECT_LE(overlaps.pairSteps, count == 100 ? 0u : 1u);
    EXPECT_LT(seconds, 200.0);
  }
}

/// The velocity after one step of an agent at rest, without a goal, beside something.
glm::vec2 pushed(const SocialForceParameters& parameters, glm::vec2 position, bool wall,
                 glm::vec2 otherVelocity = glm::vec2(0.0f), std::uint32_t group = 0) {
  CrowdSettings settings;
  Crowd crowd(settings);
  AgentSpec spec;
  spec.model = crowd.addModel(makeSocialForces(parameters));
  spec.position = position;
  spec.group = group;
  const AgentId self = *crowd.add(spec);
  if (wall) {
    (void)crowd.addObstacle(navmesh::BoxObstacle{{0.0f, 1.0f, 0.0f}, {1.0f, 1.0f, 1.0f}, 0.0f});
  } else {
    spec.position = {0.0f, 0.0f};
    spec.flags = kHuman;
    spec.velocity = otherVelocity;
    (void)*crowd.add(spec);
  }
  crowd.step(0.02f);
  return crowd.view().velocity[crowd.indexOf(self)];
}

TEST(SocialForces, WallsPushAwayAndAttractOnlyInTheLiteralForm) {
  SocialForceParameters parameters;
  EXPECT_GT(pushed(parameters, {0.0f, 1.3f}, true).y, 0.0f);
  EXPECT_GT(pushed(parameters, {1.2f, 1.2f}, true).x, 0.0f);
  parameters.literal = true;
  EXPECT_LT(pushed(parameters, {0.0f, 1.3f}, true).y, 0.0f);
}

TEST(SocialForces, LeavesTheGroundThatAnotherIsAboutToSweep) {
  SocialForceParameters parameters;
  // Two metres ahead of somebody fast and a little to the left: out of the way, to the left.
  parameters.biasSeconds = 1.0f;
  const glm::vec2 left = pushed(parameters, {-0.2f, 2.0f}, false, {0.0f, 1.5f});
  EXPECT_LT(left.x, -1e-3f);
  parameters.biasStrength = 0.0f;
  EXPECT_NEAR(pushed(parameters, {-0.2f, 2.0f}, false, {0.0f, 1.5f}).x, 0.0f, 1e-6f);
}

TEST(SocialForces, DrawsFriendsTogether) {
  const SocialForceParameters parameters;
  EXPECT_LT(pushed(parameters, {2.0f, 0.0f}, false, glm::vec2(0.0f), 3).x, 0.0f);
  EXPECT_GE(pushed(parameters, {2.0f, 0.0f}, false, glm::vec2(0.0f), 0).x, 0.0f);
}

TEST(SocialForces, TellsTheWayPoint) {
  Crowd crowd;
  const CrowdScene scene = headOnScene();
  const std::vector<AgentId> ids = populate(scene, crowd.addModel(makeSocialForces()), crowd);
  for (int k = 0; k < 10; ++k) crowd.step(0.1f);
  const std::span<float> row = crowd.memoryOf(ids[0]);
  ASSERT_EQ(row.size(), kSocialForceMemory);
  const float ahead = row[0] - crowd.view().position[0].x;
  EXPECT_NEAR(ahead, 0.75f * crowd.view().velocity[0].x, 0.15f);
}

}  // namespace
}  // namespace forewalk::agents
