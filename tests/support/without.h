// A navmesh without some of its polygons, to compare closing with removing.
#pragma once

#include <utility>
#include <vector>

#include "navmesh/polygon_mesh.h"

namespace forewalk::testing {

/// The mesh of the polygons that are not `removed` (one flag a polygon), in the same order, and for
/// each of them its number in the old one. Vertices stay.
inline std::pair<navmesh::PolygonMesh, std::vector<std::uint32_t>> without(
    const navmesh::PolygonMesh& mesh, const std::vector<bool>& removed) {
  navmesh::PolygonMesh left;
  left.vertices = mesh.vertices;
  std::vector<std::uint32_t> oldOf;
  std::vector<navmesh::PolygonId> newOf(mesh.polygonCount(), navmesh::kNoPolygon);
  for (std::uint32_t p = 0; p < mesh.polygonCount(); ++p) {
    if (removed[p]) continue;
    newOf[p] = navmesh::PolygonId{static_cast<std::uint32_t>(oldOf.size())};
    oldOf.push_back(p);
    left.ring.insert(left.ring.end(), mesh.ring.begin() + mesh.ringStart[p],
                     mesh.ring.begin() + mesh.ringStart[p + 1]);
    left.ringStart.push_back(static_cast<std::uint32_t>(left.ring.size()));
  }
  for (navmesh::BorderPortal portal : mesh.borderPortals) {
    portal.from = newOf[navmesh::index(portal.from)];
    portal.to = newOf[navmesh::index(portal.to)];
    if (portal.from == navmesh::kNoPolygon || portal.to == navmesh::kNoPolygon) continue;
    left.borderPortals.push_back(portal);
  }
  return {std::move(left), std::move(oldOf)};
}

}  // namespace forewalk::testing
