#include "agents/evaluation/one_way.h"

#include <algorithm>
#include <boost/math/distributions/fisher_f.hpp>
#include <cassert>
#include <cmath>
#include <cstddef>

namespace forewalk::agents {
namespace {

namespace policies = boost::math::policies;
// Doubles throughout, for the same digits where long double is another type; NaN instead of
// throwing.
using Quiet = policies::policy<policies::promote_double<false>,
                               policies::domain_error<policies::ignore_error>,
                               policies::overflow_error<policies::ignore_error>,
                               policies::evaluation_error<policies::ignore_error>>;

double square(double value) { return value * value; }

[[maybe_unused]] bool sound(Groups groups) {
  return groups.size() >= 2 && std::all_of(groups.begin(), groups.end(),
                                           [](const auto& group) { return group.size() >= 2; });
}

FTest fTest(double statistic, double df1, double df2) {
  FTest test{statistic, df1, df2, 0.0};
  if (std::isnan(statistic) || std::isnan(df2)) {
    test.statistic = test.p = std::nan("");
  } else if (std::isfinite(statistic)) {
    const boost::math::fisher_f_distribution<double, Quiet> distribution(df1, df2);
    test.p = boost::math::cdf(boost::math::complement(distribution, statistic));
  }
  return test;
}

std::size_t observationsOf(Groups groups) {
  std::size_t count = 0;
  for (const auto& group : groups) count += group.size();
  return count;
}

double sumOfSquaresBetween(Groups groups) {
  double sum = 0.0;
  for (const auto& group : groups) {
    for (const double value : group) sum += value;
  }
  const double grandMean = sum / static_cast<double>(observationsOf(groups));
  double between = 0.0;
  for (const auto& group : groups) {
    between += static_cast<double>(group.size()) * square(meanOf(group) - grandMean);
  }
  return between;
}

double medianOf(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const std::size_t half = values.size() / 2;
  return values.size() % 2 == 1 ? values[half] : 0.5 * (values[half - 1] + values[half]);
}

}  // namespace

double meanOf(std::span<const double> values) {
  double sum = 0.0;
  for (const double value : values) sum += value;
  return sum / static_cast<double>(values.size());
}

double varianceOf(std::span<const double> values) {
  const double mean = meanOf(values);
  double sum = 0.0;
  for (const double value : values) sum += square(value - mean);
  return sum / static_cast<double>(values.size() - 1);
}

Anova anova(Groups groups) {
  assert(sound(groups));
  Anova result;
  result.between = sumOfSquaresBetween(groups);
  for (const auto& group : groups) {
    result.within += varianceOf(group) * static_cast<double>(group.size() - 1);
  }
  const double df1 = static_cast<double>(groups.size() - 1);
  const double df2 = static_cast<double>(observationsOf(groups) - groups.size());
  result.test = fTest((result.between / df1) / (result.within / df2), df1, df2);
  return result;
}

FTest levene(Groups groups, Centre centre) {
  assert(sound(groups));
  std::vector<std::vector<double>> deviations(groups.begin(), groups.end());
  for (auto& group : deviations) {
    const double middle = centre == Centre::kMean ? meanOf(group) : medianOf(group);
    for (double& value : group) value = std::abs(value - middle);
  }
  return anova(deviations).test;
}

FTest welch(Groups groups) {
  assert(sound(groups));
  const double k = static_cast<double>(groups.size());
  std::vector<double> weights;
  double weightSum = 0.0, weighted = 0.0;
  for (const auto& group : groups) {
    const double weight = static_cast<double>(group.size()) / varianceOf(group);
    weights.push_back(weight);
    weightSum += weight;
    weighted += weight * meanOf(group);
  }
  const double mean = weighted / weightSum;
  double between = 0.0, imprecision = 0.0;
  for (std::size_t i = 0; i < groups.size(); ++i) {
    between += weights[i] * square(meanOf(groups[i]) - mean);
    imprecision += square(1.0 - weights[i] / weightSum) / static_cast<double>(groups[i].size() - 1);
  }
  const double statistic =
      between / (k - 1.0) / (1.0 + 2.0 * (k - 2.0) / (k * k - 1.0) * imprecision);
  return fTest(statistic, k - 1.0, (k * k - 1.0) / (3.0 * imprecision));
}

FTest brownForsythe(Groups groups) {
  assert(sound(groups));
  const double all = static_cast<double>(observationsOf(groups));
  double total = 0.0;
  std::vector<double> parts;
  for (const auto& group : groups) {
    parts.push_back((1.0 - static_cast<double>(group.size()) / all) * varianceOf(group));
    total += parts.back();
  }
  double inverse = 0.0;  // of the degrees of freedom
  for (std::size_t i = 0; i < groups.size(); ++i) {
    inverse += square(parts[i] / total) / static_cast<double>(groups[i].size() - 1);
  }
  const double df1 = static_cast<double>(groups.size() - 1);
  const double between = sumOfSquaresBetween(groups);
  FTest test = fTest(between / total, df1, 1.0 / inverse);
  if (total == 0.0 && between > 0.0) test = {between / total, df1, std::nan(""), 0.0};
  return test;
}

}  // namespace forewalk::agents
