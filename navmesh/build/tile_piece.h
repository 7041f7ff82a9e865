// One tile of a world as a graph of its own, and the seams to its neighbours: what joining keeps
// when other tiles change (tile_join.h). Internal to the builders.
//
// Welding puts a vertex on a tile's border to the earliest within a millimetre of it that stays.
// Vertices of one tile lie on Recast's grid, farther apart than that, so at most one of each tile
// meets at a place, and only tiles that touch there can have one: where a vertex goes depends on
// the neighbours alone, and all else of a tile on its own bytes.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <memory>
#include <span>
#include <vector>

#include "navmesh/build/detour_tiles.h"
#include "navmesh/build/tile_borders.h"
#include "navmesh/build/tile_polygons.h"
#include "navmesh/nav_graph.h"

namespace forewalk::navmesh {

/// What the bytes of a tile say.
struct TileShape {
  DetourTile bytes;
  TilePolygons alone;
  std::vector<std::uint32_t> border;  ///< vertices that those of other tiles may weld with
  bool odd = false;  ///< not what is said above, or damaged: such a world is joined from nothing
};

/// `spacing`: how far apart vertices of one tile are, metres.
std::shared_ptr<const TileShape> shapeOf(DetourTile bytes, float spacing);

/// Where welding puts the border vertices of a tile.
struct TileWelds {
  std::vector<glm::vec3> places;  ///< per border vertex
  std::vector<char> stays;        ///< per border vertex: in its own place

  bool operator==(const TileWelds&) const = default;
};

struct TilePiece {
  std::shared_ptr<const TileShape> shape;
  TileWelds welds;
  NavGraph graph;  ///< of this tile alone, its vertices welded

  /// Edges with both ends on the border, in order of (polygon, edge).
  struct OuterEdge {
    std::uint32_t polygon, edge;
    glm::vec3 from, to;
    bool joined;  ///< with a polygon of this tile
  };
  std::vector<OuterEdge> outer;
  std::vector<BorderEdge> borderEdges;
  bool odd = false;
};

/// `earlier`: the pieces around it that come before it, in order; null without ground.
TileWelds weld(const TileShape& shape, std::span<const TilePiece* const> earlier);

std::shared_ptr<const TilePiece> makePiece(std::shared_ptr<const TileShape> shape, TileWelds welds);

/// A portal from one tile to a later one, seen from the former.
struct Crossing {
  std::uint32_t polygon[2];  ///< of the earlier tile and of the later
  std::uint32_t edge[2];
  Portal ends;
  PortalHeights heights;
  bool shared;  ///< the whole edge, of both; else where two edges overlap
};

struct Seam {
  std::vector<Crossing> crossings;  ///< shared ones first; both kinds in order of polygons, edges
  bool odd = false;
};

/// `one` comes before `other`.
std::shared_ptr<const Seam> makeSeam(const TilePiece& one, const TilePiece& other, float climb);

}  // namespace forewalk::navmesh
