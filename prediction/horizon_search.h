// Depth-limited Dijkstra from the user over the navgraph, with the exact taut length to every polygon.
//
// DESIGN.md section 3, step 2. Two numbers belong to a polygon. Its key orders the search: the length
// of the walk from the user through portal midpoints, up to the midpoint of the portal it is entered
// by. Its taut length decides whether it lies within the horizon: the shortest path from the user to
// its centroid through the corridor that the search found.
//
// Taut lengths come from a funnel tree: the funnel of Lee and Preparata (1984) kept for every node of
// the search tree, sharing all corners with its parent's (as in Guibas, Hershberger, Leven, Sharir and
// Tarjan, "Linear-time algorithms for visibility and shortest path problems inside triangulated simple
// polygons", Algorithmica 2, 1987). A child adds at most two corners and walks back along one side.
//
// The taut length lies between the straight line and the key plus the last step to the centroid, so it
// is computed only where those two lie on different sides of the horizon.
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "navmesh/key_queue.h"
#include "navmesh/nav_graph.h"
#include "prediction/prediction_graph.h"

namespace forewalk::prediction {

/// No tree index, no half-portal.
inline constexpr std::uint32_t kNone = 0xffffffffu;

/// A settled polygon. Parents come before children; 0 is the source.
struct SearchNode {
  PolygonId polygon;
  std::uint32_t parent;   ///< index in the tree; of the source: 0
  std::uint32_t portal;   ///< half-portal of the parent's polygon it was entered by; source: kNone
  float key;              ///< metres, see above; source: 0
  std::uint32_t prevPG;   ///< index in the tree: the branch node or source before it; source: 0
  std::uint32_t apex;     ///< corner: where left and right side of the funnel part
  std::uint32_t left;     ///< corner: end of the funnel's left side, the entry portal's left end
  std::uint32_t right;    ///< corner: end of its right side
  bool within;            ///< taut length <= horizon: it was expanded
  bool branch;            ///< within, and more than two neighbours
  bool hasWithinChild;    ///< the way goes on to a polygon that is within
  bool hasCutChild;       ///< the way goes on to a polygon that is not
  bool dropped;           ///< the way goes on, but the polygon limit stopped the search
};

/// The search and all it remembers between frames. Not shared between threads.
class HorizonSearch {
 public:
  /// Sizes every buffer for at most `polygonLimit` settled polygons. The graph must outlive this.
  HorizonSearch(const navmesh::NavGraph& graph, std::uint32_t polygonLimit);

  /// Searches from `source` (a valid polygon, `source.plan` in it) out to `horizon` metres (>= 0).
  /// Corners go into `corners`, which is cleared. O(n log n) in the polygons within the horizon,
  /// whatever the size of the graph.
  void run(const navmesh::Location& source, float horizon, std::vector<Corner>& corners);

  const std::vector<SearchNode>& tree() const { return tree_; }
  bool limitReached() const { return limitReached_; }
  std::uint32_t relaxed() const { return relaxed_; }
  std::uint32_t cornerCapacity() const { return 2 * limit_ + 1; }

  /// The tree index of a polygon settled by the last run, or kNone.
  std::uint32_t treeIndexOf(PolygonId polygon) const { return reach_[index(polygon)].treeIndex; }

  /// The corner before a point `end` in the polygon of tree node `node` on the taut path from the
  /// source to it.
  std::uint32_t cornerBefore(const std::vector<Corner>& corners, std::uint32_t node,
                             glm::vec2 end) const;

 private:
  /// What is known of a polygon. Stamped by resetting what the last run settled, never cleared.
  struct Reach {
    float key = std::numeric_limits<float>::infinity();
    std::uint32_t portal = kNone;
    std::uint32_t parent = kNone;
    std::uint32_t treeIndex = kNone;
  };

  void reset();
  void dropQueue();
  void relaxFromSource(const navmesh::Location& source);
  void relax(std::uint32_t node);
  void extendFunnel(SearchNode& node, std::vector<Corner>& corners) const;

  const navmesh::NavGraph* graph_;
  std::uint32_t limit_;
  std::vector<Reach> reach_;           // per polygon
  navmesh::KeyQueue queue_;
  std::vector<SearchNode> tree_;
  std::uint32_t relaxed_ = 0;
  bool limitReached_ = false;
};

}  // namespace forewalk::prediction
