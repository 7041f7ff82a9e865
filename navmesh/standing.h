// People and other agents who stand in a doorway: which polygons they block, at once.
//
// A disc blocks a polygon where nobody comes from one of its portals to another past it: the
// polygon is convex, so what is left of it falls into as many pieces as what is left of its border.
// A dead end is blocked where its portal is covered. Somebody in the middle of a room blocks
// nothing; in a doorway, the doorway's polygons. Each disc is looked at alone: two people who close
// a gate together only leave it open. For what stays, geometry is exact: carve an obstacle
// (build/live_mesh.h).
#pragma once

#include <glm/glm.hpp>
#include <span>
#include <tl/expected.hpp>
#include <vector>

#include "navmesh/error.h"
#include "navmesh/polygon_states.h"
#include "navmesh/world.h"

namespace forewalk::navmesh {

/// Somebody who stands somewhere.
struct Standing {
  glm::vec3 foot{0.0f};  ///< world space, metres
  float radius = 0.6f;   ///< of the ground that others cannot use, > 0 and up to kWidestStanding,
                         ///< metres: their own and, since the navmesh is shrunk by it, the walker's
  float cost = kClosed;  ///< of the polygons blocked: 1 to kHighestCost, or kClosed

  bool operator==(const Standing&) const = default;
};

inline constexpr float kWidestStanding = 10.0f;  ///< metres

/// How far the floor of a polygon may lie above or below the feet, metres.
inline constexpr float kStandingReach = 1.0f;

/// Fails when a number is not finite (kDataDamaged), or radius or cost are out of range
/// (kSettingOutOfRange), naming which and its value.
[[nodiscard]] tl::expected<void, Error> validate(const Standing& standing);

/// Appends the polygons that valid `standing` blocks to `blocked`, with its cost, ascending.
/// O(polygons of the index's cells that it touches): under a microsecond, mostly. Allocates only
/// where `blocked` has to grow.
void blockedBy(const NavGraph& graph, const LocationIndex& locations, const Standing& standing,
               std::vector<PolygonCost>& blocked);

}  // namespace forewalk::navmesh
