#include "agents/evaluation/separation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <random>

#include "navmesh/random.h"

namespace forewalk::agents {
namespace {

// Points on a line; their distances are the table.
DistanceTable tableOf(const std::vector<double>& places) {
  DistanceTable table = makeDistanceTable(places.size());
  for (std::size_t i = 0; i < places.size(); ++i) {
    for (std::size_t j = 0; j < places.size(); ++j)
      table.at(i, j) = std::abs(places[i] - places[j]);
  }
  return table;
}

std::vector<std::size_t> range(std::size_t begin, std::size_t end) {
  std::vector<std::size_t> all(end - begin);
  std::iota(all.begin(), all.end(), begin);
  return all;
}

// Comparing every distance across with every one within.
double superiorityByHand(const DistanceTable& table, const std::vector<std::size_t>& people,
                         const std::vector<std::size_t>& model) {
  double wins = 0.0, comparisons = 0.0;
  for (const std::size_t m : model) {
    for (const std::size_t p : people) {
      for (const std::size_t a : people) {
        for (const std::size_t b : people) {
          if (a >= b) continue;
          const double across = table.at(m, p), within = table.at(a, b);
          wins += across > within ? 1.0 : across == within ? 0.5 : 0.0;
          comparisons += 1.0;
        }
      }
    }
  }
  return wins / comparisons;
}

TEST(Separation, CountsWhatABruteForceCounts) {
  std::mt19937_64 rng(1);
  for (int round = 0; round < 60; ++round) {
    const std::size_t n = 3 + static_cast<std::size_t>(navmesh::uniformInt(rng, 7));
    const std::size_t m =
        1 + static_cast<std::size_t>(navmesh::uniformInt(rng, static_cast<int>(n - 2)));
    std::vector<double> places(n);
    // Whole numbers every other time, so that there are ties.
    for (double& place : places) {
      place = round % 2 == 0 ? navmesh::uniform(rng) : navmesh::uniformInt(rng, 5);
    }
    const DistanceTable table = tableOf(places);
    const auto people = range(0, n - m), model = range(n - m, n);
    const Separation result = separation(table, people, model);
    EXPECT_NEAR(result.superiority, superiorityByHand(table, people, model), 1e-12);

    // All labellings, by their bits.
    std::size_t asLarge = 0, all = 0;
    for (std::uint32_t bits = 0; bits < (1u << n); ++bits) {
      std::vector<std::size_t> others, chosen;
      for (std::size_t i = 0; i < n; ++i) ((bits >> i & 1u) != 0 ? chosen : others).push_back(i);
      if (chosen.size() != m) continue;
      ++all;
      asLarge += superiorityByHand(table, others, chosen) >= result.superiority - 1e-9 ? 1 : 0;
    }
    EXPECT_TRUE(result.exact);
    EXPECT_EQ(result.labellings, all);
    EXPECT_DOUBLE_EQ(result.p, static_cast<double>(asLarge) / static_cast<double>(all));
    EXPECT_DOUBLE_EQ(result.leastP, 1.0 / static_cast<double>(all));
  }
}

TEST(Separation, IsCompleteForAModelOnItsOwn) {
  std::vector<double> places{0.0, 0.1, 0.25, 0.3, 0.42, 0.5, 50.0};
  const Separation alone = separation(tableOf(places), range(0, 6), range(6, 7));
  EXPECT_EQ(alone.superiority, 1.0);
  EXPECT_DOUBLE_EQ(alone.p, 1.0 / 7.0);
  places.push_back(50.5);
  EXPECT_DOUBLE_EQ(separation(tableOf(places), range(0, 6), range(6, 8)).p, 1.0 / 28.0);
  // In the middle of all it is nearer to people than they are to each other.
  places = {-5.0, 5.0, -4.0, 4.0, 0.0};
  EXPECT_LT(separation(tableOf(places), range(0, 4), range(4, 5)).superiority, 0.5);
}

TEST(Separation, DoesNotSeeOrderScaleOrOtherPaths) {
  std::mt19937_64 rng(2);
  std::vector<double> places(9);
  for (double& place : places) place = navmesh::uniform(rng);
  const std::vector<std::size_t> people{0, 1, 2, 3, 4}, turned{4, 2, 0, 1, 3}, model{6, 8},
      swapped{8, 6};
  const Separation plain = separation(tableOf(places), people, model);
  const Separation other = separation(tableOf(places), turned, swapped);
  places[5] = 1e6;  // in neither list
  for (double& place : places) place *= 64.0;
  const Separation scaled = separation(tableOf(places), people, model);
  for (const Separation& same : {other, scaled}) {
    EXPECT_EQ(same.superiority, plain.superiority);
    EXPECT_EQ(same.p, plain.p);
    EXPECT_EQ(same.pairsP, plain.pairsP);
  }
}

TEST(Separation, OfEqualPathsSaysNothing) {
  const Separation result = separation(tableOf({1, 1, 1, 1}), range(0, 3), range(3, 4));
  EXPECT_EQ(result.superiority, 0.5);
  EXPECT_EQ(result.p, 1.0);
  EXPECT_EQ(result.pairsP, 1.0);
}

TEST(Separation, SampledComesNearExactAndRepeats) {
  std::mt19937_64 rng(3);
  for (int round = 0; round < 5; ++round) {
    std::vector<double> places(14);
    for (double& place : places)
      place = navmesh::uniform(rng) + (&place - places.data() > 9 ? 0.25 : 0.0);
    const DistanceTable table = tableOf(places);
    const Separation exact = separation(table, range(0, 10), range(10, 14));
    ASSERT_TRUE(exact.exact);
    EXPECT_EQ(exact.labellings, 1001u);
    const Separation sampled = separation(table, range(0, 10), range(10, 14), {1000, 7});
    EXPECT_FALSE(sampled.exact);
    EXPECT_EQ(sampled.labellings, 1001u);
    EXPECT_NEAR(sampled.p, exact.p, 4.0 * std::sqrt(exact.p * (1 - exact.p) / 1000.0) + 0.001);
    EXPECT_EQ(sampled.p, separation(table, range(0, 10), range(10, 14), {1000, 7}).p);
  }
}

// Walkers are points in the plane, the model is one more of them.
TEST(Separation, IsUniformUnderTheNullHypothesis) {
  for (const std::size_t m : {1u, 3u}) {
    std::mt19937_64 rng(4 + m);
    constexpr int kRounds = 3000;
    const std::size_t n = m == 1 ? 20 : 12;  // p in steps of 1/20, or of 1/220
    std::vector<int> below(20, 0);
    int tooSure = 0;
    for (int round = 0; round < kRounds; ++round) {
      std::vector<double> x(n), y(n);
      for (std::size_t i = 0; i < n; ++i) {
        x[i] = navmesh::uniform(rng) + navmesh::uniform(rng);
        y[i] = navmesh::uniform(rng) * navmesh::uniform(rng);
      }
      DistanceTable table = makeDistanceTable(n);
      for (std::size_t i = 0; i < n; ++i) {
        for (std::size_t j = 0; j < n; ++j) table.at(i, j) = std::hypot(x[i] - x[j], y[i] - y[j]);
      }
      const Separation result = separation(table, range(0, n - m), range(n - m, n));
      for (std::size_t step = 0; step < below.size(); ++step) {
        below[step] += result.p <= 0.05 * static_cast<double>(step + 1) + 1e-9;
      }
      tooSure += result.pairsP <= 0.05;
    }
    for (std::size_t step = 0; step < below.size(); ++step) {
      const double expected = 0.05 * static_cast<double>(step + 1);
      EXPECT_NEAR(below[step] / static_cast<double>(kRounds), expected,
                  0.005 + 4.0 * std::sqrt(expected * (1 - expected) / kRounds))
          << m << " model paths, p <= " << expected;
    }
    // What is published is not: it finds differences that are not there far more often than it
    // says.
    EXPECT_GT(tooSure / static_cast<double>(kRounds), 0.1);
  }
}

TEST(MeanDistances, LeaveThePathItselfOut) {
  const DistanceTable table = tableOf({0.0, 1.0, 5.0});
  const std::vector<std::size_t> people{0, 1}, one{0};
  EXPECT_EQ(meanDistancesTo(table, people), (std::vector<double>{1.0, 1.0, 4.5}));
  EXPECT_TRUE(std::isnan(meanDistancesTo(table, one)[0]));
  EXPECT_EQ(columnsOf(table)[2], (std::vector<double>{5.0, 4.0, 0.0}));
}

}  // namespace
}  // namespace forewalk::agents
