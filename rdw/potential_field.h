// What pushes a body away from borders, obstacles and other people.
//
// Thomas and Suma Rosenberg, "A General Reactive Algorithm for Redirected Walking Using Artificial
// Potential Functions", IEEE VR 2019: U(x) is the sum of 1/|x - x_o| over the nearest points x_o of
// every boundary edge and obstacle. We depart in that edges seen from behind (in an L, across its
// inner corner) do not push.
#pragma once

#include <glm/glm.hpp>
#include <span>

#include "rdw/other_user.h"
#include "rdw/tracked_space.h"

namespace forewalk::rdw {

/// -grad U at `point`, plan: sum of (x - x_o) / |x - x_o|^3, 1/m^2. Points nearer than a
/// centimetre push as from there. Outside the free floor: wayBackIn(). O(corners + others).
glm::dvec2 repulsion(const TrackedSpace& space, std::span<const OtherUser> others,
                     glm::dvec2 point);

/// What pushes somebody who has got outside the free floor: toward the nearest border, as hard as
/// it pushes whoever stands at it, 1/m^2. The sum over what lies around would drive them further
/// away: there every border but the nearest pushes outward. O(corners).
glm::dvec2 wayBackIn(const TrackedSpace& space, glm::dvec2 point);

/// The point of segment ab that is nearest to `point`.
glm::dvec2 nearestOnEdge(glm::dvec2 a, glm::dvec2 b, glm::dvec2 point);

}  // namespace forewalk::rdw
