// A prediction graph as the flat arrays that the C interface shows.
#pragma once

#include <vector>

#include "navmesh/nav_graph.h"
#include "prediction/likelihood.h"
#include "prediction/prediction_graph.h"
#include "service/capi/forewalk.h"

namespace forewalk::capi {

/// Owned by a session, filled when somebody asks.
class FlatGraph {
 public:
  /// Makes room for every graph by polygons of up to `polygons` settled polygons of `graph`, over
  /// whatever ground: flatten() then allocates nothing. For graphs by fronts, which have no such
  /// bound, it makes room for more than buildings need. O(polygons of the navmesh).
  FlatGraph(const navmesh::NavGraph& graph, std::uint32_t polygons, prediction::Method method);

  /// Replaces the arrays by those of `graph`, which was predicted on `navGraph`. Paths are lifted
  /// onto the floor, to 2 cm.
  void flatten(const navmesh::NavGraph& navGraph, const prediction::PredictionGraph& graph,
               forewalk_axes axes);

  /// Adds the names and likelihoods of the ways of the graph that was flattened last.
  void addWays(const prediction::WayLikelihood& likelihood);

  void clear();

  /// The arrays live until the next flatten() or clear().
  forewalk_graph_view view() const;

 private:
  void reserveForPolygons(const navmesh::NavGraph& graph, std::size_t count);
  void addEdge(const navmesh::NavGraph& navGraph, const prediction::PredictionGraph& graph,
               const prediction::Edge& edge, forewalk_axes axes);

  float horizon_ = 0.0f;
  float completeTo_ = 0.0f;
  prediction::Method method_;
  std::vector<forewalk_node> nodes_;
  std::vector<forewalk_edge> edges_;
  std::vector<forewalk_vec3> points_;
  std::vector<forewalk_front> fronts_;
  std::vector<float> widths_;  // one an edge
  std::vector<forewalk_way> ways_;
  std::vector<forewalk_way_event> events_;
  float none_ = 1.0f;
  std::vector<std::uint32_t> portals_;  // of the edge at hand
  std::vector<glm::vec3> lifted_;       // of the edge at hand
};

}  // namespace forewalk::capi
