// Why a scene has nothing to walk on.
#pragma once

#include <span>

#include "navmesh/build/tile_builder.h"
#include "navmesh/error.h"

namespace forewalk::navmesh {

/// Which setting closed the scene, found by looking at which build step lost the last walkable
/// cell, with the value that would open it where that can be measured. `tiles` are all results of
/// `builder`, none of which has ground. Builds parts of a tile again where the climb is to blame.
Error nothingWalkable(const TileBuilder& builder, std::span<const TileResult> tiles);

}  // namespace forewalk::navmesh
