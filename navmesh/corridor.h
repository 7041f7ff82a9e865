// Finds a corridor: the portals to walk through from one place to another.
//
// A* over half-portals. The cost of a corridor is the length of the walk through its portals'
// midpoints, the same measure the horizon search uses; pulled taut (navmesh/funnel.h), the path is
// shorter, and nearly always the shortest there is.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "navmesh/locate.h"
#include "navmesh/nav_graph.h"
#include "navmesh/polygon_states.h"

namespace forewalk::navmesh {

/// What a search needs from call to call: buffers, no results. One per thread; fits any graph, and
/// grows with the largest it has seen. Stamped, not cleared, so that a short search is a cheap one.
class CorridorScratch {
 public:
  CorridorScratch() = default;

 private:
  friend bool findCorridor(const NavGraph&, const Location&, const Location&, CorridorScratch&,
                           std::vector<std::uint32_t>&, const PolygonStates*);

  struct State {
    float length;            // from the start to the half-portal's midpoint, metres
    std::uint32_t previous;  // half-portal before it; its own index at the start
    std::uint32_t stamp;     // of the search that wrote this
    bool settled;
  };
  struct Candidate {
    float total;  // length so far, and straight on to the goal
    float length;
    std::uint32_t halfPortal;
  };
  std::vector<State> states_;  // per half-portal
  std::vector<Candidate> heap_;
  std::uint32_t stamp_ = 0;
};

/// Replaces `corridor` with the half-portals from `from` to `to` in walking order (each leads out
/// of the polygon that the one before leads into), of the shortest walk through portal midpoints;
/// among equal ones the half-portal with the smaller index settles first. Empty where both are in
/// one polygon.
///
/// False, and empty, where there is no way: the two are in different components, or a polygon is
/// not one of the graph's.
///
/// Where `states` of this graph are given, a metre through a polygon counts for as many as it
/// costs, and what is closed is not entered: false as well where the goal's polygon is closed, or
/// all that leads there. Who stands in a closed polygon may leave it, and walks to any place of it.
/// Links are not taken.
///
/// Costs O(n log n) of the half-portals looked at. Allocates only where the scratch or `corridor`
/// has to grow.
bool findCorridor(const NavGraph& graph, const Location& from, const Location& to,
                  CorridorScratch& scratch, std::vector<std::uint32_t>& corridor,
                  const PolygonStates* states = nullptr);

/// Replaces `corridor` with the half-portals that `path` crosses, in walking order: a path on the
/// walkable area that begins in polygon `first` and bends at ends of portals, as taut paths do.
/// Points may lie a millimetre beside.
///
/// False, with those found so far, where the path leaves the walkable area. O(half-portals of the
/// polygons crossed); allocates only where `corridor` has to grow.
bool corridorAlong(const NavGraph& graph, PolygonId first, std::span<const glm::vec2> path,
                   std::vector<std::uint32_t>& corridor);

}  // namespace forewalk::navmesh
