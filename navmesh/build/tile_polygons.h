// One tile's polygons alone, for those who join tiles themselves. Internal to the builders.
#pragma once

#include <glm/glm.hpp>
#include <span>
#include <string>
#include <tl/expected.hpp>
#include <vector>

#include "navmesh/build/detour_tiles.h"
#include "navmesh/build/tile_borders.h"

namespace forewalk::navmesh {

struct TilePolygons {
  PolygonMesh mesh;                     ///< without border portals
  std::vector<BorderEdge> borderEdges;  ///< in order of (polygon, edge); vertices are the mesh's
  glm::vec3 low{0.0f}, high{0.0f};      ///< the tile's bounds, world space, metres
  bool welded = false;  ///< some of its vertices were within the weld of each other: then vertices
                        ///< of `borderEdges` mean nothing
};

/// As polygonsFromTiles has them, but for what it does between tiles. `places`, unless empty, are
/// where the vertices are put instead of their own places: one a vertex of `mesh`, from an earlier
/// call without.
///
/// Fails as polygonsFromTiles does.
[[nodiscard]] tl::expected<TilePolygons, Error> polygonsOfTile(const DetourTile& tile,
                                                               std::span<const glm::vec3> places,
                                                               const std::string& where);

}  // namespace forewalk::navmesh
