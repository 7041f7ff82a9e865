// The state of a crowd as flat arrays, read-only while a step is planned.
//
// Positions and velocities are on the plan (navmesh/plan.h), metres and metres a second; headings
// are radians, 0 is forward (plan +y), counter-clockwise positive. One entry an agent, the same
// index in every array. Indices change when agents are removed; ids never do.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>

#include "navmesh/plan.h"

namespace forewalk::agents {

/// An agent's name for as long as its crowd lives; never given twice.
enum class AgentId : std::uint32_t {};

inline constexpr AgentId kNoAgent{0xffffffffu};

/// An agent's place among equals.
constexpr std::uint32_t number(AgentId id) { return static_cast<std::uint32_t>(id); }

/// What an agent is, beside its model. Any of the three is never moved by a plan and must not be
/// assumed to yield: who meets one takes all of the avoidance (see `yields`).
enum AgentFlag : std::uint8_t {
  kHuman = 1,    ///< moved by the caller (the redirected user): the crowd never changes its pose
  kPassive = 2,  ///< walks its preferred velocity and looks at nobody
  kStatic = 4,   ///< stands where it is
};

/// Lives until the crowd is changed or stepped.
struct AgentsView {
  std::span<const AgentId> id;
  std::span<const std::uint8_t> flags;   ///< AgentFlag, or'ed
  std::span<const std::uint32_t> group;  ///< the caller's: who belongs together; 0: nobody
  std::span<const glm::vec2> position;
  std::span<const glm::vec2> velocity;
  std::span<const float> heading;  ///< where the body looks; kept while it stands
  std::span<const float> height;   ///< of the ground under it, world y, metres; 0 without a navmesh
  std::span<const float> radius;   ///< of the body, > 0
  std::span<const float> preferredSpeed;       ///< m/s, >= 0
  std::span<const float> maximumSpeed;         ///< m/s, >= 0
  std::span<const float> maximumAcceleration;  ///< m/s^2; infinity: no limit
  std::span<const glm::vec2>
      preferredVelocity;              ///< from navigation: towards `target`, 0 at the goal
  std::span<const glm::vec2> target;  ///< the sub-goal in sight; the own position where none
  std::span<const float> remaining;   ///< metres along the path to the goal; 0: there, or no goal

  std::uint32_t size() const { return static_cast<std::uint32_t>(id.size()); }

  /// Whether the agent takes its share of avoiding others.
  bool yields(std::uint32_t agent) const { return flags[agent] == 0; }
};

}  // namespace forewalk::agents
