// What picks the gains: one interface, five controllers.
#pragma once

#include <memory>
#include <span>
#include <string_view>
#include <tl/expected.hpp>

#include "navmesh/error.h"
#include "prediction/prediction_graph.h"
#include "rdw/gains.h"
#include "rdw/motion.h"
#include "rdw/redirector.h"
#include "rdw/tracked_space.h"
#include "rdw/ways_ahead.h"

namespace forewalk::rdw {

/// All that a controller may look at in one frame. References live for the call.
struct SteerInput {
  const Motion& motion;           ///< physical
  const PlanarPose& physical;     ///< body in the room; heading is that of the head
  const PlanarPose& virtualPose;  ///< the same under `redirection`
  const TrackedSpace& space;
  const GainLimits& limits;
  const Redirection& redirection;            ///< physical to virtual, before this frame's gains
  const prediction::PredictionGraph* graph;  ///< this frame's; null where none was predicted
  WayLikelihoods likelihoods = {};           ///< of its ways; empty unless wantsLikelihoods()
};

/// Picks gains, frame by frame. Keeps its own memory, allocates nothing in a frame.
class Controller {
 public:
  virtual ~Controller() = default;

  /// Called once, before the first frame, with what every frame will be steered in: the place for
  /// work that takes longer than a frame, or allocates. May take some tenths of a second.
  virtual void prepare(const TrackedSpace& /*space*/, const GainLimits& /*limits*/) {}

  /// Gains within `input.limits` for the motion of this frame. Not called in a frame without usable
  /// motion and not during a reset.
  virtual Gains steer(const SteerInput& input) = 0;

  /// Forgets everything: after a reset, lost tracking or a teleport.
  virtual void restart() = 0;

  virtual std::string_view name() const = 0;

  /// Whether it reads the graph; where not, nobody needs to predict.
  virtual bool wantsPrediction() const = 0;

  /// Whether it reads how likely the graph's ways are. Only with wantsPrediction().
  virtual bool wantsLikelihoods() const { return false; }

  /// Whether it steers where there is no graph to read, as on an open plane.
  virtual bool steersWithoutGraph() const { return !wantsPrediction(); }
};

/// none, s2c, s2o, s2c-predictive, s2o-predictive, foresight, mpcred, force, in this order.
std::span<const std::string_view> controllerNames();

/// Fails (kSettingOutOfRange) for an unknown name; the message lists the known ones.
[[nodiscard]] tl::expected<std::unique_ptr<Controller>, Error> makeController(
    std::string_view name);

}  // namespace forewalk::rdw
