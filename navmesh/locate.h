// Point location: which polygon is somebody on?
//
// From the last polygon by walking across portals (the frame's way), and from nothing by a uniform
// grid over the polygons' bounds (at start, and after jumps).
#pragma once

#include <algorithm>
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
  float below =
      2.2f;  ///< the floor may lie this far below the query (a head above its floor), metres
  float above = 0.4f;  ///< the floor may lie this far above the query, metres
};

/// Uniform grid over the polygons' bounds, compressed rows. Made once per graph, then only read.
/// Cells are sized so that there are about as many as polygons.
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
/// nearest on the plan wins, then the one nearest in height, then the smallest id. Nothing where
/// none is within the limits or a coordinate is not finite. Allocates nothing.
std::optional<Location> locate(const NavGraph& graph, const LocationIndex& index,
                               glm::vec3 position, const SnapLimits& limits = {});

/// The place of a user who was at `last` one frame ago: walks across portals from there, so it
/// stays on the user's own floor whatever lies above or below. A user beside the navmesh (leaning
/// through a virtual wall) is moved to the nearest point of the polygons around the walk's end.
/// Falls back to the grid where the walk does not come within the limits (a jump). Allocates
/// nothing; under 20 ns for a walking user.
std::optional<Location> locateFrom(const NavGraph& graph, const LocationIndex& index,
                                   const Location& last, glm::vec3 position,
                                   const SnapLimits& limits = {});

/// Calls visit(polygon) for all polygons whose bounds may lie within `radius` metres of a place;
/// some more than once.
template <typename Visit>
void forPolygonsNear(const LocationIndex& index, glm::vec2 plan, float radius, const Visit& visit) {
  if (index.columns == 0) return;
  const auto cell = [&](float coordinate, float origin, std::uint32_t count) {
    const float cells = (coordinate - origin) / index.cellSize;
    return static_cast<std::uint32_t>(std::clamp(cells, 0.0f, static_cast<float>(count - 1)));
  };
  const std::uint32_t lowColumn = cell(plan.x - radius, index.origin.x, index.columns);
  const std::uint32_t highColumn = cell(plan.x + radius, index.origin.x, index.columns);
  const std::uint32_t highRow = cell(plan.y + radius, index.origin.y, index.rows);
  for (std::uint32_t row = cell(plan.y - radius, index.origin.y, index.rows); row <= highRow;
       ++row) {
    const std::uint32_t first = row * index.columns;
    for (std::uint32_t i = index.cellStart[first + lowColumn];
         i < index.cellStart[first + highColumn + 1]; ++i) {
      visit(index.polygons[i]);
    }
  }
}

}  // namespace forewalk::navmesh
