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
    std::uint32_t vertex;
    std::uint32_t edge;
    bool forward;  ///< the edge starts here: the polygon is its `left`
  };

  std::vector<glm::vec2> plan;  ///< per vertex, metres; the first are the PortalEnds in their
                                ///< order, then come corners of walls
  std::vector<Edge> edges;
  std::vector<Line> lines;                    ///< per edge
  std::vector<std::uint32_t> edgeOfPortal;    ///< per half-portal; kNone where it has no width
  std::vector<std::uint32_t> cornerStart{0};  ///< polygons + 1
  std::vector<Corner> corners;

  std::span<const Corner> cornersOf(PolygonId polygon) const {
    const std::uint32_t begin = cornerStart[index(polygon)];
    return {corners.data() + begin, cornerStart[index(polygon) + 1] - begin};
  }
};

/// `ends` were made from `graph`. O(corners of all polygons); made once, then only read. Portals of
/// no width are no edges: a front passes them through their vertex.
CellMesh makeCellMesh(const navmesh::NavGraph& graph, const PortalEnds& ends);

}  // namespace forewalk::prediction
