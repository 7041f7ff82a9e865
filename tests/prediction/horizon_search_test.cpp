#include "prediction/horizon_search.h"

#include <gtest/gtest.h>

#include <limits>
#include <map>
#include <random>
#include <set>

#include "navmesh/funnel.h"
#include "navmesh/random.h"
#include "tests/support/random_mesh.h"
#include "tests/support/random_start.h"

namespace forewalk::prediction {
namespace {

using navmesh::index;
using navmesh::NavGraph;

NavGraph graphOf(const navmesh::PolygonMesh& mesh) {
  auto graph = navmesh::makeNavGraph(mesh);
  EXPECT_TRUE(graph) << graph.error().message;
  return *graph;
}

// What a search says of a polygon.
struct Settled {
  double key;
  std::uint32_t parent;  // polygon
  std::uint32_t portal;
  bool within;
};

// DESIGN.md section 3, step 2, polygon by polygon: no queue, no chains, no shared funnels. A step
// through a polygon counts as often as that costs; nobody enters what is closed.
std::map<std::uint32_t, Settled> plainSearch(const NavGraph& graph, const navmesh::Location& source,
                                             double horizon, HorizonSearch::Limit limit,
                                             const navmesh::PolygonStates& states = {}) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const std::uint32_t start = index(source.polygon);
  std::map<std::uint32_t, Settled> open{{start, {0.0, start, kNone, true}}};
  std::map<std::uint32_t, Settled> settled;
  while (!open.empty()) {
    auto next = open.end();
    double nearest = kInfinity;
    for (auto it = open.begin(); it != open.end(); ++it) {
      if (it->second.key < nearest) nearest = (next = it)->second.key;
    }
    const std::uint32_t polygon = next->first;
    Settled here = next->second;
    open.erase(next);
    if (polygon != start) {
      std::vector<navmesh::Portal> corridor{graph.portals[here.portal]};
      for (std::uint32_t at = here.parent; at != start; at = settled[at].parent) {
        corridor.insert(corridor.begin(), graph.portals[settled[at].portal]);
      }
      std::vector<glm::vec2> path;
      navmesh::pullString(source.plan, graph.centroid[polygon], corridor, path);
      const double length =
          limit == HorizonSearch::Limit::kTaut
              ? static_cast<double>(navmesh::lengthOf(path))
              : here.key + static_cast<double>(graph.portalToCentroid[here.portal]);
      here.within = length <= horizon;
    }
    settled[polygon] = here;
    if (!here.within) continue;
    const bool leaves = states.isClosed(PolygonId{polygon});
    const double cost = leaves ? 1.0 : static_cast<double>(states.costOf(PolygonId{polygon}));
    for (std::uint32_t h = graph.portalStart[polygon]; h < graph.portalStart[polygon + 1]; ++h) {
      const std::uint32_t to = index(graph.portalTo[h]);
      if (settled.contains(to) || states.isClosed(PolygonId{to})) continue;
      const glm::vec2 from = polygon == start ? source.plan : graph.portalMidpoint[here.portal];
      const double key =
          here.key + cost * static_cast<double>(glm::distance(from, graph.portalMidpoint[h]));
      const auto found = open.find(to);
      if (found == open.end() || key < found->second.key) open[to] = {key, polygon, h, true};
    }
  }
  return settled;
}

// Meshes with many loops, with long chains and dead ends, and tiles.
std::vector<navmesh::PolygonMesh> worlds(std::uint64_t seed) {
  testing::RandomMeshOptions mazy{.holeShare = 0.42, .splitShare = 0.6, .mergeShare = 0.2};
  testing::RandomMeshOptions open{.holeShare = 0.1};
  const auto a = testing::randomMesh(seed, 9, 9, mazy);
  const auto b = testing::randomMesh(seed + 1000, 6, 9, open);
  return {a, b, testing::joinedAlong(a, b),
          testing::corridorMesh(std::vector<float>{2.0f, 1.0f, 3.0f, 1.5f, 2.5f})};
}

TEST(HorizonSearch, SettlesWhatAPlainDepthLimitedDijkstraSettles) {
  std::size_t compared = 0;
  std::size_t inChains = 0;
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    for (const auto& mesh : worlds(seed)) {
      const NavGraph graph = graphOf(mesh);
      HorizonSearch search(graph, graph.polygonCount());
      std::vector<Corner> corners;
      corners.reserve(search.cornerCapacity());
      for (const auto& source : testing::randomStarts(graph, 4, seed)) {
        for (const auto limit : {HorizonSearch::Limit::kTaut, HorizonSearch::Limit::kKey}) {
          const float horizon = 1.5f + static_cast<float>(seed % 7);
          search.run(source, horizon, corners, limit);
          const auto plain = plainSearch(graph, source, static_cast<double>(horizon), limit);
          ASSERT_EQ(search.tree().size(), plain.size()) << "seed " << seed;
          for (const SearchNode& node : search.tree()) {
            const auto found = plain.find(index(node.polygon));
            ASSERT_NE(found, plain.end()) << "seed " << seed;
            const SearchNode& parent = search.tree()[node.parent];
            EXPECT_NEAR(node.key, found->second.key, 1e-4);
            EXPECT_EQ(index(parent.polygon), found->second.parent);
            EXPECT_EQ(node.portal, found->second.portal);
            EXPECT_EQ(node.within, found->second.within)
                << "seed " << seed << " polygon " << index(node.polygon);
            ++compared;
            inChains += graph.chains.ofPolygon[index(node.polygon)] != navmesh::kNoChain;
          }
        }
      }
    }
  }
  EXPECT_GT(compared, 20000u);
  EXPECT_GT(inChains, compared / 4);
}

TEST(HorizonSearch, SettlesWhatAPlainSearchSettlesWherePolygonsAreClosedOrCostMore) {
  std::size_t compared = 0, inChains = 0, dear = 0, onClosed = 0;
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    for (const auto& mesh : worlds(seed)) {
      const NavGraph graph = graphOf(mesh);
      HorizonSearch search(graph, graph.polygonCount());
      std::vector<Corner> corners;
      corners.reserve(search.cornerCapacity());
      std::mt19937_64 rng(seed);
      const double share = 0.05 * static_cast<double>(1 + seed % 4);
      std::map<float, std::vector<PolygonId>> byCost;
      for (std::uint32_t p = 0; p < graph.polygonCount(); ++p) {
        if (navmesh::uniform(rng) < share) byCost[navmesh::kClosed].push_back(PolygonId{p});
        if (navmesh::uniform(rng) < share) byCost[1.5f].push_back(PolygonId{p});
        if (navmesh::uniform(rng) < share) byCost[20.0f].push_back(PolygonId{p});
      }
      navmesh::PolygonStates states;
      for (const auto& [cost, polygons] : byCost) {
        ASSERT_TRUE(navmesh::setCost(graph, polygons, cost, states));
      }
      for (const auto& source : testing::randomStarts(graph, 6, seed)) {
        onClosed += states.isClosed(source.polygon);
        for (const auto limit : {HorizonSearch::Limit::kTaut, HorizonSearch::Limit::kKey}) {
          const float horizon = 2.5f + static_cast<float>(seed % 9);
          search.run(source, horizon, corners, limit, &states);
          const auto plain =
              plainSearch(graph, source, static_cast<double>(horizon), limit, states);
          ASSERT_EQ(search.tree().size(), plain.size()) << "seed " << seed;
          for (const SearchNode& node : search.tree()) {
            const auto found = plain.find(index(node.polygon));
            ASSERT_NE(found, plain.end()) << "seed " << seed;
            const Settled& theirs = found->second;
            EXPECT_NEAR(node.key, theirs.key, 1e-5 * (10.0 + theirs.key));
            EXPECT_EQ(index(search.tree()[node.parent].polygon), theirs.parent);
            EXPECT_EQ(node.portal, theirs.portal);
            EXPECT_EQ(node.within, theirs.within) << "seed " << seed << " " << index(node.polygon);
            ++compared;
            inChains += !states.allOpen() &&
                        states.chains.ofPolygon[index(node.polygon)] != navmesh::kNoChain;
            dear += states.costOf(node.polygon) > 1.0f;
          }
        }
      }
    }
  }
  EXPECT_GT(compared, 20000u);
  EXPECT_GT(inChains, compared / 8);
  EXPECT_GT(dear, compared / 20);
  EXPECT_GT(onClosed, 100u);
}

TEST(HorizonSearch, PutsParentsBeforeTheirChildrenAndTellsThemOfIt) {
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    for (const auto& mesh : worlds(seed)) {
      const NavGraph graph = graphOf(mesh);
      HorizonSearch search(graph, graph.polygonCount());
      std::vector<Corner> corners;
      corners.reserve(search.cornerCapacity());
      const auto source = testing::randomStarts(graph, 1, seed).front();
      search.run(source, 5.0f, corners);
      const auto tree = search.tree();
      std::set<std::uint32_t> withChild, cutChild;
      for (std::uint32_t i = 1; i < tree.size(); ++i) {
        ASSERT_LT(tree[i].parent, i);
        EXPECT_EQ(search.treeIndexOf(tree[i].polygon), i);
        (tree[i].within ? withChild : cutChild).insert(tree[i].parent);
      }
      for (std::uint32_t i = 0; i < tree.size(); ++i) {
        EXPECT_EQ(tree[i].hasWithinChild, withChild.contains(i));
        EXPECT_EQ(tree[i].hasCutChild, cutChild.contains(i));
      }
    }
  }
}

TEST(HorizonSearch, StopsAtThePolygonLimitWithAllThatIsNearerInTheTree) {
  std::size_t stopped = 0;
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    for (const auto& mesh : worlds(seed)) {
      const NavGraph graph = graphOf(mesh);
      HorizonSearch all(graph, graph.polygonCount());
      std::vector<Corner> corners;
      corners.reserve(all.cornerCapacity());
      const auto source = testing::randomStarts(graph, 1, seed).front();
      all.run(source, 6.0f, corners);
      for (const std::uint32_t limit : {1u, 2u, 5u, 12u, 30u}) {
        HorizonSearch few(graph, limit);
        std::vector<Corner> fewCorners;
        fewCorners.reserve(few.cornerCapacity());
        few.run(source, 6.0f, fewCorners);
        EXPECT_LE(few.tree().size(), limit);
        EXPECT_TRUE(limit < all.tree().size() || !few.limitReached());
        if (!few.limitReached()) continue;
        ++stopped;
        bool dropped = false;
        for (const SearchNode& node : few.tree()) dropped = dropped || node.dropped;
        EXPECT_TRUE(dropped);
        for (const SearchNode& node : all.tree()) {
          EXPECT_TRUE(node.key >= few.completeTo() || few.treeIndexOf(node.polygon) != kNone);
        }
      }
    }
  }
  EXPECT_GT(stopped, 300u);
}

}  // namespace
}  // namespace forewalk::prediction
