#include "agents/avatar_navigation.h"

#include <algorithm>
#include <cmath>

#include "navmesh/plan.h"
#include "navmesh/random.h"

namespace forewalk::agents {
namespace {

constexpr float kPi = 3.14159265358979f;
constexpr float kFastWithin = kPi / 10.0f;  // looks where it goes

CrowdSettings alone() {
  CrowdSettings settings;
  settings.symmetryBreak = 1e-3f;
  return settings;
}

}  // namespace

float stopDistance(float startDistance) { return std::max(0.5f, std::sqrt(startDistance)); }

float slowDistance(float startDistance) {
  return std::max(3.0f, stopDistance(startDistance) + 2.0f);
}

AvatarNavigation::AvatarNavigation(glm::vec2 start, const AvatarParameters& parameters,
                                   std::uint64_t seed)
    : parameters_(parameters), crowd_(alone()), rng_(seed) {
  AgentSpec spec;
  spec.position = start;
  spec.radius = parameters.radius;
  spec.preferredSpeed = parameters.preferredSpeed;
  spec.maximumSpeed = parameters.maximumSpeed;
  spec.model = crowd_.addModel(makeHrvo(parameters.model));
  self_ = *crowd_.add(spec);
}

AvatarNavigation::Object* AvatarNavigation::find(ObjectId id) {
  const auto at =
      std::lower_bound(objects_.begin(), objects_.end(), id,
                       [](const Object& object, ObjectId wanted) { return object.id < wanted; });
  return at != objects_.end() && at->id == id ? &*at : nullptr;
}

navmesh::BoxObstacle AvatarNavigation::grown(const Object& object) const {
  const glm::vec2 half = object.halfSize + parameters_.margin;
  return {navmesh::toSpace(object.centre, 1.0f), {half.x, 1.0f, half.y}, object.heading};
}

void AvatarNavigation::block(Object& object, bool blocks) {
  if (object.blocks) crowd_.removeObstacle(object.obstacle);
  object.blocks = false;
  if (!blocks) return;
  if (const auto id = crowd_.addObstacle(grown(object))) {
    object.obstacle = *id;
    object.blocks = true;
  }
}

tl::expected<void, Error> AvatarNavigation::setObject(ObjectId id, glm::vec2 centre,
                                                      glm::vec2 halfSize, float heading) {
  const Object placed{id, centre, halfSize, heading, navmesh::ObstacleId{}, false};
  if (auto valid = navmesh::validate(grown(placed)); !valid) return valid;
  Object* object = find(id);
  if (!object) {
    const auto at =
        std::lower_bound(objects_.begin(), objects_.end(), id,
                         [](const Object& other, ObjectId wanted) { return other.id < wanted; });
    object = &*objects_.insert(at, placed);
  } else {
    object->centre = centre;
    object->halfSize = halfSize;
    object->heading = heading;
  }
  block(*object, target_ != id);
  return {};
}

bool AvatarNavigation::removeObject(ObjectId id) {
  Object* object = find(id);
  if (!object) return false;
  block(*object, false);
  objects_.erase(objects_.begin() + (object - objects_.data()));
  if (target_ == id) {
    target_.reset();
    arrived_ = true;
  }
  return true;
}

bool AvatarNavigation::walkTo(ObjectId target) {
  Object* object = find(target);
  if (!object) return false;
  if (target_ && *target_ != target) {
    if (Object* old = find(*target_)) block(*old, true);
  }
  target_ = target;
  block(*object, false);
  startDistance_ = glm::distance(position(), object->centre);
  walking_ = 0.0f;
  arrived_ = false;
  return true;
}

AvatarMotion AvatarNavigation::step(float seconds, bool wander) {
  if (!(seconds > 0.0f)) return {heading_, 0.0f};
  if (wander && !objects_.empty() && (arrived_ || walking_ >= parameters_.retargetSeconds)) {
    walkTo(objects_[static_cast<std::size_t>(
                        navmesh::uniformInt(rng_, static_cast<int>(objects_.size())))]
               .id);
  }
  const Object* object = target_ ? find(*target_) : nullptr;
  if (!object || arrived_) return {heading_, 0.0f};
  walking_ += seconds;
  const glm::vec2 before = position();
  const float distance = glm::distance(before, object->centre);
  const float stop = stopDistance(startDistance_), slow = slowDistance(startDistance_);
  if (distance <= stop) {
    arrived_ = true;
    crowd_.clearGoal(self_);
    crowd_.place(self_, before, 0.0f, heading_, glm::vec2(0.0f));
    return {heading_, 0.0f};
  }
  // The model proposes, the autopilot walks: it turns at its own rate, and fast only where it
  // looks.
  crowd_.setGoal(self_, object->centre);
  crowd_.step(seconds);
  const glm::vec2 wanted = (position() - before) / seconds;
  const float wantedSpeed = glm::length(wanted);
  float speed = 0.0f;
  if (wantedSpeed > 1e-3f) {
    const float yaw = std::remainder(navmesh::headingOf(wanted) - heading_, 2.0f * kPi);
    const float turn =
        std::clamp(yaw, -parameters_.turnRate * seconds, parameters_.turnRate * seconds);
    heading_ = std::remainder(heading_ + turn, 2.0f * kPi);
    const bool looksThere = std::abs(yaw) < kFastWithin;
    speed = looksThere ? wantedSpeed
                       : std::min(wantedSpeed, parameters_.slowSpeed * parameters_.maximumSpeed);
    // Slower and slower from the slow distance on.
    if (distance < slow) speed *= std::max(0.2f, (distance - stop) / (slow - stop));
    // Only along what the model found free: while it still turns, it stays where it is.
    if (std::abs(std::remainder(navmesh::headingOf(wanted) - heading_, 2.0f * kPi)) > kFastWithin)
      speed = 0.0f;
  }
  const glm::vec2 velocity = wantedSpeed > 1e-3f ? wanted * (speed / wantedSpeed) : glm::vec2(0.0f);
  crowd_.place(self_, before + velocity * seconds, 0.0f, heading_, velocity);
  // As in the thesis: what was walked is what is preferred next; a body at rest starts anew.
  const float most =
      std::min(parameters_.maximumSpeed, speed + parameters_.maximumAcceleration * seconds);
  crowd_.setPreferredSpeed(self_, std::max(parameters_.preferredSpeed, most));
  return {heading_, speed};
}

}  // namespace forewalk::agents
