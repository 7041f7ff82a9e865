// The walkable polygons as flat arrays: what `.fwmesh` files carry and what a NavGraph is made
// from.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <tl/expected.hpp>
#include <vector>

#include "navmesh/error.h"

namespace forewalk::navmesh {

/// Index of a polygon in its navmesh, dense from 0.
enum class PolygonId : std::uint32_t {};

/// No polygon.
inline constexpr PolygonId kNoPolygon{0xffffffffu};

/// The polygon's place in arrays.
constexpr std::uint32_t index(PolygonId id) { return static_cast<std::uint32_t>(id); }

/// A stretch where two polygons touch without sharing a whole edge (across a tile border).
/// `left` and `right` are those of somebody walking from `from` to `to`; world space, metres. Named
/// once for both directions.
struct BorderPortal {
  PolygonId from;
  PolygonId to;
  std::uint32_t fromEdge;  ///< edge of `from` it lies on: from ring corner `fromEdge` to the next
  std::uint32_t toEdge;    ///< edge of `to` it lies on
  glm::vec3 left;
  glm::vec3 right;

  bool operator==(const BorderPortal&) const = default;
};

/// A triangle of the surface's true height inside a polygon; world space, metres.
struct HeightTriangle {
  glm::vec3 a, b, c;

  bool operator==(const HeightTriangle&) const = default;
};

/// Convex polygons, counter-clockwise seen from above (on the plan, see plan.h). Vertices are
/// welded: polygons that share an edge name the same two vertices. World space, metres.
struct PolygonMesh {
  std::vector<glm::vec3> vertices;
  std::vector<std::uint32_t> ringStart{0};  ///< polygons + 1 offsets into `ring`
  std::vector<std::uint32_t> ring;          ///< vertex indices, polygon after polygon
  std::vector<BorderPortal> borderPortals;  ///< in ascending order of (from, fromEdge, to, toEdge)

  /// Where the surface deviates from the polygon's own corners (stairs, uneven ground): triangles
  /// of its height, polygon after polygon. Both empty: the polygons are as flat as their corners
  /// say.
  std::vector<std::uint32_t>
      heightStart;  ///< polygons + 1 offsets into `heightTriangles`, or empty
  std::vector<HeightTriangle> heightTriangles;

  std::uint32_t polygonCount() const { return static_cast<std::uint32_t>(ringStart.size()) - 1; }

  bool operator==(const PolygonMesh&) const = default;
};

/// Checks what is said above of each array and each polygon alone; edges are compared where they
/// are joined (makeNavGraph, makeNavMesh).
///
/// A polygon is convex and counter-clockwise if its ring walks once around the hull of its corners
/// and none lies more than 1 mm inside it. One narrower than 1 mm has no direction to be wrong in;
/// it may even have no area (Recast makes such triangles where corners lie in a line).
///
/// Fails when an index is out of range, a coordinate is not finite, a ring has fewer than 3
/// corners, names a vertex twice, is not convex or not counter-clockwise, or offsets do not cover
/// their array (kDataDamaged, naming polygon and value), or the mesh has no polygon (kSceneEmpty).
///
/// O(n log n) of a polygon's corners; allocates scratch.
[[nodiscard]] tl::expected<void, Error> validate(const PolygonMesh& mesh);

}  // namespace forewalk::navmesh
