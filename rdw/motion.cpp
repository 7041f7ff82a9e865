#include "rdw/motion.h"

#include <cmath>

namespace forewalk::rdw {

const Motion& MotionTracker::frame(const HeadPose& pose, double seconds) {
  const PlanarPose now = planarPose(pose);
  const Motion before = motion_;
  motion_ = Motion{};

  const auto startOverFromHere = [&](FrameFlags why) {
    motion_.flags = why;
    position_ = now.position;
    heading_ = now.heading;
    velocity_ = glm::dvec2(0.0);
    // A time that is no number cannot be measured from: the next frame is a first one.
    started_ = std::isfinite(seconds);
    if (started_) seconds_ = seconds;
  };

  if (!std::isfinite(seconds)) {
    startOverFromHere(kTimeRanBackwards);
    return motion_;
  }
  if (!started_) {
    startOverFromHere(kFirstFrame);
    return motion_;
  }
  const double dt = seconds - seconds_;
  if (dt == 0.0) {
    motion_.flags = kTimeStoodStill;
    motion_.speed = before.speed;
    motion_.walking = before.walking;
    motion_.walkingDirection = before.walkingDirection;
    return motion_;
  }
  if (dt < 0.0) {
    startOverFromHere(kTimeRanBackwards);
    return motion_;
  }
  const glm::dvec2 step = now.position - position_;
  const double distance = std::sqrt(step.x * step.x + step.y * step.y);
  if (distance > settings_.jumpDistance) {
    startOverFromHere(kTrackingJump);
    return motion_;
  }
  if (dt > settings_.longestFrame) {
    startOverFromHere(kTimeGap);
    return motion_;
  }

  motion_.dt = dt;
  motion_.step = step;
  motion_.distance = distance;
  motion_.turn = wrapAngle(now.heading - heading_);
  motion_.turnRate = motion_.turn / dt;

  const double share = -std::expm1(-dt / settings_.timeConstant);
  velocity_ += share * (step / dt - velocity_);
  motion_.speed = std::sqrt(velocity_.x * velocity_.x + velocity_.y * velocity_.y);
  motion_.walking =
      motion_.speed > (before.walking ? settings_.walkingStops : settings_.walkingStarts);
  if (motion_.walking) motion_.walkingDirection = velocity_ / motion_.speed;
  if (motion_.walking && before.walking) {
    motion_.travelTurn = angleBetween(before.walkingDirection, motion_.walkingDirection);
  }

  position_ = now.position;
  heading_ = now.heading;
  seconds_ = seconds;
  return motion_;
}

void MotionTracker::resume(const Memory& memory) {
  *this = MotionTracker(settings_);
  position_ = memory.position;
  velocity_ = memory.velocity;
  heading_ = memory.heading;
  seconds_ = memory.seconds;
  started_ = memory.started;
  motion_.speed = std::sqrt(velocity_.x * velocity_.x + velocity_.y * velocity_.y);
  motion_.walking = memory.walking && motion_.speed > 0.0;
  if (motion_.walking) motion_.walkingDirection = velocity_ / motion_.speed;
}

}  // namespace forewalk::rdw
