#include "service/openxr/next.h"

#include <type_traits>

namespace forewalk::openxr {

Next nextOf(XrInstance instance, PFN_xrGetInstanceProcAddr getInstanceProcAddr) {
  Next next;
  next.getInstanceProcAddr = getInstanceProcAddr;
  const auto find = [&](const char* name, auto& function) {
    PFN_xrVoidFunction found = nullptr;
    if (XR_SUCCEEDED(getInstanceProcAddr(instance, name, &found))) {
      function = reinterpret_cast<std::remove_reference_t<decltype(function)>>(found);
    }
  };
  find("xrDestroyInstance", next.destroyInstance);
  find("xrPollEvent", next.pollEvent);
  find("xrCreateSession", next.createSession);
  find("xrDestroySession", next.destroySession);
  find("xrBeginSession", next.beginSession);
  find("xrEnumerateReferenceSpaces", next.enumerateReferenceSpaces);
  find("xrGetReferenceSpaceBoundsRect", next.getReferenceSpaceBoundsRect);
  find("xrCreateReferenceSpace", next.createReferenceSpace);
  find("xrCreateActionSpace", next.createActionSpace);
  find("xrDestroySpace", next.destroySpace);
  find("xrLocateSpace", next.locateSpace);
  find("xrLocateViews", next.locateViews);
  find("xrWaitFrame", next.waitFrame);
  find("xrEndFrame", next.endFrame);
  find("xrLocateHandJointsEXT", next.locateHandJoints);
  find("xrLocateSpaces", next.locateSpaces);
  find("xrLocateSpacesKHR", next.locateSpacesKhr);
  return next;
}

}  // namespace forewalk::openxr
