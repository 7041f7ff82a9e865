// Every tile of a scene: what buildTiles and TileSource begin with.
#pragma once

#include <span>
#include <tl/expected.hpp>
#include <vector>

#include "navmesh/build/build.h"
#include "navmesh/build/tile_builder.h"
#include "navmesh/build/voxel_grid.h"

namespace forewalk::navmesh {

/// Scene and settings on the grid, or what is wrong with them: fails as buildTiles does.
[[nodiscard]] tl::expected<Grid, Error> checkedGrid(const Scene& scene,
                                                    const BuildSettings& settings);

/// Every tile's result, in order. Fails as buildTiles does.
[[nodiscard]] tl::expected<std::vector<TileResult>, Error> buildAll(
    const TileBuilder& builder, std::span<const GridObstacle* const> carved, const BuildRun& run);

}  // namespace forewalk::navmesh
