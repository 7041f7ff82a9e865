// The functions of OpenXR that the layer stands in front of, as applications call them.
//
// Each calls the next one's, and changes what is in its answer; what the next one refuses stays
// refused, and a handle that is nobody's is the next one's to refuse. No exception leaves them.
#pragma once

#include <new>

#include "service/openxr/api.h"

namespace forewalk::openxr {

// locate.cpp: answers in the application's world.
XrResult XRAPI_CALL locateSpace(XrSpace space, XrSpace base, XrTime time,
                                XrSpaceLocation* location);
XrResult XRAPI_CALL locateSpaces(XrSession session, const SpacesLocateInfo* info,
                                 SpaceLocations* locations);
XrResult XRAPI_CALL locateSpacesKhr(XrSession session, const SpacesLocateInfo* info,
                                    SpaceLocations* locations);
XrResult XRAPI_CALL locateViews(XrSession session, const XrViewLocateInfo* info, XrViewState* state,
                                std::uint32_t capacity, std::uint32_t* count, XrView* views);
XrResult XRAPI_CALL locateHandJoints(XrHandTrackerEXT tracker,
                                     const XrHandJointsLocateInfoEXT* info,
                                     XrHandJointLocationsEXT* locations);

// submit.cpp: pictures back to the room.
XrResult XRAPI_CALL endFrame(XrSession session, const XrFrameEndInfo* info);

// lifetimes.cpp: who is there, and frame by frame.
XrResult XRAPI_CALL destroyInstance(XrInstance instance);
XrResult XRAPI_CALL createSession(XrInstance instance, const XrSessionCreateInfo* info,
                                  XrSession* session);
XrResult XRAPI_CALL destroySession(XrSession session);
XrResult XRAPI_CALL beginSession(XrSession session, const XrSessionBeginInfo* info);
XrResult XRAPI_CALL createReferenceSpace(XrSession session, const XrReferenceSpaceCreateInfo* info,
                                         XrSpace* space);
XrResult XRAPI_CALL createActionSpace(XrSession session, const XrActionSpaceCreateInfo* info,
                                      XrSpace* space);
XrResult XRAPI_CALL destroySpace(XrSpace space);
XrResult XRAPI_CALL getReferenceSpaceBoundsRect(XrSession session, XrReferenceSpaceType type,
                                                XrExtent2Df* bounds);
XrResult XRAPI_CALL waitFrame(XrSession session, const XrFrameWaitInfo* info, XrFrameState* state);
XrResult XRAPI_CALL pollEvent(XrInstance instance, XrEventDataBuffer* event);

/// Calls `body`; an exception becomes a result.
template <typename Body>
XrResult guarded(Body&& body) noexcept {
  try {
    return body();
  } catch (const std::bad_alloc&) {
    return XR_ERROR_OUT_OF_MEMORY;
  } catch (...) {
    return XR_ERROR_RUNTIME_FAILURE;
  }
}

}  // namespace forewalk::openxr
