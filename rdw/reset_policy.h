// How a reset turns the user: one interface for every reset.
//
// reset.h says when somebody has to be stopped; a policy says, once, where they are to face then
// and what they see meanwhile; reset.h carries it out. rdw/resets/README.md says what each policy
// does and whose it is.
#pragma once

#include <functional>
#include <limits>
#include <memory>
#include <span>
#include <string_view>
#include <tl/expected.hpp>

#include "navmesh/error.h"
#include "rdw/controller.h"
#include "rdw/pose.h"

namespace forewalk::rdw {

/// A reset as planned when it begins. First `back` metres are walked backwards with the world
/// frozen, then the body turns by `left` or `right`, while the user sees a turn of `seen` the same
/// way round. Both ways round end with the same map.
struct ResetPlan {
  static constexpr double kNever = std::numeric_limits<double>::infinity();

  double left = kPi;        ///< physical radians, >= 0; kNever: not this way round
  double right = kPi;       ///< the same to the right; one of them is finite
  double seen = 2.0 * kPi;  ///< virtual radians either way: whole turns, or 0 (frozen)
  double back = 0.0;        ///< metres, >= 0
  bool frozen = false;      ///< steps and turns move nothing virtually while it lasts
};

/// Which way the user of this frame goes in the room, a unit vector: the direction of travel, of
/// whoever stands that of the step or the heading.
glm::dvec2 aheadOf(const SteerInput& input);

/// The plan that makes somebody who goes along unit vector `ahead` go along `direction` (physical)
/// after a virtual turn of 360 degrees: the longer way round, so that the rotation gain lies in
/// [1, 2] (the peers turn the shorter way, where it has no upper limit).
ResetPlan turnTo(glm::dvec2 ahead, glm::dvec2 direction);

/// Plans resets. Allocates nothing in a frame.
class ResetPolicy {
 public:
  virtual ~ResetPolicy() = default;

  /// Called once before the first frame, as Controller::prepare.
  virtual void prepare(const TrackedSpace& /*space*/, const GainLimits& /*limits*/) {}

  /// A reset begins in this frame.
  virtual ResetPlan plan(const SteerInput& input) = 0;

  virtual std::string_view name() const = 0;

  /// As Controller's: what has to be predicted for it.
  virtual bool wantsPrediction() const { return false; }
  virtual bool wantsLikelihoods() const { return false; }
};

using ResetMaker = std::function<std::unique_ptr<ResetPolicy>()>;

/// All names, in a fixed order: new ones are added at the end. The first is the default.
std::span<const std::string_view> resetNames();

/// Fails (kSettingOutOfRange) for an unknown name; the message lists the known ones.
[[nodiscard]] tl::expected<std::unique_ptr<ResetPolicy>, Error> makeReset(std::string_view name);

}  // namespace forewalk::rdw
