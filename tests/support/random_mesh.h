// Navmeshes for tests: random ones, plain ones, and the transforms that laws speak of.
//
// All lie on the plan's first quadrant around height 0 unless said otherwise, counter-clockwise and
// welded, ready for makeNavGraph.
#pragma once

#include <cstdint>
#include <span>

#include "navmesh/polygon_mesh.h"

namespace forewalk::testing {

/// Shares are probabilities in [0, 1].
struct RandomMeshOptions {
  double holeShare = 0.2;    ///< of the cells that are not walkable
  double splitShare = 0.25;  ///< of the quads that are cut into two triangles
  double mergeShare = 0.5;   ///< of the neighbouring pairs that are merged, where that is convex
  double jitter = 0.22;      ///< how far a corner moves on each axis, in cells; at most 0.24
  float heights = 0.0f;      ///< corners lie at random heights up to this, metres
  float cell = 1.0f;         ///< metres
};

/// A jittered grid of quads, some missing, some cut, some merged: loops, dead ends, several
/// components, polygons of 3 to 6 corners and 0 to 6 neighbours. Its outline is a rectangle, so
/// that joinedAlong fits. Never empty (a cell is kept where all would go).
navmesh::PolygonMesh randomMesh(std::uint64_t seed, int columns, int rows,
                                const RandomMeshOptions& options = {});

/// Squares of side `cell`, polygon `row * columns + column`.
navmesh::PolygonMesh gridMesh(int columns, int rows, float cell = 1.0f);

/// Rectangles one after the other along plan x, `width` wide.
navmesh::PolygonMesh corridorMesh(std::span<const float> lengths, float width = 1.0f);

/// `right` moved so that its smallest x meets the largest x of `left`, and joined to it by border
/// portals wherever edges that lie there overlap: what a tile border looks like.
navmesh::PolygonMesh joinedAlong(const navmesh::PolygonMesh& left,
                                 const navmesh::PolygonMesh& right);

/// Two grids of the same outer height side by side, cut into `leftRows` and `rightRows` rows,
/// joined by partial portals.
navmesh::PolygonMesh joinedGrids(int columns, int leftRows, int rightRows, float height);

/// Both meshes, not joined; `second` moved by (x, height, z).
navmesh::PolygonMesh together(const navmesh::PolygonMesh& first, const navmesh::PolygonMesh& second,
                              glm::vec3 moved);

/// Turned about the origin, counter-clockwise seen from above, radians.
navmesh::PolygonMesh turned(const navmesh::PolygonMesh& mesh, float angle);

/// Mirrored: plan x becomes -x, rings reversed to stay counter-clockwise.
navmesh::PolygonMesh mirrored(const navmesh::PolygonMesh& mesh);

/// All coordinates times `factor` > 0.
navmesh::PolygonMesh scaled(const navmesh::PolygonMesh& mesh, float factor);

/// Copies side by side, a metre apart and not joined. Copy 0 keeps its ids and its place.
navmesh::PolygonMesh repeated(const navmesh::PolygonMesh& mesh, int columns, int rows);

}  // namespace forewalk::testing
