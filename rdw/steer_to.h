// Steer-to-center and steer-to-orbit, reactive, as published and as the public toolkits run them.
//
// Razzaque 2005; Hodgson and Bachmann, "Comparing Four Approaches to Generalized Redirected
// Walking", TVCG 2013; constants and rules as in RDWT and OpenRDW. We depart from the toolkits in
// that
// - the smoothing is a time constant that equals their share of 0.125 at 60 Hz, not a share per
// frame;
// - the centre is the pole of inaccessibility, which lies inside the room whatever its shape;
// - the temporary target lies to the side of the centre (RDWT multiplies an angle in degrees as if
// it were
//   a sign);
// - the orbit's targets are defined at the centre itself;
// - what the smoothing asks for is expressed as gains and cut to the limits, so that the remains of
// a fast
//   head turn never become a curvature that somebody notices.
#pragma once

#include <memory>

#include "rdw/controller.h"

namespace forewalk::rdw {

/// The target rules.
enum class SteerRule { kCentre, kOrbit };

/// Constants of the core; the defaults are the toolkits'.
struct SteerToSettings {
  double walkingSpeed = 0.2;                  ///< slower steps bend no path, m/s
  double turningRate = 1.5 * kPi / 180.0;     ///< slower head turns are not scaled, rad/s
  double curvatureRate = 15.0 * kPi / 180.0;  ///< cap of what curvature injects, rad/s
  double rotationRate = 30.0 * kPi / 180.0;   ///< cap of what rotation injects, rad/s
  double smoothing = 0.125;                   ///< share of the new value per frame at 60 Hz, (0, 1]
  double dampedBearing = 45.0 * kPi / 180.0;  ///< smaller bearings are damped, radians
  double dampedDistance = 1.25;               ///< nearer targets are damped, metres
};

/// What the core wants injected in a frame.
struct Steering {
  enum class By { kNothing, kRotation, kCurvature };
  double yaw = 0.0;  ///< of the world about the head, radians, left positive; before any clamping
  By by = By::kNothing;
};

/// The part that all steer-to controllers share: how hard to turn toward a target.
class SteerToCore {
 public:
  explicit SteerToCore(const SteerToSettings& settings = {}) : settings_(settings) {}

  /// Steers somebody at `position` facing unit vector `heading` toward `target`, all physical.
  /// O(1).
  ///
  /// The world turns away from the target, s = -sgn(bearing), so that the walker turns toward it:
  /// by distance * limits.curvatureMax, or by a share of the head's turn (the room above 1 of the
  /// rotation gain where the head turns the way the world shall, the room below 1 where it turns
  /// against it), whichever is more; damped near the target and near the right bearing; smoothed.
  /// Where neither walking nor turning is fast enough nothing is injected and the smoothing waits.
  Steering steer(const Motion& motion, glm::dvec2 position, glm::dvec2 heading, glm::dvec2 target,
                 const GainLimits& limits);

  void restart() { rate_ = 0.0; }

 private:
  SteerToSettings settings_;
  double rate_ = 0.0;  ///< smoothed injection, rad/s
};

/// The gains that make the redirector inject `steering` for this motion, cut to the limits.
Gains asGains(const Steering& steering, const Motion& motion, const GainLimits& limits);

/// Steer-to-center's target: the centre; while it lies behind (bearing of 160 degrees or more) a
/// point 4 m to the side, on the centre's side, fixed in the room when it is chosen.
class CentreTarget {
 public:
  glm::dvec2 target(glm::dvec2 position, glm::dvec2 heading, const TrackedSpace& space);
  void restart() { aside_ = false; }

 private:
  bool aside_ = false;
  glm::dvec2 asideTarget_{0.0};
};

/// Radius of the orbit about the centre: 5 m, a fifth of the shorter side in rooms up to 10 m.
double orbitRadius(const TrackedSpace& space);

/// Steer-to-orbit's two targets: where tangents from `position` touch the orbit, or, inside it, 60
/// degrees further round. The one that is reached leaving the centre on the left comes first (a
/// counter-clockwise orbit). At the centre itself the direction away from it is taken to be
/// -heading.
struct OrbitTargets {
  glm::dvec2 counterClockwise;
  glm::dvec2 clockwise;
};
OrbitTargets orbitTargets(glm::dvec2 position, glm::dvec2 heading, const TrackedSpace& space);

/// Steer-to-orbit's target: of the two the one at the smaller bearing (equal: the counter-clockwise
/// one).
glm::dvec2 orbitTarget(glm::dvec2 position, glm::dvec2 heading, const TrackedSpace& space);

/// The reactive controllers: they steer by where the user looks, as published.
std::unique_ptr<Controller> makeReactive(SteerRule rule, const SteerToSettings& settings = {});

}  // namespace forewalk::rdw
