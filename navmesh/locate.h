// Point location: which polygon is somebody on?
//
// From the last polygon by walking across portals (the frame's way), and from nothing by a uniform
// grid over the polygons' bounds (at start, and after jumps).
#pragma once

#include <optional>

#include "navmesh/nav_graph.h"

namespace forewalk::navmesh {

/// A place on the navmesh.
struct Location {
  PolygonId polygon = kNoPolygon;
  glm::vec2 plan{0.0f};  ///< inside the polygon; metres
  float height = 0.0f;   ///< of the surface there, world y, metres
  bool snapped = false;  ///< the query lay beside the navmesh and was moved to its nearest point

  glm::vec3 position() const { return {plan.x, height, -plan.y}; }
  bool operator==(const Location&) const = default;
};

/// How far a query may be moved. The heights keep the floor above and the floor below apart: with
/// storeys 2.6 m or more, a head or a foot finds its own floor.
struct SnapLimits {
  float distance = 0.5f;  ///< metres on the plan, >= 0
  float below = 2.2f;     ///< the floor may lie this far below the query (a head above its floor), metres
  float above = 0.4f;     ///< the floor may lie this far above the query, metres
};

/// Uniform grid over the polygons' bounds, compressed rows. Made once per graph, then only read. Cells
/// are sized so that there are about as many as polygons.
struct LocationIndex {
  glm::vec2 origin{0.0f};
  float cellSize = 1.0f;  ///< metres
  std::uint32_t columns = 0;
  std::uint32_t rows = 0;
  std::vector<std::uint32_t> cellStart;  ///< columns * rows + 1 offsets into `polygons`
  std::vector<PolygonId> polygons;       ///< ascending within a cell
};

/// O(polygons + cells covered).
LocationIndex makeLocationIndex(const NavGraph& graph);

/// The place of `position` (world space, metres) from nothing. Among polygons within the limits the
/// nearest on the plan wins, then the one nearest in height, then the smallest id. Nothing where none is
/// within the limits or a coordinate is not finite. Allocates nothing.
std::optional<Location> locate(const NavGraph& graph, const LocationIndex& index, glm::vec3 position,
                               const SnapLimits& limits = {});

/// The place of a user who was at `last` one frame ago: walks across portals from there, so it stays on
/// the user's own floor whatever lies above or below. A user beside the navmesh (leaning through a
/// virtual wall) is moved to the nearest point of the polygons around the walk's end. Falls back to the
/// grid where the walk does not come within the limits (a jump). Allocates nothing; under 20 ns for a
/// walking user.
std::optional<Location> locateFrom(const NavGraph& graph, const LocationIndex& index,
                                   const Location& last, glm::vec3 position,
                                   const SnapLimits& limits = {});

}  // namespace forewalk::navmesh
