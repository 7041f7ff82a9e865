// Takes the ground that obstacles stand on out of a tile, cell by cell.
//
// It works on Recast's compact heightfield before erosion, so that the walker's radius is kept from
// an obstacle as from a wall; nothing that was found before (voxels, clearances) depends on the
// obstacles. Recast's own marks (rcMarkConvexPolyArea, rcMarkCylinderArea) ask for the centre of a
// cell, which lets the walker half a cell nearer than walls do, and compute in floats from each
// tile's own corner, so that two tiles can disagree about a cell they share. Here a cell is taken
// when the outline covers any of its area, decided in integers (1/256 cell) that all tiles share.
#pragma once

#include <Recast.h>

#include <cstdint>
#include <span>

#include "navmesh/build/obstacle.h"

namespace forewalk::navmesh {

/// An obstacle on the grid that all tiles are cut from. Plan coordinates are (x, z) from the grid's
/// origin in 1/256 cells, whole numbers kept in doubles: sums and products of them are exact.
struct GridObstacle {
  std::vector<glm::dvec2> corners;  ///< counter-clockwise in (x, z); empty: a disc
  glm::dvec2 centre{0.0};
  double radius = 0.0;
  glm::dvec2 low{0.0}, high{0.0};     ///< its bounds
  double bottom = 0.0, top = 0.0;     ///< world y, metres
  unsigned char area = RC_NULL_AREA;  ///< what its ground becomes: taken, or another area
};

/// Puts a valid obstacle on the grid whose least corner is at `origin` (world x and z, metres).
GridObstacle onGrid(const Obstacle& obstacle, glm::dvec2 origin, double cell);

/// A tile's cells, and who walks there.
struct CarvedField {
  std::int64_t columnShift, rowShift;  ///< grid column and row of the field's first cell
  double bottom;                       ///< world y of span height 0, metres
  double cellHeight;                   ///< metres
  double walkerHeight, climb;          ///< metres
};

/// Gives all open spans `obstacle.area` that it covers: those from which somebody `walkerHeight`
/// high reaches above its bottom, and that lie more than `climb` below its top. Spans without
/// ground stay so. O(cells in its bounds).
void carve(const GridObstacle& obstacle, const CarvedField& where, rcCompactHeightfield& field);

/// Whether the outline covers any area of a cell, both in grid coordinates as above.
bool coversCell(const GridObstacle& obstacle, std::int64_t column, std::int64_t row);

}  // namespace forewalk::navmesh
