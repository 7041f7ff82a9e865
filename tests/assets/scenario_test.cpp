// Every bundled scene gives the answers that its scenario states. The generator knows them from how
// it built the scene (rooms, doors, islands, cells), not from our navmesh.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <queue>
#include <set>

#include "navmesh/build/build.h"
#include "navmesh/build/scene.h"
#include "navmesh/funnel.h"
#include "navmesh/locate.h"
#include "navmesh/nav_graph.h"
#include "navmesh/plan.h"
#include "prediction/predict.h"

namespace forewalk {
namespace {

using navmesh::Location;
using navmesh::PolygonId;
using Json = nlohmann::json;

glm::vec3 point(const Json& json) {
  return {json.at(0).get<float>(), json.at(1).get<float>(), json.at(2).get<float>()};
}

Json scenarioOf(const std::string& name) {
  std::ifstream in(std::filesystem::path(FOREWALK_ASSETS) / "scenarios" / (name + ".json"));
  return Json::parse(in);
}

navmesh::Scene sceneOf(const Json& scenario) {
  const auto scene = navmesh::importScene(std::filesystem::path(FOREWALK_ASSETS) / "scenarios" /
                                          scenario.at("scene").get<std::string>());
  if (!scene) throw std::runtime_error(scene.error().message);
  return *scene;
}

/// A built scene; built once per program, since building is what costs time here.
struct Ground {
  navmesh::PolygonMesh mesh;
  navmesh::NavGraph graph;
  navmesh::LocationIndex index;

  explicit Ground(const navmesh::Scene& scene) {
    const auto built = navmesh::buildNavMesh(scene);
    if (!built) throw std::runtime_error(built.error().message);
    if (const auto sound = navmesh::validate(*built); !sound) {
      throw std::runtime_error(sound.error().message);
    }
    mesh = navmesh::flatten(*built);
    auto made = navmesh::makeNavGraph(mesh);
    if (!made) throw std::runtime_error(made.error().message);
    graph = *made;
    index = navmesh::makeLocationIndex(graph);
  }

  /// The place of a point that lies on the walkable ground itself, not merely near it.
  std::optional<Location> standing(glm::vec3 position) const {
    return locate(graph, index, position, {.distance = 0.0f, .below = 0.15f, .above = 0.15f});
  }
};

const Ground& groundOf(const std::string& name) {
  static std::map<std::string, Ground> built;
  auto found = built.find(name);
  if (found == built.end()) found = built.emplace(name, Ground(sceneOf(scenarioOf(name)))).first;
  return found->second;
}

/// Independent loops of the walkable ground: components minus the Euler characteristic, counted on
/// polygons, portals, and vertices that polygons surround.
int loopsOf(const Ground& ground) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
  std::set<std::uint32_t> inner, rim;
  const auto& mesh = ground.mesh;
  for (std::uint32_t p = 0; p < mesh.polygonCount(); ++p) {
    for (std::uint32_t i = mesh.ringStart[p]; i < mesh.ringStart[p + 1]; ++i) {
      const std::uint32_t next = i + 1 < mesh.ringStart[p + 1] ? i + 1 : mesh.ringStart[p];
      ++edges[std::minmax(mesh.ring[i], mesh.ring[next])];
      inner.insert(mesh.ring[i]);
    }
  }
  int portals = 0;
  for (const auto& [edge, sides] : edges) {
    portals += sides == 2;
    if (sides == 1) rim.insert({edge.first, edge.second});
  }
  for (const std::uint32_t vertex : rim) inner.erase(vertex);
  const int euler =
      static_cast<int>(mesh.polygonCount()) - portals + static_cast<int>(inner.size());
  return static_cast<int>(ground.graph.componentCount) - euler;
}

/// Length of a taut walk between two places along the polygons that a search over portal midpoints
/// finds; never shorter than the shortest walk.
float walkBetween(const navmesh::NavGraph& graph, const Location& from, const Location& to) {
  std::vector<float> key(graph.portalCount(), std::numeric_limits<float>::infinity());
  std::vector<std::uint32_t> before(graph.portalCount(), graph.portalCount());
  using Entry = std::pair<float, std::uint32_t>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> open;
  const auto leave = [&](PolygonId polygon, glm::vec2 at, float length, std::uint32_t entered) {
    for (auto h = graph.portalStart[index(polygon)]; h < graph.portalStart[index(polygon) + 1];
         ++h) {
      const float there = length + glm::distance(at, graph.portalMidpoint[h]);
      if (there >= key[h]) continue;
      key[h] = there;
      before[h] = entered;
      open.push({there, h});
    }
  };
  leave(from.polygon, from.plan, 0.0f, graph.portalCount());
  std::vector<navmesh::Portal> corridor;
  while (!open.empty()) {
    const auto [length, portal] = open.top();
    open.pop();
    if (length > key[portal]) continue;
    if (graph.portalTo[portal] == to.polygon) {
      for (std::uint32_t h = portal; h != graph.portalCount(); h = before[h]) {
        corridor.push_back(graph.portals[h]);
      }
      std::reverse(corridor.begin(), corridor.end());
      break;
    }
    leave(graph.portalTo[portal], graph.portalMidpoint[portal], length, portal);
  }
  std::vector<glm::vec2> path;
  navmesh::pullString(from.plan, to.plan, corridor, path);
  return navmesh::lengthOf(path);
}

class Scenario : public testing::TestWithParam<const char*> {
 protected:
  const Json scenario = scenarioOf(GetParam());
  const Json answer = scenario.at("answer");
  const Ground& ground = groundOf(GetParam());
};

INSTANTIATE_TEST_SUITE_P(Bundled, Scenario,
                         testing::Values("office", "museum", "two_storey", "corridor", "maze"),
                         [](const auto& named) { return std::string(named.param); });

TEST_P(Scenario, StatesItsFormatSceneAndLicence) {
  EXPECT_EQ(scenario.at("format"), "forewalk.scenario/1");
  EXPECT_EQ(scenario.at("scene"), std::string("../scenes/") + GetParam() + ".obj");
  EXPECT_EQ(scenario.at("licence"), "MIT");
}

TEST_P(Scenario, HangsTogetherInAsManyPiecesAsWereBuilt) {
  EXPECT_EQ(ground.graph.componentCount, answer.at("components").get<std::uint32_t>());
}

TEST_P(Scenario, HasAsManyLoopsAsWallsAndIslandsLeave) {
  EXPECT_EQ(loopsOf(ground), answer.at("loops").get<int>());
}

TEST_P(Scenario, HasNoGroundOnFurnitureOrWalls) {
  for (std::uint32_t p = 0; p < ground.graph.polygonCount(); ++p) {
    EXPECT_LE(ground.graph.centroidHeight[p], answer.at("walkable_height_max").get<float>())
        << "polygon " << p << " at " << ground.graph.centroid[p].x << ", "
        << -ground.graph.centroid[p].y;
  }
}

TEST_P(Scenario, StandsOnEveryWaypointAndWalksFromEachToTheNext) {
  std::optional<Location> last = ground.standing(point(scenario.at("start").at("position")));
  ASSERT_TRUE(last) << "start";
  for (const Json& waypoint : scenario.at("waypoints")) {
    const auto here = ground.standing(point(waypoint));
    ASSERT_TRUE(here) << waypoint;
    EXPECT_EQ(ground.graph.component[index(here->polygon)],
              ground.graph.component[index(last->polygon)])
        << waypoint;
    last = here;
  }
}

class Building : public Scenario {};

INSTANTIATE_TEST_SUITE_P(Bundled, Building, testing::Values("office", "museum", "two_storey"),
                         [](const auto& named) { return std::string(named.param); });

TEST_P(Building, ReachesEveryRoomOnItsOwnStorey) {
  EXPECT_EQ(scenario.at("rooms").size(), answer.at("rooms").get<std::size_t>());
  const auto start = ground.standing(point(scenario.at("start").at("position")));
  ASSERT_TRUE(start);
  for (const Json& room : scenario.at("rooms")) {
    const glm::vec3 probe = point(room.at("probe"));
    const auto here = ground.standing(probe);
    ASSERT_TRUE(here) << room;
    EXPECT_EQ(ground.graph.component[index(here->polygon)],
              ground.graph.component[index(start->polygon)])
        << room;
    EXPECT_NEAR(here->height, probe.y, 0.1f) << room;
    // A head 1.7 m above the floor finds the same floor.
    const auto below = locate(ground.graph, ground.index, probe + glm::vec3(0.0f, 1.7f, 0.0f));
    ASSERT_TRUE(below) << room;
    EXPECT_EQ(below->polygon, here->polygon) << room;
  }
}

TEST(Corridor, IsWalkableBetweenItsWallsLessTheWalkersRadius) {
  const Json answer = scenarioOf("corridor").at("answer");
  const Ground& ground = groundOf("corridor");
  glm::vec2 low(1e9f), high(-1e9f);
  float area = 0.0f;
  for (const glm::vec2 corner : ground.graph.ring) {
    low = glm::min(low, corner);
    high = glm::max(high, corner);
  }
  for (std::uint32_t p = 0; p < ground.graph.polygonCount(); ++p) {
    area += areaOf(ground.graph, PolygonId{p});
  }
  const float length = answer.at("length").get<float>() - 2 * 0.25f;
  const float width = answer.at("width").get<float>() - 2 * 0.25f;
  // Two voxels a side: one that the wall touches, one that the radius is rounded up by.
  EXPECT_NEAR(high.x - low.x, length, 0.4f);
  EXPECT_NEAR(high.y - low.y, width, 0.4f);
  EXPECT_NEAR(area, (high.x - low.x) * (high.y - low.y), 0.01f * area);
}

TEST(Corridor, GivesTwoWaysThatAreCutAtExactlyTheHorizon) {
  const Json scenario = scenarioOf("corridor");
  const Ground& ground = groundOf("corridor");
  const auto start = ground.standing(point(scenario.at("start").at("position")));
  ASSERT_TRUE(start);
  prediction::Scratch scratch(ground.graph);
  const auto& graph = predict(ground.graph, *start, scenario.at("horizon").get<float>(), scratch);
  const Json answer = scenario.at("answer");
  ASSERT_EQ(graph.terminals.size(), answer.at("terminals").get<std::size_t>());
  float side = 1.0f;
  for (const auto id : graph.terminals) {
    const auto& node = graph.node(id);
    EXPECT_EQ(node.reason, prediction::TerminalReason::kHorizon);
    EXPECT_NEAR(node.distance, answer.at("terminal_distance").get<float>(), 1e-4f);
    // The cut may lie anywhere across a corridor 2 m wide: within 5 cm of 20 m along it.
    EXPECT_NEAR(std::abs(node.plan.x), 20.0f, 0.05f);
    side *= node.plan.x;
  }
  EXPECT_LT(side, 0.0f) << "both ways lead to the same end";
}

TEST(TwoStorey, FallsApartIntoItsStoreysWithoutStairs) {
  const Json scenario = scenarioOf("two_storey");
  navmesh::Scene scene = sceneOf(scenario);
  const glm::vec3 low = point(scenario.at("stairs").at("min")) - 0.001f;
  const glm::vec3 high = point(scenario.at("stairs").at("max")) + 0.001f;
  const std::size_t before = scene.triangles.size();
  std::erase_if(scene.triangles, [&](glm::uvec3 t) {
    for (int i = 0; i < 3; ++i) {
      const glm::vec3 v = scene.vertices[t[i]];
      if (glm::any(glm::lessThan(v, low)) || glm::any(glm::greaterThan(v, high))) return false;
    }
    return true;
  });
  ASSERT_LT(scene.triangles.size(), before);
  const Ground apart(scene);
  EXPECT_EQ(apart.graph.componentCount,
            scenario.at("answer").at("components_without_stairs").get<std::uint32_t>());
  std::map<int, std::set<std::uint32_t>> componentsOfStorey;
  for (const Json& room : scenario.at("rooms")) {
    const auto here = apart.standing(point(room.at("probe")));
    ASSERT_TRUE(here) << room;
    componentsOfStorey[room.at("storey").get<int>()].insert(
        apart.graph.component[index(here->polygon)]);
  }
  ASSERT_EQ(componentsOfStorey.size(), 2u);
  EXPECT_EQ(componentsOfStorey[0].size(), 1u);
  EXPECT_EQ(componentsOfStorey[1].size(), 1u);
  EXPECT_NE(componentsOfStorey[0], componentsOfStorey[1]);
}

TEST(TwoStorey, ClimbsItsStairsInRealSteps) {
  // Up the middle of both flights, the ground rises with the pitch of rise over tread.
  const Json scenario = scenarioOf("two_storey");
  const Ground& ground = groundOf("two_storey");
  const Json answer = scenario.at("answer");
  const float rise = answer.at("rise").get<float>(), tread = answer.at("tread").get<float>();
  const glm::vec3 low = point(scenario.at("stairs").at("min"));
  const glm::vec3 high = point(scenario.at("stairs").at("max"));
  for (int i = 0; i < 8; ++i) {
    const float z = high.z - (static_cast<float>(i) + 0.5f) * tread;
    const glm::vec3 step(low.x + 0.62f, static_cast<float>(i + 1) * rise, z);
    const auto here = locate(ground.graph, ground.index, step, {0.0f, 0.3f, 0.3f});
    ASSERT_TRUE(here) << "step " << i + 1;
    EXPECT_NEAR(here->height, step.y, 0.15f) << "step " << i + 1;
  }
}

TEST(Maze, IsAsLongToItsGoalAsItsGridSays) {
  const Json scenario = scenarioOf("maze");
  const Ground& ground = groundOf("maze");
  const auto start = ground.standing(point(scenario.at("start").at("position")));
  const auto goal = ground.standing(point(scenario.at("goal")));
  ASSERT_TRUE(start && goal);
  const float length = walkBetween(ground.graph, *start, *goal);
  EXPECT_GE(length, scenario.at("answer").at("shortest_at_least").get<float>());
  EXPECT_LE(length, scenario.at("answer").at("shortest_at_most").get<float>());
  // And back.
  EXPECT_NEAR(walkBetween(ground.graph, *goal, *start), length, 1e-2f * length);
}

TEST(Maze, EndsAWayInEveryDeadEnd) {
  const Json scenario = scenarioOf("maze");
  const Ground& ground = groundOf("maze");
  const auto start = ground.standing(point(scenario.at("start").at("position")));
  ASSERT_TRUE(start);
  prediction::Scratch scratch(ground.graph);
  const auto& graph = predict(ground.graph, *start, 1000.0f, scratch);
  for (const Json& deadEnd : scenario.at("answer").at("dead_ends")) {
    const glm::vec2 middle = navmesh::toPlan(point(deadEnd));
    const bool found = std::any_of(graph.terminals.begin(), graph.terminals.end(), [&](auto id) {
      const auto& node = graph.node(id);
      return node.reason == prediction::TerminalReason::kDeadEnd &&
             contains(ground.graph, node.polygon, middle);
    });
    EXPECT_TRUE(found) << deadEnd;
  }
}

}  // namespace
}  // namespace forewalk
