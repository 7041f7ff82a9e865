// Detour's tile bytes, in and out: what Recast's build ends in, and what RecastDemo saves as MSET.
//
// Tile bytes are untrusted: every count, offset and index is checked before it is used.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <tl/expected.hpp>
#include <vector>

#include "navmesh/build/navmesh.h"

namespace forewalk::navmesh {

/// One tile as dtCreateNavMeshData makes it (Detour 1.5/1.6, NAVMESH_VERSION 7, 32-bit references, this
/// machine's byte order).
using DetourTile = std::vector<std::byte>;

/// The polygons of all tiles as one navmesh, in tile order: vertices welded (1 mm), neighbours inside a
/// tile by shared edges, across tile borders by portals computed from the geometry (Detour keeps their
/// ends in 8 bits, off by centimetres). Off-mesh connections are left out.
///
/// Fails when a tile ends early, has a wrong magic or version, or an index out of range (kDataDamaged,
/// with tile and byte).
[[nodiscard]] tl::expected<PolygonMesh, Error> polygonsFromTiles(std::span<const DetourTile> tiles,
                                                                 float climb,
                                                                 const std::string& name);

/// Imports a navmesh that RecastDemo saved (`MSET`, version 1). Walker size is taken from the tiles.
[[nodiscard]] tl::expected<NavMesh, Error> importMset(std::span<const std::byte> bytes,
                                                      const std::string& name);

}  // namespace forewalk::navmesh
