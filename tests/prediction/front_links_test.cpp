// Graphs by fronts through links: lifts, ladders, teleports.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <random>
#include <set>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

#include "navmesh/plan.h"
#include "navmesh/random.h"
#include "navmesh/world.h"
#include "prediction/front_graph.h"
#include "prediction/likelihood.h"
#include "tests/support/count_allocations.h"
#include "tests/support/counted_ways.h"
#include "tests/support/linked_fronts.h"
#include "tests/support/linked_world.h"
#include "tests/support/map_mesh.h"
#include "tests/support/random_mesh.h"
#include "tests/support/random_start.h"
#include "tests/support/visibility.h"

namespace forewalk::prediction {
namespace {

using navmesh::Link;
using navmesh::LinkId;
using navmesh::Links;
using navmesh::LinkWay;
using navmesh::Location;
using navmesh::NavGraph;
using navmesh::PolygonMesh;
using navmesh::PolygonStates;
using testing::Cutting;
using testing::expectSame;
using testing::Linked;
using testing::meshOf;
using testing::randomLinks;
using testing::seenIn;
using testing::statesOf;
using testing::Ways;
using testing::waysOf;
using testing::worldOf;

// --- Distances ---

/// Shortest lengths from `source` to `places`, by every order in which links may be used: a plain
/// search over their ends, with exact walks between.
std::vector<float> shortestByLinks(const testing::VisibilityGraph& walks, const Links& links,
                                   const testing::PlanPlace& source,
                                   const std::vector<testing::PlanPlace>& places) {
  std::vector<testing::PlanPlace> entries;
  for (const LinkWay& way : links.ways) entries.push_back({way.from, way.entry});
  std::vector<float> atEntry = walks.shortest(source, entries);
  std::vector<std::vector<float>> between;
  for (const LinkWay& way : links.ways) {
    between.push_back(walks.shortest({way.to, way.exit}, entries));
  }
  for (std::size_t round = 0; round < links.ways.size(); ++round) {
    for (std::size_t i = 0; i < links.ways.size(); ++i) {
      for (std::size_t j = 0; j < links.ways.size(); ++j) {
        atEntry[j] = std::min(atEntry[j], atEntry[i] + links.ways[i].length + between[i][j]);
      }
    }
  }
  std::vector<float> lengths = walks.shortest(source, places);
  for (std::size_t i = 0; i < links.ways.size(); ++i) {
    const auto beyond = walks.shortest({links.ways[i].to, links.ways[i].exit}, places);
    for (std::size_t k = 0; k < places.size(); ++k) {
      lengths[k] = std::min(lengths[k], atEntry[i] + links.ways[i].length + beyond[k]);
    }
  }
  return lengths;
}

TEST(FrontLinks, ShortenDistancesAsEveryWayOfUsingThemDoes) {
  std::size_t compared = 0, shorter = 0;
  for (std::uint64_t seed = 1; seed <= 14; ++seed) {
    Linked linked(meshOf(seed));
    const NavGraph& graph = linked.world.graph;
    linked.set(randomLinks(linked.world, 1 + static_cast<int>(seed % 7), seed, 3.0f));
    const testing::VisibilityGraph walks(graph);
    std::vector<testing::PlanPlace> places;
    for (const Location& place : testing::randomStarts(graph, 40, seed + 7)) {
      places.push_back({place.polygon, place.plan});
    }
    DistanceField walked(graph, linked.index.ends);
    for (const Location& source : testing::randomStarts(graph, 3, seed)) {
      const float horizon = 4.0f + static_cast<float>(seed % 3);
      linked.from(source, horizon);
      walked.run(source, horizon);
      const auto expected =
          shortestByLinks(walks, linked.states.links, {source.polygon, source.plan}, places);
      for (std::size_t k = 0; k < places.size(); ++k) {
        const float found = linked.distances().distanceAt(places[k].polygon, places[k].plan);
        if (expected[k] < horizon - 1e-3f) {
          ASSERT_NEAR(found, expected[k], 2e-4f) << "seed " << seed;
          ++compared;
          shorter += walked.distanceAt(places[k].polygon, places[k].plan) > found + 0.01f ? 1 : 0;
        } else {
          ASSERT_GE(found, horizon - 2e-3f);
        }
      }
    }
  }
  EXPECT_GT(compared, 700u);
  EXPECT_GT(shorter, 100u);
}

// --- Ways ---

/// From an entry a link leads to what is seen from its exit, with the horizon as much shorter as
/// the link is long: in another room nothing else comes there.
TEST(FrontLinks, ShowTheRoomBeyondAsFromTheirExit) {
  std::size_t nodes = 0;
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    const PolygonMesh here = meshOf(seed), there = meshOf(seed + 50);
    const float length = 0.4f * static_cast<float>(seed % 7);
    Linked linked(testing::together(here, there, {3.0f, 4.0f, 1.0f}));
    Linked alone(here), beyond(there);
    const auto places = testing::randomStarts(alone.world.graph, 4, seed);
    const auto exits = testing::randomStarts(beyond.world.graph, 4, seed + 1);
    const auto herePolygons = alone.world.graph.polygonCount();
    for (std::size_t i = 0; i < places.size(); ++i) {
      for (const bool back : {false, true}) {
        SCOPED_TRACE(::testing::Message() << "seed " << seed << " place " << i << " back " << back);
        const glm::vec3 entry = places[i].position();
        const glm::vec3 exit = exits[i].position() + glm::vec3(3.0f, 4.0f, 1.0f);
        // The way back of one that leads from there to here is as good, and a way back is none.
        linked.set({Link{LinkId{5}, back ? exit : entry, back ? entry : exit, length, back, true}});
        const Location source = linked.at(entry);
        for (const float horizon : {3.0f, 6.0f}) {
          for (const float persistence : {0.0f, 0.75f}) {
            auto found = seenIn(linked.from(source, horizon, persistence));
            auto expected = seenIn(alone.from(alone.at(entry), horizon, persistence));
            auto theirs = seenIn(
                beyond.from(beyond.at(exits[i].position()), horizon - length, persistence), length);
            nodes += theirs.size();
            for (auto& [d, x, y, kind, reason, branch] : theirs) {
              x += 3.0f;
              y -= 1.0f;
            }
            expected.insert(expected.end(), theirs.begin(), theirs.end());
            std::sort(expected.begin(), expected.end());
            expectSame(found, expected);
            if (HasFatalFailure()) return;
          }
        }
      }
    }
    ASSERT_GT(herePolygons, 0u);
  }
  EXPECT_GT(nodes, 5000u);
}

/// What any graph by fronts with links must be.
void expectSound(Linked& linked, const PredictionGraph& graph) {
  const Links& links = linked.states.links;
  const auto known = [&](LinkId id, auto fits) {
    return std::any_of(links.ways.begin(), links.ways.end(),
                       [&](const LinkWay& way) { return way.link == id && fits(way); });
  };
  for (const Node& node : graph.nodes) {
    ASSERT_LE(node.distance, graph.horizon);
    // Each corner is as much farther than the one before as one walks, or as the link between.
    float walked = node.distance;
    glm::vec2 at = node.plan;
    for (std::uint32_t c = node.corner;; c = graph.corners[c].previous) {
      const Corner& corner = graph.corners[c];
      const float leg = walked - corner.distance;
      const bool floor = std::abs(glm::distance(at, corner.plan) - leg) < 5e-3f;
      const bool link = std::any_of(links.ways.begin(), links.ways.end(), [&](const LinkWay& way) {
        return way.entry == corner.plan &&
               (way.exit == at ? std::abs(way.length - leg) < 1e-4f : leg <= way.length);
      });
      ASSERT_TRUE(floor || link) << "from " << corner.distance << " m to " << walked << " m";
      walked = corner.distance;
      at = corner.plan;
      if (c == 0) break;
    }
  }
  std::vector<std::uint32_t> portals;
  std::vector<glm::vec3> lifted;
  for (const Edge& edge : graph.edges) {
    ASSERT_NEAR(graph.node(edge.from).distance - graph.node(edge.to).distance, edge.length, 1e-3f);
    const auto path = graph.pathOf(edge);
    const auto steps = graph.linkStepsOf(edge);
    float length = 0.0f;
    std::size_t next = 0;
    for (std::size_t i = 0; i + 1 < path.size(); ++i) {
      if (next == steps.size() || steps[next].point != i) {
        length += glm::distance(path[i], path[i + 1]);
        continue;
      }
      const LinkStep& step = steps[next++];
      ASSERT_FALSE(step.forward);
      const bool cut = step.polygons == 0;
      ASSERT_TRUE(known(step.link, [&](const LinkWay& way) {
        if (way.entry != path[i + 1]) return false;
        return cut ? step.length <= way.length + 1e-4f
                   : way.exit == path[i] && std::abs(step.length - way.length) < 1e-4f;
      }));
      ASSERT_TRUE(!cut || i == 0);
      length += step.length;
    }
    ASSERT_EQ(next, steps.size());
    ASSERT_NEAR(length, edge.length, 1e-2f);
    liftEdge(linked.world.graph, graph, edge, portals, lifted);
    ASSERT_GE(lifted.size(), edge.pathCount);
    ASSERT_EQ(navmesh::toPlan(lifted.front()), path.front());
    ASSERT_EQ(navmesh::toPlan(lifted.back()), path.back());
    ASSERT_NEAR(lifted.front().y, graph.node(edge.from).height, 2e-2f);
  }
  for (std::uint32_t i = 1; i < graph.nodes.size(); ++i) ASSERT_LT(index(graph.nodes[i].prev), i);
  ASSERT_EQ(graph.fronts.size(), graph.terminals.size());
}

TEST(FrontLinks, GiveSoundGraphsWhereverTheyLead) {
  std::size_t steps = 0, cuts = 0, joins = 0, inARow = 0;
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    Linked linked(testing::together(meshOf(seed), meshOf(seed + 9), {2.3f, 3.0f, 1.1f}));
    linked.set(randomLinks(linked.world, 1 + static_cast<int>(seed % 9), seed, 4.0f));
    for (const Location& start : testing::randomStarts(linked.world.graph, 8, seed)) {
      for (const float horizon : {0.0f, 1.7f, 4.0f, 9.0f, 25.0f}) {
        for (const float persistence : {0.0f, 0.75f}) {
          SCOPED_TRACE(::testing::Message() << "seed " << seed << " horizon " << horizon);
          const PredictionGraph& graph = linked.from(start, horizon, persistence);
          expectSound(linked, graph);
          if (HasFatalFailure()) return;
          for (const LinkStep& step : graph.linkSteps) {
            ++steps;
            cuts += step.polygons == 0;
          }
          for (const NodeId terminal : graph.terminals) {
            std::size_t taken = 0;
            for (NodeId at = terminal; at != NodeId{0}; at = graph.node(at).prev) {
              taken += graph.linkStepsOf(graph.treeEdge(at)).size();
            }
            inARow += taken > 1;
          }
          for (const Node& node : graph.nodes) {
            joins += node.kind == NodeKind::kJoin;
            ASSERT_TRUE(node.reason == TerminalReason::kHorizon ? node.distance == horizon : true);
          }
        }
      }
    }
  }
  EXPECT_GT(steps, 2000u);
  EXPECT_GT(cuts, 100u);
  EXPECT_GT(joins, 500u);
  EXPECT_GT(inARow, 20u);
}

// --- What links change, and what they do not ---

TEST(FrontLinks, ThatAreLongerThanWalkingAreNotThere) {
  std::size_t compared = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    Linked linked(meshOf(seed)), plain(meshOf(seed));
    // Longer than any way on this floor; where none leads on foot, they do.
    std::vector<Link> links = randomLinks(linked.world, 8, seed, 1.0f);
    links.erase(
        std::remove_if(
            links.begin(), links.end(),
            [&](const Link& link) {
              const auto component = [&](glm::vec3 place) {
                return linked.world.graph.component[navmesh::index(linked.at(place).polygon)];
              };
              return component(link.entry) != component(link.exit);
            }),
        links.end());
    for (Link& link : links) link.length += 60.0f;
    linked.set(links);
    for (const Location& start : testing::randomStarts(linked.world.graph, 5, seed)) {
      const float horizon = 70.0f;
      EXPECT_EQ(hashOf(linked.from(start, horizon)), hashOf(plain.from(start, horizon)));
      compared += linked.states.links.ways.size();
    }
  }
  EXPECT_GT(compared, 200u);
}

TEST(FrontLinks, GiveTheSameGraphInWhateverOrderTheyCome) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    Linked linked(meshOf(seed)), permuted(meshOf(seed));
    std::vector<Link> links = randomLinks(linked.world, 10, seed, 3.0f);
    linked.set(links);
    std::reverse(links.begin(), links.end());
    std::rotate(links.begin(), links.begin() + 3, links.end());
    permuted.set(links);
    for (const Location& start : testing::randomStarts(linked.world.graph, 10, seed)) {
      EXPECT_EQ(hashOf(linked.from(start, 8.0f)), hashOf(permuted.from(start, 8.0f)));
    }
  }
}

TEST(FrontLinks, ToOrFromClosedGroundAreNotThere) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    Linked linked(meshOf(seed)), without(meshOf(seed));
    const std::vector<Link> links = randomLinks(linked.world, 6, seed, 2.0f);
    for (const bool entries : {false, true}) {
      PolygonStates states = statesOf(linked.world, links);
      for (const LinkWay& way : states.links.ways) {
        if (way.link == LinkId{0}) continue;  // one stays
        const PolygonId shut = entries ? way.from : way.to;
        ASSERT_TRUE(
            navmesh::setCost(linked.world.graph, std::vector{shut}, navmesh::kClosed, states));
      }
      PolygonStates expected = states;
      Links kept = statesOf(linked.world, {links[0]}).links;
      for (const LinkWay& way : kept.ways) {
        if (states.isClosed(way.from) || states.isClosed(way.to)) kept = {};
        if (kept.empty()) break;
      }
      navmesh::setLinks(linked.world.graph, kept, expected);
      linked.set(states);
      without.set(expected);
      EXPECT_EQ(linked.index.links, kept);
      for (const Location& start : testing::randomStarts(linked.world.graph, 10, seed)) {
        EXPECT_EQ(hashOf(linked.from(start, 8.0f)), hashOf(without.from(start, 8.0f)));
      }
    }
  }
}

TEST(FrontLinks, AllocateNothingAfterTheFirstFrames) {
  Linked linked(testing::randomMesh(2, 20, 20));
  linked.set(randomLinks(linked.world, 12, 5, 2.0f));
  const auto starts = testing::randomStarts(linked.world.graph, 150, 2);
  const auto frames = [&](std::size_t from, std::size_t to) {
    std::size_t steps = 0;
    for (const float horizon : {1.0f, 5.0f, 15.0f}) {
      for (std::size_t i = from; i < to; ++i) {
        steps += linked.from(starts[i], horizon).linkSteps.size();
      }
    }
    return steps;
  };
  frames(0, 30);
  testing::allocationsSince();
  const std::size_t steps = frames(30, starts.size());
  EXPECT_EQ(testing::allocationsSince(), 0u);
  EXPECT_GT(steps, 200u);
}

// --- Known answers ---

/// A floor whose ways are known by looking at it, and a link from `a` to `b`. `@` is the user.
struct KnownScene {
  const char* name;
  std::vector<std::string> rows;  // 0.5 m a character
  float length;                   // of the link
  float horizon;
  Ways ways;
};

std::vector<KnownScene> knownScenes() {
  const auto hall = [](std::size_t exit = 31) {
    std::vector<std::string> rows(32, std::string(44, '.'));
    rows[16][15] = '@';
    rows[16][21] = 'a';
    rows[16][exit] = 'b';
    return rows;
  };
  return {
      {"a lift at the end of a corridor",
       {"........................", "...........@...........a", "                        ",
        "....................b...", "........................"},
       1.0f,
       10.0f,
       {.horizon = 1, .deadEnds = 2, .branches = 2, .links = 1}},
      {"a lift beside a corridor",
       {"........................", "...........@...a........", "                        ",
        "........................", "b......................."},
       1.0f,
       8.0f,
       {.horizon = 1, .deadEnds = 2, .branches = 2, .links = 1}},
      {"a teleport along a corridor: the two fronts come together",
       {"..............................", "@.....a.................b....."},
       0.5f,
       20.0f,
       {.deadEnds = 1, .meetings = 2, .branches = 2, .links = 1}},
      {"a teleport across a hall, not yet come upon on foot",
       hall(),
       1.0f,
       5.5f,
       {.horizon = 2, .branches = 1, .links = 1}},
      {"a teleport across a hall, come upon on foot",
       hall(),
       1.0f,
       7.0f,
       {.horizon = 1, .branches = 1, .joins = 1, .links = 1}},
      {"a teleport that is slower than walking", hall(27), 3.5f, 7.0f, {.horizon = 1}},
      {"a teleport that takes longer than the horizon reaches",
       hall(),
       4.0f,
       6.0f,
       {.horizon = 2, .branches = 1, .links = 1}},
  };
}

TEST(FrontLinks, ShowTheWaysThatAPersonSeesHoweverTheFloorIsCut) {
  for (const KnownScene& scene : knownScenes()) {
    const std::vector<std::string_view> rows(scene.rows.begin(), scene.rows.end());
    // Not quite in the middle, so that no two walls are equally far.
    const auto at = [&](char mark) {
      return navmesh::toSpace(testing::markIn(rows, 0.5f, mark) + glm::vec2(0.03f, 0.017f), 0.0f);
    };
    for (const Cutting cutting : testing::kCuttings) {
      Linked linked(testing::mapMesh(rows, 0.5f, cutting));
      linked.set({Link{LinkId{1}, at('a'), at('b'), scene.length, true, true}});
      const PredictionGraph& graph = linked.from(linked.at(at('@')), scene.horizon);
      EXPECT_EQ(waysOf(graph), scene.ways)
          << scene.name << ", cutting " << static_cast<int>(cutting);
      expectSound(linked, graph);
    }
  }
}

TEST(FrontLinks, LeadAcrossAFloorOfOnePolygon) {
  const std::vector<float> hall{15.0f};
  Linked linked(testing::corridorMesh(hall));
  ASSERT_EQ(linked.world.graph.polygonCount(), 1u);
  linked.set({Link{LinkId{1}, {3.0f, 0.0f, -0.4f}, {12.0f, 0.0f, -0.4f}, 0.5f, false, true}});
  const PredictionGraph& graph = linked.from(linked.at({0.3f, 0.0f, -0.45f}), 20.0f);
  EXPECT_EQ(waysOf(graph),
            (Ways{.deadEnds = 1, .meetings = 2, .branches = 2, .joins = 0, .links = 1}));
  // They meet where both have come equally far.
  for (const Node& node : graph.nodes) {
    if (node.reason != TerminalReason::kMeeting) continue;
    EXPECT_NEAR(node.plan.x, 7.75f, 0.02f);
    EXPECT_NEAR(node.distance, 7.45f, 0.02f);
  }
}

/// Two squares, a storey apart, one above the other, and a lift between their middles.
TEST(FrontLinks, TakePeopleToAnotherStorey) {
  const PolygonMesh square = testing::gridMesh(1, 1, 4.0f);
  Linked linked(testing::together(square, square, {0.0f, 3.0f, 0.0f}));
  const glm::vec3 below{2.0f, 0.0f, -3.0f}, above{2.0f, 3.0f, -3.0f};
  linked.set({Link{LinkId{4}, below, above, 6.0f, true, true}});
  const Location start{PolygonId{0}, {2.0f, 1.0f}, 0.0f, false};
  // Cut on the way up: the lift is the only way to the horizon.
  const PredictionGraph& inside = linked.from(start, 6.0f);
  std::vector<NodeId> upward;
  for (const NodeId terminal : inside.terminals) {
    if (inside.node(terminal).reason == TerminalReason::kHorizon) upward.push_back(terminal);
  }
  ASSERT_EQ(upward.size(), 1u);
  EXPECT_EQ(inside.node(upward[0]).position(), glm::vec3(2.0f, 2.0f, -3.0f));
  EXPECT_EQ(inside.node(upward[0]).polygon, PolygonId{0});
  EXPECT_EQ(inside.node(upward[0]).distance, 6.0f);
  std::vector<glm::vec3> way;
  wayTo(inside, upward[0], way);
  EXPECT_EQ(way, (std::vector<glm::vec3>{{2, 0, -1}, below, {2, 2, -3}}));
  // Above.
  const PredictionGraph& graph = linked.from(start, 10.5f);
  const auto there = std::find_if(graph.terminals.begin(), graph.terminals.end(), [&](NodeId id) {
    return graph.node(id).polygon == PolygonId{1} &&
           graph.node(id).reason == TerminalReason::kHorizon;
  });
  ASSERT_NE(there, graph.terminals.end());
  EXPECT_EQ(graph.node(*there).height, 3.0f);
  wayTo(graph, *there, way);
  ASSERT_EQ(way.size(), 4u);
  EXPECT_EQ(way[1], below);
  EXPECT_EQ(way[2], above);
  EXPECT_EQ(pointAlong(graph, *there, 5.0f).height, 1.5f) << "half-way up";
  std::vector<std::uint32_t> portals;
  std::vector<glm::vec3> lifted;
  for (const Edge& edge : graph.edges) {
    if (graph.linkStepsOf(edge).empty()) continue;
    liftEdge(linked.world.graph, graph, edge, portals, lifted);
    ASSERT_GE(lifted.size(), 3u);
    EXPECT_EQ(lifted[lifted.size() - 2], above);
    EXPECT_EQ(lifted.back(), below);
  }
}

TEST(FrontLinks, FromOnePlaceToManyPartThere) {
  const PolygonMesh room = testing::gridMesh(3, 3, 2.0f);
  PolygonMesh house = room;
  std::vector<Link> links;
  for (std::uint32_t storey = 1; storey <= 3; ++storey) {
    const float up = 3.0f * static_cast<float>(storey);
    house = testing::together(house, room, {0.0f, up, 0.0f});
    links.push_back({LinkId{storey}, {5.0f, 0.0f, -3.1f}, {5.0f, up, -3.1f}, up, true, true});
  }
  Linked linked(house, links);
  const Location start = linked.at({0.5f, 0.0f, -3.0f});
  const PredictionGraph& graph = linked.from(start, 30.0f);
  // One place where all three leave; each storey is seen as from its landing.
  std::set<std::uint32_t> leaves;
  for (const LinkStep& step : graph.linkSteps) {
    leaves.insert(index(graph.edges[step.edge].to));
    EXPECT_FLOAT_EQ(step.length, 3.0f * static_cast<float>(navmesh::index(step.link)));
  }
  EXPECT_EQ(graph.linkSteps.size(), 3u);
  EXPECT_EQ(leaves.size(), 1u);
  expectSound(linked, graph);
}

// --- Names and likelihoods ---

TEST(FrontLinks, KeepTheNamesOfTheWaysBehindThem) {
  // Two corridors and a lift; on the way to it the ways beyond come nearer, and are the same after.
  const std::vector<std::string_view> rows{"........................", ".......@...............a",
                                           "                        ", "...........b............",
                                           "........................"};
  const auto at = [&](char mark) {
    return navmesh::toSpace(testing::markIn(rows, 0.5f, mark) + glm::vec2(0.03f, 0.017f), 0.0f);
  };
  Linked linked(testing::mapMesh(rows, 0.5f, Cutting::kSquares));
  linked.set({Link{LinkId{1}, at('a'), at('b'), 0.5f, true, true}});
  const auto isBehind = [](const PredictionGraph& graph, const TrackedWay& way) {
    return graph.node(way.terminal).plan.y < 1.2f;
  };
  const auto frame = [&](WayLikelihood& likelihood, glm::vec3 place) -> const PredictionGraph& {
    const PredictionGraph& graph = linked.from(linked.at(place), 12.0f);
    likelihood.update(graph, {0.1, {}, {}});
    double sum = likelihood.none();
    for (const double p : likelihood.probabilities()) {
      EXPECT_GE(p, 0.0);
      sum += p;
    }
    EXPECT_NEAR(sum, 1.0, 1e-9);
    return graph;
  };
  const auto namesBehind = [&](const WayLikelihood& likelihood, const PredictionGraph& graph) {
    std::vector<WayId> names;
    for (const TrackedWay& way : likelihood.ways()) {
      if (isBehind(graph, way)) names.push_back(way.id);
    }
    std::sort(names.begin(), names.end());
    return names;
  };
  const auto likelihoodBehind = [&](const WayLikelihood& likelihood, const PredictionGraph& graph) {
    double sum = 0.0;
    for (std::size_t w = 0; w < likelihood.ways().size(); ++w) {
      if (isBehind(graph, likelihood.ways()[w])) sum += likelihood.probabilities()[w];
    }
    return sum;
  };
  constexpr int kFrames = 80;  // of 0.1 s
  WayLikelihood likelihood;
  const glm::vec3 step = (at('a') - at('@')) / static_cast<float>(kFrames + 1);
  std::vector<WayId> behind;
  double halfway = 0.0;
  for (int i = 0; i <= kFrames; ++i) {
    const PredictionGraph& graph = frame(likelihood, at('@') + static_cast<float>(i) * step);
    if (i == 0) behind = namesBehind(likelihood, graph);
    ASSERT_EQ(namesBehind(likelihood, graph), behind) << i;
    if (i == kFrames / 2) halfway = likelihoodBehind(likelihood, graph);
  }
  EXPECT_EQ(behind.size(), 2u);
  EXPECT_EQ(namesBehind(likelihood, frame(likelihood, at('b'))), behind) << "out of the lift";

  WayLikelihood away;  // who goes the other way is not about to take it
  for (int i = kFrames; i > kFrames / 2; --i) {
    frame(away, at('@') + static_cast<float>(i) * step);
  }
  const PredictionGraph& graph = frame(away, at('@') + static_cast<float>(kFrames / 2) * step);
  EXPECT_LT(likelihoodBehind(away, graph) + 0.3, halfway);
}

}  // namespace
}  // namespace forewalk::prediction
