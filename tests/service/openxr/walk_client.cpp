// An OpenXR application that knows nothing of forewalk: asks every frame where things are, and
// hands in pictures drawn from there.
//
//   openxr_walk_client OUT [--sessions N] [--threads] [--no-stage] [--mistake] [--frames N]
//
// OUT gets a line an answer: session frame name flags x y z qx qy qz qw vflags vx vy vz wx wy wz.
// Prints the bounds of STAGE, and the processor time of a frame's calls, median and 99 %.
// --threads: a second thread draws a frame while the first prepares the next.
// --mistake: one call that breaks the rules, to see who notices.
// Exit status: 0, or 1 where a call failed, named on stderr.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <map>
#include <string>
#include <thread>
#include <type_traits>
#include <vector>

#include "service/openxr/api.h"  // shapes that Debian's header does not have yet

// Debian's loader 1.0.20 never frees its list of runtimes, layer or not; no symbol of it has a name
// to tell that from what was allocated on behalf of a layer.
extern "C" const char* __lsan_default_suppressions() { return "leak:libopenxr_loader\n"; }
extern "C" const char* __lsan_default_options() { return "print_suppressions=0"; }

namespace {

using forewalk::openxr::LocateSpacesFunction;
using forewalk::openxr::SpaceLocationData;
using forewalk::openxr::SpaceLocations;
using forewalk::openxr::SpacesLocateInfo;

constexpr XrPosef kIdentity{{0, 0, 0, 1}, {0, 0, 0}};

void require(XrResult result, const char* call) {
  if (XR_SUCCEEDED(result)) return;
  std::fprintf(stderr, "walk_client: %s gave %d\n", call, static_cast<int>(result));
  std::exit(1);
}
#define REQUIRE(call) require(call, #call)

struct Options {
  std::string out;
  int sessions = 1;
  int frames = 1 << 30;
  bool threads = false, stage = true, mistake = false;
};

struct Line {
  int frame;
  std::string name;
  XrSpaceLocationFlags flags;
  XrPosef pose;
  XrSpaceVelocity velocity;
};

/// Of this thread: what others do on the machine is not in it.
double processorMicroseconds() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return 1e6 * static_cast<double>(time.tv_sec) + 1e-3 * static_cast<double>(time.tv_nsec);
}

class Application {
 public:
  Application(XrInstance instance, const Options& options, int number)
      : options_(options), number_(number), instance_(instance) {
    XrSystemGetInfo systemInfo{XR_TYPE_SYSTEM_GET_INFO, nullptr,
                               XR_FORM_FACTOR_HEAD_MOUNTED_DISPLAY};
    XrSystemId system;
    REQUIRE(xrGetSystem(instance, &systemInfo, &system));
    XrSessionCreateInfo info{XR_TYPE_SESSION_CREATE_INFO, nullptr, 0, system};
    REQUIRE(xrCreateSession(instance, &info, &session_));
    view_ = reference(XR_REFERENCE_SPACE_TYPE_VIEW, kIdentity);
    local_ = reference(XR_REFERENCE_SPACE_TYPE_LOCAL, kIdentity);
    shelf_ = reference(XR_REFERENCE_SPACE_TYPE_LOCAL, {{0, 0.6f, 0, 0.8f}, {2, -0.5f, 1}});
    if (options.stage) stage_ = reference(XR_REFERENCE_SPACE_TYPE_STAGE, kIdentity);
    hand_ = hand();
    extend();
    XrSwapchainCreateInfo picture{XR_TYPE_SWAPCHAIN_CREATE_INFO,
                                  nullptr,
                                  0,
                                  XR_SWAPCHAIN_USAGE_COLOR_ATTACHMENT_BIT,
                                  1,
                                  1,
                                  64,
                                  64,
                                  1,
                                  1,
                                  1};
    REQUIRE(xrCreateSwapchain(session_, &picture, &picture_));
    if (stage_ != XR_NULL_HANDLE) {
      XrExtent2Df bounds;
      const XrResult result =
          xrGetReferenceSpaceBoundsRect(session_, XR_REFERENCE_SPACE_TYPE_STAGE, &bounds);
      std::printf("bounds before %d: %d %g %g\n", number_, static_cast<int>(result),
                  static_cast<double>(bounds.width), static_cast<double>(bounds.height));
    }
  }

  XrSession session() const { return session_; }
  /// Asks for functions of extensions; a runtime without them is fine.
  void extend() {
    const auto find = [this](const char* name, auto& function) {
      PFN_xrVoidFunction found = nullptr;
      if (XR_FAILED(xrGetInstanceProcAddr(instance_, name, &found))) return;
      function = reinterpret_cast<std::remove_reference_t<decltype(function)>>(found);
    };
    // By the way that leads past whoever gives away the next one's.
    PFN_xrGetInstanceProcAddr another = nullptr;
    find("xrGetInstanceProcAddr", another);
    PFN_xrVoidFunction spaces = nullptr;
    if (XR_SUCCEEDED(another(instance_, "xrLocateSpacesKHR", &spaces))) {
      locateSpaces_ = reinterpret_cast<LocateSpacesFunction>(spaces);
    }
    PFN_xrCreateHandTrackerEXT create = nullptr;
    find("xrCreateHandTrackerEXT", create);
    find("xrDestroyHandTrackerEXT", destroyTracker_);
    if (create == nullptr) return;
    const XrHandTrackerCreateInfoEXT info{XR_TYPE_HAND_TRACKER_CREATE_INFO_EXT, nullptr,
                                          XR_HAND_LEFT_EXT, XR_HAND_JOINT_SET_DEFAULT_EXT};
    REQUIRE(create(session_, &info, &tracker_));
    find("xrLocateHandJointsEXT", locateJoints_);
  }

  bool done() const { return done_; }
  bool running() const { return running_; }

  void stateChanged(XrSessionState state) {
    if (state == XR_SESSION_STATE_READY) {
      XrSessionBeginInfo info{XR_TYPE_SESSION_BEGIN_INFO, nullptr,
                              XR_VIEW_CONFIGURATION_TYPE_PRIMARY_STEREO};
      REQUIRE(xrBeginSession(session_, &info));
      running_ = true;
    } else if (state == XR_SESSION_STATE_STOPPING) {
      stop();
    } else if (state == XR_SESSION_STATE_EXITING) {
      done_ = true;
    }
  }

  void moved(const XrEventDataReferenceSpaceChangePending& event) {
    lines_.push_back({frame_, "moved", event.poseValid, event.poseInPreviousSpace, {}});
  }

  void frame() {
    const double began = processorMicroseconds();
    calls();
    microseconds_.push_back(processorMicroseconds() - began);
    if (frame_ + 1 >= options_.frames) {
      stop();
      done_ = true;
    }
  }

  /// Nearest rank.
  double microseconds(double share) {
    std::sort(microseconds_.begin(), microseconds_.end());
    const auto rank = static_cast<std::size_t>(share * static_cast<double>(microseconds_.size()));
    return microseconds_.empty() ? 0.0 : microseconds_[std::min(rank, microseconds_.size() - 1)];
  }

  void calls() {
    XrFrameWaitInfo wait{XR_TYPE_FRAME_WAIT_INFO, nullptr};
    XrFrameState state{XR_TYPE_FRAME_STATE, nullptr, 0, 0, 0};
    REQUIRE(xrWaitFrame(session_, &wait, &state));
    ++frame_;
    // Only now is the frame before drawn, when the next has begun; on a thread of its own.
    finish();
    if (options_.threads && pending_ != 0) {
      drawing_ = std::thread([this, frame = frame_ - 1, time = pending_] { draw(frame, time); });
    }
    ask(state.predictedDisplayTime);
    XrFrameBeginInfo begin{XR_TYPE_FRAME_BEGIN_INFO, nullptr};
    if (options_.threads) {
      finish();
      REQUIRE(xrBeginFrame(session_, &begin));
      pending_ = state.predictedDisplayTime;
    } else {
      REQUIRE(xrBeginFrame(session_, &begin));
      draw(frame_, state.predictedDisplayTime);
    }
  }

  void write(std::FILE* out) const {
    for (const std::vector<Line>* lines : {&lines_, &drawn_}) {
      for (const Line& line : *lines) {
        const XrVector3f &p = line.pose.position, &v = line.velocity.linearVelocity,
                         &w = line.velocity.angularVelocity;
        const XrQuaternionf& q = line.pose.orientation;
        std::fprintf(out, "%d %d %s %d", number_, line.frame, line.name.c_str(),
                     static_cast<int>(line.flags));
        for (const float value : {p.x, p.y, p.z, q.x, q.y, q.z, q.w}) {
          std::fprintf(out, " %.9g", static_cast<double>(value));
        }
        std::fprintf(out, " %d", static_cast<int>(line.velocity.velocityFlags));
        for (const float value : {v.x, v.y, v.z, w.x, w.y, w.z}) {
          std::fprintf(out, " %.9g", static_cast<double>(value));
        }
        std::fputc('\n', out);
      }
    }
  }

  void close() {
    for (const XrSpace space : {view_, local_, shelf_, stage_, hand_}) {
      if (space != XR_NULL_HANDLE) REQUIRE(xrDestroySpace(space));
    }
    if (tracker_ != XR_NULL_HANDLE) REQUIRE(destroyTracker_(tracker_));
    REQUIRE(xrDestroySwapchain(picture_));
    REQUIRE(xrDestroySession(session_));
  }

 private:
  XrSpace reference(XrReferenceSpaceType type, const XrPosef& pose) const {
    XrReferenceSpaceCreateInfo info{XR_TYPE_REFERENCE_SPACE_CREATE_INFO, nullptr, type, pose};
    XrSpace space;
    REQUIRE(xrCreateReferenceSpace(session_, &info, &space));
    return space;
  }

  XrSpace hand() const {
    XrActionSetCreateInfo setInfo{XR_TYPE_ACTION_SET_CREATE_INFO, nullptr, {}, {}, 0};
    const std::string name = "walking" + std::to_string(number_);
    std::strcpy(setInfo.actionSetName, name.c_str());
    std::strcpy(setInfo.localizedActionSetName, name.c_str());
    XrActionSet set;
    REQUIRE(xrCreateActionSet(instance_, &setInfo, &set));
    XrActionCreateInfo actionInfo{
        XR_TYPE_ACTION_CREATE_INFO, nullptr, {}, XR_ACTION_TYPE_POSE_INPUT, 0, nullptr, {}};
    std::strcpy(actionInfo.actionName, "hand");
    std::strcpy(actionInfo.localizedActionName, "hand");
    XrAction action;
    REQUIRE(xrCreateAction(set, &actionInfo, &action));
    XrSessionActionSetsAttachInfo attach{XR_TYPE_SESSION_ACTION_SETS_ATTACH_INFO, nullptr, 1, &set};
    REQUIRE(xrAttachSessionActionSets(session_, &attach));
    XrActionSpaceCreateInfo info{XR_TYPE_ACTION_SPACE_CREATE_INFO, nullptr, action, XR_NULL_PATH,
                                 kIdentity};
    XrSpace space;
    REQUIRE(xrCreateActionSpace(session_, &info, &space));
    return space;
  }

  void ask(const char* name, XrSpace space, XrSpace base, XrTime time) {
    if (space == XR_NULL_HANDLE || base == XR_NULL_HANDLE) return;
    XrSpaceVelocity velocity{XR_TYPE_SPACE_VELOCITY, nullptr, 0, {}, {}};
    XrSpaceLocation location{XR_TYPE_SPACE_LOCATION, &velocity, 0, kIdentity};
    REQUIRE(xrLocateSpace(space, base, time, &location));
    lines_.push_back({frame_, name, location.locationFlags, location.pose, velocity});
  }

  void ask(XrTime time) {
    ask("view_in_stage", view_, stage_, time);
    ask("view_in_local", view_, local_, time);
    ask("view_in_shelf", view_, shelf_, time);
    ask("hand_in_stage", hand_, stage_, time);
    ask("hand_in_local", hand_, local_, time);
    ask("hand_in_view", hand_, view_, time);
    ask("stage_in_view", stage_, view_, time);
    ask("shelf_in_hand", shelf_, hand_, time);
    ask("local_in_stage", local_, stage_, time);
    ask("shelf_in_local", shelf_, local_, time);
    askForFinger(time);
    askForAll(time);
  }

  /// The tip of the hand's longest finger.
  void askForFinger(XrTime time) {
    if (locateJoints_ == nullptr) return;
    XrHandJointVelocityEXT speeds[XR_HAND_JOINT_COUNT_EXT]{};
    XrHandJointVelocitiesEXT velocities{XR_TYPE_HAND_JOINT_VELOCITIES_EXT, nullptr,
                                        XR_HAND_JOINT_COUNT_EXT, speeds};
    XrHandJointLocationEXT joints[XR_HAND_JOINT_COUNT_EXT]{};
    XrHandJointLocationsEXT locations{XR_TYPE_HAND_JOINT_LOCATIONS_EXT, &velocities, XR_FALSE,
                                      XR_HAND_JOINT_COUNT_EXT, joints};
    const XrHandJointsLocateInfoEXT info{XR_TYPE_HAND_JOINTS_LOCATE_INFO_EXT, nullptr, local_,
                                         time};
    REQUIRE(locateJoints_(tracker_, &info, &locations));
    const XrHandJointVelocityEXT& speed = speeds[XR_HAND_JOINT_MIDDLE_TIP_EXT];
    const XrHandJointLocationEXT& joint = joints[XR_HAND_JOINT_MIDDLE_TIP_EXT];
    lines_.push_back({frame_,
                      "finger_in_local",
                      joint.locationFlags,
                      joint.pose,
                      {XR_TYPE_SPACE_VELOCITY, nullptr, speed.velocityFlags, speed.linearVelocity,
                       speed.angularVelocity}});
  }

  /// Head and hand in one call of a later version.
  void askForAll(XrTime time) {
    if (locateSpaces_ == nullptr) return;
    const XrSpace spaces[] = {view_, hand_};
    SpaceLocationData where[2]{};
    const SpacesLocateInfo info{
        static_cast<XrStructureType>(1000471000), nullptr, local_, time, 2, spaces};
    SpaceLocations locations{static_cast<XrStructureType>(1000471001), nullptr, 2, where};
    REQUIRE(locateSpaces_(session_, &info, &locations));
    lines_.push_back({frame_, "together_view", where[0].locationFlags, where[0].pose, {}});
    lines_.push_back({frame_, "together_hand", where[1].locationFlags, where[1].pose, {}});
  }

  /// Asks where the eyes are, and hands in what was seen from there: a picture an eye in LOCAL, a
  /// sign on a wall, and one carried before the head.
  void draw(int frame, XrTime time) {
    XrViewLocateInfo where{XR_TYPE_VIEW_LOCATE_INFO, nullptr,
                           XR_VIEW_CONFIGURATION_TYPE_PRIMARY_STEREO, time, local_};
    XrViewState state{XR_TYPE_VIEW_STATE, nullptr, 0};
    XrView views[2] = {{XR_TYPE_VIEW, nullptr, kIdentity, {}},
                       {XR_TYPE_VIEW, nullptr, kIdentity, {}}};
    std::uint32_t count = 0;
    REQUIRE(xrLocateViews(session_, &where, &state, 2, &count, views));
    const XrSwapchainSubImage image{picture_, {{0, 0}, {64, 64}}, 0};
    XrCompositionLayerProjectionView drawn[2];
    for (int i = 0; i < 2; ++i) {
      drawn_.push_back({frame, i == 0 ? "left_eye" : "right_eye", state.viewStateFlags,
                        views[i].pose, XrSpaceVelocity{}});
      drawn[i] = {XR_TYPE_COMPOSITION_LAYER_PROJECTION_VIEW, nullptr, views[i].pose, views[i].fov,
                  image};
    }
    const XrCompositionLayerProjection eyes{
        XR_TYPE_COMPOSITION_LAYER_PROJECTION, nullptr, 0, local_, 2, drawn};
    const XrCompositionLayerQuad sign{
        XR_TYPE_COMPOSITION_LAYER_QUAD, nullptr, 0, shelf_, XR_EYE_VISIBILITY_BOTH, image,
        {{0, 0, 0, 1}, {0.5f, 1, -3}},  {1, 1}};
    XrCompositionLayerQuad visor = sign;
    visor.space = view_;
    const XrCompositionLayerBaseHeader* layers[] = {
        reinterpret_cast<const XrCompositionLayerBaseHeader*>(&eyes),
        reinterpret_cast<const XrCompositionLayerBaseHeader*>(&sign),
        reinterpret_cast<const XrCompositionLayerBaseHeader*>(&visor)};
    const XrFrameEndInfo end{XR_TYPE_FRAME_END_INFO,           nullptr, time,
                             XR_ENVIRONMENT_BLEND_MODE_OPAQUE, 3,       layers};
    REQUIRE(xrEndFrame(session_, &end));
  }

  void finish() {
    if (drawing_.joinable()) drawing_.join();
  }

  void stop() {
    if (!running_) return;
    finish();
    if (pending_ != 0) draw(frame_, pending_);
    pending_ = 0;
    if (stage_ != XR_NULL_HANDLE) {
      XrExtent2Df bounds;
      const XrResult result =
          xrGetReferenceSpaceBoundsRect(session_, XR_REFERENCE_SPACE_TYPE_STAGE, &bounds);
      std::printf("bounds after %d: %d %g %g\n", number_, static_cast<int>(result),
                  static_cast<double>(bounds.width), static_cast<double>(bounds.height));
    }
    if (options_.frames == 1 << 30) REQUIRE(xrEndSession(session_));
    running_ = false;
  }

  const Options& options_;
  const int number_;
  XrInstance instance_;
  XrSession session_ = XR_NULL_HANDLE;
  XrSpace view_ = XR_NULL_HANDLE, local_ = XR_NULL_HANDLE, shelf_ = XR_NULL_HANDLE,
          stage_ = XR_NULL_HANDLE, hand_ = XR_NULL_HANDLE;
  XrSwapchain picture_ = XR_NULL_HANDLE;
  XrHandTrackerEXT tracker_ = XR_NULL_HANDLE;
  PFN_xrLocateHandJointsEXT locateJoints_ = nullptr;
  PFN_xrDestroyHandTrackerEXT destroyTracker_ = nullptr;
  LocateSpacesFunction locateSpaces_ = nullptr;
  bool running_ = false, done_ = false;
  int frame_ = -1;
  XrTime pending_ = 0;  // begun, not yet drawn
  std::thread drawing_;
  std::vector<double> microseconds_;
  std::vector<Line> lines_, drawn_;  // of the first thread, of who draws
};

Options parse(int argc, char** argv) {
  Options options;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    const auto number = [&] { return i + 1 < argc ? std::atoi(argv[++i]) : 0; };
    if (word == "--sessions") {
      options.sessions = number();
    } else if (word == "--frames") {
      options.frames = number();
    } else if (word == "--threads") {
      options.threads = true;
    } else if (word == "--no-stage") {
      options.stage = false;
    } else if (word == "--mistake") {
      options.mistake = true;
    } else {
      options.out = word;
    }
  }
  return options;
}

void pollEvents(XrInstance instance, std::vector<Application>& applications) {
  for (;;) {
    XrEventDataBuffer event{};
    event.type = XR_TYPE_EVENT_DATA_BUFFER;
    if (xrPollEvent(instance, &event) != XR_SUCCESS) return;
    for (Application& application : applications) {
      if (event.type == XR_TYPE_EVENT_DATA_SESSION_STATE_CHANGED) {
        const auto& changed = *reinterpret_cast<XrEventDataSessionStateChanged*>(&event);
        if (changed.session == application.session()) application.stateChanged(changed.state);
      } else if (event.type == XR_TYPE_EVENT_DATA_REFERENCE_SPACE_CHANGE_PENDING) {
        const auto& moved = *reinterpret_cast<XrEventDataReferenceSpaceChangePending*>(&event);
        if (moved.session == application.session()) application.moved(moved);
      }
    }
  }
}

}  // namespace

int main(int argc, char** argv) {
  const Options options = parse(argc, argv);
  XrInstanceCreateInfo info{XR_TYPE_INSTANCE_CREATE_INFO, nullptr, 0, {}, 0, nullptr, 0, nullptr};
  std::strcpy(info.applicationInfo.applicationName, "walk client");
  info.applicationInfo.apiVersion = XR_MAKE_VERSION(1, 0, 0);
  const char* extensions[] = {XR_MND_HEADLESS_EXTENSION_NAME, XR_EXT_HAND_TRACKING_EXTENSION_NAME};
  info.enabledExtensionCount = 2;
  info.enabledExtensionNames = extensions;
  XrInstance instance;
  REQUIRE(xrCreateInstance(&info, &instance));

  std::vector<Application> applications;
  applications.reserve(static_cast<std::size_t>(options.sessions));
  for (int i = 0; i < options.sessions; ++i) applications.emplace_back(instance, options, i);
  if (options.mistake) {
    XrReferenceSpaceCreateInfo wrong{XR_TYPE_SESSION_CREATE_INFO, nullptr,
                                     XR_REFERENCE_SPACE_TYPE_LOCAL, kIdentity};
    XrSpace space;
    xrCreateReferenceSpace(applications.front().session(), &wrong, &space);
  }
  for (bool any = true; any;) {
    pollEvents(instance, applications);
    any = false;
    for (Application& application : applications) {
      if (application.done()) continue;
      any = true;
      if (application.running()) application.frame();
    }
  }
  std::FILE* out = std::fopen(options.out.c_str(), "w");
  if (out == nullptr) return std::perror(options.out.c_str()), 1;
  for (Application& application : applications) {
    std::printf("frame: %.1f %.1f us\n", application.microseconds(0.5),
                application.microseconds(0.99));
    application.write(out);
    application.close();
  }
  std::fclose(out);
  REQUIRE(xrDestroyInstance(instance));
  return 0;
}
