// Likelihood parameters as a small JSON file, with what they were fitted on.
#pragma once

#include <filesystem>
#include <string>
#include <tl/expected.hpp>
#include <vector>

#include "navmesh/error.h"
#include "prediction/likelihood.h"

namespace forewalk::service {

/// One building and the walks in it.
struct TrainingData {
  std::string scene, walks;  ///< file names
  std::vector<std::string> walkers;
};

/// What is said of a fit, beside its numbers.
struct LikelihoodRecord {
  prediction::LikelihoodParameters parameters;
  std::string method;            ///< of the graphs
  std::vector<double> horizons;  ///< metres
  std::vector<TrainingData> trainedOn;
  std::size_t samples = 0;
  double nll = 0.0;  ///< nats per sample, on the training data
};

/// JSON, schema `forewalk.likelihood/1`.
std::string toJson(const LikelihoodRecord& record);

/// Reads the parameters of such a file; those it does not name keep their defaults. Fails when it
/// cannot be read, is no such file, or a parameter is unknown, no number or out of range (names
/// it).
[[nodiscard]] tl::expected<prediction::LikelihoodParameters, Error> readLikelihood(
    const std::filesystem::path& file);

}  // namespace forewalk::service
