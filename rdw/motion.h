// What the user did since the last frame, told apart from what a head does by itself.
//
// A head bobs, sways, and turns about a neck: its path is not the path of the walk. The direction
// of travel is therefore a low-pass of the head's velocity on the plan, with a time constant rather
// than a share per frame, so that 22 Hz recordings and 120 Hz headsets give the same answer. It is
// the direction of travel and not of facing: somebody who sidesteps walks sideways.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>

#include "rdw/frame_flags.h"
#include "rdw/pose.h"

namespace forewalk::rdw {

struct MotionSettings {
  double timeConstant = 0.2;    ///< of the velocity's low-pass, seconds, > 0
  double walkingStarts = 0.30;  ///< smoothed speed above which somebody walks, m/s
  double walkingStops =
      0.15;                   ///< and below which they have stopped, m/s; standing sway stays below
  double jumpDistance = 1.0;  ///< a longer step between frames is lost tracking, metres
  double longestFrame = 0.5;  ///< a longer pause between frames is not integrated, seconds
};

/// One frame of motion in physical space, on the plan. All zero where a flag says that there was
/// none.
struct Motion {
  double dt = 0.0;        ///< seconds since the last frame, >= 0
  glm::dvec2 step{0.0};   ///< of the head, metres
  double distance = 0.0;  ///< length of the step, metres
  double turn = 0.0;      ///< change of the head's heading, radians, left positive, in (-pi, pi]
  double turnRate = 0.0;  ///< turn / dt, rad/s
  double speed = 0.0;     ///< length of the smoothed velocity, m/s
  glm::dvec2 walkingDirection{0.0};  ///< unit vector of the smoothed velocity; zero unless walking
  double travelTurn = 0.0;  ///< change of walkingDirection's heading while walking, radians
  bool walking = false;
  std::uint32_t flags = kFrameSound;  ///< of FrameFlags: only those about time and tracking

  /// Whether gains may act on this frame.
  bool usable() const {
    return (flags &
            (kFirstFrame | kTimeStoodStill | kTimeRanBackwards | kTimeGap | kTrackingJump)) == 0;
  }
};

/// Turns poses into motion. Remembers the last pose and the smoothed velocity.
class MotionTracker {
 public:
  explicit MotionTracker(const MotionSettings& settings = {}) : settings_(settings) {}

  /// `pose` is sound (see cleaned()), `seconds` any time base that runs forward.
  /// - First frame: no motion.
  /// - Time stands still: no motion; the pose the next step is measured from stays the earlier one,
  /// so
  ///   that nothing walked is lost.
  /// - Time runs backwards or is not finite, or a gap of more than `longestFrame`: no motion, and
  /// the
  ///   velocity is forgotten; the next step is measured from here.
  /// - A step longer than `jumpDistance`: tracking was lost. No motion, velocity forgotten. The map
  /// from
  ///   physical to virtual stays as it is, so the virtual pose jumps with the body, and walls keep
  ///   their place in the room.
  const Motion& frame(const HeadPose& pose, double seconds);

  const Motion& last() const { return motion_; }

  /// What the next frame is measured from, and back: frames after resume() go on to the bit. A
  /// memory that is not sound is the caller's mistake (Session::resume refuses it).
  struct Memory {
    glm::dvec2 position{0.0};  ///< plan, metres
    glm::dvec2 velocity{0.0};  ///< smoothed, m/s
    double heading = 0.0;      ///< radians
    double seconds = 0.0;
    bool started = false;  ///< false: the next frame is a first one
    bool walking = false;
  };
  Memory memory() const {
    return {position_, velocity_, heading_, seconds_, started_, motion_.walking};
  }
  void resume(const Memory& memory);

  void reset() { *this = MotionTracker(settings_); }

 private:
  MotionSettings settings_;
  Motion motion_;
  glm::dvec2 position_{0.0};
  glm::dvec2 velocity_{0.0};
  double heading_ = 0.0;
  double seconds_ = 0.0;
  bool started_ = false;
};

}  // namespace forewalk::rdw
