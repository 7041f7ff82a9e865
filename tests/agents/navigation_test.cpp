// Goals over the navmesh: corners, doors, worlds that change, budgets.
#include "agents/navigation.h"

#include <gtest/gtest.h>

#include "agents/crowd.h"
#include "agents/models/orca.h"
#include "agents/overlaps.h"
#include "agents/scenes.h"
#include "navmesh/build/live_mesh.h"
#include "tests/support/block_scene.h"

namespace forewalk::agents {
namespace {

using forewalk::testing::twoRooms;
using navmesh::LiveMesh;

LiveMesh rooms(float door = 1.6f) {
  navmesh::BuildSettings settings;
  settings.tile = 5.0f;
  return std::move(*LiveMesh::make(twoRooms(door), settings));
}

/// A crowd of `count` in the left room, all with a goal in the right one.
struct Crossing {
  explicit Crossing(std::shared_ptr<const navmesh::World> world, int count,
                    CrowdSettings settings = {})
      : crowd(settings) {
    crowd.setWorld(std::move(world));
    const ModelId model = crowd.addModel(makeOrca());
    for (int k = 0; k < count; ++k) {
      AgentSpec spec;
      spec.model = model;
      spec.position = navmesh::toPlan(
          {1.0f + 0.7f * static_cast<float>(k % 4), 0.0f, 0.8f + 0.7f * static_cast<float>(k / 4)});
      spec.goalRadius = 0.6f;
      ids.push_back(*crowd.add(spec));
      crowd.setGoal(ids.back(), navmesh::toPlan({9.0f + 0.7f * static_cast<float>(k % 4), 0.0f,
                                                 0.8f + 0.7f * static_cast<float>(k / 4)}));
    }
  }
  int arrived() const {
    int count = 0;
    for (const AgentId id : ids) count += crowd.arrived(id);
    return count;
  }
  Crowd crowd;
  std::vector<AgentId> ids;
};

TEST(Navigation, LeadsOneAgentThroughTheDoor) {
  LiveMesh mesh = rooms();
  Crossing crossing(mesh.world(), 1);
  for (int k = 0; k < 150 && crossing.arrived() == 0; ++k) {
    crossing.crowd.step(0.1f);
    EXPECT_EQ(countWallsEntered(crossing.crowd.view(), crossing.crowd.walls(), 0.02f), 0u);
  }
  EXPECT_EQ(crossing.arrived(), 1);
}

TEST(Navigation, LeadsACrowdThroughTheDoorWithoutEnteringWalls) {
  LiveMesh mesh = rooms();
  CrowdSettings settings;
  settings.project = true;
  Crossing crossing(mesh.world(), 12, settings);
  std::uint64_t walls = 0;
  int steps = 0;
  while (crossing.arrived() < 12 && ++steps < 1200) {
    crossing.crowd.step(0.1f);
    walls += countWallsEntered(crossing.crowd.view(), crossing.crowd.walls(), 0.02f);
  }
  EXPECT_EQ(crossing.arrived(), 12) << "after " << steps << " steps";
  EXPECT_EQ(walls, 0u);
}

TEST(Navigation, SaysHowFarItIsAlongThePath) {
  LiveMesh mesh = rooms();
  Crossing crossing(mesh.world(), 1);
  crossing.crowd.step(0.1f);
  const AgentsView agents = crossing.crowd.view();
  const float straight = glm::distance(agents.position[0], navmesh::toPlan({9.0f, 0.0f, 0.8f}));
  EXPECT_GE(agents.remaining[0], straight - 0.2f);
  EXPECT_LT(agents.remaining[0], straight + 1.5f);
}

TEST(Navigation, ReportsAGoalThatCannotBeReachedAndWaits) {
  LiveMesh mesh = rooms(0.0f);
  Crossing crossing(mesh.world(), 1);
  for (int k = 0; k < 20; ++k) crossing.crowd.step(0.1f);
  EXPECT_EQ(crossing.crowd.report().withoutPath, 1u);
  EXPECT_FALSE(crossing.crowd.arrived(crossing.ids[0]));
  EXPECT_LT(crossing.crowd.view().position[0].x, 2.0f);
}

TEST(Navigation, FindsPathsAnewWithinTheBudgetWhenTheWorldChanges) {
  LiveMesh mesh = rooms();
  CrowdSettings settings;
  settings.navigation.pathsPerTick = 3;
  Crossing crossing(mesh.world(), 10, settings);
  EXPECT_EQ(crossing.crowd.step(0.1f).waitingForPath, 7u);
  EXPECT_EQ(crossing.crowd.step(0.1f).waitingForPath, 4u);
  EXPECT_EQ(crossing.crowd.step(0.1f).waitingForPath, 1u);
  EXPECT_EQ(crossing.crowd.step(0.1f).waitingForPath, 0u);
  // The door is blocked: nobody has a way. Then it is free again.
  const navmesh::BoxObstacle block{{6.1f, 1.0f, 2.0f}, {0.5f, 1.0f, 1.2f}, 0.0f};
  const navmesh::ObstacleChange shut[] = {{navmesh::ObstacleId{1}, block}};
  crossing.crowd.setWorld(mesh.apply(shut)->world);
  for (int k = 0; k < 5; ++k) crossing.crowd.step(0.1f);
  EXPECT_EQ(crossing.crowd.report().withoutPath, 10u);
  const navmesh::ObstacleChange open[] = {{navmesh::ObstacleId{1}, std::nullopt}};
  crossing.crowd.setWorld(mesh.apply(open)->world);
  int steps = 0;
  while (crossing.arrived() < 10 && ++steps < 1200) crossing.crowd.step(0.1f);
  EXPECT_EQ(crossing.arrived(), 10);
}

TEST(Navigation, ClimbsStairsAndKeepsStoreysApart) {
  navmesh::BuildSettings settings;
  settings.tile = 0.0f;
  LiveMesh mesh = std::move(*LiveMesh::make(forewalk::testing::twoStoreys(), settings));
  Crowd crowd;
  crowd.setWorld(mesh.world());
  AgentSpec spec;
  spec.model = crowd.addModel(makeOrca());
  spec.position = navmesh::toPlan({12.0f, 0.0f, 2.0f});
  spec.goalRadius = 0.3f;
  const AgentId climber = *crowd.add(spec);
  crowd.setGoal(climber, navmesh::toPlan({12.0f, 0.0f, 8.0f}), 3.0f);
  // Somebody who stands right above its start is on another floor and in nobody's way.
  spec.flags = kStatic;
  spec.height = 3.0f;
  const AgentId above = *crowd.add(spec);
  int steps = 0;
  float highest = 0.0f;
  while (!crowd.arrived(climber) && ++steps < 600) {
    crowd.step(0.1f);
    highest = std::max(highest, crowd.view().height[crowd.indexOf(climber)]);
  }
  EXPECT_NEAR(crowd.view().height[crowd.indexOf(climber)], 3.0f, 0.3f);
  EXPECT_NEAR(crowd.view().height[crowd.indexOf(above)], 3.0f, 0.3f);
  EXPECT_LT(steps, 600) << crowd.view().position[0].x << " " << crowd.view().position[0].y << " "
                        << crowd.view().height[0];
}

}  // namespace
}  // namespace forewalk::agents
