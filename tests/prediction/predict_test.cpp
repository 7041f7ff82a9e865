#include "prediction/predict.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "navmesh/funnel.h"
#include "navmesh/plan.h"
#include "tests/support/paper_listing.h"
#include "tests/support/random_mesh.h"
#include "tests/support/random_start.h"

namespace forewalk::prediction {
namespace {

using navmesh::Location;
using navmesh::makeNavGraph;
using navmesh::NavGraph;
using navmesh::PolygonMesh;
using testing::randomStarts;

NavGraph graphOf(const PolygonMesh& mesh) {
  auto graph = makeNavGraph(mesh);
  if (!graph) throw std::runtime_error(graph.error().message);
  return std::move(*graph);
}

/// Runs `check(graph, start, horizon)` on random navmeshes of several kinds.
template <typename Check>
void onRandomMeshes(Check check, int seeds = 12, int starts = 6) {
  for (int seed = 1; seed <= seeds; ++seed) {
    testing::RandomMeshOptions options;
    options.holeShare = 0.05 * (seed % 7);
    options.mergeShare = 0.1 * (seed % 9);
    options.splitShare = 0.15 * (seed % 5);
    const std::uint64_t number = static_cast<std::uint64_t>(seed);
    const PolygonMesh mesh =
        seed % 4 == 0 ? testing::joinedAlong(testing::randomMesh(number, 9, 12, options),
                                             testing::randomMesh(number + 100, 7, 12, options))
                      : testing::randomMesh(number, 14, 11, options);
    const NavGraph graph = graphOf(mesh);
    for (const Location& start : randomStarts(graph, starts, number)) {
      for (const float horizon : {0.0f, 0.4f, 2.0f, 5.0f, 40.0f}) {
        SCOPED_TRACE(::testing::Message() << "seed " << seed << " polygon " << index(start.polygon)
                                          << " horizon " << horizon);
        check(graph, start, horizon);
        if (::testing::Test::HasFatalFailure()) return;
      }
    }
  }
}

/// Tree indices of the nodes from the source to `at`.
std::vector<std::uint32_t> ancestry(std::span<const SearchNode> tree, std::uint32_t at) {
  std::vector<std::uint32_t> chain{at};
  while (chain.back() != 0) chain.push_back(tree[chain.back()].parent);
  std::reverse(chain.begin(), chain.end());
  return chain;
}

TEST(Predict, AgreesWithAWordForWordTranscriptionOfThePapersListing) {
  onRandomMeshes([](const NavGraph& graph, const Location& start, float horizon) {
    const testing::Listing listing = testing::paperListing(graph, start, horizon);
    HorizonSearch search(graph, graph.polygonCount());
    std::vector<Corner> corners;
    search.run(start, horizon, corners);

    ASSERT_EQ(search.tree().size(), listing.settled.size());
    std::vector<std::uint32_t> branches, terminals;
    for (std::size_t i = 0; i < listing.settled.size(); ++i) {
      const testing::ListingNode& theirs = listing.settled[i];
      const std::uint32_t found = search.treeIndexOf(PolygonId{theirs.polygon});
      ASSERT_NE(found, kNone);
      const SearchNode& ours = search.tree()[found];
      ASSERT_NEAR(ours.key, theirs.dist, 1e-5f * (1.0f + theirs.dist));
      ASSERT_EQ(ours.within, theirs.within);
      if (i == 0) continue;
      ASSERT_EQ(index(search.tree()[ours.parent].polygon), theirs.prev);
      ASSERT_EQ(index(search.tree()[ours.prevPG].polygon), theirs.prevPG);
      if (ours.branch) branches.push_back(theirs.polygon);
      if (ours.within && !ours.hasWithinChild) terminals.push_back(theirs.polygon);
    }
    std::sort(branches.begin(), branches.end());
    std::sort(terminals.begin(), terminals.end());
    EXPECT_EQ(branches, listing.branches);
    EXPECT_EQ(terminals, listing.terminals);
  });
}

TEST(Predict, MeasuresEveryDistanceAlongTheTautPathThroughTheCorridor) {
  onRandomMeshes([](const NavGraph& graph, const Location& start, float horizon) {
    HorizonSearch search(graph, graph.polygonCount());
    std::vector<Corner> corners;
    search.run(start, horizon, corners);
    for (std::uint32_t at = 1; at < search.tree().size(); ++at) {
      const glm::vec2 goal = graph.centroid[index(search.tree()[at].polygon)];
      const Corner& before = corners[search.cornerBefore(at, goal)];
      std::vector<navmesh::Portal> corridor;
      for (const std::uint32_t step : ancestry(search.tree(), at)) {
        if (step != 0) corridor.push_back(graph.portals[search.tree()[step].portal]);
      }
      std::vector<glm::vec2> taut;
      navmesh::pullString(start.plan, goal, corridor, taut);
      EXPECT_NEAR(before.distance + glm::distance(before.plan, goal), navmesh::lengthOf(taut),
                  1e-4f);
    }
  });
}

TEST(Predict, CutsEveryWayAtExactlyTheHorizonOrEndsItWhereNobodyCanGoOn) {
  onRandomMeshes([](const NavGraph& graph, const Location& start, float horizon) {
    Scratch scratch(graph);
    const PredictionGraph& found = predict(graph, start, horizon, scratch);
    for (const NodeId terminal : found.terminals) {
      const Node& node = found.node(terminal);
      if (node.reason == TerminalReason::kHorizon) {
        EXPECT_EQ(node.distance, horizon);
        EXPECT_TRUE(navmesh::contains(graph, node.polygon, node.plan, 2e-3f));
      } else {
        EXPECT_EQ(node.reason, TerminalReason::kDeadEnd);
        EXPECT_LE(node.distance, horizon);
      }
    }
  });
}

TEST(Predict, DrawsEveryWayInsideTheWalkableAreaAndNoLongerThanItsDistance) {
  onRandomMeshes(
      [](const NavGraph& graph, const Location& start, float horizon) {
        Scratch scratch(graph);
        const navmesh::LocationIndex places = navmesh::makeLocationIndex(graph);
        const PredictionGraph& found = predict(graph, start, horizon, scratch);
        std::vector<glm::vec3> way;
        for (std::uint32_t id = 0; id < found.nodes.size(); ++id) {
          wayTo(found, NodeId{id}, way);
          float length = 0.0f;
          for (std::size_t i = 1; i < way.size(); ++i) {
            const glm::vec2 from = navmesh::toPlan(way[i - 1]);
            const glm::vec2 to = navmesh::toPlan(way[i]);
            length += glm::distance(from, to);
            for (const float share : {0.1f, 0.37f, 0.5f, 0.81f}) {
              const glm::vec3 between = way[i - 1] + share * (way[i] - way[i - 1]);
              EXPECT_TRUE(navmesh::locate(graph, places, between, {2e-3f, 5.0f, 5.0f}))
                  << "(" << between.x << ", " << between.z << ")";
            }
          }
          EXPECT_NEAR(length, found.nodes[id].distance, 1e-3f);
          EXPECT_LE(found.nodes[id].distance, horizon);
        }
        for (const Edge& edge : found.edges) {
          EXPECT_NEAR(edge.length, navmesh::lengthOf(found.pathOf(edge)), 1e-4f);
          EXPECT_EQ(found.pathOf(edge).front(), found.node(edge.from).plan);
          EXPECT_EQ(found.pathOf(edge).back(), found.node(edge.to).plan);
          for (const glm::vec2 point : found.pathOf(edge)) {
            EXPECT_TRUE(
                navmesh::locate(graph, places, navmesh::toSpace(point, 0.0f), {2e-3f, 5.0f, 5.0f}));
          }
        }
      },
      8, 3);
}

TEST(Predict, GivesEachNodeAnEdgeToItsPrevAndListsItAmongItsChildren) {
  onRandomMeshes([](const NavGraph& graph, const Location& start, float horizon) {
    Scratch scratch(graph);
    const PredictionGraph& found = predict(graph, start, horizon, scratch);
    ASSERT_EQ(found.node(NodeId{0}).kind, NodeKind::kSource);
    ASSERT_GE(found.edges.size() + 1, found.nodes.size());
    std::size_t listed = 0;
    for (std::uint32_t id = 0; id < found.nodes.size(); ++id) {
      for (const NodeId child : found.childrenOf(NodeId{id})) {
        EXPECT_EQ(found.node(child).prev, NodeId{id});
        ++listed;
      }
      if (id == 0) continue;
      const Edge& edge = found.treeEdge(NodeId{id});
      const Node& prev = found.node(edge.to);
      EXPECT_EQ(edge.from, NodeId{id});
      EXPECT_EQ(edge.to, found.nodes[id].prev);
      EXPECT_LT(index(edge.to), id);
      EXPECT_TRUE(prev.branch || prev.kind == NodeKind::kSource);
      EXPECT_EQ(found.corridorOf(edge).front(), found.nodes[id].polygon);
      EXPECT_EQ(found.corridorOf(edge).back(), prev.polygon);
    }
    EXPECT_EQ(listed + 1, found.nodes.size());
  });
}

TEST(Predict, JoinsNeighboursInTheGraphThatTheTreeLeavesApart) {
  onRandomMeshes([](const NavGraph& graph, const Location& start, float horizon) {
    Scratch scratch(graph);
    const PredictionGraph& found = predict(graph, start, horizon, scratch);
    std::set<std::pair<std::uint32_t, std::uint32_t>> joined, loops;
    std::vector<std::uint32_t> nodeOf(graph.polygonCount(), kNone);
    for (std::uint32_t id = 0; id < found.nodes.size(); ++id) {
      // A cut terminal stands on the way to a polygon, it is not that polygon's node.
      if (found.nodes[id].reason != TerminalReason::kHorizon)
        nodeOf[index(found.nodes[id].polygon)] = id;
    }
    for (std::uint32_t u = 0; u < graph.polygonCount(); ++u) {
      for (std::uint32_t p = graph.portalStart[u]; p < graph.portalStart[u + 1]; ++p) {
        const std::uint32_t from = nodeOf[u], to = nodeOf[index(graph.portalTo[p])];
        if (from == kNone || to == kNone || to >= from) continue;
        if (found.nodes[from].prev != NodeId{to}) joined.insert({from, to});
      }
    }
    for (const Edge& edge : found.edges) {
      if (edge.kind != EdgeKind::kLoop) continue;
      EXPECT_TRUE(loops.insert({index(edge.from), index(edge.to)}).second) << "joined twice";
    }
    EXPECT_EQ(loops, joined);
  });
}

TEST(Predict, KeepsTheNodesOfAShorterHorizon) {
  onRandomMeshes([](const NavGraph& graph, const Location& start, float horizon) {
    HorizonSearch shorter(graph, graph.polygonCount()), longer(graph, graph.polygonCount());
    std::vector<Corner> corners;
    shorter.run(start, horizon, corners);
    longer.run(start, 1.25f * horizon + 0.5f, corners);
    for (const SearchNode& node : shorter.tree()) {
      if (!node.within) continue;
      const std::uint32_t at = longer.treeIndexOf(node.polygon);
      ASSERT_NE(at, kNone);
      EXPECT_TRUE(longer.tree()[at].within);
      EXPECT_TRUE(longer.tree()[at].branch || !node.branch);
    }
  });
}

/// What is left of a graph when ids are forgotten: kinds and distances, sorted.
std::vector<std::pair<int, float>> shapeOf(const PredictionGraph& graph, float scale) {
  std::vector<std::pair<int, float>> shape;
  for (const Node& node : graph.nodes) {
    shape.push_back(
        {static_cast<int>(node.kind) * 4 + static_cast<int>(node.reason), node.distance / scale});
  }
  std::sort(shape.begin(), shape.end());
  return shape;
}

void expectSameShape(const PredictionGraph& a, const PredictionGraph& b, float scale) {
  const auto shapeA = shapeOf(a, 1.0f), shapeB = shapeOf(b, scale);
  ASSERT_EQ(shapeA.size(), shapeB.size());
  for (std::size_t i = 0; i < shapeA.size(); ++i) {
    EXPECT_EQ(shapeA[i].first, shapeB[i].first);
    EXPECT_NEAR(shapeA[i].second, shapeB[i].second, 1e-4f);
  }
}

TEST(Predict, IsTheSameInASceneThatIsTurnedMirroredOrScaled) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    const PolygonMesh mesh = testing::randomMesh(seed, 12, 12);
    const NavGraph graph = graphOf(mesh);
    const NavGraph turned = graphOf(testing::turned(mesh, 0.7f));
    const NavGraph mirrored = graphOf(testing::mirrored(mesh));
    const NavGraph scaled = graphOf(testing::scaled(mesh, 2.0f));
    for (const Location& start : randomStarts(graph, 4, seed)) {
      Scratch a(graph), b(turned), c(mirrored), d(scaled);
      const PredictionGraph& plain = predict(graph, start, 6.0f, a);
      Location moved = start;
      moved.plan = glm::vec2(std::cos(0.7f) * start.plan.x - std::sin(0.7f) * start.plan.y,
                             std::sin(0.7f) * start.plan.x + std::cos(0.7f) * start.plan.y);
      expectSameShape(plain, predict(turned, moved, 6.0f, b), 1.0f);
      moved.plan = glm::vec2(-start.plan.x, start.plan.y);
      expectSameShape(plain, predict(mirrored, moved, 6.0f, c), 1.0f);
      moved.plan = 2.0f * start.plan;
      expectSameShape(plain, predict(scaled, moved, 12.0f, d), 2.0f);
    }
  }
}

TEST(Predict, IsTheSameForPolygonsInAnotherOrder) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    const PolygonMesh mesh = testing::randomMesh(seed, 12, 12);
    PolygonMesh reversed = mesh;
    reversed.ringStart = {0};
    reversed.ring.clear();
    for (std::uint32_t i = mesh.polygonCount(); i-- > 0;) {
      reversed.ring.insert(reversed.ring.end(), mesh.ring.begin() + mesh.ringStart[i],
                           mesh.ring.begin() + mesh.ringStart[i + 1]);
      reversed.ringStart.push_back(static_cast<std::uint32_t>(reversed.ring.size()));
    }
    const NavGraph graph = graphOf(mesh), other = graphOf(reversed);
    for (Location start : randomStarts(graph, 4, seed)) {
      Scratch a(graph), b(other);
      const PredictionGraph& plain = predict(graph, start, 6.0f, a);
      start.polygon = PolygonId{mesh.polygonCount() - 1 - index(start.polygon)};
      expectSameShape(plain, predict(other, start, 6.0f, b), 1.0f);
    }
  }
}

TEST(Predict, RemembersNothingOfEarlierFrames) {
  const NavGraph graph = graphOf(testing::randomMesh(5, 20, 20));
  Scratch used(graph);
  for (const Location& start : randomStarts(graph, 60, 5)) {
    for (const float horizon : {1.0f, 7.0f, 20.0f}) {
      Scratch fresh(graph);
      EXPECT_EQ(hashOf(predict(graph, start, horizon, used)),
                hashOf(predict(graph, start, horizon, fresh)));
    }
  }
}

TEST(Predict, LooksAtWhatLiesWithinTheHorizonOnly) {
  const PolygonMesh floor = testing::randomMesh(3, 15, 15);
  const NavGraph one = graphOf(floor), hundred = graphOf(testing::repeated(floor, 10, 10));
  Scratch a(one), b(hundred);
  for (const Location& start : randomStarts(one, 30, 3)) {
    const PredictionGraph& small = predict(one, start, 6.0f, a);
    const PredictionGraph& large = predict(hundred, start, 6.0f, b);
    EXPECT_EQ(hashOf(small), hashOf(large));
    EXPECT_EQ(small.stats.settled, large.stats.settled);
    EXPECT_EQ(small.stats.relaxed, large.stats.relaxed);
  }
}

TEST(Predict, SaysThatItHitThePolygonLimitAndHowFarItGot) {
  const NavGraph graph = graphOf(testing::randomMesh(8, 20, 20));
  const Location start = randomStarts(graph, 1, 8).front();
  Scratch roomy(graph), tight(graph, {.polygons = 25});
  ASSERT_EQ(predict(graph, start, 30.0f, roomy).flags, kGraphComplete);
  for (int again = 0; again < 2; ++again) {
    const PredictionGraph& cut = predict(graph, start, 30.0f, tight);
    EXPECT_EQ(cut.flags, kPolygonLimit);
    EXPECT_EQ(cut.stats.settled, 25u);
    EXPECT_LT(cut.completeTo, 30.0f);
    EXPECT_FALSE(cut.terminals.empty());
    // What fits under the limit is not disturbed by having hit it before.
    EXPECT_EQ(predict(graph, start, 0.5f, tight).flags, kGraphComplete);
    const std::uint64_t hash = hashOf(predict(graph, start, 0.5f, tight));
    EXPECT_EQ(hash, hashOf(predict(graph, start, 0.5f, roomy)));
  }
}

TEST(Predict, GivesTheSourceAloneOffTheNavmesh) {
  const NavGraph graph = graphOf(testing::gridMesh(2, 2));
  Scratch scratch(graph);
  const PredictionGraph& found = predict(graph, Location{}, 5.0f, scratch);
  EXPECT_EQ(found.flags, kSourceOffMesh);
  EXPECT_EQ(found.nodes.size(), 1u);
  EXPECT_TRUE(found.terminals.empty());
}

TEST(Predict, FollowsAStraightCorridorBothWays) {
  const std::vector<float> lengths(40, 1.0f);
  const NavGraph graph = graphOf(testing::corridorMesh(lengths, 2.0f));
  Scratch scratch(graph);
  const glm::vec2 middle = 0.5f * (graph.centroid[19] + graph.centroid[20]) - glm::vec2(0.1f, 0.0f);
  const PredictionGraph& found =
      predict(graph, {PolygonId{19}, middle, 0.0f, false}, 8.0f, scratch);
  ASSERT_EQ(found.terminals.size(), 2u);
  for (const NodeId terminal : found.terminals) {
    EXPECT_EQ(found.node(terminal).reason, TerminalReason::kHorizon);
    EXPECT_NEAR(std::abs(found.node(terminal).plan.x - middle.x), 8.0f, 1e-4f);
  }
  const PredictionGraph& whole =
      predict(graph, {PolygonId{19}, middle, 0.0f, false}, 100.0f, scratch);
  ASSERT_EQ(whole.terminals.size(), 2u);
  for (const NodeId terminal : whole.terminals) {
    EXPECT_EQ(whole.node(terminal).reason, TerminalReason::kDeadEnd);
  }
}

TEST(Predict, IsTheSameToTheLastBitInEveryBuild) {
  // Debug, Release and every compiler: + - * / and sqrt only. A change here changes what users see.
  std::uint64_t hash = 0;
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const NavGraph graph = graphOf(testing::randomMesh(seed, 16, 16));
    Scratch scratch(graph);
    for (const Location& start : randomStarts(graph, 20, seed)) {
      hash = hash * 31 + hashOf(predict(graph, start, 7.5f, scratch));
    }
  }
  EXPECT_EQ(hash, 4169295899108354464ull);
}

}  // namespace
}  // namespace forewalk::prediction
