// The navmesh: where one can walk, as convex polygons with half-edge topology.
//
// For building, checking and editing. Frames search the NavGraph that is made from it once.
#pragma once

#include <tl/expected.hpp>
#include <vector>

#include "navmesh/build/half_edge_mesh.h"
#include "navmesh/build/settings.h"
#include "navmesh/error.h"
#include "navmesh/polygon_mesh.h"

namespace forewalk::navmesh {

/// Face i of `mesh` is PolygonId i. A vertex where two fans touch is stored once a fan, because a
/// half-edge mesh cannot turn around it; edges inside a fan are whole. Tile borders, where edges
/// overlap in part, are boundary edges of `mesh` joined by `borderPortals`.
struct NavMesh {
  BuildSettings settings;  ///< what it was built with; the walker's size it is good for
  HalfEdgeMesh mesh;
  std::vector<std::uint32_t> flatVertex;  ///< per vertex of `mesh`: its vertex in the flat form,
                                          ///< which the copies of one vertex have in common
  std::vector<BorderPortal> borderPortals;
  std::vector<std::uint32_t> heightStart;  ///< as in PolygonMesh
  std::vector<HeightTriangle> heightTriangles;
};

/// Half-edge topology for flat polygons (from Recast, from a file). Corner 0 of polygon i is the
/// vertex that halfedge_handle(face i) leads to. Vertices that no polygon names are left out, and
/// the later ones move up.
///
/// Fails as validate(PolygonMesh) does, when more than two polygons share an edge or two lie on the
/// same side of it (kDataDamaged, naming both), or when there are more corners than a half-edge
/// mesh can number (kTooLarge). Nothing is printed.
///
/// Costs O(n log n) of all corners; allocates the mesh.
[[nodiscard]] tl::expected<NavMesh, Error> makeNavMesh(const PolygonMesh& polygons,
                                                       const BuildSettings& settings);

/// The flat form, with vertices welded again across fans. makeNavMesh(flatten(m)) equals m, and
/// flatten(makeNavMesh(p)) equals p where every vertex of p is named by a polygon. `navMesh` must
/// be valid. O(corners).
PolygonMesh flatten(const NavMesh& navMesh);

/// Checks every promise above: settings within their ranges, rings that are convex,
/// counter-clockwise and finite, half-edge links that close, one fan a vertex, copies of a vertex
/// in one place; border portals in order, their ends on both edges within 1 cm on the plan and
/// `settings.climb` in height, left and right as the walker has them; height rows that cover the
/// height triangles. Returns the first broken one (kDataDamaged, naming where and value). O(corners
/// log corners); for tests, Debug loading and files from outside.
[[nodiscard]] tl::expected<void, Error> validate(const NavMesh& navMesh);

}  // namespace forewalk::navmesh
