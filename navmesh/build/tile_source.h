// The tiles of one scene, built one at a time, with obstacles in them.
//
// For worlds that move: the scene is put on the grid once, and a tile that an obstacle touches is
// built again from its triangles, 1 to 4 ms for 6 m at 0.1 m cells. The voxels, over half of that,
// do not depend on obstacles; keeping them would take 0.1 MB a tile.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <tl/expected.hpp>
#include <vector>

#include "navmesh/build/build.h"
#include "navmesh/build/obstacle.h"

namespace forewalk::navmesh {

struct GridObstacle;  // carve.h

/// Immutable; any number of threads build at once.
class TileSource {
 public:
  /// Puts `scene` on the grid and builds every tile without obstacles, to find what is wrong with
  /// scene and settings. `outlines` cut the ground along them: no polygon crosses one, so that
  /// polygons can be closed by area (polygon_states.h). At most 62; the later lies above the
  /// earlier.
  ///
  /// Fails as buildTiles and validate(Obstacle) do, with more outlines (kTooLarge), and with any
  /// where the partition is layers, whose regions reach across them (kSettingOutOfRange).
  [[nodiscard]] static tl::expected<TileSource, Error> make(Scene scene,
                                                            const BuildSettings& settings,
                                                            std::span<const Obstacle> outlines = {},
                                                            const BuildRun& run = {});

  TileSource(TileSource&&) noexcept;
  TileSource& operator=(TileSource&&) noexcept;
  ~TileSource();

  std::size_t tileCount() const;    ///< row by row, those without ground too
  std::size_t columnCount() const;  ///< tiles in a row
  const BuildSettings& settings() const;
  const std::string& name() const;  ///< of the scene

  /// The tiles as built in make(); one without ground is empty.
  std::vector<DetourTile> takeTiles();

  /// Puts a valid obstacle on the grid.
  std::shared_ptr<const GridObstacle> place(const Obstacle& obstacle) const;

  /// The tiles whose ground an obstacle may take, ascending: those whose cells, or whose margin of
  /// their neighbours' cells, its bounds touch.
  std::vector<std::uint32_t> tilesTouchedBy(const GridObstacle& obstacle) const;

  /// One tile with these obstacles in it, in whatever order; without ground it is empty. Fails when
  /// the tile exceeds Recast's limits (kTooLarge).
  [[nodiscard]] tl::expected<DetourTile, Error> build(
      std::size_t tile, std::span<const GridObstacle* const> obstacles) const;

 private:
  struct State;
  explicit TileSource(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace forewalk::navmesh
