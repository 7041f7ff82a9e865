// The navgraph: what every frame searches. Polygons are its nodes, portals its edges.
//
// Made once from the polygons, then only read, by any number of threads. All arrays are flat and
// indexed by 32-bit numbers; what a search touches (portal targets, successor lengths) lies apart
// from what only drawing and loading need.
//
// Lengths are measured on the plan (horizontal metres): redirection maps horizontal virtual metres to
// horizontal physical metres, and a body on virtual stairs walks on a flat floor. Heights are kept
// beside.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <tl/expected.hpp>
#include <vector>

#include "navmesh/chains.h"
#include "navmesh/error.h"
#include "navmesh/plan.h"
#include "navmesh/polygon_mesh.h"

namespace forewalk::navmesh {

/// The two ends of a portal as seen by somebody walking through it; plan, metres.
/// `left == right` is a pinch point and is allowed.
struct Portal {
  glm::vec2 left;
  glm::vec2 right;
};

/// World heights (y) of a portal's two ends, metres.
struct PortalHeights {
  float left;
  float right;
};

/// Compressed rows: polygon `p` owns half-portals [portalStart[p], portalStart[p + 1]), the ways out of
/// it. Each portal is stored twice, once a side; `portalTwin` names the other half.
struct NavGraph {
  // What the horizon search touches.
  std::vector<std::uint32_t> portalStart{0};    ///< polygons + 1
  std::vector<PolygonId> portalTo;              ///< per half-portal: where it leads
  std::vector<std::uint32_t> successorStart;    ///< per half-portal: its row in `successorLength`
  std::vector<float> successorLength;           ///< row of h: from h's midpoint to the midpoint of each
                                                ///< half-portal of portalTo[h], in row order; metres
  std::vector<float> portalToCentroid;          ///< per half-portal: midpoint to centroid of portalTo
  std::vector<glm::vec2> portalMidpoint;        ///< per half-portal; plan
  std::vector<Portal> portals;                  ///< per half-portal, left and right walking out; plan
  std::vector<glm::vec2> centroid;              ///< per polygon, of its area; plan
  std::vector<std::uint32_t> neighbourCount;    ///< per polygon: distinct neighbours, deg(u) of the paper

  Chains chains;                                ///< runs of polygons with two neighbours each

  // What location, heights and drawing touch.
  std::vector<std::uint32_t> ringStart{0};      ///< polygons + 1 offsets into ring, ringHeight
  std::vector<glm::vec2> ring;                  ///< corners, counter-clockwise; plan
  std::vector<float> ringHeight;                ///< world y of each corner
  std::vector<std::uint32_t> portalTwin;        ///< per half-portal: the same portal from the other side
  std::vector<std::uint32_t> portalEdge;        ///< per half-portal: its edge, counted within the ring
  std::vector<PortalHeights> portalHeights;     ///< per half-portal
  std::vector<float> centroidHeight;            ///< per polygon: surface height at the centroid, world y
  std::vector<std::uint32_t> component;         ///< per polygon: connected component, dense from 0 in
                                                ///< order of each component's smallest polygon id
  std::vector<std::uint32_t> heightStart;       ///< polygons + 1 offsets into heightTriangles; or empty
  std::vector<HeightTriangle> heightTriangles;
  std::uint32_t componentCount = 0;

  std::uint32_t polygonCount() const { return static_cast<std::uint32_t>(centroid.size()); }
  std::uint32_t portalCount() const { return static_cast<std::uint32_t>(portalTo.size()); }

  /// Corners of a polygon, counter-clockwise on the plan. Lives as long as the graph is not changed.
  std::span<const glm::vec2> ringOf(PolygonId polygon) const {
    const std::uint32_t begin = ringStart[index(polygon)];
    return {ring.data() + begin, ringStart[index(polygon) + 1] - begin};
  }
};

/// Makes the navgraph. Neighbours are polygons that share an edge (the same two vertices), and those
/// named by `borderPortals`. Two polygons may be joined by several portals. Half-portals of a polygon
/// are sorted by (edge, position along it), so that the same mesh gives the same graph.
///
/// Fails when an index is out of range, a coordinate is not finite, a ring has fewer than 3 corners,
/// is not convex or not counter-clockwise (tolerance 1 mm), an edge has more than two polygons or two on
/// the same side (kDataDamaged, naming polygon and value), the mesh has no polygon (kSceneEmpty), or
/// there are more than 2^28 ways through polygons from portal to portal (kTooLarge).
///
/// Costs O(n log n) of all corners; allocates the graph.
[[nodiscard]] tl::expected<NavGraph, Error> makeNavGraph(const PolygonMesh& mesh);

/// World height of the surface of `polygon` above `plan`; the nearest point's height where `plan` lies
/// outside. O(height triangles of the polygon).
float heightAt(const NavGraph& graph, PolygonId polygon, glm::vec2 plan);

/// Whether `plan` lies in `polygon`, its border included. No point falls between two polygons that share
/// an edge: seen from the point, the edge's two sides give opposite numbers to the last bit.
inline bool contains(const NavGraph& graph, PolygonId polygon, glm::vec2 plan) {
  const std::span<const glm::vec2> ring = graph.ringOf(polygon);
  glm::vec2 a = ring.back() - plan;
  for (const glm::vec2 corner : ring) {
    const glm::vec2 b = corner - plan;
    if (!(cross(a, b) >= 0.0f)) return false;
    a = b;
  }
  return true;
}

/// The same, widened by `tolerance` metres.
bool contains(const NavGraph& graph, PolygonId polygon, glm::vec2 plan, float tolerance);

/// Area on the plan, m^2.
float areaOf(const NavGraph& graph, PolygonId polygon);

}  // namespace forewalk::navmesh
