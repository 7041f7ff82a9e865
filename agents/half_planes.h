// Linear programs over velocities: the half-planes and the disc of possible speeds.
//
// The incremental programs of de Berg et al., "Computational Geometry", chapter 4, as ORCA uses
// them (Reciprocal n-body collision avoidance, section 5).
#pragma once

#include <glm/glm.hpp>
#include <span>
#include <vector>

namespace forewalk::agents {

/// Allowed is what lies left of the line through `point` along the unit vector `direction`.
struct HalfPlane {
  glm::vec2 point;
  glm::vec2 direction;
};

struct VelocityChoice {
  glm::vec2 velocity{0.0f};
  bool feasible = true;  ///< it lies in all half-planes
};

/// The velocity of at most `maximumSpeed` in all `planes` that is nearest to `preferred`. Where
/// there is none: the first `hard` planes are kept, and the largest distance into any other is
/// least. O(n) to O(n^2) of the planes where feasible, O(n^3) at worst. `scratch` grows to their
/// number.
VelocityChoice nearestAllowed(std::span<const HalfPlane> planes, std::size_t hard,
                              glm::vec2 preferred, float maximumSpeed,
                              std::vector<HalfPlane>& scratch);

}  // namespace forewalk::agents
