#include "service/walk_legs.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

namespace forewalk::service {
namespace {

double straight(glm::dvec2 from, glm::dvec2 to) { return glm::distance(from, to); }

/// A walk put together, 20 samples a second.
class WalkMaker {
 public:
  explicit WalkMaker(std::string walker, glm::dvec2 at) : walk_{std::move(walker), {{0.0, at}}} {}

  WalkMaker& to(glm::dvec2 goal, double speed = 1.0) {
    const glm::dvec2 start = walk_.samples.back().plan;
    const int steps = static_cast<int>(std::ceil(20.0 * glm::distance(start, goal) / speed));
    for (int k = 1; k <= steps; ++k) add(glm::mix(start, goal, static_cast<double>(k) / steps));
    return *this;
  }
  WalkMaker& rest(double seconds = 3.0) {
    const glm::dvec2 at = walk_.samples.back().plan;
    for (int k = 0; k < static_cast<int>(20.0 * seconds); ++k) {
      add(at + 0.02 * glm::dvec2(std::sin(0.3 * k), std::cos(0.2 * k)));
    }
    return *this;
  }
  operator rdw::Walk() const { return walk_; }

 private:
  void add(glm::dvec2 at) { walk_.samples.push_back({walk_.samples.back().seconds + 0.05, at}); }
  rdw::Walk walk_;
};

// Everybody rests near (0, 0), (10, 0) and (10, 10) and walks from each to the next; the k-th
// somewhat aside, and bent a little.
std::vector<rdw::Walk> threePlaces(int people) {
  std::vector<rdw::Walk> walks;
  for (int k = 0; k < people; ++k) {
    const double aside = 0.1 * k;
    walks.push_back(WalkMaker("u" + std::to_string(k), {aside, 0.2})
                        .rest()
                        .to({5.0, 0.3 * k})
                        .to({10.0 - aside, 0.1})
                        .rest()
                        .to({10.0 + 0.2 * k, 5.0})
                        .to({10.0, 10.0 - aside})
                        .rest());
  }
  return walks;
}

TEST(CutLegs, FindsWhereEverybodyRestsAndWhatTheyWalkBetween) {
  const std::vector<rdw::Walk> walks = threePlaces(5);
  const WalkLegs cut = cutLegs(walks, {}, straight);
  EXPECT_EQ(cut.rests, 15u);
  ASSERT_EQ(cut.regions.size(), 3u);
  ASSERT_EQ(cut.sets.size(), 2u);
  const LegRule rule;
  for (const LegSet& set : cut.sets) {
    ASSERT_EQ(set.legs.size(), 5u);
    for (const WalkLeg& leg : set.legs) {
      const auto& samples = walks[leg.walk].samples;
      const glm::dvec2 from = cut.regions[set.from], to = cut.regions[set.to];
      // It begins with the last sample in one region and ends with the first in the other.
      EXPECT_LE(glm::distance(samples[leg.first].plan, from), rule.regionRadius);
      EXPECT_GT(glm::distance(samples[leg.first + 1].plan, from), rule.regionRadius);
      EXPECT_LE(glm::distance(samples[leg.last].plan, to), rule.regionRadius);
      EXPECT_GT(glm::distance(samples[leg.last - 1].plan, to), rule.regionRadius);
      double metres = 0.0;
      for (std::size_t i = leg.first + 1; i <= leg.last; ++i) {
        metres += glm::distance(samples[i].plan, samples[i - 1].plan);
      }
      EXPECT_NEAR(leg.metres, metres, 1e-9);
      EXPECT_DOUBLE_EQ(leg.shortestWay, straight(samples[leg.first].plan, samples[leg.last].plan));
    }
  }
}

TEST(CutLegs, LeaveOutWhoStraysOrCannotHaveComeThatWay) {
  std::vector<rdw::Walk> walks = threePlaces(5);
  walks[2] = WalkMaker("astray", {0, 0}).rest().to({5, 9}).to({10, 0}).rest();
  const WalkLegs cut = cutLegs(walks, {}, straight);
  ASSERT_FALSE(cut.sets.empty());
  for (const LegSet& set : cut.sets) {
    for (const WalkLeg& leg : set.legs) EXPECT_NE(leg.walk, 2u);
  }
  LegRule patient;
  patient.detour = 3.0;
  const WalkLegs all = cutLegs(walks, patient, straight);
  EXPECT_TRUE(std::any_of(all.sets.begin(), all.sets.end(), [](const LegSet& set) {
    return std::any_of(set.legs.begin(), set.legs.end(),
                       [](const WalkLeg& leg) { return leg.walk == 2; });
  }));
  const auto noWay = [](glm::dvec2, glm::dvec2) { return std::numeric_limits<double>::infinity(); };
  EXPECT_TRUE(cutLegs(walks, {}, noWay).sets.empty());
}

TEST(CutLegs, AskForAsManyPeopleAsTheRule) {
  const std::vector<rdw::Walk> three = threePlaces(3);
  EXPECT_TRUE(cutLegs(three, {}, straight).sets.empty());
  LegRule few;
  few.walkers = 3;
  EXPECT_EQ(cutLegs(three, few, straight).sets.size(), 2u);
  few.shortest = 12.0;
  few.detour = 1.2;  // from the first place to the last it is 1.4
  EXPECT_TRUE(cutLegs(three, few, straight).sets.empty());
  few.detour = 2.5;
  EXPECT_EQ(cutLegs(three, few, straight).sets.size(), 1u);
  EXPECT_TRUE(cutLegs({}, {}, straight).sets.empty());
}

TEST(CutLegs, TakeNoStretchTwiceAndNobodyTwiceInASet) {
  // To and fro, again and again, so that legs overlap wherever they can.
  std::vector<rdw::Walk> walks;
  for (int k = 0; k < 6; ++k) {
    WalkMaker walk("u" + std::to_string(k), {0, 0.05 * k});
    for (int round = 0; round < 4; ++round) {
      walk.rest().to({7.0 + 0.05 * k, 0}).rest().to({14.0, 0.1 * k}).rest().to({0.1, 0.03 * k});
    }
    walks.push_back(walk);
  }
  const WalkLegs cut = cutLegs(walks, {}, straight);
  ASSERT_GE(cut.sets.size(), 3u);
  std::vector<std::vector<WalkLeg>> byWalk(walks.size());
  for (const LegSet& set : cut.sets) {
    std::set<std::size_t> who;
    for (const WalkLeg& leg : set.legs) {
      EXPECT_TRUE(who.insert(leg.walk).second);
      byWalk[leg.walk].push_back(leg);
    }
  }
  for (std::vector<WalkLeg>& legs : byWalk) {
    std::sort(legs.begin(), legs.end(),
              [](const WalkLeg& a, const WalkLeg& b) { return a.first < b.first; });
    for (std::size_t i = 1; i < legs.size(); ++i) EXPECT_LE(legs[i - 1].last, legs[i].first);
  }
}

TEST(CutLegs, DoNotSeeTheOrderOfWalksNorWhereTheWorldLies) {
  const std::vector<rdw::Walk> walks = threePlaces(5);
  std::vector<rdw::Walk> moved(walks.rbegin(), walks.rend());
  for (rdw::Walk& walk : moved) {
    for (rdw::WalkSample& sample : walk.samples) {
      sample.plan = glm::dvec2(-sample.plan.y + 64.0, sample.plan.x - 32.0);  // a quarter turn
      sample.seconds += 100.0;
    }
  }
  const WalkLegs one = cutLegs(walks, {}, straight), other = cutLegs(moved, {}, straight);
  const auto stretches = [](const WalkLegs& cut, const std::vector<rdw::Walk>& of) {
    std::set<std::tuple<std::string, std::size_t, std::size_t>> all;
    for (const LegSet& set : cut.sets) {
      for (const WalkLeg& leg : set.legs) all.insert({of[leg.walk].walker, leg.first, leg.last});
    }
    return all;
  };
  EXPECT_EQ(stretches(one, walks), stretches(other, moved));
}

TEST(ComfortSpeed, IsThatOfWalkingNotOfStanding) {
  const rdw::Walk walk = WalkMaker("u", {0, 0}).rest(60.0).to({8, 0}, 0.8).rest(60.0);
  EXPECT_NEAR(comfortSpeed(walk), 0.8, 0.02);
  EXPECT_EQ(comfortSpeed(WalkMaker("u", {0, 0}).rest()), 1.3);
}

}  // namespace
}  // namespace forewalk::service
