// Predictions where polygons are closed or cost more.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <random>
#include <set>
#include <string>
#include <tuple>
#include <vector>

#include "navmesh/random.h"
#include "prediction/front_graph.h"
#include "prediction/predict.h"
#include "tests/support/count_allocations.h"
#include "tests/support/random_mesh.h"
#include "tests/support/random_start.h"
#include "tests/support/without.h"

namespace forewalk::prediction {
namespace {

using navmesh::kClosed;
using navmesh::Location;
using navmesh::NavGraph;
using navmesh::PolygonMesh;
using navmesh::PolygonStates;

NavGraph graphOf(const PolygonMesh& mesh) {
  auto graph = navmesh::makeNavGraph(mesh);
  if (!graph) throw std::runtime_error(graph.error().message);
  return std::move(*graph);
}

PolygonMesh meshOf(std::uint64_t seed) {
  testing::RandomMeshOptions options;
  options.holeShare = 0.06 * static_cast<double>(seed % 7);
  options.mergeShare = 0.1 * static_cast<double>(seed % 9);
  options.splitShare = 0.15 * static_cast<double>(seed % 5);
  const PolygonMesh mesh = testing::randomMesh(seed, 13, 11, options);
  return seed % 4 == 0 ? testing::joinedAlong(mesh, testing::randomMesh(seed + 100, 6, 11, options))
                       : mesh;
}

void set(const NavGraph& graph, PolygonStates& states, std::uint32_t polygon, float cost) {
  const auto done = navmesh::setCost(graph, std::vector{PolygonId{polygon}}, cost, states);
  if (!done) throw std::runtime_error(done.error().message);
}

/// Some polygons closed, and some that cost more; at least one closed.
PolygonStates randomStates(const NavGraph& graph, std::mt19937_64& rng, double closed,
                           double dear) {
  PolygonStates states;
  std::vector<PolygonId> shut{
      PolygonId{static_cast<std::uint32_t>(navmesh::uniformInt(rng, graph.polygonCount()))}};
  std::vector<PolygonId> often;
  for (std::uint32_t p = 0; p < graph.polygonCount(); ++p) {
    const double drawn = navmesh::uniform(rng);
    if (drawn < closed) {
      shut.push_back(PolygonId{p});
    } else if (drawn < closed + dear) {
      often.push_back(PolygonId{p});
    }
  }
  EXPECT_TRUE(navmesh::setCost(graph, often, 3.0f, states));
  EXPECT_TRUE(navmesh::setCost(graph, shut, kClosed, states));
  return states;
}

/// Equal to the last bit; polygons of `a` are `oldOf` those of `b`.
void expectSame(const PredictionGraph& a, const PredictionGraph& b,
                const std::vector<std::uint32_t>& oldOf) {
  const auto old = [&](PolygonId polygon) { return PolygonId{oldOf[index(polygon)]}; };
  EXPECT_EQ(a.flags, b.flags);
  EXPECT_EQ(a.completeTo, b.completeTo);
  EXPECT_EQ(a.stats.relaxed, b.stats.relaxed);
  ASSERT_EQ(a.nodes.size(), b.nodes.size());
  for (std::size_t i = 0; i < a.nodes.size(); ++i) {
    const Node &x = a.nodes[i], &y = b.nodes[i];
    EXPECT_EQ(x.polygon, old(y.polygon));
    const auto seen = [](const Node& n) {
      return std::tuple(n.kind, n.reason, n.branch, n.plan.x, n.plan.y, n.height, n.distance,
                        n.prev, n.corner, n.firstChild, n.childCount);
    };
    ASSERT_EQ(seen(x), seen(y)) << "node " << i;
  }
  ASSERT_EQ(a.edges.size(), b.edges.size());
  for (std::size_t i = 0; i < a.edges.size(); ++i) {
    const auto seen = [](const Edge& e) {
      return std::tuple(e.from, e.to, e.kind, e.length, e.polygonStart, e.polygonCount, e.pathStart,
                        e.pathCount);
    };
    ASSERT_EQ(seen(a.edges[i]), seen(b.edges[i])) << "edge " << i;
  }
  ASSERT_EQ(a.corridorPolygons.size(), b.corridorPolygons.size());
  for (std::size_t i = 0; i < a.corridorPolygons.size(); ++i) {
    ASSERT_EQ(a.corridorPolygons[i], old(b.corridorPolygons[i]));
  }
  EXPECT_EQ(a.pathPoints, b.pathPoints);
  EXPECT_EQ(a.terminals, b.terminals);
  ASSERT_EQ(a.corners.size(), b.corners.size());
  for (std::size_t i = 0; i < a.corners.size(); ++i) {
    ASSERT_EQ(a.corners[i].plan, b.corners[i].plan);
    ASSERT_EQ(a.corners[i].distance, b.corners[i].distance);
    ASSERT_EQ(a.corners[i].previous, b.corners[i].previous);
  }
}

TEST(PredictStates, AreTakenWhereTheSourceIsOffTheMesh) {
  const NavGraph graph = graphOf(testing::gridMesh(2, 1));
  PolygonStates states;
  set(graph, states, 0, kClosed);
  Scratch scratch(graph);
  EXPECT_EQ(predict(graph, {}, 5.0f, scratch, &states).flags, kSourceOffMesh);
}

TEST(PredictStates, LeaveAUserAloneWhoIsClosedInOnAllSides) {
  const NavGraph graph = graphOf(testing::gridMesh(3, 3));
  PolygonStates states;
  for (const std::uint32_t p : {1u, 3u, 5u, 7u}) set(graph, states, p, kClosed);
  Scratch scratch(graph);
  const Location middle{PolygonId{4}, graph.centroid[4], 0.0f, false};
  EXPECT_EQ(predict(graph, middle, 9.0f, scratch, &states).nodes.size(), 1u);
  // And so it is where their own ground is closed as well.
  set(graph, states, 4, kClosed);
  EXPECT_EQ(predict(graph, middle, 9.0f, scratch, &states).nodes.size(), 1u);
}

TEST(PredictStates, ClosingAPolygonIsRemovingItFromTheMesh) {
  int graphs = 0;
  std::size_t nodes = 0, chains = 0;
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    const PolygonMesh mesh = meshOf(seed);
    const NavGraph graph = graphOf(mesh);
    std::mt19937_64 rng(seed);
    const double share = seed % 3 == 0 ? 0.0 : 0.05 * static_cast<double>(seed % 5);
    const PolygonStates states = randomStates(graph, rng, share, 0.0);
    std::vector<bool> closed(graph.polygonCount());
    for (std::uint32_t p = 0; p < graph.polygonCount(); ++p) {
      closed[p] = states.isClosed(PolygonId{p});
    }
    const auto [leftMesh, oldOf] = testing::without(mesh, closed);
    if (leftMesh.polygonCount() == 0) continue;
    const NavGraph left = graphOf(leftMesh);
    chains += left.chains.chainCount();
    Scratch scratch(graph), leftScratch(left);
    Scratch few(graph, {.polygons = 9}), leftFew(left, {.polygons = 9});
    for (const Location& start : testing::randomStarts(left, 8, seed)) {
      Location same = start;
      same.polygon = PolygonId{oldOf[index(start.polygon)]};
      for (const float horizon : {0.0f, 1.5f, 4.0f, 12.0f, 60.0f}) {
        SCOPED_TRACE(::testing::Message() << "seed " << seed << " horizon " << horizon);
        const PredictionGraph& found = predict(graph, same, horizon, scratch, &states);
        expectSame(found, predict(left, start, horizon, leftScratch), oldOf);
        nodes += found.nodes.size();
        ++graphs;
        // Up to how much is dropped where a limit is too low.
        expectSame(predict(graph, same, horizon, few, &states),
                   predict(left, start, horizon, leftFew), oldOf);
        if (HasFatalFailure()) return;
      }
    }
  }
  EXPECT_GT(graphs, 1000);
  EXPECT_GT(nodes, 20000u);
  EXPECT_GT(chains, 200u);
}

TEST(PredictStates, ClosingAPolygonIsRemovingItForFrontsToo) {
  std::size_t nodes = 0;
  for (std::uint64_t seed = 1; seed <= 24; ++seed) {
    const PolygonMesh mesh = meshOf(seed);
    const NavGraph graph = graphOf(mesh);
    std::mt19937_64 rng(seed);
    const PolygonStates states =
        randomStates(graph, rng, 0.05 * static_cast<double>(seed % 5), 0.1);
    std::vector<bool> closed(graph.polygonCount());
    for (std::uint32_t p = 0; p < graph.polygonCount(); ++p) {
      closed[p] = states.isClosed(PolygonId{p});
    }
    const auto [leftMesh, oldOf] = testing::without(mesh, closed);
    if (leftMesh.polygonCount() == 0) continue;
    const NavGraph left = graphOf(leftMesh);
    const FrontIndex frontIndex = makeFrontIndex(graph, &states);
    const FrontIndex leftIndex = makeFrontIndex(left);
    FrontScratch scratch(graph, frontIndex), leftScratch(left, leftIndex);
    for (const Location& start : testing::randomStarts(left, 8, seed)) {
      Location same = start;
      same.polygon = PolygonId{oldOf[index(start.polygon)]};
      for (const float horizon : {0.0f, 1.5f, 4.0f, 12.0f}) {
        SCOPED_TRACE(::testing::Message() << "seed " << seed << " horizon " << horizon);
        const PredictionGraph& found = predictFronts(graph, same, horizon, scratch);
        expectSame(found, predictFronts(left, start, horizon, leftScratch), oldOf);
        nodes += found.nodes.size();
        if (HasFatalFailure()) return;
      }
    }
  }
  EXPECT_GT(nodes, 3000u);
}

TEST(PredictStates, FrontsOfWhoStandsOnClosedGroundBeginAtTheNearestWayOut) {
  const NavGraph graph = graphOf(testing::gridMesh(5, 1));
  PolygonStates states;
  set(graph, states, 2, kClosed);
  const FrontIndex frontIndex = makeFrontIndex(graph, &states);
  FrontScratch scratch(graph, frontIndex);
  // Nearer to the polygon before than to the one behind.
  const Location inside{PolygonId{2}, graph.centroid[2] - glm::vec2(0.2f, 0.0f), 0.0f, false};
  const PredictionGraph& found = predictFronts(graph, inside, 9.0f, scratch);
  EXPECT_EQ(found.flags, kGraphComplete);
  ASSERT_GT(found.nodes.size(), 1u);
  for (const Node& node : found.nodes) EXPECT_LE(node.plan.x, inside.plan.x);
  // Closed in on all sides there are no ways.
  for (const std::uint32_t p : {1u, 3u}) set(graph, states, p, kClosed);
  const FrontIndex shutIndex = makeFrontIndex(graph, &states);
  FrontScratch shut(graph, shutIndex);
  EXPECT_EQ(predictFronts(graph, inside, 9.0f, shut).nodes.size(), 1u);
}

TEST(PredictStates, OpeningAgainGivesTheSameGraphsAsBeforeToTheLastBit) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const NavGraph graph = graphOf(meshOf(seed));
    std::mt19937_64 rng(seed);
    PolygonStates states = randomStates(graph, rng, 0.1, 0.1);
    std::vector<PolygonId> all;
    for (std::uint32_t p = 0; p < graph.polygonCount(); ++p) all.push_back(PolygonId{p});
    Scratch scratch(graph), fresh(graph);
    const auto starts = testing::randomStarts(graph, 10, seed);
    int changed = 0;
    for (const Location& start : starts) {
      const std::uint64_t before = hashOf(predict(graph, start, 8.0f, fresh));
      changed += hashOf(predict(graph, start, 8.0f, scratch, &states)) != before ? 1 : 0;
      EXPECT_EQ(hashOf(predict(graph, start, 8.0f, scratch)), before);
      EXPECT_EQ(hashOf(predict(graph, start, 8.0f, scratch, &states)),
                hashOf(predict(graph, start, 8.0f, scratch, &states)));
    }
    EXPECT_GT(changed, 0);
    ASSERT_TRUE(navmesh::setCost(graph, all, 1.0f, states));
    EXPECT_TRUE(states.allOpen());
    for (const Location& start : starts) {
      EXPECT_EQ(hashOf(predict(graph, start, 8.0f, scratch, &states)),
                hashOf(predict(graph, start, 8.0f, fresh)));
    }
  }
}

TEST(PredictStates, NeverEnterWhatIsClosedNorWhatLiesBehindIt) {
  std::size_t cut = 0;
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    const NavGraph graph = graphOf(meshOf(seed));
    std::mt19937_64 rng(seed);
    const PolygonStates states = randomStates(graph, rng, 0.2, 0.2);
    Scratch scratch(graph);
    for (const Location& start : testing::randomStarts(graph, 6, seed)) {
      std::vector<bool> reached(graph.polygonCount(), false);
      std::vector<PolygonId> open{start.polygon};
      reached[index(start.polygon)] = true;
      while (!open.empty()) {
        const std::uint32_t p = index(open.back());
        open.pop_back();
        for (std::uint32_t h = graph.portalStart[p]; h < graph.portalStart[p + 1]; ++h) {
          const PolygonId next = graph.portalTo[h];
          if (reached[index(next)] || states.isClosed(next)) continue;
          reached[index(next)] = true;
          open.push_back(next);
        }
      }
      cut += static_cast<std::size_t>(std::count(reached.begin(), reached.end(), false));
      const PredictionGraph& found = predict(graph, start, 100.0f, scratch, &states);
      for (const PolygonId polygon : found.corridorPolygons) EXPECT_TRUE(reached[index(polygon)]);
      // All that can be reached is: the horizon is beyond the mesh.
      EXPECT_EQ(found.stats.settled,
                static_cast<std::size_t>(std::count(reached.begin(), reached.end(), true)));
    }
  }
  EXPECT_GT(cut, 1000u);
}

TEST(PredictStates, AClosedDoorEndsTheCorridorBeforeIt) {
  const std::vector<float> lengths{2.0f, 2.0f, 1.0f, 3.0f, 4.0f};
  const NavGraph graph = graphOf(testing::corridorMesh(lengths));
  Scratch scratch(graph);
  const Location start{PolygonId{0}, {1.0f, 0.5f}, 0.0f, false};
  PolygonStates states;
  set(graph, states, 2, kClosed);
  const PredictionGraph& shut = predict(graph, start, 20.0f, scratch, &states);
  ASSERT_EQ(shut.terminals.size(), 1u);
  EXPECT_EQ(shut.node(shut.terminals[0]).polygon, PolygonId{1});
  EXPECT_EQ(shut.node(shut.terminals[0]).reason, TerminalReason::kDeadEnd);
  // Open again, it ends where the corridor ends.
  set(graph, states, 2, 1.0f);
  const PredictionGraph& open = predict(graph, start, 20.0f, scratch, &states);
  ASSERT_EQ(open.terminals.size(), 1u);
  EXPECT_EQ(open.node(open.terminals[0]).polygon, PolygonId{4});
}

// By what a search says of each polygon: nodes come in another order.
TEST(PredictStates, WhoStandsOnClosedGroundSeesWhatTheyWouldSeeWereItOpen) {
  std::size_t compared = 0;
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    const NavGraph graph = graphOf(meshOf(seed));
    HorizonSearch open(graph, graph.polygonCount()), closed(graph, graph.polygonCount());
    std::vector<Corner> openCorners, closedCorners;
    std::mt19937_64 rng(seed);
    for (const Location& start : testing::randomStarts(graph, 8, seed)) {
      PolygonStates others = randomStates(graph, rng, 0.08, 0.08);
      set(graph, others, index(start.polygon), 1.0f);
      PolygonStates own = others;
      set(graph, own, index(start.polygon), kClosed);
      const float horizon = 2.0f + static_cast<float>(seed % 9);
      open.run(start, horizon, openCorners, HorizonSearch::Limit::kTaut, &others);
      closed.run(start, horizon, closedCorners, HorizonSearch::Limit::kTaut, &own);
      ASSERT_EQ(open.tree().size(), closed.tree().size());
      for (const SearchNode& a : open.tree()) {
        ASSERT_NE(closed.treeIndexOf(a.polygon), kNone);
        const SearchNode& b = closed.tree()[closed.treeIndexOf(a.polygon)];
        EXPECT_NEAR(a.key, b.key, 1e-4f);
        EXPECT_EQ(a.portal, b.portal);
        EXPECT_EQ(a.within, b.within);
        EXPECT_EQ(a.branch, b.branch) << "seed " << seed << " polygon " << index(a.polygon);
        EXPECT_EQ(open.tree()[a.prevPG].polygon, closed.tree()[b.prevPG].polygon);
        EXPECT_EQ(a.hasWithinChild, b.hasWithinChild);
        EXPECT_EQ(a.hasCutChild, b.hasCutChild);
        ++compared;
      }
    }
  }
  EXPECT_GT(compared, 15000u);
}

TEST(PredictStates, WaysGoAroundWhatCostsMoreAndAreStillMeasuredInMetres) {
  // A ring around a block: left to right it is as far by either side.
  const NavGraph graph = graphOf(testing::without(testing::gridMesh(3, 3),
                                                  [] {
                                                    std::vector<bool> removed(9, false);
                                                    removed[4] = true;
                                                    return removed;
                                                  }())
                                     .first);
  const Location left{PolygonId{3}, graph.centroid[3], 0.0f, false};
  HorizonSearch search(graph, graph.polygonCount());
  std::vector<Corner> corners;
  for (const bool upper : {false, true}) {
    PolygonStates states;
    set(graph, states, upper ? 6 : 1, 2.0f);  // the middle of a side
    search.run(left, 20.0f, corners, HorizonSearch::Limit::kTaut, &states);
    const std::uint32_t right = search.treeIndexOf(PolygonId{4});
    ASSERT_NE(right, kNone);
    const SearchNode& node = search.tree()[right];
    EXPECT_EQ(index(search.tree()[node.parent].polygon), upper ? 2u : 7u);
    // Around the block: from (0.5, 1.5) by its near corners (1, y), (2, y) to (2.5, 1.5).
    const Corner& before = corners[search.cornerBefore(right, graph.centroid[4])];
    EXPECT_NEAR(before.distance + glm::distance(before.plan, graph.centroid[4]),
                1.0f + 2.0f * std::sqrt(0.5f), 1e-5f);
    EXPECT_NEAR(node.key, 0.5f + 2.0f * std::sqrt(0.5f) + 1.0f, 1e-5f);
    // Where both sides cost twice as much, nothing is gained by either; keys are dearer.
    set(graph, states, upper ? 1 : 6, 2.0f);
    search.run(left, 20.0f, corners, HorizonSearch::Limit::kTaut, &states);
    EXPECT_NEAR(search.tree()[search.treeIndexOf(PolygonId{4})].key,
                0.5f + 2.0f * std::sqrt(0.5f) + 2.0f, 1e-5f);
  }
}

TEST(PredictStates, CostTheFrameNoAllocationWhateverTheStates) {
  const NavGraph graph = graphOf(testing::randomMesh(2, 30, 30));
  const std::vector<Location> starts = testing::randomStarts(graph, 60, 2);
  std::mt19937_64 rng(2);
  std::vector<PolygonStates> states;
  for (int i = 0; i < 12; ++i) states.push_back(randomStates(graph, rng, 0.03 * i, 0.05));
  // All of a chequered floor costs twice: no chain is left; every second polygon closed: none is
  // reached, and others have no more ways than before.
  states.emplace_back();
  std::vector<PolygonId> even;
  for (std::uint32_t p = 0; p < graph.polygonCount(); p += 2) even.push_back(PolygonId{p});
  ASSERT_TRUE(navmesh::setCost(graph, even, kClosed, states.back()));
  std::size_t most = 0;
  for (const PolygonStates& one : states)
    most = std::max<std::size_t>(most, one.chains.chainCount());
  EXPECT_GT(most, graph.chains.chainCount());
  Scratch scratch(graph);
  testing::allocationsSince();
  std::size_t nodes = 0;
  for (const PolygonStates& one : states) {
    for (const float horizon : {1.0f, 5.0f, 20.0f, 200.0f}) {
      for (const Location& start : starts) {
        nodes += predict(graph, start, horizon, scratch, &one).nodes.size();
      }
    }
  }
  EXPECT_EQ(testing::allocationsSince(), 0u);
  EXPECT_GT(nodes, 10000u);
}

}  // namespace
}  // namespace forewalk::prediction
