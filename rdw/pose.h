// Where a head is and which way it looks, in space and on the plan.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>

#include "navmesh/plan.h"
#include "rdw/frame_flags.h"

namespace forewalk::rdw {

inline constexpr double kPi = 3.14159265358979323846;

/// A tracked or rendered head. World axes (right-handed, +Y up, forward -Z), metres. `orientation`
/// turns the head's own axes into the world's.
struct HeadPose {
  glm::vec3 position{0.0f};
  glm::quat orientation{1.0f, 0.0f, 0.0f, 0.0f};  ///< w, x, y, z
};

/// Somebody on the plan (navmesh/plan.h): metres, and a heading in radians, 0 = -Z (plan +y),
/// counter-clockwise positive. Doubles, because the rigid map between the spaces is kept in them.
struct PlanarPose {
  glm::dvec2 position{0.0};
  double heading = 0.0;
};

/// The same angle in (-pi, pi]. Finite input.
double wrapAngle(double radians);

/// The unit vector of a heading and back; as navmesh::directionOf and headingOf, in doubles.
glm::dvec2 directionOf(double heading);
double headingOf(glm::dvec2 direction);  ///< in (-pi, pi]; a zero direction gives 0

/// The heading of a direction in space, of any length; not a number where it has none (vertical,
/// zero, not finite).
double headingOf(glm::vec3 direction);

/// `v` turned by `radians`, counter-clockwise positive.
glm::dvec2 rotated(glm::dvec2 v, double radians);

/// Signed angle from `from` to `to`, in (-pi, pi], left positive. Any lengths; 0 where one is zero.
double angleBetween(glm::dvec2 from, glm::dvec2 to);

/// The heading of a head: the yaw of its forward axis. Within about 26 degrees of straight up or
/// down the forward axis says less and less, and the head's up axis (which then points behind the
/// user when looking up, ahead when looking down) is blended in, so that the heading neither jumps
/// nor is undefined while somebody nods through the vertical. Unit quaternion expected.
double headingOf(const glm::quat& orientation);

/// The plan position and heading of a head.
PlanarPose planarPose(const HeadPose& head);

/// `pose` with a finite position and a unit quaternion, whatever came in; what is beyond mending is
/// taken from `fallback` (which must be sound). A unit quaternion (to 1e-3) is left as it is, to
/// the bit. Positions further than 1e6 m from the origin count as not finite. Adds kPoseNotFinite,
/// kOrientationNotUnit and kOrientationUnusable (frame_flags.h) to `flags` where they apply.
HeadPose cleaned(const HeadPose& pose, const HeadPose& fallback, std::uint32_t& flags);

}  // namespace forewalk::rdw
