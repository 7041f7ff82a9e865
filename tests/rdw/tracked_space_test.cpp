#include "rdw/tracked_space.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "navmesh/random.h"
#include "rdw/pose.h"

namespace forewalk::rdw {
namespace {

using Ring = std::vector<glm::dvec2>;
using navmesh::uniform;

const Ring kEll{{0, 0}, {6, 0}, {6, 2}, {2, 2}, {2, 6}, {0, 6}};

Ring square(double half, glm::dvec2 at = glm::dvec2(0.0)) {
  return {at + glm::dvec2(-half, -half), at + glm::dvec2(half, -half), at + glm::dvec2(half, half),
          at + glm::dvec2(-half, half)};
}

TrackedSpace made(const Ring& border, const std::vector<Ring>& holes = {}) {
  auto space = TrackedSpace::polygon(border, holes);
  EXPECT_TRUE(space) << (space ? "" : space.error().message);
  return space ? *space : TrackedSpace();
}

void expectRefused(const tl::expected<TrackedSpace, Error>& space, const std::string& saying) {
  ASSERT_FALSE(space) << "expected: " << saying;
  EXPECT_NE(space.error().message.find(saying), std::string::npos) << space.error().message;
}

TEST(TrackedSpace, RefusesWhatIsNoRoom) {
  expectRefused(TrackedSpace::polygon({}), "0 distinct corners");
  expectRefused(TrackedSpace::polygon(Ring{{0, 0}, {1, 0}, {1, 0}, {0, 0}}), "2 distinct corners");
  expectRefused(TrackedSpace::polygon(Ring{{0, 0}, {NAN, 0}, {1, 1}}), "corner 1 is (nan, 0)");
  expectRefused(TrackedSpace::polygon(Ring{{0, 0}, {1e9, 0}, {1, 1}}), "corner 1");
  expectRefused(TrackedSpace::polygon(Ring{{0, 0}, {1, 0}, {2, 0}}), "0 m^2");
  expectRefused(TrackedSpace::polygon(Ring{{0, 0}, {3, 3}, {3, 0}, {0, 2}}), "meets");  // a bow tie
  expectRefused(TrackedSpace::polygon(Ring{{0, 0}, {4, 0}, {4, 4}, {2, 0}, {0, 4}}), "meets");
  expectRefused(TrackedSpace::polygon(Ring{{0, 0}, {4, 0}, {2, 0}, {2, 3}}),
                "meets");  // folds back
  expectRefused(TrackedSpace::polygon(Ring(5000, {0, 0})), "4096");
  const auto withHole = [](const Ring& hole) {
    return TrackedSpace::polygon(square(3), std::vector<Ring>{hole});
  };
  expectRefused(withHole(square(1, {9, 0})), "outside");
  expectRefused(withHole(square(1, {3, 0})), "meets");
  expectRefused(withHole(square(4)), "outside");
  expectRefused(TrackedSpace::polygon(square(3), std::vector<Ring>{square(2), square(1)}),
                "inside");
  expectRefused(TrackedSpace::rectangle(0.0, 5.0), "0 m x 5 m");
  expectRefused(TrackedSpace::rectangle(NAN, 5.0), "nan");
  expectRefused(TrackedSpace::circle(-1.0), "-1 m");
}

TEST(TrackedSpace, MeasuresASquareExactly) {
  const TrackedSpace room = *TrackedSpace::rectangle(6, 4);
  EXPECT_EQ(room.centre(), glm::dvec2(0.0));
  EXPECT_EQ(room.clearance(), 2.0);
  EXPECT_EQ(room.area(), 24.0);
  EXPECT_EQ(room.shorterSide(), 4.0);
  EXPECT_EQ(room.signedDistance({0, 0}), 2.0);
  EXPECT_EQ(room.signedDistance({3, 0}), 0.0);
  EXPECT_EQ(room.signedDistance({6, 6}), -5.0);
  EXPECT_TRUE(room.contains({3, 2}));
  EXPECT_FALSE(room.contains({3.001, 0}));
  EXPECT_EQ(room.distanceAlong({0, 0}, {1, 0}), 3.0);
  EXPECT_EQ(room.distanceAlong({0, 0}, {0, -1}), 2.0);
  EXPECT_EQ(room.distanceAlong({3, 0}, {1, 0}), 0.0);
  EXPECT_EQ(room.distanceAlong({3, 0}, {-1, 0}), 6.0);
  EXPECT_EQ(room.distanceAlong({4, 0}, {-1, 0}), 0.0);  // from outside
}

TEST(TrackedSpace, PutsTheCentreInsideAnEllAndBesideAPillar) {
  const TrackedSpace ell = made(kEll);
  EXPECT_GT(ell.signedDistance(ell.centre()), 1.0);
  // The inner corner (2, 2) is as far from the pole as both outer walls: x = (2 - x) * sqrt(2).
  const double pole = 2.0 * std::sqrt(2.0) / (1.0 + std::sqrt(2.0));
  EXPECT_NEAR(ell.clearance(), pole, 2e-3);
  EXPECT_NEAR(glm::distance(ell.centre(), glm::dvec2(pole)), 0.0, 0.05);

  const TrackedSpace pillar = made(square(3), {square(0.5)});
  EXPECT_GT(pillar.signedDistance(pillar.centre()), 1.2);
}

TEST(TrackedSpace, FindsThePoleThatAFineGridFinds) {
  std::mt19937_64 rng(5);
  for (int round = 0; round < 20; ++round) {
    Ring star;  // corners in order of angle never cross
    for (int i = 0; i < 9; ++i)
      star.push_back(uniform(rng, 1.0, 5.0) * directionOf(2 * kPi * i / 9));
    const TrackedSpace space = made(star);
    double best = 0.0;
    for (double x = -5; x <= 5; x += 0.05) {
      for (double y = -5; y <= 5; y += 0.05) best = std::max(best, space.signedDistance({x, y}));
    }
    EXPECT_GE(space.clearance(), best - 1.1e-3) << round;
    EXPECT_DOUBLE_EQ(space.clearance(), space.signedDistance(space.centre()));
  }
}

TEST(TrackedSpace, DistancesAgreeWithWalkingThereInSmallSteps) {
  std::mt19937_64 rng(6);
  const TrackedSpace space = made(kEll, {square(0.3, {1, 4}), square(0.3, {4, 1})});
  for (int i = 0; i < 500; ++i) {
    const glm::dvec2 p(uniform(rng, 0, 6), uniform(rng, 0, 6));
    if (!space.contains(p)) continue;
    const glm::dvec2 d = directionOf(uniform(rng, -kPi, kPi));
    double walked = 0.0;
    while (space.contains(p + walked * d)) walked += 1e-3;
    EXPECT_NEAR(space.distanceAlong(p, d), walked, 2e-3) << i;
    EXPECT_LE(space.signedDistance(p), space.distanceAlong(p, d) + 1e-9);
  }
}

TEST(TrackedSpace, NearestBorderPointsIntoTheRoom) {
  std::mt19937_64 rng(7);
  const TrackedSpace space = made(kEll, {square(0.3, {1, 4})});
  for (int i = 0; i < 500; ++i) {
    const glm::dvec2 p(uniform(rng, -2, 8), uniform(rng, -2, 8));
    const TrackedSpace::BorderPoint border = space.nearestBorder(p);
    EXPECT_NEAR(border.distance, std::abs(space.signedDistance(p)), 1e-12);
    EXPECT_NEAR(glm::length(border.inward), 1.0, 1e-9);
    const double sign = space.contains(p) ? 1.0 : -1.0;
    EXPECT_NEAR(glm::distance(border.position + sign * border.distance * border.inward, p), 0.0,
                1e-9);
  }
  EXPECT_EQ(space.nearestBorder({3, 0}).inward, glm::dvec2(0, 1));  // on the border itself
}

TEST(TrackedSpace, IsTheSameWhicheverWayItsRingsRun) {
  Ring back(kEll.rbegin(), kEll.rend());
  back.push_back(back.front());  // and closed
  const TrackedSpace a = made(kEll);
  const TrackedSpace b = made(back);
  EXPECT_EQ(a.area(), b.area());
  for (double x = -1; x < 7; x += 0.37) {
    for (double y = -1; y < 7; y += 0.41) {
      EXPECT_NEAR(a.signedDistance({x, y}), b.signedDistance({x, y}), 1e-12);
    }
  }
}

TEST(TrackedSpace, CircleLiesWithinTheTrueCircle) {
  const TrackedSpace room = *TrackedSpace::circle(4.0);
  EXPECT_NEAR(room.clearance(), 4.0, 4 * 0.6e-3);
  for (double a = 0; a < 6.3; a += 0.01) {
    const double reach = room.distanceAlong({0, 0}, directionOf(a));
    EXPECT_LE(reach, 4.0 + 1e-9);
    EXPECT_GE(reach, 4.0 - 4 * 0.6e-3);
  }
}

TEST(TrackedSpaceJson, ReadsTheThreeShapes) {
  auto room = TrackedSpace::read(R"({"format": "forewalk.space/1", "rectangle": [6, 4]})");
  ASSERT_TRUE(room);
  EXPECT_EQ(room->area(), 24.0);
  room = TrackedSpace::read(R"({"format": "forewalk.space/1", "circle": 3})");
  ASSERT_TRUE(room);
  EXPECT_NEAR(room->area(), 9 * kPi, 0.05);
  // World z runs against plan y.
  room = TrackedSpace::read(R"({"format": "forewalk.space/1", "later": 1,
    "polygon": [[0, 0], [4, 0], [4, 2], [0, 2]], "holes": [[[1, 0.5], [2, 0.5], [2, 1.5], [1, 1.5]]]})");
  ASSERT_TRUE(room) << room.error().message;
  EXPECT_EQ(room->area(), 7.0);
  EXPECT_TRUE(room->contains({3, -1}));
  EXPECT_FALSE(room->contains({3, 1}));
  EXPECT_FALSE(room->contains({1.5, -1}));
}

TEST(TrackedSpaceJson, SaysWhatIsWrong) {
  expectRefused(TrackedSpace::fromJson("{\n\"format\": \"forewalk.space/1\",\n\"circle\": }"),
                "tracked space:3: not valid JSON");
  expectRefused(TrackedSpace::fromJson("[]"), "forewalk.space/1");
  expectRefused(TrackedSpace::fromJson("{}"), "missing");
  expectRefused(TrackedSpace::fromJson(R"({"format": "forewalk.space/9"})"), "forewalk.space/9");
  const auto with = [](const std::string& rest) {
    return TrackedSpace::fromJson(R"({"format": "forewalk.space/1", )" + rest + "}");
  };
  expectRefused(with(R"("circle": 1, "rectangle": [1, 1])"), "2 shapes");
  expectRefused(with(R"("x": 1)"), "0 shapes");
  expectRefused(with(R"("circle": "big")"), "circle");
  expectRefused(with(R"("circle": 1e999)"), "not valid JSON");
  expectRefused(with(R"("rectangle": [1])"), "rectangle");
  expectRefused(with(R"("rectangle": [6, 6], "holes": [])"), "holes");
  expectRefused(with(R"("polygon": [[0, 0], [1, 0], [1, "a"]])"), "corner 2");
  expectRefused(with(R"("polygon": [[0, 0], [1, 0]])"), "2 distinct corners");
}

TEST(TrackedSpaceJson, RefusesDeepNestingInOneShortSentence) {
  const std::string deep = std::string(100000, '[') + std::string(100000, ']');
  expectRefused(TrackedSpace::fromJson(R"({"format": )" + deep + "}"), "nested more than 32 deep");
}

TEST(TrackedSpaceText, MayBeginWithAByteOrderMark) {
  const std::string mark = "\xEF\xBB\xBF";
  const auto json = TrackedSpace::read(mark + R"({"format": "forewalk.space/1", "circle": 3})");
  ASSERT_TRUE(json) << json.error().message;
  const auto text = TrackedSpace::read(mark + "1,1\n-1,1\n-1,-1\n1,-1\n");
  ASSERT_TRUE(text) << text.error().message;
  EXPECT_EQ(text->area(), 4.0);
}

TEST(TrackedSpaceOpenRdw, ReadsTheBorderAndItsObstacles) {
  const auto room = TrackedSpace::read(
      "5,5\n-5,5\r\n-5,-5\n5,-5\n\n1,1\n1,2\n2,2\n2,1\n\n\n-1,-1\n-2,-1\n-2,-2\n\n");
  ASSERT_TRUE(room) << room.error().message;
  EXPECT_EQ(room->ringCount(), 3u);
  EXPECT_EQ(room->area(), 98.5);
  EXPECT_FALSE(room->contains({1.5, 1.5}));
}

TEST(TrackedSpaceOpenRdw, ReadsTheFirstRoomOfItsSecondForm) {
  // Users, virtual space and obstacle, //, room and obstacle, /, poses, //, another room.
  const std::string text =
      "2\n20,20\n-20,20\n-20,-20\n20,-20\n\n3,3\n3,4\n4,4\n\n//\n3,2\n-3,2\n-3,-2\n3,-2\n\n"
      "1,1\n1,1.5\n1.5,1.5\n1.5,1\n\n/\n0,0\n0,1\n5,5\n0,1\n\n//\n9,9\n-9,9\n-9,-9\n9,-9\n\n";
  const auto room = TrackedSpace::read(text);
  ASSERT_TRUE(room) << room.error().message;
  EXPECT_EQ(room->ringCount(), 2u);
  EXPECT_EQ(room->area(), 24.0 - 0.25);
  // Without users and rooms after it the room is the same.
  const auto alone = TrackedSpace::read(text.substr(0, text.find("\n/\n") + 1));
  ASSERT_TRUE(alone) << alone.error().message;
  EXPECT_EQ(alone->area(), room->area());
  expectRefused(TrackedSpace::fromOpenRdw("2\n1,1\n-1,1\n-1,-1\n\n"), "no line of two characters");
  expectRefused(TrackedSpace::fromOpenRdw("2\n1,1\n\n//\n"), "no corner");
}

TEST(TrackedSpaceOpenRdw, NamesTheLine) {
  expectRefused(TrackedSpace::fromOpenRdw(""), "no corner");
  expectRefused(TrackedSpace::fromOpenRdw("\n\n  \n"), "no corner");
  expectRefused(TrackedSpace::fromOpenRdw("0,0\n1;0\n1,1"), "tracked space:2: \"1;0\"");
  expectRefused(TrackedSpace::fromOpenRdw("0,0\n1,0\n1,nan"), ":3: ");
  expectRefused(TrackedSpace::fromOpenRdw("0,0\n1,0 7\n1,1"), ":2: ");
  expectRefused(TrackedSpace::fromOpenRdw("0,0\n1,0\n\n5,5\n6,5\n6,6"), "2 distinct corners");
}

TEST(TrackedSpaceText, SurvivesEveryTruncation) {
  const std::string json =
      R"({"format": "forewalk.space/1", "polygon": [[0, 0], [4, 0], [4, 2], [0, 2]]})";
  for (std::size_t n = 0; n < json.size(); ++n) {
    EXPECT_FALSE(TrackedSpace::read(std::string_view(json).substr(0, n))) << n;
  }
}

}  // namespace
}  // namespace forewalk::rdw
