// Links in graphs by fronts, beside what they are equal to: corridors, and nothing at all.
#include <gtest/gtest.h>

#include <algorithm>

#include "navmesh/plan.h"
#include "prediction/front_graph.h"
#include "tests/support/linked_fronts.h"
#include "tests/support/random_start.h"
#include "tests/support/two_floors.h"

namespace forewalk::prediction {
namespace {

using navmesh::Link;
using navmesh::LinkWay;
using navmesh::Location;
using testing::Linked;
using testing::meshOf;
using testing::missing;
using testing::seenIn;

TEST(FrontLinksLaws, ALinkIsACorridorOfItsLength) {
  std::size_t graphs = 0, otherwise = 0, compared = 0, crossed = 0, cutInside = 0;
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    const testing::TwoFloors floors =
        testing::twoFloors(meshOf(seed, 7, 6), meshOf(seed + 50, 7, 6), seed,
                           0.9f + 0.3f * static_cast<float>(seed % 10));
    const navmesh::PolygonStates states = testing::statesOf(floors.linked, floors.links);
    const FrontIndex link = makeFrontIndex(floors.linked.graph, &states);
    const FrontIndex corridor = makeFrontIndex(floors.corridor.graph);
    FrontScratch byLink(floors.linked.graph, link), onFoot(floors.corridor.graph, corridor);
    for (const Location& start : testing::randomStarts(floors.linked.graph, 6, seed)) {
      for (const float horizon : {3.0f, 6.0f, 9.0f, 16.0f}) {
        SCOPED_TRACE(::testing::Message() << "seed " << seed << " horizon " << horizon << " at "
                                          << start.plan.x << ", " << start.plan.y);
        const auto& found = predictFronts(floors.linked.graph, start, horizon, byLink);
        const auto& expected = predictFronts(floors.corridor.graph, start, horizon, onFoot);
        // What is too short to be a way leaves its piece of the front to another, and a link has
        // none to leave.
        const float over = horizon - byLink.distances().distanceAt(states.links.ways[0].from,
                                                                   states.links.ways[0].entry);
        const float overBack = horizon - byLink.distances().distanceAt(states.links.ways[1].from,
                                                                       states.links.ways[1].entry);
        const auto isShort = [](float metres) { return metres > -0.01f && metres < 0.76f; };
        if (isShort(over) || isShort(overBack)) continue;
        const auto a = seenIn(found), b = seenIn(expected);
        ASSERT_EQ(a.size(), b.size());
        otherwise += missing(a, b).empty() ? 0 : 1;
        ++graphs;
        compared += found.nodes.size();
        crossed += found.linkSteps.empty() ? 0 : 1;
        for (const LinkStep& step : found.linkSteps) cutInside += step.polygons == 0 ? 1 : 0;
      }
    }
  }
  EXPECT_GT(graphs, 500u);
  // The corridor's throat adds a tenth of a millimetre, and with it the front may come to one more
  // wall right before the horizon.
  EXPECT_LE(otherwise, graphs / 100);
  EXPECT_GT(compared, 3000u);
  EXPECT_GT(crossed, 100u);
  EXPECT_GT(cutInside, 10u);
}

/// Links that are longer than the horizon: whoever takes one is in it when the horizon comes. Where
/// the exit is reached on foot meanwhile it is none.
TEST(FrontLinksLaws, OneLongerThanTheHorizonEndsInIt) {
  constexpr float kHorizon = 5.0f;
  std::size_t cut = 0, none = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    Linked linked(meshOf(seed)), plain(meshOf(seed));
    std::vector<Link> links = testing::randomLinks(linked.world, 6, seed, 1.0f);
    for (Link& link : links) link.length += kHorizon;
    linked.set(links);
    for (const Location& start : testing::randomStarts(linked.world.graph, 5, seed)) {
      SCOPED_TRACE(::testing::Message()
                   << "seed " << seed << " at " << start.plan.x << ", " << start.plan.y);
      plain.from(start, kHorizon, 0.0f);
      const auto walk = [&](navmesh::PolygonId polygon, glm::vec2 place) {
        return plain.distances().distanceAt(polygon, place);
      };
      const PredictionGraph& found = linked.from(start, kHorizon, 0.0f);
      for (const LinkWay& way : linked.states.links.ways) {
        const float entry = walk(way.from, way.entry);
        const float exit = walk(way.to, way.exit);
        if (std::abs(entry - kHorizon) < 1e-3f || std::abs(exit - kHorizon) < 1e-3f) continue;
        const bool isWay = entry < kHorizon && exit > kHorizon;
        // It ends as far along its straight line as is left of the horizon.
        const float share = (kHorizon - entry) / way.length;
        const glm::vec2 place = way.entry + share * (way.exit - way.entry);
        const auto ends =
            std::count_if(found.terminals.begin(), found.terminals.end(), [&](NodeId terminal) {
              const Node& node = found.node(terminal);
              return node.reason == TerminalReason::kHorizon && node.polygon == way.from &&
                     node.distance == kHorizon && glm::distance(node.plan, place) < 1e-3f;
            });
        if (isWay) {
          EXPECT_GE(ends, 1);
        }
        (isWay ? cut : none) += 1;
      }
      // No other edge leads through any.
      const auto throughLinks =
          std::count_if(found.linkSteps.begin(), found.linkSteps.end(),
                        [](const LinkStep& step) { return step.polygons != 0; });
      EXPECT_EQ(throughLinks, 0);
    }
  }
  EXPECT_GT(cut, 50u);
  EXPECT_GT(none, 50u);
}

}  // namespace
}  // namespace forewalk::prediction
