#include "rdw/reset.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "rdw/free_way.h"

namespace forewalk::rdw {

namespace {

constexpr int kFaceSteps = 36;  // directions looked at where a plan faces a wall
constexpr double kNoHeading = std::numeric_limits<double>::quiet_NaN();

ResetInstruction turnOf(int wanted) {
  return wanted > 0   ? ResetInstruction::kTurnLeft
         : wanted < 0 ? ResetInstruction::kTurnRight
                      : ResetInstruction::kTurnAround;
}

// The way that is asked for or, either way, that has been begun.
double remainingOf(const ResetPlan& plan, const ResetState& state) {
  const bool left = state.wanted != 0 ? state.wanted > 0 : state.progress >= 0.0;
  return left ? plan.left - state.progress : plan.right + state.progress;
}

/// Whether the head has moved faster in this frame than those who stand move theirs.
bool isStep(const Motion& motion) {
  constexpr double kSlowest = 0.1;  // m/s
  return motion.usable() && motion.distance > kSlowest * motion.dt;
}

/// Where somebody who went along `ahead` goes after `plan`.
glm::dvec2 facedBy(const ResetPlan& plan, glm::dvec2 ahead) {
  return rotated(ahead, std::isfinite(plan.left) ? plan.left : -plan.right);
}

/// The turn that ends facing `direction` and is seen, or not, as that of `plan` is.
ResetPlan facing(glm::dvec2 direction, const ResetPlan& plan, const SteerInput& input) {
  const ResetPlan turn = turnTo(aheadOf(input), direction);
  if (plan.seen != 0.0) return turn;
  // Of a turn that is not seen either way round is as good.
  const double shorter = 2.0 * kPi - std::min(turn.left, turn.right);
  ResetPlan frozen = plan;
  frozen.left = std::isfinite(turn.left) ? turn.left : shorter;
  frozen.right = std::isfinite(turn.right) ? turn.right : shorter;
  return frozen;
}

/// The plan, of somebody outside the floor, or the shortest way back in where it would not end
/// facing that (as good as across the border), or `mayStand` says that it has been tried.
ResetPlan backIn(const ResetPlan& plan, const SteerInput& input, double needed, bool mayStand) {
  constexpr double kAcross = 0.5;  // cosine of what counts as across the border
  const auto border = input.space.nearestBorder(input.physical.position);
  const glm::dvec2 ahead = aheadOf(input);
  const auto leadsIn = [&](glm::dvec2 direction) {
    return glm::dot(direction, border.inward) >= kAcross &&
           freeAlong(input.space, input.others, border.position, direction) >= needed;
  };
  if (mayStand && leadsIn(facedBy(plan, ahead))) return plan;
  if (leadsIn(border.inward)) return facing(border.inward, plan, input);
  // Beyond a corner the floor may lie aside: to a point of it, then.
  const glm::dvec2 freest =
      freestDirection(input.space, input.others, border.position, border.inward, kFaceSteps);
  const glm::dvec2 floor = border.position + 0.5 * needed * freest;
  return facing(glm::normalize(floor - input.physical.position), plan, input);
}

/// The plan, or the freest way where it would end facing a border or somebody.
ResetPlan passable(const ResetPlan& plan, const SteerInput& input, double needed) {
  const glm::dvec2 position = input.physical.position;
  const glm::dvec2 ahead = aheadOf(input);
  if (freeAlong(input.space, input.others, position, facedBy(plan, ahead)) >= needed) return plan;
  return facing(freestDirection(input.space, input.others, position, -ahead, kFaceSteps), plan,
                input);
}

}  // namespace

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
    case ResetInstruction::kStepBack:
      return "Stop, and step backwards until the sign goes away.";
    case ResetInstruction::kTurnLeft:
      return "Stop, and turn left on the spot until the sign goes away.";
    case ResetInstruction::kTurnRight:
      return "Stop, and turn right on the spot until the sign goes away.";
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
bool Reset::setsOffTowardBorder(const Around& around) const {
  const Motion& motion = around.motion;
  if (!isStep(motion)) return false;
  const double free =
      freeAlong(around.space, around.others, around.physical, motion.step / motion.distance);
  return free <= settings_.clearance + motion.distance;
}

bool Reset::isAtBorder(const Around& around) const {
  const Motion& motion = around.motion;
  // The step itself: the toolkits' users are at full speed at once.
  if (!motion.usable() || !(motion.distance > 1e-6)) return false;
  const glm::dvec2 direction = motion.step / motion.distance;
  const double buffer = settings_.clearance;
  for (const OtherUser& other : around.others) {
    const glm::dvec2 to = other.position - around.physical;
    if (glm::length(to) <= buffer + other.radius && glm::dot(to, direction) > 0.0) return true;
  }
  constexpr double kAlong = 0.0175;  // cosine of the toolkits' 89 degrees
  for (std::size_t r = 0; r < around.space.ringCount(); ++r) {
    const std::span<const glm::dvec2> ring = around.space.ring(r);
    for (std::size_t i = 0, j = ring.size() - 1; i < ring.size(); j = i++) {
      const glm::dvec2 edge = ring[i] - ring[j];
      const double share =
          std::clamp(glm::dot(around.physical - ring[j], edge) / glm::dot(edge, edge), 0.0, 1.0);
      const glm::dvec2 to = ring[j] + share * edge - around.physical;
      const double distance = glm::length(to);
      if (distance <= buffer && glm::dot(to, direction) > kAlong * distance) return true;
    }
  }
  return false;
}

bool Reset::mustStop(const Around& around, Step& step) const {
  const Motion& motion = around.motion;
  const glm::dvec2 physical = around.physical;
  if (!around.space.contains(physical)) {
    step.flags |= kOutsideSpace;
    // Of somebody who does not walk yet the step counts: by the time that they walk they would be a
    // foot further out.
    const glm::dvec2 way = motion.walking   ? motion.walkingDirection
                           : isStep(motion) ? motion.step / motion.distance
                                            : glm::dvec2(0.0);
    if (way == glm::dvec2(0.0)) return false;
    const TrackedSpace::BorderPoint border = around.space.nearestBorder(physical);
    const double inward = glm::dot(way, border.inward);
    if (inward <= 0.0) return true;
    // Beside a corner a way that leads inward may still miss the floor.
    constexpr double kWithin = 0.1;  // metres past the border
    return !around.space.contains(physical + (border.distance / inward + kWithin) * way);
  }
  if (settings_.trigger == ResetTrigger::kBorder) return isAtBorder(around);
  if (!motion.walking) return setsOffTowardBorder(around);
  const glm::dvec2 ahead = motion.walkingDirection;
  double free = around.space.distanceAlong(physical, ahead);
  // Somebody else comes closer while one stops.
  const double stopping = settings_.reactionTime + motion.speed / settings_.deceleration;
  for (const OtherUser& other : around.others) {
    const double closing = std::max(0.0, -glm::dot(other.velocity, ahead));
    free = std::min(free, freeAmong({&other, 1}, physical, ahead) - closing * stopping);
  }
  // In the next frame it would be too late.
  const double stop = stoppingDistance(motion.speed) + motion.speed * motion.dt;
  if (free <= stop + settings_.warningTime * motion.speed) step.flags |= kBorderNear;
  return free <= stop;
}

// Enough to set off and to be stopped again, at a walk.
double Reset::worthSettingOff(double speed) const {
  return settings_.clearance + stoppingDistance(std::max(1.0, speed));
}

// Half of it is walked before they are stopped again.
bool Reset::hasWayAhead(const Around& around) const {
  return around.space.contains(around.physical) &&
         freeAlong(around.space, around.others, around.physical, around.motion.walkingDirection) >=
             2.0 * stoppingDistance(std::max(1.0, around.motion.speed));
}

// A turn either way sends the body back along its own line, however short that is: that is what
// such a reset is. But nobody is sent to and fro on the spot.
ResetPlan Reset::mended(const ResetPlan& plan, const SteerInput& input) const {
  constexpr int kToAndFro = 2;     // resets in a row
  constexpr double kSetOff = 0.5;  // m/s; what somebody who sets off reaches before they stop
  if (plan.back > 0.0) return plan;
  const double needed = worthSettingOff(input.motion.speed);
  const bool eitherWay = std::isfinite(plan.left) && std::isfinite(plan.right);
  const bool toAndFro = settings_.trigger != ResetTrigger::kBorder && resetsInARow_ >= kToAndFro;
  if (!input.space.contains(input.physical.position))
    return backIn(plan, input, needed, !(eitherWay && toAndFro));
  if (!eitherWay) return passable(plan, input, needed);
  if (!toAndFro) return plan;
  // By the time that they stand they may be past the corner that they were stopped at; and turned
  // back, stopped at it again.
  const glm::dvec2 ahead = aheadOf(input);
  const glm::dvec2 stopped =
      input.physical.position + stoppingDistance(std::max(kSetOff, input.motion.speed)) * ahead;
  const bool leadsAway =
      !input.space.contains(stopped) ||
      freeAlong(input.space, input.others, stopped, facedBy(plan, ahead)) >= needed;
  if (leadsAway) return passable(plan, input, needed);
  return facing(freestDirection(input.space, input.others, stopped, -ahead, kFaceSteps), plan,
                input);
}

bool Reset::waitsFor(const Around& around, Step& step) {
  const bool stop = mustStop(around, step);
  if (state_.turning) return false;
  if (!std::isnan(backward_)) {
    // Whoever has just stepped back still moves that way by the smoothed velocity: that is not a
    // walk to be stopped.
    const Motion& motion = around.motion;
    if (motion.walking && glm::dot(motion.walkingDirection, directionOf(backward_)) > 0.0)
      return false;
    backward_ = kNoHeading;
  }
  if (resetsInARow_ > 0 && around.motion.walking && hasWayAhead(around)) resetsInARow_ = 0;
  state_ = ResetState{};
  if (stop && around.motion.usable()) return true;
  if ((step.flags & kOutsideSpace) != 0) state_.instruction = ResetInstruction::kWalkBack;
  return false;
}

ResetState Reset::underWay(const ResetPlan& plan, double progress, double back) {
  ResetState state;
  const bool left = std::isfinite(plan.left);
  const bool right = std::isfinite(plan.right);
  const double angle = left ? plan.left : plan.right;
  state.turning = true;
  state.wanted = left && right ? 0 : left ? 1 : -1;
  state.gain = angle > 0.0 ? plan.seen / angle : 0.0;
  state.back = back;
  state.progress = progress;
  state.remaining = remainingOf(plan, state);
  state.instruction = back > 0.0 ? ResetInstruction::kStepBack : turnOf(state.wanted);
  return state;
}

void Reset::begin(const ResetPlan& plan, const Motion& motion) {
  // The turn of this very frame belongs to the walk; the reset counts from the next one.
  plan_ = plan;
  state_ = underWay(plan, 0.0, plan.back);
  backward_ = kNoHeading;
  if (plan.back > 0.0 && motion.walking) {
    backward_ = headingOf(-motion.walkingDirection);
  } else if (plan.back > 0.0 && motion.distance > 0.0) {
    backward_ = headingOf(-motion.step / motion.distance);
  }
  ++count_;
  ++resetsInARow_;
}

void Reset::carryOn(const Around& around, Step& step) {
  const Motion& motion = around.motion;
  step.frozen = plan_.frozen;
  if (!motion.usable()) return;  // heads that jumped or times that stood still turn nothing
  if (state_.back > 0.0) {
    step.yaw = -motion.turn;
    const glm::dvec2 stepBack = std::isnan(backward_) ? glm::dvec2(0.0) : directionOf(backward_);
    const double stepped = glm::dot(motion.step, stepBack);
    state_.back = std::max(0.0, state_.back - stepped);
    if (stepped > 0.0) {
      // Nobody steps back in a straight line, and somebody may have come up behind.
      const double free =
          freeAlong(around.space, around.others, around.physical, motion.step / motion.distance);
      state_.back = std::min(state_.back, std::max(0.0, free - settings_.clearance));
    }
    if (state_.back > 0.0) return;
    if (plan_.left > 0.0 && plan_.right > 0.0) {
      state_.instruction = turnOf(state_.wanted);
      return;
    }
    state_ = ResetState{};
    step.ended = true;
    return;
  }
  const double before = state_.progress;
  // A way round that leads nowhere has to be turned back.
  const double after = std::clamp(before + motion.turn, -plan_.right, plan_.left);
  const double scale = state_.gain - 1.0;
  step.yaw = scale * (after - before);
  state_.progress = after;
  state_.remaining = remainingOf(plan_, state_);
  // Five degrees: a head that trembles has not begun to turn.
  if (state_.wanted == 0 && std::abs(after) > 0.087) {
    state_.direction = after > 0.0 ? 1 : -1;
    state_.instruction = ResetInstruction::kKeepTurning;
  } else if (state_.wanted != 0 && after * state_.wanted > 0.087) {
    state_.direction = state_.wanted;
    state_.instruction = ResetInstruction::kKeepTurning;
  }
  if (after >= plan_.left || after <= -plan_.right) {
    state_ = ResetState{};
    step.ended = true;
  }
}

Reset::Step Reset::frame(const SteerInput& input, ResetPolicy& policy) {
  Step step;
  const Around around{input.motion, input.physical.position, input.space, input.others};
  const bool turning = state_.turning;
  if (waitsFor(around, step)) {
    begin(mended(policy.plan(input), input), input.motion);
    step.began = true;
  } else if (turning) {
    carryOn(around, step);
  }
  return step;
}

Reset::Step Reset::frame(const Motion& motion, glm::dvec2 physical, const TrackedSpace& space) {
  Step step;
  const bool turning = state_.turning;
  const Around around{motion, physical, space, {}};
  if (waitsFor(around, step)) {
    begin(ResetPlan{}, motion);
    step.began = true;
  } else if (turning) {
    carryOn(around, step);
  }
  return step;
}

}  // namespace forewalk::rdw
