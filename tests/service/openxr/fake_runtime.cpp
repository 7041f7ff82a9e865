// A fake OpenXR runtime, for tests alone: no headset, no graphics, no clock.
//
// Plays a recorded walk, a pose a frame, and writes down where in the room the pictures it is given
// would be shown. Reads its orders from the environment when an instance is made:
//   FAKE_OPENXR_WALK       file with a line a frame: x y z qx qy qz qw, the head in STAGE
//   FAKE_OPENXR_SUBMITTED  file to write to, a line a picture:
//                          session frame kind index x y z qx qy qz qw red green blue
//   FAKE_OPENXR_BOUNDS     "width depth" of STAGE, metres; without it, unknown
//   FAKE_OPENXR_NO_STAGE   set: there is no STAGE
//   FAKE_OPENXR_NO_TINT    set: there is no XR_KHR_composition_layer_color_scale_bias
//   FAKE_OPENXR_RECENTRE   "local frame" or "stage frame": its origin comes to the head then
//   FAKE_OPENXR_LOST       "first last": frames in which the head is not tracked
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <deque>
#include <fstream>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "service/openxr/api.h"
#include "service/openxr/rigid.h"
#include "tests/service/openxr/fake_room.h"

namespace {

using namespace forewalk::testing;
namespace openxr = forewalk::openxr;
using forewalk::openxr::vectorOf;

constexpr int kNotice = 5;  // frames between the announcement of a change and the change

struct Space {
  XrSession session;
  Anchor anchor;
  XrPosef pose;
};

struct Session {
  int number = 0;
  int frame = -1;  // the one waited for last
  bool running = false, told = false;
  std::deque<XrEventDataBuffer> events;
};

struct Runtime {
  std::mutex mutex;
  FakeRoom room;
  std::ofstream submitted;
  std::set<std::string> paths;
  std::map<XrSession, std::unique_ptr<Session>> sessions;
  std::map<XrSpace, Space> spaces;
  std::uint64_t handles = 1;
  int sessionCount = 0;
};

Runtime runtime;
const XrInstance kInstance = reinterpret_cast<XrInstance>(std::uintptr_t{0x1157});

template <typename Handle>
Handle newHandle() {
  return reinterpret_cast<Handle>(static_cast<std::uintptr_t>(0x10000 + 16 * runtime.handles++));
}

Rigid inRoom(const Space& space, int frame) {
  return runtime.room.anchor(space.anchor, frame) * rigidOf(space.pose);
}

XrPosef located(const Space& space, const Space& base, int frame) {
  const Rigid in = inRoom(base, frame);
  // To the bit, where nothing is to be worked out.
  if (in == Rigid{} && space.anchor == Anchor::kView && rigidOf(space.pose) == Rigid{}) {
    return runtime.room.walk[static_cast<std::size_t>(frame)];
  }
  return poseOf(inverse(in) * inRoom(space, frame));
}

glm::dvec3 spinBetween(const glm::dquat& from, const glm::dquat& to) {
  glm::dquat step = to * glm::conjugate(from);
  if (step.w < 0.0) step = -step;
  const glm::dvec3 axis(step.x, step.y, step.z);
  const double sine = glm::length(axis);
  return sine < 1e-12 ? glm::dvec3(0.0) : axis / sine * (2.0 * std::atan2(sine, step.w));
}

/// Velocities, as differences over a frame.
void measure(const Space& space, const Space& base, int frame, XrVector3f& linear,
             XrVector3f& angular) {
  const int last = static_cast<int>(runtime.room.walk.size()) - 1;
  const Rigid now = rigidOf(located(space, base, frame));
  const Rigid then = rigidOf(located(space, base, std::min(frame + 1, last)));
  const double seconds = 1e-9 * static_cast<double>(kPeriod);
  linear = vectorOf((then.move - now.move) / seconds);
  angular = vectorOf(spinBetween(now.turn, then.turn) / seconds);
}

// What can be asked of any runtime.

struct Extension {
  const char* name;
  std::uint32_t version;
};

std::vector<Extension> extensions() {
  std::vector<Extension> known = {
      {XR_MND_HEADLESS_EXTENSION_NAME, XR_MND_headless_SPEC_VERSION},
      {XR_EXT_HAND_TRACKING_EXTENSION_NAME, XR_EXT_hand_tracking_SPEC_VERSION}};
  if (std::getenv("FAKE_OPENXR_NO_TINT") == nullptr) {
    known.push_back({XR_KHR_COMPOSITION_LAYER_COLOR_SCALE_BIAS_EXTENSION_NAME,
                     XR_KHR_composition_layer_color_scale_bias_SPEC_VERSION});
  }
  return known;
}

XrResult XRAPI_CALL enumerateInstanceExtensionProperties(const char*, std::uint32_t capacity,
                                                         std::uint32_t* count,
                                                         XrExtensionProperties* properties) {
  const std::vector<Extension> known = extensions();
  *count = static_cast<std::uint32_t>(known.size());
  if (capacity == 0) return XR_SUCCESS;
  if (capacity < *count) return XR_ERROR_SIZE_INSUFFICIENT;
  for (std::size_t i = 0; i < known.size(); ++i) {
    std::strcpy(properties[i].extensionName, known[i].name);
    properties[i].extensionVersion = known[i].version;
  }
  return XR_SUCCESS;
}

XrResult XRAPI_CALL createInstance(const XrInstanceCreateInfo* info, XrInstance* instance) {
  const std::lock_guard lock(runtime.mutex);
  runtime.room = FakeRoom::fromEnvironment();
  runtime.submitted.close();
  if (const char* file = std::getenv("FAKE_OPENXR_SUBMITTED")) runtime.submitted.open(file);
  runtime.submitted.precision(9);
  if (runtime.room.walk.empty()) return XR_ERROR_RUNTIME_UNAVAILABLE;
  for (std::uint32_t i = 0; i < info->enabledExtensionCount; ++i) {
    const std::string_view name = info->enabledExtensionNames[i];
    const std::vector<Extension> all = extensions();
    const bool known = std::any_of(
        all.begin(), all.end(), [&](const Extension& extension) { return name == extension.name; });
    if (!known) return XR_ERROR_EXTENSION_NOT_PRESENT;
  }
  *instance = kInstance;
  return XR_SUCCESS;
}

XrResult XRAPI_CALL destroyInstance(XrInstance) {
  const std::lock_guard lock(runtime.mutex);
  runtime.spaces.clear();
  runtime.sessions.clear();
  runtime.submitted.close();
  return XR_SUCCESS;
}

XrResult XRAPI_CALL getInstanceProperties(XrInstance, XrInstanceProperties* properties) {
  properties->runtimeVersion = XR_MAKE_VERSION(0, 1, 0);
  std::strcpy(properties->runtimeName, "fake headless runtime for tests");
  return XR_SUCCESS;
}

XrResult XRAPI_CALL getSystem(XrInstance, const XrSystemGetInfo*, XrSystemId* system) {
  *system = 1;
  return XR_SUCCESS;
}

XrResult XRAPI_CALL stringToPath(XrInstance, const char* text, XrPath* path) {
  const std::lock_guard lock(runtime.mutex);
  *path = reinterpret_cast<std::uintptr_t>(&*runtime.paths.insert(text).first);
  return XR_SUCCESS;
}

XrResult XRAPI_CALL pollEvent(XrInstance, XrEventDataBuffer* event) {
  const std::lock_guard lock(runtime.mutex);
  for (auto& [handle, session] : runtime.sessions) {
    if (session->events.empty()) continue;
    *event = session->events.front();
    session->events.pop_front();
    return XR_SUCCESS;
  }
  return XR_EVENT_UNAVAILABLE;
}

// Sessions.

template <typename Event>
void post(Session& session, const Event& event) {
  XrEventDataBuffer buffer{};
  std::memcpy(&buffer, &event, sizeof event);
  session.events.push_back(buffer);
}

void postState(XrSession handle, Session& session, XrSessionState state) {
  post(session, XrEventDataSessionStateChanged{XR_TYPE_EVENT_DATA_SESSION_STATE_CHANGED, nullptr,
                                               handle, state, kStart});
}

XrResult XRAPI_CALL createSession(XrInstance, const XrSessionCreateInfo*, XrSession* handle) {
  const std::lock_guard lock(runtime.mutex);
  *handle = newHandle<XrSession>();
  auto session = std::make_unique<Session>();
  session->number = runtime.sessionCount++;
  postState(*handle, *session, XR_SESSION_STATE_IDLE);
  postState(*handle, *session, XR_SESSION_STATE_READY);
  runtime.sessions.emplace(*handle, std::move(session));
  return XR_SUCCESS;
}

XrResult XRAPI_CALL destroySession(XrSession handle) {
  const std::lock_guard lock(runtime.mutex);
  std::erase_if(runtime.spaces, [&](const auto& space) { return space.second.session == handle; });
  return runtime.sessions.erase(handle) == 1 ? XR_SUCCESS : XR_ERROR_HANDLE_INVALID;
}

XrResult XRAPI_CALL beginSession(XrSession handle, const XrSessionBeginInfo*) {
  const std::lock_guard lock(runtime.mutex);
  Session& session = *runtime.sessions.at(handle);
  session.running = true;
  postState(handle, session, XR_SESSION_STATE_SYNCHRONIZED);
  postState(handle, session, XR_SESSION_STATE_VISIBLE);
  postState(handle, session, XR_SESSION_STATE_FOCUSED);
  return XR_SUCCESS;
}

XrResult XRAPI_CALL endSession(XrSession handle) {
  const std::lock_guard lock(runtime.mutex);
  Session& session = *runtime.sessions.at(handle);
  session.running = false;
  postState(handle, session, XR_SESSION_STATE_IDLE);
  postState(handle, session, XR_SESSION_STATE_EXITING);
  return XR_SUCCESS;
}

// Spaces.

XrResult XRAPI_CALL enumerateReferenceSpaces(XrSession, std::uint32_t capacity,
                                             std::uint32_t* count, XrReferenceSpaceType* types) {
  *count = runtime.room.hasStage ? 3 : 2;
  if (capacity == 0) return XR_SUCCESS;
  if (capacity < *count) return XR_ERROR_SIZE_INSUFFICIENT;
  types[0] = XR_REFERENCE_SPACE_TYPE_VIEW;
  types[1] = XR_REFERENCE_SPACE_TYPE_LOCAL;
  if (runtime.room.hasStage) types[2] = XR_REFERENCE_SPACE_TYPE_STAGE;
  return XR_SUCCESS;
}

XrResult XRAPI_CALL getReferenceSpaceBoundsRect(XrSession, XrReferenceSpaceType type,
                                                XrExtent2Df* bounds) {
  const bool known = runtime.room.hasBounds && type == XR_REFERENCE_SPACE_TYPE_STAGE;
  *bounds = known ? runtime.room.bounds : XrExtent2Df{0.0f, 0.0f};
  return known ? XR_SUCCESS : XR_SPACE_BOUNDS_UNAVAILABLE;
}

XrSpace addSpace(XrSession session, Anchor anchor, const XrPosef& pose) {
  const std::lock_guard lock(runtime.mutex);
  const XrSpace handle = newHandle<XrSpace>();
  runtime.spaces.emplace(handle, Space{session, anchor, pose});
  return handle;
}

XrResult XRAPI_CALL createReferenceSpace(XrSession session, const XrReferenceSpaceCreateInfo* info,
                                         XrSpace* space) {
  const XrReferenceSpaceType type = info->referenceSpaceType;
  if (type == XR_REFERENCE_SPACE_TYPE_STAGE && !runtime.room.hasStage) {
    return XR_ERROR_REFERENCE_SPACE_UNSUPPORTED;
  }
  const Anchor anchor = type == XR_REFERENCE_SPACE_TYPE_VIEW    ? Anchor::kView
                        : type == XR_REFERENCE_SPACE_TYPE_LOCAL ? Anchor::kLocal
                                                                : Anchor::kStage;
  *space = addSpace(session, anchor, info->poseInReferenceSpace);
  return XR_SUCCESS;
}

XrResult XRAPI_CALL createActionSpace(XrSession session, const XrActionSpaceCreateInfo* info,
                                      XrSpace* space) {
  *space = addSpace(session, Anchor::kHand, info->poseInActionSpace);
  return XR_SUCCESS;
}

XrResult XRAPI_CALL destroySpace(XrSpace handle) {
  const std::lock_guard lock(runtime.mutex);
  return runtime.spaces.erase(handle) == 1 ? XR_SUCCESS : XR_ERROR_HANDLE_INVALID;
}

XrResult XRAPI_CALL locateSpace(XrSpace handle, XrSpace baseHandle, XrTime time,
                                XrSpaceLocation* location) {
  const std::lock_guard lock(runtime.mutex);
  const auto space = runtime.spaces.find(handle), base = runtime.spaces.find(baseHandle);
  if (space == runtime.spaces.end() || base == runtime.spaces.end()) return XR_ERROR_HANDLE_INVALID;
  const int frame = runtime.room.frameAt(time);
  const bool lost =
      runtime.room.isLost(frame) && isBody(space->second.anchor) != isBody(base->second.anchor);
  location->locationFlags = lost ? 0 : 0xF;
  location->pose =
      lost ? XrPosef{{0, 0, 0, 1}, {0, 0, 0}} : located(space->second, base->second, frame);
  for (auto* at = static_cast<XrBaseOutStructure*>(location->next); at != nullptr; at = at->next) {
    if (at->type != XR_TYPE_SPACE_VELOCITY) continue;
    auto& velocity = *reinterpret_cast<XrSpaceVelocity*>(at);
    velocity.velocityFlags = lost ? 0 : 3;
    measure(space->second, base->second, frame, velocity.linearVelocity, velocity.angularVelocity);
  }
  return XR_SUCCESS;
}

XrResult XRAPI_CALL locateSpaces(XrSession, const openxr::SpacesLocateInfo* info,
                                 openxr::SpaceLocations* locations) {
  for (std::uint32_t i = 0; i < info->spaceCount; ++i) {
    XrSpaceLocation location{XR_TYPE_SPACE_LOCATION, nullptr, 0, {}};
    const XrResult result = locateSpace(info->spaces[i], info->baseSpace, info->time, &location);
    if (XR_FAILED(result)) return result;
    locations->locations[i] = {location.locationFlags, location.pose};
  }
  return XR_SUCCESS;
}

XrResult XRAPI_CALL createHandTracker(XrSession, const XrHandTrackerCreateInfoEXT*,
                                      XrHandTrackerEXT* tracker) {
  const std::lock_guard lock(runtime.mutex);
  *tracker = newHandle<XrHandTrackerEXT>();
  return XR_SUCCESS;
}
XrResult XRAPI_CALL destroyHandTracker(XrHandTrackerEXT) { return XR_SUCCESS; }

/// All fingers lie along the hand's axis, a centimetre from joint to joint.
XrResult XRAPI_CALL locateHandJoints(XrHandTrackerEXT, const XrHandJointsLocateInfoEXT* info,
                                     XrHandJointLocationsEXT* locations) {
  const std::lock_guard lock(runtime.mutex);
  const Space& base = runtime.spaces.at(info->baseSpace);
  const int frame = runtime.room.frameAt(info->time);
  auto* velocities = static_cast<XrHandJointVelocitiesEXT*>(locations->next);
  locations->isActive = XR_TRUE;
  for (std::uint32_t i = 0; i < locations->jointCount; ++i) {
    const XrPosef joint{{0, 0, 0, 1}, {0, 0, -0.01f * static_cast<float>(i)}};
    const Space space{base.session, Anchor::kHand, joint};
    locations->jointLocations[i] = {0xF, located(space, base, frame), 0.01f};
    XrHandJointVelocityEXT& velocity = velocities->jointVelocities[i];
    velocity.velocityFlags = 3;
    measure(space, base, frame, velocity.linearVelocity, velocity.angularVelocity);
  }
  return XR_SUCCESS;
}

XrResult XRAPI_CALL locateViews(XrSession session, const XrViewLocateInfo* info, XrViewState* state,
                                std::uint32_t capacity, std::uint32_t* count, XrView* views) {
  const std::lock_guard lock(runtime.mutex);
  *count = 2;
  if (capacity == 0) return XR_SUCCESS;
  if (capacity < 2) return XR_ERROR_SIZE_INSUFFICIENT;
  const int frame = runtime.room.frameAt(info->displayTime);
  const Space& base = runtime.spaces.at(info->space);
  const bool lost = runtime.room.isLost(frame) && !isBody(base.anchor);
  state->viewStateFlags = lost ? 0 : 0xF;
  for (std::uint32_t i = 0; i < 2; ++i) {
    const XrPosef eye{{0, 0, 0, 1}, {i == 0 ? -0.032f : 0.032f, 0, 0}};
    views[i].pose = lost ? XrPosef{{0, 0, 0, 1}, {0, 0, 0}}
                         : located(Space{session, Anchor::kView, eye}, base, frame);
    views[i].fov = {-0.8f, 0.8f, 0.8f, -0.8f};
  }
  return XR_SUCCESS;
}

// Frames.

void announceChange(XrSession handle, Session& session) {
  const Rigid before = runtime.room.anchor(runtime.room.moving, runtime.room.changeFrame - 1);
  const Rigid after = runtime.room.anchor(runtime.room.moving, runtime.room.changeFrame);
  post(session,
       XrEventDataReferenceSpaceChangePending{
           XR_TYPE_EVENT_DATA_REFERENCE_SPACE_CHANGE_PENDING, nullptr, handle,
           runtime.room.moving == Anchor::kStage ? XR_REFERENCE_SPACE_TYPE_STAGE
                                                 : XR_REFERENCE_SPACE_TYPE_LOCAL,
           kStart + runtime.room.changeFrame * kPeriod, XR_TRUE, poseOf(inverse(before) * after)});
}

XrResult XRAPI_CALL waitFrame(XrSession handle, const XrFrameWaitInfo*, XrFrameState* state) {
  const std::lock_guard lock(runtime.mutex);
  Session& session = *runtime.sessions.at(handle);
  if (!session.running) return XR_ERROR_SESSION_NOT_RUNNING;
  ++session.frame;
  if (session.frame == runtime.room.changeFrame - kNotice) announceChange(handle, session);
  if (session.frame + 1 == static_cast<int>(runtime.room.walk.size()) && !session.told) {
    session.told = true;
    postState(handle, session, XR_SESSION_STATE_VISIBLE);
    postState(handle, session, XR_SESSION_STATE_SYNCHRONIZED);
    postState(handle, session, XR_SESSION_STATE_STOPPING);
  }
  state->predictedDisplayTime = kStart + session.frame * kPeriod;
  state->predictedDisplayPeriod = kPeriod;
  state->shouldRender = XR_TRUE;
  return XR_SUCCESS;
}

XrResult XRAPI_CALL beginFrame(XrSession, const XrFrameBeginInfo*) { return XR_SUCCESS; }

void writePicture(const Session& session, int frame, const char* kind, std::uint32_t index,
                  XrSpace space, const XrPosef& pose, const void* chain) {
  XrColor4f tint{1, 1, 1, 1};
  for (auto* at = static_cast<const XrBaseInStructure*>(chain); at != nullptr; at = at->next) {
    if (at->type == XR_TYPE_COMPOSITION_LAYER_COLOR_SCALE_BIAS_KHR) {
      tint = reinterpret_cast<const XrCompositionLayerColorScaleBiasKHR*>(at)->colorScale;
    }
  }
  const XrPosef shown = poseOf(inRoom(runtime.spaces.at(space), frame) * rigidOf(pose));
  const XrVector3f& p = shown.position;
  const XrQuaternionf& q = shown.orientation;
  runtime.submitted << session.number << ' ' << frame << ' ' << kind << ' ' << index << ' ' << p.x
                    << ' ' << p.y << ' ' << p.z << ' ' << q.x << ' ' << q.y << ' ' << q.z << ' '
                    << q.w << ' ' << tint.r << ' ' << tint.g << ' ' << tint.b << '\n';
}

XrResult XRAPI_CALL endFrame(XrSession handle, const XrFrameEndInfo* info) {
  const std::lock_guard lock(runtime.mutex);
  const Session& session = *runtime.sessions.at(handle);
  const int frame = runtime.room.frameAt(info->displayTime);
  for (std::uint32_t i = 0; i < info->layerCount; ++i) {
    const XrCompositionLayerBaseHeader* layer = info->layers[i];
    if (layer->type == XR_TYPE_COMPOSITION_LAYER_PROJECTION) {
      const auto& projection = *reinterpret_cast<const XrCompositionLayerProjection*>(layer);
      for (std::uint32_t view = 0; view < projection.viewCount; ++view) {
        writePicture(session, frame, "eye", view, layer->space, projection.views[view].pose,
                     layer->next);
      }
    } else if (layer->type == XR_TYPE_COMPOSITION_LAYER_QUAD) {
      const auto& quad = *reinterpret_cast<const XrCompositionLayerQuad*>(layer);
      writePicture(session, frame, "quad", i, layer->space, quad.pose, layer->next);
    } else {
      return XR_ERROR_LAYER_INVALID;
    }
  }
  return XR_SUCCESS;
}

// Actions and swapchains: there, and nothing behind them.

XrResult XRAPI_CALL createActionSet(XrInstance, const XrActionSetCreateInfo*, XrActionSet* set) {
  const std::lock_guard lock(runtime.mutex);
  *set = newHandle<XrActionSet>();
  return XR_SUCCESS;
}
XrResult XRAPI_CALL createAction(XrActionSet, const XrActionCreateInfo*, XrAction* action) {
  const std::lock_guard lock(runtime.mutex);
  *action = newHandle<XrAction>();
  return XR_SUCCESS;
}
XrResult XRAPI_CALL attachActionSets(XrSession, const XrSessionActionSetsAttachInfo*) {
  return XR_SUCCESS;
}
XrResult XRAPI_CALL createSwapchain(XrSession, const XrSwapchainCreateInfo*, XrSwapchain* chain) {
  const std::lock_guard lock(runtime.mutex);
  *chain = newHandle<XrSwapchain>();
  return XR_SUCCESS;
}
XrResult XRAPI_CALL destroySwapchain(XrSwapchain) { return XR_SUCCESS; }

XrResult XRAPI_CALL getInstanceProcAddr(XrInstance, const char* name,
                                        PFN_xrVoidFunction* function) {
  const auto of = [](auto* pointer) { return reinterpret_cast<PFN_xrVoidFunction>(pointer); };
  static const std::map<std::string_view, PFN_xrVoidFunction> kFunctions = {
      {"xrGetInstanceProcAddr", of(getInstanceProcAddr)},
      {"xrEnumerateInstanceExtensionProperties", of(enumerateInstanceExtensionProperties)},
      {"xrCreateInstance", of(createInstance)},
      {"xrDestroyInstance", of(destroyInstance)},
      {"xrGetInstanceProperties", of(getInstanceProperties)},
      {"xrGetSystem", of(getSystem)},
      {"xrStringToPath", of(stringToPath)},
      {"xrPollEvent", of(pollEvent)},
      {"xrCreateSession", of(createSession)},
      {"xrDestroySession", of(destroySession)},
      {"xrBeginSession", of(beginSession)},
      {"xrEndSession", of(endSession)},
      {"xrEnumerateReferenceSpaces", of(enumerateReferenceSpaces)},
      {"xrGetReferenceSpaceBoundsRect", of(getReferenceSpaceBoundsRect)},
      {"xrCreateReferenceSpace", of(createReferenceSpace)},
      {"xrCreateActionSpace", of(createActionSpace)},
      {"xrDestroySpace", of(destroySpace)},
      {"xrLocateSpace", of(locateSpace)},
      {"xrLocateSpacesKHR", of(locateSpaces)},
      {"xrCreateHandTrackerEXT", of(createHandTracker)},
      {"xrDestroyHandTrackerEXT", of(destroyHandTracker)},
      {"xrLocateHandJointsEXT", of(locateHandJoints)},
      {"xrLocateViews", of(locateViews)},
      {"xrWaitFrame", of(waitFrame)},
      {"xrBeginFrame", of(beginFrame)},
      {"xrEndFrame", of(endFrame)},
      {"xrCreateActionSet", of(createActionSet)},
      {"xrCreateAction", of(createAction)},
      {"xrAttachSessionActionSets", of(attachActionSets)},
      {"xrCreateSwapchain", of(createSwapchain)},
      {"xrDestroySwapchain", of(destroySwapchain)},
  };
  const auto found = kFunctions.find(name);
  *function = found == kFunctions.end() ? nullptr : found->second;
  return *function == nullptr ? XR_ERROR_FUNCTION_UNSUPPORTED : XR_SUCCESS;
}

}  // namespace

extern "C" __attribute__((visibility("default"))) XrResult XRAPI_CALL
xrNegotiateLoaderRuntimeInterface(const XrNegotiateLoaderInfo* loader,
                                  XrNegotiateRuntimeRequest* request) {
  if (loader->structSize != sizeof(XrNegotiateLoaderInfo) ||
      request->structSize != sizeof(XrNegotiateRuntimeRequest)) {
    return XR_ERROR_INITIALIZATION_FAILED;
  }
  request->runtimeInterfaceVersion = XR_CURRENT_LOADER_RUNTIME_VERSION;
  request->runtimeApiVersion = XR_CURRENT_API_VERSION;
  request->getInstanceProcAddr = getInstanceProcAddr;
  return XR_SUCCESS;
}
