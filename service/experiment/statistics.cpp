#include "service/experiment/statistics.h"

#include <fmt/format.h>

#include <algorithm>
#include <boost/math/distributions/normal.hpp>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <numeric>
#include <utility>

#include "service/timing.h"

namespace forewalk::service {
namespace {

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
constexpr std::size_t kExact = 25;  // differences; 2^25 sign patterns, counted by sums of ranks

/// Share of all 2^n sign patterns of the ranks 1 to n whose positive ranks sum to at most `sum`.
double exactShare(std::size_t n, std::size_t sum) {
  std::vector<double> ways(n * (n + 1) / 2 + 1, 0.0);
  ways[0] = 1.0;
  for (std::size_t rank = 1; rank <= n; ++rank) {
    for (std::size_t s = ways.size(); s-- > rank;) ways[s] += ways[s - rank];
  }
  const auto last = ways.begin() + static_cast<std::ptrdiff_t>(std::min(sum + 1, ways.size()));
  return std::accumulate(ways.begin(), last, 0.0) / std::pow(2.0, static_cast<double>(n));
}

double signedRank(std::vector<double> differences) {
  differences.erase(std::remove(differences.begin(), differences.end(), 0.0), differences.end());
  const std::size_t n = differences.size();
  if (n == 0) return 1.0;
  std::sort(differences.begin(), differences.end(),
            [](double a, double b) { return std::abs(a) < std::abs(b); });
  double positive = 0.0, ties = 0.0;
  for (std::size_t i = 0; i < n;) {
    std::size_t end = i + 1;
    while (end < n && std::abs(differences[end]) == std::abs(differences[i])) ++end;
    const double rank = 0.5 * static_cast<double>(i + 1 + end);  // the mean of those tied
    const auto tied = static_cast<double>(end - i);
    ties += tied * tied * tied - tied;
    for (; i < end; ++i) positive += differences[i] > 0.0 ? rank : 0.0;
  }
  const auto count = static_cast<double>(n);
  const double all = 0.5 * count * (count + 1.0);
  const double smaller = std::min(positive, all - positive);
  if (n <= kExact && ties == 0.0) {
    return std::min(1.0, 2.0 * exactShare(n, static_cast<std::size_t>(smaller)));
  }
  const double variance = count * (count + 1.0) * (2.0 * count + 1.0) / 24.0 - ties / 48.0;
  const double z = (smaller - 0.5 * all + 0.5) / std::sqrt(variance);
  return std::min(1.0, 2.0 * boost::math::cdf(boost::math::normal(), z));
}

}  // namespace

bool isIn(const ExperimentPlan& plan, const Row& row, const Selection& selection) {
  const auto chosen = plan.choicesOf(row.run);
  for (std::size_t axis = 0; axis < kAxes; ++axis) {
    const std::size_t wanted = selection.chosen[axis];
    if (wanted != Selection::kAny && wanted != chosen[axis]) return false;
  }
  return true;
}

Estimate estimate(std::span<const double> values) {
  Estimate result{values.size(), kUnknown, kUnknown, kUnknown, kUnknown};
  if (values.empty()) return result;
  const std::vector<double> copy(values.begin(), values.end());
  const auto count = static_cast<double>(values.size());
  result.mean = mean(copy);
  if (values.size() < 2) return result;
  const double error = standardError(copy);
  result.deviation = error * std::sqrt(count);
  const double reach = error * boost::math::quantile(boost::math::students_t(count - 1.0), 0.975);
  result.low = result.mean - reach;
  result.high = result.mean + reach;
  return result;
}

Comparison compare(std::span<const double> first, std::span<const double> second) {
  std::vector<double> differences(first.size());
  for (std::size_t i = 0; i < first.size(); ++i) differences[i] = second[i] - first[i];
  Comparison result;
  result.difference = estimate(differences);
  const double from = estimate(first).mean;
  result.relative = from != 0.0 ? estimate(second).mean / from - 1.0 : kUnknown;
  const Estimate& d = result.difference;
  if (d.count >= 2 && d.deviation > 0.0) {
    const auto count = static_cast<double>(d.count);
    const double t = d.mean / (d.deviation / std::sqrt(count));
    result.tTest = 2.0 * boost::math::cdf(boost::math::students_t(count - 1.0), -std::abs(t));
  }
  result.signedRank = signedRank(std::move(differences));
  return result;
}

std::vector<double> holm(std::span<const double> p) {
  std::vector<std::size_t> order(p.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return p[a] < p[b]; });
  std::vector<double> adjusted(p.size());
  double largest = 0.0;
  for (std::size_t i = 0; i < order.size(); ++i) {
    const double times = static_cast<double>(order.size() - i);
    largest = std::max(largest, std::min(1.0, times * p[order[i]]));
    adjusted[order[i]] = largest;
  }
  return adjusted;
}

std::vector<double> valuesOf(const Results& results, const Selection& selection, Metric metric) {
  std::vector<double> values;
  for (const Row& row : results.rows) {
    if (row.failed() || std::isnan(row[metric]) || !isIn(results.plan, row, selection)) continue;
    values.push_back(row[metric]);
  }
  return values;
}

Comparison compareControllers(const Results& results, const Selection& selection, std::size_t first,
                              std::size_t second, Metric metric) {
  // Rows of the second controller by what they share with one of the first.
  const auto partner = [&](const Row& row) {
    auto key = results.plan.choicesOf(row.run);
    key[static_cast<std::size_t>(Axis::kController)] = 0;
    return std::pair(key, results.plan.seedOf(row.run));
  };
  std::map<decltype(partner(Row{})), double> others;
  std::vector<double> a, b;
  for (const Row& row : results.rows) {
    if (!row.failed() && isIn(results.plan, row, selection.with(Axis::kController, second))) {
      others.emplace(partner(row), row[metric]);
    }
  }
  for (const Row& row : results.rows) {
    if (row.failed() || !isIn(results.plan, row, selection.with(Axis::kController, first)))
      continue;
    const auto other = others.find(partner(row));
    if (other == others.end()) continue;
    a.push_back(row[metric]);
    b.push_back(other->second);
  }
  return compare(a, b);
}

std::vector<Block> blocksOf(const Results& results) {
  constexpr Axis kFixed[] = {Axis::kScene, Axis::kUser, Axis::kReset, Axis::kLimits,
                             Axis::kVariant};
  std::vector<Block> blocks{{}};
  for (const Axis axis : kFixed) {
    const auto& choices = results.plan.choices[static_cast<std::size_t>(axis)];
    std::vector<Block> narrower;
    for (const Block& block : blocks) {
      for (std::size_t i = 0; i < choices.size(); ++i) {
        Block& next = narrower.emplace_back(block);
        next.selection = block.selection.with(axis, i);
        if (choices.size() == 1) continue;
        if (!next.title.empty()) next.title += ", ";
        next.title += choices[i].name;
      }
    }
    blocks = std::move(narrower);
  }
  return blocks;
}

std::string resetTable(const Results& results) {
  const auto& rooms = results.plan.choices[static_cast<std::size_t>(Axis::kRoom)];
  const auto& controllers = results.plan.choices[static_cast<std::size_t>(Axis::kController)];
  std::size_t nameWidth = 10;
  for (const Choice& controller : controllers) {
    nameWidth = std::max(nameWidth, controller.name.size());
  }
  std::string text;
  for (const Block& block : blocksOf(results)) {
    text += fmt::format("\nResets per 100 m, mean and 95 % interval{}{}\n{:<{}}",
                        block.title.empty() ? "" : ": ", block.title, "", nameWidth);
    for (const Choice& room : rooms) text += fmt::format("  {:>22}", room.name.substr(0, 22));
    text += '\n';
    for (std::size_t c = 0; c < controllers.size(); ++c) {
      text += fmt::format("{:<{}}", controllers[c].name, nameWidth);
      for (std::size_t r = 0; r < rooms.size(); ++r) {
        const Selection selection = block.selection.with(Axis::kRoom, r).with(Axis::kController, c);
        const Estimate e = estimate(valuesOf(results, selection, Metric::kResetsPer100Metres));
        const std::string shown =
            e.count == 0  ? "failed"
            : e.count < 2 ? fmt::format("{:.2f}", e.mean)
                          : fmt::format("{:.2f} [{:.2f}, {:.2f}]", e.mean, e.low, e.high);
        text += fmt::format("  {:>22}", shown);
      }
      text += '\n';
    }
  }
  return text;
}

}  // namespace forewalk::service
