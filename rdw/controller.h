// What picks the gains: one interface for every controller.
//
// rdw/controllers/README.md says what each of them does, whose it is, and how to add one.
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <string_view>
#include <tl/expected.hpp>

#include "navmesh/error.h"
#include "navmesh/world.h"
#include "prediction/prediction_graph.h"
#include "rdw/gains.h"
#include "rdw/motion.h"
#include "rdw/other_user.h"
#include "rdw/redirector.h"
#include "rdw/tracked_space.h"
#include "rdw/ways_ahead.h"

namespace forewalk::rdw {

/// What "heading" means to controllers: where the steering thinks that the user is headed. Gains
/// act on the head's turns whatever it is.
enum class HeadingSource : std::uint8_t {
  kHead,     ///< where the head looks; as the toolkits do it
  kChest,    ///< as told by Session::setChest; the head where nothing was told
  kWalking,  ///< the direction of travel while walking, else where the head looks
};

/// A thing that can be touched: it stands in the room and in the virtual world. Plan, metres.
struct HapticTarget {
  glm::dvec2 physical{0.0};
  glm::dvec2 virtualPlan{0.0};
};

/// All that a controller may look at in one frame. References live for the call.
struct SteerInput {
  const Motion& motion;           ///< physical
  const PlanarPose& physical;     ///< body in the room; where it is headed, by HeadingSource
  const PlanarPose& virtualPose;  ///< the same under `redirection`
  const TrackedSpace& space;
  const GainLimits& limits;
  const Redirection& redirection;            ///< physical to virtual, before this frame's gains
  const prediction::PredictionGraph* graph;  ///< this frame's; null where none was predicted
  WayLikelihoods likelihoods = {};           ///< of its ways; empty unless wantsLikelihoods()
  std::span<const OtherUser> others = {};    ///< in the same room
  const navmesh::World* world = nullptr;     ///< what is walked virtually; null: an endless plane
  navmesh::Location place = {};              ///< the user's feet in `world`; kNoPolygon: unknown
  const HapticTarget* haptic = nullptr;      ///< a thing to reach in both spaces; null: none
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

/// Makes a controller: what a name stands for.
using ControllerMaker = std::function<std::unique_ptr<Controller>()>;

/// All names, in a fixed order: new ones are added at the end.
std::span<const std::string_view> controllerNames();

/// Fails (kSettingOutOfRange) for an unknown name; the message lists the known ones.
[[nodiscard]] tl::expected<std::unique_ptr<Controller>, Error> makeController(
    std::string_view name);

}  // namespace forewalk::rdw
