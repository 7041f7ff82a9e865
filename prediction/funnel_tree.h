// Exact taut paths from the source to every polygon of a search tree, sharing what they have in
// common.
//
// The funnel algorithm of Lee and Preparata (Networks 14, 1984) on a tree instead of a corridor: a
// node's funnel is its parent's, narrowed by one more portal. Most portals do not bend the path, so
// narrowing is done without branches and only a bend is a test that fails now and then. A bend
// makes a corner, and the funnel is opened again from there, rescanning the portals since (they are
// few: a bend is found soon after it is passed).
//
// A node behind a link (navmesh/links.h) begins anew: its paths go to the link's entry, through it,
// and on from the exit, which are corners, whatever bends there.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "navmesh/links.h"
#include "navmesh/nav_graph.h"
#include "prediction/prediction_graph.h"

namespace forewalk::prediction {

/// No tree index, no half-portal.
inline constexpr std::uint32_t kNone = 0xffffffffu;

/// What stands in the place of a half-portal where a polygon was entered by a link: this, and the
/// number of the way in navmesh::Links::ways.
inline constexpr std::uint32_t kByLink = 0x80000000u;
constexpr bool isLink(std::uint32_t portal) { return portal >= kByLink && portal != kNone; }

/// How the search came to a polygon.
struct TreeLink {
  std::uint32_t parent;  ///< tree index, smaller than the node's own; of the source: 0
  std::uint32_t portal;  ///< half-portal of the parent's polygon it was entered by, or kByLink and
                         ///< a way; source: kNone
};

/// Funnels of the nodes of one search tree, found when they are asked for. Allocates nothing as
/// long as the tree has no more nodes than reserved and `corners` is reserved for cornerCapacity()
/// of them.
class FunnelTree {
 public:
  void reserve(std::size_t nodes);

  /// Most corners that a tree of `nodes` nodes can have: both ends of every portal, and the source.
  static constexpr std::size_t cornerCapacity(std::size_t nodes) { return 2 * nodes + 1; }

  /// Starts anew with the source as node 0; the first corner is the user. `ways` are of links;
  /// null where no node is entered by one.
  void restart(const navmesh::NavGraph& graph, glm::vec2 source, float height,
               std::vector<Corner>& corners, const navmesh::LinkWay* ways = nullptr);

  /// One more node of the tree, in order.
  void add(TreeLink link) {
    links_[count_].parent = link.parent;
    links_[count_].portal = link.portal;
    opened_[count_].at = kNone;
    apex_[count_++] = kNone;
  }

  /// The last corner before `end`, a point in the polygon of `node`, on the taut path to it. Stops
  /// early, at a corner of that path, where that is `enough` metres or more from the source.
  /// Amortised O(portals since the last bend).
  std::uint32_t cornerBefore(std::uint32_t node, glm::vec2 end, float enough);

  /// The last corner that all taut paths through `node` have in common: they are at least as long
  /// as the way by it. Cheaper than cornerBefore.
  std::uint32_t cornerShared(std::uint32_t node) {
    find(node);
    return cornerOf_[apex_[node]];
  }

  /// The corners of a node that is entered by a link, of which cornerBefore has been asked for it
  /// or for a node behind it: where the link is entered, and where it is left.
  std::uint32_t entryCorner(std::uint32_t node) const { return cornerOf_[2 * node + 1]; }
  std::uint32_t exitCorner(std::uint32_t node) const { return cornerOf_[2 * node]; }

 private:
  /// What can be seen from the apex, the last bend, through all portals since: three points. A side
  /// whose point is the apex bounds nothing.
  struct Funnel {
    std::uint32_t apex;
    std::uint32_t left;
    std::uint32_t right;
  };

  // Points are numbered by the tree: the left end of the entry portal of node n is 2n, the right 2n
  // + 1. Of a link, the exit and the entry.
  static std::uint32_t nodeOf(std::uint32_t point) { return point / 2; }

  void find(std::uint32_t node);
  void findFromParent(std::uint32_t node);
  void findBehindLink(std::uint32_t node);
  Funnel narrowed(Funnel funnel, std::uint32_t depth);
  Funnel open(std::uint32_t at, std::uint32_t node, std::uint32_t& depth);
  void bend(std::uint32_t apex, std::uint32_t at);

  const navmesh::NavGraph* graph_ = nullptr;
  const navmesh::LinkWay* ways_ = nullptr;
  std::vector<Corner>* corners_ = nullptr;

  // Per tree node, the first count_ in use. Funnels lie in three arrays, so that what is written as
  // numbers is read as numbers: copied as one piece too soon, it would wait for the store buffer.
  std::vector<TreeLink> links_;
  std::vector<std::uint32_t> apex_;  // kNone until asked for
  std::vector<std::uint32_t> left_;
  std::vector<std::uint32_t> right_;
  std::uint32_t count_ = 0;

  // What a path to a point of a node's polygon sees once it has bent around the point `at`: kept,
  // because the paths to the node's children mostly bend there too. `at` is kNone until then.
  struct Opened {
    std::uint32_t at;
    Funnel funnel;
  };
  std::vector<Opened> opened_;

  // Per point; valid where a funnel has been found.
  std::vector<glm::vec2> points_;
  std::vector<std::uint32_t> cornerOf_;  // kNone until the path bends there

  std::vector<std::uint32_t> path_;   // of find(): nodes without a funnel, deepest first
  std::vector<std::uint32_t> stack_;  // of narrowed(): nodes to narrow by, the next on top
};

}  // namespace forewalk::prediction
