// The paths that the toolkits generate on an endless plane, point by point.
//
// RDWT and OpenRDW: 90-degree turns, random turns and a straight walk (Legs, walker.h), and these.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <random>

#include "rdw/pose.h"

namespace forewalk::rdw {

enum class CourseKind : std::uint8_t {
  kSawtooth,     ///< legs of `size`, turns of +turn and -turn
  kCircle,       ///< radius `size`, to the left
  kFigureEight,  ///< a circle to the left, one to the right
  kCorridors,    ///< legs of one to three times `size` on a grid, turns of 90 degrees to either
                 ///< side, never three the same way
};

struct Course {
  CourseKind kind = CourseKind::kSawtooth;
  double size = 5.0;              ///< leg or radius, metres, [0.1, 1e4]
  double turn = 7.0 * kPi / 9.0;  ///< of a sawtooth, radians, [0, pi]; 140 degrees, as theirs
};

/// The corners of a course, for ever.
class CoursePoints {
 public:
  CoursePoints(const Course& course, const PlanarPose& start)
      : course_(course), at_(start.position), heading_(start.heading) {}

  /// The next corner. O(1); draws from `rng` for corridors only.
  glm::dvec2 next(std::mt19937_64& rng);

 private:
  Course course_;
  glm::dvec2 at_;
  double heading_;
  int count_ = 0;  // points so far
  int side_ = 0;   // corridors: of the last turn
  int same_ = 0;   // and how many went that way
};

}  // namespace forewalk::rdw
