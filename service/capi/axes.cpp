#include "service/capi/axes.h"

namespace forewalk::capi {

glm::vec3 positionFromUnity(forewalk_vec3 unity) { return {unity.x, unity.y, -unity.z}; }

forewalk_vec3 positionToUnity(glm::vec3 position) { return {position.x, position.y, -position.z}; }

glm::quat orientationFromUnity(forewalk_quat unity) {
  return glm::quat(unity.w, -unity.x, -unity.y, unity.z);
}

forewalk_quat orientationToUnity(const glm::quat& orientation) {
  return {-orientation.x, -orientation.y, orientation.z, orientation.w};
}

rdw::HeadPose poseFromUnity(const forewalk_pose& unity) {
  return {positionFromUnity(unity.position), orientationFromUnity(unity.orientation)};
}

forewalk_pose poseToUnity(const rdw::HeadPose& pose) {
  return {positionToUnity(pose.position), orientationToUnity(pose.orientation)};
}

namespace {

constexpr float kUnrealUnits = 100.0f;  // in a metre

}  // namespace

// Divided rather than multiplied by 0.01, which is no float: where a float of centimetres holds our
// position exactly, it comes back as it was.
glm::vec3 positionFromUnreal(forewalk_vec3 unreal) {
  return {unreal.y / kUnrealUnits, unreal.z / kUnrealUnits, -unreal.x / kUnrealUnits};
}

forewalk_vec3 positionToUnreal(glm::vec3 position) {
  return {-position.z * kUnrealUnits, position.x * kUnrealUnits, position.y * kUnrealUnits};
}

glm::quat orientationFromUnreal(forewalk_quat unreal) {
  return glm::quat(unreal.w, -unreal.y, -unreal.z, unreal.x);
}

forewalk_quat orientationToUnreal(const glm::quat& orientation) {
  return {orientation.z, -orientation.x, -orientation.y, orientation.w};
}

rdw::HeadPose poseFromUnreal(const forewalk_pose& unreal) {
  return {positionFromUnreal(unreal.position), orientationFromUnreal(unreal.orientation)};
}

forewalk_pose poseToUnreal(const rdw::HeadPose& pose) {
  return {positionToUnreal(pose.position), orientationToUnreal(pose.orientation)};
}

glm::vec3 positionFrom(forewalk_axes axes, forewalk_vec3 theirs) {
  switch (axes) {
    case FOREWALK_AXES_UNITY:
      return positionFromUnity(theirs);
    case FOREWALK_AXES_UNREAL:
      return positionFromUnreal(theirs);
    default:
      return {theirs.x, theirs.y, theirs.z};
  }
}

forewalk_vec3 positionTo(forewalk_axes axes, glm::vec3 ours) {
  switch (axes) {
    case FOREWALK_AXES_UNITY:
      return positionToUnity(ours);
    case FOREWALK_AXES_UNREAL:
      return positionToUnreal(ours);
    default:
      return {ours.x, ours.y, ours.z};
  }
}

rdw::HeadPose poseFrom(forewalk_axes axes, const forewalk_pose& theirs) {
  switch (axes) {
    case FOREWALK_AXES_UNITY:
      return poseFromUnity(theirs);
    case FOREWALK_AXES_UNREAL:
      return poseFromUnreal(theirs);
    default:
      return {positionFrom(axes, theirs.position),
              glm::quat(theirs.orientation.w, theirs.orientation.x, theirs.orientation.y,
                        theirs.orientation.z)};
  }
}

forewalk_pose poseTo(forewalk_axes axes, const rdw::HeadPose& ours) {
  switch (axes) {
    case FOREWALK_AXES_UNITY:
      return poseToUnity(ours);
    case FOREWALK_AXES_UNREAL:
      return poseToUnreal(ours);
    default:
      return {positionTo(axes, ours.position),
              {ours.orientation.x, ours.orientation.y, ours.orientation.z, ours.orientation.w}};
  }
}

navmesh::Link linkFrom(forewalk_axes axes, const forewalk_link& theirs) {
  return {navmesh::LinkId{theirs.id},      positionFrom(axes, theirs.entry),
          positionFrom(axes, theirs.exit), theirs.length,
          theirs.both_ways != 0,           theirs.closed == 0};
}

navmesh::Standing standingFrom(forewalk_axes axes, const forewalk_standing& theirs) {
  return {positionFrom(axes, theirs.foot), theirs.radius,
          theirs.cost == 0.0f ? navmesh::kClosed : theirs.cost};
}

}  // namespace forewalk::capi
