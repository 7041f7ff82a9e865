// One XrSession whose user is redirected: follows the head, walks a forewalk session, and says how
// the runtime's answers become the application's.
#pragma once

#include <openxr/openxr.h>

#include <array>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "rdw/session.h"
#include "service/openxr/config.h"
#include "service/openxr/next.h"
#include "service/openxr/world_maps.h"

namespace forewalk::openxr {

/// A space of the application, as far as redirection minds.
struct AppSpace {
  XrSpace handle = XR_NULL_HANDLE;
  Kind kind = Kind::kBody;
  std::optional<Rigid> inTracking;  ///< its pose in the tracking space where that never changes
};

/// How a pose of one space in another is put right: before * pose * after. At most one of the two
/// is anything but the identity.
struct Correction {
  Rigid before, after;
  bool turnsBase = false;  ///< `after` counts: a fixed space, located in one that moves
};

class RedirectedSession {
 public:
  /// Makes the spaces that it follows the user with. Null where the runtime refuses them; a log
  /// line says so. `next` and `config` have to outlive it.
  static std::unique_ptr<RedirectedSession> make(const Next& next, const LayerConfig& config,
                                                 XrSession session);
  ~RedirectedSession();

  /// When the application begins its session: makes the walk, the first time. Takes up to 0.15 s.
  /// Where it cannot be made, a log line says why, and all poses stay as they are.
  void begin();

  /// A frame that will be displayed at `time`: one frame of the walk.
  void frame(XrTime time);

  /// The runtime has announced that one of its reference spaces moves; `event` becomes what that
  /// is in the application's world.
  void noteChange(XrEventDataReferenceSpaceChangePending& event);

  /// What a space of the application is, from how it was made.
  AppSpace describe(XrSpace handle, const XrReferenceSpaceCreateInfo& info) const;

  /// A space of the application is gone.
  void forget(XrSpace space);

  /// For `of` located in `base` at `time`; none where the runtime's answer stays as it is.
  std::optional<Correction> correction(const AppSpace& of, const AppSpace& base, XrTime time) const;
  /// For a body located in `base`.
  std::optional<Rigid> bodyCorrection(const AppSpace& base, XrTime time) const;

  /// Whether the frame displayed at `time` should tell the user that there is a turn to make.
  bool signals(XrTime time) const;

  /// Whether poses are, or will be, others than the runtime's.
  bool redirects() const;

  const Next& next() const { return next_; }
  const LayerConfig& config() const { return config_; }

 private:
  struct Change {
    Kind kind;
    XrTime time;
    std::optional<Rigid> move;  // the new origin in the old space
  };

  RedirectedSession(const Next& next, const LayerConfig& config, XrSession session)
      : next_(next), config_(config), xrSession_(session) {}
  bool makeSpaces();
  XrSpace makeSpace(XrReferenceSpaceType type, const Rigid& pose) const;
  std::optional<rdw::TrackedSpace> room() const;
  std::optional<XrPosef> locatedPose(XrSpace space, XrTime time) const;
  std::optional<Rigid> located(XrSpace space, XrTime time) const;
  std::optional<Rigid> inTracking(const AppSpace& space, XrTime time) const;
  std::optional<Rigid> originInTracking(XrTime time) const;
  std::optional<glm::dvec3> teleport(const Rigid& toScene, const Rigid& head);
  bool placeAtFirst(const Rigid& head, XrTime time);
  void applyChanges(const Rigid& head, XrTime time);
  void moveOrigin(const Rigid& head, XrTime time);
  void publish(XrTime time);
  void tell(const rdw::FrameResult& result);
  void giveUp(const std::string& why);

  const Next& next_;
  const LayerConfig& config_;
  const XrSession xrSession_;

  // Spaces at the runtime.
  XrSpace view_ = XR_NULL_HANDLE, local_ = XR_NULL_HANDLE, tracking_ = XR_NULL_HANDLE;
  Kind trackingKind_ = Kind::kStage;  // what the tracking space is made from
  Rigid tracking0_;                   // its pose in that

  mutable std::mutex stepMutex_;           // guards all down to the next comment
  std::unique_ptr<rdw::Session> session_;  // null: not begun, or given up
  bool begun_ = false;                     // begin() was called
  bool placed_ = false;                    // a first frame was walked
  XrTime firstTime_ = 0;
  Rigid scene_;                              // the application's world to the scene
  Rigid moved_;                              // tracking space now to what it was at first
  std::array<Rigid, kKinds> fixed_;          // tracking space at first to the application's world
  std::vector<Change> changes_;              // still to come
  bool inReset_ = false, offFloor_ = false;  // told already

  WorldMapHistory history_;

  mutable std::mutex lastMutex_;  // guards last_
  struct LastPlace {
    XrSpace space;
    Rigid pose;
  };
  mutable std::vector<LastPlace> last_;  // where spaces were when they could last be located
};

}  // namespace forewalk::openxr
