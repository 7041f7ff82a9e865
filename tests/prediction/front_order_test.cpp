// Rows of sectors: which piece of a front passes where.
#include "prediction/front_order.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "navmesh/random.h"

namespace forewalk::prediction {
namespace {

glm::dvec2 towards(double angle) { return {std::cos(angle), std::sin(angle)}; }

// Around one root pieces lie between neighbouring cuts: each ends on its left at the next cut
// counter-clockwise, whatever the order of the cuts.
TEST(FrontOrder, PiecesAboutOneRootEndAtTheNextCut) {
  constexpr double kTurn = 6.283185307179586;
  std::mt19937_64 rng(1);
  for (int round = 0; round < 200; ++round) {
    const int count = 1 + navmesh::uniformInt(rng, 12);
    FrontOrder order;
    order.start(1, 2 * static_cast<std::size_t>(count));
    EXPECT_EQ(order.leftEndOf(order.sectorOf(0, towards(1.0))), kNone) << "it is closed at first";
    std::vector<double> cuts;
    for (int i = 0; i < count; ++i) {
      const double angle = navmesh::uniform(rng, 0.0, kTurn);
      const auto stretch = static_cast<std::uint32_t>(2 * i);
      order.split(order.sectorOf(0, towards(angle)), towards(angle), stretch, stretch + 1);
      cuts.push_back(angle);
      for (int probe = 0; probe < 20; ++probe) {
        const double at = navmesh::uniform(rng, 0.0, kTurn);
        std::size_t next = 0;
        const auto turnTo = [&](std::size_t k) { return std::fmod(cuts[k] - at + kTurn, kTurn); };
        for (std::size_t k = 1; k < cuts.size(); ++k) next = turnTo(k) < turnTo(next) ? k : next;
        ASSERT_EQ(order.leftEndOf(order.sectorOf(0, towards(at))), 2 * next)
            << "round " << round << " after " << cuts.size() << " cuts";
      }
    }
    // What was parted and runs together again is one piece, up to the next cut to the left.
    const std::size_t joined = cuts.size() - 1;
    const auto stretch = static_cast<std::uint32_t>(2 * joined);
    ASSERT_TRUE(order.join(stretch + 1, stretch));
    const double at = cuts[joined] - 1e-9;
    std::size_t next = joined;
    const auto turnTo = [&](std::size_t k) {
      return k == joined ? kTurn : std::fmod(cuts[k] - at + kTurn, kTurn);
    };
    for (std::size_t k = 0; k < joined; ++k) next = turnTo(k) < turnTo(next) ? k : next;
    ASSERT_EQ(order.leftEndOf(order.sectorOf(0, towards(at))), count == 1 ? kNone : 2 * next);
  }
}

// A corner of the wall that a piece ends on becomes its end: to the left of all there is, or to the
// right.
TEST(FrontOrder, NewRootsLieAtTheEndsOfTheirPiece) {
  FrontOrder order;
  order.start(4, 8);
  const glm::dvec2 north(0.0, 1.0), west(-1.0, 0.0), east(1.0, 0.0);
  order.split(order.sectorOf(0, north), north, 0, 1);
  order.split(order.sectorOf(0, -north), -north, 2, 3);
  ASSERT_TRUE(order.add(1, north, 0));  // at the left end of the eastern piece
  ASSERT_TRUE(order.add(2, north, 1));  // at the right end of the western piece
  EXPECT_FALSE(order.add(3, north, 6)) << "no piece ends there";
  EXPECT_FALSE(order.add(1, north, 1)) << "it is known already";
  EXPECT_EQ(order.leftEndOf(order.sectorOf(0, east)), 0u);
  EXPECT_EQ(order.leftEndOf(order.sectorOf(1, east)), 0u);
  EXPECT_EQ(order.leftEndOf(order.sectorOf(0, west)), 2u);
  EXPECT_EQ(order.leftEndOf(order.sectorOf(2, west)), 2u);
  EXPECT_EQ(order.sectorOf(3, west), kNone);

  // The western piece and the eastern one meet behind what stands in the north: one piece, from the
  // left end of the western one to the right end of the other.
  ASSERT_TRUE(order.join(1, 0));
  for (const std::uint32_t root : {0u, 1u, 2u}) {
    EXPECT_EQ(order.leftEndOf(order.sectorOf(root, east)), 2u) << root;
  }
  // Who closes around the south as well has no end.
  ASSERT_TRUE(order.join(3, 2));
  EXPECT_EQ(order.leftEndOf(order.sectorOf(0, east)), kNone);
}

// A front that meets another in the open: left of the place the one goes on with the other's right.
TEST(FrontOrder, MeetingInTheOpenSwapsWhatIsRight) {
  FrontOrder order;
  order.start(2, 8);
  const glm::dvec2 north(0.0, 1.0), east(1.0, 0.0), northEast(1.0, 1.0);
  order.split(order.sectorOf(0, north), north, 0, 1);
  order.split(order.sectorOf(0, -north), -north, 2, 3);
  ASSERT_TRUE(order.add(1, north, 1));  // a root of the western piece
  order.meet(order.sectorOf(0, east), east, order.sectorOf(1, northEast), northEast);
  EXPECT_EQ(order.leftEndOf(order.sectorOf(0, northEast)), 0u) << "left of the place: the east's";
  EXPECT_EQ(order.leftEndOf(order.sectorOf(1, east)), 0u) << "and on with the west's right";
  EXPECT_EQ(order.leftEndOf(order.sectorOf(1, north)), 2u);
  EXPECT_EQ(order.leftEndOf(order.sectorOf(0, glm::dvec2(1.0, -1.0))), 2u);
}

}  // namespace
}  // namespace forewalk::prediction
