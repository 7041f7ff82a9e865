#include "navmesh/sight.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

namespace forewalk::navmesh {

namespace {

constexpr int kMostCrossed = 1 << 20;  // polygons; longer ways are rounding going in circles
constexpr std::uint32_t kNoPortal = std::numeric_limits<std::uint32_t>::max();

double crossed(glm::dvec2 a, glm::dvec2 b) { return a.x * b.y - a.y * b.x; }

/// Where the ray from the origin along `direction` meets the line through a and b.
glm::dvec2 onRay(glm::dvec2 direction, glm::dvec2 a, glm::dvec2 b) {
  const glm::dvec2 ab = b - a;
  const double across = crossed(direction, ab);
  return across == 0.0 ? a : direction * (crossed(a, ab) / across);
}

/// The part of the piece a to b (counter-clockwise about the origin) within the wedge from `right`
/// to `left`; false where there is none.
bool clip(glm::dvec2 right, glm::dvec2 left, glm::dvec2& a, glm::dvec2& b) {
  if (crossed(a, b) <= 1e-12 || crossed(right, b) <= 1e-12 || crossed(a, left) <= 1e-12)
    return false;
  const glm::dvec2 from = a;
  const glm::dvec2 to = b;
  if (crossed(right, from) < 0.0) a = onRay(right, from, to);
  if (crossed(to, left) < 0.0) b = onRay(left, from, to);
  return crossed(a, b) > 1e-12;
}

double distanceToPiece(glm::dvec2 a, glm::dvec2 b) {
  const glm::dvec2 ab = b - a;
  const double along = std::clamp(-glm::dot(a, ab) / glm::dot(ab, ab), 0.0, 1.0);
  return glm::length(a + along * ab);
}

}  // namespace

double sightAlong(const NavGraph& graph, const Location& place, glm::dvec2 direction,
                  double limit) {
  if (place.polygon == kNoPolygon) return 0.0;
  const glm::dvec2 origin(place.plan);
  PolygonId polygon = place.polygon;
  double reached = 0.0;
  for (int n = 0; n < kMostCrossed && reached < limit; ++n) {
    const std::span<const glm::vec2> ring = graph.ringOf(polygon);
    double exit = INFINITY;
    std::uint32_t through = 0;
    for (std::uint32_t i = 0; i < ring.size(); ++i) {
      const glm::dvec2 a = glm::dvec2(ring[i]) - origin;
      const glm::dvec2 ab = glm::dvec2(ring[(i + 1) % ring.size()]) - origin - a;
      const double out = crossed(direction, ab);
      if (out <= 0.0) continue;  // parallel, or the way in
      const double along = crossed(a, ab) / out;
      if (along < exit) {
        exit = along;
        through = i;
      }
    }
    if (!std::isfinite(exit)) return std::min(reached, limit);
    reached = std::max(reached, exit);
    const glm::dvec2 at = origin + exit * direction;
    std::uint32_t next = kNoPortal;
    for (std::uint32_t half = graph.portalStart[index(polygon)];
         half < graph.portalStart[index(polygon) + 1]; ++half) {
      if (graph.portalEdge[half] != through) continue;
      const glm::dvec2 right(graph.portals[half].right);
      const glm::dvec2 left(graph.portals[half].left);
      const glm::dvec2 width = left - right;
      const double along = glm::dot(at - right, width);
      if (along >= -1e-6 && along <= glm::dot(width, width) + 1e-6) next = half;
    }
    if (next == kNoPortal) return std::min(reached, limit);
    polygon = graph.portalTo[next];
  }
  return limit;
}

void visibleSlices(const NavGraph& graph, const Location& place, double reach, std::size_t most,
                   SightScratch& scratch, std::vector<SightSlice>& slices) {
  slices.clear();
  scratch.open.clear();
  if (place.polygon == kNoPolygon) return;
  const glm::dvec2 origin(place.plan);
  const auto end = [&](glm::dvec2 a, glm::dvec2 b) {
    if (slices.size() < most) slices.push_back({origin + a, origin + b});
  };
  // One polygon, seen through the wedge; the first one all around.
  const auto look = [&](const SightScratch::Wedge& wedge, bool all) {
    const std::span<const glm::vec2> ring = graph.ringOf(wedge.polygon);
    const std::uint32_t last = graph.portalStart[index(wedge.polygon) + 1];
    std::uint32_t half = graph.portalStart[index(wedge.polygon)];
    const auto seen = [&](glm::dvec2& a, glm::dvec2& b) {
      return all ? crossed(a, b) > 1e-12 : clip(wedge.right, wedge.left, a, b);
    };
    for (std::uint32_t i = 0; i < ring.size(); ++i) {
      const glm::dvec2 to = glm::dvec2(ring[(i + 1) % ring.size()]) - origin;
      glm::dvec2 at = glm::dvec2(ring[i]) - origin;
      for (; half < last && graph.portalEdge[half] == i; ++half) {
        glm::dvec2 a = glm::dvec2(graph.portals[half].right) - origin;
        glm::dvec2 b = glm::dvec2(graph.portals[half].left) - origin;
        glm::dvec2 wallA = at, wallB = a;
        if (glm::distance(wallA, wallB) > 1e-4 && seen(wallA, wallB)) end(wallA, wallB);
        at = b;
        if (half == wedge.cameBy || !seen(a, b)) continue;
        if (distanceToPiece(a, b) > reach || scratch.open.size() >= most) {
          end(a, b);
        } else {
          scratch.open.push_back({graph.portalTo[half], graph.portalTwin[half], a, b});
        }
      }
      glm::dvec2 b = to;
      if (glm::distance(at, b) > 1e-4 && seen(at, b)) end(at, b);
    }
  };
  look({place.polygon, kNoPortal, {}, {}}, true);
  while (!scratch.open.empty() && slices.size() < most) {
    const SightScratch::Wedge wedge = scratch.open.back();
    scratch.open.pop_back();
    look(wedge, false);
  }
}

}  // namespace forewalk::navmesh
