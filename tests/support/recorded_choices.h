// Walks as fitting and evaluation see them, made up: ways in random directions, of which one is
// taken by the likelihood's own probabilities.
#pragma once

#include <cmath>
#include <random>

#include "navmesh/random.h"
#include "service/fitting.h"

namespace forewalk::testing {

/// `samples` choices among 2 to 4 ways, a frame each, between which everything is forgotten.
inline service::RecordedWalk recordedChoices(const std::string& walker, std::size_t samples,
                                             std::uint64_t seed,
                                             const prediction::LikelihoodParameters& truth) {
  std::mt19937_64 rng(seed);
  service::RecordedWalk walk;
  walk.walker = walker;
  prediction::WayFilter filter(4);
  for (std::size_t k = 0; k < samples; ++k) {
    service::Sample sample{};
    sample.frame = k;
    const auto ways = static_cast<std::size_t>(2 + navmesh::uniformInt(rng, 3));
    const std::size_t first = walk.facts.size();
    const double turn = navmesh::uniform(rng, -3.14159, 3.14159);
    for (std::size_t i = 0; i < ways; ++i) {
      const double angle = turn + (static_cast<double>(i) + navmesh::uniform(rng, -0.3, 0.3)) *
                                      6.28318 / static_cast<double>(ways);
      prediction::WayFacts facts;
      facts.near = facts.far = {std::cos(angle), std::sin(angle)};
      facts.distance = 5.0;
      walk.facts.push_back(facts);
      sample.toEnd.push_back(facts.far);
      std::vector<glm::dvec2>& path = sample.paths.emplace_back();
      for (int s = 0; s <= 20; ++s) path.push_back(service::kPathStep * s * facts.far);
    }
    const prediction::Walked walked{1.0, 1.0, {1.0, 0.0}, {}, {}};
    walk.frames.push_back({first, ways, walked, {0.0, 0.0}, {1.0, 0.0}});
    filter.step(walk.waysOf(walk.frames.back()), walked, truth);
    double drawn = navmesh::uniform(rng) * (1.0 - filter.none());
    sample.outcome = service::Outcome::kTaken;
    while (sample.taken + 1 < ways && drawn >= filter.probabilities()[sample.taken]) {
      drawn -= filter.probabilities()[sample.taken++];
    }
    const glm::dvec2 toward = sample.toEnd[sample.taken];
    for (std::size_t t = 0; t < service::kSecondsAhead.size(); ++t) {
      sample.after[t] = std::min(5.0, service::kSecondsAhead[t]) * toward;
    }
    for (std::size_t m = 0; m < service::kMetresAhead.size(); ++m) {
      sample.along[m] = service::kMetresAhead[m] * toward;
    }
    sample.afterKnown = service::kSecondsAhead.size();
    sample.alongKnown = service::kMetresAhead.size();
    walk.samples.push_back(std::move(sample));
  }
  return walk;
}

}  // namespace forewalk::testing
