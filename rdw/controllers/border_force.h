// The force of Messinger, Hodgson and Bachmann, "Effects of Tracking Area Shape and Size on
// Artificial Potential Field Redirected Walking", IEEE VR 2019, made by a room's border.
#pragma once

#include <algorithm>
#include <cmath>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "rdw/other_user.h"
#include "rdw/potential_field.h"
#include "rdw/tracked_space.h"

namespace forewalk::rdw {

/// Border and obstacles in segments of at most a metre, each with a middle, an inner normal n and a
/// length. At d from a middle with n . d > 0 it pushes by 0.00897 * length * d / |d|^3.656.
class BorderForce {
 public:
  /// Allocates. O(metres of border).
  void prepare(const TrackedSpace& space) {
    segments_.clear();
    for (std::size_t r = 0; r < space.ringCount(); ++r) {
      const std::span<const glm::dvec2> ring = space.ring(r);
      for (std::size_t i = 0, j = ring.size() - 1; i < ring.size(); j = i++) {
        const glm::dvec2 edge = ring[i] - ring[j];
        const double length = glm::length(edge);
        const int pieces = std::max(1, static_cast<int>(std::ceil(length - 1e-9)));
        for (int k = 0; k < pieces; ++k) {
          segments_.push_back({ring[j] + (k + 0.5) / pieces * edge,
                               glm::dvec2(-edge.y, edge.x) / length, length / pieces});
        }
      }
    }
  }

  /// In the `space` of prepare(); outside it: wayBackIn() of potential_field.h. O(segments).
  glm::dvec2 at(glm::dvec2 point, const TrackedSpace& space) const {
    if (!space.contains(point)) return wayBackIn(space, point);
    glm::dvec2 sum(0.0);
    for (const Segment& segment : segments_) {
      const glm::dvec2 d = point - segment.middle;
      if (glm::dot(segment.inward, d) <= 0.0) continue;
      const double distance = std::max(glm::length(d), kNearest);
      sum += 0.00897 * segment.length * d / std::pow(distance, 3.656);
    }
    return sum;
  }

 private:
  static constexpr double kNearest = 0.01;  // metres
  struct Segment {
    glm::dvec2 middle, inward;
    double length;
  };
  std::vector<Segment> segments_;
};

/// How much two users matter to each other: clamp01((cos a + cos b) / 2), a and b the angles at
/// which each sees the other from where they face. Whose facing is not known sees nobody aside.
inline double mutualSight(glm::dvec2 position, glm::dvec2 facing, const OtherUser& other) {
  const glm::dvec2 to = other.position - position;
  const double distance = glm::length(to);
  if (distance == 0.0) return 1.0;
  const double seen = glm::dot(facing, to) / distance;
  const double back = -glm::dot(other.facing, to) / distance;
  return std::clamp(0.5 * (seen + back), 0.0, 1.0);
}

}  // namespace forewalk::rdw
