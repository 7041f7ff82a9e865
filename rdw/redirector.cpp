#include "rdw/redirector.h"

#include <cmath>

namespace forewalk::rdw {

namespace {

glm::quat yawed(const glm::quat& orientation, double yaw) {
  const glm::dquat turn(std::cos(0.5 * yaw), 0.0, std::sin(0.5 * yaw), 0.0);
  return glm::quat(turn * glm::dquat(orientation));
}

}  // namespace

glm::dvec2 Redirection::toVirtual(glm::dvec2 physical) const {
  return rotated(physical, yaw) + offset;
}

glm::dvec2 Redirection::toPhysical(glm::dvec2 virtualPoint) const {
  return rotated(virtualPoint - offset, -yaw);
}

PlanarPose Redirection::toVirtual(const PlanarPose& physical) const {
  return {toVirtual(physical.position), wrapAngle(physical.heading + yaw)};
}

PlanarPose Redirection::toPhysical(const PlanarPose& virtualPose) const {
  return {toPhysical(virtualPose.position), wrapAngle(virtualPose.heading - yaw)};
}

HeadPose Redirection::toVirtual(const HeadPose& physical) const {
  if (*this == Redirection{}) return physical;
  const glm::dvec2 plan = toVirtual(glm::dvec2(navmesh::toPlan(physical.position)));
  return {navmesh::toSpace(glm::vec2(plan), static_cast<float>(physical.position.y + height)),
          yaw == 0.0 ? physical.orientation : yawed(physical.orientation, yaw)};
}

HeadPose Redirection::toPhysical(const HeadPose& virtualPose) const {
  if (*this == Redirection{}) return virtualPose;
  const glm::dvec2 plan = toPhysical(glm::dvec2(navmesh::toPlan(virtualPose.position)));
  return {navmesh::toSpace(glm::vec2(plan), static_cast<float>(virtualPose.position.y - height)),
          yaw == 0.0 ? virtualPose.orientation : yawed(virtualPose.orientation, -yaw)};
}

Redirection alignment(const PlanarPose& physical, const PlanarPose& virtualPose, double height) {
  const double yaw = wrapAngle(virtualPose.heading - physical.heading);
  return {yaw, virtualPose.position - rotated(physical.position, yaw), height};
}

Applied Redirector::frame(const Motion& motion, const HeadPose& head, const Gains& gains) {
  if (!motion.usable()) return inject(head, 0.0, glm::dvec2(0.0));
  double yaw = 0.0;
  glm::dvec2 push(0.0);
  const double bent = static_cast<double>(gains.curvature) * motion.distance;
  if (gains.rotation != 1.0f) yaw += (static_cast<double>(gains.rotation) - 1.0) * motion.turn;
  if (gains.curvature != 0.0f) yaw -= bent;
  if (gains.bending != 1.0f)
    yaw += (1.0 / static_cast<double>(gains.bending) - 1.0) * (motion.travelTurn - bent);
  if (gains.translation != 1.0f) {
    push = (static_cast<double>(gains.translation) - 1.0) *
           redirection_.directionToVirtual(motion.step);
  }
  return inject(head, yaw, push);
}

Applied Redirector::turnWorld(const HeadPose& head, double yaw) {
  return inject(head, yaw, glm::dvec2(0.0));
}

Applied Redirector::freezeWorld(const HeadPose& head, double yaw, glm::dvec2 step) {
  return inject(head, yaw, -redirection_.directionToVirtual(step));
}

Applied Redirector::inject(const HeadPose& head, double yaw, glm::dvec2 push) {
  if (yaw != 0.0 || push != glm::dvec2(0.0)) {
    const glm::dvec2 physical(navmesh::toPlan(head.position));
    const glm::dvec2 kept = redirection_.toVirtual(physical) + push;
    redirection_.yaw = wrapAngle(redirection_.yaw + yaw);
    redirection_.offset = kept - rotated(physical, redirection_.yaw);
  }
  return {redirection_.toVirtual(head), yaw, push};
}

}  // namespace forewalk::rdw
