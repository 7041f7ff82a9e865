#include "service/evaluation.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "navmesh/random.h"
#include "service/timing.h"

namespace forewalk::service {

namespace {

using prediction::LikelihoodParameters;

constexpr double kPi = 3.14159265358979323846;
const double kForward = std::cos(100.0 * kPi / 180.0);
constexpr std::size_t kAtThree = 3;  // kSecondsAhead: 3.2 s
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// A sample ready to be judged.
struct Case {
  const Sample* sample;
  std::size_t walker;
  bool settled, contained, junction, forward;
  glm::dvec2 plan, velocity, heading;
  std::vector<bool> open;      // ways that can be taken at all
  std::vector<double> cosine;  // of the deviation
  std::vector<double> likelihood;
  double none;
};

bool canBeTaken(const prediction::WayFacts& way) {
  return !way.deadEnd || way.distance >= prediction::kArrived;
}

void addCases(const RecordedWalk& walk, std::size_t walker, const LikelihoodParameters& parameters,
              std::vector<Case>& cases) {
  replay(walk, parameters,
         [&](const Sample& sample, std::span<const double> probabilities, double none) {
           const RecordedFrame& frame = walk.frames[sample.frame];
           const auto ways = walk.waysOf(frame);
           Case one{&sample,
                    walker,
                    sample.outcome != Outcome::kUnsettled,
                    sample.outcome == Outcome::kTaken,
                    false,
                    false,
                    frame.plan,
                    frame.velocity,
                    frame.walked.direction,
                    {},
                    {},
                    {probabilities.begin(), probabilities.end()},
                    none};
           std::size_t open = 0, ahead = 0;
           for (std::size_t i = 0; i < ways.size(); ++i) {
             one.open.push_back(canBeTaken(ways[i]));
             one.cosine.push_back(glm::dot(one.heading, sample.toEnd[i]));
             if (!one.open[i]) continue;
             ++open;
             ahead += one.cosine[i] >= kForward;
           }
           one.junction = one.contained && open >= 2;
           one.forward = one.junction && ahead >= 2 && glm::length(one.heading) > 0.5;
           cases.push_back(std::move(one));
         });
}

std::vector<double> softmax(const Case& one, double concentration) {
  std::vector<double> p(one.open.size(), 0.0);
  double sum = 0.0;
  for (std::size_t i = 0; i < p.size(); ++i) {
    if (one.open[i]) sum += p[i] = std::exp(concentration * (one.cosine[i] - 1.0));
  }
  for (double& value : p) value /= sum;
  return p;
}

std::vector<double> probabilitiesOf(const Case& one, Guess guess, double cosine) {
  switch (guess) {
    case Guess::kUniform:
      return softmax(one, 0.0);
    case Guess::kCosine:
      return softmax(one, cosine);
    case Guess::kLeastDeviation: {
      std::vector<double> p(one.open.size(), 0.0);
      std::size_t best = 0;
      double most = -2.0;
      for (std::size_t i = 0; i < p.size(); ++i) {
        if (one.open[i] && one.cosine[i] > most) {
          most = one.cosine[i];
          best = i;
        }
      }
      p[best] = 1.0;
      return p;
    }
    case Guess::kLikelihood: {
      // The others cannot say "none of these": ways are compared where one of them was taken.
      std::vector<double> p = one.likelihood;
      for (double& value : p) value /= std::max(1e-12, 1.0 - one.none);
      return p;
    }
    case Guess::kConstantVelocity:
      break;
  }
  return {};
}

/// The chance that the way taken is among the first k by probability, ties drawn by lot.
double amongFirst(const std::vector<double>& p, std::size_t taken, double k) {
  double before = 0.0, same = 0.0;
  for (const double other : p) {
    before += other > p[taken];
    same += other == p[taken];
  }
  return std::clamp((k - before) / same, 0.0, 1.0);
}

/// What one guess says of one sample.
struct Score {
  double nll = 0.0, brier = 0.0, top1 = 0.0, top3 = 0.0;
};

Score scoreOf(const Case& one, const std::vector<double>& p) {
  Score score;
  const std::size_t taken = one.sample->taken;
  score.nll = -std::log(p[taken]);
  for (std::size_t i = 0; i < p.size(); ++i) {
    const double off = p[i] - (i == taken ? 1.0 : 0.0);
    score.brier += off * off;
  }
  score.top1 = amongFirst(p, taken, 1.0);
  score.top3 = amongFirst(p, taken, 3.0);
  return score;
}

struct ScoreSum {
  Score sum;
  std::size_t count = 0;
  void add(const Score& score) {
    sum.nll += score.nll;
    sum.brier += score.brier;
    sum.top1 += score.top1;
    sum.top3 += score.top3;
    ++count;
  }
  Scores mean() const {
    if (count == 0) return {0, kNaN, kNaN, kNaN, kNaN};
    const auto n = static_cast<double>(count);
    return {count, sum.nll / n, sum.brier / n, sum.top1 / n, sum.top3 / n};
  }
};

enum Sector { kAhead, kLeft, kRight, kBehind, kSectors };
Sector sectorOf(const Case& one, std::size_t way) {
  const double cosine = one.cosine[way];
  if (cosine > std::cos(kPi / 4)) return kAhead;
  if (cosine < -std::cos(kPi / 4)) return kBehind;
  const glm::dvec2 to = one.sample->toEnd[way];
  return one.heading.x * to.y - one.heading.y * to.x > 0.0 ? kLeft : kRight;
}

using Bins = std::array<ReliabilityBin, kReliabilityBins>;

void addTo(Bins& bins, double said, bool came) {
  const auto at = std::min(kReliabilityBins - 1, static_cast<std::size_t>(said * kReliabilityBins));
  ++bins[at].count;
  bins[at].said += said;
  bins[at].came += came ? 1.0 : 0.0;
}

double calibrationError(const Bins& sums) {
  double off = 0.0, count = 0.0;
  for (const ReliabilityBin& bin : sums) {
    off += std::abs(bin.said - bin.came);
    count += static_cast<double>(bin.count);
  }
  return count > 0.0 ? off / count : kNaN;
}

/// Sums per walker of a paired difference, and the interval of its mean over walkers drawn anew.
struct Paired {
  std::vector<double> sum;
  std::vector<double> count;
};

double quantileOf(std::vector<double>& sorted, double q) {
  return sorted[static_cast<std::size_t>(q * static_cast<double>(sorted.size() - 1) + 0.5)];
}

Interval intervalOf(const Paired& paired, std::uint64_t seed) {
  constexpr int kDraws = 4000;
  const std::size_t walkers = paired.sum.size();
  double total = 0.0, count = 0.0;
  for (std::size_t w = 0; w < walkers; ++w) {
    total += paired.sum[w];
    count += paired.count[w];
  }
  if (count == 0.0 || !std::isfinite(total)) return {total / count, kNaN, kNaN};
  std::mt19937_64 rng(seed);
  std::vector<double> means;
  means.reserve(kDraws);
  for (int draw = 0; draw < kDraws; ++draw) {
    double s = 0.0, n = 0.0;
    for (std::size_t w = 0; w < walkers; ++w) {
      const auto drawn =
          static_cast<std::size_t>(navmesh::uniformInt(rng, static_cast<int>(walkers)));
      s += paired.sum[drawn];
      n += paired.count[drawn];
    }
    if (n > 0.0) means.push_back(s / n);
  }
  std::sort(means.begin(), means.end());
  return {total / count, quantileOf(means, 0.025), quantileOf(means, 0.975)};
}

/// Where a guess without a filter thinks that the walker will be: on the way at the walker's speed.
glm::dvec2 placeAfter(const Case& one, Guess guess, const std::vector<double>& p, double seconds,
                      const LikelihoodParameters& parameters) {
  const auto along = [&](std::size_t i, double s) { return alongPath(one.sample->paths[i], s); };
  if (guess == Guess::kConstantVelocity) return one.plan + seconds * one.velocity;
  if (guess == Guess::kLikelihood) {
    return prediction::expectedPlace(one.plan, one.velocity, one.likelihood, one.none, seconds,
                                     parameters, along);
  }
  return prediction::expectedPlaceAt(one.plan, one.heading, p, 0.0,
                                     glm::length(one.velocity) * seconds, along);
}

glm::dvec2 placeAlong(const Case& one, Guess guess, const std::vector<double>& p, double metres) {
  if (guess == Guess::kConstantVelocity) return one.plan + metres * one.heading;
  const bool ours = guess == Guess::kLikelihood;
  return prediction::expectedPlaceAt(
      one.plan, one.heading, ours ? one.likelihood : p, ours ? one.none : 0.0, metres,
      [&](std::size_t i, double s) { return alongPath(one.sample->paths[i], s); });
}

}  // namespace

const char* nameOf(Guess guess) {
  switch (guess) {
    case Guess::kUniform:
      return "uniform";
    case Guess::kLeastDeviation:
      return "least deviation";
    case Guess::kCosine:
      return "softmax of cosine";
    case Guess::kConstantVelocity:
      return "constant velocity";
    case Guess::kLikelihood:
      return "likelihood";
  }
  return "";
}

double fitCosine(std::span<const RecordedWalk* const> walks) {
  std::vector<Case> cases;
  for (const RecordedWalk* walk : walks) addCases(*walk, 0, {}, cases);
  const auto nll = [&](std::span<const double> at) {
    double sum = 0.0;
    for (const Case& one : cases) {
      if (one.forward) sum -= std::log(softmax(one, std::exp(at[0]))[one.sample->taken] + 1e-12);
    }
    return sum / static_cast<double>(cases.size());
  };
  return cases.empty() ? 1.0 : std::exp(minimise(nll, {0.0}, 0.5, 60).at[0]);
}

PredictionQuality qualityOf(const RecordedWalk& walk, const LikelihoodParameters& parameters) {
  std::vector<Case> cases;
  addCases(walk, 0, parameters, cases);
  PredictionQuality quality;
  for (const Case& one : cases) {
    quality.settled += one.settled;
    quality.contained += one.contained;
    if (!one.junction) continue;
    ++quality.junctions;
    const std::vector<double> p = probabilitiesOf(one, Guess::kLikelihood, 0.0);
    const Score score = scoreOf(one, p);
    quality.nll += score.nll;
    quality.first += score.top1;
    double before = 0.0, same = 0.0;
    for (const double other : p) {
      before += other > p[one.sample->taken];
      same += other == p[one.sample->taken];
    }
    quality.rank += before + 0.5 * (same + 1.0);
  }
  if (quality.junctions > 0) {
    const auto count = static_cast<double>(quality.junctions);
    quality.nll /= count;
    quality.first /= count;
    quality.rank /= count;
  }
  return quality;
}

Evaluation evaluate(std::span<const RecordedWalk> walks, const EvaluationModels& models,
                    float horizon, std::uint64_t seed) {
  Evaluation evaluation;
  evaluation.horizon = horizon;
  std::vector<Case> cases;
  for (std::size_t w = 0; w < walks.size(); ++w) {
    addCases(walks[w], w, models.likelihood[w], cases);
    evaluation.walkers.push_back(walks[w].walker);
    evaluation.frames += walks[w].frames.size();
    evaluation.offMesh += walks[w].offMesh;
    evaluation.snapped += walks[w].snapped;
    evaluation.worstSnap = std::max(evaluation.worstSnap, walks[w].worstSnap);
    evaluation.turnover += walks[w].turnover;
  }
  std::size_t settled = 0, behind = 0;
  for (const Case& one : cases) {
    ++evaluation.samples;
    evaluation.unsettled += !one.settled;
    evaluation.contained += one.contained;
    evaluation.junctions += one.junction;
    evaluation.forwardJunctions += one.forward;
    if (one.settled) {
      ++settled;
      evaluation.noneSaid += one.none;
    }
    if (one.contained) behind += one.cosine[one.sample->taken] < 0.0;
  }
  if (settled > 0) evaluation.noneSaid /= static_cast<double>(settled);
  if (evaluation.contained > 0) {
    evaluation.behind = static_cast<double>(behind) / static_cast<double>(evaluation.contained);
  }

  const std::size_t count = walks.size();
  const std::vector<double> zeros(count, 0.0);
  struct PerWalker {
    std::vector<ScoreSum> forward;
    std::vector<double> finalSum, finalCount;
  };
  std::vector<PerWalker> perWalker;
  for (const Guess guess : kGuesses) {
    GuessReport report{};
    report.guess = guess;
    PerWalker of{std::vector<ScoreSum>(count), zeros, zeros};
    ScoreSum forward, all;
    Bins bins{};
    std::array<Bins, kSectors> sectors{};
    std::array<std::vector<double>, kSecondsAhead.size()> after;
    std::array<std::vector<double>, kSecondsAhead.size()> averages;
    std::array<std::vector<double>, kMetresAhead.size()> along;
    for (const Case& one : cases) {
      const std::vector<double> p = probabilitiesOf(one, guess, models.cosine[one.walker]);
      double sum = 0.0;
      for (std::size_t t = 0; t < one.sample->afterKnown; ++t) {
        const double off = glm::distance(
            placeAfter(one, guess, p, kSecondsAhead[t], models.likelihood[one.walker]),
            one.sample->after[t]);
        sum += off;
        after[t].push_back(off);
        averages[t].push_back(sum / static_cast<double>(t + 1));
        if (t == kAtThree) {
          of.finalSum[one.walker] += off;
          of.finalCount[one.walker] += 1.0;
        }
      }
      for (std::size_t m = 0; m < one.sample->alongKnown; ++m) {
        along[m].push_back(
            glm::distance(placeAlong(one, guess, p, kMetresAhead[m]), one.sample->along[m]));
      }
      if (!one.junction || guess == Guess::kConstantVelocity) continue;
      const Score score = scoreOf(one, p);
      all.add(score);
      for (std::size_t i = 0; i < p.size(); ++i) {
        if (!one.open[i]) continue;
        addTo(bins, p[i], i == one.sample->taken);
        addTo(sectors[sectorOf(one, i)], p[i], i == one.sample->taken);
      }
      if (!one.forward) continue;
      forward.add(score);
      of.forward[one.walker].add(score);
    }
    report.forward = forward.mean();
    report.all = all.mean();
    for (const ScoreSum& sum : of.forward) report.forwardOfWalker.push_back(sum.mean());
    report.calibration = calibrationError(bins);
    for (const Bins& sector : sectors)
      report.classCalibration += calibrationError(sector) / static_cast<double>(kSectors);
    for (std::size_t b = 0; b < kReliabilityBins; ++b) {
      ReliabilityBin bin = bins[b];
      const double n = std::max(1.0, static_cast<double>(bin.count));
      report.reliability[b] = {bin.count, bin.said / n, bin.came / n};
    }
    for (std::size_t t = 0; t < kSecondsAhead.size(); ++t) {
      report.places.final[t] = mean(after[t]);
      report.places.average[t] = mean(averages[t]);
    }
    for (std::size_t m = 0; m < kMetresAhead.size(); ++m) {
      report.places.along[m] = mean(along[m]);
      report.places.alongMedian[m] = quantile(along[m], 0.5);
    }
    evaluation.guesses.push_back(std::move(report));
    perWalker.push_back(std::move(of));
  }
  const PerWalker& ours = perWalker.back();
  for (std::size_t g = 0; g < kGuesses.size(); ++g) {
    Paired nll{zeros, zeros}, top1{zeros, zeros}, final{zeros, zeros};
    for (std::size_t w = 0; w < count; ++w) {
      const ScoreSum& a = ours.forward[w];
      const ScoreSum& b = perWalker[g].forward[w];
      nll.sum[w] = a.sum.nll - b.sum.nll;
      top1.sum[w] = a.sum.top1 - b.sum.top1;
      nll.count[w] = top1.count[w] = static_cast<double>(b.count);
      final.sum[w] = ours.finalSum[w] - perWalker[g].finalSum[w];
      final.count[w] = ours.finalCount[w];
    }
    evaluation.guesses[g].nllDifference = intervalOf(nll, seed);
    evaluation.guesses[g].top1Difference = intervalOf(top1, seed);
    evaluation.guesses[g].finalDifference = intervalOf(final, seed);
  }
  return evaluation;
}

}  // namespace forewalk::service
