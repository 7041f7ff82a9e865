// When no gain keeps the user inside, they are stopped and turned.
//
// When somebody has to be stopped is the same for every reset, and so is carrying it out: while the
// body turns by an angle, the world turns along, so that the user has seen a whole turn (or none)
// and looks where they looked before. The angle is a ResetPolicy's (reset_policy.h); without one it
// is the 2:1 turn of Williams et al. 2007: 180 degrees, either way.
#pragma once

#include <cstdint>
#include <limits>
#include <string_view>

#include "rdw/motion.h"
#include "rdw/pose.h"
#include "rdw/reset_policy.h"
#include "rdw/tracked_space.h"

namespace forewalk::rdw {

/// What brings a reset about.
enum class ResetTrigger : std::uint8_t {
  kAhead,   ///< the free way ahead is as short as the way of stopping, plus the clearance
  kBorder,  ///< as the toolkits: a border, obstacle or other user is nearer than the clearance, to
            ///< whichever side, and the walk leads toward it. To compare with published
            ///< simulations: who walks along a wall into a corner is turned again and again
};

/// When to stop somebody. Stopping takes the way of the reaction plus the way of braking;
/// `clearance` is what must be left then.
struct ResetSettings {
  double reactionTime = 0.30;  ///< from the sign to the first slower step, seconds, >= 0
  double deceleration = 3.0;   ///< of a walker who stops, m/s^2, > 0
  double clearance = 0.20;     ///< free floor in front of somebody who has stopped, metres, >= 0
  double warningTime = 1.0;    ///< how much earlier kBorderNear is raised, seconds, >= 0
  ResetTrigger trigger = ResetTrigger::kAhead;
};

/// What to tell the user. The text is the caller's; these name it.
enum class ResetInstruction : std::uint8_t {
  kNone,
  kTurnAround,   ///< stop and turn on the spot, either way
  kKeepTurning,  ///< the way they began, `remaining` to go
  kWalkBack,     ///< outside the tracked space, and heading for it: walk back in
  kStepBack,     ///< stop and step backwards, `back` to go
  kTurnLeft,     ///< stop and turn left on the spot, `remaining` to go
  kTurnRight,
};
inline constexpr ResetInstruction kLastInstruction = ResetInstruction::kTurnRight;

/// A short English sentence for each.
std::string_view sentenceOf(ResetInstruction instruction);

/// What a frame should know about resets.
struct ResetState {
  bool turning = false;    ///< a reset is under way
  int direction = 0;       ///< +1 left, -1 right, 0 not begun: the way the user is turning
  double progress = 0.0;   ///< physical radians turned since it began, left positive
  double remaining = 0.0;  ///< physical radians to go that way, >= 0; above 2 pi only after turning
                           ///< the other way
  double back = 0.0;       ///< metres to step back before the turn, >= 0
  int wanted = 0;          ///< the way that the reset asks for: +1 left, -1 right, 0 either
  double gain = 2.0;       ///< virtual radians per physical radian turned
  ResetInstruction instruction = ResetInstruction::kNone;
};

/// Watches the border and runs the turn. Remembers the reset under way and how many there were.
class Reset {
 public:
  explicit Reset(const ResetSettings& settings = {}) : settings_(settings) {}

  struct Step {
    double yaw = 0.0;     ///< by which the world is to be turned about the head this frame, radians
    bool frozen = false;  ///< and it is to move along with this frame's step
    bool began = false;   ///< this frame is the first of a reset
    bool ended = false;   ///< and this one the last
    std::uint32_t flags = 0;  ///< kOutsideSpace, kBorderNear
  };

  /// One frame. Before the trigger: begins a reset when the user walks and
  /// - inside: the free floor along the walking direction will in the next frame be no longer than
  ///   clearance + speed * reactionTime + speed^2 / (2 * deceleration). How near the border is to
  ///   the side does not count: somebody beside a wall who walks along it would be turned back and
  ///   forth in a corner for ever;
  /// - inside, not walking yet: a step faster than 0.1 m/s leads along less than clearance of free
  ///   floor;
  /// - outside: the walk, or of somebody not walking yet the step, does not lead back onto the
  ///   floor. Walking back in from outside is let be.
  /// Other users are obstacles that come closer while one stops.
  /// Somebody near a border who stands, or walks away from it or along it, is let be.
  ///
  /// While turning: progress is the sum of the head's turns since the first frame; the world has
  /// been turned by (gain - 1) times that in all, back and forth included. It ends in the frame in
  /// which the progress reaches the plan's angle either way; of that frame only the part up to
  /// there counts: the world has then been turned by exactly the plan's angle. Steps walked while
  /// turning are passed on unscaled, but for frozen resets. O(corners + others), allocates nothing.
  ///
  /// Some plans are changed, so that resets cannot follow each other on the spot for ever:
  /// - one whose end would face a way too short to set off on at a walk and to be stopped again:
  ///   the user faces the freest of 36 directions;
  /// - a turn either way by the third reset in a row without a way ahead (twice that of stopping at
  ///   a walk): likewise. Not with ResetTrigger::kBorder, which does as the toolkits;
  /// - outside, where it would not end facing the floor: the user faces the nearest border, or the
  ///   freest way from there.
  /// Stepping back ends where less than the clearance is free behind.
  Step frame(const SteerInput& input, ResetPolicy& policy);

  /// The same alone, with the 2:1 turn.
  Step frame(const Motion& motion, glm::dvec2 physical, const TrackedSpace& space);

  const ResetState& state() const { return state_; }
  std::uint64_t count() const { return count_; }  ///< resets begun

  /// What the next frame depends on, and back: frames after resume() go on to the bit.
  struct Memory {
    ResetState state;
    ResetPlan plan;                                              ///< of the reset under way
    double backward = std::numeric_limits<double>::quiet_NaN();  ///< heading of stepping back,
                                                                 ///< physical radians; NaN: none
    std::uint64_t count = 0;
    int inARow = 0;  ///< resets begun since the user last walked with a way ahead of them
  };
  Memory memory() const { return {state_, plan_, backward_, count_, resetsInARow_}; }
  void resume(const Memory& memory) {
    state_ = memory.state;
    plan_ = memory.plan;
    backward_ = memory.backward;
    count_ = memory.count;
    resetsInARow_ = memory.inARow;
  }

  /// What state() is while a reset goes by `plan`, `progress` radians turned (left positive) and
  /// `back` metres left to step back; its direction and instruction are those of a turn not begun.
  static ResetState underWay(const ResetPlan& plan, double progress, double back);

  /// Length of floor at `speed` m/s at which a reset begins, metres.
  double stoppingDistance(double speed) const;

 private:
  /// Whom and where, as far as the trigger needs it.
  struct Around {
    const Motion& motion;
    glm::dvec2 physical;
    const TrackedSpace& space;
    std::span<const OtherUser> others;
  };
  bool mustStop(const Around& around, Step& step) const;
  bool isAtBorder(const Around& around) const;
  bool setsOffTowardBorder(const Around& around) const;
  bool waitsFor(const Around& around, Step& step);  // whether a reset begins
  void begin(const ResetPlan& plan, const Motion& motion);
  void carryOn(const Around& around, Step& step);
  double worthSettingOff(double speed) const;  // metres
  bool hasWayAhead(const Around& around) const;
  ResetPlan mended(const ResetPlan& plan, const SteerInput& input) const;

  ResetSettings settings_;
  ResetState state_;
  ResetPlan plan_;
  double backward_ = std::numeric_limits<double>::quiet_NaN();  // heading of stepping back, or NaN
  std::uint64_t count_ = 0;
  int resetsInARow_ = 0;  ///< begun since the user last walked with a way ahead of them
};

}  // namespace forewalk::rdw
