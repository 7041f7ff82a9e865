// The 2:1 turn: when no gain keeps the user inside, they are stopped and turned.
//
// Williams et al. 2007. The user turns on the spot until the body has turned by 180 degrees, either
// way; the world turns along, so that they have seen exactly 360 and look where they looked before.
#pragma once

#include <cstdint>
#include <string_view>

#include "rdw/motion.h"
#include "rdw/pose.h"
#include "rdw/tracked_space.h"

namespace forewalk::rdw {

/// When to stop somebody. Stopping takes the way of the reaction plus the way of braking;
/// `clearance` is what must be left then.
struct ResetSettings {
  double reactionTime = 0.30;  ///< from the sign to the first slower step, seconds, >= 0
  double deceleration = 3.0;   ///< of a walker who stops, m/s^2, > 0
  double clearance = 0.20;     ///< free floor in front of somebody who has stopped, metres, >= 0
  double warningTime = 1.0;    ///< how much earlier kBorderNear is raised, seconds, >= 0
};

/// What to tell the user. The text is the caller's; these name it.
enum class ResetInstruction : std::uint8_t {
  kNone,
  kTurnAround,   ///< stop and turn on the spot, either way
  kKeepTurning,  ///< the way they began, `remaining` to go
  kWalkBack,     ///< outside the tracked space, and heading for it: walk back in
};

/// A short English sentence for each.
std::string_view sentenceOf(ResetInstruction instruction);

/// What a frame should know about resets.
struct ResetState {
  bool turning = false;    ///< a reset is under way
  int direction = 0;       ///< +1 left, -1 right, 0 not begun: the way the user is turning
  double progress = 0.0;   ///< physical radians turned since it began, left positive
  double remaining = 0.0;  ///< physical radians to go, [0, pi]
  ResetInstruction instruction = ResetInstruction::kNone;
};

/// Watches the border and runs the turn. Remembers the reset under way and how many there were.
class Reset {
 public:
  explicit Reset(const ResetSettings& settings = {}) : settings_(settings) {}

  struct Step {
    double yaw = 0.0;    ///< by which the world is to be turned about the head this frame, radians
    bool began = false;  ///< this frame is the first of a reset
    bool ended = false;  ///< and this one the last
    std::uint32_t flags = 0;  ///< kOutsideSpace, kBorderNear
  };

  /// One frame. Before the trigger: begins a reset when the user walks and
  /// - inside: the free floor along the walking direction will in the next frame be no longer than
  ///   clearance + speed * reactionTime + speed^2 / (2 * deceleration). How near the border is to
  ///   the side does not count: somebody beside a wall who walks along it would be turned back and
  ///   forth in a corner for ever;
  /// - inside, not walking yet: a step faster than 0.1 m/s leads along less than clearance of free
  ///   floor. At most twice before the user has walked again after a reset;
  /// - outside: the walk does not lead back. Walking back in from outside is let be.
  /// Somebody near a border who stands, or walks away from it or along it, is let be.
  ///
  /// While turning: progress is the sum of the head's turns since the first frame; the world has
  /// been turned by that much in all, so the virtual turn is twice the physical one, back and forth
  /// included. It ends in the frame in which the progress reaches pi either way; of that frame only
  /// the part up to pi is doubled: the world has then been turned by exactly +-pi. Steps walked
  /// while turning are passed on unscaled. O(corners), allocates nothing.
  Step frame(const Motion& motion, glm::dvec2 physical, const TrackedSpace& space);

  /// Turns the reset that has just begun: the body shall be turned by `turn` radians, (-pi, pi],
  /// in the end. It is turned the long way round, by pi to 2 pi, so that the world turns with it by
  /// no more than one radian a radian, and the user has seen a full turn.
  void aim(double turn);

  const ResetState& state() const { return state_; }
  std::uint64_t count() const { return count_; }  ///< resets begun

  /// Length of floor at `speed` m/s at which a reset begins, metres.
  double stoppingDistance(double speed) const;

 private:
  bool mustStop(const Motion& motion, glm::dvec2 physical, const TrackedSpace& space,
                Step& step) const;
  bool setsOffTowardBorder(const Motion& motion, glm::dvec2 physical,
                           const TrackedSpace& space) const;

  ResetSettings settings_;
  ResetState state_;
  std::uint64_t count_ = 0;
  double goal_ = 0.0;  ///< physical turn of the reset under way, left positive; 0: pi either way
  int resetsSinceWalk_ = 0;  ///< begun since the user last walked
};

}  // namespace forewalk::rdw
