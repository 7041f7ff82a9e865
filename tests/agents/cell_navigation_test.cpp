// Free, mixed and full cells, paths over them, and who is told when they change.
#include "agents/cell_navigation.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <thread>

#include "agents/crowd.h"
#include "agents/models/social_forces.h"
#include "agents/overlaps.h"
#include "navmesh/build/live_mesh.h"
#include "navmesh/random.h"
#include "tests/support/block_scene.h"

namespace forewalk::agents {
namespace {

using navmesh::ObstacleId;

CellSettings small() {
  CellSettings settings;
  settings.low = glm::vec2(-6.0f);
  settings.high = glm::vec2(6.0f);
  settings.samples = 3;
  settings.reach = 0.5f;
  return settings;
}

GroundCells cellsOf(const CellSettings& settings) { return *GroundCells::make(settings); }

navmesh::Obstacle box(glm::vec2 centre, glm::vec2 halfSize, float heading = 0.0f) {
  return navmesh::BoxObstacle{
      navmesh::toSpace(centre, 1.0f), {halfSize.x, 1.0f, halfSize.y}, heading};
}

navmesh::Obstacle randomObstacle(std::mt19937_64& rng, double half) {
  const auto number = [&](double low, double high) {
    return static_cast<float>(navmesh::uniform(rng, low, high));
  };
  const float x = number(-half, half);
  const glm::vec2 at(x, number(-half, half));
  if (navmesh::uniform(rng) < 0.3) {
    navmesh::CylinderObstacle pillar;
    pillar.foot = navmesh::toSpace(at, 0.0f);
    pillar.radius = number(0.2, 1.2);
    return pillar;
  }
  const float wide = number(0.05, 1.5), deep = number(0.05, 1.5);
  return box(at, {wide, deep}, number(0.0, 3.0));
}

void expectSame(const GroundCells& a, const GroundCells& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::uint32_t cell = 0; cell < a.size(); ++cell) {
    ASSERT_EQ(a.kind(cell), b.kind(cell)) << cell;
    ASSERT_EQ(a.placeOf(cell), b.placeOf(cell)) << cell;
    ASSERT_EQ(a.roomOf(cell), b.roomOf(cell)) << cell;
    for (std::uint32_t d = 0; d < GroundCells::kDirections; ++d) {
      ASSERT_EQ(a.wayRoom(cell, d), b.wayRoom(cell, d)) << cell << " direction " << d;
    }
  }
}

// Dijkstra with nothing clever: the least of all open cells, every time.
std::uint32_t plainCost(const GroundCells& ground, std::uint32_t from, std::uint32_t to,
                        float radius) {
  std::vector<std::uint32_t> cost(ground.size(), CellSearch::kNoWay);
  std::vector<bool> settled(ground.size(), false);
  cost[from] = 0;
  for (;;) {
    std::uint32_t least = GroundCells::kOutside;
    for (std::uint32_t cell = 0; cell < ground.size(); ++cell) {
      if (settled[cell] || cost[cell] == CellSearch::kNoWay) continue;
      if (least == GroundCells::kOutside || cost[cell] < cost[least]) least = cell;
    }
    if (least == GroundCells::kOutside) return cost[to];
    settled[least] = true;
    for (std::uint32_t d = 0; d < GroundCells::kDirections; ++d) {
      if (ground.wayRoom(least, d) < radius) continue;
      const std::uint32_t other = ground.neighbour(least, d);
      cost[other] = std::min(cost[other], cost[least] + (d % 2 ? kDiagonalCost : kStraightCost));
    }
  }
}

TEST(GroundCells, AreWhatLiesOnThem) {
  GroundCells ground = cellsOf(small());
  EXPECT_EQ(ground.kind(ground.cellAt({0.0f, 0.0f})), CellKind::free);
  ground.setObject(ObstacleId{1}, box({0.0f, 0.0f}, {1.6f, 1.6f}));
  EXPECT_FALSE(ground.update().empty());
  EXPECT_EQ(ground.kind(ground.cellAt({0.1f, 0.1f})), CellKind::full);
  EXPECT_EQ(ground.kind(ground.cellAt({1.6f, 0.1f})), CellKind::mixed);
  EXPECT_EQ(ground.kind(ground.cellAt({4.0f, 0.1f})), CellKind::free);
  EXPECT_TRUE(ground.update().empty());
  EXPECT_TRUE(ground.removeObject(ObstacleId{1}));
  ground.update();
  expectSame(ground, cellsOf(small()));
}

TEST(GroundCells, KeepRoomAwayFromEveryObstacle) {
  std::mt19937_64 rng(3);
  GroundCells ground = cellsOf(small());
  std::vector<navmesh::CylinderObstacle> pillars;
  for (std::uint32_t k = 0; k < 12; ++k) {
    navmesh::CylinderObstacle pillar;
    const float x = static_cast<float>(navmesh::uniform(rng, -5, 5));
    pillar.foot = {x, 0.0f, static_cast<float>(navmesh::uniform(rng, -5, 5))};
    pillar.radius = static_cast<float>(navmesh::uniform(rng, 0.02, 0.8));  // some between samples
    ground.setObject(ObstacleId{k}, pillar);
    pillars.push_back(pillar);
  }
  ground.update();
  const float spacing = small().cell / 3.0f;
  for (int k = 0; k < 20000; ++k) {
    const float x = static_cast<float>(navmesh::uniform(rng, -6, 6));
    const glm::vec2 at(x, static_cast<float>(navmesh::uniform(rng, -6, 6)));
    float truth = small().reach;
    for (const auto& pillar : pillars) {
      truth = std::min(truth, glm::distance(at, navmesh::toPlan(pillar.foot)) - pillar.radius);
    }
    const float room = ground.roomAt(at);
    // Never more than there is but for the samples' squares, and never far less.
    EXPECT_LE(room, std::max(0.0f, truth) + 1.42f * spacing);
    EXPECT_GE(room, truth - 1.42f * spacing - 1e-4f);
    if (truth <= 0.0f) {
      EXPECT_EQ(room, 0.0f);
    }
  }
}

TEST(GroundCells, UpdatedAreRebuilt) {
  std::mt19937_64 rng(1);
#ifdef NDEBUG
  constexpr int kMoves = 10000;
#else
  constexpr int kMoves = 1000;  // made anew at each: minutes in a build that is watched
#endif
  const CellSettings settings = small();
  GroundCells ground = cellsOf(settings);
  std::vector<std::pair<ObstacleId, navmesh::Obstacle>> there;
  for (int move = 0; move < kMoves; ++move) {
    const ObstacleId id{static_cast<std::uint32_t>(navmesh::uniformInt(rng, 8))};
    const auto at = std::find_if(there.begin(), there.end(),
                                 [&](const auto& object) { return object.first == id; });
    if (at != there.end() && navmesh::uniform(rng) < 0.3) {
      there.erase(at);
      EXPECT_TRUE(ground.removeObject(id));
    } else {
      const navmesh::Obstacle shape = randomObstacle(rng, 6.5);
      if (at != there.end()) {
        at->second = shape;
      } else {
        there.emplace_back(id, shape);
      }
      ground.setObject(id, shape);
    }
    ground.update();
    GroundCells rebuilt = cellsOf(settings);
    for (auto object = there.rbegin(); object != there.rend(); ++object) {
      rebuilt.setObject(object->first, object->second);
    }
    rebuilt.update();
    expectSame(ground, rebuilt);
    if (HasFatalFailure()) FAIL() << "after move " << move;
  }
}

TEST(CellSearch, CostsWhatBruteForceFinds) {
  std::mt19937_64 rng(2);
  CellSearch search;
  std::vector<std::uint32_t> cells;
  int ways = 0, none = 0;
  for (int scene = 0; scene < 60; ++scene) {
    GroundCells ground = cellsOf(small());
    for (std::uint32_t k = 0; k < 14; ++k)
      ground.setObject(ObstacleId{k}, randomObstacle(rng, 6.0));
    ground.update();
    for (int pair = 0; pair < 4; ++pair) {
      const auto n = static_cast<int>(ground.size());
      const auto from = static_cast<std::uint32_t>(navmesh::uniformInt(rng, n));
      const auto to = static_cast<std::uint32_t>(navmesh::uniformInt(rng, n));
      const float radius = pair % 2 ? 0.3f : 0.2f;
      const std::uint32_t cost = search.find(ground, from, to, radius, cells);
      ASSERT_EQ(cost, plainCost(ground, from, to, radius));
      ASSERT_EQ(cost, search.find(ground, from, to, radius, cells)) << "asked again";
      cost == CellSearch::kNoWay ? ++none : ++ways;
      for (std::size_t k = 1; k < cells.size(); ++k) {
        EXPECT_NE(ground.kind(cells[k]), CellKind::full);
      }
    }
  }
  EXPECT_GT(ways, 50);
  EXPECT_GT(none, 20);
}

/// Agents with random paths among random objects.
struct Paths {
  explicit Paths(std::uint64_t seed) : rng(seed), navigation(cellsOf(small())) {
    for (std::uint32_t k = 0; k < 10; ++k) {
      navigation.ground().setObject(ObstacleId{k}, randomObstacle(rng, 6.0));
    }
    navigation.update([](std::uint32_t) {});
    for (std::uint32_t agent = 0; agent < 40; ++agent) {
      navigation.add();
      const auto at = [&] { return static_cast<float>(navmesh::uniform(rng, -5.9, 5.9)); };
      const float x = at(), y = at(), u = at();
      start.push_back({x, y});
      goal.push_back({u, at()});
      path.emplace_back();
      find(agent);
    }
  }
  bool find(std::uint32_t agent) {
    const bool found = navigation.find(agent, start[agent], goal[agent], 0.25f, 1.0f, path[agent]);
    if (!found) path[agent].clear();
    return found;
  }
  std::mt19937_64 rng;
  CellNavigation navigation;
  std::vector<glm::vec2> start, goal;
  std::vector<std::vector<glm::vec2>> path;
};

TEST(CellNavigation, NeverEntersFullCellsNorBlockedGround) {
  int found = 0;
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    Paths paths(seed);
    const GroundCells& ground = paths.navigation.ground();
    for (std::uint32_t agent = 0; agent < paths.path.size(); ++agent) {
      const auto& path = paths.path[agent];
      if (path.empty() || ground.roomAt(path[0]) == 0.0f) continue;
      ++found;
      for (const std::uint32_t cell : paths.navigation.cellsOf(agent)) {
        EXPECT_NE(ground.kind(cell), CellKind::full) << "seed " << seed;
      }
      for (std::size_t k = 1; k < path.size(); ++k) {
        EXPECT_GT(ground.lineRoom(path[k - 1], path[k]), 0.0f) << "seed " << seed;
        // From the second corner on with room for the body.
        if (k > 1) {
          EXPECT_GE(ground.lineRoom(path[k - 1], path[k]), 0.25f) << "seed " << seed;
        }
      }
    }
  }
  EXPECT_GT(found, 300);
}

TEST(CellNavigation, TellsThoseWhosePathCrossesAChangedCellAndNobodyElse) {
  Paths paths(7);
  GroundCells& ground = paths.navigation.ground();
  std::uint64_t told = 0, left = 0;
  for (int move = 0; move < 2000; ++move) {
    // What each sample's room was, asked from outside.
    const auto look = [&] {
      std::vector<float> rooms;
      for (int y = 0; y < 72; ++y) {
        for (int x = 0; x < 72; ++x) {
          const glm::vec2 step(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f);
          rooms.push_back(ground.roomAt(glm::vec2(-6.0f) + step * (0.5f / 3.0f)));
        }
      }
      return rooms;
    };
    const std::vector<float> before = look();
    ground.setObject(ObstacleId{static_cast<std::uint32_t>(navmesh::uniformInt(paths.rng, 10))},
                     randomObstacle(paths.rng, 6.0));
    std::vector<std::uint32_t> notified;
    paths.navigation.update([&](std::uint32_t agent) { notified.push_back(agent); });
    const std::vector<float> after = look();
    std::vector<bool> changed(ground.size(), false);
    for (std::uint32_t k = 0; k < after.size(); ++k) {
      if (before[k] != after[k]) changed[k / 72 / 3 * 24 + k % 72 / 3] = true;
    }
    std::vector<std::uint32_t> concerned;
    for (std::uint32_t agent = 0; agent < paths.path.size(); ++agent) {
      const auto cells = paths.navigation.cellsOf(agent);
      if (std::any_of(cells.begin(), cells.end(), [&](auto cell) { return changed[cell]; })) {
        concerned.push_back(agent);
      } else {
        ++left;
        // And theirs is as good as it was.
        const auto& path = paths.path[agent];
        for (std::size_t k = 2; k < path.size(); ++k) {
          ASSERT_GE(ground.lineRoom(path[k - 1], path[k]), 0.25f);
        }
      }
    }
    ASSERT_EQ(notified, concerned) << "move " << move;
    told += notified.size();
    for (const std::uint32_t agent : notified) paths.find(agent);
  }
  EXPECT_GT(told, 500u);
  EXPECT_GT(left, 1000u);
}

TEST(CellNavigation, LetsThroughAGapWhoFitsAndNobodyElse) {
  // A wall across with a gap of 0.9 m that begins in the middle of a cell.
  CellSettings settings;
  settings.low = {-5.0f, -5.0f};
  settings.high = {5.0f, 5.0f};
  GroundCells cells = cellsOf(settings);
  cells.setObject(ObstacleId{1}, box({-2.4f, 0.0f}, {2.5f, 0.2f}));
  cells.setObject(ObstacleId{2}, box({3.0f, 0.0f}, {2.0f, 0.2f}));
  CellNavigation navigation(std::move(cells));
  navigation.ground().update();
  navigation.add();
  std::vector<glm::vec2> path;
  EXPECT_TRUE(navigation.find(0, {-3.0f, -3.0f}, {3.0f, 3.0f}, 0.25f, 1.0f, path));
  EXPECT_FALSE(navigation.find(0, {-3.0f, -3.0f}, {3.0f, 3.0f}, 0.5f, 1.0f, path));
}

TEST(CellNavigation, DoesNotStepThroughAWallThinnerThanItsSamples) {
  CellSettings settings = small();
  GroundCells cells = cellsOf(settings);
  for (int k = 0; k < 40; ++k) {
    cells.setObject(ObstacleId{1},
                    box({-0.27f + 0.013f * static_cast<float>(k), 0.0f}, {0.001f, 7.0f}));
    CellNavigation navigation(cells);
    navigation.ground().update();
    navigation.add();
    std::vector<glm::vec2> path;
    EXPECT_FALSE(navigation.find(0, {-3.0f, 0.0f}, {3.0f, 0.3f}, 0.05f, 1.0f, path)) << k;
  }
}

/// Walkers to and fro across a square in which a box goes round; with cells.
std::uint64_t walked(unsigned threads, bool project, std::uint32_t* notified = nullptr) {
  const navmesh::ForEach forEach = [threads](std::size_t n,
                                             const std::function<void(std::size_t)>& work) {
    std::vector<std::thread> pool;
    for (unsigned t = 0; t < threads; ++t) {
      pool.emplace_back([&, t] {
        for (std::size_t k = t; k < n; k += threads) work(k);
      });
    }
    for (std::thread& thread : pool) thread.join();
  };
  CrowdSettings settings;
  settings.project = project;
  Crowd crowd(settings);
  EXPECT_TRUE(crowd.setCells({glm::vec2(-12.0f), glm::vec2(12.0f)}));
  const ModelId model = crowd.addModel(makeSocialForces());
  std::mt19937_64 rng(5);
  for (int k = 0; k < 120; ++k) {
    AgentSpec spec;
    spec.model = model;
    const float x = static_cast<float>(navmesh::uniform(rng, -11, 11));
    spec.position = {x, static_cast<float>(navmesh::uniform(rng, -11, 11))};
    const AgentId id = *crowd.add(spec);
    crowd.setGoal(id, -spec.position);
  }
  const ObstacleId moving = *crowd.addObstacle(box({-8.0f, 0.0f}, {1.0f, 3.0f}), {0.6f, 0.0f});
  std::uint64_t hash = 0;
  for (int tick = 0; tick < 150; ++tick) {
    crowd.step(0.1f, threads > 1 ? forEach : navmesh::ForEach{});
    if (notified) *notified += crowd.report().notified;
    hash = hash * 31 + crowd.hash();
  }
  EXPECT_TRUE(crowd.removeObstacle(moving));
  return hash;
}

TEST(CellNavigation, IsTheSameForAnyNumberOfThreads) {
  std::uint32_t notified = 0;
  const std::uint64_t one = walked(1, true, &notified);
  EXPECT_GT(notified, 0u);
  EXPECT_EQ(walked(2, true), one);
  EXPECT_EQ(walked(4, true), one);
}

TEST(CellNavigation, LeadsAroundWhatComesInTheWayAndWaitsWhereThereIsNoWay) {
  Crowd crowd;
  ASSERT_TRUE(crowd.setCells({glm::vec2(-6.0f), glm::vec2(6.0f)}));
  AgentSpec spec;
  spec.model = crowd.addModel(makeSocialForces());
  spec.position = {-5.0f, 0.0f};
  spec.goalRadius = 0.3f;
  const AgentId id = *crowd.add(spec);
  crowd.setGoal(id, {5.0f, 0.0f});
  for (int k = 0; k < 10; ++k) crowd.step(0.1f);
  EXPECT_NEAR(crowd.view().position[0].y, 0.0f, 0.3f);
  // Shut from edge to edge.
  const auto wall = *crowd.addObstacle(box({0.0f, 0.0f}, {0.5f, 7.0f}));
  crowd.step(0.1f);
  EXPECT_EQ(crowd.report().notified, 1u);
  EXPECT_EQ(crowd.report().withoutPath, 1u);
  // Opened at one end: it asks again, and gets there.
  ASSERT_TRUE(crowd.moveObstacle(wall, box({0.0f, -2.0f}, {0.5f, 5.0f})));
  crowd.step(0.1f);
  EXPECT_EQ(crowd.report().withoutPath, 0u);
  int ticks = 0;
  while (!crowd.arrived(id) && ++ticks < 400) {
    crowd.step(0.1f);
    ASSERT_EQ(countWallsEntered(crowd.view(), crowd.walls(), 0.02f), 0u);
  }
  EXPECT_TRUE(crowd.arrived(id));
}

TEST(CellNavigation, LeadsACrowdThroughADoorOfANavMesh) {
  navmesh::BuildSettings build;
  build.tile = 5.0f;
  auto mesh = std::move(*navmesh::LiveMesh::make(forewalk::testing::twoRooms(1.6f), build));
  CrowdSettings settings;
  settings.project = true;
  Crowd crowd(settings);
  crowd.setWorld(mesh.world());
  ASSERT_TRUE(crowd.setCells({glm::vec2(-1.0f, -12.0f), glm::vec2(16.0f, 2.0f)}));
  const ModelId model = crowd.addModel(makeSocialForces());
  std::vector<AgentId> ids;
  for (int k = 0; k < 8; ++k) {
    AgentSpec spec;
    spec.model = model;
    const float x = 0.7f * static_cast<float>(k % 4), z = 0.8f + 0.7f * static_cast<float>(k / 4);
    spec.position = navmesh::toPlan({1.0f + x, 0.0f, z});
    spec.goalRadius = 0.6f;
    ids.push_back(*crowd.add(spec));
    crowd.setGoal(ids.back(), navmesh::toPlan({9.0f + x, 0.0f, z}));
  }
  int steps = 0;
  const auto all = [&] {
    return std::all_of(ids.begin(), ids.end(), [&](AgentId id) { return crowd.arrived(id); });
  };
  while (!all() && ++steps < 1200) {
    crowd.step(0.1f);
    ASSERT_EQ(countWallsEntered(crowd.view(), crowd.walls(), 0.02f), 0u);
  }
  EXPECT_TRUE(all()) << "after " << steps << " steps";
}

TEST(GroundCells, SayWhatIsWrongWithTheirSettings) {
  CellSettings even = small();
  even.samples = 4;
  ASSERT_FALSE(GroundCells::make(even));
  EXPECT_EQ(GroundCells::make(even).error().message,
            "cells.samples is 4: it has to be odd, from 1 to 15.");
  CellSettings fine;
  fine.cell = 0.01f;
  fine.reach = 0.2f;
  ASSERT_FALSE(GroundCells::make(fine));
  EXPECT_EQ(GroundCells::make(fine).error().code, ErrorCode::kTooLarge);
}

}  // namespace
}  // namespace forewalk::agents
