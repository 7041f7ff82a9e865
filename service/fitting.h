// Fits the likelihood's parameters to recorded walks.
//
// Maximum likelihood with a pull toward the starting values (maximum a posteriori under normal
// priors): six walkers carry few parameters, and what they cannot tell stays where it was. The
// search is Nelder and Mead's simplex (Computer J. 7, 1965), in coordinates without bounds
// (logarithms, logits), restarted until it gains nothing. Deterministic.
#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "prediction/likelihood.h"
#include "service/recording.h"

namespace forewalk::service {

/// A parameter as files and fits know it.
struct ParameterInfo {
  const char* name;  ///< in files: "forget_metres"
  double prediction::LikelihoodParameters::*member;
  enum class Scale { kPlain, kLog, kLogit } scale;
  double low, high;  ///< allowed in files
  double spread;     ///< of the prior, in the scale's coordinates; 0: not fitted to ways
};
std::span<const ParameterInfo> parameterInfos();

/// The least value of `f` near `start`, each coordinate first stepped by `step`. At most `budget`
/// calls of `f`, which may return infinity.
struct Minimum {
  std::vector<double> at;
  double value;
};
Minimum minimise(const std::function<double(std::span<const double>)>& f, std::vector<double> start,
                 double step, int budget);

/// Where fits start and are pulled to: plain guesses made before any walk was seen. Not the
/// defaults: those were fitted, so a fold that starts there would know the walker it leaves out.
prediction::LikelihoodParameters unfittedParameters();

struct FitSettings {
  prediction::LikelihoodParameters start = unfittedParameters();
  double pull = 20.0;  ///< a prior weighs as much as so many samples a spread off it, >= 0
  int budget = 1500;   ///< evaluations of the likelihood
};

struct Fit {
  prediction::LikelihoodParameters parameters;
  std::size_t samples = 0;    ///< with two ways or more, settled
  double nll = 0.0;           ///< mean, at these parameters, nats
  double displacement = 0.0;  ///< mean distance off at kSecondsAhead, metres
};

/// Calls `visit(sample, probabilities, none)` for every sample of a walk.
void replay(const RecordedWalk& walk, const prediction::LikelihoodParameters& parameters,
            const std::function<void(const Sample&, std::span<const double>, double)>& visit);

/// The likelihood on settled samples with two ways or more; then pace and inertia on places at
/// kSecondsAhead, from walks recorded with a horizon of 5 m or more (or all where none is). Head
/// and gaze stay as they start. REQUIRES: walks that live on.
Fit fitLikelihood(std::span<const RecordedWalk* const> walks, const FitSettings& settings = {});

}  // namespace forewalk::service
