// The free velocity nearest to the preferred one, outside a set of cones.
//
// What velocity obstacles come down to (Fiorini and Shiller 1998; Snape et al. 2011): the nearest
// free velocity is the preferred one, its projection on a side, a side's crossing with the circle
// of greatest speed, or a crossing of two sides.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

namespace forewalk::agents {

/// Forbidden is what lies between the sides (left of `right`, right of `left`), and beyond the cut
/// where there is one: dot(v - apex, cutDirection) > cut. With sides 180 degrees apart: a
/// half-plane.
struct VelocityCone {
  glm::vec2 apex;          ///< m/s
  glm::vec2 right, left;   ///< unit vectors
  glm::vec2 cutDirection;  ///< unit vector; 0: no cut
  float cut;               ///< m/s
  bool hard;               ///< a wall: never to be entered
  // For the time until a velocity collides: a disc at `apart` of radius `reach` (a wall: of its
  // nearest point). Metres.
  glm::vec2 apart;
  float reach;

  bool hasCut() const { return cutDirection != glm::vec2(0.0f); }

  static constexpr float kOnBorder = 1e-4f;  // m/s: crossings lie on sides up to rounding

  bool forbids(glm::vec2 v) const {
    const glm::vec2 w = v - apex;
    return right.x * w.y - right.y * w.x > kOnBorder && left.x * w.y - left.y * w.x < -kOnBorder &&
           cutDirection.x * w.x + cutDirection.y * w.y > cut + kOnBorder;
  }
};

/// The cone of directions from the origin to a disc at `apart` of radius `reach`, |apart| > reach,
/// with its apex at `apex`. `horizon` seconds; 0: no cut.
VelocityCone coneOfDisc(glm::vec2 apart, float reach, glm::vec2 apex, float horizon);

/// Forbids to go along the unit vector `towards` faster than `speed` (beside `apex`).
VelocityCone halfPlaneCone(glm::vec2 towards, glm::vec2 apex, float speed);

/// Buffers of the search.
struct ConeScratch {
  struct Edge {
    glm::vec2 point, direction;
    float from, to;         // where it is slow enough, m/s along `direction`
    float foot;             // where its line is nearest to the preferred velocity
    float start;            // where the edge is
    float squaredDistance;  // there
  };
  std::vector<Edge> edges;
  std::vector<std::uint32_t> order;
  std::vector<float> sides;     // of the cones, row by row
  std::vector<float> from, to;  // the stretch of one edge that each cone forbids
};

/// Sets `velocity` to the free one nearest to `preferred` (which is at most `maximumSpeed`). Of two
/// equally near, the one on `side` (1 left, -1 right). False where none is free. O(n) where
/// `preferred` is free, otherwise up to O(n^3); sides farther than the best so far are not looked
/// at.
bool nearestFree(std::span<const VelocityCone> cones, glm::vec2 preferred, float maximumSpeed,
                 float side, ConeScratch& scratch, glm::vec2& velocity);

/// The least |v - preferred| + weight / (time to collision) over a polar sample of at most
/// `maximumSpeed`, the projections on the sides (left in `scratch` by nearestFree), `preferred` and
/// `present`. Velocities that hard cones forbid come after all others. Never fails.
glm::vec2 leastDangerous(std::span<const VelocityCone> cones, glm::vec2 preferred,
                         glm::vec2 present, float maximumSpeed, float weight, float seconds,
                         float side, const ConeScratch& scratch);

}  // namespace forewalk::agents
