#include "agents/crowd.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>

namespace forewalk::agents {
namespace {

constexpr std::uint32_t kNowhere = 0xffffffffu;

std::uint32_t numberOf(ModelId model) { return static_cast<std::uint32_t>(model); }

tl::unexpected<Error> outOfRange(std::string message) {
  return tl::unexpected(Error{ErrorCode::kSettingOutOfRange, std::move(message)});
}

}  // namespace

Crowd::Crowd(CrowdSettings settings) : settings_(settings), navigation_(settings.navigation) {}

ModelId Crowd::addModel(std::unique_ptr<const Model> model) {
  OwnModel own;
  own.needs = model->needs();
  own.model = std::move(model);
  if (own.needs.memory > memoryStride_) {
    // Wider rows for all, each agent keeping what it had.
    std::vector<float> wider(id_.size() * own.needs.memory, 0.0f);
    for (std::size_t i = 0; i < id_.size(); ++i) {
      std::copy_n(memory_.begin() + static_cast<std::ptrdiff_t>(i * memoryStride_), memoryStride_,
                  wider.begin() + static_cast<std::ptrdiff_t>(i * own.needs.memory));
    }
    memory_ = std::move(wider);
    memoryStride_ = own.needs.memory;
  }
  models_.push_back(std::move(own));
  return static_cast<ModelId>(models_.size() - 1);
}

// Every array that has one entry an agent.
template <typename Visit>
void Crowd::forArrays(const Visit& visit) {
  visit(id_);
  visit(flags_);
  visit(group_);
  visit(position_);
  visit(velocity_);
  visit(heading_);
  visit(height_);
  visit(radius_);
  visit(preferredSpeed_);
  visit(maximumSpeed_);
  visit(maximumAcceleration_);
  visit(preferredVelocity_);
  visit(target_);
  visit(remaining_);
  visit(modelOf_);
  visit(goalRadius_);
  visit(plan_);
  visit(planAge_);
  visit(heldUp_);
}

tl::expected<AgentId, Error> Crowd::add(const AgentSpec& spec) {
  struct Number {
    const char* name;
    float value;
    bool inRange;
    const char* range;
  };
  const auto finite = [](float x) { return std::isfinite(x); };
  const Number numbers[] = {
      {"position.x", spec.position.x, finite(spec.position.x), "finite"},
      {"position.y", spec.position.y, finite(spec.position.y), "finite"},
      {"height", spec.height, finite(spec.height), "finite"},
      {"heading", spec.heading, finite(spec.heading), "finite"},
      {"velocity.x", spec.velocity.x, finite(spec.velocity.x), "finite"},
      {"velocity.y", spec.velocity.y, finite(spec.velocity.y), "finite"},
      {"radius", spec.radius, finite(spec.radius) && spec.radius > 0.0f, "above 0 m"},
      {"preferredSpeed", spec.preferredSpeed,
       finite(spec.preferredSpeed) && spec.preferredSpeed >= 0.0f, "0 m/s or more"},
      {"maximumSpeed", spec.maximumSpeed, finite(spec.maximumSpeed) && spec.maximumSpeed >= 0.0f,
       "0 m/s or more"},
      {"maximumAcceleration", spec.maximumAcceleration, spec.maximumAcceleration > 0.0f,
       "above 0 m/s^2; infinity for no limit"},
      {"goalRadius", spec.goalRadius, finite(spec.goalRadius) && spec.goalRadius >= 0.0f,
       "0 m or more"},
  };
  for (const Number& number : numbers) {
    if (number.inRange) continue;
    return outOfRange(
        fmt::format("agent {} is {}: it has to be {}.", number.name, number.value, number.range));
  }
  if (spec.model != kNoModel && numberOf(spec.model) >= models_.size()) {
    return outOfRange(fmt::format("agent model is {}, the crowd has {}. Add the model first.",
                                  numberOf(spec.model), models_.size()));
  }
  if (spec.model == kNoModel && spec.flags == 0) {
    return outOfRange(
        "an agent that avoids others has to have a model. Give one, or the flag passive.");
  }
  const AgentId id{static_cast<std::uint32_t>(indexOfId_.size())};
  indexOfId_.push_back(static_cast<std::uint32_t>(id_.size()));
  forArrays([](auto& array) { array.emplace_back(); });
  memory_.resize(memory_.size() + memoryStride_, 0.0f);
  navigation_.add();
  id_.back() = id;
  flags_.back() = spec.flags;
  group_.back() = spec.group;
  position_.back() = target_.back() = spec.position;
  velocity_.back() = spec.velocity;
  heading_.back() = spec.heading;
  height_.back() = spec.height;
  radius_.back() = spec.radius;
  preferredSpeed_.back() = spec.preferredSpeed;
  maximumSpeed_.back() = spec.maximumSpeed;
  maximumAcceleration_.back() = spec.maximumAcceleration;
  goalRadius_.back() = spec.goalRadius;
  modelOf_.back() = spec.model;
  planAge_.back() = std::numeric_limits<float>::infinity();
  return id;
}

bool Crowd::contains(AgentId agent) const {
  return number(agent) < indexOfId_.size() && indexOfId_[number(agent)] != kNowhere;
}

std::uint32_t Crowd::indexOf(AgentId agent) const { return indexOfId_[number(agent)]; }

bool Crowd::remove(AgentId agent) {
  if (!contains(agent)) return false;
  const std::uint32_t at = indexOf(agent);
  const std::size_t last = id_.size() - 1;
  indexOfId_[number(id_[last])] = at;
  indexOfId_[number(agent)] = kNowhere;
  forArrays([&](auto& array) {
    array[at] = array[last];
    array.pop_back();
  });
  std::copy_n(memory_.begin() + static_cast<std::ptrdiff_t>(last * memoryStride_), memoryStride_,
              memory_.begin() + static_cast<std::ptrdiff_t>(std::size_t{at} * memoryStride_));
  memory_.resize(last * memoryStride_);
  navigation_.removeBySwap(at);
  return true;
}

void Crowd::setGoal(AgentId agent, glm::vec2 goal, float height) {
  navigation_.setGoal(indexOf(agent), goal, height);
}

void Crowd::setWay(AgentId agent, std::span<const glm::vec2> corners, float beyond) {
  navigation_.setWay(indexOf(agent), corners, beyond);
}

void Crowd::clearGoal(AgentId agent) { navigation_.clearGoal(indexOf(agent)); }

bool Crowd::arrived(AgentId agent) const {
  const std::uint32_t i = indexOf(agent);
  const Route& route = navigation_.route(i);
  if (route.state == Route::State::none) return true;
  if (route.state == Route::State::closed) return false;
  // Of a goal beside the navmesh the nearest point of it counts: that is where the path ends.
  const glm::vec2 end =
      route.toTheGoal && route.count > 0 ? route.corners[route.count - 1u] : route.goal;
  return glm::distance(position_[i], end) <= goalRadius_[i] + 1e-4f;
}

void Crowd::place(AgentId agent, glm::vec2 position, float height, float heading,
                  glm::vec2 velocity) {
  const std::uint32_t i = indexOf(agent);
  position_[i] = position;
  height_[i] = height;
  heading_[i] = heading;
  velocity_[i] = velocity;
  navigation_.moved(i);
}

void Crowd::setModel(AgentId agent, ModelId model) {
  const std::uint32_t i = indexOf(agent);
  modelOf_[i] = model;
  planAge_[i] = std::numeric_limits<float>::infinity();
  std::fill_n(memory_.begin() + static_cast<std::ptrdiff_t>(std::size_t{i} * memoryStride_),
              memoryStride_, 0.0f);
}

void Crowd::setPreferredSpeed(AgentId agent, float metresPerSecond) {
  preferredSpeed_[indexOf(agent)] = metresPerSecond;
}

void Crowd::setFlags(AgentId agent, std::uint8_t flags) { flags_[indexOf(agent)] = flags; }

std::span<float> Crowd::memoryOf(AgentId agent) {
  const std::uint32_t i = indexOf(agent);
  const std::uint32_t size =
      modelOf_[i] == kNoModel ? 0 : models_[numberOf(modelOf_[i])].needs.memory;
  return {memory_.data() + std::size_t{i} * memoryStride_, size};
}

void Crowd::setFixedWalls(std::vector<Wall> walls) {
  fixedWalls_ = std::move(walls);
  layCells();
  wallsChanged_ = true;
}

void Crowd::setWorld(std::shared_ptr<const navmesh::World> world) {
  borderWalls_.clear();
  if (world) appendBorder(world->graph, settings_.navigation.walkerRadius, borderWalls_);
  navigation_.setWorld(std::move(world));
  layCells();
  wallsChanged_ = true;
}

void Crowd::layCells() {
  if (CellNavigation* cells = navigation_.cells()) {
    cells->ground().setGround(navigation_.world(), settings_.navigation.walkerRadius, fixedWalls_);
  }
}

tl::expected<void, Error> Crowd::setCells(const CellSettings& settings) {
  auto ground = GroundCells::make(settings);
  if (!ground) return tl::unexpected(std::move(ground.error()));
  for (const PlacedObstacle& placed : obstacles_) ground->setObject(placed.id, placed.shape);
  navigation_.setCells(std::move(*ground));
  layCells();
  return {};
}

void Crowd::setStates(std::shared_ptr<const navmesh::PolygonStates> states, bool doors) {
  if (!navigation_.world()) return;
  borderWalls_.clear();
  appendBorder(navigation_.world()->graph, settings_.navigation.walkerRadius, borderWalls_,
               doors ? states.get() : nullptr);
  navigation_.setStates(std::move(states));
  wallsChanged_ = true;
  std::fill(heldUp_.begin(), heldUp_.end(), 0.0f);  // a door may have opened
}

tl::expected<navmesh::ObstacleId, Error> Crowd::addObstacle(const navmesh::Obstacle& obstacle,
                                                            glm::vec2 velocity) {
  if (auto valid = navmesh::validate(obstacle); !valid) return tl::unexpected(valid.error());
  const navmesh::ObstacleId id{nextObstacle_++};
  obstacles_.push_back({id, obstacle, velocity});
  if (CellNavigation* cells = navigation_.cells()) cells->ground().setObject(id, obstacle);
  wallsChanged_ = true;
  return id;
}

tl::expected<void, Error> Crowd::moveObstacle(navmesh::ObstacleId id,
                                              const navmesh::Obstacle& obstacle,
                                              glm::vec2 velocity) {
  if (auto valid = navmesh::validate(obstacle); !valid) return valid;
  for (PlacedObstacle& placed : obstacles_) {
    if (placed.id != id) continue;
    placed.shape = obstacle;
    if (CellNavigation* cells = navigation_.cells()) cells->ground().setObject(id, obstacle);
    placed.velocity = velocity;
    wallsChanged_ = true;
    return {};
  }
  return outOfRange(fmt::format("obstacle {} is not here. Add it before moving it.",
                                static_cast<std::uint32_t>(id)));
}

bool Crowd::removeObstacle(navmesh::ObstacleId id) {
  const auto gone = std::remove_if(obstacles_.begin(), obstacles_.end(),
                                   [&](const PlacedObstacle& placed) { return placed.id == id; });
  if (gone == obstacles_.end()) return false;
  obstacles_.erase(gone, obstacles_.end());
  if (CellNavigation* cells = navigation_.cells()) cells->ground().removeObject(id);
  wallsChanged_ = true;
  // Whoever turned aside for it goes straight on again.
  std::fill(heldUp_.begin(), heldUp_.end(), 0.0f);
  return true;
}

void Crowd::onStep(std::function<void(const AgentsView&, const StepReport&)> record) {
  record_ = std::move(record);
}

AgentsView Crowd::view() const {
  return {id_,
          flags_,
          group_,
          position_,
          velocity_,
          heading_,
          height_,
          radius_,
          preferredSpeed_,
          maximumSpeed_,
          maximumAcceleration_,
          preferredVelocity_,
          target_,
          remaining_};
}

std::span<const Wall> Crowd::walls() {
  refreshWalls();
  return wallIndex_.walls();
}

std::uint64_t Crowd::hash() const {
  std::uint64_t total = 0;
  for (std::size_t i = 0; i < id_.size(); ++i) {
    std::uint64_t h = 0xcbf29ce484222325ull;
    const auto mix = [&](const auto& value) {
      std::uint32_t bits = 0;
      static_assert(sizeof(value) == sizeof(bits));
      std::memcpy(&bits, &value, sizeof(bits));
      h = (h ^ bits) * 0x100000001b3ull;
      h ^= h >> 29;
    };
    mix(id_[i]);
    mix(position_[i].x);
    mix(position_[i].y);
    mix(velocity_[i].x);
    mix(velocity_[i].y);
    mix(heading_[i]);
    total += h * 0x9e3779b97f4a7c15ull;  // a sum: the order of storage does not matter
  }
  return total;
}

}  // namespace forewalk::agents
