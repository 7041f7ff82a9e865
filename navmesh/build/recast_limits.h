// How much Recast can hold.
#pragma once

#include <Recast.h>

#include <cstdint>

namespace forewalk::navmesh {

// Recast's own limits: bit widths and index types in Recast.h and its sources.
inline constexpr int kRadiusCellsMax = 127;   // rcErodeWalkableArea compares twice this in a byte
inline constexpr int kHeightVoxelsMax = 255;  // rcCompactSpan::h has 8 bits
inline constexpr int kHeightVoxelsMin = 3;    // rcConfig::walkableHeight
inline constexpr int kSpanTopMax = RC_SPAN_MAX_HEIGHT;   // rcSpan::smax has 13 bits
inline constexpr std::int64_t kCellsPerSideMax = 65535;  // rcPolyMesh::verts are unsigned short
inline constexpr std::int64_t kCellsMax = std::int64_t{1} << 26;  // of a heightfield: 8 bytes each
inline constexpr int kSpansMax = (1 << 24) - 1;  // rcCompactCell::index has 24 bits
inline constexpr int kSpansPerColumnMax = 255;   // rcCompactCell::count has 8 bits
inline constexpr int kIndexMax = 0xfffe;         // of vertices and of polygons in a tile
inline constexpr int kTileCellsMin = 16;         // below that a tile is nearly all border
inline constexpr std::int64_t kTilesMax = std::int64_t{1} << 20;
inline constexpr std::int64_t kWorldCellsMax = std::int64_t{1}
                                               << 22;  // keeps grid coordinates in 32 bits

}  // namespace forewalk::navmesh
