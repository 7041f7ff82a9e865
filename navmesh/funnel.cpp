#include "navmesh/funnel.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "navmesh/plan.h"

namespace forewalk::navmesh {
namespace {

// Adds a waypoint: nothing where the path is already, and without the one before it where the path
// goes straight on there.
void addWaypoint(glm::vec2 point, std::vector<glm::vec2>& path) {
  if (path.back() == point) return;
  if (path.size() >= 2) {
    const glm::vec2 before = path[path.size() - 2];
    const glm::vec2 last = path.back();
    if (exactTurn(before, last, point) == 0.0 && glm::dot(last - before, point - last) > 0.0f) {
      path.back() = point;
      return;
    }
  }
  path.push_back(point);
}

// One side of the funnel: its tip, and how many portals lie up to there.
struct Tip {
  glm::vec2 plan;
  std::size_t portal;
};

enum class Narrowed { kOutside, kInside, kPast };

// What becomes of one side of the funnel when the next portal's end comes: it lies outside (the
// side stays), inside (it becomes the tip), or past the other side (that side's tip is a corner of
// the path). `sign` is 1 for the right side and -1 for the left, its mirror image.
Narrowed narrow(glm::vec2 apex, Tip& side, const Tip& other, double sign, Tip next) {
  if (sign * exactTurn(apex, side.plan, next.plan) < 0.0) return Narrowed::kOutside;
  if (sign * exactTurn(apex, other.plan, next.plan) > 0.0) return Narrowed::kPast;
  side = next;
  return Narrowed::kInside;
}

// Walks a path through its corridor, polygon by polygon, and records its height wherever the slope
// under it may change.
class Lifter {
 public:
  Lifter(const NavGraph& graph, std::span<const glm::vec2> path, float tolerance,
         std::vector<glm::vec3>& lifted)
      : graph_(graph), path_(path), tolerance_(tolerance), lifted_(lifted) {}

  void lift(PolygonId first, std::span<const std::uint32_t> corridor) {
    if (path_.empty()) return;
    anchor_ = lifted_.size();
    lifted_.push_back(toSpace(path_[0], heightAt(graph_, first, path_[0])));
    PolygonId polygon = first;
    for (const std::uint32_t h : corridor) {
      walkTo(polygon, graph_.portals[h]);
      polygon = graph_.portalTo[h];
    }
    while (leg_ + 1 < path_.size()) finishLeg(polygon);
  }

 private:
  // Up to where the path crosses the portal's line. Until then it is inside the convex polygon,
  // hence on the line's near side.
  void walkTo(PolygonId polygon, const Portal& portal) {
    for (; leg_ + 1 < path_.size(); finishLeg(polygon)) {
      const double ahead = exactTurn(portal.right, portal.left, path_[leg_ + 1]);
      if (ahead > 0.0) continue;
      const double behind = exactTurn(portal.right, portal.left, path_[leg_]);
      const double share = behind > ahead ? behind / (behind - ahead) : 1.0;
      record(polygon, std::clamp(static_cast<float>(share), along_, 1.0f));
      return;
    }
  }

  void finishLeg(PolygonId polygon) {
    record(polygon, 1.0f);
    simplify();
    ++leg_;
    along_ = 0.0f;
    anchor_ = lifted_.size() - 1;
  }

  // The heights of the present leg from `along_` to `to` (shares of the leg), over one polygon.
  void record(PolygonId polygon, float to) {
    const std::size_t before = lifted_.size();
    const std::uint32_t p = index(polygon);
    if (!graph_.heightStart.empty() && graph_.heightStart[p] < graph_.heightStart[p + 1]) {
      for (std::uint32_t i = graph_.heightStart[p]; i < graph_.heightStart[p + 1]; ++i) {
        const HeightTriangle& t = graph_.heightTriangles[i];
        recordCrossing(polygon, to, toPlan(t.a), toPlan(t.b));
        recordCrossing(polygon, to, toPlan(t.b), toPlan(t.c));
        recordCrossing(polygon, to, toPlan(t.c), toPlan(t.a));
      }
    } else {
      // heightAt fans the ring out from its first corner.
      const std::span<const glm::vec2> ring = graph_.ringOf(polygon);
      for (std::size_t i = 2; i + 1 < ring.size(); ++i) {
        recordCrossing(polygon, to, ring[0], ring[i]);
      }
    }
    const glm::vec2 from = path_[leg_];
    const auto nearer = [&](const glm::vec3& a, const glm::vec3& b) {
      return glm::distance(from, toPlan(a)) < glm::distance(from, toPlan(b));
    };
    std::sort(lifted_.begin() + static_cast<std::ptrdiff_t>(before), lifted_.end(), nearer);
    along_ = to;
    recordAt(polygon, to);
  }

  void recordCrossing(PolygonId polygon, float to, glm::vec2 a, glm::vec2 b) {
    const glm::vec2 from = path_[leg_];
    const glm::vec2 walk = path_[leg_ + 1] - from;
    const glm::vec2 edge = b - a;
    const float parallel = cross(walk, edge);
    if (parallel == 0.0f) return;
    const float share = cross(a - from, edge) / parallel;
    const float onEdge = cross(a - from, walk) / parallel;
    if (share > along_ && share < to && onEdge >= 0.0f && onEdge <= 1.0f) recordAt(polygon, share);
  }

  void recordAt(PolygonId polygon, float share) {
    // Ends of legs stay what they are to the last bit.
    const glm::vec2 plan =
        share < 1.0f ? glm::mix(path_[leg_], path_[leg_ + 1], share) : path_[leg_ + 1];
    lifted_.push_back(toSpace(plan, heightAt(graph_, polygon, plan)));
  }

  // Drops recorded points of the leg that lie within the tolerance of the straight line between
  // those kept: from each kept point on, all slopes that pass the points so far closely enough form
  // a wedge; the last point inside its wedge is kept next.
  void simplify() {
    constexpr float kInfinity = std::numeric_limits<float>::infinity();
    std::size_t kept = anchor_;  // last place kept
    std::size_t from = anchor_;  // where it was recorded
    while (from + 1 < lifted_.size()) {
      const glm::vec3 start = lifted_[kept];
      float low = -kInfinity;
      float high = kInfinity;
      std::size_t next = from + 1;
      for (std::size_t i = from + 1; i < lifted_.size() && low <= high; ++i) {
        const float length = glm::distance(toPlan(start), toPlan(lifted_[i]));
        const float rise = lifted_[i].y - start.y;
        if (length <= kShortest) {
          next = i;  // the same place, recorded by two triangles
          continue;
        }
        if (rise >= low * length && rise <= high * length) next = i;
        low = std::max(low, (rise - tolerance_) / length);
        high = std::min(high, (rise + tolerance_) / length);
      }
      from = next;
      const bool samePlace = glm::distance(toPlan(start), toPlan(lifted_[next])) <= kShortest;
      const bool last = next + 1 == lifted_.size();
      // Both ends of a leg are kept, however short it is.
      if (samePlace && !last) continue;
      if (!samePlace || kept == anchor_) ++kept;
      lifted_[kept] = lifted_[next];
    }
    lifted_.resize(kept + 1);
  }

  static constexpr float kShortest = 1e-4f;  // metres between two recorded points

  const NavGraph& graph_;
  std::span<const glm::vec2> path_;
  float tolerance_;
  std::vector<glm::vec3>& lifted_;
  std::size_t leg_ = 0;     // from path_[leg_] to the next
  float along_ = 0.0f;      // share of the leg that is recorded
  std::size_t anchor_ = 0;  // where in lifted_ the leg begins
};

// `portalAt(i)` is the i-th of `count` portals.
template <typename PortalAt>
void pullThrough(glm::vec2 start, glm::vec2 goal, std::size_t count, const PortalAt& portalAt,
                 std::vector<glm::vec2>& path) {
  path.clear();
  path.push_back(start);
  glm::vec2 apex = start;
  std::size_t behind = 0;  // portals that the apex lies beyond or on
  Tip left{apex, behind};
  Tip right{apex, behind};
  const auto turnAt = [&](const Tip& corner) {
    apex = corner.plan;
    behind = corner.portal;
    addWaypoint(apex, path);
    left = right = Tip{apex, behind};
  };
  // The goal is one last portal of zero width. After a corner, the portals beyond it are scanned
  // again.
  for (std::size_t i = 0; i <= count;) {
    const Portal portal = i < count ? portalAt(i) : Portal{goal, goal};
    ++i;
    if (narrow(apex, right, left, 1.0, {portal.right, i}) == Narrowed::kPast) {
      turnAt(left);
      i = behind;
    } else if (narrow(apex, left, right, -1.0, {portal.left, i}) == Narrowed::kPast) {
      turnAt(right);
      i = behind;
    }
  }
  addWaypoint(goal, path);
}

}  // namespace

void pullString(glm::vec2 start, glm::vec2 goal, std::span<const Portal> corridor,
                std::vector<glm::vec2>& path) {
  pullThrough(
      start, goal, corridor.size(), [&](std::size_t i) { return corridor[i]; }, path);
}

void pullString(const NavGraph& graph, glm::vec2 start, glm::vec2 goal,
                std::span<const std::uint32_t> corridor, std::vector<glm::vec2>& path) {
  pullThrough(
      start, goal, corridor.size(), [&](std::size_t i) { return graph.portals[corridor[i]]; },
      path);
}

void liftPath(const NavGraph& graph, PolygonId first, std::span<const std::uint32_t> corridor,
              std::span<const glm::vec2> path, float tolerance, std::vector<glm::vec3>& lifted) {
  lifted.clear();
  appendLifted(graph, first, corridor, path, tolerance, lifted);
}

void appendLifted(const NavGraph& graph, PolygonId first, std::span<const std::uint32_t> corridor,
                  std::span<const glm::vec2> path, float tolerance,
                  std::vector<glm::vec3>& lifted) {
  Lifter(graph, path, tolerance, lifted).lift(first, corridor);
}

float lengthOf(std::span<const glm::vec2> path) {
  float length = 0.0f;
  for (std::size_t i = 1; i < path.size(); ++i) length += glm::distance(path[i - 1], path[i]);
  return length;
}

}  // namespace forewalk::navmesh
