#include "agents/evaluation/matched_separation.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

#include "navmesh/random.h"

namespace forewalk::agents {
namespace {

// Legs as points on a line: people[k] is where walker k's path lies, models[k] the model's in its
// place.
struct Legs {
  std::vector<double> people, models;
  std::vector<std::size_t> walkers;
};

/// A set with the table that it points to.
struct Set {
  explicit Set(const Legs& legs) : table(makeDistanceTable(2 * legs.people.size())) {
    std::vector<double> places = legs.people;
    places.insert(places.end(), legs.models.begin(), legs.models.end());
    for (std::size_t i = 0; i < places.size(); ++i) {
      for (std::size_t j = 0; j < places.size(); ++j) {
        table.at(i, j) = std::abs(places[i] - places[j]);
      }
    }
    for (std::size_t k = 0; k < legs.people.size(); ++k) {
      people.push_back(k);
      models.push_back(legs.people.size() + k);
    }
    walkers = legs.walkers;
  }
  MatchedLegs view() const { return {&table, people, models, walkers}; }

  DistanceTable table;
  std::vector<std::size_t> people, models, walkers;
};

MatchedSeparation separated(const std::vector<Legs>& all, const SeparationSettings& settings = {}) {
  std::vector<Set> sets(all.begin(), all.end());
  std::vector<MatchedLegs> views;
  for (const Set& set : sets) views.push_back(set.view());
  return matchedSeparation(views, settings);
}

Legs randomLegs(std::mt19937_64& rng, std::size_t n, double shift = 0.0, bool ties = false) {
  Legs legs;
  for (std::size_t k = 0; k < n; ++k) {
    const auto draw = [&] { return ties ? navmesh::uniformInt(rng, 4) : navmesh::uniform(rng); };
    legs.people.push_back(draw());
    legs.models.push_back(draw() + shift);
    legs.walkers.push_back(k);
  }
  return legs;
}

Legs withFlipped(Legs legs, std::uint32_t flipped) {
  for (std::size_t k = 0; k < legs.people.size(); ++k) {
    if ((flipped >> legs.walkers[k] & 1u) != 0) std::swap(legs.people[k], legs.models[k]);
  }
  return legs;
}

// Every distance to another's model against every one between people.
double superiorityByHand(const Legs& legs) {
  double wins = 0.0, comparisons = 0.0;
  const std::size_t n = legs.people.size();
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j < n; ++j) {
      for (std::size_t a = 0; a < n && i != j; ++a) {
        for (std::size_t b = a + 1; b < n; ++b) {
          const double across = std::abs(legs.people[i] - legs.models[j]);
          const double within = std::abs(legs.people[a] - legs.people[b]);
          wins += across > within ? 1.0 : across == within ? 0.5 : 0.0;
          comparisons += 1.0;
        }
      }
    }
  }
  return wins / comparisons;
}

// Mean distances between different legs.
double energyByHand(const Legs& legs) {
  const std::size_t n = legs.people.size();
  const auto mean = [n](const std::vector<double>& a, const std::vector<double>& b) {
    double sum = 0.0;
    for (std::size_t i = 0; i < n; ++i) {
      for (std::size_t j = 0; j < n; ++j) sum += i == j ? 0.0 : std::abs(a[i] - b[j]);
    }
    return sum / static_cast<double>(n * (n - 1));
  };
  const double across = mean(legs.people, legs.models);
  const double people = mean(legs.people, legs.people), models = mean(legs.models, legs.models);
  const double all = (2.0 * across + people + models) / 4.0;
  return all > 0.0 ? (2.0 * across - people - models) / all : 0.0;
}

TEST(MatchedSeparation, CountsWhatABruteForceCounts) {
  std::mt19937_64 rng(1);
  for (int round = 0; round < 40; ++round) {
    // Two sets; the second without the first walker, and in another order.
    const std::size_t n = 3 + static_cast<std::size_t>(navmesh::uniformInt(rng, 3));
    const Legs first = randomLegs(rng, n, 0.2 * (round % 5), round % 2 == 1);
    Legs second = randomLegs(rng, n - 1, 0.2 * (round % 5), round % 2 == 1);
    for (std::size_t k = 0; k + 1 < n; ++k) second.walkers[k] = n - 1 - k;
    const MatchedSeparation result = separated({first, second});

    const auto pooled = [&](const auto& statistic, std::uint32_t flipped) {
      const double a = statistic(withFlipped(first, flipped));
      const double b = statistic(withFlipped(second, flipped));
      return (a * static_cast<double>(n) + b * static_cast<double>(n - 1)) /
             static_cast<double>(2 * n - 1);
    };
    EXPECT_NEAR(result.superiority, pooled(superiorityByHand, 0), 1e-12);
    EXPECT_NEAR(result.energy, pooled(energyByHand, 0), 1e-12);
    std::size_t asFar = 0, asApart = 0;
    const std::uint32_t all = 1u << n;
    for (std::uint32_t flipped = 0; flipped < all; ++flipped) {
      asFar += pooled(superiorityByHand, flipped) >= result.superiority - 1e-9 ? 1 : 0;
      asApart += pooled(energyByHand, flipped) >= result.energy - 1e-9 ? 1 : 0;
    }
    EXPECT_TRUE(result.exact);
    EXPECT_EQ(result.labellings, all);
    EXPECT_DOUBLE_EQ(result.farther, static_cast<double>(asFar) / all);
    EXPECT_DOUBLE_EQ(result.apart, static_cast<double>(asApart) / all);
    EXPECT_DOUBLE_EQ(result.leastP, 1.0 / all);
  }
}

TEST(MatchedSeparation, OfAReplayIsThatOfOneMorePerson) {
  std::mt19937_64 rng(2);
  Legs legs = randomLegs(rng, 6);
  legs.models = legs.people;
  const MatchedSeparation replay = separated({legs});
  EXPECT_EQ(replay.superiority, 0.5);
  EXPECT_NEAR(replay.energy, 0.0, 1e-12);
  EXPECT_EQ(replay.farther, 1.0);
  EXPECT_EQ(replay.apart, 1.0);
}

TEST(MatchedSeparation, IsCompleteForAStrangerAndSeesTheAverage) {
  std::mt19937_64 rng(3);
  const MatchedSeparation stranger =
      separated({randomLegs(rng, 6, 10.0), randomLegs(rng, 6, -9.0)});
  EXPECT_EQ(stranger.superiority, 1.0);
  // The true labels, and all of them swapped.
  EXPECT_DOUBLE_EQ(stranger.farther, 2.0 / 64.0);
  EXPECT_DOUBLE_EQ(stranger.apart, 2.0 / 64.0);
  EXPECT_GT(stranger.energy, 1.5);
  // In the middle of all it is nearer to people than they are to each other, and gives itself away.
  const MatchedSeparation average =
      separated({{{-3, -2.5, -2, 2, 2.5, 3}, {0, 0, 0, 0, 0, 0}, {0, 1, 2, 3, 4, 5}}});
  EXPECT_LT(average.superiority, 0.5);
  EXPECT_GT(average.farther, 0.5);
  EXPECT_LE(average.apart, 4.0 / 64.0);
}

TEST(MatchedSeparation, DoesNotSeeOrderScaleOrWhoseErrandItWas) {
  std::mt19937_64 rng(4);
  const Legs a = randomLegs(rng, 5, 0.3), b = randomLegs(rng, 4, 0.3);
  const MatchedSeparation plain = separated({a, b});
  Legs turned = a;
  for (std::vector<double>* places : {&turned.people, &turned.models}) {
    std::reverse(places->begin(), places->end());
    for (double& place : *places) place *= 64.0;
  }
  std::reverse(turned.walkers.begin(), turned.walkers.end());
  const MatchedSeparation other = separated({b, turned});
  EXPECT_NEAR(other.superiority, plain.superiority, 1e-12);
  EXPECT_EQ(other.farther, plain.farther);
  EXPECT_NEAR(other.energy, plain.energy, 1e-12);
  EXPECT_EQ(other.apart, plain.apart);

  // What lies between a person and the model in their place plays no part.
  Set set(a);
  const MatchedLegs view = set.view();
  const MatchedSeparation before = matchedSeparation({&view, 1});
  for (std::size_t k = 0; k < 5; ++k) set.table.at(k, 5 + k) = set.table.at(5 + k, k) = 1e6;
  EXPECT_EQ(matchedSeparation({&view, 1}).farther, before.farther);
  EXPECT_EQ(matchedSeparation({&view, 1}).apart, before.apart);
}

TEST(MatchedSeparation, SampledComesNearExactAndRepeats) {
  std::mt19937_64 rng(5);
  const Legs legs = randomLegs(rng, 11, 0.1);
  const MatchedSeparation exact = separated({legs});
  ASSERT_TRUE(exact.exact);
  const MatchedSeparation sampled = separated({legs}, {1000, 7});
  EXPECT_FALSE(sampled.exact);
  EXPECT_EQ(sampled.labellings, 1001u);
  EXPECT_NEAR(sampled.farther, exact.farther, 0.07);
  EXPECT_EQ(sampled.farther, separated({legs}, {1000, 7}).farther);
}

// The model is a person; legs differ in where they begin, people in how they walk, in two sets
// alike. The p of this test is as often below a bound as the bound says; that of separation(),
// which takes legs for alike, is never more often.
TEST(MatchedSeparation, IsUniformUnderTheNullHypothesisWhereSeparationIsMild) {
  std::mt19937_64 rng(6);
  constexpr int kRounds = 3000;
  constexpr std::size_t kPeople = 6;
  std::vector<int> farther(10, 0), apart(10, 0), unmatched(10, 0);
  for (int round = 0; round < kRounds; ++round) {
    const auto normal = [&] {
      return navmesh::uniform(rng) + navmesh::uniform(rng) + navmesh::uniform(rng) - 1.5;
    };
    std::vector<double> personStyle(kPeople), modelStyle(kPeople);
    for (std::size_t k = 0; k < kPeople; ++k) {
      personStyle[k] = normal();
      modelStyle[k] = normal();
    }
    std::vector<Legs> sets(2);
    for (Legs& legs : sets) {
      for (std::size_t k = 0; k < kPeople; ++k) {
        const double start = normal();
        legs.people.push_back(start + personStyle[k] + 0.3 * normal());
        legs.models.push_back(start + modelStyle[k] + 0.3 * normal());
        legs.walkers.push_back(k);
      }
    }
    const MatchedSeparation result = separated(sets);
    const Set first(sets.front());
    const Separation plain = separation(first.table, first.people, first.models);
    for (std::size_t step = 0; step < farther.size(); ++step) {
      const double bound = static_cast<double>(step + 1) / 16.0;
      farther[step] += result.farther <= bound + 1e-9;
      apart[step] += result.apart <= bound + 1e-9;
      unmatched[step] += plain.p <= bound + 1e-9;
    }
  }
  for (std::size_t step = 0; step < farther.size(); ++step) {
    const double bound = static_cast<double>(step + 1) / 16.0;
    const double tolerance = 0.004 + 4.0 * std::sqrt(bound * (1 - bound) / kRounds);
    EXPECT_NEAR(farther[step] / static_cast<double>(kRounds), bound, tolerance) << bound;
    EXPECT_NEAR(apart[step] / static_cast<double>(kRounds), bound, tolerance) << bound;
    EXPECT_LE(unmatched[step] / static_cast<double>(kRounds), bound + tolerance) << bound;
  }
}

}  // namespace
}  // namespace forewalk::agents
