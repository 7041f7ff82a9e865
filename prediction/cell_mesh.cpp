#include "prediction/cell_mesh.h"

#include <utility>

namespace forewalk::prediction {
namespace {

using navmesh::kNoPolygon;
using navmesh::NavGraph;

class CellMeshMaker {
 public:
  CellMeshMaker(const NavGraph& graph, const PortalEnds& ends) : graph_(graph), ends_(ends) {
    mesh_.plan = ends.plan;
    mesh_.edgeOfPortal.assign(graph.portalCount(), kNone);
  }

  CellMesh make() {
    for (std::uint32_t p = 0; p < graph_.polygonCount(); ++p) addPolygon(PolygonId{p});
    for (const CellMesh::Edge& edge : mesh_.edges) addLine(edge);
    chainWalls();
    fillCorners();
    return std::move(mesh_);
  }

 private:
  void addPolygon(PolygonId polygon) {
    const std::span<const glm::vec2> ring = graph_.ringOf(polygon);
    const std::uint32_t begin = graph_.portalStart[index(polygon)];
    const std::uint32_t end = graph_.portalStart[index(polygon) + 1];
    ringVertex_.assign(ring.size(), kNone);
    for (std::uint32_t h = begin; h < end; ++h) {
      const std::size_t edge = graph_.portalEdge[h];
      const std::size_t next = (edge + 1) % ring.size();
      const PortalEnds::Pair& pair = ends_.ofPortal[h];
      if (meets(graph_.portals[h].right, ring[edge])) ringVertex_[edge] = pair.right;
      if (meets(graph_.portals[h].left, ring[next])) ringVertex_[next] = pair.left;
    }
    for (std::size_t i = 0; i < ring.size(); ++i) {
      if (ringVertex_[i] != kNone) continue;
      ringVertex_[i] = static_cast<std::uint32_t>(mesh_.plan.size());
      mesh_.plan.push_back(ring[i]);
    }
    std::uint32_t h = begin;
    for (std::size_t i = 0; i < ring.size(); ++i) {
      std::uint32_t at = ringVertex_[i];
      for (; h < end && graph_.portalEdge[h] == i; ++h) {
        const PortalEnds::Pair& pair = ends_.ofPortal[h];
        if (pair.left == pair.right) continue;
        addWall(polygon, at, pair.right);
        addPortal(polygon, h);
        at = pair.left;
      }
      addWall(polygon, at, ringVertex_[(i + 1) % ring.size()]);
    }
    mesh_.cornerStart.push_back(static_cast<std::uint32_t>(mesh_.corners.size()));
  }

  /// Corners of rings and ends of portals on them differ by rounding at most.
  static bool meets(glm::vec2 end, glm::vec2 corner) { return glm::distance(end, corner) < 1e-4f; }

  void addWall(PolygonId polygon, std::uint32_t from, std::uint32_t to) {
    if (from == to) return;
    addCorner(from, static_cast<std::uint32_t>(mesh_.edges.size()), true);
    mesh_.edges.push_back({from, to, polygon, kNoPolygon});
  }

  void addPortal(PolygonId polygon, std::uint32_t h) {
    const PortalEnds::Pair& pair = ends_.ofPortal[h];
    const std::uint32_t twinEdge = mesh_.edgeOfPortal[graph_.portalTwin[h]];
    const bool first = twinEdge == kNone;
    const std::uint32_t edge = first ? static_cast<std::uint32_t>(mesh_.edges.size()) : twinEdge;
    if (first) mesh_.edges.push_back({pair.right, pair.left, polygon, graph_.portalTo[h]});
    mesh_.edgeOfPortal[h] = edge;
    addCorner(pair.right, edge, first);
  }

  void addCorner(std::uint32_t vertex, std::uint32_t edge, bool forward) {
    CellMesh::Corner& corner = mesh_.corners.emplace_back();
    corner.vertex = vertex;
    corner.edge = edge;
    corner.forward = forward;
  }

  /// What corners know of their edges, so that it lies together.
  void fillCorners() {
    for (CellMesh::Corner& corner : mesh_.corners) {
      const CellMesh::Edge& edge = mesh_.edges[corner.edge];
      const CellMesh::Line& line = mesh_.lines[corner.edge];
      corner.from = glm::dvec2(mesh_.plan[corner.vertex]);
      corner.along = corner.forward ? line.along : -line.along;
      corner.length = line.length;
      corner.wall = mesh_.wallOfEdge[corner.edge];
      corner.beyond = corner.forward ? edge.right : edge.left;
    }
  }

  void addLine(const CellMesh::Edge& edge) {
    const glm::dvec2 from(mesh_.plan[edge.from]);
    const glm::dvec2 span = glm::dvec2(mesh_.plan[edge.to]) - from;
    const double length = glm::length(span);
    mesh_.lines.push_back({from, length > 0.0 ? span / length : glm::dvec2(0.0), length});
  }

  void chainWalls() {
    mesh_.wallOfEdge.assign(mesh_.edges.size(), kNone);
    for (std::uint32_t edge = 0; edge < mesh_.edges.size(); ++edge) {
      if (mesh_.edges[edge].right != kNoPolygon) continue;
      mesh_.wallOfEdge[edge] = static_cast<std::uint32_t>(mesh_.walls.size());
      mesh_.walls.push_back({edge, kNone, kNone});
    }
    for (std::uint32_t wall = 0; wall < mesh_.walls.size(); ++wall) {
      const std::uint32_t next =
          mesh_.wallOfEdge[mesh_.borderAfter(mesh_.walls[wall].edge, [](PolygonId) {})];
      mesh_.walls[wall].next = next;
      mesh_.walls[next].previous = wall;
    }
  }

  const NavGraph& graph_;
  const PortalEnds& ends_;
  CellMesh mesh_;
  std::vector<std::uint32_t> ringVertex_;  // per ring corner of the polygon at hand
};

}  // namespace

CellMesh makeCellMesh(const NavGraph& graph, const PortalEnds& ends) {
  return CellMeshMaker(graph, ends).make();
}

}  // namespace forewalk::prediction
