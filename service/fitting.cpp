#include "service/fitting.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

namespace forewalk::service {

namespace {

using prediction::LikelihoodParameters;
using P = LikelihoodParameters;
using Scale = ParameterInfo::Scale;

constexpr ParameterInfo kParameters[] = {
    {"concentration", &P::concentration, Scale::kLog, 0.0, 1000.0, 1.0},
    {"far_share", &P::farShare, Scale::kLogit, 0.0, 1.0, 1.0},
    {"turns_round", &P::turnsRound, Scale::kLogit, 1e-6, 1.0, 1.0},
    {"forget_metres", &P::forgetMetres, Scale::kLog, 1e-3, 1000.0, 0.7},
    {"forget_seconds", &P::forgetSeconds, Scale::kLog, 1e-3, 1e6, 0.5},
    {"steady", &P::steady, Scale::kLog, 1e-6, 1000.0, 0.7},
    {"branch_split", &P::branchSplit, Scale::kLogit, 0.0, 1.0, 1.0},
    {"dead_end", &P::deadEnd, Scale::kPlain, -100.0, 100.0, 1.0},
    {"retrace", &P::retrace, Scale::kPlain, -100.0, 100.0, 1.0},
    {"revisit", &P::revisit, Scale::kPlain, -100.0, 100.0, 1.0},
    {"none_share", &P::noneShare, Scale::kLogit, 1e-9, 0.999, 1.0},
    {"head", &P::head, Scale::kLog, 0.0, 1000.0, 0.0},
    {"gaze", &P::gaze, Scale::kLog, 0.0, 1000.0, 0.0},
    {"look_seconds", &P::lookSeconds, Scale::kLog, 1e-3, 1000.0, 0.0},
    {"pace_memory", &P::paceMemory, Scale::kLog, 1e-3, 1000.0, 0.0},
    {"cruise", &P::cruise, Scale::kLog, 0.0, 20.0, 0.0},
    {"inertia", &P::inertia, Scale::kLog, 1e-3, 100.0, 0.0},
};
constexpr double LikelihoodParameters::*kMotion[] = {&P::paceMemory, &P::cruise, &P::inertia};

double outward(Scale scale, double value) {
  constexpr double kEdge = 1e-9;
  if (scale == Scale::kLog) return std::log(std::max(value, kEdge));
  if (scale == Scale::kPlain) return value;
  value = std::clamp(value, kEdge, 1.0 - kEdge);
  return std::log(value / (1.0 - value));
}

double inward(const ParameterInfo& info, double coordinate) {
  double value = coordinate;
  if (info.scale == Scale::kLog) value = std::exp(coordinate);
  if (info.scale == Scale::kLogit) value = 1.0 / (1.0 + std::exp(-coordinate));
  return std::clamp(value, info.low, info.high);
}

std::vector<double> simplexOnce(const std::function<double(std::span<const double>)>& f,
                                std::vector<double> start, double step, int& budget,
                                double& value) {
  const std::size_t n = start.size();
  std::vector<std::vector<double>> points(n + 1, start);
  std::vector<double> values(n + 1);
  const auto ask = [&](const std::vector<double>& at) {
    --budget;
    const double v = f(at);
    return std::isnan(v) ? std::numeric_limits<double>::infinity() : v;
  };
  for (std::size_t i = 0; i < n; ++i) points[i + 1][i] += step;
  for (std::size_t i = 0; i <= n; ++i) values[i] = ask(points[i]);
  std::vector<std::size_t> order(n + 1);
  while (budget > 0) {
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return values[a] < values[b]; });
    const std::size_t best = order[0], worst = order[n], second = order[n - 1];
    if (values[worst] - values[best] < 1e-6 * (1.0 + std::abs(values[best]))) break;
    std::vector<double> centre(n, 0.0);
    for (std::size_t i = 0; i <= n; ++i) {
      if (i == worst) continue;
      for (std::size_t k = 0; k < n; ++k) centre[k] += points[i][k] / static_cast<double>(n);
    }
    const auto beyond = [&](double factor) {
      std::vector<double> at(n);
      for (std::size_t k = 0; k < n; ++k) {
        at[k] = centre[k] + factor * (points[worst][k] - centre[k]);
      }
      return at;
    };
    std::vector<double> reflected = beyond(-1.0);
    double asked = ask(reflected);
    if (asked < values[best]) {
      std::vector<double> expanded = beyond(-2.0);
      const double further = ask(expanded);
      if (further < asked) {
        reflected = std::move(expanded);
        asked = further;
      }
    } else if (asked >= values[second]) {
      std::vector<double> inside = beyond(asked < values[worst] ? -0.5 : 0.5);
      const double nearer = ask(inside);
      if (nearer >= std::min(asked, values[worst])) {
        for (std::size_t i = 0; i <= n; ++i) {
          if (i == best) continue;
          for (std::size_t k = 0; k < n; ++k) {
            points[i][k] = 0.5 * (points[i][k] + points[best][k]);
          }
          values[i] = ask(points[i]);
        }
        continue;
      }
      reflected = std::move(inside);
      asked = nearer;
    }
    points[worst] = std::move(reflected);
    values[worst] = asked;
  }
  const auto best = std::min_element(values.begin(), values.end()) - values.begin();
  value = values[static_cast<std::size_t>(best)];
  return points[static_cast<std::size_t>(best)];
}

struct Likelihoods {
  double nll = 0.0;
  std::size_t samples = 0;
};

Likelihoods likelihoodsOf(std::span<const RecordedWalk* const> walks,
                          const LikelihoodParameters& parameters) {
  Likelihoods sum;
  for (const RecordedWalk* walk : walks) {
    replay(*walk, parameters,
           [&](const Sample& sample, std::span<const double> probabilities, double none) {
             if (probabilities.size() < 2 || sample.outcome == Outcome::kUnsettled) return;
             const double p =
                 sample.outcome == Outcome::kTaken ? probabilities[sample.taken] : none;
             sum.nll -= std::log(std::max(p, 1e-12));
             ++sum.samples;
           });
  }
  return sum;
}

/// What places ahead need, once the ways' probabilities are settled.
struct Ahead {
  const Sample* sample;
  glm::dvec2 plan, velocity;
  std::vector<double> probabilities;
  double none;
};

double displacementOf(const std::vector<Ahead>& all, const LikelihoodParameters& parameters) {
  double sum = 0.0;
  std::size_t count = 0;
  for (const Ahead& ahead : all) {
    for (std::size_t t = 0; t < ahead.sample->afterKnown; ++t) {
      const glm::dvec2 place = prediction::expectedPlace(
          ahead.plan, ahead.velocity, ahead.probabilities, ahead.none, kSecondsAhead[t], parameters,
          [&](std::size_t i, double s) { return alongPath(ahead.sample->paths[i], s); });
      sum += glm::distance(place, ahead.sample->after[t]);
      ++count;
    }
  }
  return count > 0 ? sum / static_cast<double>(count) : 0.0;
}

}  // namespace

LikelihoodParameters unfittedParameters() {
  LikelihoodParameters p;
  p.concentration = 2.0;
  p.farShare = 0.5;
  p.turnsRound = 0.05;
  p.forgetMetres = 0.7;
  p.forgetSeconds = 20.0;
  p.steady = 0.5;
  p.branchSplit = 0.5;
  p.deadEnd = 0.0;
  p.retrace = 0.0;
  p.revisit = 0.0;
  p.noneShare = 0.02;
  p.paceMemory = 1.5;
  p.cruise = 0.4;
  p.inertia = 0.5;
  return p;
}

std::span<const ParameterInfo> parameterInfos() { return kParameters; }

Minimum minimise(const std::function<double(std::span<const double>)>& f, std::vector<double> start,
                 double step, int budget) {
  Minimum minimum{std::move(start), std::numeric_limits<double>::infinity()};
  while (budget > 0) {
    double value;
    std::vector<double> at = simplexOnce(f, minimum.at, step, budget, value);
    const bool gained = value < minimum.value - 1e-4 * (1.0 + std::abs(minimum.value));
    if (value < minimum.value) minimum = {std::move(at), value};
    if (!gained) break;
    step *= 0.5;
  }
  return minimum;
}

void replay(const RecordedWalk& walk, const LikelihoodParameters& parameters,
            const std::function<void(const Sample&, std::span<const double>, double)>& visit) {
  std::size_t most = 0;
  for (const RecordedFrame& frame : walk.frames) most = std::max(most, frame.wayCount);
  prediction::WayFilter filter(most);
  std::size_t next = 0;
  for (std::size_t f = 0; f < walk.frames.size() && next < walk.samples.size(); ++f) {
    filter.step(walk.waysOf(walk.frames[f]), walk.frames[f].walked, parameters);
    if (walk.samples[next].frame == f) {
      visit(walk.samples[next++], filter.probabilities(), filter.none());
    }
  }
}

Fit fitLikelihood(std::span<const RecordedWalk* const> walks, const FitSettings& settings) {
  std::vector<const ParameterInfo*> fitted;
  std::vector<double> centre;
  for (const ParameterInfo& info : kParameters) {
    if (info.spread == 0.0) continue;
    fitted.push_back(&info);
    centre.push_back(outward(info.scale, settings.start.*info.member));
  }
  const auto parametersAt = [&](std::span<const double> at) {
    LikelihoodParameters parameters = settings.start;
    for (std::size_t i = 0; i < fitted.size(); ++i) {
      parameters.*fitted[i]->member = inward(*fitted[i], at[i]);
    }
    return parameters;
  };
  const Minimum ways = minimise(
      [&](std::span<const double> at) {
        const Likelihoods sum = likelihoodsOf(walks, parametersAt(at));
        double pull = 0.0;
        for (std::size_t i = 0; i < fitted.size(); ++i) {
          const double off = (at[i] - centre[i]) / fitted[i]->spread;
          pull += 0.5 * off * off;
        }
        const double samples = static_cast<double>(std::max<std::size_t>(1, sum.samples));
        return (sum.nll + settings.pull * pull) / samples;
      },
      centre, 0.5, settings.budget);
  Fit fit;
  fit.parameters = parametersAt(ways.at);
  const Likelihoods sum = likelihoodsOf(walks, fit.parameters);
  fit.samples = sum.samples;
  fit.nll = sum.nll / static_cast<double>(std::max<std::size_t>(1, sum.samples));

  std::vector<Ahead> ahead;
  for (const bool all : {false, true}) {
    for (const RecordedWalk* walk : walks) {
      replay(*walk, fit.parameters,
             [&](const Sample& sample, std::span<const double> probabilities, double none) {
               double longest = 0.0;
               const RecordedFrame& frame = walk->frames[sample.frame];
               for (const prediction::WayFacts& way : walk->waysOf(frame)) {
                 longest = std::max(longest, way.distance);
               }
               if (!all && longest < 4.9) return;
               ahead.push_back({&sample,
                                frame.plan,
                                frame.velocity,
                                {probabilities.begin(), probabilities.end()},
                                none});
             });
    }
    if (!ahead.empty()) break;
  }
  std::vector<double> motion;
  for (const auto member : kMotion) motion.push_back(outward(Scale::kLog, fit.parameters.*member));
  const auto withMotion = [&](std::span<const double> at) {
    LikelihoodParameters parameters = fit.parameters;
    for (std::size_t i = 0; i < std::size(kMotion); ++i) {
      parameters.*kMotion[i] = std::clamp(std::exp(at[i]), 1e-3, 20.0);
    }
    return parameters;
  };
  const Minimum best =
      minimise([&](std::span<const double> at) { return displacementOf(ahead, withMotion(at)); },
               motion, 0.3, 200);
  fit.parameters = withMotion(best.at);
  fit.displacement = best.value;
  return fit;
}

}  // namespace forewalk::service
