// A navmesh that follows obstacles: touched tiles are built again, the rest is kept.
//
//   changes --tiles touched--> tiles built --join (tile_join.h)--> a new World
//
// A world that was handed out never changes; the next one stands beside it for as long as somebody
// holds it. No thread is started: `service` runs this on one of its own (service/live_world.h).
//
// DetourTileCache keeps compressed layers for the same purpose. It gives polygons without height
// samples, from another region builder, so that a tile would change its polygons by being touched.
// What it saves is the voxels, over half of a tile's time (some 1 of 2 ms at 6 m and 0.1 m cells).
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <tl/expected.hpp>
#include <vector>

#include "navmesh/build/build.h"
#include "navmesh/build/obstacle.h"
#include "navmesh/build/tile_join.h"
#include "navmesh/build/tile_source.h"
#include "navmesh/world.h"

namespace forewalk::navmesh {

/// An obstacle that is there now (new, or moved from wherever it was), or no longer.
struct ObstacleChange {
  ObstacleId id;
  std::optional<Obstacle> obstacle;  ///< none: it goes; one that is not there may go
};

/// What one set of changes did.
struct LiveUpdate {
  std::shared_ptr<const World> world;  ///< the same as before where no tile was touched
  std::uint32_t tilesBuilt = 0;
};

/// Not shared between threads; the worlds are.
class LiveMesh {
 public:
  /// Builds `scene` without obstacles. Tiles of 5 to 10 m (`settings.tile`) are best; in one piece
  /// (0) every change builds all. No polygon crosses an outline of `outlines` (TileSource::make).
  ///
  /// Fails as buildNavMesh and TileSource::make do.
  [[nodiscard]] static tl::expected<LiveMesh, Error> make(Scene scene,
                                                          const BuildSettings& settings,
                                                          std::span<const Obstacle> outlines = {},
                                                          const BuildRun& run = {});

  /// Applies all changes, in their order, or none. The world depends on the obstacles that are
  /// there, not on how they came there: it equals one made with the same obstacles at once, to the
  /// last bit. Obstacles may close all ground; then the world has no polygon. Polygon ids hold for
  /// one world only.
  ///
  /// Fails as validate(Obstacle) does, or when a tile exceeds Recast's limits (kTooLarge). Costs a
  /// tile's build for each tile touched (old and new places), 1 to 4 ms at 6 m and 0.1 m cells,
  /// spread over `run.forEach`, and O(polygons) of the world, some 0.2 ms for 1,000.
  [[nodiscard]] tl::expected<LiveUpdate, Error> apply(std::span<const ObstacleChange> changes,
                                                      const BuildRun& run = {});

  const std::shared_ptr<const World>& world() const { return world_; }
  const BuildSettings& settings() const { return source_.settings(); }
  std::size_t tileCount() const { return source_.tileCount(); }
  std::size_t obstacleCount() const { return placed_.size(); }

 private:
  struct Placed {
    Obstacle obstacle;
    std::shared_ptr<const GridObstacle> onGrid;
    std::vector<std::uint32_t> tiles;  // touched, ascending
  };
  using Obstacles = std::map<ObstacleId, Placed>;

  explicit LiveMesh(TileSource source);
  tl::expected<std::shared_ptr<const World>, Error> worldOf(const TileJoin& join) const;

  TileSource source_;
  Obstacles placed_;
  TileJoin join_;
  std::shared_ptr<const World> world_;
};

}  // namespace forewalk::navmesh
