// Builds a navmesh from scene triangles with Recast: voxels, regions, contours, convex polygons.
//
// Solo, or in tiles that are built independently. `navmesh` starts no threads: tiles are handed to
// the caller's `ForEach`, and the result has the same bytes in whatever order and on however many
// threads it runs them.
#pragma once

#include <cstddef>
#include <functional>
#include <tl/expected.hpp>
#include <vector>

#include "navmesh/build/detour_tiles.h"
#include "navmesh/build/navmesh.h"
#include "navmesh/build/scene.h"
#include "navmesh/for_each.h"

namespace forewalk::navmesh {

/// Told after each finished tile. May be called from the threads of ForEach, one call at a time.
using Progress = std::function<void(std::size_t done, std::size_t total)>;

struct BuildRun {
  ForEach forEach;    ///< empty: in turn
  Progress progress;  ///< empty: silent
};

/// Fails when a setting is out of range (names it and its range), the scene is empty or names a
/// vertex it does not have, the grid would exceed Recast's limits (names cell and tile), or nothing
/// is walkable: then the message names the setting that closed it (slope, height, climb, radius or
/// region size, found by looking at which build step lost the last walkable cell) with the value
/// that would open it where that can be measured.
[[nodiscard]] tl::expected<NavMesh, Error> buildNavMesh(const Scene& scene,
                                                        const BuildSettings& settings = {},
                                                        const BuildRun& run = {});

/// The tiles that buildNavMesh makes its polygons from, as dtNavMesh::addTile takes them: row by
/// row (header.y, then header.x), those with nothing walkable left out; a solo build is one tile.
/// All share one grid, so that neighbours agree on their common border.
///
/// polygonsFromTiles numbers the polygons of these tiles by a running index over the tiles in
/// order, within a tile in Detour's order: none is left out. Fails as buildNavMesh does.
[[nodiscard]] tl::expected<std::vector<DetourTile>, Error> buildTiles(
    const Scene& scene, const BuildSettings& settings = {}, const BuildRun& run = {});

/// Whether buildNavMesh could work with these settings at all: every number finite and in its
/// range, and walker and voxels in proportion. Names the first setting that is not
/// (kSettingOutOfRange).
[[nodiscard]] tl::expected<void, Error> checkSettings(const BuildSettings& settings);

}  // namespace forewalk::navmesh
