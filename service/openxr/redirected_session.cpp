#include "service/openxr/redirected_session.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "rdw/frame_flags.h"
#include "service/openxr/log.h"

namespace forewalk::openxr {
namespace {

constexpr XrSpaceLocationFlags kPlaced =
    XR_SPACE_LOCATION_POSITION_VALID_BIT | XR_SPACE_LOCATION_ORIENTATION_VALID_BIT;

rdw::HeadPose headOf(const XrPosef& pose) {
  const XrVector3f& p = pose.position;
  const XrQuaternionf& q = pose.orientation;
  return {{p.x, p.y, p.z}, {q.w, q.x, q.y, q.z}};
}

}  // namespace

std::unique_ptr<RedirectedSession> RedirectedSession::make(const Next& next,
                                                           const LayerConfig& config,
                                                           XrSession session) {
  std::unique_ptr<RedirectedSession> made(new RedirectedSession(next, config, session));
  if (!made->makeSpaces()) {
    say("the runtime has no space to follow the head in; its poses are passed on unchanged.");
    return nullptr;
  }
  return made;
}

RedirectedSession::~RedirectedSession() {
  for (const XrSpace space : {view_, local_, tracking_}) {
    if (space != XR_NULL_HANDLE) next_.destroySpace(space);
  }
}

XrSpace RedirectedSession::makeSpace(XrReferenceSpaceType type, const Rigid& pose) const {
  XrReferenceSpaceCreateInfo info{XR_TYPE_REFERENCE_SPACE_CREATE_INFO, nullptr, type, poseOf(pose)};
  XrSpace space = XR_NULL_HANDLE;
  if (XR_FAILED(next_.createReferenceSpace(xrSession_, &info, &space))) return XR_NULL_HANDLE;
  return space;
}

bool RedirectedSession::makeSpaces() {
  view_ = makeSpace(XR_REFERENCE_SPACE_TYPE_VIEW, {});
  local_ = makeSpace(XR_REFERENCE_SPACE_TYPE_LOCAL, {});
  std::uint32_t count = 0;
  std::vector<XrReferenceSpaceType> types;
  if (XR_SUCCEEDED(next_.enumerateReferenceSpaces(xrSession_, 0, &count, nullptr))) {
    types.resize(count);
    if (XR_FAILED(next_.enumerateReferenceSpaces(xrSession_, count, &count, types.data()))) {
      count = 0;
    }
    types.resize(count);
  }
  if (std::find(types.begin(), types.end(), XR_REFERENCE_SPACE_TYPE_STAGE) != types.end()) {
    tracking_ = makeSpace(XR_REFERENCE_SPACE_TYPE_STAGE, {});
  } else {
    trackingKind_ = Kind::kLocal;
    tracking0_.move.y = -config_.eyeHeight;
    tracking_ = makeSpace(XR_REFERENCE_SPACE_TYPE_LOCAL, tracking0_);
  }
  return view_ != XR_NULL_HANDLE && local_ != XR_NULL_HANDLE && tracking_ != XR_NULL_HANDLE;
}

std::optional<rdw::TrackedSpace> RedirectedSession::room() const {
  if (!config_.stageRoom) return config_.session.space;
  XrExtent2Df size{};
  const XrResult result =
      next_.getReferenceSpaceBoundsRect(xrSession_, XR_REFERENCE_SPACE_TYPE_STAGE, &size);
  if (result != XR_SUCCESS) {
    say(
        fmt::format("{}: space is \"stage\", but the runtime knows no bounds of its STAGE; give "
                    "the free floor, for example {{\"rectangle\": [4, 4]}}. Poses are passed on "
                    "unchanged.",
                    config_.file.string()));
    return std::nullopt;
  }
  auto space = rdw::TrackedSpace::rectangle(static_cast<double>(size.width),
                                            static_cast<double>(size.height));
  if (space) return std::move(*space);
  say(fmt::format("the runtime's STAGE: {} Poses are passed on unchanged.", space.error().message));
  return std::nullopt;
}

void RedirectedSession::begin() {
  const std::lock_guard lock(stepMutex_);
  if (begun_) return;
  begun_ = true;
  auto space = room();
  if (!space) return;
  rdw::SessionSettings settings = config_.session;
  settings.space = std::move(*space);
  auto session = rdw::Session::make(config_.world, std::move(settings));
  if (!session) return giveUp(session.error().message);
  session_ = std::make_unique<rdw::Session>(std::move(*session));
  const rdw::SessionSettings& made = session_->settings();
  say(fmt::format("redirecting in {}: controller {}, horizon {:g} m, {:.1f} m^2 of free floor{}.",
                  config_.scene, made.controller, made.horizon, made.space.area(),
                  config_.stageRoom ? " by the runtime's STAGE" : ""));
}

void RedirectedSession::giveUp(const std::string& why) {
  session_.reset();
  say(fmt::format("{}: {} Poses are passed on unchanged.", config_.file.string(), why));
}

bool RedirectedSession::redirects() const {
  const std::lock_guard lock(stepMutex_);
  return session_ != nullptr;
}

std::optional<XrPosef> RedirectedSession::locatedPose(XrSpace space, XrTime time) const {
  XrSpaceLocation location{XR_TYPE_SPACE_LOCATION, nullptr, 0, {}};
  if (XR_FAILED(next_.locateSpace(space, tracking_, time, &location))) return std::nullopt;
  if ((location.locationFlags & kPlaced) != kPlaced) return std::nullopt;
  return location.pose;
}

std::optional<Rigid> RedirectedSession::located(XrSpace space, XrTime time) const {
  const auto pose = locatedPose(space, time);
  return pose ? std::optional(rigidOf(*pose)) : std::nullopt;
}

void RedirectedSession::frame(XrTime time) {
  const std::lock_guard lock(stepMutex_);
  if (session_ == nullptr) return;
  const auto pose = locatedPose(view_, time);
  if (!pose) return;  // who is lost goes on under the last map
  const Rigid head = rigidOf(*pose);
  if (!placed_) {
    if (!placeAtFirst(head, time)) return;
    placed_ = true;
    firstTime_ = time;
    changes_.clear();  // the world begins with the spaces as they are now
  }
  applyChanges(head, time);
  // Differences of times alone count; in seconds since the first a double keeps the nanoseconds.
  const XrPosef physical = moved_ == Rigid{} ? *pose : poseOf(moved_ * head);
  tell(session_->frame(headOf(physical), static_cast<double>(time - firstTime_) * 1e-9));
  publish(time);
}

/// Pose of the origin that the scene is tied to.
std::optional<Rigid> RedirectedSession::originInTracking(XrTime time) const {
  const Kind kind = config_.originSpace == OriginSpace::kStage ? Kind::kStage : Kind::kLocal;
  if (kind == trackingKind_) return inverse(tracking0_);
  if (kind == Kind::kStage) return Rigid{};  // there is none: the floor under LOCAL stands for it
  return located(local_, time);
}

/// At first the application's world is the tracking space, as without us. A walk whose start is
/// given takes the user there; any other begins where the application has them.
bool RedirectedSession::placeAtFirst(const Rigid& head, XrTime time) {
  const auto origin = originInTracking(time);
  if (!origin) return false;
  scene_ = config_.origin * inverse(*origin);
  if (config_.session.start || scene_ == Rigid{}) return true;
  const auto foot = teleport(scene_, head);
  if (!foot) return true;
  giveUp(
      fmt::format("origin puts the user at ({:.2f}, {:.2f}, {:.2f}) in {}, where there is no "
                  "walkable floor within 0.5 m; give another origin, or a start.",
                  foot->x, foot->y, foot->z, config_.scene));
  return false;
}

/// The user's next frame is where `toScene` has them; else the place, where there is no floor.
std::optional<glm::dvec3> RedirectedSession::teleport(const Rigid& toScene, const Rigid& head) {
  const Rigid foot = toScene * Rigid{head.turn, {head.move.x, 0.0, head.move.z}};
  const auto heading = static_cast<float>(rdw::headingOf(glm::quat(foot.turn)));
  if (session_->teleport({glm::vec3(foot.move), heading})) return std::nullopt;
  return foot.move;
}

void RedirectedSession::applyChanges(const Rigid& head, XrTime time) {
  for (auto change = changes_.begin(); change != changes_.end();) {
    if (change->time > time) {
      ++change;
      continue;
    }
    // Whoever recentres wants the space's origin where they are now, in what they see.
    fixed_[static_cast<std::size_t>(change->kind)] =
        inverse(scene_) * rigidOf(session_->redirection());
    if (change->kind == trackingKind_ && change->move) {
      moved_ = moved_ * inverse(tracking0_) * *change->move * tracking0_;
    }
    const Kind origin = config_.originSpace == OriginSpace::kStage ? Kind::kStage : Kind::kLocal;
    if (change->kind == origin) moveOrigin(head, time);
    change = changes_.erase(change);
  }
}

/// The application draws the scene where the space's origin is now: the user is elsewhere in it.
void RedirectedSession::moveOrigin(const Rigid& head, XrTime time) {
  const auto origin = originInTracking(time);
  if (!origin) return;
  const Kind kind = config_.originSpace == OriginSpace::kStage ? Kind::kStage : Kind::kLocal;
  const Rigid inWorld = fixed_[static_cast<std::size_t>(kind)] * moved_ * *origin;
  const Rigid scene = config_.origin * inverse(inWorld);
  const Rigid body = inverse(scene_) * rigidOf(session_->redirection()) * moved_;
  if (teleport(scene * body, head)) {
    say(
        fmt::format("the user has recentred to where {} has no walkable floor; the walk goes on "
                    "as if they had not.",
                    config_.scene));
    return;
  }
  scene_ = scene;
  say("the user has recentred, and walks on from another place of the scene.");
}

void RedirectedSession::publish(XrTime time) {
  WorldMaps maps;
  maps.time = time;
  for (std::size_t kind = 0; kind < kKinds; ++kind) maps.of[kind] = fixed_[kind] * moved_;
  maps[Kind::kBody] = inverse(scene_) * rigidOf(session_->redirection()) * moved_;
  const rdw::ResetState& reset = session_->result().reset;
  maps.signal = reset.turning || reset.instruction != rdw::ResetInstruction::kNone;
  history_.add(maps);
}

void RedirectedSession::tell(const rdw::FrameResult& result) {
  if (result.resetBegan) say(fmt::format("reset {} begins.", result.resetCount));
  if (inReset_ && !result.reset.turning) say(fmt::format("reset {} is done.", result.resetCount));
  inReset_ = result.reset.turning;
  const bool off = (result.flags & rdw::kOffNavMesh) != 0;
  if (off && !offFloor_) {
    say(
        fmt::format("the user is off the walkable floor of {}: is origin where the application "
                    "has its own?",
                    config_.scene));
  }
  offFloor_ = off;
}

void RedirectedSession::noteChange(XrEventDataReferenceSpaceChangePending& event) {
  const Kind kind = kindOf(event.referenceSpaceType);
  if (kind == Kind::kBody) return;
  const std::lock_guard lock(stepMutex_);
  if (session_ == nullptr || !placed_) return;
  Change change{kind, event.changeTime, std::nullopt};
  if (event.poseValid == XR_TRUE) {
    change.move = rigidOf(event.poseInPreviousSpace);
    const Rigid body = inverse(scene_) * rigidOf(session_->redirection()) * moved_;
    const Rigid before = fixed_[static_cast<std::size_t>(kind)] * moved_;
    std::optional<Rigid> old;
    if (kind == trackingKind_) {
      old = inverse(tracking0_);
    } else if (kind == Kind::kLocal) {
      old = located(local_, event.changeTime - 1);
    }
    if (!old) {
      event.poseValid = XR_FALSE;
    } else if (body != before) {
      event.poseInPreviousSpace = poseOf(inverse(before * *old) * body * *old * *change.move);
    }
  }
  changes_.push_back(std::move(change));
}

AppSpace RedirectedSession::describe(XrSpace handle, const XrReferenceSpaceCreateInfo& info) const {
  AppSpace space{handle, kindOf(info.referenceSpaceType), std::nullopt};
  if (space.kind == trackingKind_) {
    space.inTracking = inverse(tracking0_) * rigidOf(info.poseInReferenceSpace);
  }
  return space;
}

std::optional<Rigid> RedirectedSession::inTracking(const AppSpace& space, XrTime time) const {
  if (space.inTracking) return space.inTracking;
  const auto pose = located(space.handle, time);
  const std::lock_guard lock(lastMutex_);
  const auto last = std::find_if(last_.begin(), last_.end(), [&](const LastPlace& place) {
    return place.space == space.handle;
  });
  if (!pose) return last == last_.end() ? std::nullopt : std::optional(last->pose);
  if (last == last_.end()) {
    last_.push_back({space.handle, *pose});
  } else {
    last->pose = *pose;
  }
  return pose;
}

std::optional<Rigid> RedirectedSession::bodyCorrection(const AppSpace& base, XrTime time) const {
  const auto maps = history_.at(time);
  if (!maps || (*maps)[Kind::kBody] == (*maps)[base.kind]) return std::nullopt;
  const auto at = inTracking(base, time);
  if (!at) return std::nullopt;
  return inverse((*maps)[base.kind] * *at) * (*maps)[Kind::kBody] * *at;
}

void RedirectedSession::forget(XrSpace space) {
  const std::lock_guard lock(lastMutex_);
  std::erase_if(last_, [&](const LastPlace& place) { return place.space == space; });
}

std::optional<Correction> RedirectedSession::correction(const AppSpace& of, const AppSpace& base,
                                                        XrTime time) const {
  const auto maps = history_.at(time);
  if (!maps || (*maps)[of.kind] == (*maps)[base.kind]) return std::nullopt;
  // The same answer from whichever of the two is fixed, and so can be located in the tracking space
  // even while the body is lost.
  const bool turnsBase = base.kind == Kind::kBody;
  const auto at = inTracking(turnsBase ? of : base, time);
  if (!at) return std::nullopt;
  Correction correction;
  correction.turnsBase = turnsBase;
  if (turnsBase) {
    correction.after = inverse(*at) * inverse((*maps)[base.kind]) * (*maps)[of.kind] * *at;
  } else {
    correction.before = inverse((*maps)[base.kind] * *at) * (*maps)[of.kind] * *at;
  }
  return correction;
}

bool RedirectedSession::signals(XrTime time) const {
  const auto maps = history_.at(time);
  return maps && maps->signal;
}

}  // namespace forewalk::openxr
