// Predictions through links: lifts, ladders, teleports.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <queue>
#include <random>
#include <set>
#include <tuple>
#include <vector>

#include "navmesh/funnel.h"
#include "navmesh/plan.h"
#include "navmesh/random.h"
#include "navmesh/world.h"
#include "prediction/predict.h"
#include "tests/support/count_allocations.h"
#include "tests/support/linked_world.h"
#include "tests/support/random_mesh.h"
#include "tests/support/random_start.h"
#include "tests/support/two_floors.h"

namespace forewalk::prediction {
namespace {

using navmesh::index;
using navmesh::kClosed;
using navmesh::Link;
using navmesh::LinkId;
using navmesh::Links;
using navmesh::LinkWay;
using navmesh::Location;
using navmesh::NavGraph;
using navmesh::PolygonMesh;
using navmesh::PolygonStates;
using testing::randomLinks;
using testing::statesOf;
using testing::TwoFloors;
using testing::worldOf;

PolygonMesh meshOf(std::uint64_t seed, int columns = 13, int rows = 11) {
  testing::RandomMeshOptions options;
  options.holeShare = 0.06 * static_cast<double>(seed % 6);
  options.mergeShare = 0.1 * static_cast<double>(seed % 9);
  options.splitShare = 0.15 * static_cast<double>(seed % 5);
  return testing::randomMesh(seed, columns, rows, options);
}

/// Length of an edge by its own path: walked, and by link.
float lengthByPath(const PredictionGraph& graph, const Edge& edge) {
  const auto path = graph.pathOf(edge);
  float length = 0.0f;
  const auto steps = graph.linkStepsOf(edge);
  std::size_t next = 0;
  for (std::size_t i = 0; i + 1 < path.size(); ++i) {
    if (next < steps.size() && steps[next].point == i) {
      length += steps[next++].length;
    } else {
      length += glm::distance(path[i], path[i + 1]);
    }
  }
  EXPECT_EQ(next, steps.size());
  return length;
}

/// What any graph with links must be.
void expectSound(const navmesh::World& world, const PredictionGraph& graph, const Links& links) {
  for (std::size_t i = 1; i < graph.nodes.size(); ++i) {
    const Node& node = graph.nodes[i];
    ASSERT_LE(node.distance, graph.horizon);
    if (node.reason == TerminalReason::kHorizon && graph.flags == kGraphComplete) {
      ASSERT_EQ(node.distance, graph.horizon);
    }
    ASSERT_GE(node.distance + 1e-3f,
              graph.node(node.prev).distance -
                  graph.treeEdge(NodeId{static_cast<std::uint32_t>(i)}).length);
    // The way to it, corner by corner, is as long as it says.
    float walked = node.distance;
    for (std::uint32_t at = node.corner; at != 0; at = graph.corners[at].previous) {
      ASSERT_LE(graph.corners[at].distance, walked + 1e-4f);
      walked = graph.corners[at].distance;
    }
    ASSERT_GE(walked, 0.0f);
  }
  std::vector<std::uint32_t> portals;
  std::vector<glm::vec3> lifted;
  std::uint32_t lastEdge = 0;
  for (const LinkStep& step : graph.linkSteps) {
    ASSERT_LE(lastEdge, step.edge);
    lastEdge = step.edge;
    const Edge& edge = graph.edges[step.edge];
    ASSERT_LT(step.point + 1, edge.pathCount);
    ASSERT_LT(step.polygons, edge.polygonCount);
    ASSERT_FALSE(edge.kind == EdgeKind::kTree && step.forward);
    // It runs along a way of that link.
    const auto path = graph.pathOf(edge);
    const glm::vec2 from = path[step.forward ? step.point : step.point + 1];
    const glm::vec2 to = path[step.forward ? step.point + 1 : step.point];
    const bool cut = step.polygons == 0;
    const bool known = std::any_of(links.ways.begin(), links.ways.end(), [&](const LinkWay& way) {
      if (way.link != step.link || way.entry != from) return false;
      return cut ? step.length <= way.length : way.exit == to && step.length == way.length;
    });
    ASSERT_TRUE(known) << "link " << index(step.link);
  }
  for (const Edge& edge : graph.edges) {
    ASSERT_NEAR(lengthByPath(graph, edge), edge.length, 1e-3f);
    // On the ground from end to end.
    liftEdge(world.graph, graph, edge, portals, lifted);
    ASSERT_GE(lifted.size(), edge.pathCount);
    const auto path = graph.pathOf(edge);
    ASSERT_EQ(navmesh::toPlan(lifted.front()), path.front());
    ASSERT_EQ(navmesh::toPlan(lifted.back()), path.back());
    ASSERT_NEAR(lifted.front().y, graph.node(edge.from).height, 1e-3f);
    ASSERT_NEAR(lifted.back().y, graph.node(edge.to).height, 1e-3f);
    const auto corridor = graph.corridorOf(edge);
    const auto steps = graph.linkStepsOf(edge);
    for (std::size_t i = 0; i + 1 < corridor.size(); ++i) {
      if (std::any_of(steps.begin(), steps.end(),
                      [&](const LinkStep& step) { return step.polygons == i + 1; })) {
        continue;
      }
      const auto begin = world.graph.portalTo.begin() + world.graph.portalStart[index(corridor[i])];
      const auto end =
          world.graph.portalTo.begin() + world.graph.portalStart[index(corridor[i]) + 1];
      ASSERT_NE(std::find(begin, end, corridor[i + 1]), end) << "neighbours but for links";
    }
  }
}

TwoFloors twoFloors(std::uint64_t seed, float apart) {
  return testing::twoFloors(meshOf(seed, 7, 6), meshOf(seed + 50, 7, 6), seed, apart);
}

using Seen = std::tuple<float, float, float, int, int, bool>;  // distance, place, kind, reason

std::vector<Seen> seenIn(const PredictionGraph& graph) {
  std::vector<Seen> seen;
  for (const Node& node : graph.nodes) {
    seen.emplace_back(node.distance, node.plan.x, node.plan.y, static_cast<int>(node.kind),
                      static_cast<int>(node.reason), node.branch);
  }
  std::sort(seen.begin(), seen.end());
  return seen;
}

TEST(PredictLinks, OfALengthAreACorridorOfThatLength) {
  int crossed = 0, cutInside = 0, otherLengths = 0;
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    const TwoFloors floors = twoFloors(seed, 0.5f + 0.3f * static_cast<float>(seed % 10));
    const PolygonStates states = statesOf(floors.linked, floors.links);
    ASSERT_EQ(states.links.ways.size(), 2u);
    Scratch linked(floors.linked.graph), corridor(floors.corridor.graph);
    for (const Location& start : testing::randomStarts(floors.linked.graph, 6, seed)) {
      for (const float horizon : {3.0f, 6.0f, 9.0f, 12.0f, 16.0f, 40.0f}) {
        SCOPED_TRACE(::testing::Message() << "seed " << seed << " horizon " << horizon);
        const PredictionGraph& found =
            predict(floors.linked.graph, start, horizon, linked, &states);
        expectSound(floors.linked, found, states.links);
        const PredictionGraph& expected = predict(floors.corridor.graph, start, horizon, corridor);
        const auto a = seenIn(found), b = seenIn(expected);
        ASSERT_EQ(a.size(), b.size());
        for (std::size_t i = 0; i < a.size(); ++i) {
          ASSERT_NEAR(std::get<0>(a[i]), std::get<0>(b[i]), 1e-3f);
        }
        // Sums of all there is: places may swap where distances tie.
        double sumA = 0.0, sumB = 0.0, lengthA = 0.0, lengthB = 0.0;
        for (const auto& [d, x, y, kind, reason, branch] : a) {
          sumA += static_cast<double>(x + 2.0f * y) + kind + 3 * reason + 11 * branch;
        }
        for (const auto& [d, x, y, kind, reason, branch] : b) {
          sumB += static_cast<double>(x + 2.0f * y) + kind + 3 * reason + 11 * branch;
        }
        ASSERT_NEAR(sumA, sumB, 1e-2);
        for (const Edge& edge : found.edges) lengthA += static_cast<double>(edge.length);
        for (const Edge& edge : expected.edges) lengthB += static_cast<double>(edge.length);
        // An edge to a terminal may run through another polygon of two that hold it.
        otherLengths += std::abs(lengthA - lengthB) > 1e-2 ? 1 : 0;
        crossed += found.linkSteps.empty() ? 0 : 1;
        for (const LinkStep& step : found.linkSteps) {
          if (step.polygons != 0) continue;
          ++cutInside;
          const Node& node = found.node(found.edges[step.edge].from);
          EXPECT_EQ(node.reason, TerminalReason::kHorizon);
          EXPECT_EQ(node.distance, horizon);
        }
        if (HasFatalFailure()) return;
      }
    }
  }
  EXPECT_GT(crossed, 200);
  EXPECT_GT(cutInside, 20);
  EXPECT_LE(otherLengths, crossed / 100);
}

/// Keys of all polygons that a depth-limited search settles, without chains or a clever queue.
std::map<std::uint32_t, float> plainSearch(const NavGraph& graph, const PolygonStates& states,
                                           const Location& start, float horizon) {
  struct Label {
    float key;
    std::uint32_t polygon;
    glm::vec2 entered;
    bool operator<(const Label& other) const {
      return std::tie(key, polygon) > std::tie(other.key, other.polygon);
    }
  };
  std::priority_queue<Label> queue;
  std::map<std::uint32_t, float> settled;
  queue.push({0.0f, index(start.polygon), start.plan});
  while (!queue.empty()) {
    const Label at = queue.top();
    queue.pop();
    if (!settled.emplace(at.polygon, at.key).second) continue;
    if (at.key + glm::distance(at.entered, graph.centroid[at.polygon]) > horizon &&
        settled.size() > 1) {
      continue;
    }
    for (std::uint32_t h = graph.portalStart[at.polygon]; h < graph.portalStart[at.polygon + 1];
         ++h) {
      const glm::vec2 middle = graph.portalMidpoint[h];
      queue.push({at.key + glm::distance(at.entered, middle), index(graph.portalTo[h]), middle});
    }
    for (const LinkWay& way : states.links.from(PolygonId{at.polygon})) {
      queue.push(
          {at.key + glm::distance(at.entered, way.entry) + way.length, index(way.to), way.exit});
    }
  }
  return settled;
}

TEST(PredictLinks, AreSearchedAsThePlainSearchDoes) {
  std::size_t settled = 0, byLink = 0;
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    const navmesh::World world = worldOf(meshOf(seed));
    const int count = 1 + static_cast<int>(seed % 12);
    const PolygonStates states = statesOf(world, randomLinks(world, count, seed, 3.0f));
    HorizonSearch search(world.graph, 100000);
    std::vector<Corner> corners;
    for (const Location& start : testing::randomStarts(world.graph, 6, seed)) {
      for (const float horizon : {2.0f, 5.0f, 11.0f}) {
        search.run(start, horizon, corners, HorizonSearch::Limit::kKey, &states);
        const auto plain = plainSearch(world.graph, states, start, horizon);
        ASSERT_EQ(search.tree().size(), plain.size()) << "seed " << seed << " " << horizon;
        for (const SearchNode& node : search.tree()) {
          const auto found = plain.find(index(node.polygon));
          ASSERT_NE(found, plain.end());
          ASSERT_NEAR(node.key, found->second, 1e-4f);
          byLink += isLink(node.portal) ? 1 : 0;
        }
        settled += plain.size();
      }
    }
  }
  EXPECT_GT(settled, 20000u);
  EXPECT_GT(byLink, 500u);
}

TEST(PredictLinks, GiveSoundGraphsWhereverTheyLead) {
  std::size_t steps = 0, loops = 0, cuts = 0;
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    const PolygonMesh floor = meshOf(seed);
    const navmesh::World world =
        worldOf(testing::together(floor, meshOf(seed + 9), {2.3f, 3.0f, 1.1f}));
    PolygonStates states = statesOf(world, randomLinks(world, 12, seed, 4.0f));
    if (seed % 3 == 0) {
      std::vector<PolygonId> shut, dear;
      for (std::uint32_t p = 0; p < world.graph.polygonCount(); p += 9)
        shut.push_back(PolygonId{p});
      for (std::uint32_t p = 4; p < world.graph.polygonCount(); p += 7)
        dear.push_back(PolygonId{p});
      ASSERT_TRUE(navmesh::setCost(world.graph, dear, 2.5f, states));
      ASSERT_TRUE(navmesh::setCost(world.graph, shut, kClosed, states));
    }
    Scratch scratch(world.graph), few(world.graph, {.polygons = 12});
    for (const Location& start : testing::randomStarts(world.graph, 8, seed)) {
      for (const float horizon : {0.0f, 1.7f, 4.0f, 9.0f, 25.0f}) {
        SCOPED_TRACE(::testing::Message() << "seed " << seed << " horizon " << horizon);
        const PredictionGraph& graph = predict(world.graph, start, horizon, scratch, &states);
        expectSound(world, graph, states.links);
        if (HasFatalFailure()) return;
        for (const LinkStep& step : graph.linkSteps) {
          ++steps;
          loops += graph.edges[step.edge].kind == EdgeKind::kLoop;
          cuts += step.polygons == 0;
        }
        expectSound(world, predict(world.graph, start, horizon, few, &states), states.links);
        if (HasFatalFailure()) return;
        std::set<std::pair<std::uint32_t, std::uint32_t>> pairs;
        for (const Edge& edge : graph.edges) {
          EXPECT_TRUE(pairs.insert({index(edge.from), index(edge.to)}).second);
          EXPECT_TRUE(edge.kind == EdgeKind::kTree || index(edge.from) > index(edge.to));
        }
      }
    }
  }
  EXPECT_GT(steps, 5000u);
  EXPECT_GT(loops, 200u);
  EXPECT_GT(cuts, 100u);
}

TEST(PredictLinks, OneWayAreNotGoneBack) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    TwoFloors floors = twoFloors(seed, 2.0f);
    floors.links[0].bothWays = false;
    const navmesh::World& world = floors.linked;
    const PolygonStates states = statesOf(world, floors.links);
    const Links& links = states.links;
    const std::uint32_t there = world.graph.component[index(links.ways[0].to)];
    Scratch scratch(world.graph);
    const auto reached = [&](const Location& start) {
      const PredictionGraph& graph = predict(world.graph, start, 100.0f, scratch, &states);
      return std::any_of(graph.nodes.begin(), graph.nodes.end(), [&](const Node& node) {
        return world.graph.component[index(node.polygon)] == there;
      });
    };
    const auto at = [&](PolygonId polygon) {
      return Location{polygon, world.graph.centroid[index(polygon)], 0.0f, false};
    };
    EXPECT_TRUE(reached(at(links.ways[0].from)));
    const Location end = at(links.ways[0].to);
    const PredictionGraph& back = predict(world.graph, end, 100.0f, scratch, &states);
    for (const Node& node : back.nodes) {
      EXPECT_EQ(world.graph.component[index(node.polygon)], there);
    }
    EXPECT_TRUE(back.linkSteps.empty());
  }
}

TEST(PredictLinks, ClosedAreNotThere) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    const navmesh::World world = worldOf(meshOf(seed));
    std::vector<Link> links = randomLinks(world, 6, seed, 2.0f);
    for (Link& link : links) link.open = false;
    const PolygonStates none = statesOf(world, links);
    EXPECT_TRUE(none.allOpen());
    links[2].open = true;
    const PolygonStates one = statesOf(world, {links[2]}), others = statesOf(world, links);
    EXPECT_EQ(one, others);
    // Nor is one whose exit is closed.
    PolygonStates shut = one;
    if (one.links.empty()) continue;
    for (const LinkWay& way : one.links.ways) {
      ASSERT_TRUE(navmesh::setCost(world.graph, std::vector{way.to}, kClosed, shut));
    }
    PolygonStates without = shut;
    navmesh::setLinks(world.graph, {}, without);
    Scratch scratch(world.graph), other(world.graph);
    for (const Location& start : testing::randomStarts(world.graph, 10, seed)) {
      if (shut.isClosed(start.polygon)) continue;
      const PredictionGraph& graph = predict(world.graph, start, 9.0f, scratch, &shut);
      EXPECT_TRUE(graph.linkSteps.empty());
      EXPECT_EQ(hashOf(graph), hashOf(predict(world.graph, start, 9.0f, other, &without)));
      EXPECT_EQ(hashOf(predict(world.graph, start, 9.0f, scratch, &none)),
                hashOf(predict(world.graph, start, 9.0f, other)));
    }
  }
}

TEST(PredictLinks, GiveTheSameGraphInWhateverOrderTheyCome) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    const navmesh::World world = worldOf(meshOf(seed));
    std::vector<Link> links = randomLinks(world, 10, seed, 3.0f);
    const PolygonStates states = statesOf(world, links);
    std::reverse(links.begin(), links.end());
    std::rotate(links.begin(), links.begin() + 3, links.end());
    const PolygonStates permuted = statesOf(world, links);
    EXPECT_EQ(states, permuted);
    Scratch scratch(world.graph), other(world.graph);
    for (const Location& start : testing::randomStarts(world.graph, 10, seed)) {
      EXPECT_EQ(hashOf(predict(world.graph, start, 12.0f, scratch, &states)),
                hashOf(predict(world.graph, start, 12.0f, other, &permuted)));
    }
  }
}

/// Two squares, a storey apart, one above the other, and a lift between their middles.
TEST(PredictLinks, TakePeopleToAnotherStorey) {
  const PolygonMesh square = testing::gridMesh(1, 1, 4.0f);
  const navmesh::World world = worldOf(testing::together(square, square, {0.0f, 3.0f, 0.0f}));
  const glm::vec3 below{2.0f, 0.0f, -3.0f}, above{2.0f, 3.0f, -3.0f};
  const PolygonStates states = statesOf(world, {{LinkId{4}, below, above, 6.0f, true, true}});
  Scratch scratch(world.graph);
  const Location start{PolygonId{0}, {2.0f, 1.0f}, 0.0f, false};
  const PredictionGraph& whole = predict(world.graph, start, 20.0f, scratch, &states);
  ASSERT_EQ(whole.nodes.size(), 2u);
  EXPECT_EQ(whole.nodes[1].reason, TerminalReason::kDeadEnd);
  EXPECT_EQ(whole.nodes[1].position(), glm::vec3(2.0f, 3.0f, -2.0f));
  EXPECT_FLOAT_EQ(whole.nodes[1].distance, 2.0f + 6.0f + 1.0f);
  std::vector<glm::vec3> way;
  wayTo(whole, NodeId{1}, way);
  EXPECT_EQ(way, (std::vector<glm::vec3>{{2, 0, -1}, below, above, {2, 3, -2}}));
  EXPECT_EQ(pointAlong(whole, NodeId{1}, 5.0f).height, 1.5f) << "half-way up";
  EXPECT_EQ(pointAlong(whole, NodeId{1}, 5.0f).direction, glm::vec2(0.0f, -1.0f));
  EXPECT_EQ(pointAlong(whole, NodeId{1}, 8.5f).plan, glm::vec2(2.0f, 2.5f));
  std::vector<std::uint32_t> portals;
  std::vector<glm::vec3> lifted;
  liftEdge(world.graph, whole, whole.edges[0], portals, lifted);
  EXPECT_EQ(lifted, (std::vector<glm::vec3>{{2, 3, -2}, above, below, {2, 0, -1}}));

  // Cut on the way up, and before.
  const PredictionGraph& inside = predict(world.graph, start, 4.0f, scratch, &states);
  ASSERT_EQ(inside.nodes.size(), 2u);
  EXPECT_EQ(inside.nodes[1].reason, TerminalReason::kHorizon);
  EXPECT_EQ(inside.nodes[1].position(), glm::vec3(2.0f, 1.0f, -3.0f));
  EXPECT_EQ(inside.nodes[1].polygon, PolygonId{0});
  EXPECT_EQ(inside.nodes[1].distance, 4.0f);
  EXPECT_FLOAT_EQ(inside.edges[0].length, 4.0f);
  liftEdge(world.graph, inside, inside.edges[0], portals, lifted);
  EXPECT_EQ(lifted, (std::vector<glm::vec3>{{2, 1, -3}, below, {2, 0, -1}}));
  const PredictionGraph& before = predict(world.graph, start, 1.5f, scratch, &states);
  ASSERT_EQ(before.nodes.size(), 2u);
  EXPECT_EQ(before.nodes[1].position(), glm::vec3(2.0f, 0.0f, -2.5f));
  EXPECT_TRUE(before.linkSteps.empty());
}

TEST(PredictLinks, OfNoLengthJumpWhereTheyLead) {
  const PolygonMesh square = testing::gridMesh(1, 1, 4.0f);
  const navmesh::World world = worldOf(testing::together(square, square, {50.0f, 0.0f, 0.0f}));
  const PolygonStates states =
      statesOf(world, {{LinkId{4}, {2, 0, -3}, {52, 0, -3}, 0.0f, false, true}});
  Scratch scratch(world.graph);
  const Location start{PolygonId{0}, {2.0f, 1.0f}, 0.0f, false};
  const PredictionGraph& graph = predict(world.graph, start, 20.0f, scratch, &states);
  ASSERT_EQ(graph.nodes.size(), 2u);
  EXPECT_FLOAT_EQ(graph.nodes[1].distance, 3.0f);
  EXPECT_EQ(pointAlong(graph, NodeId{1}, 1.0f).plan, glm::vec2(2.0f, 2.0f));
  EXPECT_EQ(pointAlong(graph, NodeId{1}, 2.5f).plan, glm::vec2(52.0f, 2.5f));
}

TEST(PredictLinks, AllocateNothingAfterTheFirstGraphs) {
  const navmesh::World world = worldOf(meshOf(5));
  const PolygonStates states = statesOf(world, randomLinks(world, 15, 5, 2.0f));
  Scratch scratch(world.graph);
  const auto starts = testing::randomStarts(world.graph, 200, 5);
  for (const Location& start : starts) predict(world.graph, start, 15.0f, scratch, &states);
  testing::allocationsSince();
  for (const Location& start : starts) predict(world.graph, start, 15.0f, scratch, &states);
  EXPECT_EQ(testing::allocationsSince(), 0u);
}

}  // namespace
}  // namespace forewalk::prediction
