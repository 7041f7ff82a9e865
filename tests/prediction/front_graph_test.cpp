#include "prediction/front_graph.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "navmesh/funnel.h"
#include "navmesh/locate.h"
#include "navmesh/plan.h"
#include "tests/support/counted_ways.h"
#include "tests/support/map_mesh.h"
#include "tests/support/random_mesh.h"
#include "tests/support/random_start.h"

namespace forewalk::prediction {
namespace {

using navmesh::NavGraph;
using testing::Cutting;
using testing::Ways;
using testing::waysOf;

NavGraph graphOf(const navmesh::PolygonMesh& mesh) {
  auto graph = navmesh::makeNavGraph(mesh);
  EXPECT_TRUE(graph) << graph.error().message;
  return *graph;
}

// A floor whose ways are known by looking at it. `@` is the user.
struct KnownScene {
  const char* name;
  std::vector<std::string_view> rows;
  float horizon;
  Ways ways;
  float cell = 0.5f;  // metres a character
};

const std::vector<KnownScene>& knownScenes() {
  static const std::vector<KnownScene> scenes{
      {"an open plane",
       {"................", "................", "................", "................",
        "................", "................", "................", ".......@........",
        "................", "................", "................", "................",
        "................", "................", "................", "................"},
       3.0f,
       {.horizon = 1}},
      {"a corridor",
       {"........................", "...........@............"},
       4.0f,
       {.horizon = 2, .branches = 1}},
      {"the end of a corridor",
       {"........................", ".....@.................."},
       6.0f,
       {.horizon = 1, .deadEnds = 1, .branches = 1}},
      {"a corner",
       {"..              ", "..              ", "..              ", "..              ",
        "..              ", "..              ", "......@.........", "................"},
       4.0f,
       {.horizon = 2, .branches = 1}},
      {"a T junction, seen from the stem",
       {"........................", "........................", "           ..           ",
        "           ..           ", "           @.           ", "           ..           ",
        "           ..           ", "           ..           ", "           ..           ",
        "           ..           "},
       4.5f,
       {.horizon = 2, .deadEnds = 1, .branches = 2}},
      {"a plus crossing, from its middle",
       {"         ...         ", "         ...         ", "         ...         ",
        "         ...         ", "         ...         ", "         ...         ",
        ".....................", "..........@..........", ".....................",
        "         ...         ", "         ...         ", "         ...         ",
        "         ...         ", "         ...         ", "         ...         "},
       3.5f,
       {.horizon = 4, .branches = 3}},
      {"a pillar in a hall",
       {"..............................", "..............................",
        "..............................", "............  ................",
        "..@.........  ................", "............  ................",
        "..............................", "..............................",
        ".............................."},
       12.0f,
       {.horizon = 1, .branches = 1, .joins = 1}},
      {"a pillar that the front passes before it comes to any wall",
       {"........................", "........................", "........................",
        "........................", "........................", "........................",
        "........................", "........................", "..............  ........",
        "...........@..  ........", "........................", "........................",
        "........................", "........................", "........................",
        "........................", "........................", "........................"},
       4.0f,
       {.horizon = 1}},
      {"a pillar too thin to part a way",
       {"................................................",
        "................................................",
        "....................... ........................",
        "..@.............................................",
        "................................................",
        "................................................"},
       9.0f,
       {.horizon = 1},
       0.25f},
      {"a ring",
       {"............", "............", "..        ..", "..        ..", "..        ..",
        "..        ..", "..        ..", "..        ..", "......@.....", "............"},
       20.0f,
       {.meetings = 2, .branches = 1},
       0.25f},
      {"a niche that is no way",
       {"                ..              ", "................................",
        ".@.............................."},
       12.0f,
       {.horizon = 1}},
      {"a side room",
       {"            .......             ", "            .......             ",
        "            .......             ", "               .                ",
        "................................", "...@............................"},
       12.0f,
       {.horizon = 1, .deadEnds = 2, .branches = 2}},
      {"a room with the user in the middle and one door",
       {"..........          ", "..........          ", "..........          ",
        "..........          ", "....................", ".....@..............",
        "..........          ", "..........          ", "..........          ",
        "..........          "},
       7.0f,
       {.horizon = 1, .deadEnds = 4, .branches = 4}},
      {"two corridors that part and come together",
       {"       ............       ", "       ............       ", "       ..        ..       ",
        "       ..        ..       ", "..........      ..........", ".@........      ..........",
        "       ..        ..       ", "       ..        ..       ", "       ............       ",
        "       ............       "},
       11.0f,
       {.horizon = 1, .branches = 1, .joins = 1}},
  };
  return scenes;
}

struct Built {
  explicit Built(const navmesh::PolygonMesh& mesh)
      : graph(graphOf(mesh)),
        locations(navmesh::makeLocationIndex(graph)),
        index(makeFrontIndex(graph)),
        scratch(graph, index) {}

  navmesh::Location at(glm::vec2 plan) const {
    return *navmesh::locate(graph, locations, navmesh::toSpace(plan, 0.0f));
  }

  NavGraph graph;
  navmesh::LocationIndex locations;
  FrontIndex index;
  FrontScratch scratch;
};

TEST(FrontGraph, FindsTheWaysThatAPersonSeesHoweverTheFloorIsCut) {
  for (const KnownScene& scene : knownScenes()) {
    for (const Cutting cutting : testing::kCuttings) {
      Built built(testing::mapMesh(scene.rows, scene.cell, cutting));
      // Not quite in the middle, so that no two walls are equally far.
      const glm::vec2 user =
          testing::markIn(scene.rows, scene.cell, '@') + glm::vec2(0.03f, 0.017f);
      const auto& graph = predictFronts(built.graph, built.at(user), scene.horizon, built.scratch);
      EXPECT_EQ(waysOf(graph), scene.ways)
          << scene.name << ", cutting " << static_cast<int>(cutting);
    }
  }
}

// Random floors with holes, cut in every way we know, some with tile borders.
std::vector<navmesh::PolygonMesh> randomFloors() {
  std::vector<navmesh::PolygonMesh> floors;
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    testing::RandomMeshOptions options;
    options.holeShare = 0.05 * static_cast<double>(seed % 8);
    options.splitShare = 0.2 * static_cast<double>(seed % 5);
    options.mergeShare = 0.2 * static_cast<double>(seed % 4);
    options.jitter = seed % 3 == 0 ? 0.0 : 0.2;
    const auto floor = testing::randomMesh(seed, 10, 9, options);
    floors.push_back(
        seed % 4 != 0 ? floor : testing::joinedAlong(floor, testing::randomMesh(seed + 99, 7, 9)));
  }
  return floors;
}

float lengthOf(std::span<const glm::vec2> path) { return navmesh::lengthOf(path); }

TEST(FrontGraph, PutsEveryNodeAtItsTrueDistance) {
  std::size_t compared = 0;
  for (const auto& floor : randomFloors()) {
    Built built(floor);
    for (const auto& source : testing::randomStarts(built.graph, 6, 1)) {
      const auto& graph = predictFronts(built.graph, source, 5.0f, built.scratch);
      const DistanceField& distances = built.scratch.distances();
      for (const Node& node : graph.nodes) {
        EXPECT_NEAR(distances.distanceAt(node.polygon, node.plan), node.distance, 5e-3f);
        const Corner& corner = graph.corners[node.corner];
        EXPECT_NEAR(corner.distance + glm::distance(corner.plan, node.plan), node.distance, 5e-3f);
        ++compared;
      }
    }
  }
  EXPECT_GT(compared, 1000u);
}

TEST(FrontGraph, JoinsEveryNodeToTheOneBeforeItByAPathOfItsLength) {
  for (const auto& floor : randomFloors()) {
    Built built(floor);
    for (const auto& source : testing::randomStarts(built.graph, 6, 2)) {
      const auto& graph = predictFronts(built.graph, source, 5.0f, built.scratch);
      ASSERT_GE(graph.edges.size(), graph.nodes.size() - 1);
      for (std::uint32_t i = 1; i < graph.nodes.size(); ++i) {
        const Node& node = graph.nodes[i];
        const Edge& edge = graph.treeEdge(NodeId{i});
        ASSERT_LT(index(node.prev), i);
        EXPECT_EQ(edge.from, NodeId{i});
        EXPECT_EQ(edge.to, node.prev);
        EXPECT_LE(graph.node(node.prev).distance, node.distance);
      }
      for (const Edge& edge : graph.edges) {
        EXPECT_NEAR(lengthOf(graph.pathOf(edge)), edge.length, 1e-2f);
        EXPECT_NEAR(graph.node(edge.from).distance - graph.node(edge.to).distance, edge.length,
                    1e-3f);
      }
    }
  }
}

TEST(FrontGraph, EndsEveryWayInATerminalAndHasAFrontForEach) {
  for (const auto& floor : randomFloors()) {
    Built built(floor);
    for (const auto& source : testing::randomStarts(built.graph, 6, 3)) {
      const auto& graph = predictFronts(built.graph, source, 4.0f, built.scratch);
      ASSERT_EQ(graph.fronts.size(), graph.terminals.size());
      std::set<std::uint32_t> left;
      for (const Edge& edge : graph.edges) left.insert(index(edge.to));
      for (std::uint32_t i = 0; i < graph.nodes.size(); ++i) {
        const bool terminal = graph.nodes[i].kind == NodeKind::kTerminal;
        EXPECT_NE(terminal, left.contains(i)) << i;
        if (graph.nodes[i].reason == TerminalReason::kHorizon) {
          EXPECT_EQ(graph.nodes[i].distance, 4.0f);
        }
      }
      for (std::size_t i = 0; i < graph.fronts.size(); ++i) {
        const Node& node = graph.node(graph.terminals[i]);
        if (node.reason != TerminalReason::kHorizon) continue;
        EXPECT_GE(graph.fronts[i].length + 1e-3f,
                  glm::distance(graph.fronts[i].from, graph.fronts[i].to));
      }
    }
  }
}

TEST(FrontGraph, GivesTheFrontOfAMergedWayToItsNeighbour) {
  const auto& stem = *std::find_if(knownScenes().begin(), knownScenes().end(), [](const auto& s) {
    return std::string_view(s.name).starts_with("a T junction");
  });
  Built built(testing::mapMesh(stem.rows, stem.cell, Cutting::kSquares));
  const auto place =
      built.at(testing::markIn(stem.rows, stem.cell, '@') + glm::vec2(0.03f, 0.017f));
  // The front has just been parted by the wall at the end of the stem: two pieces, left and right.
  std::size_t compared = 0;
  for (float horizon = 1.2f; horizon < 3.0f; horizon += 0.05f) {
    const auto ahead = [&](float persistence) {
      std::vector<Front> fronts;
      const auto& graph = predictFronts(built.graph, place, horizon, built.scratch, {persistence});
      for (std::size_t i = 0; i < graph.fronts.size(); ++i) {
        if (graph.node(graph.terminals[i]).plan.y > place.plan.y) fronts.push_back(graph.fronts[i]);
      }
      return fronts;
    };
    const std::vector<Front> pieces = ahead(0.0f), merged = ahead(0.75f);
    if (pieces.size() != 2 || merged.size() != 1) continue;
    ++compared;
    // From the outer end of one to the outer end of the other.
    const auto isEndOf = [&](glm::vec2 end, const Front& front) {
      return glm::distance(end, front.from) < 1e-4f || glm::distance(end, front.to) < 1e-4f;
    };
    for (const glm::vec2 end : {merged[0].from, merged[0].to}) {
      EXPECT_NE(isEndOf(end, pieces[0]), isEndOf(end, pieces[1])) << horizon;
    }
    EXPECT_NE(isEndOf(merged[0].from, pieces[0]), isEndOf(merged[0].to, pieces[0])) << horizon;
    EXPECT_GE(merged[0].length, pieces[0].length + pieces[1].length);
    EXPECT_LT(glm::distance(pieces[0].from, pieces[1].from),
              glm::distance(merged[0].from, merged[0].to) + 1e-4f);
  }
  EXPECT_GE(compared, 3u);
}

TEST(FrontGraph, HasNoMoreBranchesWhereLongerWaysAreMerged) {
  for (const auto& floor : randomFloors()) {
    Built built(floor);
    for (const auto& source : testing::randomStarts(built.graph, 4, 4)) {
      std::size_t before = 1u << 20;
      for (const float persistence : {0.0f, 0.25f, 0.75f, 2.0f, 100.0f}) {
        const auto& graph = predictFronts(built.graph, source, 5.0f, built.scratch, {persistence});
        const std::size_t branches = waysOf(graph).branches;
        EXPECT_LE(branches, before);
        before = branches;
      }
    }
  }
}

TEST(FrontGraph, GivesTheSourceAloneOffTheNavmesh) {
  Built built(testing::gridMesh(3, 3));
  const auto& graph =
      predictFronts(built.graph, {navmesh::kNoPolygon, {1.0f, 1.0f}, 0.0f}, 5.0f, built.scratch);
  EXPECT_EQ(graph.nodes.size(), 1u);
  EXPECT_EQ(graph.flags & kSourceOffMesh, kSourceOffMesh);
}

TEST(FrontGraph, RemembersNothingOfEarlierFrames) {
  for (const auto& floor : randomFloors()) {
    Built built(floor);
    const auto starts = testing::randomStarts(built.graph, 5, 5);
    std::vector<std::uint64_t> hashes;
    for (const auto& source : starts) {
      FrontScratch fresh(built.graph, built.index);
      hashes.push_back(hashOf(predictFronts(built.graph, source, 6.0f, fresh)));
    }
    for (std::size_t i = starts.size(); i-- > 0;) {
      EXPECT_EQ(hashOf(predictFronts(built.graph, starts[i], 6.0f, built.scratch)), hashes[i]);
    }
  }
}

}  // namespace
}  // namespace forewalk::prediction
