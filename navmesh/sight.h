// What can be seen of the walkable floor from a place on it, as if walls were where it ends.
//
// Across portals from polygon to polygon: what is seen through a portal is what lies in the wedge
// between its ends (the triangular expansion of Bungiu et al. 2014, on convex polygons). Costs what
// is seen, whatever the size of the world.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "navmesh/locate.h"
#include "navmesh/nav_graph.h"

namespace forewalk::navmesh {

/// Metres on the plan from `place` along unit vector `direction` to the end of the floor, at most
/// `limit`; 0 without a polygon. O(polygons crossed), allocates nothing.
double sightAlong(const NavGraph& graph, const Location& place, glm::dvec2 direction, double limit);

/// A triangle of what is seen: the place, and a piece of the end of the floor from `right` to
/// `left`, counter-clockwise; plan.
struct SightSlice {
  glm::dvec2 right{0.0};
  glm::dvec2 left{0.0};
};

struct SightScratch {
  struct Wedge {
    PolygonId polygon;
    std::uint32_t cameBy;  // half-portal of `polygon`
    glm::dvec2 right, left;
  };
  std::vector<Wedge> open;
};

/// Replaces `slices` with what is seen from `place` up to about `reach` metres, at most `most`
/// slices, in no order around it. Portals further away than `reach` count as the end of the floor.
/// Allocates where the vectors have to grow; with `most` reserved in both, never.
void visibleSlices(const NavGraph& graph, const Location& place, double reach, std::size_t most,
                   SightScratch& scratch, std::vector<SightSlice>& slices);

}  // namespace forewalk::navmesh
