#include "navmesh/corridor.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <set>

#include "navmesh/funnel.h"
#include "navmesh/random.h"
#include "tests/support/count_allocations.h"
#include "tests/support/random_mesh.h"
#include "tests/support/random_start.h"

namespace forewalk::navmesh {
namespace {

using Row = std::vector<std::uint32_t>;

NavGraph graphOf(const PolygonMesh& mesh) { return *makeNavGraph(mesh); }

Location placeIn(const NavGraph& graph, std::uint32_t polygon) {
  return {PolygonId{polygon}, graph.centroid[polygon], graph.centroidHeight[polygon], false};
}

// The walk through the portals' midpoints.
double lengthThrough(const NavGraph& graph, const Location& from, const Location& to,
                     const Row& row) {
  glm::dvec2 at(from.plan);
  double length = 0.0;
  for (const std::uint32_t h : row) {
    length += glm::distance(at, glm::dvec2(graph.portalMidpoint[h]));
    at = graph.portalMidpoint[h];
  }
  return length + glm::distance(at, glm::dvec2(to.plan));
}

// What the walk costs.
double costThrough(const NavGraph& graph, const PolygonStates& states, const Location& from,
                   const Location& to, const Row& row) {
  glm::dvec2 at(from.plan);
  double total = 0.0;
  double cost = states.isClosed(from.polygon) ? 1.0 : double(states.costOf(from.polygon));
  for (const std::uint32_t h : row) {
    total += cost * glm::distance(at, glm::dvec2(graph.portalMidpoint[h]));
    at = graph.portalMidpoint[h];
    cost = double(states.costOf(graph.portalTo[h]));
  }
  return total + cost * glm::distance(at, glm::dvec2(to.plan));
}

// Bellman-Ford over half-portals, until nothing changes.
double shortestByBruteForce(const NavGraph& graph, const Location& from, const Location& to,
                            const PolygonStates& states = {}) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const auto costOf = [&](PolygonId polygon) { return double(states.costOf(polygon)); };
  if (from.polygon == to.polygon) return glm::distance(glm::dvec2(from.plan), glm::dvec2(to.plan));
  const auto midpoint = [&](std::uint32_t h) { return glm::dvec2(graph.portalMidpoint[h]); };
  std::vector<double> length(graph.portalCount(), kInfinity);
  for (std::uint32_t h = graph.portalStart[index(from.polygon)];
       h < graph.portalStart[index(from.polygon) + 1]; ++h) {
    const double cost = states.isClosed(from.polygon) ? 1.0 : costOf(from.polygon);
    if (states.isClosed(graph.portalTo[h])) continue;
    length[h] = cost * glm::distance(glm::dvec2(from.plan), midpoint(h));
  }
  for (bool changed = true; changed;) {
    changed = false;
    for (std::uint32_t h = 0; h < graph.portalCount(); ++h) {
      if (length[h] == kInfinity) continue;
      const std::uint32_t over = index(graph.portalTo[h]);
      for (std::uint32_t next = graph.portalStart[over]; next < graph.portalStart[over + 1];
           ++next) {
        if (states.isClosed(graph.portalTo[next])) continue;
        const double through =
            length[h] + costOf(graph.portalTo[h]) * glm::distance(midpoint(h), midpoint(next));
        if (through < length[next]) {
          length[next] = through;
          changed = true;
        }
      }
    }
  }
  double best = kInfinity;
  for (std::uint32_t h = 0; h < graph.portalCount(); ++h) {
    if (graph.portalTo[h] == to.polygon) {
      if (length[h] == kInfinity) continue;
      const double rest = costOf(to.polygon) * glm::distance(midpoint(h), glm::dvec2(to.plan));
      best = std::min(best, length[h] + rest);
    }
  }
  return best;
}

TEST(FindCorridor, FindsNoWayFromOrToNowhere) {
  const NavGraph graph = graphOf(testing::gridMesh(2, 2));
  CorridorScratch scratch;
  Row row{7};
  EXPECT_FALSE(findCorridor(graph, Location{}, placeIn(graph, 0), scratch, row));
  EXPECT_TRUE(row.empty());
  EXPECT_FALSE(findCorridor(graph, placeIn(graph, 0), Location{PolygonId{4}}, scratch, row));
  EXPECT_FALSE(findCorridor(NavGraph{}, Location{}, Location{}, scratch, row));
}

TEST(FindCorridor, NeedsNoPortalWithinAPolygon) {
  const NavGraph graph = graphOf(testing::gridMesh(2, 2));
  CorridorScratch scratch;
  Row row{7};
  EXPECT_TRUE(findCorridor(graph, placeIn(graph, 3), placeIn(graph, 3), scratch, row));
  EXPECT_TRUE(row.empty());
}

TEST(FindCorridor, FindsNoWayBetweenComponents) {
  const NavGraph graph = graphOf(testing::repeated(testing::gridMesh(2, 2), 2, 1));
  CorridorScratch scratch;
  Row row{7};
  EXPECT_FALSE(findCorridor(graph, placeIn(graph, 0), placeIn(graph, 4), scratch, row));
  EXPECT_TRUE(row.empty());
}

TEST(FindCorridor, WalksStraightDownACorridor) {
  const NavGraph graph = graphOf(testing::corridorMesh(std::vector<float>(20, 1.0f)));
  CorridorScratch scratch;
  Row row;
  ASSERT_TRUE(findCorridor(graph, placeIn(graph, 2), placeIn(graph, 17), scratch, row));
  ASSERT_EQ(row.size(), 15u);
  for (std::uint32_t i = 0; i < row.size(); ++i)
    EXPECT_EQ(graph.portalTo[row[i]], PolygonId{3 + i});
}

TEST(FindCorridor, TakesTheShortestWalkThroughMidpoints) {
  // One scratch for all of them, larger and smaller in turn.
  CorridorScratch scratch;
  Row row;
  for (std::uint64_t seed = 0; seed < 12; ++seed) {
    const int size = seed % 2 == 0 ? 9 : 6;
    const NavGraph graph = graphOf(testing::joinedAlong(testing::randomMesh(seed, size, size),
                                                        testing::randomMesh(seed + 9, size, size)));
    const std::vector<Location> places = testing::randomStarts(graph, 30, seed);
    for (std::size_t i = 0; i + 1 < places.size(); ++i) {
      const Location& from = places[i];
      const Location& to = places[i + 1];
      const double shortest = shortestByBruteForce(graph, from, to);
      const bool found = findCorridor(graph, from, to, scratch, row);
      ASSERT_EQ(found, std::isfinite(shortest));
      if (!found) continue;
      EXPECT_NEAR(lengthThrough(graph, from, to, row), shortest, 1e-4);
      PolygonId at = from.polygon;
      std::set<PolygonId> visited{at};
      for (const std::uint32_t h : row) {
        ASSERT_GE(h, graph.portalStart[index(at)]);
        ASSERT_LT(h, graph.portalStart[index(at) + 1]);
        at = graph.portalTo[h];
        EXPECT_TRUE(visited.insert(at).second) << "polygon " << index(at) << " twice";
      }
      EXPECT_EQ(at, to.polygon);
    }
  }
}

TEST(FindCorridor, IsAsLongBackwards) {
  CorridorScratch scratch;
  Row there, back;
  const NavGraph graph = graphOf(testing::randomMesh(5, 14, 14));
  const std::vector<Location> places = testing::randomStarts(graph, 100, 5);
  for (std::size_t i = 0; i + 1 < places.size(); ++i) {
    const Location& a = places[i];
    const Location& b = places[i + 1];
    ASSERT_EQ(findCorridor(graph, a, b, scratch, there), findCorridor(graph, b, a, scratch, back));
    EXPECT_NEAR(lengthThrough(graph, a, b, there), lengthThrough(graph, b, a, back), 1e-4);
  }
}

TEST(FindCorridor, IsTheSameWhateverTheScratchHasSeen) {
  const NavGraph graph = graphOf(testing::gridMesh(12, 12));  // many equal ways
  const std::vector<Location> places = testing::randomStarts(graph, 40, 1);
  CorridorScratch used;
  Row row, fresh;
  for (std::size_t i = 0; i + 1 < places.size(); ++i) {
    CorridorScratch scratch;
    ASSERT_TRUE(findCorridor(graph, places[i], places[i + 1], used, row));
    ASSERT_TRUE(findCorridor(graph, places[i], places[i + 1], scratch, fresh));
    EXPECT_EQ(row, fresh);
  }
}

TEST(FindCorridor, TakesTheCheapestWalkAndEntersNothingClosed) {
  CorridorScratch scratch;
  Row row;
  int found = 0, shut = 0, dearer = 0;
  for (std::uint64_t seed = 0; seed < 16; ++seed) {
    const NavGraph graph = graphOf(testing::randomMesh(seed, 9, 9));
    std::mt19937_64 rng(seed);
    PolygonStates states;
    states.cost.resize(graph.polygonCount());
    for (float& cost : states.cost) {
      const int kind = uniformInt(rng, 6);
      cost = kind == 0 ? kClosed : kind < 3 ? 1.0f + 9.0f * float(uniform(rng)) : 1.0f;
    }
    const std::vector<Location> places = testing::randomStarts(graph, 40, seed);
    for (std::size_t i = 0; i + 1 < places.size(); ++i) {
      const Location &from = places[i], &to = places[i + 1];
      const double cheapest = shortestByBruteForce(graph, from, to, states);
      const bool way = findCorridor(graph, from, to, scratch, row, &states);
      ASSERT_EQ(way, std::isfinite(cheapest)) << "seed " << seed << " walk " << i;
      if (!way) {
        ++shut;
        continue;
      }
      ++found;
      for (const std::uint32_t h : row) EXPECT_FALSE(states.isClosed(graph.portalTo[h]));
      if (from.polygon == to.polygon) continue;
      EXPECT_NEAR(costThrough(graph, states, from, to, row), cheapest, 1e-3);
      dearer += cheapest > shortestByBruteForce(graph, from, to) + 0.1;
    }
  }
  EXPECT_GT(found, 100);
  EXPECT_GT(shut, 50);
  EXPECT_GT(dearer, 50);
}

TEST(FindCorridor, IsTheSameWithStatesInWhichAllIsOpen) {
  const NavGraph graph = graphOf(testing::randomMesh(5, 14, 14));
  const std::vector<Location> places = testing::randomStarts(graph, 60, 5);
  PolygonStates none, ones;
  ones.cost.assign(graph.polygonCount(), 1.0f);
  CorridorScratch scratch;
  Row row, open, one;
  for (std::size_t i = 0; i + 1 < places.size(); ++i) {
    findCorridor(graph, places[i], places[i + 1], scratch, row);
    findCorridor(graph, places[i], places[i + 1], scratch, open, &none);
    findCorridor(graph, places[i], places[i + 1], scratch, one, &ones);
    EXPECT_EQ(row, open);
    EXPECT_EQ(row, one);
  }
}

// The walker's whole question: where am I, which way is it, and what is the taut path.
TEST(FindCorridor, AllocatesNothingOnceWarm) {
  const NavGraph graph = graphOf(testing::randomMesh(8, 20, 20));
  const LocationIndex index = makeLocationIndex(graph);
  const std::vector<Location> places = testing::randomStarts(graph, 200, 8);
  CorridorScratch scratch;
  Row row;
  std::vector<glm::vec2> path;
  std::size_t found = 0;
  const auto walkAll = [&] {
    for (std::size_t i = 0; i + 1 < places.size(); ++i) {
      const auto from = locate(graph, index, places[i].position());
      const auto to = locateFrom(graph, index, places[i], places[i + 1].position());
      if (!findCorridor(graph, *from, *to, scratch, row)) continue;
      pullString(graph, from->plan, to->plan, row, path);
      found += path.size() > 2 ? 1 : 0;
    }
  };
  walkAll();
  testing::allocationsSince();
  walkAll();
  EXPECT_EQ(testing::allocationsSince(), 0u);
  EXPECT_GT(found, 100u);
}

}  // namespace
}  // namespace forewalk::navmesh
