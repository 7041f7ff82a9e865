#include "prediction/portal_ends.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <utility>

#include "navmesh/plan.h"
#include "prediction/prediction_graph.h"

namespace forewalk::prediction {

using glm::dvec2;
using navmesh::cross;
using navmesh::NavGraph;

float roundingOf(const NavGraph& graph) {
  float extent = 1.0f;
  for (const glm::vec2 corner : graph.ring) {
    extent = std::max({extent, std::abs(corner.x), std::abs(corner.y)});
  }
  return 4 * std::numeric_limits<float>::epsilon() * extent;
}

namespace {

constexpr double kPi = 3.14159265358979323846;

/// Finds out which portal ends are one. Slot 2h is the left end of half-portal h, 2h + 1 the right.
class EndWelder {
 public:
  explicit EndWelder(const NavGraph& graph)
      : graph_(graph), tolerance_(roundingOf(graph)), above_(2 * graph.portalCount()) {
    for (std::uint32_t slot = 0; slot < above_.size(); ++slot) above_[slot] = slot;
  }

  PortalEnds weld() {
    for (std::uint32_t h = 0; h < graph_.portalCount(); ++h) {
      const std::uint32_t twin = graph_.portalTwin[h];
      unite(leftOf(h), rightOf(twin));
      unite(rightOf(h), leftOf(twin));
      if (graph_.portals[h].left == graph_.portals[h].right) unite(leftOf(h), rightOf(h));
    }
    for (std::uint32_t p = 0; p < graph_.polygonCount(); ++p) uniteWithin(p);
    number();
    for (std::uint32_t p = 0; p < graph_.polygonCount(); ++p) addAngles(p);
    judge();
    return std::move(ends_);
  }

 private:
  static std::uint32_t leftOf(std::uint32_t h) { return 2 * h; }
  static std::uint32_t rightOf(std::uint32_t h) { return 2 * h + 1; }
  glm::vec2 planOf(std::uint32_t slot) const {
    const navmesh::Portal& portal = graph_.portals[slot / 2];
    return slot % 2 == 0 ? portal.left : portal.right;
  }
  bool same(glm::vec2 a, glm::vec2 b) const { return glm::distance(a, b) <= tolerance_; }

  std::uint32_t find(std::uint32_t slot) {
    while (above_[slot] != slot) slot = above_[slot] = above_[above_[slot]];
    return slot;
  }
  void unite(std::uint32_t a, std::uint32_t b) {
    a = find(a);
    b = find(b);
    above_[std::max(a, b)] = std::min(a, b);
  }

  /// The half-portal after `h` around its polygon, counter-clockwise.
  std::uint32_t after(std::uint32_t polygon, std::uint32_t h) const {
    return h + 1 < graph_.portalStart[polygon + 1] ? h + 1 : graph_.portalStart[polygon];
  }

  /// Portals one after the other around a polygon share an end where no wall lies between them.
  void uniteWithin(std::uint32_t polygon) {
    for (std::uint32_t h = graph_.portalStart[polygon]; h < graph_.portalStart[polygon + 1]; ++h) {
      const std::uint32_t next = after(polygon, h);
      if (next != h && same(graph_.portals[h].left, graph_.portals[next].right)) {
        unite(leftOf(h), rightOf(next));
      }
    }
  }

  void number() {
    const std::uint32_t portals = graph_.portalCount();
    std::vector<std::uint32_t> idOf(above_.size());
    for (std::uint32_t slot = 0; slot < above_.size(); ++slot) {
      const std::uint32_t first = find(slot);
      if (first == slot) {
        idOf[slot] = ends_.count();
        ends_.plan.push_back(planOf(slot));
        const navmesh::PortalHeights& heights = graph_.portalHeights[slot / 2];
        ends_.height.push_back(slot % 2 == 0 ? heights.left : heights.right);
      } else {
        idOf[slot] = idOf[first];
      }
    }
    ends_.walls.assign(ends_.count(), {});
    angle_.assign(ends_.count(), 0.0);
    border_.assign(ends_.count(), 0);
    moved_.assign(ends_.count(), 0);
    pinch_.assign(ends_.count(), 0);
    for (std::uint32_t h = 0; h < portals; ++h) {
      const PortalEnds::Pair pair{idOf[leftOf(h)], idOf[rightOf(h)]};
      ends_.ofPortal.push_back(pair);
      if (graph_.portals[h].left != ends_.plan[pair.left]) moved_[pair.left] = 1;
      if (graph_.portals[h].right != ends_.plan[pair.right]) moved_[pair.right] = 1;
      if (pair.left == pair.right) pinch_[pair.left] = 1;
    }
  }

  /// The walkable angle of a polygon at one of its portal ends, and the ring corners on its two
  /// sides there. `corner` is the corner at the end of the portal's edge that the portal's end may
  /// coincide with.
  struct Inside {
    double angle;
    glm::vec2 next, previous;  // along the ring
  };
  Inside insideAt(std::span<const glm::vec2> ring, glm::vec2 end, std::uint32_t edge,
                  std::size_t corner) const {
    const std::size_t n = ring.size();
    if (!same(end, ring[corner])) return {kPi, ring[(edge + 1) % n], ring[edge]};
    const glm::vec2 next = ring[(corner + 1) % n];
    const glm::vec2 previous = ring[(corner + n - 1) % n];
    const dvec2 in = dvec2(previous) - dvec2(ring[corner]);
    const dvec2 out = dvec2(next) - dvec2(ring[corner]);
    if (in == dvec2(0.0) || out == dvec2(0.0)) return {kPi, next, previous};
    const double angle = std::atan2(cross(out, in), glm::dot(out, in));
    // Rounding may turn a straight corner inward a little, and the tip of a sliver inside out.
    return {angle < -0.5 * kPi ? angle + 2 * kPi : std::abs(angle), next, previous};
  }

  void addAngles(std::uint32_t polygon) {
    const std::span<const glm::vec2> ring = graph_.ringOf(PolygonId{polygon});
    for (std::uint32_t h = graph_.portalStart[polygon]; h < graph_.portalStart[polygon + 1]; ++h) {
      const std::uint32_t edge = graph_.portalEdge[h];
      const std::uint32_t left = ends_.ofPortal[h].left;
      const Inside atLeft = insideAt(ring, graph_.portals[h].left, edge, (edge + 1) % ring.size());
      angle_[left] += atLeft.angle;
      const std::uint32_t next = after(polygon, h);
      const std::uint32_t right = ends_.ofPortal[next].right;
      if (right == left) continue;
      // A wall between them: seen from inside, it begins at the left end of the one, and ends at
      // the right end of the other.
      const std::uint32_t nextEdge = graph_.portalEdge[next];
      const Inside atRight = insideAt(ring, graph_.portals[next].right, nextEdge, nextEdge);
      angle_[right] += atRight.angle;
      border_[left] = border_[right] = 1;
      ends_.walls[left].first = atLeft.next;
      ends_.walls[right].last = atRight.previous;
    }
  }

  void judge() {
    for (std::uint32_t end = 0; end < ends_.count(); ++end) {
      // Too many bends only cost time, too few lose ways. Built meshes are full of walls that are
      // exactly straight; where ends were moved, there is no exactly.
      using Kind = PortalEnds::Kind;
      constexpr double kNearly = 1e-3;
      const bool bend = border_[end] && angle_[end] > kPi + (moved_[end] ? -kNearly : 1e-12);
      const bool plain = !moved_[end] && angle_[end] < 2 * kPi - kNearly;
      ends_.kind.push_back(pinch_[end]     ? Kind::kPinch
                           : bend && plain ? Kind::kBend
                           : bend          ? Kind::kKnot
                                           : Kind::kOpen);
      ends_.bendCount += bend || pinch_[end] ? 1 : 0;
    }
  }

  const NavGraph& graph_;
  float tolerance_;
  std::vector<std::uint32_t> above_;
  PortalEnds ends_;
  // Per end:
  std::vector<double> angle_;  // walkable, radians
  std::vector<char> border_;   // some wall begins here
  std::vector<char> moved_;    // some portal was a little off
  std::vector<char> pinch_;
};

}  // namespace

PortalEnds makePortalEnds(const NavGraph& graph) { return EndWelder(graph).weld(); }

}  // namespace forewalk::prediction
