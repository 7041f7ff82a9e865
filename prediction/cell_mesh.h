// The walkable polygons as cells that share vertices and edges: what a front is followed over.
//
// A navgraph knows polygons and portals; a front also runs along walls. Here the outline of every
// polygon is one cycle of edges, each either a portal, shared with the polygon behind it, or a
// stretch of wall. Edges that portals cover in part (tile borders) are cut at the portals' ends.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "navmesh/nav_graph.h"
#include "prediction/distance_field.h"

namespace forewalk::prediction {

struct CellMesh {
  /// From one vertex to the next, counter-clockwise around `left`.
  struct Edge {
    std::uint32_t from, to;
    PolygonId left;
    PolygonId right;  ///< kNoPolygon: a wall
  };
  /// An edge in space: where it begins, which way it goes and how far.
  struct Line {
    glm::dvec2 from, along;  ///< metres; of unit length, or zero
    double length;           ///< metres
  };
  /// A vertex of a polygon's outline and the edge from there to the next, counter-clockwise.
  struct Corner {
    glm::dvec2 from, along;  ///< metres; of unit length, or zero
    double length;           ///< metres
    std::uint32_t vertex;
    std::uint32_t edge;
    std::uint32_t wall;  ///< that the edge is, or kNone
    PolygonId beyond;    ///< kNoPolygon: a wall
    bool forward;        ///< the edge starts here: the polygon is its `left`
  };

  /// A stretch of border. One follows the other with the walkable area on the left, around a whole
  /// border and back to the first.
  struct Wall {
    std::uint32_t edge;
    std::uint32_t next, previous;  ///< walls; the next begins where this one ends
  };

  std::vector<glm::vec2> plan;  ///< per vertex, metres; the first are the PortalEnds in their
                                ///< order, then come corners of walls
  std::vector<Edge> edges;
  std::vector<Line> lines;                    ///< per edge
  std::vector<std::uint32_t> edgeOfPortal;    ///< per half-portal; kNone where it has no width
  std::vector<std::uint32_t> cornerStart{0};  ///< polygons + 1
  std::vector<Corner> corners;
  std::vector<Wall> walls;
  std::vector<std::uint32_t> wallOfEdge;  ///< per edge; kNone: a portal

  std::span<const Corner> cornersOf(PolygonId polygon) const {
    const std::uint32_t begin = cornerStart[index(polygon)];
    return {corners.data() + begin, cornerStart[index(polygon) + 1] - begin};
  }

  /// The edge by which the border goes on where `edge`, of the border too, ends. Calls
  /// visit(polygon) for the polygons between the two, about the vertex that they share.
  template <typename Visit>
  std::uint32_t borderAfter(std::uint32_t edge, const Visit& visit) const {
    PolygonId polygon = edges[edge].left;
    for (;;) {
      visit(polygon);
      const std::span<const Corner> around = cornersOf(polygon);
      std::size_t at = 0;
      while (around[at].edge != edge) ++at;
      edge = around[at + 1 < around.size() ? at + 1 : 0].edge;
      if (edges[edge].right == navmesh::kNoPolygon) return edge;
      polygon = edges[edge].left == polygon ? edges[edge].right : edges[edge].left;
    }
  }
};

/// `ends` were made from `graph`. O(corners of all polygons); made once, then only read. Portals of
/// no width are no edges: a front passes them through their vertex.
CellMesh makeCellMesh(const navmesh::NavGraph& graph, const PortalEnds& ends);

}  // namespace forewalk::prediction
