// The arithmetic that rating one trajectory and searching all of them share, so that both give the
// same numbers to the last bit.
#pragma once

#include <algorithm>
#include <cmath>
#include <glm/glm.hpp>

#include "navmesh/plan.h"

namespace forewalk::agents {

inline float lengthOf(float x, float y) { return std::sqrt(x * x + y * y); }

/// What lies at (x, y) for somebody who looks along +y, for somebody who looks along (dx, dy).
inline float turnedByX(float x, float y, float dx, float dy) { return x * dy + y * dx; }
inline float turnedByY(float x, float y, float dx, float dy) { return y * dy - x * dx; }

/// `v` turned counter-clockwise by the angle with this cosine and sine.
inline glm::vec2 rotatedBy(glm::vec2 v, glm::vec2 cosineAndSine) {
  return {cosineAndSine.x * v.x - cosineAndSine.y * v.y,
          cosineAndSine.y * v.x + cosineAndSine.x * v.y};
}

/// Of (0, 0) from the segment.
inline float squaredDistanceToOrigin(glm::vec2 from, glm::vec2 to) {
  const glm::vec2 edge = to - from;
  const float squaredLength = edge.x * edge.x + edge.y * edge.y;
  const float along = -(from.x * edge.x + from.y * edge.y);
  const float share =
      along <= 0.0f ? 0.0f : (along >= squaredLength ? 1.0f : along / squaredLength);
  const glm::vec2 nearest = from + share * edge;
  return nearest.x * nearest.x + nearest.y * nearest.y;
}

inline float squaredDistanceTo(glm::vec2 from, glm::vec2 to, glm::vec2 point) {
  return squaredDistanceToOrigin(from - point, to - point);
}

/// Of two segments from each other; 0 where they cross.
inline float squaredDistanceBetween(glm::vec2 a, glm::vec2 b, glm::vec2 c, glm::vec2 d) {
  const float abc = navmesh::turn(a, b, c), abd = navmesh::turn(a, b, d);
  const float cda = navmesh::turn(c, d, a), cdb = navmesh::turn(c, d, b);
  if (((abc > 0.0f && abd < 0.0f) || (abc < 0.0f && abd > 0.0f)) &&
      ((cda > 0.0f && cdb < 0.0f) || (cda < 0.0f && cdb > 0.0f))) {
    return 0.0f;
  }
  return std::min(std::min(squaredDistanceTo(c, d, a), squaredDistanceTo(c, d, b)),
                  std::min(squaredDistanceTo(a, b, c), squaredDistanceTo(a, b, d)));
}

}  // namespace forewalk::agents
