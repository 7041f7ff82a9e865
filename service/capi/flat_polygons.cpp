#include "service/capi/flat_polygons.h"

#include <utility>

#include "service/capi/axes.h"

namespace forewalk::capi {

FlatPolygons::FlatPolygons(const navmesh::NavGraph& graph, forewalk_axes axes)
    : cornerStart_(graph.ringStart), portalStart_(graph.portalStart) {
  const auto place = [&](glm::vec2 plan, float height) {
    return positionTo(axes, navmesh::toSpace(plan, height));
  };
  corners_.reserve(graph.ring.size());
  for (std::size_t i = 0; i < graph.ring.size(); ++i) {
    corners_.push_back(place(graph.ring[i], graph.ringHeight[i]));
  }
  portals_.reserve(graph.portalCount());
  for (std::uint32_t i = 0; i < graph.portalCount(); ++i) {
    portals_.push_back({.to = navmesh::index(graph.portalTo[i]),
                        .edge = graph.portalEdge[i],
                        .left = place(graph.portals[i].left, graph.portalHeights[i].left),
                        .right = place(graph.portals[i].right, graph.portalHeights[i].right)});
  }
  const auto triangles = [&] { return static_cast<std::uint32_t>(triangles_.size() / 3); };
  for (std::uint32_t polygon = 0; polygon < graph.polygonCount(); ++polygon) {
    triangleStart_.push_back(triangles());
    if (!graph.heightStart.empty()) {
      for (std::uint32_t i = graph.heightStart[polygon]; i < graph.heightStart[polygon + 1]; ++i) {
        navmesh::HeightTriangle triangle = graph.heightTriangles[i];
        const glm::vec2 a = navmesh::toPlan(triangle.a);
        if (navmesh::cross(navmesh::toPlan(triangle.b) - a, navmesh::toPlan(triangle.c) - a) < 0) {
          std::swap(triangle.b, triangle.c);  // a navmesh says nothing of their sense
        }
        for (const glm::vec3 corner : {triangle.a, triangle.b, triangle.c}) {
          triangles_.push_back(positionTo(axes, corner));
        }
      }
    }
    if (triangles() > triangleStart_.back()) continue;
    for (std::uint32_t i = cornerStart_[polygon] + 2; i < cornerStart_[polygon + 1]; ++i) {
      triangles_.insert(triangles_.end(),
                        {corners_[cornerStart_[polygon]], corners_[i - 1], corners_[i]});
    }
  }
  triangleStart_.push_back(triangles());
}

forewalk_navmesh_view FlatPolygons::view() const {
  return {.struct_size = sizeof(forewalk_navmesh_view),
          .polygon_count = static_cast<std::uint32_t>(cornerStart_.size() - 1),
          .corner_start = cornerStart_.data(),
          .corners = corners_.data(),
          .portal_start = portalStart_.data(),
          .portals = portals_.data(),
          .triangle_start = triangleStart_.data(),
          .triangles = triangles_.data()};
}

}  // namespace forewalk::capi
