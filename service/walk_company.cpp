#include "service/walk_company.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "navmesh/plan.h"

namespace forewalk::service {
namespace {

constexpr float kStandingReach =
    0.3f;                            // metres; whoever stays so near to where they stopped stands
constexpr double kSameWay = 0.02;    // m/s; what differs less from the user's wish is that wish
constexpr float kSqueeze = 20.0f;    // what closed ground costs agents' own paths
constexpr float kGoalAhead = 0.05f;  // metres; the user's goal radius

CompanyConfig wholeFrames(CompanyConfig config, double rate) {
  config.crowd.tick = std::max(1.0, std::round(config.crowd.tick * rate)) / rate;
  return config;
}

glm::vec2 velocityOf(const agents::Plan& plan, float heading) {
  switch (plan.kind) {
    case agents::Plan::Kind::velocity:
      return plan.velocity;
    case agents::Plan::Kind::heading:
      return navmesh::directionOf(plan.heading) * plan.speed;
    case agents::Plan::Kind::arc:
      break;
  }
  // Where a moment of the arc leads.
  constexpr float kMoment = 0.25f;  // seconds
  return navmesh::directionOf(heading + kMoment * plan.turnRate) * plan.speed;
}

}  // namespace

std::optional<glm::dvec2> wayOf(const agents::Crowd& crowd, agents::AgentId human) {
  const agents::AgentsView view = crowd.view();
  const std::uint32_t i = crowd.indexOf(human);
  const glm::vec2 wish = view.preferredVelocity[i];
  if (wish == glm::vec2(0.0f)) return std::nullopt;  // standing, or there
  const glm::dvec2 velocity(velocityOf(crowd.planOf(human), view.heading[i]));
  if (glm::distance(velocity, glm::dvec2(wish)) < kSameWay) return std::nullopt;
  return velocity;
}

WalkCompany::WalkCompany(CompanyConfig config, std::shared_ptr<const navmesh::World> world,
                         float walkerRadius, double rate, navmesh::ForEach forEach)
    : config_(wholeFrames(std::move(config), rate)),
      world_(std::move(world)),
      frameSeconds_(1.0 / rate),
      framesPerTick_(static_cast<std::uint64_t>(std::llround(config_.crowd.tick * rate))),
      forEach_(std::move(forEach)),
      walk_(config_.crowd, world_, walkerRadius) {}

tl::expected<void, Error> WalkCompany::begin(const rdw::CompanyUser& user) {
  agents::Crowd& crowd = walk_.crowd();
  agents::AgentSpec spec;
  spec.flags = agents::kHuman;
  spec.position = glm::vec2(user.pose.position);
  spec.height = user.height;
  spec.heading = static_cast<float>(user.pose.heading);
  spec.radius = config_.userRadius;
  spec.goalRadius = kGoalAhead;
  spec.preferredSpeed = static_cast<float>(user.speed);
  spec.maximumSpeed = std::max(2.0f, 1.5f * spec.preferredSpeed);
  if (config_.userAvoids) spec.model = crowd.addModel(config_.crowd.makeModel(config_.userModel));
  const auto added = crowd.add(spec);
  if (!added) return tl::unexpected(added.error());
  user_ = *added;
  const CrowdWalk::Body body[] = {{spec.position, spec.height, spec.radius}};
  if (auto populated = walk_.populate(body); !populated) return populated;

  const std::size_t count = walk_.members().size();
  touching_.assign(count, false);
  userAt_ = user.pose.position;
  for (const CrowdWalk::Member& member : walk_.members()) {
    from_.push_back(member.last);
    // Who goes nowhere has stood there already.
    const bool stays = config_.crowd.groups[member.group].goal.kind == CrowdGoal::Kind::none;
    stands_.push_back({member.last, stays ? config_.blockAfter : 0.0f});
  }
  summary_.others = static_cast<std::uint32_t>(count);
  summary_.userAvoids = config_.userAvoids;
  block();
  return {};
}

// Agents are at the end of the tick that began `sinceTick_` of a tick ago.
glm::vec2 WalkCompany::positionOf(std::size_t member) const {
  const agents::Crowd& crowd = walk_.crowd();
  const glm::vec2 to = crowd.view().position[crowd.indexOf(walk_.members()[member].id)];
  return glm::mix(from_[member], to, sinceTick_);
}

void WalkCompany::tick(const rdw::CompanyUser& user) {
  agents::Crowd& crowd = walk_.crowd();
  const auto seconds = static_cast<float>(config_.crowd.tick);
  for (std::size_t k = 0; k < from_.size(); ++k) {
    from_[k] = positionOf(k);
    Stand& stand = stands_[k];
    if (glm::distance(from_[k], stand.at) > kStandingReach) {
      stand = {from_[k], 0.0f};
    } else {
      stand.seconds += seconds;
    }
  }
  block();
  const glm::dvec2 at = user.pose.position;
  const auto velocity = glm::vec2((at - userAt_) / config_.crowd.tick);
  userAt_ = at;
  crowd.place(user_, glm::vec2(at), user.height, static_cast<float>(user.pose.heading), velocity);
  crowd.setPreferredSpeed(user_, static_cast<float>(user.speed));
  if (user.goal) {
    crowd.setGoal(user_, glm::vec2(*user.goal), user.height);
  } else {
    crowd.clearGoal(user_);
  }
  walk_.tick(forEach_);
}

void WalkCompany::block() {
  if (!world_ || !config_.blocks) return;
  const agents::AgentsView view = walk_.crowd().view();
  found_.clear();
  for (std::size_t k = 0; k < stands_.size(); ++k) {
    if (stands_[k].seconds < config_.blockAfter) continue;
    const CrowdWalk::Member& member = walk_.members()[k];
    navmesh::Standing standing;
    standing.foot = navmesh::toSpace(from_[k], view.height[walk_.crowd().indexOf(member.id)]);
    standing.radius = std::min(member.radius + config_.userRadius, navmesh::kWidestStanding);
    standing.cost = config_.blockCost;
    navmesh::blockedBy(world_->graph, world_->locations, standing, found_);
  }
  const auto byPolygon = [](const navmesh::PolygonCost& a, const navmesh::PolygonCost& b) {
    return a.polygon < b.polygon;
  };
  std::sort(found_.begin(), found_.end(), byPolygon);
  found_.erase(std::unique(found_.begin(), found_.end()), found_.end());
  record_.blockedPolygons = static_cast<std::uint32_t>(found_.size());
  summary_.blockedPolygons = std::max(summary_.blockedPolygons, record_.blockedPolygons);
  if (found_ == blocked_) return;
  blocked_ = found_;
  ++summary_.stateChanges;
  if (blocked_.empty()) {
    states_ = nullptr;
    return walk_.crowd().setStates(nullptr, false);
  }
  // Polygons of the graph, and a cost that was checked when it was read.
  states_ = std::make_shared<const navmesh::PolygonStates>(
      *navmesh::makePolygonStates(world_->graph, {}, {}, blocked_));
  for (navmesh::PolygonCost& one : found_) one.cost = std::min(one.cost, kSqueeze);
  walk_.crowd().setStates(std::make_shared<const navmesh::PolygonStates>(
                              *navmesh::makePolygonStates(world_->graph, {}, {}, found_)),
                          false);
}

void WalkCompany::meet(const rdw::CompanyUser& user) {
  const agents::AgentsView view = walk_.crowd().view();
  record_.clearance = std::numeric_limits<double>::infinity();
  bool inCollision = false;
  for (std::size_t k = 0; k < from_.size(); ++k) {
    const CrowdWalk::Member& member = walk_.members()[k];
    const float height = view.height[walk_.crowd().indexOf(member.id)];
    if (std::abs(height - user.height) > kStorey) {
      touching_[k] = false;
      continue;
    }
    const float bodies = member.radius + config_.userRadius;
    const double clearance =
        glm::distance(glm::dvec2(positionOf(k)), user.pose.position) - static_cast<double>(bodies);
    record_.clearance = std::min(record_.clearance, clearance);
    const bool touches = clearance < -static_cast<double>(kTouch * bodies);
    if (touches && !touching_[k]) ++record_.collisions;
    touching_[k] = touches;
    inCollision = inCollision || touches;
  }
  summary_.minimumSeparation = std::min(summary_.minimumSeparation, record_.clearance);
  summary_.collisions = record_.collisions;
  if (inCollision) summary_.collisionSeconds += frameSeconds_;
  if (!blocked_.empty()) summary_.blockedSeconds += frameSeconds_;
}

void WalkCompany::follow(std::uint64_t frame, const rdw::CompanyUser& user) {
  const std::uint64_t since = frame % framesPerTick_;
  // At the first frame nobody has moved yet; later, agents have come to the end of their tick.
  sinceTick_ = frame == 0   ? 0.0f
               : since == 0 ? 1.0f
                            : static_cast<float>(since) / static_cast<float>(framesPerTick_);
  meet(user);
  if (since == 0) {
    if (frame > 0) {
      // Among themselves: the user's collisions are counted in frames.
      summary_.othersCollisions += amongOthers_.count(walk_.crowd().view());
    }
    tick(user);
    sinceTick_ = 0.0f;
  }
}

std::optional<glm::dvec2> WalkCompany::makeWay() const {
  if (!config_.userAvoids) return std::nullopt;
  return wayOf(walk_.crowd(), user_);
}

rdw::CompanySummary WalkCompany::summary() const {
  rdw::CompanySummary summary = summary_;
  summary.hash = walk_.crowd().hash();
  return summary;
}

}  // namespace forewalk::service
