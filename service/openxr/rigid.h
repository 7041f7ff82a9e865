// A turn and a move in space, in doubles: poses, and maps between spaces.
#pragma once

#include <openxr/openxr.h>

#include <cmath>
#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>

#include "navmesh/plan.h"
#include "rdw/redirector.h"

namespace forewalk::openxr {

/// Takes a point p to turn * p + move. Metres; world axes, as OpenXR's are.
struct Rigid {
  glm::dquat turn{1.0, 0.0, 0.0, 0.0};  ///< w, x, y, z; unit
  glm::dvec3 move{0.0};

  bool operator==(const Rigid&) const = default;
};

/// First `b`, then `a`; or the pose `b`, given in the space whose pose is `a`.
inline Rigid operator*(const Rigid& a, const Rigid& b) {
  return {a.turn * b.turn, a.turn * b.move + a.move};
}

inline Rigid inverse(const Rigid& map) {
  const glm::dquat back = glm::conjugate(map.turn);
  return {back, back * -map.move};
}

/// What is no orientation counts as none.
inline glm::dquat turnOf(const XrQuaternionf& q) {
  const glm::dquat turn(static_cast<double>(q.w), static_cast<double>(q.x),
                        static_cast<double>(q.y), static_cast<double>(q.z));
  const double length = glm::length(turn);
  return length > 1e-6 && std::isfinite(length) ? turn / length : glm::dquat(1.0, 0.0, 0.0, 0.0);
}
inline XrQuaternionf quaternionOf(const glm::dquat& turn) {
  const glm::quat q(turn);
  return {q.x, q.y, q.z, q.w};
}

inline glm::dvec3 pointOf(const XrVector3f& v) {
  return {static_cast<double>(v.x), static_cast<double>(v.y), static_cast<double>(v.z)};
}
inline XrVector3f vectorOf(const glm::dvec3& v) {
  const glm::vec3 p(v);
  return {p.x, p.y, p.z};
}

inline Rigid rigidOf(const XrPosef& pose) {
  return {turnOf(pose.orientation), pointOf(pose.position)};
}
inline XrPosef poseOf(const Rigid& rigid) {
  return {quaternionOf(rigid.turn), vectorOf(rigid.move)};
}

/// A turn about the vertical, then a move.
inline Rigid levelRigid(double yaw, const glm::dvec3& move) {
  return {glm::dquat(std::cos(0.5 * yaw), 0.0, std::sin(0.5 * yaw), 0.0), move};
}

/// The map of a redirection, in space.
inline Rigid rigidOf(const rdw::Redirection& map) {
  // As navmesh::toSpace, which is for floats.
  return levelRigid(map.yaw, {map.offset.x, map.height, -map.offset.y});
}

}  // namespace forewalk::openxr
