#include "rdw/session.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <utility>

namespace forewalk::rdw {

namespace {

// Somebody put at a floor stands on it, or within a step of it.
constexpr navmesh::SnapLimits kFloorSnap{0.5f, 0.5f, 0.5f};

// Rebuilt ground may have its border elsewhere by so much for no reason, metres: whoever stands at
// a wall has not lost it.
constexpr float kSameGround = 0.05f;

// Somebody further from any ground of their storey is nowhere, metres.
constexpr float kFarthestGround = 64.0f;

constexpr float kLongestPersistence = 100.0f;  // metres

// Fronts need two or three windows for a polygon of a building.
prediction::DistanceLimits distanceLimits(const navmesh::World& world,
                                          const prediction::PredictionLimits& limits) {
  const std::uint64_t polygons = std::min(limits.polygons, world.graph.polygonCount());
  return {.windows =
              static_cast<std::uint32_t>(std::min<std::uint64_t>(8 * polygons + 64, 1u << 28))};
}

}  // namespace

std::shared_ptr<const prediction::FrontIndex> makeFrontIndex(const navmesh::World& world,
                                                             const navmesh::PolygonStates* states) {
  return std::make_shared<const prediction::FrontIndex>(
      prediction::makeFrontIndex(world.graph, states));
}

PreparedWorld prepareWorld(std::shared_ptr<const navmesh::World> world,
                           const prediction::PredictionLimits& limits, prediction::Method method,
                           std::shared_ptr<const prediction::FrontIndex> frontIndex,
                           std::shared_ptr<const navmesh::PolygonStates> states) {
  assert(world != nullptr);
  PreparedWorld prepared;
  if (method == prediction::Method::kFront) {
    if (frontIndex == nullptr) frontIndex = makeFrontIndex(*world, states.get());
    prepared.frontScratch = std::make_unique<prediction::FrontScratch>(
        world->graph, *frontIndex, distanceLimits(*world, limits));
    prepared.frontIndex = std::move(frontIndex);
  } else {
    prepared.scratch = std::make_unique<prediction::Scratch>(world->graph, limits);
  }
  prepared.world = std::move(world);
  prepared.states = std::move(states);
  return prepared;
}

Session::Session(std::shared_ptr<const navmesh::World> world, SessionSettings settings,
                 std::unique_ptr<Controller> controller, std::unique_ptr<ResetPolicy> policy)
    : world_(std::move(world)),
      settings_(std::move(settings)),
      controller_(std::move(controller)),
      policy_(std::move(policy)),
      tracker_(settings_.motion),
      reset_(settings_.reset),
      hold_(settings_.sideHold),
      chest_(std::numeric_limits<double>::quiet_NaN()),
      gaze_(chest_) {
  others_.reserve(kMostOthers);
  PreparedWorld prepared = prepareWorld(world_, settings_.prediction, settings_.method,
                                        std::exchange(settings_.frontIndex, nullptr),
                                        std::exchange(settings_.states, nullptr));
  scratch_ = std::move(prepared.scratch);
  frontIndex_ = std::move(prepared.frontIndex);
  frontScratch_ = std::move(prepared.frontScratch);
  states_ = std::move(prepared.states);
  if (settings_.alwaysLikely || controller_->wantsLikelihoods() || policy_->wantsLikelihoods()) {
    likelihood_ = std::make_unique<prediction::WayLikelihood>(settings_.likelihood);
  }
}

Session::Session(Session&&) noexcept = default;
Session& Session::operator=(Session&&) noexcept = default;
Session::~Session() = default;

tl::expected<Session, Error> Session::make(std::shared_ptr<const navmesh::World> world,
                                           SessionSettings settings) {
  assert(world != nullptr);
  if (auto ok = validate(settings.limits); !ok) return tl::unexpected(ok.error());
  tl::expected<std::unique_ptr<Controller>, Error> controller =
      settings.makeController ? settings.makeController()
                              : rdw::makeController(settings.controller);
  if (!controller) return tl::unexpected(controller.error());
  tl::expected<std::unique_ptr<ResetPolicy>, Error> policy =
      settings.makeReset ? settings.makeReset() : rdw::makeReset(settings.resetPolicy);
  if (!policy) return tl::unexpected(policy.error());
  const auto outOfRange = [](std::string message) {
    return tl::unexpected(Error{ErrorCode::kSettingOutOfRange, std::move(message)});
  };
  if (!(settings.horizon > 0.0f && settings.horizon <= 1000.0f)) {
    return outOfRange(
        fmt::format("session: a horizon of {} m cannot work: give more than 0 and at most 1000 m.",
                    settings.horizon));
  }
  const MotionSettings& motion = settings.motion;
  if (!(motion.timeConstant > 0.0 && motion.walkingStops >= 0.0 &&
        motion.walkingStarts >= motion.walkingStops && motion.jumpDistance > 0.0 &&
        motion.longestFrame > 0.0)) {
    return outOfRange(
        fmt::format("session: motion settings (time constant {} s, walking from {} to {} m/s, jump "
                    "{} m, longest frame {} s) must be "
                    "positive, and walking must stop below where it starts.",
                    motion.timeConstant, motion.walkingStops, motion.walkingStarts,
                    motion.jumpDistance, motion.longestFrame));
  }
  const ResetSettings& reset = settings.reset;
  if (!(reset.reactionTime >= 0.0 && reset.deceleration > 0.0 && reset.clearance >= 0.0 &&
        reset.warningTime >= 0.0)) {
    return outOfRange(
        fmt::format("session: reset settings (reaction {} s, deceleration {} m/s^2, clearance {} "
                    "m, warning {} s) must not be "
                    "negative, and the deceleration must be above 0.",
                    reset.reactionTime, reset.deceleration, reset.clearance, reset.warningTime));
  }
  if (!(settings.sideHold >= 0.0)) {
    return outOfRange(fmt::format(
        "session: {} s between changes of the steering's side cannot work: give 0 or more.",
        settings.sideHold));
  }
  if (!(settings.front.persistence >= 0.0f && settings.front.persistence <= kLongestPersistence)) {
    return outOfRange(fmt::format(
        "session: a persistence of {} m cannot work: give 0 to {:g} m; 0.75 m leaves niches out.",
        settings.front.persistence, kLongestPersistence));
  }
  if (settings.prediction.polygons < 1)
    return outOfRange("session: a limit of 0 predicted polygons cannot work: give 1 or more.");

  (*controller)->prepare(settings.space, settings.limits);
  (*policy)->prepare(settings.space, settings.limits);
  const std::optional<VirtualStart> start = settings.start;
  Session session(std::move(world), std::move(settings), std::move(*controller),
                  std::move(*policy));
  if (start && !session.teleport(*start)) {
    return tl::unexpected(Error{ErrorCode::kPositionOffNavMesh,
                                fmt::format("session: the start ({}, {}, {}) heading {} rad is not "
                                            "within {} m of a walkable floor.",
                                            start->floor.x, start->floor.y, start->floor.z,
                                            start->heading, kFloorSnap.distance)});
  }
  return session;
}

bool Session::teleport(const VirtualStart& to) {
  if (!std::isfinite(to.heading)) return false;
  const auto place = navmesh::locate(world_->graph, world_->locations, to.floor, kFloorSnap);
  if (!place) return false;
  location_ = *place;
  pending_ = PlanarPose{glm::dvec2(place->plan), wrapAngle(static_cast<double>(to.heading))};
  groundTaken_ = false;
  controller_->restart();
  if (likelihood_ != nullptr) likelihood_->restart();
  return true;
}

SessionState Session::state() const {
  return {redirector_.redirection(), physical_, location_, tracker_.memory(), reset_.memory()};
}

bool Session::resume(const SessionState& state) {
  const Redirection& map = state.redirection;
  const MotionTracker::Memory& motion = state.motion;
  const ResetPlan& plan = state.reset.plan;
  // What frames can have led to, generously: heads are within 1000 km of the origin.
  constexpr double kFarthest = 1e7, kWidest = 7.0, kMostSeen = 100.0;
  for (const double length :
       {map.offset.x, map.offset.y, map.height, motion.position.x, motion.position.y,
        motion.velocity.x, motion.velocity.y, plan.back, state.reset.state.back}) {
    if (!(std::abs(length) <= kFarthest)) return false;
  }
  for (const double angle :
       {map.yaw, motion.heading, state.reset.state.progress, state.reset.state.remaining}) {
    if (!(std::abs(angle) <= kWidest)) return false;
  }
  for (const double angle : {plan.left, plan.right}) {
    if (!(angle >= 0.0 && (angle <= kWidest || angle == ResetPlan::kNever))) return false;
  }
  if (!(std::min(plan.left, plan.right) <= kWidest && std::abs(plan.seen) <= kMostSeen)) {
    return false;
  }
  const double backward = state.reset.backward;
  if (!(std::isnan(backward) || std::abs(backward) <= kWidest)) return false;
  if (!std::isfinite(motion.seconds)) return false;
  std::uint32_t flags = kFrameSound;
  const HeadPose physical = cleaned(state.physical, HeadPose{}, flags);
  if (flags != kFrameSound) return false;
  navmesh::Location place = state.location;
  if (place.polygon != navmesh::kNoPolygon) {
    if (static_cast<std::uint32_t>(place.polygon) >= world_->graph.polygonCount()) return false;
    // On a border several polygons would do: the one it was goes on to the bit.
    const auto found =
        navmesh::locateFrom(world_->graph, world_->locations, place, place.position(), kFloorSnap);
    if (!found) return false;
    if (found->polygon != place.polygon) place = *found;
  }
  location_ = place;
  pending_.reset();
  groundTaken_ = false;
  physical_ = physical;
  redirector_.align(map);
  tracker_.resume(motion);
  reset_.resume(state.reset);
  resetGain_ = state.reset.state.gain;
  hold_.restart();
  controller_->restart();
  if (likelihood_ != nullptr) likelihood_->restart();
  return true;
}

void Session::enter(PreparedWorld& next) {
  assert(next.world != nullptr && (next.scratch != nullptr) == (scratch_ != nullptr) &&
         (next.frontScratch != nullptr) == (frontScratch_ != nullptr));
  std::swap(world_, next.world);
  std::swap(scratch_, next.scratch);
  std::swap(frontIndex_, next.frontIndex);
  std::swap(frontScratch_, next.frontScratch);
  std::swap(states_, next.states);
  result_.graph = nullptr;
  graph_ = nullptr;
  result_.likelihoods = {};
  if (location_.polygon == navmesh::kNoPolygon) return;
  // From where the user stood on the old ground: heads and walls beside it are the frame's matter.
  const auto place = nearestGround(location_.position());
  if (place) {
    groundTaken_ = groundTaken_ || glm::distance(place->plan, location_.plan) > kSameGround;
    location_ = *place;
  } else {
    groundTaken_ = true;
    location_.polygon = navmesh::kNoPolygon;
  }
  result_.location = location_;
}

void Session::setStates(std::shared_ptr<const navmesh::PolygonStates>& next) {
  assert(frontScratch_ == nullptr);
  assert(next == nullptr || next->allOpen() || next->cost.size() == world_->graph.polygonCount());
  std::swap(states_, next);
  graph_ = nullptr;
}

// Doubled again and again, because a search costs what lies within its distance.
std::optional<navmesh::Location> Session::nearestGround(glm::vec3 feet) const {
  navmesh::SnapLimits limits = settings_.snap;
  for (limits.distance = 0.5f; limits.distance <= kFarthestGround; limits.distance *= 2.0f) {
    if (const auto place = navmesh::locate(world_->graph, world_->locations, feet, limits)) {
      return place;
    }
  }
  return std::nullopt;
}

void Session::locate(const HeadPose& physical, double seconds) {
  result_.flags = kFrameSound;
  physical_ = cleaned(physical, physical_, result_.flags);
  result_.motion = tracker_.frame(physical_, seconds);
  result_.flags |= result_.motion.flags;
  result_.physical = planarPose(physical_);
  if (pending_) {
    redirector_.align(
        alignment(result_.physical, *pending_, static_cast<double>(location_.height)));
    pending_.reset();
  }
  result_.virtualPlan = redirector_.redirection().toVirtual(result_.physical);
  placeOnFloor();
}

void Session::placeOnFloor() {
  const navmesh::World& world = *world_;
  std::optional<navmesh::Location> place;
  const glm::vec2 plan(result_.virtualPlan.position);
  if (location_.polygon == navmesh::kNoPolygon) {
    // Nowhere yet: the floor under the head.
    const Redirection& map = redirector_.redirection();
    const float head = static_cast<float>(static_cast<double>(physical_.position.y) + map.height);
    place = navmesh::locate(world.graph, world.locations, navmesh::toSpace(plan, head));
  } else {
    place = navmesh::locateFrom(world.graph, world.locations, location_,
                                navmesh::toSpace(plan, location_.height), settings_.snap);
  }
  if (groundTaken_) {
    if (!place) place = nearestGround(navmesh::toSpace(plan, location_.height));
    groundTaken_ = !place || place->snapped;
    if (groundTaken_) result_.flags |= kGroundTaken;
  }
  if (!place) {
    result_.flags |= kOffNavMesh;
  } else {
    location_ = *place;
    if (place->snapped) result_.flags |= kSnapped;
    redirector_.setHeight(static_cast<double>(place->height));
  }
  result_.location = location_;
}

void Session::predict() {
  result_.graph = nullptr;
  result_.likelihoods = {};
  if (settings_.openPlane) return;
  if (!settings_.alwaysPredict && !controller_->wantsPrediction() && !policy_->wantsPrediction())
    return;
  const bool moved =
      location_.polygon != graphSource_.polygon || location_.plan != graphSource_.plan ||
      location_.height != graphSource_.height || location_.snapped != graphSource_.snapped;
  if (graph_ == nullptr || moved) {
    graph_ = frontScratch_ != nullptr
                 ? &prediction::predictFronts(world_->graph, location_, settings_.horizon,
                                              *frontScratch_, settings_.front)
                 : &prediction::predict(world_->graph, location_, settings_.horizon, *scratch_,
                                        states_.get());
    graphSource_ = location_;
  }
  const prediction::PredictionGraph& graph = *graph_;
  if ((graph.flags & prediction::kPolygonLimit) != 0) result_.flags |= kGraphLimit;
  result_.graph = &graph;
  if (likelihood_ == nullptr) return;
  // Who is turned round by a reset looks everywhere and means nothing by it.
  prediction::Evidence evidence{result_.motion.dt, std::nullopt, std::nullopt};
  if (!reset_.state().turning) {
    evidence.head = directionOf(result_.virtualPlan.heading);
    if (std::isfinite(gaze_)) {
      evidence.gaze = directionOf(gaze_ + redirector_.redirection().yaw);
    }
  }
  likelihood_->update(graph, evidence);
  result_.likelihoods = {likelihood_->probabilities(), likelihood_->none()};
}

void Session::setOthers(std::span<const OtherUser> others) {
  const auto distance2 = [&](const OtherUser& other) {
    const glm::dvec2 to = other.position - result_.physical.position;
    return glm::dot(to, to);
  };
  others_.clear();
  for (const OtherUser& other : others) {
    if (!std::isfinite(distance2(other)) || !std::isfinite(glm::dot(other.velocity, other.facing)))
      continue;
    if (others_.size() < kMostOthers) {
      others_.push_back(other);
      continue;
    }
    const auto furthest = std::max_element(
        others_.begin(), others_.end(),
        [&](const OtherUser& a, const OtherUser& b) { return distance2(a) < distance2(b); });
    if (distance2(other) < distance2(*furthest)) *furthest = other;
  }
}

// Physical radians.
double Session::heading() const {
  const Motion& motion = result_.motion;
  if (settings_.heading == HeadingSource::kChest && std::isfinite(chest_)) return chest_;
  if (settings_.heading == HeadingSource::kWalking && motion.walking)
    return headingOf(motion.walkingDirection);
  return result_.physical.heading;
}

const FrameResult& Session::steer() {
  const Motion& motion = result_.motion;
  const PlanarPose physical{result_.physical.position, heading()};
  const PlanarPose seen{result_.virtualPlan.position,
                        settings_.heading == HeadingSource::kHead
                            ? result_.virtualPlan.heading
                            : wrapAngle(physical.heading + redirector_.redirection().yaw)};
  const SteerInput input{motion,
                         physical,
                         seen,
                         settings_.space,
                         settings_.limits,
                         redirector_.redirection(),
                         result_.graph,
                         result_.likelihoods,
                         others_,
                         world_.get(),
                         location_,
                         settings_.haptic ? &*settings_.haptic : nullptr};
  Reset::Step step;
  if (settings_.resets) step = reset_.frame(input, *policy_);
  result_.flags |= step.flags;
  result_.gains = Gains{};
  Applied applied;
  if (step.began || step.ended || reset_.state().turning) {
    if (step.began) {
      controller_->restart();
      hold_.restart();
    } else {
      result_.gains.rotation = static_cast<float>(resetGain_);
    }
    if (reset_.state().turning) resetGain_ = reset_.state().gain;
    applied = step.frozen ? redirector_.freezeWorld(physical_, step.yaw, motion.step)
                          : redirector_.turnWorld(physical_, step.yaw);
  } else {
    if (motion.usable()) {
      result_.gains = hold_.held(controller_->steer(input), motion);
    } else if ((motion.flags & kTimeStoodStill) == 0) {
      controller_->restart();
    }
    applied = redirector_.frame(motion, physical_, result_.gains);
  }
  result_.virtualPose = applied.virtualPose;
  result_.virtualPlan = redirector_.redirection().toVirtual(result_.physical);
  result_.injectedYaw = applied.injectedYaw;
  result_.injectedTranslation = applied.injectedTranslation;
  result_.reset = reset_.state();
  result_.resetCount = reset_.count();
  result_.resetBegan = step.began;
  return result_;
}

}  // namespace forewalk::rdw
