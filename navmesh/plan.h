// The ground plane seen from above, and the one pair of functions that goes there and back.
//
// World axes are those of glTF, OpenXR and Recast: right-handed, +Y up, forward is -Z. Planar work
// is done on glm::vec2(x, -z), so that counter-clockwise is positive and equals a positive turn
// about +Y. Heights are kept beside (DESIGN.md section 2). Nothing else in forewalk converts.
#pragma once

#include <cmath>
#include <glm/glm.hpp>

namespace forewalk::navmesh {

/// The plan of a point in space, metres. Drops the height.
inline glm::vec2 toPlan(glm::vec3 point) { return {point.x, -point.z}; }

/// The point in space above `plan` at `height` (world y), metres.
inline glm::vec3 toSpace(glm::vec2 plan, float height) { return {plan.x, height, -plan.y}; }

/// z of the cross product: positive where `b` lies counter-clockwise of `a`.
inline float cross(glm::vec2 a, glm::vec2 b) { return a.x * b.y - a.y * b.x; }
inline double cross(glm::dvec2 a, glm::dvec2 b) { return a.x * b.y - a.y * b.x; }

/// Twice the signed area of the triangle: positive where `c` lies left of the walk from `a` to `b`.
inline float turn(glm::vec2 a, glm::vec2 b, glm::vec2 c) { return cross(b - a, c - a); }

/// The same in double precision, with the sign of the exact result: differences of coordinates and
/// their products fit into a double.
inline double exactTurn(glm::vec2 a, glm::vec2 b, glm::vec2 c) {
  const glm::dvec2 ab = glm::dvec2(b) - glm::dvec2(a);
  const glm::dvec2 ac = glm::dvec2(c) - glm::dvec2(a);
  return ab.x * ac.y - ab.y * ac.x;
}

/// The unit vector of a heading on the plan. Headings are radians, 0 is forward (-Z, plan +y),
/// counter-clockwise positive.
inline glm::vec2 directionOf(float heading) { return {-std::sin(heading), std::cos(heading)}; }

/// The heading of a direction on the plan, in (-pi, pi]. A zero direction gives 0.
inline float headingOf(glm::vec2 direction) { return std::atan2(-direction.x, direction.y); }

}  // namespace forewalk::navmesh
