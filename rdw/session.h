// One user's walk: what a VR runtime calls once per frame.
//
// Pose in, virtual pose and everything about it out. A session owns all that outlives a frame; the
// world is shared. Sessions may run on any threads, one thread at a time each. No clock, no lock,
// no allocation in a frame after the first few (buffers of the prediction graph grow to what the
// world needs).
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <tl/expected.hpp>

#include "navmesh/polygon_states.h"
#include "navmesh/world.h"
#include "prediction/front_graph.h"
#include "prediction/likelihood.h"
#include "prediction/predict.h"
#include "rdw/controller.h"
#include "rdw/gains.h"
#include "rdw/motion.h"
#include "rdw/redirector.h"
#include "rdw/reset.h"
#include "rdw/reset_policy.h"
#include "rdw/steering_hold.h"
#include "rdw/tracked_space.h"

namespace forewalk::rdw {

/// Where the user stands in the virtual world when the walk begins.
struct VirtualStart {
  glm::vec3 floor{0.0f};  ///< a point on the walkable floor (feet, not head), world axes, metres
  float heading = 0.0f;   ///< where the user's first look goes, radians
};

struct SessionSettings {
  TrackedSpace space;
  GainLimits limits;
  std::string controller = "s2c-predictive";  ///< of controllerNames()
  ControllerMaker makeController;  ///< one of your own, instead; empty: `controller` counts
  float horizon = 10.0f;           ///< of prediction, metres along the virtual path, (0, 1000]

  /// Predict in every frame, even where the controller does not ask (to draw it, to compare costs).
  bool alwaysPredict = true;

  /// The world is an open plane without ways: nothing is predicted, whoever asks.
  bool openPlane = false;

  /// How the graph is made (prediction_graph.h), and what graphs by fronts take for a way.
  prediction::Method method = prediction::Method::kPolygon;
  prediction::FrontSettings front;

  /// Which way people take, for controllers that want to know; with `alwaysLikely` in every frame
  /// that has a graph, even where the controller does not ask (to draw it, to judge it).
  prediction::LikelihoodParameters likelihood;
  bool alwaysLikely = false;

  /// For graphs by fronts: the world's index, where it has been made for another session already.
  /// None: the session makes its own.
  std::shared_ptr<const prediction::FrontIndex> frontIndex;

  /// What is closed in the world, and what costs more: graphs by polygons lead nobody there. None:
  /// all is open. Others later with Session::setStates.
  std::shared_ptr<const navmesh::PolygonStates> states;

  /// Where the first frame's head is put, looking along `heading`. None: virtual space is physical
  /// space at first, and the floor is looked for under the head.
  std::optional<VirtualStart> start;

  /// How far a user may be beside the navmesh or over its edge and still be on it. Seen from the
  /// feet.
  navmesh::SnapLimits snap{0.5f, 1.3f, 1.3f};

  prediction::PredictionLimits prediction;
  MotionSettings motion;
  HeadingSource heading = HeadingSource::kHead;

  /// The side of steering changes at most this often, seconds, >= 0 (steering_hold.h). 0: as often
  /// as the controller likes, as in the toolkits; to compare with published simulations.
  double sideHold = SteeringHold::kSeconds;

  /// A thing that is to be reached in both spaces at once (controller `haptics`).
  std::optional<HapticTarget> haptic;

  ResetSettings reset;
  std::string resetPolicy = "two-one-turn";  ///< of resetNames()
  ResetMaker makeReset;  ///< one of your own, instead; empty: `resetPolicy` counts
  bool resets = true;    ///< false: nobody is ever stopped (for looking at controllers alone)
};

/// Another world to walk in, with all that a session needs to do so: made off the frame, so that
/// the frame only exchanges it (Session::enter).
struct PreparedWorld {
  std::shared_ptr<const navmesh::World> world;
  std::unique_ptr<prediction::Scratch> scratch;              ///< by polygons, else null
  std::shared_ptr<const prediction::FrontIndex> frontIndex;  ///< by fronts, else null
  std::unique_ptr<prediction::FrontScratch> frontScratch;    ///< by fronts, else null
  std::shared_ptr<const navmesh::PolygonStates> states;      ///< of this world; null: all is open
};

/// What graphs by fronts need to know of `world` in these states (null: all is open), to be shared
/// by its sessions. O(polygons log polygons), some 0.5 ms for 1,000.
std::shared_ptr<const prediction::FrontIndex> makeFrontIndex(
    const navmesh::World& world, const navmesh::PolygonStates* states = nullptr);

/// Allocates all that frames in `world` will need. `limits` and `method` are those of the session's
/// settings; `frontIndex` is this world's in these states, made here where it is null and needed.
/// O(polygons of the world), some 0.1 ms for 1,000.
PreparedWorld prepareWorld(std::shared_ptr<const navmesh::World> world,
                           const prediction::PredictionLimits& limits = {},
                           prediction::Method method = prediction::Method::kPolygon,
                           std::shared_ptr<const prediction::FrontIndex> frontIndex = nullptr,
                           std::shared_ptr<const navmesh::PolygonStates> states = nullptr);

/// One frame's answer. Valid until the session's next frame.
struct FrameResult {
  HeadPose virtualPose;                 ///< world axes; what to render from
  PlanarPose physical;                  ///< the body in the room
  PlanarPose virtualPlan;               ///< virtualPose on the plan, in doubles
  Motion motion;                        ///< physical
  Gains gains;                          ///< as applied; in a reset: its rotation, the rest neutral
  double injectedYaw = 0.0;             ///< radians by which the world was turned about the head
  glm::dvec2 injectedTranslation{0.0};  ///< metres by which the user was pushed, virtual plan
  ResetState reset;
  std::uint64_t resetCount = 0;  ///< begun so far
  bool resetBegan = false;
  std::uint32_t flags = kFrameSound;  ///< of FrameFlags
  navmesh::Location location;  ///< the user's feet on the navmesh; kNoPolygon until first found
  const prediction::PredictionGraph* graph = nullptr;  ///< this frame's; null where none was made
  WayLikelihoods likelihoods;  ///< of its ways; empty where the controller does not want them
};

/// What a session knows that its settings and its world do not: small, so that it can travel, and
/// another session, in another process, go on from it. A controller's memory stays behind: its
/// gains begin from neutral again.
struct SessionState {
  Redirection redirection;
  HeadPose physical;           ///< the last sound one
  navmesh::Location location;  ///< of the user's feet; kNoPolygon until first found
  MotionTracker::Memory motion;
  Reset::Memory reset;
};

class Session {
 public:
  /// Fails (kSettingOutOfRange, kPositionOffNavMesh) when a setting cannot work: an unknown
  /// controller or reset, limits out of range, a horizon outside (0, 1000] m, a persistence outside
  /// [0, 100] m, or a start more than snap.distance beside the navmesh.
  static tl::expected<Session, Error> make(std::shared_ptr<const navmesh::World> world,
                                           SessionSettings settings);

  Session(Session&&) noexcept;
  Session& operator=(Session&&) noexcept;
  ~Session();

  /// One frame: the tracked head (physical space, y = 0 is the floor) at a time in seconds.
  /// Whatever is passed, the session stays usable; see FrameFlags.
  ///
  /// Order: motion; virtual pose under the map so far; place on the navmesh; prediction; reset
  /// check; gains; their application about the head. The virtual head is as high above the virtual
  /// floor as the physical head above y = 0: on virtual stairs the user rises with the surface.
  const FrameResult& frame(const HeadPose& physical, double seconds) {
    locate(physical, seconds);
    predict();
    steer();
    return result_;
  }

  /// The same in three steps, for callers who time them: call all three, in this order, every
  /// frame.
  void locate(const HeadPose& physical, double seconds);
  /// A graph is a function of the place: where the feet are where they were (on the spot, in a
  /// reset's turn) predict() keeps the last one.
  void predict();
  const FrameResult& steer();

  const FrameResult& result() const { return result_; }
  const Redirection& redirection() const { return redirector_.redirection(); }
  const SessionSettings& settings() const { return settings_; }
  const navmesh::World& world() const { return *world_; }
  const std::shared_ptr<const navmesh::World>& sharedWorld() const { return world_; }
  /// What works out result().likelihoods, with the names of the ways; null where nobody wants them.
  const prediction::WayLikelihood* likelihood() const { return likelihood_.get(); }
  const Controller& controller() const { return *controller_; }
  const ResetPolicy& resetPolicy() const { return *policy_; }

  /// Who else is in the room, as kept by setOthers.
  std::span<const OtherUser> others() const { return others_; }

  /// Who else is in the room from the next frame on, until told otherwise (other_user.h). Of more
  /// than kMostOthers the nearest to the user are kept; positions that are not finite are left out.
  /// Allocates nothing.
  void setOthers(std::span<const OtherUser> others);

  /// Where the user's chest points from the next frame on, physical radians; not a number: unknown.
  void setChest(double heading) { chest_ = heading; }

  /// Where the user's eyes look from the next frame on, physical radians: evidence for the
  /// likelihoods. Not a number: unknown.
  void setGaze(double heading) { gaze_ = heading; }

  /// Puts the user's next frame at another virtual place, looking along its heading (a teleport, a
  /// lift). False, and nothing changes, where it is off the navmesh.
  bool teleport(const VirtualStart& to);

  /// Between frames, after the first one.
  SessionState state() const;

  /// Goes on where another session was, of the same world and settings: the next frame's virtual
  /// pose is that of the same map, so nothing jumps for the user, and a reset under way is
  /// finished. Without a controller all frames to come are the other session's to the bit; with one
  /// they are those of every session that resumes there, this one itself included. False,
  /// and nothing changes, where a number is not finite or beyond what frames lead to (1e7 m, 7
  /// radians), or the floor is off the navmesh.
  [[nodiscard]] bool resume(const SessionState& state);

  /// Goes on in another world, where the user stays at the same place of virtual space: for worlds
  /// that move (an obstacle came, a door closed). Between frames; `next` was prepared for the
  /// session's method. Afterwards `next` holds what the
  /// session has left, for its owner to let go of off the frame; the last FrameResult's graph is
  /// gone.
  ///
  /// Whose ground is no longer there is located on the nearest walkable ground of that height,
  /// however far (64 m), and frames say so (kGroundTaken) until the user is on the navmesh again;
  /// where there is none at all, kOffNavMesh. Neither locks nor allocates; costs one location.
  void enter(PreparedWorld& next);

  /// Predicts from now on with other states of the world the session is in; null: all is open. Not
  /// by fronts: their index knows the states, so enter() the world again, prepared with them.
  /// Between frames. Afterwards `next` holds those left, for its owner to let go of off the frame.
  void setStates(std::shared_ptr<const navmesh::PolygonStates>& next);

 private:
  Session(std::shared_ptr<const navmesh::World> world, SessionSettings settings,
          std::unique_ptr<Controller> controller, std::unique_ptr<ResetPolicy> policy);
  void placeOnFloor();
  double heading() const;
  std::optional<navmesh::Location> nearestGround(glm::vec3 feet) const;

  std::shared_ptr<const navmesh::World> world_;
  SessionSettings settings_;  // without frontIndex and states: they are tied to the world
  std::unique_ptr<Controller> controller_;
  std::unique_ptr<ResetPolicy> policy_;
  std::unique_ptr<prediction::Scratch> scratch_;  // by polygons, else null
  std::shared_ptr<const prediction::FrontIndex> frontIndex_;
  std::unique_ptr<prediction::FrontScratch> frontScratch_;  // by fronts, else null
  std::shared_ptr<const navmesh::PolygonStates> states_;    // null: all is open
  std::unique_ptr<prediction::WayLikelihood> likelihood_;   // null: not wanted
  MotionTracker tracker_;
  Redirector redirector_;
  Reset reset_;
  SteeringHold hold_;
  double resetGain_ = 2.0;  // of the reset under way
  std::vector<OtherUser> others_;
  double chest_, gaze_;                // NaN: unknown
  HeadPose physical_;                  ///< the last sound one
  std::optional<PlanarPose> pending_;  ///< virtual pose that the next frame's head is put at
  navmesh::Location location_;
  const prediction::PredictionGraph* graph_ = nullptr;  ///< the last one made; null: none in force
  navmesh::Location graphSource_;                       ///< where it was made from
  bool groundTaken_ = false;                            ///< since a change of the world
  FrameResult result_;
};

}  // namespace forewalk::rdw
