#include "rdw/pose.h"

#include <cmath>

namespace forewalk::rdw {

namespace {

constexpr double kFurthestPosition =
    1e6;  // metres; beyond it floats are no longer good to a decimetre

bool finite(const glm::vec3& p) {
  return std::abs(p.x) <= kFurthestPosition && std::abs(p.y) <= kFurthestPosition &&
         std::abs(p.z) <= kFurthestPosition;  // false for NaN too
}

double smoothStep(double low, double high, double x) {
  const double t = std::fmin(std::fmax((x - low) / (high - low), 0.0), 1.0);
  return t * t * (3.0 - 2.0 * t);
}

}  // namespace

double wrapAngle(double radians) {
  const double wrapped = std::remainder(radians, 2.0 * kPi);
  return wrapped <= -kPi ? wrapped + 2.0 * kPi : wrapped;
}

glm::dvec2 directionOf(double heading) { return {-std::sin(heading), std::cos(heading)}; }

double headingOf(glm::dvec2 direction) {
  return direction == glm::dvec2(0.0) ? 0.0 : std::atan2(-direction.x, direction.y);
}

double headingOf(glm::vec3 direction) {
  const glm::dvec2 plan(navmesh::toPlan(direction));
  return std::isfinite(glm::dot(plan, plan)) && glm::dot(plan, plan) > 0.0
             ? headingOf(plan)
             : std::numeric_limits<double>::quiet_NaN();
}

glm::dvec2 rotated(glm::dvec2 v, double radians) {
  const double c = std::cos(radians);
  const double s = std::sin(radians);
  return {c * v.x - s * v.y, s * v.x + c * v.y};
}

double angleBetween(glm::dvec2 from, glm::dvec2 to) {
  const double cross = from.x * to.y - from.y * to.x;
  const double dot = from.x * to.x + from.y * to.y;
  return cross == 0.0 && dot == 0.0 ? 0.0 : std::atan2(cross, dot);
}

double headingOf(const glm::quat& orientation) {
  const glm::dquat q(orientation);
  const glm::dvec3 forward = q * glm::dvec3(0.0, 0.0, -1.0);
  const glm::dvec3 up = q * glm::dvec3(0.0, 1.0, 0.0);
  const glm::dvec2 forwardPlan(forward.x, -forward.z);
  const glm::dvec2 upPlan(up.x, -up.z);
  // cos(26 degrees) = 0.9: outside that cone the forward axis decides alone.
  const double share = smoothStep(0.9, 1.0, std::abs(forward.y));
  return headingOf((1.0 - share) * forwardPlan - share * forward.y * upPlan);
}

PlanarPose planarPose(const HeadPose& head) {
  return {glm::dvec2(navmesh::toPlan(head.position)), headingOf(head.orientation)};
}

HeadPose cleaned(const HeadPose& pose, const HeadPose& fallback, std::uint32_t& flags) {
  HeadPose sound = pose;
  if (!finite(pose.position)) {
    sound.position = fallback.position;
    flags |= kPoseNotFinite;
  }
  const glm::dquat q(pose.orientation);
  const double length = std::sqrt(q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z);
  if (!(length >= 1e-6 && length <= 1e30)) {
    sound.orientation = fallback.orientation;
    flags |= kOrientationUnusable;
  } else if (std::abs(length - 1.0) > 1e-3) {
    sound.orientation =
        glm::quat(glm::dquat(q.w / length, q.x / length, q.y / length, q.z / length));
    flags |= kOrientationNotUnit;
  }
  return sound;
}

}  // namespace forewalk::rdw
