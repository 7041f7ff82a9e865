#include "rdw/free_way.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "rdw/pose.h"

namespace forewalk::rdw {

double freeAmong(std::span<const OtherUser> others, glm::dvec2 point, glm::dvec2 direction) {
  double free = std::numeric_limits<double>::infinity();
  for (const OtherUser& other : others) {
    const glm::dvec2 to = other.position - point;
    const double along = glm::dot(to, direction);
    if (along <= 0.0) continue;
    const double aside2 = glm::dot(to, to) - along * along;
    const double half2 = other.radius * other.radius - aside2;
    if (half2 > 0.0) free = std::min(free, std::max(0.0, along - std::sqrt(half2)));
  }
  return free;
}

double freeAlong(const TrackedSpace& space, std::span<const OtherUser> others, glm::dvec2 point,
                 glm::dvec2 direction) {
  return std::min(space.distanceAlong(point, direction), freeAmong(others, point, direction));
}

double clearanceAt(const TrackedSpace& space, std::span<const OtherUser> others, glm::dvec2 point) {
  double clearance = space.signedDistance(point);
  for (const OtherUser& other : others) {
    clearance = std::min(clearance, glm::distance(point, other.position) - other.radius);
  }
  return clearance;
}

glm::dvec2 freestDirection(const TrackedSpace& space, std::span<const OtherUser> others,
                           glm::dvec2 point, glm::dvec2 first, int count) {
  glm::dvec2 best = first;
  double most = -1.0;
  for (int i = 0; i < count; ++i) {
    const glm::dvec2 direction = rotated(first, 2.0 * kPi * i / count);
    const double free = freeAlong(space, others, point, direction);
    if (free > most + 1e-9) {
      most = free;
      best = direction;
    }
  }
  return best;
}

}  // namespace forewalk::rdw
