#include "prediction/distance_field.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "navmesh/plan.h"

namespace forewalk::prediction {

using glm::dvec2;
using navmesh::cross;
using navmesh::KeyQueue;
using navmesh::NavGraph;

namespace {

dvec2 rayTo(glm::vec2 point, dvec2 root) { return dvec2(point) - root; }

double distanceToSegment(dvec2 a, dvec2 b) {
  const dvec2 ab = b - a;
  const double squared = glm::dot(ab, ab);
  const double share = squared > 0.0 ? std::clamp(-glm::dot(a, ab) / squared, 0.0, 1.0) : 0.0;
  return glm::length(a + share * ab);
}

/// Whether a window lets its root see along `ray`, or is within rounding of it.
bool sees(const Window& window, dvec2 ray, double tolerance) {
  const double squaredTolerance = tolerance * tolerance;
  const auto inside = [&](double side, dvec2 bound) {
    return side >= 0.0 || side * side <= squaredTolerance * glm::dot(bound, bound);
  };
  return window.portal == kNone || (inside(cross(ray, window.left), window.left) &&
                                    inside(cross(window.right, ray), window.right));
}

}  // namespace

DistanceField::DistanceField(const NavGraph& graph, const PortalEnds& ends,
                             const DistanceLimits& limits, const navmesh::Links* links)
    : graph_(&graph),
      ends_(&ends),
      links_(links != nullptr && !links->empty() ? links : nullptr),
      tolerance_(static_cast<double>(roundingOf(graph))) {
  const std::size_t windows = std::max(1u, limits.windows);
  const std::size_t bends = std::min<std::size_t>(ends.bendCount, windows);
  const std::size_t ways = links_ != nullptr ? links_->ways.size() : 0;
  corners_.reserve(bends + 1 + 2 * ways);
  cornerDistance_.reserve(bends + 1 + 2 * ways);
  cornerEnd_.reserve(bends + 1 + 2 * ways);
  passages_.reserve(ways);
  windows_.resize(windows);
  first_.assign(graph.polygonCount(), kNone);
  reached_.resize(std::min<std::size_t>(graph.polygonCount(), windows));
  states_.resize(ends.count() + ways);
  touched_.resize(ends.count() + ways);
  // Improved corners are pushed again; when the queue is full, what is stale is thrown out.
  queue_.reserve(4 * (bends + ways) + 64);
}

void DistanceField::reset() {
  for (std::uint32_t i = 0; i < touchedCount_; ++i) states_[touched_[i]] = EndState{};
  for (std::uint32_t i = 0; i < reachedCount_; ++i) first_[index(reached_[i])] = kNone;
  touchedCount_ = reachedCount_ = windowCount_ = 0;
  corners_.clear();
  cornerDistance_.clear();
  cornerEnd_.clear();
  passages_.clear();
  queue_.clear();
  limitReached_ = false;
}

/// The place of one more window of the polygon, or kNone where there is none left.
std::uint32_t DistanceField::newWindow(PolygonId polygon) {
  if (windowCount_ == windows_.size()) {
    limitReached_ = true;
    return kNone;
  }
  // Field by field into its place: built aside and copied, it would wait for the store buffer.
  std::uint32_t& first = first_[index(polygon)];
  if (first == kNone) reached_[reachedCount_++] = polygon;
  Window& window = windows_[windowCount_];
  window.polygon = polygon;
  window.corner = rootCorner_;
  window.next = first;
  return first = windowCount_++;
}

void DistanceField::pushWhole(PolygonId polygon) {
  const std::uint32_t window = newWindow(polygon);
  if (window == kNone) return;
  windows_[window].portal = kNone;
  if (links_ != nullptr) relaxLinks(windows_[window]);
}

/// Whether a better way to the end has been found since, or it is settled.
bool DistanceField::isStale(KeyQueue::Entry entry) const {
  const EndState& state = states_[index(KeyQueue::polygonOf(entry))];
  return state.corner != kNone || KeyQueue::keyOf(entry) != static_cast<float>(state.distance);
}

void DistanceField::pushEntry(KeyQueue::Entry entry) {
  if (queue_.size() == queue_.capacity()) {
    const std::size_t count = queue_.size();
    queue_.clear();
    for (std::size_t i = 0; i < count; ++i) {  // entries move to the front only: none is lost
      const KeyQueue::Entry old = queue_.at(i);
      const EndState& state = states_[index(KeyQueue::polygonOf(old))];
      const bool stale =
          state.corner != kNone || KeyQueue::keyOf(old) != static_cast<float>(state.distance);
      if (!stale) queue_.push(old);
    }
    if (queue_.size() == queue_.capacity()) {
      limitReached_ = true;
      return;
    }
  }
  queue_.push(entry);
}

DistanceField::Bends DistanceField::bendsAt(std::uint32_t end, dvec2 arrival) const {
  if (ends_->kind[end] != PortalEnds::Kind::kBend) return {true, true};
  // To the left where one could not go on along the wall on the left without turning left.
  const PortalEnds::Walls& walls = ends_->walls[end];
  const dvec2 at(ends_->plan[end]);
  return {cross(arrival, dvec2(walls.last) - at) > 0.0,
          cross(arrival, dvec2(walls.first) - at) < 0.0};
}

/// A way by the root at hand, straight to a portal end that it sees, at last in `polygon`.
void DistanceField::relax(const Sight& sight, std::uint32_t polygon) {
  EndState& state = states_[sight.end];
  const double distance = rootDistance_ + sight.length;
  if (distance >= state.distance || state.corner != kNone) return;
  if (state.root == kNone) touched_[touchedCount_++] = sight.end;
  state.distance = distance;
  state.root = rootCorner_;
  state.polygon = polygon;
  if (ends_->kind[sight.end] == PortalEnds::Kind::kOpen) return;
  const float key = static_cast<float>(distance);
  if (key > horizon_) return;
  const Bends bends = bendsAt(sight.end, sight.ray);
  if (bends.left || bends.right) pushEntry(KeyQueue::entryOf(key, PolygonId{sight.end}));
}

/// Whether rays that came in by the twin of `entry` and meet a portal at `a` and `b`, which lies
/// along `along`, met it before they came in. No ray leaves a convex polygon by the line that it
/// entered by. But where rounding has dented a polygon there, one that grazes the line might go
/// round an end of the portals forever.
bool DistanceField::goesBack(std::uint32_t entry, dvec2 along, dvec2 a, dvec2 b) const {
  const dvec2 l = dvec2(ends_->plan[ends_->ofPortal[entry].left]) - root_;
  const dvec2 r = dvec2(ends_->plan[ends_->ofPortal[entry].right]) - root_;
  const dvec2 line = l - r;
  const double parallel = glm::dot(line, along);
  if (!(parallel > 0.0) || std::abs(cross(line, along)) > 0.1 * parallel) return false;
  const auto before = [&](dvec2 point) {
    const double fromR = cross(r, point), fromL = cross(l, point);
    if (fromR == fromL) return false;
    const dvec2 entered = r + fromR / (fromR - fromL) * line;
    return glm::dot(point, point) < (1 - 1e-9) * glm::dot(entered, point);
  };
  return before(a) || before(b);
}

/// Sends the window between `left` and `right` on through `portal`, narrowed by its ends `l` and
/// `r`, unless nothing of it is within the horizon or a way by one of the ends beats it.
void DistanceField::pass(std::uint32_t portal, std::uint32_t entry, const Sight& l, const Sight& r,
                         dvec2 left, dvec2 right) {
  // Where the rays meet the portal; its own ends where it is seen so far.
  dvec2 a = l.ray, b = r.ray;
  double toA = l.length, toB = r.length;
  const dvec2 along = l.ray - r.ray;
  if (l.fromLeft < 0.0) {
    a = r.ray + r.fromLeft / (r.fromLeft - l.fromLeft) * along;
    toA = glm::length(a);
  } else {
    left = l.ray;
  }
  if (r.fromRight < 0.0) {
    b = l.ray - l.fromRight / (l.fromRight - r.fromRight) * along;
    toB = glm::length(b);
  } else {
    right = r.ray;
  }
  if (cross(right, left) <= 0.0) return;

  const double reach = static_cast<double>(horizon_) - rootDistance_;
  if (toA > reach && toB > reach && distanceToSegment(a, b) > reach) return;

  // Beaten at the far end of the interval by the way by the near one, it is beaten everywhere.
  constexpr double kSlack = 1e-7;
  const auto beaten = [&](const Sight& by, dvec2 far, double toFar) {
    const double spare = rootDistance_ + toFar - states_[by.end].distance - kSlack;
    const dvec2 between = far - by.ray;
    return spare > 0.0 && spare * spare > glm::dot(between, between);
  };
  if (beaten(l, b, toB) || beaten(r, a, toA)) return;
  if (entry != kNone && goesBack(entry, along, a, b)) return;
  const std::uint32_t window = newWindow(graph_->portalTo[portal]);
  if (window == kNone) return;
  windows_[window].left = left;
  windows_[window].right = right;
  windows_[window].portal = portal;
  if (links_ != nullptr) relaxLinks(windows_[window]);
}

/// What the root at hand sees of a polygon, and of those beyond its portals, but for `entry`.
/// `bounds` sets on which side of the rays an end lies.
template <typename Bounds>
void DistanceField::lookOut(std::uint32_t polygon, std::uint32_t entry, dvec2 left, dvec2 right,
                            const Bounds& bounds) {
  // Portals side by side share an end: it is looked at once. Two places in turn, never copied.
  Sight sights[2];
  Sight* l = &sights[0];
  Sight* r = &sights[1];
  l->end = kNone;
  const auto see = [&](Sight& sight, std::uint32_t end) {
    const dvec2 ray = dvec2(ends_->plan[end]) - root_;
    sight.end = end;
    sight.ray = ray;
    bounds(sight, ray);
    if (sight.fromLeft >= 0.0 && sight.fromRight >= 0.0) {
      sight.length = glm::length(ray);
      if (rootDistance_ + sight.length < states_[end].distance) relax(sight, polygon);
    }
  };
  const std::uint32_t end = graph_->portalStart[polygon + 1];
  for (std::uint32_t h = graph_->portalStart[polygon]; h < end; ++h) {
    if (h == entry) continue;
    const PortalEnds::Pair ends = ends_->ofPortal[h];
    std::swap(l, r);
    if (ends.right != r->end) see(*r, ends.right);
    see(*l, ends.left);
    if (l->fromRight > 0.0 && r->fromLeft > 0.0) pass(h, entry, *l, *r, left, right);
  }
}

void DistanceField::look(const Window& window) {
  const dvec2 left = window.left, right = window.right;
  lookOut(index(window.polygon), graph_->portalTwin[window.portal], left, right,
          [left, right](Sight& sight, dvec2 ray) {
            sight.fromRight = cross(right, ray);
            sight.fromLeft = cross(ray, left);
          });
}

// What the root sees of a polygon that touches it: all, or only what lies to the left (or right) of
// the way that came to it, prolonged.

void DistanceField::seeWhole(std::uint32_t polygon) {
  pushWhole(PolygonId{polygon});
  lookOut(polygon, kNone, {}, {},
          [](Sight& sight, dvec2) { sight.fromLeft = sight.fromRight = 1.0; });
}

void DistanceField::seeLeftOf(dvec2 arrival, std::uint32_t polygon) {
  pushWhole(PolygonId{polygon});
  lookOut(polygon, kNone, {}, arrival, [arrival](Sight& sight, dvec2 ray) {
    sight.fromRight = cross(arrival, ray);
    sight.fromLeft = 1.0;
  });
}

void DistanceField::seeRightOf(dvec2 arrival, std::uint32_t polygon) {
  pushWhole(PolygonId{polygon});
  lookOut(polygon, kNone, arrival, {}, [arrival](Sight& sight, dvec2 ray) {
    sight.fromLeft = cross(ray, arrival);
    sight.fromRight = 1.0;
  });
}

/// Sends on all windows from `begin`, and those that come of them.
void DistanceField::spread(std::uint32_t begin) {
  for (std::uint32_t i = begin; i < windowCount_ && !limitReached_; ++i) {
    if (windows_[i].portal == kNone) continue;  // sent on where it was made
    look(windows_[i]);
  }
}

void DistanceField::addRoot(glm::vec2 plan, float height, double distance, std::uint32_t previous) {
  root_ = dvec2(plan);
  rootDistance_ = distance;
  rootCorner_ = static_cast<std::uint32_t>(corners_.size());
  corners_.push_back({plan, height, static_cast<float>(distance), previous});
  cornerDistance_.push_back(distance);
  cornerEnd_.push_back(kNone);
}

/// From the root at hand, which lies in `polygon` and sees all around: the source, or where a link
/// leads.
void DistanceField::seeAllFrom(PolygonId polygon) {
  // Somebody who stands on a portal sees both its sides, whole.
  const std::uint32_t begin = windowCount_;
  const auto isWhole = [&](PolygonId other) {
    return std::any_of(windows_.begin() + begin, windows_.begin() + windowCount_,
                       [&](const Window& w) { return w.polygon == other; });
  };
  pushWhole(polygon);
  for (std::uint32_t i = begin; i < windowCount_ && !limitReached_; ++i) {
    const std::uint32_t p = index(windows_[i].polygon);
    for (std::uint32_t h = graph_->portalStart[p]; h < graph_->portalStart[p + 1]; ++h) {
      if (isWhole(graph_->portalTo[h])) continue;
      const PortalEnds::Pair ends = ends_->ofPortal[h];
      if (distanceToSegment(rayTo(ends_->plan[ends.left], root_),
                            rayTo(ends_->plan[ends.right], root_)) <= tolerance_) {
        pushWhole(graph_->portalTo[h]);
      }
    }
  }
  const std::uint32_t whole = windowCount_;
  for (std::uint32_t i = begin; i < whole; ++i) {
    const std::uint32_t p = index(windows_[i].polygon);
    for (std::uint32_t h = graph_->portalStart[p]; h < graph_->portalStart[p + 1]; ++h) {
      const auto see = [&](std::uint32_t end) {
        const dvec2 ray = rayTo(ends_->plan[end], root_);
        const Sight sight{ray, 1.0, 1.0, glm::length(ray), end};
        relax(sight, p);
        return sight;
      };
      const Sight l = see(ends_->ofPortal[h].left);
      const Sight r = see(ends_->ofPortal[h].right);
      const PolygonId to = graph_->portalTo[h];
      const bool into = std::none_of(windows_.begin() + begin, windows_.begin() + whole,
                                     [&](const Window& w) { return w.polygon == to; });
      if (into) pass(h, kNone, l, r, {}, {});
    }
  }
  spread(begin);
}

// --- Links ---

/// Whether a path may set out from a corner to all sides.
bool DistanceField::startsAt(std::uint32_t corner) const {
  return corner == 0 || passageTo(corner) != nullptr;
}

const LinkPassage* DistanceField::passageTo(std::uint32_t corner) const {
  const auto at = std::lower_bound(
      passages_.begin(), passages_.end(), corner,
      [](const LinkPassage& passage, std::uint32_t exit) { return passage.exit < exit; });
  return at != passages_.end() && at->exit == corner ? &*at : nullptr;
}

/// Ways by the root at hand to the exits of the links whose entries it sees in a window.
void DistanceField::relaxLinks(const Window& window) {
  const std::span<const navmesh::LinkWay> ways = links_->from(window.polygon);
  for (const navmesh::LinkWay& way : ways) {
    const dvec2 ray = rayTo(way.entry, root_);
    const double entry = rootDistance_ + glm::length(ray);
    if (static_cast<float>(entry) > horizon_ || !sees(window, ray, tolerance_)) continue;
    const std::uint32_t id =
        ends_->count() + static_cast<std::uint32_t>(&way - links_->ways.data());
    EndState& state = states_[id];
    const double exit = entry + static_cast<double>(way.length);
    if (exit >= state.distance || state.corner != kNone) continue;
    if (state.root == kNone) touched_[touchedCount_++] = id;
    state.distance = exit;
    state.root = rootCorner_;
    const float key = static_cast<float>(exit);
    if (key <= horizon_) pushEntry(KeyQueue::entryOf(key, PolygonId{id}));
  }
}

/// The shortest way through a link is known: on from its exit, unless that was reached sooner.
void DistanceField::takeLink(std::uint32_t way) {
  const navmesh::LinkWay& link = links_->ways[way];
  EndState& state = states_[ends_->count() + way];
  state.corner = 0;  // settled
  rootDistance_ = state.distance;
  if (bestWay(link.to, link.exit).length <= state.distance + tolerance_) return;
  const double entry = cornerDistance_[state.root] +
                       glm::length(rayTo(link.entry, dvec2(corners_[state.root].plan)));
  addRoot(link.entry, link.entryHeight, entry, state.root);
  const std::uint32_t entryCorner = rootCorner_;
  addRoot(link.exit, link.exitHeight, state.distance, entryCorner);
  state.corner = rootCorner_;
  passages_.push_back({way, entryCorner, rootCorner_});
  seeAllFrom(link.to);
}

/// The links that are entered within the horizon and not left, unless something else leads to their
/// exit.
void DistanceField::findCutLinks() {
  const std::size_t taken = passages_.size();
  for (std::uint32_t i = 0; i < touchedCount_; ++i) {
    if (touched_[i] < ends_->count() || states_[touched_[i]].corner != kNone) continue;
    const std::uint32_t way = touched_[i] - ends_->count();
    const navmesh::LinkWay& link = links_->ways[way];
    if (bestWay(link.to, link.exit).length <= static_cast<double>(horizon_)) continue;
    passages_.push_back({way, 0, kNone});
  }
  std::sort(passages_.begin() + static_cast<std::ptrdiff_t>(taken), passages_.end(),
            [](const LinkPassage& a, const LinkPassage& b) { return a.way < b.way; });
  for (std::size_t i = taken; i < passages_.size(); ++i) {
    const navmesh::LinkWay& link = links_->ways[passages_[i].way];
    const std::uint32_t root = states_[ends_->count() + passages_[i].way].root;
    const double entry =
        cornerDistance_[root] + glm::length(rayTo(link.entry, dvec2(corners_[root].plan)));
    passages_[i].entry = static_cast<std::uint32_t>(corners_.size());
    addRoot(link.entry, link.entryHeight, entry, root);
  }
}

// --- Corners ---

/// Walks about the corner `end`, keeping it on the left (or right), up to the wall that the
/// shortest paths bend around.
void DistanceField::turnAbout(std::uint32_t end, bool leftwards, dvec2 arrival) {
  const std::uint32_t start = states_[end].polygon;
  const auto portalOn = [&](std::uint32_t polygon) {
    for (std::uint32_t h = graph_->portalStart[polygon]; h < graph_->portalStart[polygon + 1];
         ++h) {
      const PortalEnds::Pair ends = ends_->ofPortal[h];
      if ((leftwards ? ends.left : ends.right) == end) return h;
    }
    return kNone;
  };
  const auto beyond = [&](std::uint32_t portal) {
    const PortalEnds::Pair ends = ends_->ofPortal[portal];
    const dvec2 ray = rayTo(ends_->plan[leftwards ? ends.right : ends.left], root_);
    const double side = cross(arrival, ray);
    return leftwards ? side > 0.0 : side < 0.0;
  };
  bool clipped = arrival != dvec2(0.0);
  for (std::uint32_t portal = portalOn(start); portal != kNone;) {
    const std::uint32_t polygon = index(graph_->portalTo[portal]);
    if (polygon == start) return;
    clipped = clipped && !beyond(portal);
    const std::uint32_t next = portalOn(polygon);
    if (!clipped) {
      seeWhole(polygon);
    } else if (next == kNone || beyond(next)) {
      leftwards ? seeLeftOf(arrival, polygon) : seeRightOf(arrival, polygon);
    }
    portal = next;
  }
}

/// Through a pinch point one comes from any polygon into any other.
void DistanceField::seeAllAbout(std::uint32_t end) {
  const std::uint32_t begin = windowCount_;
  const auto known = [&](std::uint32_t polygon) {
    return std::any_of(
        windows_.begin() + begin, windows_.begin() + windowCount_,
        [&](const Window& w) { return w.portal == kNone && index(w.polygon) == polygon; });
  };
  seeWhole(states_[end].polygon);
  for (std::uint32_t i = begin; i < windowCount_ && !limitReached_; ++i) {
    if (windows_[i].portal != kNone) continue;
    const std::uint32_t p = index(windows_[i].polygon);
    for (std::uint32_t h = graph_->portalStart[p]; h < graph_->portalStart[p + 1]; ++h) {
      const PortalEnds::Pair ends = ends_->ofPortal[h];
      const std::uint32_t to = index(graph_->portalTo[h]);
      if ((ends.left == end || ends.right == end) && !known(to)) {
        seeWhole(to);
      }
    }
  }
}

void DistanceField::settle(std::uint32_t end) {
  EndState& state = states_[end];
  const std::uint32_t before = state.root;
  addRoot(ends_->plan[end], ends_->height[end], state.distance, before);
  state.corner = rootCorner_;
  cornerEnd_.back() = end;
  // Where the user stands, or a link leads, who sees all around already.
  if (state.distance - cornerDistance_[before] <= tolerance_ && startsAt(before)) return;
  const dvec2 arrival = root_ - dvec2(corners_[before].plan);

  const std::uint32_t begin = windowCount_;
  if (ends_->kind[end] == PortalEnds::Kind::kPinch) {
    seeAllAbout(end);
  } else {
    const Bends bends = bendsAt(end, arrival);
    if (bends.left) turnAbout(end, true, arrival);
    if (bends.right) turnAbout(end, false, arrival);
  }
  spread(begin);
}

void DistanceField::run(const navmesh::Location& source, float horizon) {
  assert(index(source.polygon) < graph_->polygonCount());
  reset();
  horizon_ = completeTo_ = horizon;
  const std::size_t ways = links_ != nullptr ? links_->ways.size() : 0;
  addRoot(source.plan, source.height, 0.0, 0);
  seeAllFrom(source.polygon);
  while (!queue_.empty() && !limitReached_) {
    const KeyQueue::Entry entry = queue_.top();
    queue_.pop();
    const std::uint32_t end = index(KeyQueue::polygonOf(entry));
    if (isStale(entry)) continue;
    if (end >= ends_->count()) {
      takeLink(end - ends_->count());
      continue;
    }
    // Each way by a link has room for the two corners that it may become.
    if (corners_.size() + 2 * (ways - passages_.size()) == corners_.capacity()) {
      limitReached_ = true;
      rootDistance_ = states_[end].distance;
      break;
    }
    settle(end);
  }
  if (links_ != nullptr && !limitReached_) findCutLinks();
  if (limitReached_) completeTo_ = std::min(horizon, static_cast<float>(rootDistance_));
}

DistanceField::Way DistanceField::bestWay(PolygonId polygon, glm::vec2 point) const {
  Way best{std::numeric_limits<double>::infinity(), kNone};
  const auto consider = [&](double length, std::uint32_t corner) {
    if (length < best.length) best = {length, corner};
  };
  for (std::uint32_t w = first_[index(polygon)]; w != kNone; w = windows_[w].next) {
    const Window& window = windows_[w];
    const dvec2 ray = rayTo(point, dvec2(corners_[window.corner].plan));
    if (!sees(window, ray, tolerance_)) continue;
    consider(cornerDistance_[window.corner] + glm::length(ray), window.corner);
  }
  if (best.corner != kNone || first_[index(polygon)] == kNone) return best;
  // In the shadow beyond the horizon, or of a gap between portals that is only rounding: by the
  // ends of the portals that are known.
  for (std::uint32_t h = graph_->portalStart[index(polygon)];
       h < graph_->portalStart[index(polygon) + 1]; ++h) {
    for (const std::uint32_t end : {ends_->ofPortal[h].left, ends_->ofPortal[h].right}) {
      const EndState& state = states_[end];
      if (state.root == kNone) continue;
      consider(state.distance + glm::length(dvec2(point) - dvec2(ends_->plan[end])),
               state.corner != kNone ? state.corner : state.root);
    }
  }
  return best;
}

}  // namespace forewalk::prediction
