#include "agents/evaluation/one_way.h"

#include <gtest/gtest.h>

#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <random>

#include "navmesh/random.h"

namespace forewalk::agents {
namespace {

using Sample = std::vector<std::vector<double>>;

// About normal: enough for laws, and the same everywhere.
double draw(std::mt19937_64& rng) {
  double sum = -6.0;
  for (int i = 0; i < 12; ++i) sum += navmesh::uniform(rng);
  return sum;
}

Sample randomGroups(std::mt19937_64& rng, std::size_t groups, bool equalSizes = false) {
  Sample sample(groups);
  for (auto& group : sample) {
    const double spread = navmesh::uniform(rng, 0.5, 3.0), mean = navmesh::uniform(rng, -1.0, 1.0);
    group.resize(equalSizes ? 9 : 2 + static_cast<std::size_t>(navmesh::uniformInt(rng, 12)));
    for (double& value : group) value = mean + spread * draw(rng);
  }
  return sample;
}

std::vector<FTest> allTests(const Sample& sample) {
  return {anova(sample).test, levene(sample), levene(sample, Centre::kMedian), welch(sample),
          brownForsythe(sample)};
}

Sample mapped(Sample sample, double scale, double shift) {
  for (auto& group : sample) {
    for (double& value : group) value = scale * value + shift;
  }
  return sample;
}

TEST(OneWay, SumsOfSquaresAddUpToTheWhole) {
  std::mt19937_64 rng(1);
  for (int round = 0; round < 100; ++round) {
    const Sample sample = randomGroups(rng, 2 + static_cast<std::size_t>(round % 7));
    std::vector<double> all;
    for (const auto& group : sample) all.insert(all.end(), group.begin(), group.end());
    const Anova result = anova(sample);
    EXPECT_NEAR(result.between + result.within,
                varianceOf(all) * static_cast<double>(all.size() - 1), 1e-10);
    EXPECT_EQ(result.test.df1 + result.test.df2 + 1.0, static_cast<double>(all.size()));
  }
}

TEST(OneWay, DoesNotSeeShiftOrScaleOrOrder) {
  std::mt19937_64 rng(2);
  for (int round = 0; round < 50; ++round) {
    const Sample sample = randomGroups(rng, 2 + static_cast<std::size_t>(round % 5));
    Sample reversed(sample.rbegin(), sample.rend());
    for (auto& group : reversed) group = {group.rbegin(), group.rend()};
    const std::vector<FTest> plain = allTests(sample);
    for (const Sample& other : {mapped(sample, 1.0, 250.0), mapped(sample, 37.5, 0.0),
                                mapped(sample, -0.01, 4.0), reversed}) {
      const std::vector<FTest> tests = allTests(other);
      for (std::size_t i = 0; i < plain.size(); ++i) {
        EXPECT_NEAR(tests[i].statistic, plain[i].statistic, 1e-7 * (1.0 + plain[i].statistic));
        EXPECT_NEAR(tests[i].df2, plain[i].df2, 1e-7 * plain[i].df2);
        EXPECT_NEAR(tests[i].p, plain[i].p, 1e-8);
      }
    }
  }
}

TEST(OneWay, OfTwoGroupsIsTheTTestSquared) {
  std::mt19937_64 rng(3);
  for (int round = 0; round < 50; ++round) {
    const Sample sample = randomGroups(rng, 2);
    const double n1 = static_cast<double>(sample[0].size()),
                 n2 = static_cast<double>(sample[1].size());
    const double v1 = varianceOf(sample[0]), v2 = varianceOf(sample[1]);
    const double difference = meanOf(sample[0]) - meanOf(sample[1]);
    const auto bothTails = [](double t, double df) {
      const boost::math::students_t_distribution<double> distribution(df);
      return 2.0 * boost::math::cdf(boost::math::complement(distribution, std::abs(t)));
    };

    const double pooled = ((n1 - 1) * v1 + (n2 - 1) * v2) / (n1 + n2 - 2);
    const double student = difference / std::sqrt(pooled * (1 / n1 + 1 / n2));
    EXPECT_NEAR(anova(sample).test.statistic, student * student, 1e-9);
    EXPECT_NEAR(anova(sample).test.p, bothTails(student, n1 + n2 - 2), 1e-10);

    const double error = v1 / n1 + v2 / n2, t = difference / std::sqrt(error);
    const double df = error * error / (v1 * v1 / n1 / n1 / (n1 - 1) + v2 * v2 / n2 / n2 / (n2 - 1));
    for (const FTest& robust : {welch(sample), brownForsythe(sample)}) {
      EXPECT_NEAR(robust.statistic, t * t, 1e-9);
      EXPECT_NEAR(robust.df2, df, 1e-7 * df);
      EXPECT_NEAR(robust.p, bothTails(t, df), 1e-9);
    }
  }
}

TEST(OneWay, BrownForsytheIsTheFOfGroupsOfOneSize) {
  std::mt19937_64 rng(4);
  for (int round = 0; round < 30; ++round) {
    const Sample sample = randomGroups(rng, 5, true);
    EXPECT_NEAR(brownForsythe(sample).statistic, anova(sample).test.statistic, 1e-10);
    EXPECT_LE(brownForsythe(sample).df2, anova(sample).test.df2 * (1 + 1e-12));
  }
}

TEST(OneWay, KnowsThePublishedExample) {
  // NIST/SEMATECH e-Handbook of Statistical Methods, 7.4.3.3: three levels, F = 9.59 with 2 and 12.
  const Sample nist{
      {6.9, 5.4, 5.8, 4.6, 4.0}, {8.3, 6.8, 7.8, 9.2, 6.5}, {8.0, 10.5, 8.1, 6.9, 9.3}};
  const Anova result = anova(nist);
  EXPECT_NEAR(result.between, 27.897, 5e-4);
  EXPECT_NEAR(result.within, 17.452, 5e-4);
  EXPECT_NEAR(result.test.statistic, 9.59, 5e-3);
  EXPECT_NEAR(result.test.p, 0.00325, 5e-6);
}

TEST(OneWay, IsRightAboutHowOftenItIsWrong) {
  // Under the null hypothesis p is uniform: about 5 % of samples are called different at 0.05.
  std::mt19937_64 rng(5);
  constexpr int kRounds = 4000;
  int anovas = 0, welches = 0, robusts = 0, levenes = 0, unequal = 0;
  for (int round = 0; round < kRounds; ++round) {
    Sample sample(4, std::vector<double>(12));
    for (auto& group : sample) {
      for (double& value : group) value = draw(rng);
    }
    anovas += anova(sample).test.p < 0.05;
    welches += welch(sample).p < 0.05;
    robusts += brownForsythe(sample).p < 0.05;
    levenes += levene(sample, Centre::kMedian).p < 0.05;
    for (double& value : sample[0]) value *= 5.0;
    unequal += welch(sample).p < 0.05;
  }
  // Four standard deviations of a binomial count either way, and what the approximations miss.
  const auto share = [](int count) { return static_cast<double>(count) / kRounds; };
  EXPECT_NEAR(share(anovas), 0.05, 0.014);
  EXPECT_NEAR(share(welches), 0.05, 0.016);
  EXPECT_NEAR(share(robusts), 0.05, 0.016);
  EXPECT_NEAR(share(unequal), 0.05, 0.018);
  EXPECT_NEAR(share(levenes), 0.04, 0.02);
}

TEST(OneWay, SaysWhatNoSpreadLeavesToSay) {
  const Sample apart{{1, 1, 1}, {2, 2}}, same{{3, 3}, {3, 3, 3}}, half{{1, 1, 1}, {1, 2, 4}};
  EXPECT_TRUE(std::isinf(anova(apart).test.statistic));
  EXPECT_EQ(anova(apart).test.p, 0.0);
  EXPECT_TRUE(std::isinf(brownForsythe(apart).statistic));
  EXPECT_EQ(brownForsythe(apart).p, 0.0);
  for (const FTest& test :
       {anova(same).test, levene(same), welch(same), brownForsythe(same), welch(half)}) {
    EXPECT_TRUE(std::isnan(test.statistic));
    EXPECT_TRUE(std::isnan(test.p));
  }
  EXPECT_TRUE(std::isfinite(brownForsythe(half).p));
}

}  // namespace
}  // namespace forewalk::agents
