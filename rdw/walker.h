// Who walks: simulated users, and recorded ones walked again.
//
// A walker lives in two spaces. It sees the virtual one and plans there; its body moves in the
// physical one. Every frame it looks where it is virtually, and steps and turns physically so as to
// keep to its virtual path: that is how a curvature gain bends the body's way while the walk seems
// straight. The body faces where it walks; the head looks around on top of that.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <memory>
#include <optional>
#include <tl/expected.hpp>
#include <variant>
#include <vector>

#include "navmesh/error.h"
#include "navmesh/world.h"
#include "rdw/course.h"
#include "rdw/pose.h"
#include "rdw/session.h"
#include "rdw/walk_file.h"

namespace forewalk::rdw {

/// How a body moves and a head is carried. Defaults are the simulated user of the published
/// toolkits, who looks straight ahead, but with a person's time to react and to stop.
struct WalkerSettings {
  double speed = 1.0;            ///< physical, m/s, (0, 5]
  double turnRate = 0.5 * kPi;   ///< physical, on the spot and while walking, rad/s, (0, 4 pi]
  double stopAngle = kPi / 6.0;  ///< corners sharper than this are turned on the spot, rad, (0, pi]
  double reactionTime = 0.25;    ///< walked on after a reset begins, seconds, [0, 2]
  double acceleration = 2.0;     ///< of setting off, m/s^2, [0.1, 1e9]; stops of its own are sudden
  double deceleration = 3.0;     ///< of stopping for a reset, m/s^2, [0.1, 1e9]
  double pauseMin = 0.0;         ///< at each goal a pause drawn from [pauseMin, pauseMax], seconds,
  double pauseMax = 0.0;         ///< 0 <= pauseMin <= pauseMax <= 600
  double lookAmplitude = 0.0;    ///< the head's largest yaw away from the body, rad, [0, pi/2]
  double lookPeriod = 4.0;       ///< of the slower of its two swings, seconds, [0.5, 60]
  double bob = 0.0;           ///< amplitude of the head's rise and fall in every step, m, [0, 0.2]
  double sway = 0.0;          ///< amplitude of its way to either side in two steps, m, [0, 0.2]
  double eyeHeight = 1.65;    ///< above the physical floor, metres, [0.2, 3]
  double cornerMargin = 0.2;  ///< kept from corners where there is room, m, [0, 2]
};

/// Walks to each point in turn. Where there is a navmesh, a point that is not in sight is reached
/// by the shortest way over it; otherwise straight.
struct Waypoints {
  std::vector<glm::vec3> points;  ///< virtual floor, world axes, metres
  bool loop = false;              ///< after the last, on to the first again, for ever
};

/// Walks for ever between random goals on the navmesh: polygons of the start's component drawn by
/// area, a uniform point in each.
struct Wander {
  double goalDistanceMin =
      3.0;  ///< goals nearer than this, as the crow flies, are drawn again, metres
};

/// Walks for ever in straight legs on an open plane, for comparison with published simulations.
struct Legs {
  double lengthMin = 2.0;   ///< metres, > 0
  double lengthMax = 8.0;   ///< metres, >= lengthMin
  double turn = 0.5 * kPi;  ///< between legs, rad, [0, pi]
  bool eitherSide = true;   ///< true: exactly +turn or -turn; false: uniform in [-turn, turn]
};

/// Walks a recording again: same virtual way, same speeds. The recording waits while a reset is
/// under way; the body stops at once, so no violation comes from stopping late.
struct Recorded {
  Walk walk;
};

/// Who walks.
struct User {
  WalkerSettings walker;
  std::variant<Waypoints, Wander, Legs, Recorded, Course> plan = Wander{};
};

/// Where a walk begins. What is not given follows from the plan: the first waypoint; a random place
/// in the largest component; the origin; the recording's first sample. The heading: along the first
/// step.
struct WalkStart {
  std::optional<glm::vec3> floor;      ///< virtual, world axes, metres
  std::optional<double> heading;       ///< virtual, radians
  std::optional<PlanarPose> physical;  ///< body in the room; else at the space's centre, facing -Z
};

class Walker {
 public:
  virtual ~Walker() = default;

  /// Moves the body by one frame of `dt` seconds, having seen `frame` under the map `redirection`.
  virtual void advance(double dt, const FrameResult& frame, const Redirection& redirection) = 0;

  /// How the next frames are to be walked so as to make way for others, virtual m/s on the plan;
  /// none: as planned. Recordings are walked as they were.
  void makeWay(std::optional<glm::dvec2> velocity) { makingWay_ = velocity; }

  /// Goes, from now on, around what is closed or costs more in these states of the world, where
  /// there is a way around. Null: all is open. Recordings are walked as they were.
  virtual void avoidBlocked(std::shared_ptr<const navmesh::PolygonStates> states) { (void)states; }

  /// The point walked straight to now, virtual plan; none where there is no plan of points.
  virtual std::optional<glm::dvec2> target() const { return std::nullopt; }

  const PlanarPose& body() const { return body_; }      ///< physical; heading is that of travel
  const VirtualStart& start() const { return start_; }  ///< where the session is to begin
  HeadPose head() const;                       ///< physical, tracked: what the session is given
  bool finished() const { return finished_; }  ///< nothing left to walk

  /// Share of the plan that is behind, [0, 1]; 0 where the plan has no end or no measure.
  virtual double progress() const { return 0.0; }

  /// Whether the walker stood of its own accord in the last frame (a pause, a stop in a recording).
  bool standing() const { return standing_; }

 protected:
  Walker(const WalkerSettings& settings, const PlanarPose& physical, std::uint64_t seed);
  void lookAround(double dt);      // moves the head's yaw on
  void step(glm::dvec2 physical);  // moves the body, and the head's bob with it

  WalkerSettings settings_;
  PlanarPose body_;
  VirtualStart start_;
  bool finished_ = false;
  bool standing_ = false;
  std::optional<glm::dvec2> makingWay_;

 private:
  double walked_ = 0.0;   // metres, physical; the phase of bob and sway
  double looking_ = 0.0;  // seconds, the phase of looking around
  double phase_[2];       // of the two swings
};

/// Makes the walker of `user`. `world` may be null: then everybody walks on an open plane, and
/// nobody can wander. `rate` is the frame rate, 1/s; `seed` settles everything random.
///
/// Fails (kSettingOutOfRange) when a setting is outside its range, named with value and unit, when
/// there is nothing to walk to, or when wandering without a navmesh; kPositionOffNavMesh when start
/// or waypoint lies more than `snap` beside the navmesh, or a waypoint in another component than
/// the start.
[[nodiscard]] tl::expected<std::unique_ptr<Walker>, Error> makeWalker(
    std::shared_ptr<const navmesh::World> world, const User& user, const WalkStart& start,
    const navmesh::SnapLimits& snap, glm::dvec2 spaceCentre, double rate, std::uint64_t seed);

}  // namespace forewalk::rdw
