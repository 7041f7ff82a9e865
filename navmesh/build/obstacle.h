// Things that come, move and go while somebody walks: furniture, barriers, robots, other people.
//
// Three shapes, each an outline on the plan and a range of heights. An obstacle takes the ground
// that a walker cannot use because of it, and gives none: its top is not walked on. One that the
// walker can step over (its top within `climb` of the ground) or pass under takes nothing.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <tl/expected.hpp>
#include <variant>
#include <vector>

#include "navmesh/error.h"

namespace forewalk::navmesh {

/// The owner's name for an obstacle; any number.
enum class ObstacleId : std::uint32_t {};

/// A box that stands upright, turned about its vertical axis.
struct BoxObstacle {
  glm::vec3 centre{0.0f};    ///< world space, metres
  glm::vec3 halfSize{0.5f};  ///< metres, > 0; x and z before it is turned
  float heading = 0.0f;      ///< radians, counter-clockwise seen from above

  bool operator==(const BoxObstacle&) const = default;
};

/// A convex outline drawn up from `bottom` to `top`.
struct PrismObstacle {
  std::vector<glm::vec2> corners;  ///< 3 to 64, counter-clockwise on the plan (plan.h), metres
  float bottom = 0.0f;             ///< world y, metres
  float top = 2.0f;                ///< world y, metres, > bottom

  bool operator==(const PrismObstacle&) const = default;
};

/// An upright cylinder.
struct CylinderObstacle {
  glm::vec3 foot{0.0f};  ///< middle of its lower end; world space, metres
  float radius = 0.3f;   ///< metres, > 0
  float height = 1.8f;   ///< metres, > 0

  bool operator==(const CylinderObstacle&) const = default;
};

using Obstacle = std::variant<BoxObstacle, PrismObstacle, CylinderObstacle>;

/// Fails when a number is not finite (kDataDamaged), or a place lies beyond 1,000 km, a size is not
/// above 0 or above 1 km, or a prism is not convex (1 mm) and counter-clockwise with 3 to 64
/// corners (kSettingOutOfRange). Names the field and its value. O(corners squared).
[[nodiscard]] tl::expected<void, Error> validate(const Obstacle& obstacle);

/// Where an obstacle is, whatever its shape. `corners` is empty for a cylinder, counter-clockwise
/// on the plan for the others; `centre` and `radius` are a cylinder's. Metres.
struct ObstacleOutline {
  std::vector<glm::dvec2> corners;
  glm::dvec2 centre{0.0};
  double radius = 0.0;
  double bottom = 0.0;  ///< world y
  double top = 0.0;     ///< world y
};

/// `obstacle` must be valid.
ObstacleOutline outlineOf(const Obstacle& obstacle);

}  // namespace forewalk::navmesh
