// Commands to choose from: linear and angular velocities that a body's motion clips can play.
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "agents/locomotion.h"

namespace forewalk::agents {

inline constexpr std::uint32_t kMostSamples = 100;

struct CommandSampling {
  std::uint32_t linearSamples = 10;   ///< evenly from the slowest to the fastest
  std::uint32_t angularSamples = 15;  ///< 1 to kMostSamples; an odd number keeps straight ahead
  float spacing = 2.5f;               ///< k of sinh(k u)/sinh(k); 0: evenly
  float sideOffset = 0.0f;            ///< added to u; above 0: more to the left
  /// Turns from the sharpest to either side that the clips can play at each speed. Without it they
  /// are those of all clips, and whatever cannot be played at a speed is dropped.
  bool fitted = true;
  float side = -1.0f;                 ///< which side comes first: 1 left, -1 right
  float fastest = std::numeric_limits<float>::infinity();  ///< nothing beyond, m/s
  float comfortSpeed = 0.0f;  ///< the linear sample nearest to it becomes it, m/s; 0: none does
  /// Only what differs from `present` by at most `reach` in each component; the same number of
  /// samples is then spread over that.
  Command present;
  Command reach{std::numeric_limits<float>::infinity(), std::numeric_limits<float>::infinity()};
};

/// Replaces `commands` with the samples, by linear velocity and then by side, each once. Those that
/// the clips cannot play are left out, so there may be none. Of clips on one line linearSamples are
/// taken along it. Allocates only where `commands` has to grow.
void sampleCommands(const LocomotionDatabase& clips, const CommandSampling& sampling,
                    std::vector<Command>& commands);

}  // namespace forewalk::agents
