#include "agents/evaluation/post_hoc.h"

#include <cassert>
#include <cmath>

#include "agents/evaluation/studentized_range.h"

namespace forewalk::agents {
namespace {

struct GroupMoments {
  double count, mean, variance;
};

std::vector<GroupMoments> momentsOf(Groups groups) {
  std::vector<GroupMoments> moments;
  for (const auto& group : groups) {
    moments.push_back({static_cast<double>(group.size()), meanOf(group), varianceOf(group)});
  }
  return moments;
}

PairDifference compare(std::size_t i, std::size_t j, double difference, double standardError,
                       double df, int groups) {
  PairDifference pair{i, j, difference, standardError, df, 0.0, 0.0, 0.0};
  pair.q = std::abs(difference) / standardError;
  if (std::isinf(pair.q)) {
    pair.p = 0.0;
  } else if (std::isnan(pair.q) || std::isnan(df)) {
    pair.p = std::nan("");
  } else {
    pair.p = studentizedRangeAbove(pair.q, groups, df);
  }
  return pair;
}

}  // namespace

std::vector<PairDifference> tukeyHsd(Groups groups, double confidence) {
  assert(confidence > 0.0 && confidence < 1.0);
  const std::vector<GroupMoments> moments = momentsOf(groups);
  const Anova variance = anova(groups);
  const double df = variance.test.df2;
  const int k = static_cast<int>(groups.size());
  const double quantile = studentizedRangeQuantile(1.0 - confidence, k, df);
  std::vector<PairDifference> pairs;
  for (std::size_t i = 0; i < groups.size(); ++i) {
    for (std::size_t j = i + 1; j < groups.size(); ++j) {
      const double error = std::sqrt(0.5 * variance.meanSquareWithin() *
                                     (1.0 / moments[i].count + 1.0 / moments[j].count));
      pairs.push_back(compare(i, j, moments[i].mean - moments[j].mean, error, df, k));
      pairs.back().halfWidth = quantile * error;
    }
  }
  return pairs;
}

std::vector<PairDifference> gamesHowell(Groups groups, double confidence) {
  assert(confidence > 0.0 && confidence < 1.0);
  const std::vector<GroupMoments> moments = momentsOf(groups);
  const int k = static_cast<int>(groups.size());
  std::vector<PairDifference> pairs;
  for (std::size_t i = 0; i < groups.size(); ++i) {
    for (std::size_t j = i + 1; j < groups.size(); ++j) {
      const double a = moments[i].variance / moments[i].count;
      const double b = moments[j].variance / moments[j].count;
      const double share = a / (a + b);  // squares of variances themselves may leave a double
      const double df = 1.0 / (share * share / (moments[i].count - 1.0) +
                               (1.0 - share) * (1.0 - share) / (moments[j].count - 1.0));
      const double error = std::sqrt(0.5 * (a + b));
      pairs.push_back(compare(i, j, moments[i].mean - moments[j].mean, error, df, k));
      pairs.back().halfWidth =
          std::isnan(df) ? df : studentizedRangeQuantile(1.0 - confidence, k, df) * error;
    }
  }
  return pairs;
}

}  // namespace forewalk::agents
