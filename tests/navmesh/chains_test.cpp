#include "navmesh/chains.h"

#include <gtest/gtest.h>

#include <random>

#include "navmesh/nav_graph.h"
#include "navmesh/polygon_states.h"
#include "navmesh/random.h"
#include "tests/support/random_mesh.h"
#include "tests/support/without.h"

namespace forewalk::navmesh {
namespace {

NavGraph graphOf(const PolygonMesh& mesh) {
  auto graph = makeNavGraph(mesh);
  EXPECT_TRUE(graph) << graph.error().message;
  return *graph;
}

std::vector<NavGraph> graphs() {
  std::vector<NavGraph> all;
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    const double holes = 0.1 * static_cast<double>(seed % 6);
    all.push_back(graphOf(testing::randomMesh(seed, 12, 9, {.holeShare = holes})));
  }
  all.push_back(graphOf(testing::joinedGrids(3, 2, 5, 6.0f)));
  return all;
}

std::uint32_t waysOf(const NavGraph& graph, std::uint32_t polygon) {
  return graph.portalStart[polygon + 1] - graph.portalStart[polygon];
}

TEST(Chains, HaveNothingToSayOfACorridorWithoutCrossings) {
  const NavGraph graph = graphOf(testing::corridorMesh(std::vector<float>{1.0f, 2.0f, 3.0f}));
  EXPECT_EQ(graph.chains.chainCount(), 0u);
  for (const std::uint32_t chain : graph.chains.ofPolygon) EXPECT_EQ(chain, kNoChain);
}

TEST(Chains, HoldEveryPolygonThatOneCanOnlyWalkThroughOnce) {
  std::size_t rows = 0;
  for (const NavGraph& graph : graphs()) {
    std::vector<int> seen(graph.polygonCount(), 0);
    for (std::uint32_t d = 0; d < graph.chains.directed.size(); d += 2) {
      const DirectedChain& way = graph.chains.directed[d];
      for (std::uint32_t row = way.begin; row < way.end; ++row, ++rows) {
        const std::uint32_t polygon = index(graph.chains.rows[row].polygon);
        ++seen[polygon];
        EXPECT_LE(waysOf(graph, polygon), 2u);
        EXPECT_EQ(graph.chains.ofPolygon[polygon], d / 2);
        EXPECT_EQ(graph.chains.rowOf[polygon], row);
      }
    }
    // In components that have a crossing.
    std::vector<bool> crossed(graph.componentCount, false);
    for (std::uint32_t p = 0; p < graph.polygonCount(); ++p) {
      if (waysOf(graph, p) > 2) crossed[graph.component[p]] = true;
    }
    for (std::uint32_t p = 0; p < graph.polygonCount(); ++p) {
      EXPECT_LE(seen[p], 1);
      EXPECT_EQ(seen[p] == 0, graph.chains.ofPolygon[p] == kNoChain);
      const bool passage =
          waysOf(graph, p) == 1 || (waysOf(graph, p) == 2 && graph.neighbourCount[p] == 2);
      if (passage && crossed[graph.component[p]]) {
        EXPECT_EQ(seen[p], 1) << p;
      }
    }
  }
  EXPECT_GT(rows, 500u);
}

TEST(Chains, AreWalkedThroughPortalByPortal) {
  for (const NavGraph& graph : graphs()) {
    for (std::uint32_t h = 0; h < graph.portalCount(); ++h) {
      const std::uint32_t d = graph.chains.enteredBy[h];
      if (d == kNoChain) continue;
      const DirectedChain& way = graph.chains.directed[d];
      ASSERT_LT(way.begin, way.end);
      EXPECT_EQ(graph.chains.rows[way.begin].portal, h);
      float length = 0.0f;
      float farthest = 0.0f;
      for (std::uint32_t row = way.begin; row < way.end; ++row) {
        const ChainRow& here = graph.chains.rows[row];
        EXPECT_EQ(graph.portalTo[here.portal], here.polygon);
        EXPECT_NEAR(here.length, length, 1e-4f);
        farthest = std::max(farthest, here.length + graph.portalToCentroid[here.portal]);
        const bool last = row + 1 == way.end;
        const std::uint32_t next = last ? way.exit : graph.chains.rows[row + 1].portal;
        if (next == kNoChain) {
          EXPECT_EQ(waysOf(graph, index(here.polygon)), 1u);
          break;
        }
        EXPECT_EQ(graph.portalTo[graph.portalTwin[next]], here.polygon);
        length += glm::distance(graph.portalMidpoint[here.portal], graph.portalMidpoint[next]);
      }
      EXPECT_FLOAT_EQ(way.farthest, farthest);
      if (way.exit != kNoChain) {
        EXPECT_EQ(graph.portalTo[way.exit], way.exitTo);
        EXPECT_NEAR(way.exitLength, length, 1e-4f);
      }
    }
  }
}

TEST(Chains, AreTheSameWalkedBackwards) {
  for (const NavGraph& graph : graphs()) {
    for (std::uint32_t d = 0; d < graph.chains.directed.size(); ++d) {
      const DirectedChain& way = graph.chains.directed[d];
      const DirectedChain& back = graph.chains.directed[d ^ 1];
      ASSERT_EQ(way.end - way.begin, back.end - back.begin);
      const std::uint32_t mirror = back.begin + way.end - 1;
      for (std::uint32_t row = way.begin; row < way.end; ++row) {
        EXPECT_EQ(graph.chains.rows[row].polygon, graph.chains.rows[mirror - row].polygon);
      }
      if (way.exit == kNoChain || back.exit == kNoChain) continue;
      EXPECT_EQ(graph.portalTwin[way.exit], graph.chains.rows[back.begin].portal);
      EXPECT_EQ(graph.chains.enteredBy[graph.portalTwin[way.exit]], d ^ 1);
      EXPECT_NEAR(way.exitLength, back.exitLength, 1e-4f);
    }
  }
}

TEST(Chains, AreThoseOfTheMeshWithoutWhatIsClosed) {
  std::size_t rows = 0;
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    const double holes = 0.1 * static_cast<double>(seed % 6);
    const PolygonMesh mesh = testing::randomMesh(seed, 12, 9, {.holeShare = holes});
    const NavGraph graph = graphOf(mesh);
    std::mt19937_64 rng(seed);
    std::vector<bool> closed(graph.polygonCount());
    std::vector<PolygonId> polygons;
    for (std::uint32_t p = 1; p < graph.polygonCount(); ++p) {
      closed[p] = uniform(rng) < 0.03 * static_cast<double>(seed % 8);
      if (closed[p]) polygons.push_back(PolygonId{p});
    }
    PolygonStates states;
    ASSERT_TRUE(setCost(graph, polygons, kClosed, states));
    if (states.allOpen()) continue;
    const auto [leftMesh, oldOf] = testing::without(mesh, closed);
    const NavGraph left = graphOf(leftMesh);
    ASSERT_EQ(states.chains.directed.size(), left.chains.directed.size());
    for (std::size_t d = 0; d < left.chains.directed.size(); ++d) {
      const DirectedChain &here = states.chains.directed[d], &there = left.chains.directed[d];
      EXPECT_EQ(here.begin, there.begin);
      EXPECT_EQ(here.end, there.end);
      EXPECT_EQ(here.exit == kNoChain, there.exit == kNoChain);
      EXPECT_EQ(here.exitLength, there.exitLength);
      EXPECT_EQ(here.farthest, there.farthest);
    }
    ASSERT_EQ(states.chains.rows.size(), left.chains.rows.size());
    for (std::size_t row = 0; row < left.chains.rows.size(); ++row, ++rows) {
      EXPECT_EQ(index(states.chains.rows[row].polygon),
                oldOf[index(left.chains.rows[row].polygon)]);
      EXPECT_EQ(states.chains.rows[row].length, left.chains.rows[row].length);
    }
    for (std::uint32_t p = 0; p < left.polygonCount(); ++p) {
      EXPECT_EQ(states.openNeighbours[oldOf[p]], left.neighbourCount[p]);
      EXPECT_EQ(states.chains.ofPolygon[oldOf[p]], left.chains.ofPolygon[p]);
      EXPECT_EQ(states.chains.rowOf[oldOf[p]], left.chains.rowOf[p]);
    }
    for (const PolygonId polygon : polygons) {
      EXPECT_EQ(states.chains.ofPolygon[index(polygon)], kNoChain);
    }
  }
  EXPECT_GT(rows, 500u);
}

TEST(Chains, HoldNothingThatCostsMore) {
  std::size_t cut = 0;
  for (const NavGraph& graph : graphs()) {
    std::vector<PolygonId> dear;
    for (std::uint32_t p = 0; p < graph.polygonCount(); p += 5) dear.push_back(PolygonId{p});
    PolygonStates states;
    ASSERT_TRUE(setCost(graph, dear, 2.0f, states));
    for (std::uint32_t p = 0; p < graph.polygonCount(); ++p) {
      const std::uint32_t before = graph.chains.ofPolygon[p];
      if (states.cost[p] > 1.0f) {
        EXPECT_EQ(states.chains.ofPolygon[p], kNoChain);
        cut += before != kNoChain;
      } else if (before != kNoChain) {
        // The rest of a chain that they were in still is one: now it has ends.
        EXPECT_NE(states.chains.ofPolygon[p], kNoChain);
      }
    }
  }
  EXPECT_GT(cut, 100u);
}

}  // namespace
}  // namespace forewalk::navmesh
