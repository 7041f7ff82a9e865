// Predicts, every frame, where the user may go within a horizon.
//
// Azmandian, Grechkin, Bolas and Suma (3DUI 2016), as mended in DESIGN.md section 3: depth-limited
// Dijkstra over the navgraph from the user's polygon (horizon_search.h), branch and terminal nodes
// with prevPG links, taut paths along the links.
//
// Which polygon-to-polygon distance: from the midpoint of the portal a polygon is entered by to the
// midpoint of the one it is left by. It is closer to the walk than centroid to centroid, which
// swings through every polygon's middle, and it is known at load. bench/prediction_error prints
// both against exact shortest paths. The distance only orders the search; whether a polygon is
// within the horizon is decided by its taut path.
//
// The ways: a way that is cut ends in a terminal at exactly the horizon, placed on the taut path
// toward the first polygon beyond; the polygon before it is then no terminal of its own. A way that
// ends because every neighbour is on a way already ends at the last polygon's centroid, as a dead
// end.
//
// Where polygons are closed or cost more (navmesh/polygon_states.h) the ways are those that people
// take then: none through what is closed, and around what costs more where that is cheaper. All
// lengths are metres of walking still, and the horizon is too.
//
// Links (navmesh/links.h), a part of the states, lead from polygon to polygon as portals do: a
// polygon's neighbours are those that its links lead to as well, so that it may be a branch, and
// two nodes that a link joins and the tree does not have a loop edge. A way through one goes to its
// entry, counts its length, and goes on from its exit; both are corners. Where the horizon falls
// into a link the terminal lies in it: on the straight line from entry to exit, as far along as is
// walked, in the entry's polygon. PredictionGraph::linkSteps says which edges lead through which.
#pragma once

#include "navmesh/polygon_states.h"
#include "prediction/horizon_search.h"
#include "prediction/prediction_graph.h"

namespace forewalk::prediction {

/// Sizes fixed at load, so that no frame allocates.
struct PredictionLimits {
  std::uint32_t polygons = 16384;  ///< settled in one graph, >= 1; about 150 bytes each
};

/// What predictions need from frame to frame: buffers and the latest graph. One per user; not
/// shared between threads. Tied to the graph it was made for, which must outlive it.
class Scratch {
 public:
  explicit Scratch(const navmesh::NavGraph& graph, const PredictionLimits& limits = {});

 private:
  friend const PredictionGraph& predict(const navmesh::NavGraph&, const navmesh::Location&, float,
                                        Scratch&, const navmesh::PolygonStates*);
  HorizonSearch search_;
  PredictionGraph graph_;
  std::vector<std::uint32_t> nodeOf_;      // per tree index: its node, or kNone
  std::vector<std::uint32_t> treeOf_;      // per node: its tree index
  std::vector<navmesh::Portal> corridor_;  // of the edge at hand
  std::vector<glm::vec2> path_;            // of the edge at hand
};

/// The prediction graph around `source` (from navmesh::locate) out to `horizon` metres (>= 0,
/// finite), where `states` of this navgraph say what is closed and what costs more; none: all is
/// open. Nobody enters a closed polygon; who stands in one may leave it.
///
/// Never fails: an invalid source polygon gives a graph of the source alone with kSourceOffMesh,
/// and a graph that reaches the polygon limit says so (kPolygonLimit), its dropped ways ending as
/// horizon terminals short of the horizon.
///
/// The result belongs to `scratch` and lives until its next prediction. Costs O(n log n) in the
/// polygons within the horizon, whatever the size of the world; allocates nothing once the buffers
/// have grown to the largest graph seen.
const PredictionGraph& predict(const navmesh::NavGraph& graph, const navmesh::Location& source,
                               float horizon, Scratch& scratch,
                               const navmesh::PolygonStates* states = nullptr);

}  // namespace forewalk::prediction
