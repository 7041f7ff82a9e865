#include "service/crowd_walk.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <unordered_map>

#include "agents/overlaps.h"
#include "navmesh/plan.h"
#include "navmesh/random.h"
#include "service/files.h"

namespace forewalk::service {

using agents::AgentId;

namespace {

constexpr int kTries = 1000;
constexpr double kFollowAgain = 0.5;  // seconds between two looks at who is followed
// Of a place that somebody else is given: how far it may be moved onto the navmesh, metres.
constexpr navmesh::SnapLimits kOnFloor{0.05f, 1.0f, 1.0f};

}  // namespace

/// Bodies that stand already, by cells, to find room beside them.
class CrowdWalk::Occupied {
 public:
  explicit Occupied(float widest) : cell_(2.0f * widest) {}

  bool isFree(glm::vec2 at, float height, float radius) const {
    const auto [column, row] = cellOf(at);
    for (std::int64_t x = column - 1; x <= column + 1; ++x) {
      for (std::int64_t y = row - 1; y <= row + 1; ++y) {
        const auto found = bodies_.find(key(x, y));
        if (found == bodies_.end()) continue;
        for (const Body& body : found->second) {
          if (std::abs(body.height - height) < 2.0f &&
              glm::distance(at, body.at) < radius + body.radius) {
            return false;
          }
        }
      }
    }
    return true;
  }
  void add(glm::vec2 at, float height, float radius) {
    const auto [column, row] = cellOf(at);
    bodies_[key(column, row)].push_back({at, height, radius});
  }

 private:
  struct Body {
    glm::vec2 at;
    float height, radius;
  };
  std::pair<std::int64_t, std::int64_t> cellOf(glm::vec2 at) const {
    return {static_cast<std::int64_t>(std::floor(at.x / cell_)),
            static_cast<std::int64_t>(std::floor(at.y / cell_))};
  }
  static std::uint64_t key(std::int64_t x, std::int64_t y) {
    return static_cast<std::uint64_t>(x) << 32 ^ (static_cast<std::uint64_t>(y) & 0xffffffffu);
  }
  float cell_;
  std::unordered_map<std::uint64_t, std::vector<Body>> bodies_;  // looked up, never walked through
};

CrowdWalk::CrowdWalk(const CrowdConfig& config, std::shared_ptr<const navmesh::World> world,
                     float walkerRadius)
    : config_(config),
      world_(std::move(world)),
      rng_(config.seed),
      crowd_(settings(config, walkerRadius)) {
  if (world_) places_.emplace(world_->graph);
}

tl::expected<void, Error> CrowdWalk::populate(std::span<const Body> others) {
  layGround();
  float widest = 0.0f;
  for (const CrowdGroup& group : config_.groups) widest = std::max(widest, group.radius.y);
  for (const Body& body : others) widest = std::max(widest, body.radius);
  Occupied occupied(widest);
  for (const Body& body : others) occupied.add(body.plan, body.height, body.radius);
  std::map<std::string, agents::ModelId> models;
  for (std::uint32_t g = 0; g < config_.groups.size(); ++g) {
    const CrowdGroup& group = config_.groups[g];
    if (models.count(group.model) == 0) {
      models[group.model] = crowd_.addModel(config_.makeModel(group.model));
    }
    firstOf_.push_back(members_.size());
    for (std::uint32_t k = 0; k < group.count; ++k) {
      if (auto added = add(g, k, models[group.model], occupied); !added) return added;
    }
  }
  return {};
}

agents::CrowdSettings CrowdWalk::settings(const CrowdConfig& config, float walkerRadius) {
  agents::CrowdSettings settings;
  settings.project = config.projection;
  settings.navigation.walkerRadius = walkerRadius;
  return settings;
}

void CrowdWalk::layGround() {
  std::vector<agents::Wall> walls;
  agents::appendLoop(config_.room, glm::vec2(0.0f), walls);
  for (const std::vector<glm::vec2>& row : config_.walls) {
    // There and back: both of its sides.
    std::vector<glm::vec2> loop = row;
    loop.insert(loop.end(), row.rbegin() + 1, row.rend() - 1);
    agents::appendLoop(loop, glm::vec2(0.0f), walls);
  }
  crowd_.setFixedWalls(std::move(walls));
  obstacles_.resize(config_.obstacles.size());
  placeObstacles();
  if (world_) crowd_.setWorld(world_);
}

void CrowdWalk::placeObstacles() {
  // Half a tick early, so that a time which is a whole number of ticks is that tick's.
  const double now = seconds() + 0.5 * config_.tick;
  for (std::size_t k = 0; k < obstacles_.size(); ++k) {
    const PlacedObstacle& obstacle = config_.obstacles[k];
    if (obstacle.isThere(now) == obstacles_[k].has_value()) continue;
    if (obstacles_[k]) {
      crowd_.removeObstacle(*obstacles_[k]);
      obstacles_[k].reset();
    } else if (const auto id = crowd_.addObstacle(obstacle.shape, obstacle.velocity)) {
      obstacles_[k] = *id;  // valid: it was looked at when it was read
    }
  }
}

Error CrowdWalk::groupError(std::uint32_t group, ErrorCode code,
                            const std::string& sentence) const {
  return {code, fmt::format("groups[{}] \"{}\": {}", group, config_.groups[group].name, sentence)};
}

std::optional<glm::vec3> CrowdWalk::onGround(glm::vec2 at, float height, float radius) {
  if (world_) {
    const auto place =
        navmesh::locate(world_->graph, world_->locations, navmesh::toSpace(at, height), kOnFloor);
    if (!place) return {};
    at = place->plan;
    height = place->height;
  }
  if (agents::entersWall(at, height, radius, crowd_.walls(), 0.01f)) return {};
  return glm::vec3(at, height);
}

glm::vec2 CrowdWalk::randomIn(const PlanArea& area) {
  const double x = navmesh::uniform(rng_, area.low.x, area.high.x);
  return glm::vec2(x, navmesh::uniform(rng_, area.low.y, area.high.y));
}

float CrowdWalk::within(glm::vec2 range) {
  return static_cast<float>(navmesh::uniform(rng_, range.x, range.y));
}

/// A place (plan, height) that `draw` gives, on free ground, and free of bodies where asked for.
template <typename Draw>
tl::expected<glm::vec3, Error> CrowdWalk::roomFor(std::uint32_t g, float radius,
                                                  const Occupied* occupied, std::string_view what,
                                                  const Draw& draw) {
  for (int attempt = 0; attempt < kTries; ++attempt) {
    const auto [at, height] = draw();
    const auto place = onGround(at, height, radius);
    if (place && (!occupied || occupied->isFree(glm::vec2(*place), place->z, radius)))
      return *place;
  }
  return tl::unexpected(groupError(
      g, ErrorCode::kSettingOutOfRange,
      fmt::format("no room for {} of radius {:.2f} m after {} tries; make its area larger or its "
                  "count smaller.",
                  what, radius, kTries)));
}

/// A place that somebody gave.
tl::expected<glm::vec3, Error> CrowdWalk::given(std::uint32_t g, glm::vec2 at,
                                                std::string_view what) {
  const float height = config_.groups[g].height;
  if (!world_) return glm::vec3(at, height);
  const auto place =
      placeIn(*world_, navmesh::toSpace(at, height), fmt::format("{} in {}", what, config_.scene));
  if (!place) {
    return tl::unexpected(groupError(g, place.error().code, place.error().message));
  }
  return glm::vec3(place->plan, place->height);
}

std::pair<glm::vec2, float> CrowdWalk::anywhere() {
  const navmesh::Location place = places_->draw(rng_);
  return {place.plan, place.height};
}

tl::expected<glm::vec3, Error> CrowdWalk::startOf(std::uint32_t g, std::uint32_t k, float radius,
                                                  const Occupied& occupied) {
  const CrowdGroup& group = config_.groups[g];
  switch (group.start.kind) {
    case CrowdStart::Kind::area:
      return roomFor(g, radius, &occupied, "an agent",
                     [&] { return std::pair(randomIn(group.start.area), group.height); });
    case CrowdStart::Kind::anywhere:
      return roomFor(g, radius, &occupied, "an agent", [&] { return anywhere(); });
    case CrowdStart::Kind::ring: {
      const double angle = 2.0 * 3.14159265358979323846 * k / group.count;
      const glm::vec2 out(std::cos(angle), std::sin(angle));
      return given(g, group.start.centre + group.start.radius * out, "start");
    }
    case CrowdStart::Kind::points:
      break;
  }
  return given(g, group.start.points[k], "start");
}

tl::expected<std::vector<glm::vec2>, Error> CrowdWalk::goalsOf(std::uint32_t g, std::uint32_t k,
                                                               float radius, glm::vec2 start) {
  const CrowdGroup& group = config_.groups[g];
  const CrowdGoal& goal = group.goal;
  std::vector<glm::vec2> goals;
  switch (goal.kind) {
    case CrowdGoal::Kind::none:
    case CrowdGoal::Kind::follow:
      break;
    case CrowdGoal::Kind::opposite:
      goals.push_back(2.0f * group.start.centre - start);
      break;
    case CrowdGoal::Kind::points:
      goals.push_back(goal.points[goal.points.size() == 1 ? 0 : k]);
      break;
    case CrowdGoal::Kind::visit:
      goals = goal.points;
      break;
    case CrowdGoal::Kind::area:
    case CrowdGoal::Kind::anywhere: {
      const auto place = roomFor(g, radius, nullptr, "a goal", [&] {
        return goal.kind == CrowdGoal::Kind::area ? std::pair(randomIn(goal.area), group.height)
                                                  : anywhere();
      });
      if (!place) return tl::unexpected(place.error());
      return std::vector<glm::vec2>{glm::vec2(*place)};
    }
  }
  for (const glm::vec2 at : goals) {
    if (const auto place = given(g, at, "goal"); !place) return tl::unexpected(place.error());
  }
  return goals;
}

tl::expected<void, Error> CrowdWalk::add(std::uint32_t g, std::uint32_t k, agents::ModelId model,
                                         Occupied& occupied) {
  const CrowdGroup& group = config_.groups[g];
  agents::AgentSpec spec;
  spec.radius = within(group.radius);
  spec.preferredSpeed = within(group.speed);
  spec.maximumSpeed = std::max(2.0f, 1.5f * spec.preferredSpeed);
  spec.group = group.friends ? g + 1 : 0;
  if (group.human) {
    spec.flags = agents::kHuman;
  } else {
    spec.model = model;
  }
  const auto start = startOf(g, k, spec.radius, occupied);
  if (!start) return tl::unexpected(start.error());
  spec.position = glm::vec2(*start);
  spec.height = start->z;
  const bool tight = group.goal.kind == CrowdGoal::Kind::opposite;
  // In a crowd nobody gets to the very point where others stand.
  spec.goalRadius = group.goal.kind == CrowdGoal::Kind::follow ? group.goal.distance
                    : tight                                    ? 0.1f
                                                               : 2.0f * spec.radius;
  auto goals = goalsOf(g, k, spec.radius, spec.position);
  if (!goals) return tl::unexpected(goals.error());
  if (!goals->empty() && goals->front() != spec.position) {
    spec.heading = navmesh::headingOf(goals->front() - spec.position);
  }
  const auto id = crowd_.add(spec);
  if (!id) return tl::unexpected(groupError(g, id.error().code, id.error().message));
  occupied.add(spec.position, spec.height, spec.radius);
  Member member{*id, g, k, spec.radius};
  member.goals = std::move(*goals);
  member.last = spec.position;
  members_.push_back(std::move(member));
  return {};
}

bool CrowdWalk::hasFinalGoal(const Member& member) const {
  const CrowdGoal& goal = config_.groups[member.group].goal;
  return goal.kind != CrowdGoal::Kind::none && goal.kind != CrowdGoal::Kind::follow &&
         goal.kind != CrowdGoal::Kind::anywhere &&
         !(goal.kind == CrowdGoal::Kind::visit && goal.loop);
}

void CrowdWalk::setOut(Member& member) {
  member.legMeasured = false;
  member.legWalked = 0.0;
  crowd_.setGoal(member.id, member.goals[member.next], config_.groups[member.group].height);
}

void CrowdWalk::follow(const Member& member) {
  const CrowdGroup& group = config_.groups[member.group];
  for (std::uint32_t g = 0; g < config_.groups.size(); ++g) {
    if (config_.groups[g].name != group.goal.follow) continue;
    const std::uint32_t whom = std::min(member.place, config_.groups[g].count - 1);
    const std::uint32_t leader = crowd_.indexOf(members_[firstOf_[g] + whom].id);
    const agents::AgentsView view = crowd_.view();
    crowd_.setGoal(member.id, view.position[leader], view.height[leader]);
    return;
  }
}

void CrowdWalk::setGoals(double now, double seconds) {
  const bool followNow = now + 0.5 * seconds >= nextFollow_;
  if (followNow) nextFollow_ += std::max(kFollowAgain, seconds);
  for (Member& member : members_) {
    const CrowdGroup& group = config_.groups[member.group];
    if (now + 1e-9 < static_cast<double>(group.departSeconds)) continue;
    if (group.goal.kind == CrowdGoal::Kind::follow) {
      if (followNow) follow(member);
    } else if (!member.departed && !member.goals.empty()) {
      setOut(member);
    }
    member.departed = true;
  }
}

// A person is moved by whoever tracks them; here they walk their way and look at nobody.
void CrowdWalk::moveHumans(double seconds) {
  const agents::AgentsView view = crowd_.view();
  for (const Member& member : members_) {
    if (!config_.groups[member.group].human) continue;
    const std::uint32_t i = crowd_.indexOf(member.id);
    const glm::vec2 velocity = view.preferredVelocity[i];
    const bool walks = glm::length(velocity) > 0.05f;
    crowd_.place(member.id, view.position[i] + velocity * static_cast<float>(seconds),
                 view.height[i], walks ? navmesh::headingOf(velocity) : view.heading[i], velocity);
  }
}

// What a leg walked, and how long it had to be: known when its path is found.
void CrowdWalk::measureLegs() {
  const agents::AgentsView view = crowd_.view();
  for (Member& member : members_) {
    const std::uint32_t i = crowd_.indexOf(member.id);
    const double moved = static_cast<double>(glm::distance(member.last, view.position[i]));
    member.last = view.position[i];
    member.speed = moved / config_.tick;
    if (!member.departed || member.arrived) continue;
    member.legWalked += moved;
    if (!member.legMeasured && view.remaining[i] > 0.0f) {
      // As it was before this tick.
      member.legShortest = static_cast<double>(view.remaining[i]) + member.legWalked - moved;
      member.legMeasured = true;
    }
  }
}

void CrowdWalk::arrive(Member& member, double now) {
  const CrowdGroup& group = config_.groups[member.group];
  if (member.legMeasured) {
    const glm::vec2 at = crowd_.view().position[crowd_.indexOf(member.id)];
    const double left = static_cast<double>(glm::distance(at, member.goals[member.next]));
    const double walked = member.legWalked + left;
    if (walked > 0.0) efficiency_.push_back(std::min(1.0, member.legShortest / walked));
  }
  if (group.goal.kind == CrowdGoal::Kind::anywhere) {
    const auto place =
        roomFor(member.group, member.radius, nullptr, "a goal", [&] { return anywhere(); });
    if (place) member.goals[0] = glm::vec2(*place);
    return setOut(member);
  }
  if (member.next + 1 < member.goals.size() || group.goal.loop) {
    member.next = (member.next + 1) % member.goals.size();
    return setOut(member);
  }
  member.arrived = true;
  arrivals_.push_back(now - static_cast<double>(group.departSeconds));
}

void CrowdWalk::tick(const navmesh::ForEach& forEach) {
  placeObstacles();
  setGoals(seconds(), config_.tick);
  moveHumans(config_.tick);
  crowd_.step(static_cast<float>(config_.tick), forEach);
  ++ticks_;
  measureLegs();
  for (Member& member : members_) {
    if (member.departed && !member.arrived && !member.goals.empty() && crowd_.arrived(member.id)) {
      arrive(member, seconds());
    }
  }
}

}  // namespace forewalk::service
