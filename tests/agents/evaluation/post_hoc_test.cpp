#include "agents/evaluation/post_hoc.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "agents/evaluation/studentized_range.h"
#include "navmesh/random.h"

namespace forewalk::agents {
namespace {

using Sample = std::vector<std::vector<double>>;

Sample randomGroups(std::mt19937_64& rng, std::size_t groups, std::size_t least,
                    double unevenness) {
  Sample sample(groups);
  for (std::size_t g = 0; g < groups; ++g) {
    sample[g].resize(least + (unevenness > 0 ? 3 * g : 0));
    for (double& value : sample[g]) {
      value = -6.0;
      for (int i = 0; i < 12; ++i) value += navmesh::uniform(rng);
      value *= 1.0 + unevenness * static_cast<double>(g);
    }
  }
  return sample;
}

TEST(PostHoc, OfTwoGroupsIsTheTestOfTwoGroups) {
  std::mt19937_64 rng(1);
  for (int round = 0; round < 30; ++round) {
    const Sample sample = randomGroups(rng, 2, 5, 0.7);
    const PairDifference tukey = tukeyHsd(sample).front(), gh = gamesHowell(sample).front();
    EXPECT_NEAR(tukey.p, anova(sample).test.p, 1e-10);
    EXPECT_NEAR(tukey.q * tukey.q, 2.0 * anova(sample).test.statistic, 1e-9);
    EXPECT_NEAR(gh.p, welch(sample).p, 1e-10);
    EXPECT_NEAR(gh.df, welch(sample).df2, 1e-9 * gh.df);
  }
}

TEST(PostHoc, KnowsThePublishedExample) {
  // NIST/SEMATECH e-Handbook of Statistical Methods, 7.4.7.1: SST 38.820, SSE 21.292, and a half
  // width of 4.05 sqrt(1.331 / 5) = 2.09.
  const Sample nist{{6.9, 5.4, 5.8, 4.6, 4.0},
                    {8.3, 6.8, 7.8, 9.2, 6.5},
                    {8.0, 10.5, 8.1, 6.9, 9.3},
                    {5.8, 3.8, 6.1, 5.6, 6.2}};
  const std::vector<PairDifference> pairs = tukeyHsd(nist);
  ASSERT_EQ(pairs.size(), 6u);
  EXPECT_NEAR(anova(nist).between, 38.820, 5e-4);
  EXPECT_NEAR(anova(nist).within, 21.292, 5e-4);
  EXPECT_NEAR(pairs[0].halfWidth, 2.09, 5e-3);
  EXPECT_NEAR(pairs[0].difference, -2.38, 1e-12);
  EXPECT_EQ(pairs[4].first, 1u);
  EXPECT_EQ(pairs[4].second, 3u);
}

TEST(PostHoc, IntervalsHoldZeroWherePExceedsItsLevel) {
  std::mt19937_64 rng(2);
  for (int round = 0; round < 20; ++round) {
    const Sample sample = randomGroups(rng, 5, 4, round % 2 == 0 ? 0.0 : 0.5);
    for (const double confidence : {0.5, 0.95}) {
      for (const auto& pairs : {tukeyHsd(sample, confidence), gamesHowell(sample, confidence)}) {
        for (const PairDifference& pair : pairs) {
          EXPECT_EQ(std::abs(pair.difference) > pair.halfWidth, pair.p < 1.0 - confidence);
        }
      }
    }
  }
}

TEST(PostHoc, DoesNotSeeShiftAndScalesWithScale) {
  std::mt19937_64 rng(3);
  const Sample sample = randomGroups(rng, 4, 5, 0.4);
  Sample other = sample;
  for (auto& group : other) {
    for (double& value : group) value = 12.0 * value - 300.0;
  }
  for (const auto& [plain, scaled] : {std::pair(tukeyHsd(sample), tukeyHsd(other)),
                                      std::pair(gamesHowell(sample), gamesHowell(other))}) {
    for (std::size_t i = 0; i < plain.size(); ++i) {
      EXPECT_NEAR(scaled[i].p, plain[i].p, 1e-9);
      EXPECT_NEAR(scaled[i].difference, 12.0 * plain[i].difference, 1e-9);
      EXPECT_NEAR(scaled[i].halfWidth, 12.0 * plain[i].halfWidth, 1e-8);
    }
  }
}

TEST(PostHoc, RaisesAFalseAlarmAboutAsOftenAsItSays) {
  // Any pair of five equal groups: 5 % of samples. With unequal spreads and sizes Tukey's is off,
  // that of Games and Howell is not.
  std::mt19937_64 rng(4);
  constexpr int kRounds = 1500;
  const double critical = studentizedRangeQuantile(0.05, 5, 45.0);
  int tukey = 0, howell = 0;
  const auto alarm = [](const std::vector<PairDifference>& pairs) {
    return std::any_of(pairs.begin(), pairs.end(),
                       [](const PairDifference& p) { return p.p < 0.05; });
  };
  for (int round = 0; round < kRounds; ++round) {
    const Sample equal = randomGroups(rng, 5, 10, 0.0);
    double low = 1e9, high = -1e9;
    for (const auto& group : equal) {
      low = std::min(low, meanOf(group));
      high = std::max(high, meanOf(group));
    }
    tukey += (high - low) / std::sqrt(anova(equal).meanSquareWithin() / 10.0) > critical;
    if (round % 5 == 0) howell += alarm(gamesHowell(randomGroups(rng, 3, 8, 1.0)));
  }
  EXPECT_NEAR(tukey / static_cast<double>(kRounds), 0.05, 0.023);
  EXPECT_NEAR(howell / (kRounds / 5.0), 0.05, 0.05);
}

TEST(PostHoc, SaysWhatNoSpreadLeavesToSay) {
  const Sample sample{{1, 1, 1}, {2, 2}, {2, 2}};
  const std::vector<PairDifference> pairs = gamesHowell(sample);
  EXPECT_EQ(pairs[0].p, 0.0);
  EXPECT_TRUE(std::isnan(pairs[2].p));
  EXPECT_EQ(tukeyHsd(sample)[0].p, 0.0);
}

TEST(PostHoc, StandsVariancesAtTheEndsOfDouble) {
  const Sample plain{{0.0, 1.0, 3.0}, {5.0, 7.0, 6.0}};
  for (const double scale : {1e-120, 1e120}) {  // their squares' squares are 0 and infinite
    Sample sample = plain;
    for (auto& group : sample) {
      for (double& value : group) value *= scale;
    }
    EXPECT_NEAR(gamesHowell(sample)[0].p, gamesHowell(plain)[0].p, 1e-9) << scale;
  }
  const PairDifference beyond = gamesHowell(Sample{{0.0, 1e300, 0.0}, {1e300, 0.0, 1e299}})[0];
  EXPECT_TRUE(std::isnan(beyond.p));
}

}  // namespace
}  // namespace forewalk::agents
