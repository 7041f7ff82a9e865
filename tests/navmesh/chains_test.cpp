#include "navmesh/chains.h"

#include <gtest/gtest.h>

#include "navmesh/nav_graph.h"
#include "tests/support/random_mesh.h"

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

}  // namespace
}  // namespace forewalk::navmesh
