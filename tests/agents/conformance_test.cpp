// What every avoidance model has to do, whatever its method. A new one is added in models.h.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numeric>
#include <random>
#include <thread>

#include "agents/crowd.h"
#include "agents/overlaps.h"
#include "agents/recording.h"
#include "agents/scenes.h"
#include "navmesh/random.h"
#include "tests/agents/models.h"
#include "tests/support/count_allocations.h"

namespace forewalk::agents {
namespace {

#ifdef NDEBUG
constexpr int kDebugShare = 1;
#else
constexpr int kDebugShare = 40;
#endif

class EveryModel : public ::testing::TestWithParam<testing::NamedModel> {
 protected:
  std::unique_ptr<const Model> make() const { return GetParam().make(); }
};

bool isFinite(glm::vec2 v) { return std::isfinite(v.x) && std::isfinite(v.y); }

bool allFinite(const AgentsView& agents) {
  for (std::uint32_t i = 0; i < agents.size(); ++i) {
    if (!isFinite(agents.position[i]) || !isFinite(agents.velocity[i]) ||
        !std::isfinite(agents.heading[i])) {
      return false;
    }
  }
  return true;
}

navmesh::ForEach threads(unsigned count) {
  return [count](std::size_t pieces, const std::function<void(std::size_t)>& work) {
    std::vector<std::thread> running;
    for (unsigned t = 0; t < count; ++t) {
      running.emplace_back([&, t] {
        // From the end, so that the order differs from that of one thread.
        for (std::size_t k = pieces; k-- > 0;) {
          if (k % count == t) work(k);
        }
      });
    }
    for (std::thread& thread : running) thread.join();
  };
}

/// The scene's crowd after so many steps.
Crowd walked(const CrowdScene& scene, std::unique_ptr<const Model> model, int steps,
             const CrowdSettings& settings = {}, const navmesh::ForEach& forEach = {}) {
  Crowd crowd(settings);
  populate(scene, crowd.addModel(std::move(model)), crowd);
  for (int k = 0; k < steps; ++k) crowd.step(scene.seconds, forEach);
  return crowd;
}

CrowdScene withWalls(CrowdScene scene) {
  navmesh::BoxObstacle box;
  box.centre = navmesh::toSpace({3.0f, 1.0f}, 1.0f);
  box.halfSize = {1.0f, 1.0f, 2.0f};
  box.heading = 0.4f;
  scene.obstacles.push_back(box);
  scene.obstacles.push_back(
      navmesh::CylinderObstacle{navmesh::toSpace({-4.0f, -2.0f}, 0.0f), 0.8f, 2.0f});
  scene.obstacles.push_back(
      navmesh::PrismObstacle{{{-3.0f, 3.0f}, {-1.0f, 3.5f}, {-2.0f, 5.0f}}, 0.0f, 2.0f});
  appendLoop(std::vector<glm::vec2>{{-9, -9}, {9, -9}, {9, 9}, {-9, 9}}, glm::vec2(0.0f),
             scene.walls);
  return scene;
}

/// Without the agents that would begin in a wall.
CrowdScene clearOfWalls(CrowdScene scene) {
  std::erase_if(scene.agents, [&](const SceneAgent& agent) {
    CrowdScene alone = scene;
    alone.agents = {agent};
    alone.agents[0].spec.radius += 0.05f;
    alone.agents[0].spec.flags = kStatic;
    Crowd crowd;
    populate(alone, kNoModel, crowd);
    return countWallsEntered(crowd.view(), crowd.walls(), 0.0f) > 0;
  });
  return scene;
}

TEST_P(EveryModel, StepsAnEmptyCrowd) {
  Crowd crowd;
  crowd.addModel(make());
  EXPECT_EQ(crowd.step(0.1f).tick, 1u);
}

TEST_P(EveryModel, WalksOneAgentToItsGoalAndStops) {
  CrowdScene scene;
  SceneAgent agent;
  agent.goal = {3.0f, -4.0f};
  agent.spec.heading = navmesh::headingOf(agent.goal);
  scene.agents.push_back(agent);
  const Crowd crowd = walked(scene, make(), 150);
  EXPECT_LT(glm::distance(crowd.view().position[0], agent.goal), 0.35f);
  EXPECT_LT(glm::length(crowd.view().velocity[0]), 0.1f);
}

TEST_P(EveryModel, StaysAtTheGoalWithSpeedZero) {
  CrowdScene scene;
  SceneAgent agent;
  agent.spec.position = agent.goal = {1.0f, 2.0f};
  agent.spec.preferredSpeed = 0.0f;
  scene.agents.push_back(agent);
  const Crowd crowd = walked(scene, make(), 50);
  EXPECT_LT(glm::distance(crowd.view().position[0], agent.goal), 0.05f);
}

TEST_P(EveryModel, PartsCoincidentAgents) {
  CrowdScene scene;
  for (int k = 0; k < 3; ++k) {
    SceneAgent agent;
    agent.goal = {0.0f, 5.0f};
    scene.agents.push_back(agent);
  }
  CrowdSettings settings;
  settings.project = true;
  const Crowd crowd = walked(scene, make(), 60, settings);
  EXPECT_TRUE(allFinite(crowd.view()));
  EXPECT_LE(crowd.report().deepestOverlap, 0.01f);
}

TEST_P(EveryModel, PassesHeadOnInExactSymmetry) {
  const CrowdScene scene = headOnScene();
  CrowdSettings settings;
  settings.project = true;
  Crowd crowd(settings);
  const std::vector<AgentId> ids = populate(scene, crowd.addModel(make()), crowd);
  OverlapCounter counter;
  OverlapCount overlaps;
  int steps = 0;
  while (!allArrived(scene, ids, crowd) && steps < 600) {
    crowd.step(scene.seconds);
    overlaps += counter.count(crowd.view());
    ++steps;
  }
  EXPECT_LT(steps, 600);
  EXPECT_EQ(overlaps.pairSteps, 0u);
}

/// A model that is allowed to see nobody.
class Blind final : public Model {
 public:
  explicit Blind(std::unique_ptr<const Model> model) : model_(std::move(model)) {}
  const char* name() const override { return model_->name(); }
  Needs needs() const override {
    Needs needs = model_->needs();
    needs.neighbourCount = needs.wallCount = 0;
    return needs;
  }
  std::unique_ptr<Scratch> makeScratch() const override { return model_->makeScratch(); }
  void plan(const PlanInput& input, Memory memory, Scratch& scratch,
            std::span<Plan> plans) const override {
    model_->plan(input, memory, scratch, plans);
  }

 private:
  std::unique_ptr<const Model> model_;
};

TEST_P(EveryModel, WalksOnWhereNoNeighboursAreAllowed) {
  const CrowdScene scene = headOnScene();
  const Crowd crowd = walked(scene, std::make_unique<Blind>(make()), 100);
  for (std::uint32_t i = 0; i < 2; ++i) {
    EXPECT_LT(glm::distance(crowd.view().position[i], scene.agents[i].goal), 0.4f);
  }
}

TEST_P(EveryModel, SurvivesBeingPutIntoAWall) {
  CrowdScene scene = withWalls(randomScene(20, 3));
  for (std::size_t k = 0; k < scene.agents.size(); ++k) {
    // On the edges, in the corners and in the middle of the box.
    scene.agents[k].spec.position =
        glm::vec2(3.0f, 1.0f) + 0.1f * glm::vec2(float(k % 5), float(k / 5));
  }
  scene.agents[0].spec.position = {9.0f, 9.0f};
  scene.agents[1].spec.position = {-3.0f, 3.0f};
  scene.agents[2].spec.position = {-4.0f, -2.0f};
  const Crowd crowd = walked(scene, make(), 100);
  EXPECT_TRUE(allFinite(crowd.view()));
}

TEST_P(EveryModel, KeepsOutOfWallsAndOfEachOtherWithProjection) {
  CrowdScene scene = clearOfWalls(withWalls(randomScene(30, 5)));
  ASSERT_GT(scene.agents.size(), 12u);
  CrowdSettings settings;
  settings.project = true;
  Crowd crowd(settings);
  populate(scene, crowd.addModel(make()), crowd);
  OverlapCounter counter;
  for (int k = 0; k < 20; ++k) crowd.step(0.1f);  // whoever began too near is apart by now
  std::uint64_t overlaps = 0, walls = 0;
  for (int k = 0; k < 300; ++k) {
    crowd.step(0.1f);
    overlaps += counter.count(crowd.view()).pairSteps;
    walls += countWallsEntered(crowd.view(), crowd.walls(), 0.01f);
  }
  EXPECT_EQ(overlaps, 0u);
  EXPECT_EQ(walls, 0u);
}

// To the last bit, for as long as one likes: in a crowd any rounding grows.
TEST_P(EveryModel, WalksTheMirroredSceneInTheMirror) {
  CrowdScene walls = clearOfWalls(withWalls(randomScene(40, 7)));
  // Turned, its corners would be rounded differently in the mirror.
  std::get<navmesh::BoxObstacle>(walls.obstacles[0]).heading = 0.0f;
  const int steps = GetParam().name == std::string("golaem") ? 40 : 400;  // a slow one
  for (const CrowdScene& scene : {randomScene(40, 7), walls}) {
    for (const bool project : {false, true}) {
      CrowdSettings settings, otherSide;
      settings.project = otherSide.project = project;
      otherSide.side = -settings.side;
      Crowd here(settings), there(otherSide);
      populate(scene, here.addModel(make()), here);
      populate(mirrored(scene), there.addModel(make()), there);
      for (int k = 0; k < steps; ++k) {
        here.step(0.1f);
        there.step(0.1f);
        for (std::uint32_t i = 0; i < here.view().size(); ++i) {
          const glm::vec2 image(-there.view().position[i].x, there.view().position[i].y);
          ASSERT_EQ(here.view().position[i], image)
              << (scene.walls.empty() ? "no walls, " : "walls, ")
              << (project ? "projected, " : "free, ") << "agent " << i << ", step " << k;
        }
      }
    }
  }
}

TEST_P(EveryModel, TakesTheSameWayInHalfTheTimeSteps) {
  // Two who pass at a distance, and a wall beside: nothing that a coarser step could tear open.
  CrowdScene scene = headOnScene();
  scene.agents[0].spec.position.y += 1.2f;
  scene.agents[0].goal.y += 1.2f;
  const auto endOf = [&](float seconds, int steps) {
    CrowdScene same = scene;
    same.seconds = seconds;
    return walked(same, make(), steps).view().position[0];
  };
  const glm::vec2 coarse = endOf(0.1f, 60), fine = endOf(0.05f, 120), finer = endOf(0.025f, 240);
  EXPECT_LT(glm::distance(coarse, fine), 0.15f);
  EXPECT_LT(glm::distance(fine, finer), 0.1f);
}

TEST_P(EveryModel, IsTheSameOnAnyNumberOfThreads) {
  const CrowdScene scene = withWalls(randomScene(200, 11));
  CrowdSettings settings;
  settings.project = true;
  const std::uint64_t one = walked(scene, make(), 40, settings).hash();
  EXPECT_EQ(walked(scene, make(), 40, settings, threads(2)).hash(), one);
  EXPECT_EQ(walked(scene, make(), 40, settings, threads(4)).hash(), one);
}

TEST_P(EveryModel, IsTheSameWhateverTheOrderOfStorageAndOfIds) {
  const CrowdScene scene = withWalls(randomScene(120, 13));
  CrowdScene permuted = scene;
  std::vector<std::size_t> order(scene.agents.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::mt19937_64 rng(5);
  for (std::size_t k = order.size(); k > 1; --k) {
    std::swap(order[k - 1],
              order[static_cast<std::size_t>(navmesh::uniformInt(rng, static_cast<int>(k)))]);
  }
  for (std::size_t k = 0; k < order.size(); ++k) permuted.agents[k] = scene.agents[order[k]];
  const Crowd a = walked(scene, make(), 50), b = walked(permuted, make(), 50);
  for (std::uint32_t k = 0; k < order.size(); ++k) {
    ASSERT_EQ(a.view().position[order[k]], b.view().position[k]) << "agent " << order[k];
  }
}

TEST_P(EveryModel, RecordsAndReplaysTheSame) {
  const CrowdScene scene = withWalls(randomScene(60, 17));
  const auto record = [&] {
    Crowd crowd;
    const std::vector<AgentId> ids = populate(scene, crowd.addModel(make()), crowd);
    Recording recording;
    crowd.onStep([&](const AgentsView& agents, const StepReport&) { recording.add(agents); });
    for (int k = 0; k < 60; ++k) {
      if (k == 20) crowd.remove(ids[7]);
      if (k == 30) crowd.setGoal(ids[9], {0.0f, 0.0f});
      crowd.step(0.1f);
    }
    return recording;
  };
  const Recording first = record(), again = record();
  EXPECT_EQ(first, again);
  EXPECT_EQ(first.hash(), again.hash());
  ASSERT_EQ(first.frames(), 60u);
  EXPECT_EQ(first.frame(59).id.size(), 59u);
}

TEST_P(EveryModel, AllocatesNothingAfterTheFirstStep) {
  CrowdScene scene = withWalls(randomScene(150, 19));
  CrowdSettings settings;
  Crowd crowd(settings);
  populate(scene, crowd.addModel(make()), crowd);
  for (int k = 0; k < 40; ++k) crowd.step(0.1f);  // scratch grows to the largest neighbourhood
  forewalk::testing::allocationsSince();
  for (int k = 0; k < 20; ++k) crowd.step(0.1f);
  EXPECT_EQ(forewalk::testing::allocationsSince(), 0u);
}

TEST_P(EveryModel, NeverRunsIntoAHumanWhoDoesNotLook) {
  // Straight through eight agents who stand or come towards; only they can avoid it.
  Crowd crowd;
  const ModelId model = crowd.addModel(make());
  AgentSpec human;
  human.flags = kHuman;
  human.position = {0.0f, -8.0f};
  const AgentId user = *crowd.add(human);
  AgentSpec spec;
  spec.model = model;
  spec.position = {0.1f, 8.0f};
  spec.heading = navmesh::headingOf({0.0f, -1.0f});
  const AgentId walker = *crowd.add(spec);
  crowd.setGoal(walker, {0.1f, -12.0f});
  float nearest = 1e30f;
  for (int k = 0; k < 160; ++k) {
    const glm::vec2 velocity(0.0f, 1.0f);
    crowd.place(user, {0.0f, -8.0f + 0.1f * static_cast<float>(k)}, 0.0f, 0.0f, velocity);
    crowd.step(0.1f);
    const AgentsView agents = crowd.view();
    nearest = std::min(nearest, glm::distance(agents.position[crowd.indexOf(user)],
                                              agents.position[crowd.indexOf(walker)]));
    EXPECT_EQ(agents.position[crowd.indexOf(user)].x, 0.0f);  // nobody moves the user
  }
  EXPECT_GT(nearest, 0.5f * 0.8f);  // a brush of sleeves at most: the user moves between our plans
}

// Equal in Debug and in optimised builds, on one kind of machine: whoever changes what a model does
// changes its number here, knowing it.
TEST_P(EveryModel, EndsInItsGoldenState) {
  CrowdSettings settings;
  settings.project = true;
  const Crowd crowd = walked(withWalls(randomScene(60, 29)), make(), 80, settings);
  EXPECT_EQ(crowd.hash(), GetParam().golden) << std::hex << "0x" << crowd.hash();
}

// FOREWALK_AGENT_STEPS=10000000 runs so many for each model.
TEST_P(EveryModel, StaysFiniteWhateverIsFuzzed) {
  std::mt19937_64 rng(23);
  const char* asked = std::getenv("FOREWALK_AGENT_STEPS");
  const long wanted = asked ? std::atol(asked) : GetParam().fuzzedAgentSteps / kDebugShare;
  long agentSteps = 0;
  while (agentSteps < wanted) {
    const int count = 1 + navmesh::uniformInt(rng, 60);
    CrowdScene scene = randomScene(static_cast<std::uint32_t>(count), rng());
    if (navmesh::uniformInt(rng, 2)) scene = withWalls(scene);
    const float crowding = static_cast<float>(std::exp(navmesh::uniform(rng, -4.0, 1.0)));
    for (SceneAgent& agent : scene.agents) {
      agent.spec.position *= crowding;
      agent.spec.radius = static_cast<float>(std::exp(navmesh::uniform(rng, -5.0, 1.0)));
      agent.spec.preferredSpeed =
          static_cast<float>(std::max(0.0, navmesh::uniform(rng, -1.0, 5.0)));
      agent.spec.maximumSpeed = static_cast<float>(std::max(0.0, navmesh::uniform(rng, -1.0, 6.0)));
      if (navmesh::uniformInt(rng, 3) == 0) {
        agent.spec.maximumAcceleration = static_cast<float>(navmesh::uniform(rng, 0.01, 20.0));
      }
      if (navmesh::uniformInt(rng, 20) == 0) agent.spec.flags = kStatic;
      if (navmesh::uniformInt(rng, 20) == 0) agent.spec.flags = kPassive;
      if (navmesh::uniformInt(rng, 10) == 0) agent.spec.position = scene.agents[0].spec.position;
      agent.spec.group = static_cast<std::uint32_t>(navmesh::uniformInt(rng, 4));
    }
    CrowdSettings settings;
    settings.project = navmesh::uniformInt(rng, 2) == 0;
    Crowd crowd(settings);
    populate(scene, crowd.addModel(make()), crowd);
    const float seconds = static_cast<float>(navmesh::uniform(rng, 0.01, 0.3));
    const int steps = 100;
    for (int k = 0; k < steps; ++k) crowd.step(seconds);
    agentSteps += count * steps;
    ASSERT_TRUE(allFinite(crowd.view())) << "after " << agentSteps << " agent-steps";
  }
}

INSTANTIATE_TEST_SUITE_P(Models, EveryModel, ::testing::ValuesIn(testing::allModels()),
                         [](const auto& instance) {
                           std::string name = instance.param.name;
                           std::replace(name.begin(), name.end(), '-', '_');
                           return name;
                         });

}  // namespace
}  // namespace forewalk::agents
