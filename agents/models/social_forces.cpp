#include "agents/models/social_forces.h"

#include <algorithm>
#include <cmath>

#include "navmesh/plan.h"

namespace forewalk::agents {
namespace {

// exp(-12) of the strength at touch, under a thousandth of a metre per second squared, is nothing.
constexpr float kNothing = -12.0f;

/// The forces of Helbing's form: strength * exp((reach - distance) / range).
float decayed(float strength, float reach, float distance, float range) {
  const float exponent = (reach - distance) / range;
  if (exponent < kNothing) return 0.0f;
  // Deep overlaps are the contact force's; beyond a body's depth this one grows no further.
  return strength * std::exp(std::min(exponent, 3.0f));
}

glm::vec2 limited(glm::vec2 v, float limit) {
  const float length = glm::length(v);
  return length > limit ? v * (limit / length) : v;
}

class SocialForces final : public Model {
 public:
  explicit SocialForces(const SocialForceParameters& parameters) : p_(parameters) {}

  const char* name() const override {
    return p_.literal ? "social-forces-literal" : "social-forces";
  }

  Needs needs() const override {
    Needs needs;
    needs.neighbourRadius = p_.neighbourRadius;
    needs.neighbourCount = p_.neighbourCount;
    needs.wallRadius = std::max(1.0f, -kNothing * p_.wallRange);
    needs.longestSubStep = stableSubStep(p_.contactStiffness);
    needs.memory = kSocialForceMemory;
    return needs;
  }

  void plan(const PlanInput& input, Memory memory, Scratch&, std::span<Plan> plans) const override {
    for (std::size_t k = 0; k < input.which.size(); ++k) {
      const std::uint32_t agent = input.which[k];
      bool contact = false;
      const glm::vec2 velocity =
          input.agents.velocity[agent] + accelerationOf(input, agent, contact) * input.seconds;
      const glm::vec2 wayPoint = input.agents.position[agent] + velocity * p_.projectedSeconds;
      const std::span<float> row = memory.of(agent);
      row[0] = wayPoint.x;
      row[1] = wayPoint.y;
      plans[k] = Plan::walk(velocity, contact ? PlanStatus::contact : PlanStatus::ok);
    }
  }

 private:
  glm::vec2 accelerationOf(const PlanInput& input, std::uint32_t agent, bool& contact) const {
    const AgentsView& agents = input.agents;
    const Surroundings near = input.around.of(agent);
    glm::vec2 sum = (agents.preferredVelocity[agent] - agents.velocity[agent]) / p_.relaxation;
    glm::vec2 attraction(0.0f);
    for (const Neighbour& neighbour : near.neighbours) {
      sum += fromAgent(input, agent, neighbour.index, attraction, contact);
    }
    for (const NearWall& nearWall : near.walls) {
      sum += fromWall(input, agent, nearWall.index, attraction, contact);
    }
    return sum + limited(attraction, p_.attractionLimit);
  }

  glm::vec2 fromAgent(const PlanInput& input, std::uint32_t self, std::uint32_t other,
                      glm::vec2& attraction, bool& contact) const {
    const AgentsView& agents = input.agents;
    glm::vec2 between = agents.position[self] - agents.position[other];
    const float reach = agents.radius[self] + agents.radius[other];
    float distance = std::sqrt(between.x * between.x + between.y * between.y);
    if (distance < 1e-6f) {  // in one spot: the ids say which way
      between = {number(agents.id[self]) < number(agents.id[other]) ? -1.0f : 1.0f, 0.0f};
      distance = 1.0f;
      contact = true;
      return between * (p_.socialStrength + p_.contactStiffness * reach);
    }
    const glm::vec2 away = between / distance;
    glm::vec2 sum = away * decayed(p_.socialStrength, reach, distance, p_.socialRange);
    if (agents.group[self] != 0 && agents.group[self] == agents.group[other] &&
        distance < p_.attractionReach) {
      attraction -= away * decayed(p_.friendAttraction, reach, distance, p_.friendAttractionRange);
    }
    if (distance < reach) {
      contact = true;
      // Who yields takes half of the slip away, the other half is the other's to take.
      sum += contactForce(away, reach - distance, agents.velocity[self] - agents.velocity[other],
                          agents.yields(other) ? 0.5f : 1.0f, input.seconds);
    }
    if (p_.biasStrength > 0.0f) sum += bias(input, self, other, reach);
    return sum;
  }

  glm::vec2 contactForce(glm::vec2 away, float depth, glm::vec2 relative, float share,
                         float seconds) const {
    const float push = p_.contactStiffness * depth;
    if (p_.literal) return push * away + p_.friction * push * glm::vec2(-away.y, away.x);
    const glm::vec2 slip = relative - glm::dot(relative, away) * away;
    return push * away + frictionOf(slip, push, p_.friction, share, seconds);
  }

  // Repulsion from the ground that the other is about to sweep.
  glm::vec2 bias(const PlanInput& input, std::uint32_t self, std::uint32_t other,
                 float reach) const {
    const AgentsView& agents = input.agents;
    const glm::vec2 velocity = agents.velocity[other];
    const float squaredSpeed = glm::dot(velocity, velocity);
    if (!(squaredSpeed > 1e-6f))
      return glm::vec2(0.0f);  // nothing is swept: social repulsion has it
    const float ourSquaredSpeed = glm::dot(agents.velocity[self], agents.velocity[self]);
    const float along = glm::dot(velocity, agents.velocity[self]);
    if (along > p_.sameWay * std::sqrt(squaredSpeed * ourSquaredSpeed)) return glm::vec2(0.0f);
    const glm::vec2 between = agents.position[self] - agents.position[other];
    const float when = std::clamp(glm::dot(between, velocity) / squaredSpeed, 0.0f, p_.biasSeconds);
    const glm::vec2 off = between - when * velocity;
    const float distance = glm::length(off);
    // Right in its way there is no side to leave to: the one everybody takes.
    const glm::vec2 away = distance > 1e-3f ? off / distance
                                            : input.side * glm::vec2(velocity.y, -velocity.x) /
                                                  std::sqrt(squaredSpeed);
    if (p_.literal) {
      const float surface = distance - agents.radius[other];
      return away * (p_.biasStrength *
                     std::exp(std::min(agents.radius[self] - surface / p_.biasRange, 3.0f)));
    }
    return away * decayed(p_.biasStrength, reach, distance, p_.biasRange);
  }

  glm::vec2 fromWall(const PlanInput& input, std::uint32_t self, std::uint32_t which,
                     glm::vec2& attraction, bool& contact) const {
    const AgentsView& agents = input.agents;
    const Wall& wall = input.around.walls[which];
    const glm::vec2 position = agents.position[self];
    const glm::vec2 nearest = nearestOn(wall, position);
    if (!wall.isCircle() && isOthersCorner(input, self, which, nearest)) return glm::vec2(0.0f);
    const glm::vec2 between = position - nearest;
    const float distance = glm::length(between);
    const float reach = wallRadius(agents.radius[self], wall);
    glm::vec2 away = distance > 1e-6f ? between / distance : glm::vec2(1.0f, 0.0f);
    if (!wall.isCircle()) {
      const glm::vec2 along = wall.to - wall.from;
      const glm::vec2 inward = glm::vec2(-along.y, along.x) / glm::length(along);
      // On the wall, or pushed a little through it in this tick: out again.
      if (distance <= 1e-6f ||
          (glm::dot(between, inward) < 0.0f && nearest != wall.from && nearest != wall.to)) {
        away = inward;
        contact = true;
        return contactForce(away, reach + distance, agents.velocity[self] - wall.velocity, 1.0f,
                            input.seconds);
      }
    }
    glm::vec2 sum = away * decayed(p_.wallStrength, reach, distance, p_.wallRange);
    if (p_.literal) sum = -sum;
    if (wall.attraction > 0.0f && distance < p_.attractionReach) {
      attraction -= away * (wall.attraction *
                            decayed(p_.wallAttraction, reach, distance, p_.wallAttractionRange));
    }
    if (distance < reach) {
      contact = true;
      sum += contactForce(away, reach - distance, agents.velocity[self] - wall.velocity, 1.0f,
                          input.seconds);
    }
    return sum;
  }

  /// Whether the nearest point of a wall is a corner that the wall beyond it answers for: that one
  /// is nearer, or as near and comes first. (It is not asked where it was not gathered, as when the
  /// tick began on its far side.)
  static bool isOthersCorner(const PlanInput& input, std::uint32_t self, std::uint32_t which,
                             glm::vec2 nearest) {
    const Wall& wall = input.around.walls[which];
    const std::uint32_t beyond = nearest == wall.from ? wall.previous
                                 : nearest == wall.to ? wall.next
                                                      : kNoWall;
    if (beyond == kNoWall) return false;
    bool first = true;  // of the two
    for (const NearWall& other : input.around.of(self).walls) {
      if (other.index == which) first = false;
      if (other.index != beyond) continue;
      return first || nearestOn(input.around.walls[beyond], input.agents.position[self]) != nearest;
    }
    return false;
  }

  SocialForceParameters p_;
};

}  // namespace

glm::vec2 frictionOf(glm::vec2 slip, float push, float friction, float share, float seconds) {
  const float speed = glm::length(slip);
  if (!(speed > 0.0f)) return glm::vec2(0.0f);
  const float most = share * speed / seconds;
  return slip * (-std::min(friction * push, most) / speed);
}

float stableSubStep(float contactStiffness) {
  return contactStiffness > 0.0f ? 0.6f * 2.0f / std::sqrt(2.0f * contactStiffness) : 0.0f;
}

std::unique_ptr<const Model> makeSocialForces(const SocialForceParameters& parameters) {
  return std::make_unique<SocialForces>(parameters);
}

}  // namespace forewalk::agents
