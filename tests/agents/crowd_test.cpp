#include "agents/crowd.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "agents/models/orca.h"
#include "agents/models/social_forces.h"
#include "agents/scenes.h"

namespace forewalk::agents {
namespace {

TEST(Crowd, WalksEverybodyAcrossTheCircle) {
  const CrowdScene scene = circleScene(50);
  Crowd crowd;
  const std::vector<AgentId> ids = populate(scene, crowd.addModel(makeOrca()), crowd);
  int steps = 0;
  while (!allArrived(scene, ids, crowd) && steps < 600) {
    crowd.step(scene.seconds);
    ++steps;
  }
  EXPECT_LT(steps, 600);
  EXPECT_GT(steps, 80);
}

TEST(Crowd, RefusesAgentsThatCannotBeAndSaysWhy) {
  Crowd crowd;
  const ModelId model = crowd.addModel(makeOrca());
  const auto refusal = [&](auto change) {
    AgentSpec spec;
    spec.model = model;
    change(spec);
    const auto id = crowd.add(spec);
    return id ? std::string("accepted") : id.error().message;
  };
  EXPECT_EQ(refusal([](AgentSpec&) {}), "accepted");
  EXPECT_EQ(refusal([](AgentSpec& spec) { spec.radius = 0.0f; }),
            "agent radius is 0: it has to be above 0 m.");
  EXPECT_EQ(refusal([](AgentSpec& spec) { spec.position.x = NAN; }),
            "agent position.x is nan: it has to be finite.");
  EXPECT_EQ(refusal([](AgentSpec& spec) { spec.model = ModelId{7}; }),
            "agent model is 7, the crowd has 1. Add the model first.");
  EXPECT_NE(refusal([](AgentSpec& spec) { spec.model = kNoModel; }), "accepted");
  EXPECT_EQ(crowd.view().size(), 1u);
}

TEST(Crowd, TakesAndLosesAgentsWhileItRuns) {
  const CrowdScene scene = circleScene(40);
  Crowd crowd;
  const ModelId model = crowd.addModel(makeOrca());
  std::vector<AgentId> ids = populate(scene, model, crowd);
  for (int k = 0; k < 100; ++k) {
    crowd.step(0.1f);
    if (k % 5 == 0) {
      EXPECT_TRUE(crowd.remove(ids.front()));
      EXPECT_FALSE(crowd.remove(ids.front()));
      ids.erase(ids.begin());
      AgentSpec spec;
      spec.model = model;
      spec.position = {-3.0f + 0.1f * static_cast<float>(k), 20.0f};
      ids.push_back(*crowd.add(spec));
      crowd.setGoal(ids.back(), {0.0f, -20.0f});
    }
  }
  EXPECT_EQ(crowd.view().size(), 40u);
  for (const AgentId id : ids) {
    ASSERT_TRUE(crowd.contains(id));
    EXPECT_EQ(crowd.view().id[crowd.indexOf(id)], id);
  }
}

TEST(Crowd, MovesWhatHasAVelocityAndStopsWhatIsStatic) {
  Crowd crowd;
  const ModelId model = crowd.addModel(makeOrca());
  AgentSpec spec;
  spec.model = model;
  spec.position = {0.0f, 5.0f};
  const AgentId walker = *crowd.add(spec);
  spec.flags = kStatic;
  spec.velocity = {1.0f, 0.0f};
  spec.position = {50.0f, 5.0f};
  const AgentId statue = *crowd.add(spec);
  // A cart comes straight at somebody who has nowhere to go.
  const auto cart =
      crowd.addObstacle(navmesh::CylinderObstacle{{0.0f, 0.0f, 0.0f}, 0.5f, 1.0f}, {0.0f, 1.0f});
  ASSERT_TRUE(cart);
  EXPECT_FALSE(crowd.moveObstacle(navmesh::ObstacleId{77}, navmesh::CylinderObstacle{}));
  float nearest = 1e30f;
  for (int k = 0; k < 100; ++k) {
    crowd.step(0.1f);
    const glm::vec2 at = crowd.view().position[crowd.indexOf(walker)];
    nearest = std::min(nearest, glm::distance(at, {0.0f, 0.1f * static_cast<float>(k + 1)}));
  }
  EXPECT_GT(nearest, 0.72f);
  EXPECT_EQ(crowd.view().position[crowd.indexOf(statue)], glm::vec2(50.0f, 5.0f));
  EXPECT_TRUE(crowd.removeObstacle(*cart));
  EXPECT_FALSE(crowd.removeObstacle(*cart));
  EXPECT_TRUE(crowd.walls().empty());
}

TEST(Crowd, MixesModelsAndKeepsAnAgentsMemoryApart) {
  const CrowdScene scene = circleScene(30);
  Crowd crowd;
  const ModelId orca = crowd.addModel(makeOrca());
  const std::vector<AgentId> ids = populate(scene, orca, crowd);
  const ModelId forces = crowd.addModel(makeSocialForces());
  for (std::size_t k = 0; k < ids.size(); k += 2) crowd.setModel(ids[k], forces);
  EXPECT_EQ(crowd.memoryOf(ids[0]).size(), kSocialForceMemory);
  EXPECT_EQ(crowd.memoryOf(ids[1]).size(), 0u);
  int steps = 0;
  while (!allArrived(scene, ids, crowd) && steps < 600) {
    crowd.step(0.1f);
    ++steps;
  }
  EXPECT_LT(steps, 600);
}

TEST(Crowd, AgentWithoutModelOrFlagStandsStill) {
  Crowd crowd;
  AgentSpec spec;
  spec.flags = kPassive;
  const AgentId id = *crowd.add(spec);
  crowd.setGoal(id, {5.0f, 0.0f});
  crowd.step(0.1f);
  EXPECT_NEAR(crowd.view().position[0].x, 0.13f, 1e-3f);
  crowd.setFlags(id, 0);
  crowd.step(0.1f);
  EXPECT_NEAR(crowd.view().position[0].x, 0.13f, 1e-3f);
}

}  // namespace
}  // namespace forewalk::agents
