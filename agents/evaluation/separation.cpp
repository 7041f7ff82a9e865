#include "agents/evaluation/separation.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>
#include <random>
#include <tuple>
#include <utility>
#include <vector>

#include "navmesh/random.h"

namespace forewalk::agents {
namespace {

/// All pairs of paths, nearest first, in runs of equal distance.
class RankedPairs {
 public:
  RankedPairs(const DistanceTable& table, const std::vector<std::size_t>& paths) {
    for (std::uint32_t i = 0; i < paths.size(); ++i) {
      for (std::uint32_t j = i + 1; j < paths.size(); ++j) {
        pairs_.push_back({table.at(paths[i], paths[j]), i, j});
      }
    }
    std::sort(pairs_.begin(), pairs_.end(), [](const Pair& a, const Pair& b) {
      return std::tie(a.distance, a.i, a.j) < std::tie(b.distance, b.i, b.j);
    });
  }

  struct Count {
    double u = 0.0;  ///< of (across, within) how many have across > within; ties half
    double across = 0.0, within = 0.0;
    double ties = 0.0;  ///< sum of t^3 - t over runs of t equal distances
  };

  /// `isModel[i]`: whether path i is labelled so.
  Count count(const std::vector<char>& isModel) const {
    Count all;
    for (std::size_t begin = 0; begin < pairs_.size();) {
      double across = 0.0, within = 0.0;
      std::size_t end = begin;
      for (; end < pairs_.size() && pairs_[end].distance == pairs_[begin].distance; ++end) {
        const bool a = isModel[pairs_[end].i] != 0, b = isModel[pairs_[end].j] != 0;
        if (a != b) {
          across += 1.0;
        } else if (!a) {
          within += 1.0;
        }
      }
      all.u += across * (all.within + 0.5 * within);
      all.across += across;
      all.within += within;
      const double run = across + within;
      all.ties += run * run * run - run;
      begin = end;
    }
    return all;
  }

 private:
  struct Pair {
    double distance;
    std::uint32_t i, j;
  };
  std::vector<Pair> pairs_;
};

// How many ways there are to choose m of n, or `limit` + 1 where there are more than that.
std::size_t waysToChoose(std::size_t m, std::size_t n, std::size_t limit) {
  m = std::min(m, n - m);
  double ways = 1.0;
  for (std::size_t i = 1; i <= m; ++i) {
    ways = ways * static_cast<double>(n - m + i) / static_cast<double>(i);
    if (ways > static_cast<double>(limit) + 0.5) return limit + 1;
  }
  return static_cast<std::size_t>(std::llround(ways));
}

double mannWhitneyAbove(const RankedPairs::Count& count) {
  const double all = count.across + count.within;
  const double variance =
      count.across * count.within / 12.0 * (all + 1.0 - count.ties / (all * (all - 1.0)));
  const double z = (count.u - 0.5 * count.across * count.within - 0.5) / std::sqrt(variance);
  return variance > 0.0 ? 0.5 * std::erfc(z / std::numbers::sqrt2) : 1.0;
}

}  // namespace

Separation separation(const DistanceTable& table, std::span<const std::size_t> people,
                      std::span<const std::size_t> model, const SeparationSettings& settings) {
  assert(people.size() >= 2 && !model.empty());
  std::vector<std::size_t> paths(people.begin(), people.end());
  paths.insert(paths.end(), model.begin(), model.end());
  const RankedPairs pairs(table, paths);

  const std::size_t n = paths.size(), m = model.size();
  std::vector<char> isModel(n, 0);
  std::fill(isModel.end() - static_cast<std::ptrdiff_t>(m), isModel.end(), 1);
  const RankedPairs::Count truth = pairs.count(isModel);
  Separation result;
  result.superiority = truth.u / (truth.across * truth.within);
  result.pairsP = mannWhitneyAbove(truth);

  const std::size_t ways = waysToChoose(m, n, settings.draws);
  result.exact = ways <= settings.draws;
  std::size_t asLarge = 0;
  if (result.exact) {
    // From 0..01..1, the first in lexicographic order, through all.
    do {
      asLarge += pairs.count(isModel).u >= truth.u ? 1 : 0;
      ++result.labellings;
    } while (std::next_permutation(isModel.begin(), isModel.end()));
  } else {
    std::mt19937_64 rng(settings.seed);
    asLarge = result.labellings = 1;  // the true one
    for (std::size_t draw = 0; draw < settings.draws; ++draw, ++result.labellings) {
      for (std::size_t i = n - 1; i > 0; --i) {
        const int other = navmesh::uniformInt(rng, static_cast<int>(i + 1));
        std::swap(isModel[i], isModel[static_cast<std::size_t>(other)]);
      }
      asLarge += pairs.count(isModel).u >= truth.u ? 1 : 0;
    }
  }
  result.p = static_cast<double>(asLarge) / static_cast<double>(result.labellings);
  result.leastP = 1.0 / static_cast<double>(result.labellings);
  return result;
}

}  // namespace forewalk::agents
