// Handles that clean up, scenes as arrays, and made-up users, for the tests of the C interface.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <random>
#include <vector>

#include "navmesh/build/build.h"
#include "navmesh/random.h"
#include "navmesh/world.h"
#include "rdw/pose.h"
#include "rdw/walk_file.h"
#include "service/capi/forewalk.h"
#include "tests/support/block_scene.h"

namespace forewalk::testing {

struct NavMeshRelease {
  void operator()(forewalk_navmesh* navmesh) const { forewalk_navmesh_release(navmesh); }
};
using NavMeshHandle = std::unique_ptr<forewalk_navmesh, NavMeshRelease>;

struct SessionDestroy {
  void operator()(forewalk_session* session) const { forewalk_session_destroy(session); }
};
using SessionHandle = std::unique_ptr<forewalk_session, SessionDestroy>;

/// A scene as an engine has it in memory.
struct SceneArrays {
  std::vector<float> vertices;
  std::vector<std::uint32_t> indices;
};

inline SceneArrays arraysOf(const navmesh::Scene& scene) {
  SceneArrays arrays;
  for (const glm::vec3 v : scene.vertices)
    arrays.vertices.insert(arrays.vertices.end(), {v.x, v.y, v.z});
  for (const glm::uvec3 t : scene.triangles)
    arrays.indices.insert(arrays.indices.end(), {t.x, t.y, t.z});
  return arrays;
}

inline NavMeshHandle makeNavMesh(const SceneArrays& arrays,
                                 forewalk_axes axes = FOREWALK_AXES_OPENXR,
                                 const forewalk_build_settings* settings = nullptr) {
  forewalk_navmesh* navmesh = nullptr;
  const forewalk_status status = forewalk_navmesh_from_triangles(
      arrays.vertices.data(), arrays.vertices.size() / 3, arrays.indices.data(),
      arrays.indices.size(), axes, settings, &navmesh);
  EXPECT_EQ(status, FOREWALK_OK) << forewalk_last_error();
  return NavMeshHandle(navmesh);
}

inline NavMeshHandle makeNavMesh(const navmesh::Scene& scene) {
  return makeNavMesh(arraysOf(scene));
}

/// What the C interface makes of the scene, made by the library below it.
inline std::shared_ptr<const navmesh::World> makeWorld(const navmesh::Scene& scene) {
  return std::make_shared<const navmesh::World>(
      navmesh::makeWorld(*navmesh::makeNavGraph(navmesh::flatten(*navmesh::buildNavMesh(scene)))));
}

inline SessionHandle makeSession(const NavMeshHandle& navmesh,
                                 const forewalk_session_settings& settings) {
  forewalk_session* session = nullptr;
  const forewalk_status status = forewalk_session_create(navmesh.get(), &settings, &session);
  EXPECT_EQ(status, FOREWALK_OK) << forewalk_last_error();
  return SessionHandle(session);
}

inline forewalk_session_settings defaultSettings() {
  forewalk_session_settings settings;
  forewalk_session_settings_init(&settings, sizeof settings);
  return settings;
}

struct TimedHead {
  rdw::HeadPose pose;
  double seconds;
};

/// Somebody who wanders about a 4 m x 4 m room at 90 frames a second, turns where it ends, stops
/// now and then, nods, and tilts the head.
inline std::vector<TimedHead> wander(std::uint64_t seed, int frames) {
  std::mt19937_64 rng(seed);
  std::vector<TimedHead> heads;
  glm::dvec2 plan(0.0);
  double heading = 2.0 * rdw::kPi * navmesh::uniform(rng);
  double turnRate = 0.0, speed = 1.2;
  for (int i = 0; i < frames; ++i) {
    if (i % 60 == 0) {
      turnRate = 2.0 * navmesh::uniform(rng) - 1.0;
      speed = navmesh::uniform(rng) < 0.2 ? 0.0 : 0.6 + 0.8 * navmesh::uniform(rng);
    }
    const glm::dvec2 next = plan + speed / 90.0 * rdw::directionOf(heading);
    const bool blocked = std::abs(next.x) > 1.9 || std::abs(next.y) > 1.9;
    if (!blocked) plan = next;
    heading += (blocked ? 2.0 : turnRate) / 90.0;
    const glm::dquat yaw = glm::angleAxis(heading, glm::dvec3(0, 1, 0));
    const glm::dquat pitch = glm::angleAxis(0.3 * std::sin(0.05 * i), glm::dvec3(1, 0, 0));
    const glm::dquat roll = glm::angleAxis(0.1 * std::sin(0.03 * i), glm::dvec3(0, 0, 1));
    const double height = 1.7 + 0.03 * std::sin(0.2 * i);
    heads.push_back({{glm::vec3(static_cast<float>(plan.x), static_cast<float>(height),
                                static_cast<float>(-plan.y)),
                      glm::quat(yaw * pitch * roll)},
                     i / 90.0});
  }
  return heads;
}

/// A recorded walk, so many frames a second, by somebody 1.7 m tall who looks where they walk.
inline std::vector<TimedHead> recordedHeads(const rdw::Walk& walk, double rate) {
  std::vector<TimedHead> heads;
  for (const rdw::WalkFrame& at : rdw::resample(walk, rate)) {
    const double half = 0.5 * at.heading;
    heads.push_back({{navmesh::toSpace(glm::vec2(at.plan), 1.7f),
                      glm::quat(static_cast<float>(std::cos(half)), 0.0f,
                                static_cast<float>(std::sin(half)), 0.0f)},
                     static_cast<double>(heads.size()) / rate});
  }
  return heads;
}

/// One frame in our axes.
inline forewalk_frame_out frame(const SessionHandle& session, const TimedHead& head) {
  forewalk_frame_out out{};
  out.struct_size = sizeof out;
  const auto& [p, q] = head.pose;
  EXPECT_EQ(
      forewalk_frame(session.get(), {p.x, p.y, p.z}, {q.x, q.y, q.z, q.w}, head.seconds, &out),
      FOREWALK_OK);
  return out;
}

inline bool isFinite(const forewalk_frame_out& out) {
  const forewalk_pose& pose = out.virtual_pose;
  for (const float number :
       {pose.position.x, pose.position.y, pose.position.z, pose.orientation.x, pose.orientation.y,
        pose.orientation.z, pose.orientation.w, out.translation, out.rotation, out.curvature,
        out.bending, out.injected_yaw, out.injected_translation.x, out.injected_translation.y,
        out.injected_translation.z, out.reset_remaining, out.reset_turned, out.predict_seconds,
        out.steer_seconds}) {
    if (!std::isfinite(number)) return false;
  }
  return true;
}

}  // namespace forewalk::testing
