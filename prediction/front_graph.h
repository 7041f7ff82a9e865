// Prediction graphs by fronts: real junctions, whatever polygons the building is cut into.
//
// A way is a piece of the front of all points at one distance from the user. Where it splits is a
// branch, where pieces meet is a join, where one dies is a dead end, and where it reaches the
// horizon is a terminal (front_sweep.h). Ways that end less than a persistence length beyond their
// branch are merged into it, lowest first along each way (Pascucci, Scorzelli, Bremer and
// Mascarenhas, SIGGRAPH 2007; persistence after Edelsbrunner, Letscher and Zomorodian, 2002), so
// that a niche is not a corridor. The result has the same form as the paper's graph
// (prediction_graph.h) and answers the same questions.
//
// What differs: distances are exact; a branch lies where the front touches the wall that splits it,
// not where people turn; the path of an edge is that part of the shortest path to its `from` node
// that lies beyond the distance of its `to` node, and its corridor is not listed.
//
// A link (navmesh/links.h) that shortest paths lead through is a way that leaves its entry, where
// it branches off, and comes out of its exit; both are corners of the paths through it. One that is
// longer than walking is none. A way that the horizon cuts in a link ends there: on the straight
// line from entry to exit, in the entry's polygon, with a front of no length. Of edges that lead
// through links the corridor has the polygons where each stretch of floor begins and ends, of the
// last one where it begins.
#pragma once

#include <memory>

#include "navmesh/polygon_states.h"
#include "prediction/front_sweep.h"
#include "prediction/prediction_graph.h"

namespace forewalk::prediction {

/// What graphs by fronts need to know of a navgraph, and of what is closed in it. Made once, then
/// only read, by any number of threads.
struct FrontIndex {
  std::shared_ptr<const navmesh::NavGraph> open;  ///< openPart() of the graph; null: all is open
  std::vector<bool> closed;                       ///< per polygon; empty: none is
  navmesh::Links links;                           ///< those between places that are open
  PortalEnds ends;                                ///< of `open`, or of the graph
  CellMesh cells;                                 ///< likewise
};

/// For `graph` where `states` of it (null: none) say what is closed and where links lead. What
/// costs more is as good as any ground here: fronts know of metres only. O(n log n) in the
/// half-portals: some 0.5 ms for 1,000 polygons.
FrontIndex makeFrontIndex(const navmesh::NavGraph& graph,
                          const navmesh::PolygonStates* states = nullptr);

struct FrontSettings {
  float persistence = 0.75f;  ///< metres, >= 0: shorter ways are part of the one they leave
};

/// What is remembered between frames: buffers and the latest graph. One per user; not shared
/// between threads. Tied to the graph and index it was made for, which must outlive it.
class FrontScratch {
 public:
  FrontScratch(const navmesh::NavGraph& graph, const FrontIndex& index,
               const DistanceLimits& limits = {});

  /// Distances of the latest graph; they live until the next.
  const DistanceField& distances() const { return field_; }

 private:
  friend class FrontAssembly;
  friend const PredictionGraph& predictFronts(const navmesh::NavGraph&, const navmesh::Location&,
                                              float, FrontScratch&, const FrontSettings&);
  /// An arc of the sweep, with those that were merged into it.
  struct Way {
    std::uint32_t from, to;  // events; to: kNone at the horizon
    std::uint32_t last;      // arc at its end
    bool gone;
    std::uint32_t nextOut, nextIn;  // of the same event, or kNone
    std::uint32_t mergedInto;       // itself, unless merged
    HorizonFront front;             // of all its pieces at the horizon; length 0: none
  };

  const FrontIndex* index_;
  const navmesh::NavGraph* navGraph_;  // the open part
  DistanceField field_;
  FrontSweep sweep_;
  PredictionGraph graph_;
  std::vector<Way> ways_;
  std::vector<std::uint32_t> firstOut_, firstIn_;  // per event
  std::vector<std::uint32_t> nodeOf_;              // per event: its node, or kNone
};

/// The graph around `source` (from navmesh::locate) out to `horizon` metres (>= 0, finite).
///
/// Somebody who stands on what is closed is taken to be at the nearest portal that leads from there
/// to what is open; links do not. Never fails: an invalid source polygon, or a closed one from
/// where none does, gives a graph of the source alone with kSourceOffMesh; if the window limit is
/// reached, `completeTo` says how far the graph is right, and kPolygonLimit is set.
///
/// The result belongs to `scratch` and lives until its next prediction. Costs O(n log n) in what
/// lies within the horizon; allocates only while buffers grow to the largest graph seen.
const PredictionGraph& predictFronts(const navmesh::NavGraph& graph,
                                     const navmesh::Location& source, float horizon,
                                     FrontScratch& scratch, const FrontSettings& settings = {});

}  // namespace forewalk::prediction
