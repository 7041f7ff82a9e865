// The grid that a scene is cut into: voxels, and squares of them that are built as tiles.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <tl/expected.hpp>
#include <vector>

#include "navmesh/build/scene.h"
#include "navmesh/build/settings.h"

namespace forewalk::navmesh {

/// Scene coordinates are rounded to this fraction of a voxel, as integers. A tile subtracts its own
/// corner from them without error, so a wall on a cell line falls to the same side in all tiles.
inline constexpr int kSubdivision = 256;

// Quotients of floats that mean whole numbers (0.3 / 0.1) miss them by 1e-7; a voxel more or less
// must not depend on that.
inline constexpr double kQuotientSlack = 1e-4;
inline int ceilOf(double quotient) {
  return static_cast<int>(std::ceil(quotient - kQuotientSlack));
}
inline int floorOf(double quotient) {
  return static_cast<int>(std::min(std::floor(quotient + kQuotientSlack), 1e9));
}

/// The settings in voxels, as Recast takes them.
struct Voxels {
  int radius, height, climb;
  int regionMin, regionMerge;
  int edgeMax;
  float edgeError;
  int border;  // extra cells around a tile, so that it sees what its neighbours see
};

/// The one grid that all tiles are cut from. Voxel (0, 0, 0) has its least corner at `origin`.
struct Grid {
  glm::dvec3 origin;
  double cell, cellHeight;
  std::int64_t columns, rows;  // along x and z
  int layers;                  // along y
  std::int64_t tileCells;      // 0: solo
  std::int64_t tilesX, tilesZ;
};

/// A scene on the grid: what rasterizing a tile needs, found once for all tiles.
struct GridScene {
  std::vector<glm::ivec3> vertices;      // 1/kSubdivision voxels from the grid's origin
  std::vector<unsigned char> walkable;   // per triangle: Recast area id
  std::vector<std::size_t> bucketStart;  // tiles + 1 offsets into `bucket`
  std::vector<std::uint32_t> bucket;     // triangles that touch each tile's bounds, border included
};

/// The settings must have passed checkSettings.
Voxels toVoxels(const BuildSettings& settings);

/// Fails when the scene exceeds Recast's limits (kTooLarge: names cell, cellHeight or tile). The
/// scene has triangles, and they name vertices that are there.
[[nodiscard]] tl::expected<Grid, Error> makeGrid(const Scene& scene, const BuildSettings& settings);

/// O(triangles * tiles that each touches).
GridScene onGrid(const Scene& scene, const Grid& grid, const BuildSettings& settings, int border);

/// How upright a triangle's normal is; -1 where it has no area. Recast's own test of slopes leaves
/// out ground that is exactly as steep as allowed, which with slope 0 is all of it.
double upwardCosine(const Scene& scene, const glm::uvec3& triangle);

}  // namespace forewalk::navmesh
