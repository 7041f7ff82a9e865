// Exact shortest-path distances from the user to everything within the horizon.
//
// Continuous Dijkstra on the navgraph: what a root sees is carried from polygon to polygon as
// windows, as in Polyanya (Cui, Harabor and Grastien, IJCAI 2017) but without a target, or as in
// exact discrete geodesics (Mitchell, Mount and Papadimitriou, SIAM J. Comput. 16, 1987; Chen and
// Han 1990). Roots are the user and the corners of walls where shortest paths bend. A window that a
// known way by one end of its portal beats everywhere is dropped (Xin and Wang, ACM TOG 28, 2009).
//
// We depart from them in two points. Only corners are queued, not windows: a corner that is
// settled sends out all its windows at once. And a window keeps the two rays that bound it instead
// of an interval: rays pass through corners, so that every turn is decided on given coordinates, in
// double precision where it is exact, and windows side by side leave no gap between them.
//
// Links (navmesh/links.h) are roots as well: who sees the entry of one knows a way to its exit, as
// long as the link is longer; when that is settled, and nothing has reached the exit sooner, the
// exit sees all around, as the user does.
//
// Lengths are horizontal metres (navmesh/nav_graph.h). Storeys may lie above each other: every step
// is from polygon to polygon, nothing is looked up on the plan.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <limits>
#include <span>
#include <vector>

#include "navmesh/key_queue.h"
#include "navmesh/links.h"
#include "navmesh/nav_graph.h"
#include "prediction/funnel_tree.h"
#include "prediction/portal_ends.h"
#include "prediction/prediction_graph.h"

namespace forewalk::prediction {

/// The part of a polygon that a root sees through the portal that it is entered by.
struct Window {
  glm::dvec2 left, right;  ///< the rays that bound it, from the root, any length; metres
  PolygonId polygon;
  std::uint32_t portal;  ///< half-portal into `polygon`; kNone: `polygon` touches the root and is
                         ///< seen whole, whatever the rays
  std::uint32_t corner;  ///< the root: index into corners()
  std::uint32_t next;    ///< another window of the same polygon, or kNone
};

/// A way through a link that shortest paths take, or that the horizon falls into.
struct LinkPassage {
  std::uint32_t way;    ///< index into navmesh::Links::ways
  std::uint32_t entry;  ///< the corner at its entry, an index into corners()
  std::uint32_t exit;   ///< the corner at its exit; kNone: the horizon lies before it, and nothing
                        ///< else reaches it within the horizon
};

/// Sizes fixed at load, so that no frame allocates.
struct DistanceLimits {
  std::uint32_t windows = 32768;  ///< of one run, >= 1; 48 bytes each
};

/// Distances from one source, and what finding them needs from frame to frame. One per user; not
/// shared between threads.
class DistanceField {
 public:
  /// Sizes every buffer. `graph`, `ends`, made from it, and `links`, made for it, must outlive
  /// this; null: there are none.
  DistanceField(const navmesh::NavGraph& graph, const PortalEnds& ends,
                const DistanceLimits& limits = {}, const navmesh::Links* links = nullptr);

  /// Finds all distances up to `horizon` metres (>= 0, finite) from `source` (a valid polygon,
  /// `source.plan` in it). Costs O(windows + corners log corners) within the horizon, whatever the
  /// size of the world; allocates nothing.
  void run(const navmesh::Location& source, float horizon);

  /// The source and all corners within the horizon by distance, each after the one before it on the
  /// shortest path from the source. Entries of links come right before their exits, and those of
  /// links that the horizon falls into last. This and all below lives until the next run.
  std::span<const Corner> corners() const { return corners_; }

  /// The links that shortest paths lead through, by the distance of their exits, then those that
  /// the horizon falls into, by way. A link that is longer than another way to its exit is none.
  std::span<const LinkPassage> passages() const { return passages_; }

  /// The link whose exit a corner is, an element of passages(); null where it is none.
  const LinkPassage* passageTo(std::uint32_t corner) const;

  /// The links that were given; null: none.
  const navmesh::Links* links() const { return links_; }

  /// All distances are known out to here, metres: the horizon, unless the limit was reached.
  float completeTo() const { return completeTo_; }
  bool limitReached() const { return limitReached_; }

  /// Polygons of which some part is within the horizon, in the order they were reached; the
  /// source's comes first. A polygon may be among them that lies beyond by less than rounding.
  std::span<const PolygonId> polygons() const { return {reached_.data(), reachedCount_}; }

  /// The first window of a polygon, or kNone where it was not reached; go on by Window::next.
  std::uint32_t firstWindow(PolygonId polygon) const { return first_[index(polygon)]; }
  std::span<const Window> windows() const { return {windows_.data(), windowCount_}; }

  /// Length of the shortest path to `point`, which lies in `polygon`; metres. Exact up to
  /// completeTo(). What is longer is the length of some path, and the point lies beyond; infinity
  /// where the polygon was not reached. O(windows of the polygon).
  float distanceAt(PolygonId polygon, glm::vec2 point) const {
    return static_cast<float>(bestWay(polygon, point).length);
  }

  /// The last corner before `point` on that path, an index into corners(); kNone where the polygon
  /// was not reached.
  std::uint32_t cornerBefore(PolygonId polygon, glm::vec2 point) const {
    return bestWay(polygon, point).corner;
  }

  /// distanceAt() an end of a portal (PortalEnds), already known: O(1). Infinity where it was not
  /// reached.
  float endDistance(std::uint32_t end) const { return static_cast<float>(states_[end].distance); }

  /// The corner before an end on the shortest path to it, an index into corners(), and the polygon
  /// that this path comes through at last. kNone where the end was not reached.
  std::uint32_t cornerBeforeEnd(std::uint32_t end) const { return states_[end].root; }
  PolygonId polygonBeforeEnd(std::uint32_t end) const { return PolygonId{states_[end].polygon}; }

  /// The distance of a corner, an index into corners(), not rounded; metres.
  double exactDistance(std::uint32_t corner) const { return cornerDistance_[corner]; }

  /// The end (PortalEnds) that a corner is; kNone for the source, and where links begin and end.
  std::uint32_t endOf(std::uint32_t corner) const { return cornerEnd_[corner]; }

  /// The sides to which a shortest path that arrives at an end in that direction can bend there.
  struct Bends {
    bool left, right;
  };
  Bends bendsAt(std::uint32_t end, glm::dvec2 arrival) const;

 private:
  /// What is known of a portal end. Reset by walking what the last run touched, never cleared.
  struct EndState {
    double distance = std::numeric_limits<double>::infinity();  ///< of the best way so far
    std::uint32_t root = kNone;     ///< the corner before it on that way
    std::uint32_t polygon = kNone;  ///< the last polygon of that way
    std::uint32_t corner = kNone;   ///< its own index in corners(), where it is settled
  };
  struct Way {
    double length;
    std::uint32_t corner;
  };
  /// A portal end seen from the root at hand.
  struct Sight {
    glm::dvec2 ray;
    double fromRight, fromLeft;  ///< >= 0 both: within the window
    double length;               ///< of the ray, where it is within the window
    std::uint32_t end;
  };
  void reset();
  void addRoot(glm::vec2 plan, float height, double distance, std::uint32_t previous);
  void seeAllFrom(PolygonId polygon);
  void settle(std::uint32_t end);
  void turnAbout(std::uint32_t end, bool leftwards, glm::dvec2 arrival);
  void seeAllAbout(std::uint32_t end);
  void seeWhole(std::uint32_t polygon);
  void seeLeftOf(glm::dvec2 arrival, std::uint32_t polygon);
  void seeRightOf(glm::dvec2 arrival, std::uint32_t polygon);
  void look(const Window& window);
  void spread(std::uint32_t begin);
  template <typename Bounds>
  void lookOut(std::uint32_t polygon, std::uint32_t entry, glm::dvec2 left, glm::dvec2 right,
               const Bounds& bounds);
  void pass(std::uint32_t portal, std::uint32_t entry, const Sight& l, const Sight& r,
            glm::dvec2 left, glm::dvec2 right);
  bool goesBack(std::uint32_t entry, glm::dvec2 along, glm::dvec2 a, glm::dvec2 b) const;
  void relax(const Sight& sight, std::uint32_t polygon);
  void pushEntry(navmesh::KeyQueue::Entry entry);
  bool isStale(navmesh::KeyQueue::Entry entry) const;
  bool startsAt(std::uint32_t corner) const;
  void relaxLinks(const Window& window);
  void takeLink(std::uint32_t way);
  void findCutLinks();
  void pushWhole(PolygonId polygon);
  std::uint32_t newWindow(PolygonId polygon);
  Way bestWay(PolygonId polygon, glm::vec2 point) const;

  const navmesh::NavGraph* graph_;
  const PortalEnds* ends_;
  const navmesh::Links* links_;  // null: none
  double tolerance_;  // metres; how far rounding may put a point beside the ray that it lies on

  float horizon_ = 0.0f;
  float completeTo_ = 0.0f;
  bool limitReached_ = false;

  // The root whose windows are being sent out.
  glm::dvec2 root_{0.0};
  double rootDistance_ = 0.0;
  std::uint32_t rootCorner_ = 0;

  std::vector<Corner> corners_;
  std::vector<double> cornerDistance_;    // as in corners_, not rounded
  std::vector<std::uint32_t> cornerEnd_;  // as in corners_
  std::vector<Window> windows_;           // the first windowCount_ are in use
  std::uint32_t windowCount_ = 0;
  std::vector<std::uint32_t> first_;  // per polygon: its first window
  std::vector<PolygonId> reached_;    // the first reachedCount_ are in use
  std::uint32_t reachedCount_ = 0;
  std::vector<EndState> states_;        // per end, then per way of links: its exit, by that way
  std::vector<std::uint32_t> touched_;  // ends with a state; the first touchedCount_ are in use
  std::uint32_t touchedCount_ = 0;
  std::vector<LinkPassage> passages_;
  navmesh::KeyQueue queue_;
};

}  // namespace forewalk::prediction
