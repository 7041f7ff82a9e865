// Judges predictions by recorded walks: which way was taken, and where the walker came to be.
//
// Proper scores (negative log-likelihood, Brier 1950), top-k, calibration (Guo et al., ICML 2017;
// class-wise as in Kull et al., NeurIPS 2019), displacement errors as in pedestrian forecasting
// (Alahi et al., CVPR 2016), and paired bootstrap intervals over walkers, for samples of one walk
// are not independent.
#pragma once

#include <array>
#include <span>
#include <string>
#include <vector>

#include "service/fitting.h"
#include "service/recording.h"

namespace forewalk::service {

/// What is compared. Constant velocity has no ways, only places.
enum class Guess { kUniform, kLeastDeviation, kCosine, kConstantVelocity, kLikelihood };
inline constexpr std::array<Guess, 5> kGuesses{Guess::kUniform, Guess::kLeastDeviation,
                                               Guess::kCosine, Guess::kConstantVelocity,
                                               Guess::kLikelihood};
const char* nameOf(Guess guess);

/// Scores of one guess on one set of samples; means, NaN where there is nothing to score.
struct Scores {
  std::size_t samples = 0;
  double nll = 0.0;               ///< nats; infinite where a way taken was given no chance
  double brier = 0.0;             ///< sum of squares over the ways
  double top1 = 0.0, top3 = 0.0;  ///< shares; ties count by their share
};

struct Displacements {
  std::array<double, kSecondsAhead.size()> final{};    ///< mean distance off then, metres
  std::array<double, kSecondsAhead.size()> average{};  ///< mean over the times up to then
  std::array<double, kMetresAhead.size()> along{};     ///< mean at metres of the walk ahead
  std::array<double, kMetresAhead.size()> alongMedian{};
};

/// A bar of the reliability diagram.
struct ReliabilityBin {
  std::size_t count = 0;
  double said = 0.0, came = 0.0;  ///< means: probability, share that was taken
};
inline constexpr std::size_t kReliabilityBins = 10;

/// An interval of a paired difference, likelihood minus another guess.
struct Interval {
  double mean = 0.0, low = 0.0, high = 0.0;  ///< 2.5 and 97.5 percent
};

struct GuessReport {
  Guess guess;
  Scores forward, all;  ///< junctions: with two ways within 100 degrees of the heading; with two
  std::vector<Scores> forwardOfWalker;
  Displacements places;
  double calibration = 0.0;       ///< expected calibration error over all ways of all junctions
  double classCalibration = 0.0;  ///< mean of those of ways ahead, left, right and behind
  std::array<ReliabilityBin, kReliabilityBins> reliability{};
  Interval nllDifference, top1Difference;  ///< forward junctions; of the likelihood against this
  Interval finalDifference;                ///< at 3.2 s
};

struct Evaluation {
  float horizon = 0.0f;
  std::vector<std::string> walkers;
  std::size_t samples = 0, unsettled = 0, contained = 0;  ///< contained: of the settled ones
  std::size_t junctions = 0, forwardJunctions = 0;        ///< contained and with two ways
  double behind = 0.0;    ///< share of ways taken more than 90 degrees off the heading
  double noneSaid = 0.0;  ///< mean probability of none of the ways, settled samples
  std::size_t frames = 0, offMesh = 0, snapped = 0;
  double worstSnap = 0.0;  ///< metres
  WayTurnover turnover;
  bool folds = false;  ///< each walker by parameters fitted without them
  std::vector<GuessReport> guesses;
};

/// Parameters per walk, in order: one for all, or a fold's each. `cosine` is the concentration of
/// the softmax of the cosine, likewise.
struct EvaluationModels {
  std::vector<prediction::LikelihoodParameters> likelihood;
  std::vector<double> cosine;
};

/// The concentration of the softmax of the cosine of the deviation that fits these walks best.
double fitCosine(std::span<const RecordedWalk* const> walks);

/// `walks` of one horizon. Bootstrap with 4000 draws from `seed`. O(frames * ways + draws).
Evaluation evaluate(std::span<const RecordedWalk> walks, const EvaluationModels& models,
                    float horizon, std::uint64_t seed);

/// How well the ways of one walk were foreseen, in few numbers; means are 0 without junctions.
struct PredictionQuality {
  std::size_t settled = 0;    ///< samples whose outcome is known
  std::size_t contained = 0;  ///< of these, whose way was in the graph
  std::size_t junctions = 0;  ///< of these, with two ways that could be taken
  double nll = 0.0;           ///< mean of the way taken at junctions, nats
  double first = 0.0;         ///< share in which it was the likeliest, ties by their share
  double rank = 0.0;          ///< its mean rank by likelihood, from 1, ties in the middle
};

/// By the likelihood (Guess::kLikelihood) and the definitions above. O(frames * ways).
PredictionQuality qualityOf(const RecordedWalk& walk,
                            const prediction::LikelihoodParameters& parameters);

/// For the console.
std::string toTable(const Evaluation& evaluation);
/// One row per guess and walker (and "all"), with a header.
std::string toCsv(const Evaluation& evaluation);
/// `forewalk.evaluation/1`.
std::string toJson(const Evaluation& evaluation);
/// SVG: reliability; displacement over time; scores of the guesses.
std::string reliabilityPlot(const Evaluation& evaluation);
std::string displacementPlot(const Evaluation& evaluation);
std::string scorePlot(const Evaluation& evaluation);

}  // namespace forewalk::service
