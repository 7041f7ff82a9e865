#include "agents/evaluation/matched_separation.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <random>

#include "navmesh/random.h"

namespace forewalk::agents {
namespace {

struct Statistics {
  double superiority = 0.0, energy = 0.0;
};

/// The statistics of one set, with some of its legs flipped.
class MatchedSet {
 public:
  explicit MatchedSet(const MatchedLegs& legs) : legs_(legs) {}

  /// `flipped[walker]`: whether the labels of this walker's legs are swapped.
  Statistics under(const std::vector<char>& flipped) {
    within_.clear();
    across_.clear();
    const std::size_t n = legs_.people.size();
    const auto person = [&](std::size_t k) { return path(k, flipped[legs_.walkers[k]] != 0); };
    const auto model = [&](std::size_t k) { return path(k, flipped[legs_.walkers[k]] == 0); };
    double people = 0.0, models = 0.0, across = 0.0;
    for (std::size_t i = 0; i < n; ++i) {
      for (std::size_t j = 0; j < n; ++j) {
        if (i < j) {
          within_.push_back(legs_.table->at(person(i), person(j)));
          people += within_.back();
          models += legs_.table->at(model(i), model(j));
        }
        if (i == j) continue;
        across_.push_back(legs_.table->at(person(i), model(j)));
        across += across_.back();
      }
    }
    std::sort(within_.begin(), within_.end());
    std::size_t halves = 0;  // whole numbers, so that the order of legs cannot round
    for (const double distance : across_) {
      const auto [below, above] = std::equal_range(within_.begin(), within_.end(), distance);
      halves += static_cast<std::size_t>(below - within_.begin()) +
                static_cast<std::size_t>(above - within_.begin());
    }
    Statistics statistics;
    statistics.superiority =
        0.5 * static_cast<double>(halves) / static_cast<double>(across_.size() * within_.size());
    // There are twice as many distances across as among people, or among models.
    const double all = across + people + models;
    if (all > 0.0) statistics.energy = 4.0 * (across - people - models) / all;
    return statistics;
  }

  std::size_t legs() const { return legs_.people.size(); }

 private:
  std::size_t path(std::size_t k, bool other) const {
    return other ? legs_.models[k] : legs_.people[k];
  }

  const MatchedLegs& legs_;
  std::vector<double> within_, across_;
};

}  // namespace

MatchedSeparation matchedSeparation(std::span<const MatchedLegs> sets,
                                    const SeparationSettings& settings) {
  assert(!sets.empty());
  std::vector<MatchedSet> all;
  std::vector<std::size_t> walkers;
  std::size_t legs = 0;
  for (const MatchedLegs& set : sets) {
    assert(set.people.size() >= 2 && set.people.size() == set.models.size() &&
           set.people.size() == set.walkers.size());
    all.emplace_back(set);
    legs += set.people.size();
    walkers.insert(walkers.end(), set.walkers.begin(), set.walkers.end());
  }
  std::sort(walkers.begin(), walkers.end());
  walkers.erase(std::unique(walkers.begin(), walkers.end()), walkers.end());

  std::vector<char> flipped(walkers.back() + 1, 0);
  const auto pooled = [&] {
    Statistics sum;
    for (MatchedSet& set : all) {
      const Statistics one = set.under(flipped);
      const double weight = static_cast<double>(set.legs()) / static_cast<double>(legs);
      sum.superiority += weight * one.superiority;
      sum.energy += weight * one.energy;
    }
    return sum;
  };
  const Statistics truth = pooled();
  MatchedSeparation result;
  result.superiority = truth.superiority;
  result.energy = truth.energy;
  // Sums round by their order; what is equal but for that counts as equal.
  constexpr double kRounding = 1e-11;
  std::size_t asFar = 0, asApart = 0;
  const auto look = [&] {
    const Statistics here = pooled();
    asFar += here.superiority >= truth.superiority - kRounding ? 1 : 0;
    asApart += here.energy >= truth.energy - kRounding ? 1 : 0;
    ++result.labellings;
  };
  constexpr std::size_t kMostBits = 40;
  result.exact = walkers.size() < kMostBits &&
                 (std::uint64_t{1} << walkers.size()) <= std::uint64_t{settings.draws};
  if (result.exact) {
    for (std::uint64_t bits = 0; bits < (std::uint64_t{1} << walkers.size()); ++bits) {
      for (std::size_t w = 0; w < walkers.size(); ++w) {
        flipped[walkers[w]] = static_cast<char>(bits >> w & 1u);
      }
      look();
    }
  } else {
    look();  // the true one
    std::mt19937_64 rng(settings.seed);
    for (std::size_t draw = 0; draw < settings.draws; ++draw) {
      for (const std::size_t walker : walkers) {
        flipped[walker] = navmesh::uniform(rng) < 0.5 ? 1 : 0;
      }
      look();
    }
  }
  const auto share = [&](std::size_t count) {
    return static_cast<double>(count) / static_cast<double>(result.labellings);
  };
  result.farther = share(asFar);
  result.apart = share(asApart);
  result.leastP = share(1);
  return result;
}

}  // namespace forewalk::agents
