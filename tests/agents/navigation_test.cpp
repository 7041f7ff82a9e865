// Goals over the navmesh: corners, doors, worlds that change, budgets.
#include "agents/navigation.h"

#include <gtest/gtest.h>

#include "agents/crowd.h"
#include "agents/models/orca.h"
#include "agents/overlaps.h"
#include "agents/scenes.h"
#include "navmesh/build/live_mesh.h"
#include "tests/support/block_scene.h"
#include "tests/support/random_mesh.h"

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

// Ground of 12 x 7 squares of a metre. Column 6 is a wall with two doors, squares (6, 1) and (6,
// 5).
struct Doors {
  static constexpr int kColumns = 12, kRows = 7;

  explicit Doors(int count, CrowdSettings settings = {}) {
    settings.project = true;
    settings.navigation.walkerRadius = 0.25f;
    crowd = Crowd(settings);
    world = std::make_shared<const navmesh::World>(
        navmesh::makeWorld(*navmesh::makeNavGraph(forewalk::testing::gridMesh(kColumns, kRows))));
    crowd.setWorld(world);
    crowd.setStates(states(1.0f, 1.0f));
    const ModelId model = crowd.addModel(makeOrca());
    for (int k = 0; k < count; ++k) {
      AgentSpec spec;
      spec.model = model;
      spec.position = origin() + glm::vec2(0.6f + 0.6f * float(k % 4), 0.6f + 0.6f * float(k / 4));
      spec.goalRadius = 0.6f;
      ids.push_back(*crowd.add(spec));
      crowd.setGoal(ids.back(),
                    origin() + glm::vec2(9.0f + 0.6f * float(k % 4), 0.6f + 0.6f * float(k / 4)));
    }
  }

  glm::vec2 origin() const { return world->graph.centroid[0] - 0.5f; }
  static navmesh::PolygonId at(int column, int row) {
    return navmesh::PolygonId{static_cast<std::uint32_t>(row * kColumns + column)};
  }
  /// The wall, and what the doors cost.
  std::shared_ptr<const navmesh::PolygonStates> states(float nearCost, float farCost) const {
    navmesh::PolygonStates made;
    for (int row = 0; row < kRows; ++row) {
      const navmesh::PolygonId one[] = {at(6, row)};
      const float cost = row == 1 ? nearCost : row == 5 ? farCost : navmesh::kClosed;
      EXPECT_TRUE(navmesh::setCost(world->graph, one, cost, made));
    }
    return std::make_shared<const navmesh::PolygonStates>(std::move(made));
  }
  bool isIn(AgentId id, int column, int row) const {
    const glm::vec2 p = crowd.view().position[crowd.indexOf(id)] - origin();
    return static_cast<int>(std::floor(p.x)) == column && static_cast<int>(std::floor(p.y)) == row;
  }
  /// Walks on until all have arrived. How many agent-ticks were spent in squares of the column that
  /// are closed, and in each of the doors.
  int walk(int steps, bool nearShut, bool farShut) {
    int taken = 0;
    while (taken < steps && arrived() < static_cast<int>(ids.size())) {
      crowd.step(0.1f);
      ++taken;
      for (const AgentId id : ids) {
        for (int row = 0; row < kRows; ++row) {
          if (!isIn(id, 6, row)) continue;
          near += row == 1;
          far += row == 5;
          inClosed += (row == 1 && nearShut) || (row == 5 && farShut) || (row != 1 && row != 5);
        }
      }
    }
    return taken;
  }
  int arrived() const {
    int count = 0;
    for (const AgentId id : ids) count += crowd.arrived(id);
    return count;
  }

  std::shared_ptr<const navmesh::World> world;
  Crowd crowd;
  std::vector<AgentId> ids;
  int near = 0, far = 0, inClosed = 0;
};

TEST(NavigationStates, LeadACrowdAroundWhatIsClosed) {
  Doors doors(12);
  doors.crowd.setStates(doors.states(navmesh::kClosed, 1.0f));
  doors.walk(1200, true, false);
  EXPECT_EQ(doors.arrived(), 12);
  EXPECT_EQ(doors.inClosed, 0);
  EXPECT_EQ(doors.near, 0);
  EXPECT_GT(doors.far, 0);
}

TEST(NavigationStates, LeadAroundWhatCostsMoreThanTheDetour) {
  for (const float cost : {1.2f, 50.0f}) {
    Doors doors(1);
    doors.crowd.setStates(doors.states(cost, 1.0f));
    doors.walk(300, false, false);
    EXPECT_EQ(doors.arrived(), 1) << cost;
    EXPECT_EQ(doors.near > 0, cost < 2.0f) << cost;
    EXPECT_EQ(doors.far > 0, cost > 2.0f) << cost;
  }
}

TEST(NavigationStates, TurnACrowdBackWhenTheDoorShutsInFrontOfIt) {
  Doors doors(12);
  doors.walk(38, false, false);
  ASSERT_GT(doors.near, 0);
  ASSERT_LT(doors.arrived(), 12);
  std::vector<AgentId> inside;  // of the door as it shuts: they may leave, and nobody else comes in
  for (const AgentId id : doors.ids) {
    if (doors.isIn(id, 6, 1)) inside.push_back(id);
  }
  doors.crowd.setStates(doors.states(navmesh::kClosed, 1.0f));
  int entered = 0, steps = 0;
  while (doors.arrived() < 12 && ++steps < 1200) {
    doors.crowd.step(0.1f);
    for (const AgentId id : doors.ids) {
      const auto was = std::find(inside.begin(), inside.end(), id);
      if (!doors.isIn(id, 6, 1)) {
        if (was != inside.end()) inside.erase(was);
      } else {
        entered += was == inside.end();
      }
    }
  }
  EXPECT_EQ(doors.arrived(), 12) << "after " << steps;
  EXPECT_EQ(entered, 0);
  EXPECT_TRUE(inside.empty());
}

TEST(NavigationStates, AreFollowedWithinTheBudgetWhileEverybodyWalksOn) {
  CrowdSettings settings;
  settings.navigation.pathsPerTick = 3;
  Doors doors(10, settings);
  doors.walk(8, false, false);  // all have their path, and are on their way
  ASSERT_EQ(doors.crowd.report().waitingForPath, 0u);
  doors.crowd.setStates(doors.states(50.0f, 1.0f));
  EXPECT_EQ(doors.crowd.step(0.1f).waitingForPath, 7u);
  for (const float remaining : doors.crowd.view().remaining) EXPECT_GT(remaining, 1.0f);
  for (const glm::vec2 wish : doors.crowd.view().preferredVelocity) {
    EXPECT_GT(glm::length(wish), 1.0f);
  }
  EXPECT_EQ(doors.crowd.step(0.1f).waitingForPath, 4u);
  doors.walk(1200, false, false);
  EXPECT_EQ(doors.arrived(), 10);
}

TEST(NavigationStates, LeaveNoWayAndGiveItBack) {
  Doors doors(4);
  doors.crowd.setStates(doors.states(navmesh::kClosed, navmesh::kClosed));
  doors.walk(60, true, true);
  EXPECT_EQ(doors.crowd.report().withoutPath, 4u);
  EXPECT_EQ(doors.near + doors.far + doors.inClosed, 0);
  doors.crowd.setStates(doors.states(1.0f, navmesh::kClosed));
  doors.walk(600, false, true);
  EXPECT_EQ(doors.arrived(), 4);
  EXPECT_EQ(doors.far + doors.inClosed, 0);
}

TEST(NavigationStates, AreTheSameOnAnyNumberOfThreadsAndInAnyOrderOfAsking) {
  const auto run = [](const navmesh::ForEach& forEach) {
    Doors doors(12);
    for (int k = 0; k < 120; ++k) {
      if (k == 30) doors.crowd.setStates(doors.states(navmesh::kClosed, 1.0f));
      if (k == 60) doors.crowd.setStates(doors.states(1.0f, 2.0f));
      doors.crowd.step(0.1f, forEach);
    }
    return doors.crowd.hash();
  };
  const navmesh::ForEach backwards = [](std::size_t pieces,
                                        const std::function<void(std::size_t)>& work) {
    for (std::size_t k = pieces; k-- > 0;) work(k);
  };
  EXPECT_EQ(run({}), run(backwards));
}

}  // namespace
}  // namespace forewalk::agents
