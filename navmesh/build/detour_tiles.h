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

/// One tile as dtCreateNavMeshData makes it (Detour 1.5/1.6, NAVMESH_VERSION 7, 32-bit references,
/// this machine's byte order).
using DetourTile = std::vector<std::byte>;

/// The polygons of all tiles as one navmesh: vertices welded (1 mm, the earlier one stays),
/// neighbours inside a tile by shared edges, across tile borders by portals computed from the
/// geometry (Detour keeps their ends in 8 bits, off by centimetres). Portals join edges that lie on
/// one line with their polygons on either side of it, where they overlap by more than 1 mm and
/// differ by at most `climb` (metres) in height; border edges that are equal after welding are
/// joined as shared edges instead.
///
/// PolygonId is a running index over the tiles in order, within a tile in Detour's order, off-mesh
/// connections skipped. No polygon is left out; two corners of one polygon are never welded
/// together.
///
/// Fails when a tile ends early, has a wrong magic or version, or an index out of range, or a
/// coordinate that is not finite or beyond 1,000 km (kDataDamaged, with tile and byte); when
/// nothing walkable is in it (kSceneEmpty); when border edges overlap without end (kTooLarge).
/// `name` stands for the file in messages. O(n log n) of corners and border edges.
[[nodiscard]] tl::expected<PolygonMesh, Error> polygonsFromTiles(std::span<const DetourTile> tiles,
                                                                 float climb,
                                                                 const std::string& name);

/// Imports a navmesh that RecastDemo saved (`MSET`, version 1). The walker's size and the cell are
/// taken from the first tile; cellHeight, which is not in the file, is set to the cell; other
/// settings that the file does not tell keep their defaults.
///
/// Fails when the bytes are no MSET (kFormatUnknown), of another version, byte order or reference
/// size (kFormatUnsupported), end early or go on after the last tile (kDataDamaged), and as
/// polygonsFromTiles and makeNavMesh do.
[[nodiscard]] tl::expected<NavMesh, Error> importMset(std::span<const std::byte> bytes,
                                                      const std::string& name);

}  // namespace forewalk::navmesh
