// What makeNavGraph and the joining of tiles (build/tile_pieces.h) have in common. Internal.
#pragma once

#include <glm/glm.hpp>
#include <tl/expected.hpp>

#include "navmesh/error.h"
#include "navmesh/nav_graph.h"

namespace forewalk::navmesh {

inline glm::vec2 midpointOf(const Portal& portal) { return 0.5f * (portal.left + portal.right); }

/// How far along a polygon's edge, which runs from `begin` to `end`, a portal's midpoint lies,
/// metres: sorts the portals of one edge.
inline float alongEdge(glm::vec2 begin, glm::vec2 end, const Portal& portal) {
  const glm::vec2 edge = end - begin;
  const float length = glm::length(edge);
  return length > 0.0f ? glm::dot(midpointOf(portal) - begin, edge) / length : 0.0f;
}

/// Fills in what follows from rings, centroids and the rows of half-portals (portalStart, portalTo,
/// portals, portalMidpoint, portalTwin): successors, neighbour counts, components, chains.
///
/// Fails when there are more than 2^28 ways through polygons from portal to portal (kTooLarge).
/// O(half-portals), about.
[[nodiscard]] tl::expected<void, Error> completeRows(NavGraph& graph);

}  // namespace forewalk::navmesh
