#include "rdw/potential_field.h"

#include <algorithm>
#include <cmath>

namespace forewalk::rdw {

namespace {

constexpr double kNearest = 0.01;  // metres

glm::dvec2 push(glm::dvec2 point, glm::dvec2 from) {
  const glm::dvec2 off = point - from;
  const double distance = glm::length(off);
  if (distance == 0.0) return glm::dvec2(0.0);
  const double d = std::max(distance, kNearest);
  return off / distance / (d * d);
}

}  // namespace

glm::dvec2 wayBackIn(const TrackedSpace& space, glm::dvec2 point) {
  return space.nearestBorder(point).inward / (kNearest * kNearest);
}

glm::dvec2 nearestOnEdge(glm::dvec2 a, glm::dvec2 b, glm::dvec2 point) {
  const glm::dvec2 ab = b - a;
  return a + std::clamp(glm::dot(point - a, ab) / glm::dot(ab, ab), 0.0, 1.0) * ab;
}

glm::dvec2 repulsion(const TrackedSpace& space, std::span<const OtherUser> others,
                     glm::dvec2 point) {
  if (!space.contains(point)) return wayBackIn(space, point);
  glm::dvec2 sum(0.0);
  for (std::size_t r = 0; r < space.ringCount(); ++r) {
    const std::span<const glm::dvec2> ring = space.ring(r);
    glm::dvec2 nearest = ring[0];
    double nearest2 = INFINITY;
    for (std::size_t i = 0, j = ring.size() - 1; i < ring.size(); j = i++) {
      const glm::dvec2 on = nearestOnEdge(ring[j], ring[i], point);
      const glm::dvec2 edge = ring[i] - ring[j];
      const glm::dvec2 off = point - ring[j];
      if (r == 0) {
        if (edge.x * off.y - edge.y * off.x > 0.0) sum += push(point, on);
      } else if (glm::dot(on - point, on - point) < nearest2) {
        nearest2 = glm::dot(on - point, on - point);
        nearest = on;
      }
    }
    if (r > 0) sum += push(point, nearest);
  }
  for (const OtherUser& other : others) sum += push(point, other.position);
  return sum;
}

}  // namespace forewalk::rdw
