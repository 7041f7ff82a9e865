#include "rdw/steer_to.h"

#include <algorithm>
#include <cmath>

namespace forewalk::rdw {

namespace {

constexpr double kBehind = 160.0 * kPi / 180.0;  // bearing from which the centre counts as behind
constexpr double kAsideDistance = 4.0;           // metres
constexpr double kOrbitAhead = 60.0 * kPi / 180.0;

double lengthOf(glm::dvec2 v) { return std::sqrt(v.x * v.x + v.y * v.y); }

// The toolkits' sign: nothing is on the left.
double signOf(double x) { return x < 0.0 ? -1.0 : 1.0; }

}  // namespace

Steering SteerToCore::steer(const Motion& motion, glm::dvec2 position, glm::dvec2 heading,
                            glm::dvec2 target, const GainLimits& limits) {
  if (!motion.usable() || motion.dt <= 0.0) return {};
  const double dt = motion.dt;
  const glm::dvec2 way = target - position;
  const double bearing = angleBetween(heading, way);
  const double away = -signOf(bearing);

  double byCurvature = 0.0;
  if (motion.distance / dt > settings_.walkingSpeed) {
    byCurvature = std::min(motion.distance * static_cast<double>(limits.curvatureMax),
                           settings_.curvatureRate * dt);
  }
  double byRotation = 0.0;
  if (std::abs(motion.turn) / dt >= settings_.turningRate) {
    const double share = motion.turn * away < 0.0 ? 1.0 - static_cast<double>(limits.rotationMin)
                                                  : static_cast<double>(limits.rotationMax) - 1.0;
    byRotation = std::min(std::abs(motion.turn) * share, settings_.rotationRate * dt);
  }
  double wanted = std::max(byRotation, byCurvature);
  if (wanted == 0.0) return {};

  if (std::abs(bearing) <= settings_.dampedBearing) {
    wanted *= std::sin(0.5 * kPi * std::abs(bearing) / settings_.dampedBearing);
  }
  if (lengthOf(way) <= settings_.dampedDistance) wanted *= lengthOf(way) / settings_.dampedDistance;

  const double kept = std::pow(1.0 - settings_.smoothing, 60.0 * dt);
  rate_ = kept * rate_ + (1.0 - kept) * away * wanted / dt;
  return {rate_ * dt,
          byRotation > byCurvature ? Steering::By::kRotation : Steering::By::kCurvature};
}

Gains asGains(const Steering& steering, const Motion& motion, const GainLimits& limits) {
  Gains gains;
  if (steering.by == Steering::By::kRotation && motion.turn != 0.0) {
    gains.rotation = static_cast<float>(1.0 + steering.yaw / motion.turn);
  } else if (steering.by == Steering::By::kCurvature && motion.distance > 0.0) {
    gains.curvature = static_cast<float>(-steering.yaw / motion.distance);
  }
  return clamped(gains, limits);
}

glm::dvec2 CentreTarget::target(glm::dvec2 position, glm::dvec2 heading,
                                const TrackedSpace& space) {
  const double bearing = angleBetween(heading, space.centre() - position);
  if (std::abs(bearing) < kBehind) {
    aside_ = false;
    return space.centre();
  }
  if (!aside_) {
    aside_ = true;
    asideTarget_ = position + kAsideDistance * rotated(heading, signOf(bearing) * 0.5 * kPi);
  }
  return asideTarget_;
}

double orbitRadius(const TrackedSpace& space) {
  return space.shorterSide() <= 10.0 ? 0.2 * space.shorterSide() : 5.0;
}

OrbitTargets orbitTargets(glm::dvec2 position, glm::dvec2 heading, const TrackedSpace& space) {
  const double radius = orbitRadius(space);
  const glm::dvec2 out = position - space.centre();
  const double distance = lengthOf(out);
  const glm::dvec2 away = distance > 1e-9 ? out / distance : -heading;
  const double ahead = distance < radius ? kOrbitAhead : std::acos(radius / distance);
  return {space.centre() + radius * rotated(away, ahead),
          space.centre() + radius * rotated(away, -ahead)};
}

glm::dvec2 orbitTarget(glm::dvec2 position, glm::dvec2 heading, const TrackedSpace& space) {
  const OrbitTargets targets = orbitTargets(position, heading, space);
  const double counterClockwise =
      std::abs(angleBetween(heading, targets.counterClockwise - position));
  const double clockwise = std::abs(angleBetween(heading, targets.clockwise - position));
  return clockwise < counterClockwise ? targets.clockwise : targets.counterClockwise;
}

}  // namespace forewalk::rdw
