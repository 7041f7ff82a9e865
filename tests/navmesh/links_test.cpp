#include "navmesh/links.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <random>

#include "navmesh/polygon_states.h"
#include "navmesh/random.h"
#include "navmesh/world.h"
#include "tests/support/random_mesh.h"

namespace forewalk::navmesh {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

/// Two rows of five squares, z 0 to -1, the second 3 m higher and 10 m to the right.
World twoRows() {
  const PolygonMesh row = testing::gridMesh(5, 1);
  return makeWorld(*makeNavGraph(testing::together(row, row, {10.0f, 3.0f, 0.0f})));
}

Link link(std::uint32_t id, glm::vec3 entry, glm::vec3 exit, float length, bool bothWays = false) {
  return {LinkId{id}, entry, exit, length, bothWays, true};
}

const Link kLift = link(7, {1.5f, 0.1f, -0.5f}, {12.5f, 3.2f, -0.25f}, 4.0f, true);

Links made(const World& world, const std::vector<Link>& links) {
  const auto result = makeLinks(world.graph, world.locations, links);
  if (!result) throw std::runtime_error(result.error().message);
  return *result;
}

std::string refusal(const World& world, const std::vector<Link>& links, ErrorCode code) {
  const auto result = makeLinks(world.graph, world.locations, links);
  if (result) return "made";
  EXPECT_EQ(result.error().code, code);
  return result.error().message;
}

TEST(Links, AreNoneWithoutLinks) {
  const World world = twoRows();
  EXPECT_TRUE(made(world, {}).empty());
  EXPECT_TRUE(made(world, {}).from(PolygonId{3}).empty());
  Link shut = kLift;
  shut.open = false;
  EXPECT_EQ(made(world, {shut}), Links{});
  // From a place to itself is nowhere; across a polygon is a short cut, or a detour.
  EXPECT_EQ(made(world, {link(1, {1.1f, 0, -0.5f}, {1.1f, 0, -0.5f}, 0.1f)}), Links{});
  EXPECT_EQ(made(world, {link(1, {1.1f, 0, -0.5f}, {1.9f, 0, -0.5f}, 0.1f)}).ways.size(), 1u);
}

TEST(Links, StandOnTheGroundBelowTheirEnds) {
  const World world = twoRows();
  const Links links = made(world, {kLift});
  const LinkWay up{PolygonId{1}, PolygonId{7}, {1.5f, 0.5f}, {12.5f, 0.25f}, 0.0f,
                   3.0f,         4.0f,         LinkId{7},    false};
  const LinkWay down{PolygonId{7}, PolygonId{1}, {12.5f, 0.25f}, {1.5f, 0.5f}, 3.0f,
                     0.0f,         4.0f,         LinkId{7},      true};
  EXPECT_THAT(links.ways, ElementsAre(up, down));
  EXPECT_THAT(links.from(PolygonId{7}), ElementsAre(down));
  EXPECT_TRUE(links.from(PolygonId{2}).empty());
  // A little beside it they are moved.
  const Links moved = made(world, {link(1, {-0.3f, 0, -0.5f}, {14.5f, 3, 0.4f}, 1)});
  EXPECT_EQ(moved.ways[0].entry, glm::vec2(0.0f, 0.5f));
  EXPECT_EQ(moved.ways[0].exit, glm::vec2(14.5f, 0.0f));
}

TEST(Links, SayWhichIsWrongAndWhere) {
  const World world = twoRows();
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  Link wrong = kLift;
  wrong.entry.y = 0.7f;
  EXPECT_EQ(refusal(world, {wrong}, ErrorCode::kPositionOffNavMesh),
            "link 7: its entry (1.5, 0.7, -0.5) is more than 0.5 m beside walkable ground, or 0.5 "
            "m above or below it. Move it onto the floor.");
  wrong = kLift;
  wrong.exit.z = 2.0f;
  EXPECT_THAT(refusal(world, {wrong}, ErrorCode::kPositionOffNavMesh), HasSubstr("its exit"));
  wrong = kLift;
  wrong.exit.x = kNan;
  EXPECT_THAT(refusal(world, {wrong}, ErrorCode::kDataDamaged), HasSubstr("finite"));
  for (const float length : {-0.5f, kNan, 1e5f}) {
    wrong = kLift;
    wrong.length = length;
    EXPECT_THAT(refusal(world, {wrong}, ErrorCode::kSettingOutOfRange), HasSubstr("0 to 10000 m"));
  }
  EXPECT_EQ(refusal(world, {kLift, kLift}, ErrorCode::kSettingOutOfRange),
            "link 7 is given twice. Give each an id of its own.");
  std::vector<Link> many;
  for (std::uint32_t i = 0; i <= kMostLinkWays; ++i) {
    many.push_back(link(i, {1.5f, 0, -0.5f}, {12.5f, 3, -0.5f}, 1));
  }
  EXPECT_THAT(refusal(world, many, ErrorCode::kTooLarge), HasSubstr("out of polygon 1"));
}

TEST(Links, AreLeftOutWhereTheirGroundHasGone) {
  const World world = twoRows();
  std::vector<LinkId> groundless;
  const Link off = link(3, {40, 0, 0}, {1.5f, 0, -0.5f}, 1);
  const Link offToo = link(2, {1.5f, 0, -0.5f}, {1.5f, 9, -0.5f}, 1);
  const auto links =
      makeLinks(world.graph, world.locations, std::vector<Link>{off, kLift, offToo}, &groundless);
  ASSERT_TRUE(links);
  EXPECT_EQ(*links, made(world, {kLift}));
  EXPECT_THAT(groundless, ElementsAre(LinkId{2}, LinkId{3}));
  groundless.clear();
  const World none = makeWorld(NavGraph{});
  EXPECT_TRUE(
      makeLinks(none.graph, none.locations, std::vector<Link>{kLift}, &groundless)->empty());
  EXPECT_THAT(groundless, ElementsAre(LinkId{7}));
}

TEST(Links, DoNotDependOnTheirOrder) {
  const World world = twoRows();
  std::mt19937_64 rng(3);
  std::vector<Link> links;
  for (std::uint32_t i = 0; i < 20; ++i) {
    const auto place = [&](float x, float y) {
      return glm::vec3{x + static_cast<float>(uniformInt(rng, 5)) + 0.5f, y, -0.5f};
    };
    links.push_back(link(i, place(0, 0), place(10, 3), static_cast<float>(uniformInt(rng, 3)),
                         uniformInt(rng, 2) == 0));
  }
  const Links before = made(world, links);
  EXPECT_GT(before.ways.size(), 25u);
  for (int trial = 0; trial < 10; ++trial) {
    for (std::size_t i = links.size(); i > 1; --i) {
      std::swap(links[i - 1],
                links[static_cast<std::size_t>(uniformInt(rng, static_cast<int>(i)))]);
    }
    EXPECT_EQ(made(world, links), before);
  }
}

TEST(Links, MakeNeighboursAndPartChainsInTheStates) {
  const World world = twoRows();
  EXPECT_EQ(world.graph.chains.ofPolygon[0], kNoChain) << "a component without other polygons";
  PolygonStates states;
  setLinks(world.graph, made(world, {kLift}), states);
  EXPECT_FALSE(states.allOpen());
  EXPECT_EQ(states.openNeighbours, (std::vector<std::uint32_t>{1, 3, 2, 2, 1, 1, 2, 3, 2, 1}));
  EXPECT_EQ(states.chains.ofPolygon[1], kNoChain);
  EXPECT_EQ(states.chains.ofPolygon[7], kNoChain);
  EXPECT_NE(states.chains.ofPolygon[2], kNoChain);
  // One way: only the entry has one more.
  Link oneWay = kLift;
  oneWay.bothWays = false;
  setLinks(world.graph, made(world, {oneWay}), states);
  EXPECT_EQ(states.openNeighbours, (std::vector<std::uint32_t>{1, 3, 2, 2, 1, 1, 2, 2, 2, 1}));
  EXPECT_EQ(states.chains.ofPolygon[7], kNoChain) << "people come out there";
  // With areas they are the same, and without both nothing is left.
  EXPECT_EQ(*makePolygonStates(world.graph, {}, made(world, {oneWay})), states);
  ASSERT_TRUE(setCost(world.graph, std::vector{PolygonId{7}}, kClosed, states));
  EXPECT_EQ(states.openNeighbours[1], 2u) << "nobody is let out there";
  ASSERT_TRUE(setCost(world.graph, std::vector{PolygonId{7}}, 1.0f, states));
  setLinks(world.graph, {}, states);
  EXPECT_EQ(states, PolygonStates{});
}

}  // namespace
}  // namespace forewalk::navmesh
