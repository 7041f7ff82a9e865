// Exact shortest paths by brute force: what taut paths and path distances are judged by.
//
// Visibility graphs: a shortest path bends at the ends of walls only, and between two bends it is a
// straight segment that stays inside. Whether a segment stays inside is found by flooding: from the
// polygons at its start, over every portal that it touches. All in double precision.
#pragma once

#include <span>
#include <vector>

#include "navmesh/nav_graph.h"

namespace forewalk::testing {

/// A point and a polygon that holds it.
struct PlanPlace {
  navmesh::PolygonId polygon;
  glm::vec2 plan;
};

/// Shortest paths on the plan inside the walkable polygons of one storey. Walking goes through
/// portals only: two polygons that merely touch are not joined. O(corners^2 * polygons crossed) on
/// the first query, O(corners^2) on the next. Keeps a reference to `graph`.
class VisibilityGraph {
 public:
  explicit VisibilityGraph(const navmesh::NavGraph& graph);

  /// Length of the shortest walk, metres; infinity where there is none.
  float shortest(const PlanPlace& from, const PlanPlace& to) const;

  /// The same to each of `to`, for the price of one.
  std::vector<float> shortest(const PlanPlace& from, std::span<const PlanPlace> to) const;

  /// Whether the segment between the two stays inside, its touching of walls included.
  bool visible(const PlanPlace& from, const PlanPlace& to) const;

 private:
  void connect() const;

  const navmesh::NavGraph& graph_;
  std::vector<PlanPlace> corners_;                        // both ends of every wall
  mutable std::vector<std::vector<std::uint32_t>> seen_;  // per corner: corners in sight
  mutable std::vector<std::uint32_t> stamp_;              // per polygon: last flood that came by
  mutable std::uint32_t flood_ = 0;
};

/// VisibilityGraph for one question. The places are found by brute force; infinity where one lies
/// off the navmesh.
float visibilityShortest(const navmesh::NavGraph& graph, glm::vec2 from, glm::vec2 to);

/// Length of the shortest path from `start` to `goal` that crosses `portals` in order, each turned
/// as in a corridor of convex polygons. O(portals^3).
float visibilityShortestInCorridor(std::span<const navmesh::Portal> portals, glm::vec2 start,
                                   glm::vec2 goal);

/// The same for a row of half-portals of `graph`, in walking order.
float visibilityShortestInCorridor(const navmesh::NavGraph& graph,
                                   std::span<const std::uint32_t> corridor, glm::vec2 start,
                                   glm::vec2 goal);

}  // namespace forewalk::testing
