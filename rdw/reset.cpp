#include "rdw/reset.h"

#include <algorithm>
#include <cmath>

namespace forewalk::rdw {

std::string_view sentenceOf(ResetInstruction instruction) {
  switch (instruction) {
    case ResetInstruction::kNone:
      return "";
    case ResetInstruction::kTurnAround:
      return "Stop, and turn around on the spot until the sign goes away.";
    case ResetInstruction::kKeepTurning:
      return "Keep turning the same way until the sign goes away.";
    case ResetInstruction::kWalkBack:
      return "You are outside the tracked space: walk back into it.";
  }
  return "";
}

double Reset::stoppingDistance(double speed) const {
  return settings_.clearance + speed * settings_.reactionTime +
         speed * speed / (2.0 * settings_.deceleration);
}

// The smoothed speed says too late that somebody beside a border sets off towards it; of them the
// step itself is looked at. Further off the smoothed speed does, and is not misled by a head that
// sways.
bool Reset::setsOffTowardBorder(const Motion& motion, glm::dvec2 physical,
                                const TrackedSpace& space) const {
  constexpr double kSlowest = 0.1;  // m/s; slower steps are those of standing
  // A corner can leave no way out but along a wall: nobody is turned back and forth there for ever.
  constexpr int kMostInARow = 3;
  if (resetsSinceWalk_ >= kMostInARow || !motion.usable() ||
      !(motion.distance > kSlowest * motion.dt))
    return false;
  const double free = space.distanceAlong(physical, motion.step / motion.distance);
  return free <= settings_.clearance + motion.distance;
}

bool Reset::mustStop(const Motion& motion, glm::dvec2 physical, const TrackedSpace& space,
                     Step& step) const {
  if (!space.contains(physical)) {
    step.flags |= kOutsideSpace;
    const glm::dvec2 inward = space.nearestBorder(physical).inward;
    return motion.walking && glm::dot(motion.walkingDirection, inward) <= 0.0;
  }
  if (!motion.walking) return setsOffTowardBorder(motion, physical, space);
  const double free = space.distanceAlong(physical, motion.walkingDirection);
  // In the next frame it would be too late.
  const double stop = stoppingDistance(motion.speed) + motion.speed * motion.dt;
  if (free <= stop + settings_.warningTime * motion.speed) step.flags |= kBorderNear;
  return free <= stop;
}

void Reset::aim(double turn) {
  if (!state_.turning) return;
  goal_ = std::abs(turn) > kPi - 1e-9 ? 0.0 : turn > 0.0 ? turn - 2.0 * kPi : turn + 2.0 * kPi;
  if (goal_ == 0.0) return;
  state_.remaining = std::abs(goal_);
  state_.direction = goal_ > 0.0 ? 1 : -1;
}

Reset::Step Reset::frame(const Motion& motion, glm::dvec2 physical, const TrackedSpace& space) {
  Step step;
  const bool stop = mustStop(motion, physical, space, step);
  if (!state_.turning) {
    if (motion.walking) resetsSinceWalk_ = 0;
    state_ = ResetState{};
    if (stop && motion.usable()) {
      // The turn of this very frame belongs to the walk; the reset counts from the next one.
      state_.turning = true;
      goal_ = 0.0;
      state_.remaining = kPi;
      state_.instruction = ResetInstruction::kTurnAround;
      step.began = true;
      ++count_;
      ++resetsSinceWalk_;
    } else if ((step.flags & kOutsideSpace) != 0) {
      state_.instruction = ResetInstruction::kWalkBack;
    }
    return step;
  }
  if (!motion.usable()) return step;  // heads that jumped or times that stood still turn nothing

  const double before = state_.progress;
  if (goal_ != 0.0) {
    const double size = std::abs(goal_);
    const double after =
        std::clamp(before + motion.turn, goal_ > 0.0 ? -kPi : -size, goal_ > 0.0 ? size : kPi);
    step.yaw = (after - before) * (2.0 * kPi / size - 1.0);
    state_.progress = after;
    state_.remaining = std::abs(goal_ - after);
    state_.instruction = ResetInstruction::kKeepTurning;
    if (state_.remaining <= 0.0) {
      state_ = ResetState{};
      step.ended = true;
    }
    return step;
  }
  const double after = std::clamp(before + motion.turn, -kPi, kPi);
  step.yaw = after - before;
  state_.progress = after;
  state_.remaining = kPi - std::abs(after);
  // Five degrees: a head that trembles has not begun to turn.
  if (std::abs(after) > 0.087) {
    state_.direction = after > 0.0 ? 1 : -1;
    state_.instruction = ResetInstruction::kKeepTurning;
  }
  if (std::abs(after) >= kPi) {
    state_ = ResetState{};
    step.ended = true;
  }
  return step;
}

}  // namespace forewalk::rdw
