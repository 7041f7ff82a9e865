// Other people's axes and units, and ours. The names say which side is which: a forewalk_ struct
// holds the engine's numbers, a GLM vector ours (right-handed, +Y up, forward -Z, metres).
//
// Both engines are left-handed, so their maps are improper: a rotation's axis is mapped like any
// vector and its angle changes sign. Unity differs by signs only and converts without rounding;
// Unreal's centimetres round to the nearest float each way.
#pragma once

#include <glm/glm.hpp>

#include "navmesh/links.h"
#include "navmesh/standing.h"
#include "rdw/pose.h"
#include "service/capi/forewalk.h"

namespace forewalk::capi {

/// Unity: x right, y up, z forward, metres. The maps are linear: they convert displacements, too.
glm::vec3 positionFromUnity(forewalk_vec3 unity);
forewalk_vec3 positionToUnity(glm::vec3 position);
glm::quat orientationFromUnity(forewalk_quat unity);
forewalk_quat orientationToUnity(const glm::quat& orientation);
rdw::HeadPose poseFromUnity(const forewalk_pose& unity);
forewalk_pose poseToUnity(const rdw::HeadPose& pose);

/// Unreal: x forward, y right, z up, centimetres.
glm::vec3 positionFromUnreal(forewalk_vec3 unreal);
forewalk_vec3 positionToUnreal(glm::vec3 position);
glm::quat orientationFromUnreal(forewalk_quat unreal);
forewalk_quat orientationToUnreal(const glm::quat& orientation);
rdw::HeadPose poseFromUnreal(const forewalk_pose& unreal);
forewalk_pose poseToUnreal(const rdw::HeadPose& pose);

/// The same for a session that was told whose axes it speaks. `axes` is one of the constants.
glm::vec3 positionFrom(forewalk_axes axes, forewalk_vec3 theirs);
forewalk_vec3 positionTo(forewalk_axes axes, glm::vec3 ours);
rdw::HeadPose poseFrom(forewalk_axes axes, const forewalk_pose& theirs);
forewalk_pose poseTo(forewalk_axes axes, const rdw::HeadPose& ours);

/// What worlds that move are told, of their axes.
navmesh::Link linkFrom(forewalk_axes axes, const forewalk_link& theirs);
navmesh::Standing standingFrom(forewalk_axes axes, const forewalk_standing& theirs);

/// Of a turn that is +1 radian in `axes` ours is angleSign() radians, and the other way round.
inline float angleSign(forewalk_axes axes) { return axes == FOREWALK_AXES_OPENXR ? 1.0f : -1.0f; }

/// How many of the axes' units a metre has.
inline float unitsPerMetre(forewalk_axes axes) {
  return axes == FOREWALK_AXES_UNREAL ? 100.0f : 1.0f;
}

}  // namespace forewalk::capi
