#include "agents/evaluation/studentized_range.h"

#include <algorithm>
#include <array>
#include <boost/math/tools/toms748_solve.hpp>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numbers>
#include <utility>

namespace forewalk::agents {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kManyDegrees = 1e10;  // from here on the limit is nearer than rounding

enum class Side { kBelow, kAbove };

// Nodes of the inner integral: beyond +-9 phi is below 1e-18.
constexpr double kNodeStep = 0.125;
constexpr double kNodeEnd = 9.0;
constexpr std::size_t kNodes = 1 + static_cast<std::size_t>(2 * kNodeEnd / kNodeStep);

double normalBelow(double z) { return 0.5 * std::erfc(-z * (1.0 / std::numbers::sqrt2)); }

struct Node {
  double z, density, below;
};

const std::array<Node, kNodes>& nodes() {
  static const std::array<Node, kNodes> all = [] {
    std::array<Node, kNodes> made{};
    for (std::size_t i = 0; i < kNodes; ++i) {
      const double z = -kNodeEnd + kNodeStep * static_cast<double>(i);
      const double density =
          std::exp(-0.5 * z * z) * std::numbers::inv_sqrtpi / std::numbers::sqrt2;
      made[i] = {z, density, normalBelow(z)};
    }
    return made;
  }();
  return all;
}

double power(double base, int exponent) {
  double result = 1.0;
  for (; exponent > 0; exponent >>= 1, base *= base) {
    if (exponent & 1) result *= base;
  }
  return result;
}

// W(w), or 1 - W(w) as an integral of its own, which keeps its digits where it is small: the
// integrand is that of W(infinity) = 1 times what the finite w takes away.
double rangeProbability(Side side, double w, int k) {
  double sum = 0.0;
  for (const Node& node : nodes()) {
    if (side == Side::kBelow) {
      sum += node.density * power(node.below - normalBelow(node.z - w), k - 1);
    } else {
      const double share = normalBelow(node.z - w) / node.below;
      if (share >= 1.0) {
        sum += node.density * power(node.below, k - 1);
      } else if (share > 0.0) {
        sum -= node.density * power(node.below, k - 1) *
               std::expm1(static_cast<double>(k - 1) * std::log1p(-share));
      }
    }
  }
  return std::clamp(sum * kNodeStep * k, 0.0, 1.0);
}

double probability(Side side, double q, int k, double df) {
  assert(k >= 2 && k <= 1000 && df > 0.0 && !std::isnan(q));
  if (!(q > 0.0)) return side == Side::kBelow ? 0.0 : 1.0;
  if (q == kInfinity) return side == Side::kBelow ? 1.0 : 0.0;
  if (df >= kManyDegrees) return rangeProbability(side, q, k);

  // ln of the density of t = ln s, less its maximum (at 0).
  const auto logWeight = [df](double t) { return df * (t - 0.5 * std::expm1(2.0 * t)); };
  // The density is about normal with deviation 1 / sqrt(2 df) where df is large. Where it is small,
  // the strip of analyticity (pi / 4 to either side) bounds the step, and the rise of W, which is
  // the steeper the larger k. The constants leave 1e-13 (a half and a quarter of the steps agree).
  const double step =
      std::min({0.12, 0.2 / std::log(static_cast<double>(k)), 0.45 / std::sqrt(2.0 * df)});
  constexpr double kNegligible = -41.0;  // ln of 1.6e-18
  double weights = 0.0, sum = 0.0;
  const auto add = [&](double t) {
    const double log = logWeight(t);
    const double weight = std::exp(log);
    const double w = q * std::exp(t);
    weights += weight;
    // W(w) < k^2 w^(k-1): far to the left it is nothing, beside 1 or times the weight.
    const double below = 2.0 * std::log(k) + (k - 1) * std::log(w);
    double inner;
    if (side == Side::kBelow) {
      inner = log + below < kNegligible ? 0.0 : rangeProbability(side, w, k);
    } else {
      inner = below < kNegligible ? 1.0 : rangeProbability(side, w, k);
    }
    sum += weight * inner;
    // A small tail is made of small s: on for as long as something comes.
    return log > kNegligible || weight * inner > 1e-18 * sum;
  };
  add(0.0);
  for (std::int64_t i = 1; add(step * static_cast<double>(i)); ++i) {
  }
  for (std::int64_t i = -1; add(step * static_cast<double>(i)); --i) {
  }
  return std::clamp(sum / weights, 0.0, 1.0);
}

}  // namespace

double studentizedRangeBelow(double q, int k, double df) {
  return probability(Side::kBelow, q, k, df);
}

double studentizedRangeAbove(double q, int k, double df) {
  const double above = 1.0 - probability(Side::kBelow, q, k, df);
  // Below that, the difference has lost digits; the other integral is dearer.
  return above > 1e-2 ? above : probability(Side::kAbove, q, k, df);
}

double studentizedRangeQuantile(double p, int k, double df) {
  assert(p > 0.0 && p < 1.0);
  // In ln q against ln P(above), tails are nearly straight whatever df.
  const auto miss = [&](double logQ) {
    return std::log(studentizedRangeAbove(std::exp(logQ), k, df)) - std::log(p);
  };
  double low = std::log(3.0), high = low + 0.25;
  double missLow = miss(low), missHigh = miss(high);
  for (double step = 0.5; missLow <= 0.0; step *= 2.0) {
    high = std::exchange(low, low - step);
    missHigh = std::exchange(missLow, miss(low));
  }
  for (double step = 0.5; missHigh > 0.0; step *= 2.0) {
    low = std::exchange(high, high + step);
    missLow = std::exchange(missHigh, miss(high));
  }
  std::uintmax_t most = 100;
  const auto [from, to] = boost::math::tools::toms748_solve(
      miss, low, high, missLow, missHigh,
      [](double a, double b) { return std::abs(b - a) < 1e-11; }, most);
  return std::exp(0.5 * (from + to));
}

}  // namespace forewalk::agents
