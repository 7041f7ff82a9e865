// Keeps the side to which a path is bent from changing more often than once a second.
//
// A rule that chooses its target anew every frame can bend the path left and right in turn. People
// feel that, and it gains nothing. Whatever the controller asks for, the session lets a curvature
// to the other side through only when the last change is a second old; until then it bends nothing.
#pragma once

#include "rdw/gains.h"

namespace forewalk::rdw {

class SteeringHold {
 public:
  static constexpr double kSeconds = 1.0;

  /// `gains` of a frame of `dt` seconds in which `distance` metres were walked, with curvature 0
  /// where its side has to wait. O(1).
  Gains held(Gains gains, double dt, double distance) {
    since_ += dt;
    const int side = gains.curvature > 0.0f ? 1 : gains.curvature < 0.0f ? -1 : 0;
    if (side == 0 || distance == 0.0 || side == side_) return gains;
    if (side_ != 0 && since_ < kSeconds) {
      gains.curvature = 0.0f;
      return gains;
    }
    side_ = side;
    since_ = 0.0;
    return gains;
  }

  void restart() { *this = SteeringHold(); }

 private:
  int side_ = 0;        // to which the path was last bent
  double since_ = 0.0;  // seconds since it changed
};

}  // namespace forewalk::rdw
