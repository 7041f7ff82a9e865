// A navmesh's polygons as the flat arrays of the C interface, in somebody's axes.
#pragma once

#include <vector>

#include "navmesh/nav_graph.h"
#include "service/capi/forewalk.h"

namespace forewalk::capi {

class FlatPolygons {
 public:
  FlatPolygons() = default;
  /// Copies what it needs; `axes` is one of the constants. O(corners, portals, height triangles).
  FlatPolygons(const navmesh::NavGraph& graph, forewalk_axes axes);

  /// Lives as long as this is neither moved nor changed.
  forewalk_navmesh_view view() const;

 private:
  std::vector<std::uint32_t> cornerStart_, portalStart_, triangleStart_;
  std::vector<forewalk_vec3> corners_, triangles_;
  std::vector<forewalk_portal> portals_;
};

}  // namespace forewalk::capi
