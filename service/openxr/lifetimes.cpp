// Who is there: instances, sessions and spaces come and go, and frames pass.
#include <memory>
#include <utility>

#include "service/openxr/entry_points.h"
#include "service/openxr/registry.h"

namespace forewalk::openxr {
namespace {

Registry& registry() { return Registry::instance(); }

/// The session's instance, or the only one there is.
std::shared_ptr<const LayerInstance> instanceOf(const std::shared_ptr<LayerSession>& session) {
  return session ? session->instance : registry().latest();
}

}  // namespace

XrResult XRAPI_CALL destroyInstance(XrInstance handle) {
  return guarded([&] {
    const auto instance = registry().remove(handle);
    if (!instance) return XR_ERROR_HANDLE_INVALID;
    return instance->next.destroyInstance(handle);
  });
}

XrResult XRAPI_CALL createSession(XrInstance handle, const XrSessionCreateInfo* info,
                                  XrSession* session) {
  return guarded([&] {
    const auto instance = registry().find(handle);
    if (!instance) return XR_ERROR_HANDLE_INVALID;
    const XrResult result = instance->next.createSession(handle, info, session);
    if (XR_FAILED(result)) return result;
    auto made = std::make_shared<LayerSession>();
    made->instance = instance;
    made->redirected = RedirectedSession::make(instance->next, *instance->config, *session);
    registry().add(*session, std::move(made));
    return result;
  });
}

XrResult XRAPI_CALL destroySession(XrSession handle) {
  return guarded([&] {
    const auto session = registry().remove(handle);
    const auto instance = instanceOf(session);
    if (!instance) return XR_ERROR_HANDLE_INVALID;
    if (session) session->redirected.reset();  // its spaces, while the session lives
    return instance->next.destroySession(handle);
  });
}

XrResult XRAPI_CALL beginSession(XrSession handle, const XrSessionBeginInfo* info) {
  return guarded([&] {
    const auto session = registry().find(handle);
    const auto instance = instanceOf(session);
    if (!instance) return XR_ERROR_HANDLE_INVALID;
    const XrResult result = instance->next.beginSession(handle, info);
    if (XR_SUCCEEDED(result) && session && session->redirected) session->redirected->begin();
    return result;
  });
}

XrResult XRAPI_CALL createReferenceSpace(XrSession handle, const XrReferenceSpaceCreateInfo* info,
                                         XrSpace* space) {
  return guarded([&] {
    auto session = registry().find(handle);
    const auto instance = instanceOf(session);
    if (!instance) return XR_ERROR_HANDLE_INVALID;
    const XrResult result = instance->next.createReferenceSpace(handle, info, space);
    if (XR_FAILED(result) || !session || !session->redirected) return result;
    const AppSpace made = session->redirected->describe(*space, *info);
    registry().add({std::move(session), made});
    return result;
  });
}

XrResult XRAPI_CALL createActionSpace(XrSession handle, const XrActionSpaceCreateInfo* info,
                                      XrSpace* space) {
  return guarded([&] {
    auto session = registry().find(handle);
    const auto instance = instanceOf(session);
    if (!instance) return XR_ERROR_HANDLE_INVALID;
    const XrResult result = instance->next.createActionSpace(handle, info, space);
    if (XR_FAILED(result) || !session) return result;
    registry().add({std::move(session), AppSpace{*space, Kind::kBody, std::nullopt}});
    return result;
  });
}

XrResult XRAPI_CALL destroySpace(XrSpace handle) {
  return guarded([&] {
    const auto space = registry().find(handle);
    const auto instance = instanceOf(space ? space->session : nullptr);
    if (!instance) return XR_ERROR_HANDLE_INVALID;
    registry().remove(handle);
    return instance->next.destroySpace(handle);
  });
}

XrResult XRAPI_CALL getReferenceSpaceBoundsRect(XrSession handle, XrReferenceSpaceType type,
                                                XrExtent2Df* bounds) {
  return guarded([&] {
    const auto session = registry().find(handle);
    const auto instance = instanceOf(session);
    if (!instance) return XR_ERROR_HANDLE_INVALID;
    const XrResult result = instance->next.getReferenceSpaceBoundsRect(handle, type, bounds);
    // The room turns about the user in the application's world: no rectangle there stays free.
    if (result != XR_SUCCESS || !session || !session->redirected ||
        !session->redirected->redirects()) {
      return result;
    }
    *bounds = {0.0f, 0.0f};
    return XR_SPACE_BOUNDS_UNAVAILABLE;
  });
}

XrResult XRAPI_CALL waitFrame(XrSession handle, const XrFrameWaitInfo* info, XrFrameState* state) {
  return guarded([&] {
    const auto session = registry().find(handle);
    const auto instance = instanceOf(session);
    if (!instance) return XR_ERROR_HANDLE_INVALID;
    const XrResult result = instance->next.waitFrame(handle, info, state);
    // From here on the application may ask where things will be in this frame.
    if (XR_SUCCEEDED(result) && session && session->redirected) {
      session->redirected->frame(state->predictedDisplayTime);
    }
    return result;
  });
}

XrResult XRAPI_CALL pollEvent(XrInstance handle, XrEventDataBuffer* event) {
  return guarded([&] {
    const auto instance = registry().find(handle);
    if (!instance) return XR_ERROR_HANDLE_INVALID;
    const XrResult result = instance->next.pollEvent(handle, event);
    if (result != XR_SUCCESS || event->type != XR_TYPE_EVENT_DATA_REFERENCE_SPACE_CHANGE_PENDING) {
      return result;
    }
    auto& change = *reinterpret_cast<XrEventDataReferenceSpaceChangePending*>(event);
    const auto session = registry().find(change.session);
    if (session && session->redirected) session->redirected->noteChange(change);
    return result;
  });
}

}  // namespace forewalk::openxr
