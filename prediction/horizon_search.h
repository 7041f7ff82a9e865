// Depth-limited Dijkstra from the user over the navgraph, with the exact taut length to every
// polygon.
//
// DESIGN.md section 3, step 2. Two numbers belong to a polygon. Its key orders the search: the
// length of the walk from the user through portal midpoints, up to the midpoint of the portal it is
// entered by. Its taut length decides whether it lies within the horizon: the shortest path from
// the user to its centroid through the corridor that the search found.
//
// Taut lengths come from a funnel tree (funnel_tree.h).
//
// The taut length lies between the way by the last bend that is known and the key plus the last
// step to the centroid, so it is computed only where those two lie on different sides of the
// horizon.
//
// Chains (navmesh/chains.h) are crossed in one step: only polygons where ways part, and the
// arrivals at the far ends of chains, go through the queue. The tree is that of the plain search,
// in another order: a chain is settled when the way through it arrives, or when it is entered from
// its far end as well and the two ways meet inside.
//
// Polygons may be closed or cost more (navmesh/polygon_states.h). A closed polygon is not entered:
// the tree is that of the graph without it. Who stands in one sees what they would see were it
// open. A step through a polygon, from portal midpoint to portal midpoint, counts as often in the
// key as the polygon costs, so that the tree holds the ways people take: a dear one only where the
// way around costs as much. Taut lengths and the horizon stay metres of walking: a way around that
// is longer than the horizon is cut there, even where the dear way would not be.
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "navmesh/key_queue.h"
#include "navmesh/nav_graph.h"
#include "navmesh/polygon_states.h"
#include "prediction/funnel_tree.h"
#include "prediction/prediction_graph.h"

namespace forewalk::prediction {

/// A settled polygon. Parents come before children, 0 is the source; the order is no other.
struct SearchNode {
  PolygonId polygon;
  std::uint32_t parent;  ///< index in the tree; of the source: 0
  std::uint32_t portal;  ///< of the parent's polygon it was entered by, as TreeLink has it
  float key;             ///< metres, each as often as it costs, see above; source: 0
  std::uint32_t corner;  ///< before its centroid on the taut path (FunnelTree::cornerBefore with
                         ///< the horizon as enough), where the search needed it; else kNone
  std::uint32_t prevPG;  ///< index in the tree: the branch node or source before it; source: 0
  bool within;           ///< taut length <= horizon: it was expanded
  bool branch;           ///< within, and more than two neighbours
  bool hasWithinChild;   ///< the way goes on to a polygon that is within
  bool hasCutChild;      ///< the way goes on to a polygon that is not
  bool dropped;          ///< the way goes on, but the polygon limit stopped the search
};

/// The search and all it remembers between frames. Not shared between threads.
class HorizonSearch {
 public:
  /// What decides whether a polygon is within the horizon.
  enum class Limit {
    kTaut,  ///< its taut path, as DESIGN.md has it
    kKey,   ///< its key and the step to its centroid: a plain depth-limited Dijkstra, to compare
            ///< with
  };

  /// Sizes every buffer for at most `polygonLimit` settled polygons. The graph must outlive this.
  HorizonSearch(const navmesh::NavGraph& graph, std::uint32_t polygonLimit);

  /// Searches from `source` (a valid polygon, `source.plan` in it) out to `horizon` metres (>= 0).
  /// Corners go into `corners`, which is cleared; reserve cornerCapacity(). `states` are of this
  /// graph; none: all is open. O(n log n) in the polygons within
  /// the horizon, whatever the size of the graph.
  void run(const navmesh::Location& source, float horizon, std::vector<Corner>& corners,
           Limit limit = Limit::kTaut, const navmesh::PolygonStates* states = nullptr);

  /// The settled polygons. Lives until the next run.
  std::span<const SearchNode> tree() const { return {tree_.data(), count_}; }
  bool limitReached() const { return limitReached_; }
  /// Every polygon with a smaller key than this is in the tree, metres; infinity unless the limit
  /// was reached.
  float completeTo() const { return completeTo_; }
  std::uint32_t relaxed() const { return relaxed_; }
  std::size_t cornerCapacity() const { return FunnelTree::cornerCapacity(limit_); }

  /// The tree index of a polygon settled by the last run, or kNone.
  std::uint32_t treeIndexOf(PolygonId polygon) const { return reach_[index(polygon)].treeIndex; }

  /// The last corner before `end`, a point in the polygon of tree node `node`, on the taut path
  /// from the source to it, or one of its corners that is `enough` metres or more away. May add
  /// corners to those of the last run.
  std::uint32_t cornerBefore(std::uint32_t node, glm::vec2 end,
                             float enough = std::numeric_limits<float>::infinity()) {
    return funnels_.cornerBefore(node, end, enough);
  }

  /// The tree's funnels, for the corners of links.
  const FunnelTree& funnels() const { return funnels_; }

 private:
  /// What is known of a polygon. Stamped by resetting what the last run settled, never cleared.
  struct Reach {
    float key = std::numeric_limits<float>::infinity();
    std::uint32_t portal = kNone;
    std::uint32_t parent = kNone;
    std::uint32_t treeIndex = kNone;
  };

  /// What is known of a chain, or of a part of the user's own chain.
  struct ChainReach {
    // kCut: settled up to the first row beyond the horizon; the rest is entered from its other end.
    enum Passage : std::uint32_t { kUntouched, kEntered, kCut, kSettled } passage = kUntouched;
    std::uint32_t directed = 0;  // the way it was entered
    std::uint32_t begin = 0;     // its first row; where it was cut: the row after that
    std::uint32_t node = 0;      // tree index of the polygon before it
    float key = 0.0f;            // a row's is `key` and its length
  };

  /// The end of a walk through rows of a chain.
  struct Walked {
    std::uint32_t node;  // tree index of the last polygon settled
    std::uint32_t row;   // the row after it
    bool cut;            // that polygon lies beyond the horizon
  };

  // Queue entries above this are arrivals at the end of a directed chain, others are polygons.
  static constexpr std::uint32_t kArrival = 0x80000000u;

  void reset();
  std::uint32_t settle(PolygonId polygon, std::uint32_t parent, std::uint32_t portal, float key);
  void settleTop(PolygonId polygon, const Reach& reach);
  void arrive(std::uint32_t directed, float key);
  void useStates(const navmesh::PolygonStates* states, PolygonId source);
  bool isEntered(std::uint32_t portal) const;
  bool isBranch(PolygonId polygon) const;
  void relaxFromSource(const navmesh::Location& source);
  void enterOwnChain(std::uint32_t portal, float key);
  void relax(std::uint32_t node);
  void relaxByCost(std::uint32_t node);
  void relaxLinks(std::uint32_t node, glm::vec2 from, float key, float cost);
  float stepToCentroid(const SearchNode& node) const;
  void offer(std::uint32_t portal, float key, std::uint32_t node);
  void label(PolygonId polygon, float key, std::uint32_t portal, std::uint32_t parent);
  void enqueue(float key, std::uint32_t entry);
  ChainReach& chainReach(std::uint32_t directed);
  void touch(ChainReach& chain, ChainReach::Passage passage);
  void enterChain(std::uint32_t directed, float key, std::uint32_t node);
  void startChain(ChainReach& chain, std::uint32_t directed, std::uint32_t begin, float key,
                  std::uint32_t node);
  Walked settleChain(ChainReach& chain);
  void settleRest(ChainReach& chain, std::uint32_t directed, float key, std::uint32_t node);
  void settleMeeting(ChainReach& chain, std::uint32_t directed, float key, std::uint32_t node);
  Walked settleRows(std::uint32_t directed, std::uint32_t begin, std::uint32_t end, float key,
                    std::uint32_t node);
  void dropQueue();
  bool judge(std::uint32_t node);
  bool isWithin(std::uint32_t node);

  const navmesh::NavGraph* graph_;
  std::uint32_t limit_;
  std::uint32_t mostNeighbours_ = 0;  // half-portals of one polygon
  std::vector<Reach> reach_;          // per polygon
  std::vector<ChainReach> chains_;  // per chain; then the two parts of the user's own, between the
                                    // user and where its even and its odd way begin
  std::vector<std::uint32_t> touchedChains_;
  std::uint32_t touchedCount_ = 0;
  navmesh::KeyQueue queue_;
  std::vector<SearchNode> tree_;  // the first count_ are in use
  std::uint32_t count_ = 0;
  FunnelTree funnels_;
  std::uint32_t relaxed_ = 0;
  bool limitReached_ = false;
  float completeTo_ = std::numeric_limits<float>::infinity();

  // Of the run at hand.
  const navmesh::Chains* waysThrough_ = nullptr;    // the graph's, or those of the states
  const std::uint32_t* neighbourCount_ = nullptr;   // likewise
  const navmesh::PolygonStates* states_ = nullptr;  // null where nothing is closed or costs more,
                                                    // and there is no link
  const navmesh::LinkWay* ways_ = nullptr;          // of links; null where there are none
  std::uint32_t mostOffered_ = 0;                   // by one polygon: mostNeighbours_ and links
  PolygonId leaves_ = navmesh::kNoPolygon;          // the user's polygon, where that is closed
  glm::vec2 source_{};
  float horizon_ = 0.0f;
  Limit by_ = Limit::kTaut;
  float latestKey_ = 0.0f;  // of the queue
  std::uint32_t ownChain_ = navmesh::kNoChain;
  const std::vector<Corner>* corners_ = nullptr;
  bool topTaken_ = false;  // the queue's top, the node being relaxed, is replaced already
};

}  // namespace forewalk::prediction
