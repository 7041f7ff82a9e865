// The neighbour index against brute force.
#include "agents/neighbourhood.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "navmesh/random.h"

namespace forewalk::agents {
namespace {

struct Bodies {
  std::vector<AgentId> id;
  std::vector<glm::vec2> position;
  std::vector<float> radius, height;

  AgentsView view() const {
    AgentsView agents;
    agents.id = id;
    agents.position = position;
    agents.radius = radius;
    agents.height = height;
    return agents;
  }
};

Bodies scattered(std::mt19937_64& rng, int count, double size, bool onAGrid) {
  Bodies bodies;
  for (int k = 0; k < count; ++k) {
    bodies.id.push_back(AgentId{static_cast<std::uint32_t>((k * 7919) % 100003)});
    glm::vec2 at(navmesh::uniform(rng, -size, size), navmesh::uniform(rng, -size, size));
    if (onAGrid) at = glm::round(at);  // many equal distances, and several in one place
    bodies.position.push_back(at);
    bodies.radius.push_back(static_cast<float>(navmesh::uniform(rng, 0.1, 0.6)));
    bodies.height.push_back(navmesh::uniformInt(rng, 5) == 0 ? 3.0f : 0.0f);
  }
  return bodies;
}

TEST(NeighbourIndex, FindsTheNearestInOrderAsBruteForceDoes) {
  std::mt19937_64 rng(1);
  NeighbourIndex index;
  WallIndex noWalls;
  for (int round = 0; round < 60; ++round) {
    const Bodies bodies = scattered(rng, 1 + navmesh::uniformInt(rng, 300),
                                    std::exp(navmesh::uniform(rng, -1.0, 4.0)), round % 2 == 0);
    const AgentsView agents = bodies.view();
    Needs needs;
    needs.neighbourRadius = static_cast<float>(navmesh::uniform(rng, 0.0, 8.0));
    needs.neighbourCount = static_cast<std::uint32_t>(navmesh::uniformInt(rng, 20));
    const std::vector<const Needs*> needsOf(agents.size(), &needs);
    index.build(agents, needs.neighbourRadius);
    const Neighbourhoods& found = index.gather(agents, noWalls, needsOf, {});
    for (std::uint32_t i = 0; i < agents.size(); ++i) {
      std::vector<Neighbour> expected;
      for (std::uint32_t j = 0; j < agents.size(); ++j) {
        const glm::vec2 apart = agents.position[j] - agents.position[i];
        const float squared = apart.x * apart.x + apart.y * apart.y;
        const float reach = needs.neighbourRadius + agents.radius[i] + agents.radius[j];
        if (i == j || squared > reach * reach) continue;
        if (std::abs(agents.height[i] - agents.height[j]) > 2.0f) continue;
        expected.push_back({j, squared});
      }
      std::sort(expected.begin(), expected.end(), [&](const Neighbour& a, const Neighbour& b) {
        return a.squaredDistance < b.squaredDistance ||
               (a.squaredDistance == b.squaredDistance &&
                number(agents.id[a.index]) < number(agents.id[b.index]));
      });
      if (expected.size() > needs.neighbourCount) expected.resize(needs.neighbourCount);
      const auto neighbours = found.of(i).neighbours;
      ASSERT_EQ(neighbours.size(), expected.size()) << "round " << round << " agent " << i;
      for (std::size_t k = 0; k < expected.size(); ++k) {
        ASSERT_EQ(neighbours[k].index, expected[k].index) << "round " << round << " agent " << i;
      }
    }
  }
}

TEST(WallIndex, FindsTheNearestVisibleWallsAsBruteForceDoes) {
  std::mt19937_64 rng(2);
  for (int round = 0; round < 60; ++round) {
    std::vector<Wall> walls;
    const double size = std::exp(navmesh::uniform(rng, 0.0, 4.0));
    const auto somewhere = [&] {
      const double x = navmesh::uniform(rng, -size, size);
      return glm::vec2(x, navmesh::uniform(rng, -size, size));
    };
    for (int k = navmesh::uniformInt(rng, 40); k > 0; --k) {
      const glm::vec2 a = somewhere(), b = a + 0.2f * somewhere(), c = a + 0.2f * somewhere();
      appendLoop(std::vector<glm::vec2>{a, b, c}, glm::vec2(0.0f), walls);
      appendCircle(somewhere(), 0.5f, glm::vec2(0.0f), walls);
    }
    WallIndex index;
    index.assign(walls);
    for (int query = 0; query < 40; ++query) {
      const glm::vec2 at = 1.5f * somewhere();
      const float radius = static_cast<float>(navmesh::uniform(rng, 0.0, 5.0));
      const std::uint32_t count = static_cast<std::uint32_t>(navmesh::uniformInt(rng, 12));
      std::vector<NearWall> expected, found;
      for (std::uint32_t w = 0; w < walls.size(); ++w) {
        if (!walls[w].isCircle() && navmesh::exactTurn(walls[w].from, walls[w].to, at) < 0.0)
          continue;
        const glm::vec2 apart = nearestOn(walls[w], at) - at;
        float squared = glm::dot(apart, apart);
        if (walls[w].isCircle()) {
          const float rim = std::max(0.0f, glm::distance(walls[w].from, at) - 0.5f);
          squared = rim * rim;
        }
        if (squared <= radius * radius) expected.push_back({w, squared});
      }
      // Of walls that meet in a corner, the one whose middle is nearer.
      const auto toMiddle = [&](const NearWall& near) {
        const glm::vec2 off = 0.5f * (walls[near.index].from + walls[near.index].to) - at;
        return glm::dot(off, off);
      };
      std::stable_sort(expected.begin(), expected.end(), [&](const NearWall& a, const NearWall& b) {
        return std::pair(a.squaredDistance, toMiddle(a)) <
               std::pair(b.squaredDistance, toMiddle(b));
      });
      if (expected.size() > count) expected.resize(count);
      index.nearest(at, 0.0f, radius, count, found);
      ASSERT_EQ(found.size(), expected.size());
      for (std::size_t k = 0; k < found.size(); ++k) ASSERT_EQ(found[k].index, expected[k].index);
    }
  }
}

TEST(Walls, LinkTheBorderOfARoomAndKnowWhichCornersPointOut) {
  // A room of 4 m x 4 m with a box of 1 m in it: outer corners turn in, the box's point out.
  std::vector<Wall> walls;
  appendLoop(std::vector<glm::vec2>{{0, 0}, {4, 0}, {4, 4}, {0, 4}}, glm::vec2(0.0f), walls);
  appendLoop(std::vector<glm::vec2>{{1, 1}, {1, 2}, {2, 2}, {2, 1}}, glm::vec2(0.0f), walls);
  for (std::uint32_t w = 0; w < 4; ++w) EXPECT_FALSE(pointsOut(walls, w));
  for (std::uint32_t w = 4; w < 8; ++w) EXPECT_TRUE(pointsOut(walls, w));
  EXPECT_EQ(walls[3].next, 0u);
  EXPECT_EQ(walls[4].previous, 7u);
}

}  // namespace
}  // namespace forewalk::agents
