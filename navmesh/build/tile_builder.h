// Recast's pipeline on one tile: voxels, open space, regions, contours, convex polygons, heights.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "navmesh/build/detour_tiles.h"
#include "navmesh/build/scene.h"
#include "navmesh/build/settings.h"
#include "navmesh/build/voxel_grid.h"

namespace forewalk::navmesh {

struct GridObstacle;  // carve.h

/// The build steps that can lose walkable cells, in the order they run, and the setting behind
/// each.
enum Step : std::size_t { kSlope, kHeight, kClimb, kRadius, kRegion, kContour, kSteps };

struct TileResult {
  DetourTile bytes;                        // empty: nothing walkable here
  std::array<std::size_t, kSteps> left{};  // walkable cells (kContour: polygons) after each step
  // Measured where a step left nothing.
  int headroom = 0;        // kHeight: highest clear space above walkable ground, voxels
  int room = 0;            // kRadius: largest radius that fits somewhere, cells
  std::size_t island = 0;  // kRegion: largest connected area, cells
  std::optional<Error> error;
};

/// Builds any tile of a scene; immutable, so threads share it. Scene and settings outlive it.
class TileBuilder {
 public:
  TileBuilder(const Scene& scene, const BuildSettings& settings, const Grid& grid);

  const Scene& scene() const { return scene_; }
  const BuildSettings& settings() const { return settings_; }
  std::size_t tileCount() const { return static_cast<std::size_t>(grid_.tilesX * grid_.tilesZ); }
  int climbVoxels() const { return voxels_.climb; }

  /// `carved` in turn are taken from the ground before it is shrunk by the walker's radius.
  TileResult build(std::size_t tile, std::span<const GridObstacle* const> carved = {}) const;

  /// Walkable spans of a tile that survive the height and ledge filters with another climb, voxels.
  std::size_t spansWithClimb(std::size_t tile, int climb) const;

 private:
  friend class TileBuild;

  const Scene& scene_;
  const BuildSettings& settings_;
  Grid grid_;
  Voxels voxels_;
  GridScene gridScene_;
};

}  // namespace forewalk::navmesh
