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
  std::vector<BorderPortal> borderPortals;
  std::vector<std::uint32_t> heightStart;  ///< as in PolygonMesh
  std::vector<HeightTriangle> heightTriangles;
};

/// Half-edge topology for flat polygons (from Recast, from a file). Fails as makeNavGraph does.
[[nodiscard]] tl::expected<NavMesh, Error> makeNavMesh(const PolygonMesh& polygons,
                                                       const BuildSettings& settings);

/// The flat form, with vertices welded again across fans. makeNavMesh(flatten(m)) equals m.
PolygonMesh flatten(const NavMesh& navMesh);

/// Checks every promise above: convex, counter-clockwise, finite, half-edge links that close, border
/// portals that lie on both their edges within `settings.climb`. Returns the first broken one.
/// O(corners); for tests, Debug loading and files from outside.
[[nodiscard]] tl::expected<void, Error> validate(const NavMesh& navMesh);

}  // namespace forewalk::navmesh
