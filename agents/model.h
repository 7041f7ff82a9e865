// An avoidance model: what it needs to see, and one pure function that plans for many agents.
//
// To add one, write one pair of files under agents/models/ (README.md shows how). A model object is
// its parameters and never changes; what it keeps of an agent from plan to plan is a row of floats
// that the crowd holds (Memory); what it works in is a Scratch.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <memory>
#include <span>

#include "agents/agents_view.h"
#include "agents/neighbourhood.h"

namespace forewalk::agents {

enum class PlanStatus : std::uint8_t {
  ok,
  infeasible,  ///< no motion is free: the least bad one is returned
  contact,     ///< bodies touch or overlap
};

/// What an agent is to do until it is planned for again.
struct Plan {
  enum class Kind : std::uint8_t { velocity, heading, arc };

  Kind kind = Kind::velocity;
  PlanStatus status = PlanStatus::ok;
  glm::vec2 velocity{0.0f};  ///< velocity: m/s on the plan; the body turns to where it goes
  float heading = 0.0f;      ///< heading: turn there, radians, and walk that way at `speed`
  float speed = 0.0f;        ///< heading, arc: m/s, >= 0
  float turnRate = 0.0f;     ///< arc: rad/s, from the body's present heading

  static Plan walk(glm::vec2 velocity, PlanStatus status = PlanStatus::ok) {
    return {Kind::velocity, status, velocity, 0.0f, 0.0f, 0.0f};
  }
  static Plan towards(float heading, float speed, PlanStatus status = PlanStatus::ok) {
    return {Kind::heading, status, glm::vec2(0.0f), heading, speed, 0.0f};
  }
  static Plan arc(float speed, float turnRate, PlanStatus status = PlanStatus::ok) {
    return {Kind::arc, status, glm::vec2(0.0f), 0.0f, speed, turnRate};
  }
};

/// Working memory of one plan call: buffers, no results. Models that need one derive from it.
struct Scratch {
  virtual ~Scratch() = default;
};

/// What a model keeps of each agent: Needs::memory floats, 0 when the agent joins the model. A plan
/// reads and writes the rows of its own agents only. The caller may write them between steps
/// (Crowd::memoryOf), so a row also holds what differs from agent to agent: mass, boldness.
struct Memory {
  float* rows = nullptr;
  std::uint32_t stride = 0;  ///< floats from one agent's row to the next
  std::uint32_t size = 0;    ///< floats in a row that are this model's

  std::span<float> of(std::uint32_t agent) const {
    return {rows + static_cast<std::size_t>(agent) * stride, size};
  }
};

/// What plan() is given.
struct PlanInput {
  const AgentsView& agents;
  const Neighbourhoods& around;
  std::span<const std::uint32_t> which;  ///< the agents to plan for, indices
  float seconds;                         ///< until positions are next updated (the sub-step), > 0
  std::uint64_t tick;  ///< steps made so far; with the id, the seed of random choices
  float side;          ///< which way to turn where nothing else decides: 1 left, -1 right
};

class Model {
 public:
  virtual ~Model() = default;

  /// For programs and tables: "orca", "social-forces".
  virtual const char* name() const = 0;

  /// What it has to see. The same at every call.
  virtual Needs needs() const = 0;

  virtual std::unique_ptr<Scratch> makeScratch() const { return std::make_unique<Scratch>(); }

  /// Sets plans[k] for agent input.which[k], all k.
  ///
  /// Pure: the plan of an agent depends on the input, its own memory row and nothing else, not on
  /// who else is in `which` (the crowd cuts it as it likes), nor on what is left in `scratch`.
  /// Called from several threads at once, each with its own scratch and its own agents. All
  /// numbers are finite whatever the input: coincident agents, zero speeds, walls of no length.
  /// Limits of speed and acceleration are the crowd's to apply, but a model may well plan within
  /// them. Allocates only where the scratch has to grow.
  virtual void plan(const PlanInput& input, Memory memory, Scratch& scratch,
                    std::span<Plan> plans) const = 0;
};

}  // namespace forewalk::agents
