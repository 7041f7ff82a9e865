// Turning the walker toward a direction: what controllers share that follow a field of force.
#pragma once

#include <glm/glm.hpp>

#include "rdw/steer_to.h"

namespace forewalk::rdw {

/// The steer-to core without the damping near a target. Within a few degrees of the right direction
/// it is damped all the same, or the side would change with every tremble of the head (the peers
/// do not, and theirs does).
class Follow {
 public:
  Follow() : core_(settings()) {}

  /// Gains that turn somebody toward `direction` (physical, any length); zero: neutral.
  Gains toward(glm::dvec2 direction, const SteerInput& input) {
    return toward(direction, input, input.limits);
  }

  /// The same within other limits, which lie within the input's.
  Gains toward(glm::dvec2 direction, const SteerInput& input, const GainLimits& limits) {
    if (direction == glm::dvec2(0.0)) return {};
    const glm::dvec2 position = input.physical.position;
    const Steering steering =
        core_.steer(input.motion, position, directionOf(input.physical.heading),
                    position + glm::normalize(direction), limits);
    return asGains(steering, input.motion, limits);
  }

  void restart() { core_.restart(); }

 private:
  static SteerToSettings settings() {
    SteerToSettings settings;
    settings.dampedBearing = 5.0 * kPi / 180.0;
    settings.dampedDistance = 0.0;
    return settings;
  }
  SteerToCore core_;
};

}  // namespace forewalk::rdw
