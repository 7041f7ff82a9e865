// Random situations to search trajectories in: open ground, crowds, corridors, touching bodies.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>

#include "agents/command_samples.h"
#include "agents/models/golaem.h"
#include "agents/trajectory_search.h"
#include "navmesh/plan.h"

namespace forewalk::agents::testing {

/// Numbers that are the same everywhere: no std distribution.
class Dice {
 public:
  explicit Dice(std::uint64_t seed) : random_(seed) {}
  float between(float low, float high) {
    return low + (high - low) * (static_cast<float>(random_() >> 40) * 0x1p-24f);
  }
  std::uint32_t upTo(std::uint32_t most) {
    return static_cast<std::uint32_t>(random_() % (most + 1ull));
  }
  bool oneIn(std::uint32_t n) { return random_() % n == 0; }
  glm::vec2 direction() { return navmesh::directionOf(between(-3.14159f, 3.14159f)); }

 private:
  std::mt19937_64 random_;
};

/// Clips that span all that is sampled, so that no sample is dropped: speeds to 2 m/s and turns to
/// 2 rad/s.
inline LocomotionDatabase rectangularClips() {
  return LocomotionDatabase::make({{"stand", {0.0f, 0.0f}},
                                   {"stand left", {0.0f, 2.0f}},
                                   {"stand right", {0.0f, -2.0f}},
                                   {"run left", {2.0f, 2.0f}},
                                   {"run right", {2.0f, -2.0f}}},
                                  {{0, 3, 1}, {0, 4, 3}, {0, 2, 4}})
      .value();
}

inline void addDisc(Dice& dice, float most, TrajectorySituation& situation) {
  PredictedDisc disc;
  disc.position = dice.direction() * dice.between(0.3f, most);
  disc.velocity = dice.oneIn(4) ? glm::vec2(0.0f) : dice.direction() * dice.between(0.2f, 1.6f);
  disc.contact = dice.between(0.4f, 0.7f);
  disc.hit = std::min(disc.contact, 0.8f * glm::length(disc.position));
  disc.keep = std::min(disc.contact, 0.999f * glm::length(disc.position));
  disc.agent = !dice.oneIn(4);
  situation.discs.push_back(disc);
}

inline void addWall(Dice& dice, TrajectorySituation& situation) {
  PredictedWall wall;
  wall.from = dice.direction() * dice.between(0.3f, 5.0f);
  wall.to = dice.oneIn(20) ? wall.from : wall.from + dice.direction() * dice.between(0.2f, 6.0f);
  wall.velocity = dice.oneIn(5) ? dice.direction() * dice.between(0.1f, 1.0f) : glm::vec2(0.0f);
  wall.contact = dice.between(0.1f, 0.4f);
  const Wall at{wall.from, wall.to, kNoWall, kNoWall, 0, 0, 0, 0, glm::vec2(0.0f)};
  const float away = glm::length(nearestOn(at, glm::vec2(0.0f)));
  wall.hit = std::min(wall.contact, 0.8f * away);
  wall.keep = std::min(wall.contact, 0.999f * away);
  situation.walls.push_back(wall);
}

/// `full`: ten speeds and fifteen turns for both halves, ten points, 22,500 trajectories; else any
/// smaller numbers, weights and limits.
inline void randomSituation(Dice& dice, bool full, TrajectorySituation& situation) {
  static const LocomotionDatabase clips = rectangularClips();
  TrajectoryProblem& problem = situation.problem;
  problem = {};
  problem.heading = dice.direction();
  problem.towards = dice.oneIn(10) ? glm::vec2(0.0f) : dice.direction();
  problem.comfortSpeed = dice.between(0.3f, 1.8f);
  problem.remaining = dice.oneIn(4) ? dice.between(0.1f, 3.0f) : dice.between(3.0f, 50.0f);
  problem.points = full ? 10 : 1 + dice.upTo(15);
  problem.step = dice.between(1.5f, 4.0f) / static_cast<float>(problem.points);
  const auto weight = [&] { return dice.oneIn(6) ? 0.0f : dice.between(0.2f, 5.0f); };
  if (!full) {
    problem.weights = {weight(),
                       weight(),
                       weight(),
                       weight(),
                       dice.between(0.1f, 1.0f),
                       dice.between(0.1f, 1.0f),
                       dice.oneIn(2),
                       dice.between(-10.0f, 10.0f),
                       dice.between(-10.0f, 10.0f)};
  }
  CommandSampling sampling;
  sampling.comfortSpeed = dice.oneIn(2) ? problem.comfortSpeed : 0.0f;
  if (!full) {
    sampling.linearSamples = 1 + dice.upTo(6);
    sampling.angularSamples = 1 + dice.upTo(8);
    sampling.sideOffset = dice.between(-0.3f, 0.3f);
  }
  sampleCommands(full ? clips : *builtInClips(), sampling, situation.first);
  situation.second = situation.first;
  if (!full) {
    if (dice.oneIn(3)) situation.second.clear();
    sampling.reach = {dice.between(0.1f, 1.0f), dice.between(0.2f, 2.0f)};
    sampling.present = {dice.between(0.0f, 1.5f), dice.between(-1.0f, 1.0f)};
    sampleCommands(*builtInClips(), sampling, situation.first);
  }
  situation.discs.clear();
  situation.walls.clear();
  const std::uint32_t discs = dice.oneIn(8) ? 0 : dice.upTo(20);
  const float crowd = dice.oneIn(3) ? 1.5f : 7.0f;  // sometimes there is no way out
  for (std::uint32_t d = 0; d < discs; ++d) addDisc(dice, crowd, situation);
  const std::uint32_t walls = dice.oneIn(3) ? 0 : dice.upTo(8);
  for (std::uint32_t w = 0; w < walls; ++w) addWall(dice, situation);
  problem.first = situation.first;
  problem.second = situation.second;
  problem.discs = situation.discs;
  problem.walls = situation.walls;
}

}  // namespace forewalk::agents::testing
