#include "navmesh/polygon_states.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <random>

#include "navmesh/plan.h"
#include "navmesh/random.h"

namespace forewalk::navmesh {
namespace {

using ::testing::HasSubstr;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

/// `count` rectangles of 1 m x 1 m along plan x, the i-th from x = i to i + 1.
NavGraph row(std::uint32_t count) {
  PolygonMesh mesh;
  for (std::uint32_t i = 0; i <= count; ++i) {
    mesh.vertices.push_back({static_cast<float>(i), 0.0f, 0.0f});
    mesh.vertices.push_back({static_cast<float>(i), 0.0f, -1.0f});
  }
  for (std::uint32_t i = 0; i < count; ++i) {
    for (const std::uint32_t v : {2 * i, 2 * i + 2, 2 * i + 3, 2 * i + 1}) mesh.ring.push_back(v);
    mesh.ringStart.push_back(static_cast<std::uint32_t>(mesh.ring.size()));
  }
  return *makeNavGraph(mesh);
}

PlanArea from(float x0, float x1) { return {{{x0, -1}, {x1, -1}, {x1, 2}, {x0, 2}}}; }

TEST(PolygonStates, AreAllOpenWhereNothingIsSaid) {
  const NavGraph graph = row(3);
  const auto states = makePolygonStates(graph, {});
  ASSERT_TRUE(states);
  EXPECT_TRUE(states->cost.empty());
  EXPECT_EQ(states->costOf(PolygonId{2}), 1.0f);
  EXPECT_FALSE(states->isClosed(PolygonId{2}));
  // An empty graph has no state to give.
  const auto none = makePolygonStates(NavGraph{}, std::vector<AreaCost>{{from(0, 9), kClosed}});
  ASSERT_TRUE(none);
  EXPECT_TRUE(none->cost.empty());
}

TEST(PolygonStates, CloseWhatLiesInTheAreaAndNothingElse) {
  const NavGraph graph = row(6);
  const auto states =
      makePolygonStates(graph, std::vector<AreaCost>{{from(2, 4), kClosed}, {from(3, 5), 3.0f}});
  ASSERT_TRUE(states);
  EXPECT_EQ(states->cost, (std::vector<float>{1, 1, kClosed, kClosed, 3, 1}));
}

TEST(PolygonStates, DoNotDependOnTheOrderOfTheAreas) {
  std::mt19937_64 rng(5);
  const NavGraph graph = row(40);
  for (int trial = 0; trial < 50; ++trial) {
    std::vector<AreaCost> areas;
    for (int i = 0; i < 6; ++i) {
      const auto x = static_cast<float>(uniform(rng, 0.0, 35.0));
      const float cost = uniformInt(rng, 4) == 0 ? kClosed : 1.0f + uniformInt(rng, 3);
      areas.push_back({from(x, x + static_cast<float>(uniform(rng, 0.1, 8.0))), cost});
    }
    const auto one = makePolygonStates(graph, areas);
    std::reverse(areas.begin(), areas.end());
    const auto other = makePolygonStates(graph, areas);
    ASSERT_TRUE(one && other);
    EXPECT_EQ(*one, *other);
  }
}

TEST(PolygonStates, KnowTheStoreyOfAnArea) {
  const NavGraph graph = row(2);
  PlanArea upstairs = from(0, 2);
  upstairs.bottom = 2.5f;
  upstairs.top = 4.5f;
  EXPECT_TRUE(polygonsIn(graph, upstairs).empty());
  upstairs.bottom = 0.0f;
  EXPECT_EQ(polygonsIn(graph, upstairs).size(), 2u);
}

TEST(PolygonStates, ArePolygonsNamedOneByOneAsWell) {
  const NavGraph graph = row(3);
  PolygonStates states;
  ASSERT_TRUE(setCost(graph, {}, kClosed, states));
  EXPECT_TRUE(states.cost.empty());
  const std::vector<PolygonId> door{PolygonId{1}};
  ASSERT_TRUE(setCost(graph, door, kClosed, states));
  EXPECT_TRUE(states.isClosed(PolygonId{1}));
  ASSERT_TRUE(setCost(graph, door, 1.0f, states));
  EXPECT_EQ(states, PolygonStates{});
}

TEST(PolygonStates, RefuseWhatCannotWorkAndStayAsTheyWere) {
  const NavGraph graph = row(3);
  PolygonStates states;
  const std::vector<PolygonId> wrong{PolygonId{0}, PolygonId{3}};
  const auto outside = setCost(graph, wrong, 2.0f, states);
  ASSERT_FALSE(outside);
  EXPECT_THAT(outside.error().message, HasSubstr("polygon 3"));
  for (const float cost : {0.5f, -1.0f, 1e7f, kNan}) {
    EXPECT_FALSE(setCost(graph, std::vector<PolygonId>{PolygonId{0}}, cost, states));
    EXPECT_FALSE(makePolygonStates(graph, std::vector<AreaCost>{{from(0, 1), cost}}));
  }
  EXPECT_TRUE(states.cost.empty());

  const auto message = [&](PlanArea area) {
    const auto made = makePolygonStates(graph, std::vector<AreaCost>{{std::move(area), 2.0f}});
    return made ? std::string("it was accepted") : made.error().message;
  };
  EXPECT_THAT(message({{{0, 0}, {1, 0}}}), HasSubstr("2 corners"));
  EXPECT_THAT(message({{{0, 0}, {0, 1}, {1, 1}}}), HasSubstr("reverse"));
  EXPECT_THAT(message({{{0, 0}, {2, 0}, {0.5f, 0.5f}, {0, 2}}}), HasSubstr("not convex"));
  EXPECT_THAT(message({{{0, 0}, {kNan, 0}, {0, 2}}}), HasSubstr("not finite"));
  EXPECT_THAT(message({{{0, 0}, {1, 0}, {0, 2}}, 2.0f, 1.0f}), HasSubstr("from 2 m up to 1 m"));
}

}  // namespace
}  // namespace forewalk::navmesh
