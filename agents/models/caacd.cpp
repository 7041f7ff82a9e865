#include "agents/models/caacd.h"

#include <algorithm>
#include <cmath>

#include "navmesh/plan.h"

namespace forewalk::agents {
namespace {

// Of the force that a critical threat leaves to the path amendment. Less, and a crowd stands still
// with nothing but threats around; more, and it walks into them.
constexpr float kHeldBack = 0.8f;
// Nearer to straight on than this share of the reach, everybody takes the same side.
constexpr float kStraightOn = 0.1f;

glm::vec2 leftOf(glm::vec2 v) { return {-v.y, v.x}; }

glm::vec2 limited(glm::vec2 v, float limit) {
  const float length = glm::length(v);
  return length > limit ? v * (limit / length) : v;
}

enum class Field { tolerable, alert, critical, collision };

/// Somebody or something round, as seen from an agent.
struct Body {
  glm::vec2 apart;     // from it to the agent, metres
  glm::vec2 relative;  // its velocity less the agent's, m/s
  float reach;         // sum of the radii, metres
};

/// Two bodies at their nearest approach.
struct Approach {
  Field field = Field::tolerable;
  float seconds = 0.0f;    // tau: until then
  glm::vec2 offset{0.0f};  // from the other to this one, then, metres
};

/// The agent that is planned for.
struct Self {
  glm::vec2 position, velocity, forward;
  float speed;         // of `velocity`
  float slowest;       // at which it still brakes for others, m/s
  float remaining;     // metres to its target
  float acceleration;  // the largest, m/s^2
  float side;
};

/// Sum of what threats ask for.
struct Avoidance {
  glm::vec2 sum{0.0f};
  float strength = 0.0f;  // of the worst: 0, 1/2 or 1
  bool contact = false;
};

class Caacd final : public Model {
 public:
  explicit Caacd(const CaacdParameters& parameters) : p_(parameters) {}

  const char* name() const override { return p_.literal ? "caacd-literal" : "caacd"; }

  Needs needs() const override {
    Needs needs;
    needs.neighbourRadius = p_.neighbourRadius;
    needs.neighbourCount = p_.neighbourCount;
    needs.wallRadius = p_.neighbourRadius;
    needs.memory = kCaacdMemory;
    return needs;
  }

  void plan(const PlanInput& input, Memory memory, Scratch&, std::span<Plan> plans) const override {
    for (std::size_t k = 0; k < input.which.size(); ++k) {
      const std::uint32_t agent = input.which[k];
      const std::span<const float> row = memory.of(agent);
      const float mass = row[0] > 0.0f ? row[0] : p_.mass;
      const float force = row[1] > 0.0f ? row[1] : p_.force;
      const Self self = selfOf(input, agent, force / mass);
      plans[k] = p_.literal ? asPrinted(input, agent, self, force) : corrected(input, agent, self);
    }
  }

 private:
  Self selfOf(const PlanInput& input, std::uint32_t agent, float acceleration) const {
    const AgentsView& agents = input.agents;
    Self self;
    self.position = agents.position[agent];
    self.velocity = agents.velocity[agent];
    self.speed = glm::length(self.velocity);
    self.forward = self.speed > 1e-3f ? self.velocity / self.speed
                                      : navmesh::directionOf(agents.heading[agent]);
    self.slowest = p_.slowest * agents.preferredSpeed[agent];
    self.remaining = agents.remaining[agent];
    self.acceleration = acceleration;
    self.side = input.side;
    return self;
  }

  static Body bodyOf(const AgentsView& agents, std::uint32_t agent, std::uint32_t other) {
    Body body{agents.position[agent] - agents.position[other],
              agents.velocity[other] - agents.velocity[agent],
              agents.radius[agent] + agents.radius[other]};
    if (glm::length(body.apart) < 1e-5f) {  // in one spot: the ids say which way
      const bool first = number(agents.id[agent]) < number(agents.id[other]);
      body.apart = {first ? -1e-5f : 1e-5f, 0.0f};
    }
    return body;
  }

  /// Equations (1) to (9).
  Approach approachOf(const Self& self, const Body& body) const {
    Approach approach;
    approach.offset = body.apart;
    if (glm::length(body.apart) <= body.reach) {
      approach.field = Field::collision;
      return approach;
    }
    // Without relative velocity: the present distance.
    const float squaredSpeed = glm::dot(body.relative, body.relative);
    if (squaredSpeed > 1e-10f)
      approach.seconds = glm::dot(body.relative, body.apart) / squaredSpeed;
    if (approach.seconds < 0.0f || approach.seconds > p_.horizon) return approach;
    if (!p_.literal && self.speed * approach.seconds > self.remaining) {
      approach.seconds = self.remaining / self.speed;
    }
    approach.offset = body.apart - body.relative * approach.seconds;
    const float distance =
        p_.literal ? weightedLength(approach.offset) : glm::length(approach.offset);
    if (distance <= p_.precaution * body.reach) {
      approach.field = Field::critical;
    } else if (distance <= p_.alert * body.reach) {
      approach.field = Field::alert;
    }
    return approach;
  }

  /// Mended (10) to (13): away from where the other will be.
  void avoid(const Self& self, const Body& body, Avoidance& avoidance) const {
    const Approach approach = approachOf(self, body);
    if (approach.field == Field::tolerable) return;
    const float strength = approach.field == Field::alert ? 0.5f : 1.0f;
    avoidance.strength = std::max(avoidance.strength, strength);
    avoidance.contact = avoidance.contact || approach.field == Field::collision;
    // The sooner the more; what is nearly here counts no more than what is here.
    const float weight = strength / (approach.seconds + 0.05f * p_.horizon);
    const glm::vec2 left = leftOf(self.forward);
    float ahead = glm::dot(approach.offset, self.forward);
    float lateral = glm::dot(approach.offset, left);
    if (approach.field != Field::collision) {
      if (std::abs(lateral) < kStraightOn * body.reach) {
        lateral = self.side * kStraightOn * body.reach;
      }
      if (ahead < 0.0f && self.speed < self.slowest) ahead = 0.0f;
    }
    const float length = std::sqrt(lateral * lateral + ahead * ahead);
    avoidance.sum += (lateral * left + ahead * self.forward) * (weight / length);
  }

  Avoidance avoidanceOf(const PlanInput& input, std::uint32_t agent, const Self& self) const {
    const Surroundings near = input.around.of(agent);
    Avoidance avoidance;
    for (const Neighbour& neighbour : near.neighbours) {
      avoid(self, bodyOf(input.agents, agent, neighbour.index), avoidance);
    }
    for (const NearWall& nearWall : near.walls) {
      const Wall& wall = input.around.walls[nearWall.index];
      if (!wall.isCircle()) continue;
      glm::vec2 apart = self.position - wall.from;
      if (apart == glm::vec2(0.0f)) apart = {1e-5f, 0.0f};
      avoid(self,
            {apart, wall.velocity - self.velocity, wallRadius(input.agents.radius[agent], wall)},
            avoidance);
    }
    return avoidance;
  }

  Plan corrected(const PlanInput& input, std::uint32_t agent, const Self& self) const {
    const AgentsView& agents = input.agents;
    const Avoidance avoidance = avoidanceOf(input, agent, self);
    // Path amendment and arrival: towards the target, no faster than half the force can stop.
    const glm::vec2 wanted =
        limited(agents.preferredVelocity[agent], std::sqrt(self.acceleration * self.remaining));
    const glm::vec2 amendment =
        limited((wanted - self.velocity) / input.seconds, self.acceleration) *
        (1.0f - kHeldBack * avoidance.strength);
    const float length = glm::length(avoidance.sum);
    const glm::vec2 away = length > 1e-6f
                               ? avoidance.sum * (avoidance.strength * self.acceleration / length)
                               : glm::vec2(0.0f);
    const glm::vec2 change = limited(amendment + away, self.acceleration) * input.seconds;
    // The source's MaxSpeed is the speed one walks at: nobody runs to get out of the way.
    const float preferred = agents.preferredSpeed[agent], most = agents.maximumSpeed[agent];
    const glm::vec2 velocity =
        limited(self.velocity + change, preferred > 0.0f ? std::min(preferred, most) : most);
    return Plan::walk(outOfWalls(input, agent, self, velocity),
                      avoidance.contact ? PlanStatus::contact : PlanStatus::ok);
  }

  /// `velocity` without what would not be stopped in time before a wall.
  static glm::vec2 outOfWalls(const PlanInput& input, std::uint32_t agent, const Self& self,
                              glm::vec2 velocity) {
    const Surroundings near = input.around.of(agent);
    for (int pass = 0; pass < 2; ++pass) {  // in a corner the second wall pushes into the first
      for (const NearWall& nearWall : near.walls) {
        const Wall& wall = input.around.walls[nearWall.index];
        if (wall.isCircle()) continue;
        const glm::vec2 nearest = nearestOn(wall, self.position);
        const glm::vec2 between = self.position - nearest;
        float distance = glm::length(between);
        const glm::vec2 along = wall.to - wall.from;
        const glm::vec2 inward = leftOf(along) / glm::length(along);
        glm::vec2 away = distance > 1e-6f ? between / distance : inward;
        const bool atAnEnd = nearest == wall.from || nearest == wall.to;
        if (!atAnEnd && glm::dot(between, inward) < 0.0f) {  // a little through it
          away = inward;
          distance = -distance;
        }
        const float room = distance - wallRadius(input.agents.radius[agent], wall);
        const float closing = glm::dot(wall.velocity - velocity, away);
        const float allowed =
            std::min(room / input.seconds, std::sqrt(self.acceleration * std::max(room, 0.0f)));
        // Out of a wall no faster than one walks.
        const float most = std::max(allowed, -input.agents.maximumSpeed[agent]);
        if (closing > most) velocity += (closing - most) * away;
      }
    }
    return velocity;
  }

  /// (10) to (13) as they stand, except that forward is the way one goes, since with a basis of
  /// zeros nothing would be added at all.
  Plan asPrinted(const PlanInput& input, std::uint32_t agent, const Self& self, float force) const {
    const Avoidance avoidance = avoidanceOf(input, agent, self);
    const glm::vec2 steer = avoidance.strength > 0.0f ? force * self.forward : glm::vec2(0.0f);
    return Plan::walk(input.agents.preferredVelocity[agent] + steer,
                      avoidance.contact ? PlanStatus::contact : PlanStatus::ok);
  }

  CaacdParameters p_;
};

}  // namespace

std::unique_ptr<const Model> makeCaacd(const CaacdParameters& parameters) {
  return std::make_unique<Caacd>(parameters);
}

CaacdParameters caacdCalibration(float mass, float force) {
  CaacdParameters parameters;
  parameters.mass = mass;
  parameters.force = force;
  parameters.precaution = 2.0f;
  parameters.alert = 4.0f;
  parameters.horizon = 40.0f;
  parameters.neighbourCount = 16;
  parameters.neighbourRadius = 40.0f;
  return parameters;
}

float weightedLength(glm::vec2 v) {
  const float larger = std::max(std::abs(v.x), std::abs(v.y));
  const float smaller = std::min(std::abs(v.x), std::abs(v.y));
  return 0.96f * larger + 0.398f * smaller;
}

}  // namespace forewalk::agents
