// The functions of whoever comes after the layer: another layer, or the runtime.
#pragma once

#include "service/openxr/api.h"

namespace forewalk::openxr {

/// Those that the layer calls. Null where the next one has none; those of OpenXR 1.0 are there.
struct Next {
  PFN_xrGetInstanceProcAddr getInstanceProcAddr = nullptr;
  PFN_xrDestroyInstance destroyInstance = nullptr;
  PFN_xrPollEvent pollEvent = nullptr;
  PFN_xrCreateSession createSession = nullptr;
  PFN_xrDestroySession destroySession = nullptr;
  PFN_xrBeginSession beginSession = nullptr;
  PFN_xrEnumerateReferenceSpaces enumerateReferenceSpaces = nullptr;
  PFN_xrGetReferenceSpaceBoundsRect getReferenceSpaceBoundsRect = nullptr;
  PFN_xrCreateReferenceSpace createReferenceSpace = nullptr;
  PFN_xrCreateActionSpace createActionSpace = nullptr;
  PFN_xrDestroySpace destroySpace = nullptr;
  PFN_xrLocateSpace locateSpace = nullptr;
  PFN_xrLocateViews locateViews = nullptr;
  PFN_xrWaitFrame waitFrame = nullptr;
  PFN_xrEndFrame endFrame = nullptr;
  PFN_xrLocateHandJointsEXT locateHandJoints = nullptr;
  LocateSpacesFunction locateSpaces = nullptr;     // 1.1
  LocateSpacesFunction locateSpacesKhr = nullptr;  // XR_KHR_locate_spaces
};

/// Asks `getInstanceProcAddr` for all of them.
Next nextOf(XrInstance instance, PFN_xrGetInstanceProcAddr getInstanceProcAddr);

}  // namespace forewalk::openxr
