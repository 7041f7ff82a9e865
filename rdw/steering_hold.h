// Keeps the side to which people are steered from changing more often than once a second.
//
// A rule that chooses its target anew every frame can bend the path left and right in turn. People
// feel that, and it gains nothing. Whatever the controller asks for, the session lets steering to
// the other side through only when the last change is a second old; until then it does nothing.
#pragma once

#include "rdw/gains.h"
#include "rdw/motion.h"

namespace forewalk::rdw {

class SteeringHold {
 public:
  static constexpr double kSeconds = 1.0;

  /// `seconds` between two changes, >= 0; 0 lets everything through.
  explicit SteeringHold(double seconds = kSeconds) : seconds_(seconds) {}

  /// `gains` of a frame of `motion`, neutral where their side has to wait. O(1).
  ///
  /// The side is that to which the body is made to go, whether curvature bends its path or rotation
  /// turns the world: a left turn of the head that is sped up steers to the right, and so does a
  /// right one that is slowed down. A rotation gain that stays above 1, or below, while the head
  /// turns back has not changed sides: its user has.
  Gains held(Gains gains, const Motion& motion) {
    since_ += motion.dt;
    if (gains.rotation != 1.0f && motion.turn != 0.0) {
      const int sense = gains.rotation > 1.0f ? 1 : -1;
      if (sense == sense_ || passes(motion.turn > 0.0 ? -sense : sense)) {
        sense_ = sense;
      } else {
        gains.rotation = 1.0f;
      }
    }
    if (gains.curvature != 0.0f && motion.distance > 0.0) {
      if (!passes(gains.curvature > 0.0f ? 1 : -1)) {
        gains.curvature = 0.0f;
      } else if (gains.rotation == 1.0f) {
        sense_ = 0;
      }
    }
    return gains;
  }

  void restart() { *this = SteeringHold(seconds_); }

 private:
  // Whether steering to `side` may go on, or begin.
  bool passes(int side) {
    if (side == side_) return true;
    if (side_ != 0 && since_ < seconds_) return false;
    side_ = side;
    since_ = 0.0;
    return true;
  }

  double seconds_;
  int side_ = 0;        // to which the user was last steered: +1 left, -1 right, 0 not yet
  int sense_ = 0;       // whether rotation then was above 1 or below; 0 where it was curvature
  double since_ = 0.0;  // seconds since the side changed
};

}  // namespace forewalk::rdw
