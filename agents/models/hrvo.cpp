#include "agents/models/hrvo.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "agents/velocity_cones.h"
#include "navmesh/plan.h"

namespace forewalk::agents {
namespace {

using navmesh::cross;

// Overlaps up to this share of the radii's sum are touches.
constexpr float kTouch = 0.01f;

struct HrvoScratch : Scratch {
  std::vector<VelocityCone> cones;
  ConeScratch search;
};

/// The cone of a wall widened by `radius`, as seen from the origin, cut off where it is nearest.
VelocityCone coneOfWall(std::span<const Wall> walls, std::uint32_t which, glm::vec2 position,
                        float radius, float horizon, float seconds, float maximumSpeed) {
  const Wall& wall = walls[which];
  const glm::vec2 nearest = nearestOn(wall, position) - position;
  const float distance = glm::length(nearest);
  const glm::vec2 along = (wall.to - wall.from) / glm::length(wall.to - wall.from);
  const glm::vec2 towards = distance > 1e-6f ? nearest / distance : glm::vec2(along.y, -along.x);
  const float gap = distance - radius;
  VelocityCone cone;
  if (gap <= 1e-3f) {
    // In contact: out again, as fast as that may go in one step.
    cone = halfPlaneCone(towards, wall.velocity, std::max(gap / seconds, -0.5f * maximumSpeed));
  } else {
    // Free ground is left of the wall: seen from there, it ends at the left. An end that another
    // wall takes up, turning towards us, is no way around.
    const glm::vec2 to = wall.to - position, from = wall.from - position;
    const bool leftOut = pointsOut(walls, which);
    const bool rightOut = wall.previous == kNoWall || pointsOut(walls, wall.previous);
    cone.left = leftOut ? coneOfDisc(to, radius, to, 0.0f).left : along;
    cone.right = rightOut ? coneOfDisc(from, radius, from, 0.0f).right : -along;
    cone.apex = wall.velocity;
    cone.cutDirection = towards;
    cone.cut = gap / horizon;
    cone.apart = nearest;
    cone.reach = radius;
  }
  cone.hard = true;
  return cone;
}

class Hrvo final : public Model {
 public:
  explicit Hrvo(const HrvoParameters& parameters) : p_(parameters) {}

  const char* name() const override { return p_.preferredOnly ? "hrvo-thesis" : "hrvo"; }

  Needs needs() const override {
    Needs needs;
    needs.neighbourRadius = p_.preferredOnly ? 0.0f : p_.neighbourRadius;
    needs.neighbourCount = p_.preferredOnly ? 0 : p_.neighbourCount;
    needs.wallRadius = 2.0f * p_.wallHorizon + 0.5f;
    needs.wallCount = p_.preferredOnly ? 0 : 16;
    return needs;
  }

  std::unique_ptr<Scratch> makeScratch() const override { return std::make_unique<HrvoScratch>(); }

  void plan(const PlanInput& input, Memory, Scratch& scratch,
            std::span<Plan> plans) const override {
    HrvoScratch& own = static_cast<HrvoScratch&>(scratch);
    for (std::size_t k = 0; k < input.which.size(); ++k) {
      plans[k] = p_.preferredOnly ? Plan::walk(input.agents.preferredVelocity[input.which[k]])
                                  : planFor(input, input.which[k], own);
    }
  }

 private:
  Plan planFor(const PlanInput& input, std::uint32_t agent, HrvoScratch& scratch) const {
    const AgentsView& agents = input.agents;
    const float maximumSpeed = agents.maximumSpeed[agent];
    PlanStatus status = PlanStatus::ok;
    scratch.cones.clear();
    const Surroundings near = input.around.of(agent);
    for (const NearWall& wall : near.walls) {
      scratch.cones.push_back(coneOf(input, agent, wall.index));
    }
    for (const Neighbour& neighbour : near.neighbours) {
      bool contact = false;
      scratch.cones.push_back(coneOfAgent(input, agent, neighbour.index, contact));
      if (contact) status = PlanStatus::contact;
    }
    glm::vec2 preferred = agents.preferredVelocity[agent];
    const float speed = glm::length(preferred);
    if (speed > maximumSpeed) preferred *= maximumSpeed / speed;
    glm::vec2 velocity;
    if (!nearestFree(scratch.cones, preferred, maximumSpeed, input.side, scratch.search,
                     velocity)) {
      if (status == PlanStatus::ok) status = PlanStatus::infeasible;
      velocity = leastDangerous(scratch.cones, preferred, agents.velocity[agent], maximumSpeed,
                                p_.collisionWeight, input.seconds, input.side, scratch.search);
    }
    return Plan::walk(velocity, status);
  }

  VelocityCone coneOf(const PlanInput& input, std::uint32_t agent, std::uint32_t which) const {
    const AgentsView& agents = input.agents;
    const Wall& wall = input.around.walls[which];
    const glm::vec2 position = agents.position[agent];
    const float radius = wallRadius(agents.radius[agent], wall);
    if (!wall.isCircle()) {
      return coneOfWall(input.around.walls, which, position, radius, p_.wallHorizon, input.seconds,
                        agents.maximumSpeed[agent]);
    }
    const glm::vec2 apart = wall.from - position;
    const float distance = glm::length(apart);
    VelocityCone cone;
    if (distance - radius > 1e-3f) {
      cone = coneOfDisc(apart, radius, wall.velocity, p_.wallHorizon);
    } else {
      const glm::vec2 towards = distance > 1e-6f ? apart / distance : glm::vec2(1.0f, 0.0f);
      cone = halfPlaneCone(
          towards, wall.velocity,
          std::max((distance - radius) / input.seconds, -0.5f * agents.maximumSpeed[agent]));
    }
    cone.hard = true;
    return cone;
  }

  VelocityCone coneOfAgent(const PlanInput& input, std::uint32_t self, std::uint32_t other,
                           bool& contact) const {
    const AgentsView& agents = input.agents;
    const glm::vec2 apart = agents.position[other] - agents.position[self];
    float reach = agents.radius[self] + agents.radius[other];
    const glm::vec2 velocity = agents.velocity[self], theirs = agents.velocity[other];
    const bool yields = agents.yields(other);
    const float distance = glm::length(apart);
    // A touch is no overlap: whoever stands shoulder to shoulder may walk along the other.
    if (distance <= reach && distance > (1.0f - kTouch) * reach) reach = distance * 0.9999f;
    if (distance <= reach) {
      contact = true;
      const bool first = number(agents.id[self]) < number(agents.id[other]);
      const glm::vec2 towards =
          distance > 1e-6f ? apart / distance : glm::vec2(first ? 1.0f : -1.0f, 0.0f);
      const glm::vec2 apex = yields ? 0.5f * (velocity + theirs) : theirs;
      const float part = (reach - distance) / ((yields ? 2.0f : 1.0f) * input.seconds);
      return halfPlaneCone(towards, apex, -p_.uncertainty - part);
    }
    glm::vec2 apex = theirs;
    if (yields) {
      // As the published library: what both want decides the side, which they then agree on.
      const float side =
          cross(apart, agents.preferredVelocity[self] - agents.preferredVelocity[other]);
      const bool left = side > 0.0f || (side == 0.0f && input.side > 0.0f);
      apex = hybridApex(apart, reach, velocity, theirs, left);
    }
    apex -= apart * (p_.uncertainty / reach);
    return coneOfDisc(apart, reach, apex, p_.timeHorizon);
  }

  HrvoParameters p_;
};

}  // namespace

glm::vec2 hybridApex(glm::vec2 apart, float reach, glm::vec2 velocity, glm::vec2 theirs,
                     bool leftOfCentre) {
  const VelocityCone cone = coneOfDisc(apart, reach, theirs, 0.0f);
  const float d = cross(cone.right, cone.left);  // sin of the cone's angle
  if (!(d > 1e-6f)) return theirs;
  const glm::vec2 relative = velocity - theirs;
  return leftOfCentre ? theirs + cross(relative, cone.left) / (2.0f * d) * cone.right
                      : theirs - cross(relative, cone.right) / (2.0f * d) * cone.left;
}

std::unique_ptr<const Model> makeHrvo(const HrvoParameters& parameters) {
  return std::make_unique<Hrvo>(parameters);
}

}  // namespace forewalk::agents
