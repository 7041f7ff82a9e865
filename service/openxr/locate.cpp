// Where things are, in the application's world.
#include <algorithm>
#include <memory>
#include <vector>

#include "service/openxr/entry_points.h"
#include "service/openxr/registry.h"

namespace forewalk::openxr {
namespace {

constexpr XrSpaceVelocityFlags kLinear = XR_SPACE_VELOCITY_LINEAR_VALID_BIT,
                               kAngular = XR_SPACE_VELOCITY_ANGULAR_VALID_BIT;

/// The struct of this type in a chain; null where there is none.
template <typename Struct>
Struct* inChain(void* chain, int type) {
  for (auto* at = static_cast<XrBaseOutStructure*>(chain); at != nullptr; at = at->next) {
    if (static_cast<int>(at->type) == type) return reinterpret_cast<Struct*>(at);
  }
  return nullptr;
}

/// Puts a pose right, where it is valid.
void correct(const Correction& correction, XrSpaceLocationFlags flags, XrPosef& pose) {
  const Rigid right = correction.before * rigidOf(pose) * correction.after;
  // Positions that were never valid stay what they are; orientations do not need them.
  if ((flags & XR_SPACE_LOCATION_ORIENTATION_VALID_BIT) != 0) {
    pose.orientation = quaternionOf(right.turn);
  }
  if ((flags & XR_SPACE_LOCATION_POSITION_VALID_BIT) != 0) pose.position = vectorOf(right.move);
}

/// Velocities under the frame's map: as the body moves, without what gains add. A fixed space seen
/// from one that moves goes around it when it turns, in a circle as wide as it is far: that is
/// another distance now. `before` and `after` are its pose.
void correctVelocity(const Correction& correction, const XrPosef& before, const XrPosef& after,
                     XrSpaceVelocityFlags& flags, XrVector3f& linear, XrVector3f& angular) {
  if (!correction.turnsBase) {
    const glm::dquat& turn = correction.before.turn;
    if ((flags & kLinear) != 0) linear = vectorOf(turn * pointOf(linear));
    if ((flags & kAngular) != 0) angular = vectorOf(turn * pointOf(angular));
    return;
  }
  if ((flags & kLinear) == 0) return;
  if ((flags & kAngular) == 0) {
    flags &= ~kLinear;
    return;
  }
  linear = vectorOf(pointOf(linear) + glm::cross(pointOf(angular), pointOf(after.position) -
                                                                       pointOf(before.position)));
}

/// The session that two spaces, either of which may be unknown, belong to.
std::shared_ptr<LayerSession> sessionOf(const std::optional<LayerSpace>& a,
                                        const std::optional<LayerSpace>& b) {
  return a ? a->session : b ? b->session : nullptr;
}

std::shared_ptr<const LayerInstance> instanceOf(const std::shared_ptr<LayerSession>& session) {
  return session ? session->instance : Registry::instance().latest();
}

AppSpace spaceOf(const std::optional<LayerSpace>& space) {
  return space ? space->space : AppSpace{};
}

XrResult locateAll(XrSession handle, const SpacesLocateInfo* info, SpaceLocations* locations,
                   LocateSpacesFunction Next::*function) {
  const auto session = Registry::instance().find(handle);
  const auto instance = instanceOf(session);
  if (!instance || instance->next.*function == nullptr) return XR_ERROR_HANDLE_INVALID;
  const XrResult result = (instance->next.*function)(handle, info, locations);
  if (XR_FAILED(result) || !session || !session->redirected) return result;
  const AppSpace base = spaceOf(Registry::instance().find(info->baseSpace));
  auto* velocities = inChain<SpaceVelocities>(locations->next, kTypeSpaceVelocities);
  for (std::uint32_t i = 0; i < info->spaceCount; ++i) {
    const AppSpace of = spaceOf(Registry::instance().find(info->spaces[i]));
    const auto correction = session->redirected->correction(of, base, info->time);
    if (!correction) continue;
    SpaceLocationData& location = locations->locations[i];
    const XrPosef before = location.pose;
    correct(*correction, location.locationFlags, location.pose);
    if (velocities == nullptr) continue;
    SpaceVelocityData& v = velocities->velocities[i];
    correctVelocity(*correction, before, location.pose, v.velocityFlags, v.linearVelocity,
                    v.angularVelocity);
  }
  return result;
}

}  // namespace

XrResult XRAPI_CALL locateSpace(XrSpace handle, XrSpace baseHandle, XrTime time,
                                XrSpaceLocation* location) {
  return guarded([&] {
    const auto space = Registry::instance().find(handle);
    const auto base = Registry::instance().find(baseHandle);
    const auto session = sessionOf(space, base);
    const auto instance = instanceOf(session);
    if (!instance) return XR_ERROR_HANDLE_INVALID;
    const XrResult result = instance->next.locateSpace(handle, baseHandle, time, location);
    if (XR_FAILED(result) || !session || !session->redirected) return result;
    const auto correction = session->redirected->correction(spaceOf(space), spaceOf(base), time);
    if (!correction) return result;
    const XrPosef before = location->pose;
    correct(*correction, location->locationFlags, location->pose);
    if (auto* v = inChain<XrSpaceVelocity>(location->next, XR_TYPE_SPACE_VELOCITY)) {
      correctVelocity(*correction, before, location->pose, v->velocityFlags, v->linearVelocity,
                      v->angularVelocity);
    }
    return result;
  });
}

XrResult XRAPI_CALL locateSpaces(XrSession session, const SpacesLocateInfo* info,
                                 SpaceLocations* locations) {
  return guarded([&] { return locateAll(session, info, locations, &Next::locateSpaces); });
}

XrResult XRAPI_CALL locateSpacesKhr(XrSession session, const SpacesLocateInfo* info,
                                    SpaceLocations* locations) {
  return guarded([&] { return locateAll(session, info, locations, &Next::locateSpacesKhr); });
}

XrResult XRAPI_CALL locateViews(XrSession handle, const XrViewLocateInfo* info, XrViewState* state,
                                std::uint32_t capacity, std::uint32_t* count, XrView* views) {
  return guarded([&] {
    const auto session = Registry::instance().find(handle);
    const auto instance = instanceOf(session);
    if (!instance) return XR_ERROR_HANDLE_INVALID;
    const XrResult result = instance->next.locateViews(handle, info, state, capacity, count, views);
    if (XR_FAILED(result) || !session || !session->redirected || capacity == 0) return result;
    const AppSpace base = spaceOf(Registry::instance().find(info->space));
    const auto correction = session->redirected->correction({}, base, info->displayTime);
    if (!correction) return result;
    // The flags of a view's state are those of a location's.
    static_assert(XR_VIEW_STATE_ORIENTATION_VALID_BIT == XR_SPACE_LOCATION_ORIENTATION_VALID_BIT &&
                  XR_VIEW_STATE_POSITION_VALID_BIT == XR_SPACE_LOCATION_POSITION_VALID_BIT);
    for (std::uint32_t i = 0; i < *count && i < capacity; ++i) {
      correct(*correction, state->viewStateFlags, views[i].pose);
    }
    return result;
  });
}

XrResult XRAPI_CALL locateHandJoints(XrHandTrackerEXT tracker,
                                     const XrHandJointsLocateInfoEXT* info,
                                     XrHandJointLocationsEXT* locations) {
  return guarded([&] {
    const auto base = info == nullptr ? std::nullopt : Registry::instance().find(info->baseSpace);
    const auto session = sessionOf(base, std::nullopt);
    const auto instance = instanceOf(session);
    if (!instance || instance->next.locateHandJoints == nullptr) return XR_ERROR_HANDLE_INVALID;
    const XrResult result = instance->next.locateHandJoints(tracker, info, locations);
    if (XR_FAILED(result) || !session || !session->redirected) return result;
    const auto correction = session->redirected->correction({}, base->space, info->time);
    if (!correction) return result;
    auto* velocities =
        inChain<XrHandJointVelocitiesEXT>(locations->next, XR_TYPE_HAND_JOINT_VELOCITIES_EXT);
    for (std::uint32_t i = 0; i < locations->jointCount; ++i) {
      XrHandJointLocationEXT& joint = locations->jointLocations[i];
      const XrPosef before = joint.pose;
      correct(*correction, joint.locationFlags, joint.pose);
      if (velocities == nullptr || i >= velocities->jointCount) continue;
      XrHandJointVelocityEXT& v = velocities->jointVelocities[i];
      correctVelocity(*correction, before, joint.pose, v.velocityFlags, v.linearVelocity,
                      v.angularVelocity);
    }
    return result;
  });
}

}  // namespace forewalk::openxr
