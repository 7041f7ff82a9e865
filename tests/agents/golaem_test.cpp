#include "agents/models/golaem.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "agents/crowd.h"
#include "agents/overlaps.h"
#include "agents/scenes.h"

namespace forewalk::agents {
namespace {

AgentSpec someone(glm::vec2 position, float heading, ModelId model) {
  AgentSpec spec;
  spec.position = position;
  spec.heading = heading;
  spec.model = model;
  return spec;
}

TEST(Golaem, WalksToItsGoalAtComfortSpeedAndStops) {
  Crowd crowd;
  const ModelId model = crowd.addModel(makeGolaem());
  const AgentId id = crowd.add(someone({0, 0}, 1.0f, model)).value();
  crowd.setGoal(id, {3.0f, 12.0f});
  int steps = 0;
  while (!crowd.arrived(id) && steps < 200) {
    crowd.step(0.1f);
    ++steps;
    // It has turned to the goal by then, and is not there yet.
    if (steps > 40 && steps < 80) {
      EXPECT_NEAR(glm::length(crowd.view().velocity[0]), 1.3f, 0.02f);
    }
  }
  EXPECT_LT(steps, 120);
  for (int k = 0; k < 30; ++k) crowd.step(0.1f);
  EXPECT_LT(glm::length(crowd.view().velocity[0]), 0.01f);
  EXPECT_TRUE(crowd.arrived(id));
}

TEST(Golaem, TellsWhichClipsMakeUpItsMotion) {
  Crowd crowd;
  const ModelId model = crowd.addModel(makeGolaem());
  const AgentId id = crowd.add(someone({0, 0}, 2.0f, model)).value();
  crowd.setGoal(id, {0.0f, 10.0f});
  for (int k = 0; k < 80; ++k) {
    crowd.step(0.1f);
    const GolaemRow row = golaemRow(crowd.memoryOf(id));
    ClipBlend blend;
    float sum = 0.0f;
    for (std::size_t c = 0; c < 3; ++c) {
      blend.clip[c] = static_cast<std::uint32_t>(row.clip[c]);
      ASSERT_LT(blend.clip[c], builtInClips()->clips().size());
      sum += blend.weight[c] = row.weight[c];
    }
    EXPECT_NEAR(sum, 1.0f, 1e-5f);
    EXPECT_NEAR(builtInClips()->motionOf(blend).linear, row.linear, 0.005f);
    EXPECT_NEAR(builtInClips()->motionOf(blend).angular, row.angular, 0.005f);
    EXPECT_NEAR(glm::length(crowd.view().velocity[0]), row.linear, 1e-4f);
  }
}

TEST(Golaem, KeepsItsAccelerationLimits) {
  GolaemParameters parameters;
  parameters.linearAcceleration = 1.5f;
  parameters.angularAcceleration = 4.0f;
  Crowd crowd;
  const auto ids = populate(circleScene(20), crowd.addModel(makeGolaem(parameters)), crowd);
  std::vector<Plan> before(ids.size(), Plan::arc(0.0f, 0.0f));
  for (int k = 0; k < 100; ++k) {
    crowd.step(0.1f);
    for (std::size_t i = 0; i < ids.size(); ++i) {
      const Plan& now = crowd.planOf(ids[i]);
      EXPECT_LE(std::abs(now.speed - before[i].speed), 0.15f + 1e-4f);
      EXPECT_LE(std::abs(now.turnRate - before[i].turnRate), 0.4f + 1e-4f);
      before[i] = now;
    }
  }
}

TEST(Golaem, WhoIsBoldLooksLessFarAhead) {
  for (const float boldness : {0.25f, 0.5f, 1.0f}) {
    Crowd crowd;
    const AgentId id = crowd.add(someone({0, 0}, 0.0f, crowd.addModel(makeGolaem()))).value();
    crowd.setGoal(id, {0.0f, 100.0f});
    crowd.step(0.1f);
    GolaemRow row = golaemRow(crowd.memoryOf(id));
    row.boldness = boldness;
    TrajectorySituation situation;
    const AgentsView view = crowd.view();
    NeighbourIndex index;
    index.build(view, 1.0f);
    const Needs needs;
    const std::vector<const Needs*> needsOf{&needs};
    const Neighbourhoods& around = index.gather(view, WallIndex{}, needsOf, {});
    const std::vector<std::uint32_t> which{0};
    const GolaemParameters parameters;
    lookAround(parameters, {view, around, which, 0.1f, 0, -1.0f}, 0, row, situation);
    EXPECT_NEAR(situation.problem.step * 10.0f,
                boldness * parameters.shortestLook + (1.0f - boldness) * parameters.longestLook,
                1e-5f);
  }
}

TEST(Golaem, TwoWhoMeetPassOnTheAgreedSideWithoutTouching) {
  for (const bool dual : {false, true}) {
    GolaemParameters parameters;
    parameters.dual = dual;
    Crowd crowd;
    const CrowdScene scene = headOnScene();
    const auto ids = populate(scene, crowd.addModel(makeGolaem(parameters)), crowd);
    OverlapCounter counter;
    OverlapCount overlaps;
    int steps = 0;
    for (; steps < 150 && !allArrived(scene, ids, crowd); ++steps) {
      crowd.step(scene.seconds);
      overlaps += counter.count(crowd.view());
    }
    EXPECT_LT(steps, 100);
    EXPECT_EQ(overlaps.pairSteps, 0u);
  }
}

TEST(Golaem, IsMirroredInAMirror) {
  const CrowdScene scene = circleScene(16);
  Crowd crowd;
  CrowdSettings other;
  other.side = 1.0f;
  Crowd mirror(other);
  populate(scene, crowd.addModel(makeGolaem()), crowd);
  populate(mirrored(scene), mirror.addModel(makeGolaem()), mirror);
  for (int k = 0; k < 60; ++k) {
    crowd.step(scene.seconds);
    mirror.step(scene.seconds);
  }
  for (std::uint32_t i = 0; i < crowd.view().size(); ++i) {
    EXPECT_EQ(crowd.view().position[i].x, -mirror.view().position[i].x);
    EXPECT_EQ(crowd.view().position[i].y, mirror.view().position[i].y);
  }
}

TEST(Golaem, ACrowdedCircleClears) {
  CrowdSettings settings;
  settings.project = true;
  Crowd crowd(settings);
  const CrowdScene scene = circleScene(30);
  const auto ids = populate(scene, crowd.addModel(makeGolaem()), crowd);
  int steps = 0;
  float deepest = 0.0f;
  while (!allArrived(scene, ids, crowd) && steps < 600) {
    deepest = std::max(deepest, crowd.step(scene.seconds).deepestOverlap);
    ++steps;
  }
  EXPECT_LT(steps, 600);
  EXPECT_LE(deepest, 0.01f);
}

TEST(Golaem, TheLiteralFormStandsWhereBodiesTouch) {
  GolaemParameters parameters;
  parameters.literal = true;
  Crowd crowd;
  const ModelId model = crowd.addModel(makeGolaem(parameters));
  const AgentId a = crowd.add(someone({0.0f, 0.0f}, 0.0f, model)).value();
  const AgentId b = crowd.add(someone({0.4f, 0.0f}, 0.0f, model)).value();
  crowd.setGoal(a, {-5.0f, 0.0f});
  crowd.setGoal(b, {5.0f, 0.0f});
  for (int k = 0; k < 50; ++k) crowd.step(0.1f);
  EXPECT_NEAR(glm::distance(crowd.view().position[0], crowd.view().position[1]), 0.4f, 1e-3f);
  crowd.setModel(a, crowd.addModel(makeGolaem()));
  for (int k = 0; k < 100; ++k) crowd.step(0.1f);
  EXPECT_TRUE(crowd.arrived(a));
}

}  // namespace
}  // namespace forewalk::agents
