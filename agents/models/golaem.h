// Navigation and locomotion, as in Golaem's crowds: pick the best of many short trajectories that
// the body's motion clips can play.
//
// The source is the manual of a product, so what it leaves open is said here. Trajectories and
// their four penalties: trajectory_search.h. What is sampled for them:
//
// - Linear velocities evenly, angular ones hyperbolically: omega(u) = omega_max sinh(k u)/sinh(k),
//   u evenly from -1 to 1, finer where it is nearly straight; an odd number keeps straight ahead.
//   `sideOffset` is added to u, so above 0 there are more trajectories to the left.
// - A command that no clips can be blended for is dropped. Clips on one line are sampled along it.
// - Acceleration limits bound the first command only: linear and angular velocities are sampled
//   over what can be reached from the present ones, in the literal form until the next plan.
// - Trajectories last boldness * shortestLook + (1 - boldness) * longestLook: who is bold looks
//   less far ahead.
//
// Others are predicted to walk on straight. Nobody is assumed to yield.
//
// Departs from the source, unless `literal`:
// - One of the sampled speeds is the comfort speed, so that who has free way walks at it.
// - The first command may be what takes `reachSeconds` to reach; the body then approaches it within
//   its acceleration limits. Sampled only up to the next plan, as in the source, someone who stands
//   finds no reason to walk off: a fifth of a metre a second for half a trajectory leads nowhere.
// - Turns are sampled over what the clips can play at each speed, so that none is dropped.
// - Near the goal trajectories are shorter, so that the goal is met and not circled.
// - Who is nearly there lets others come as near as the goal is, or it would never get there.
// - Bodies that touch already may part: only what brings them closer is dismissed. In the source
//   everything is.
// The source also calls the full dual command too much to search (22,500 trajectories an agent);
// the search makes it affordable, but the default stays with 2 x 3 second commands, which walk as
// well.
#pragma once

#include <array>
#include <memory>
#include <vector>

#include "agents/locomotion.h"
#include "agents/model.h"
#include "agents/trajectory_search.h"

namespace forewalk::agents {

struct GolaemParameters {
  std::shared_ptr<const LocomotionDatabase> clips;  ///< null: builtInClips()

  std::uint32_t linearSamples = 10;   ///< 1 to kMostSamples
  std::uint32_t angularSamples = 15;  ///< 1 to kMostSamples
  float spacing = 2.5f;               ///< k; 0: angular velocities evenly
  float sideOffset = 0.0f;            ///< -1 to 1
  bool dual = true;                   ///< another command for the second half
  std::uint32_t secondLinear = 2;     ///< how many of them; 0: as many as for the first
  std::uint32_t secondAngular = 3;    ///< likewise
  std::uint32_t points = 10;          ///< of a trajectory, 1 to kMostPoints

  float boldness = 0.5f;      ///< 0 to 1; where the agent's row has none
  float shortestLook = 1.5f;  ///< T_min, seconds, > 0
  float longestLook = 4.0f;   ///< T_max, seconds
  float comfortSpeed = 0.0f;  ///< m/s; 0: the agent's preferred speed

  float linearAcceleration = 6.0f;    ///< m/s^2; infinity: no limit
  float angularAcceleration = 12.0f;  ///< rad/s^2; infinity: no limit
  float reachSeconds = 0.3f;  ///< in which the first command has to be reached, at least `period`
  float period = 0.1f;        ///< from plan to plan, seconds; 0: every tick

  // Sensors. Agents and obstacles within 2 m of the own height are seen: the crowd's own rule,
  // about the source's twice the height.
  float detectionWidth = 0.5f;  ///< of a body, metres
  float agentWidths = 25.0f;    ///< agents are seen within so many
  float obstacleWidths = 8.0f;  ///< obstacles likewise
  std::uint32_t neighbourCount = 20;
  std::uint32_t wallCount = 16;

  TrajectoryWeights weights;
  bool literal = false;
};

/// An agent's row. The first two are the caller's to set, 0 for the model's; the rest the model
/// writes: the command it follows, and the clips with their weights for an engine to play
/// (LocomotionDatabase::motionOf, replayRatio).
struct GolaemRow {
  float boldness;      ///< above 0 to 1
  float comfortSpeed;  ///< m/s
  float linear, angular;
  std::array<float, 3> clip;  ///< whole numbers
  std::array<float, 3> weight;
};
inline constexpr std::uint32_t kGolaemMemory = sizeof(GolaemRow) / sizeof(float);

/// Reads and writes the row that Crowd::memoryOf gives.
GolaemRow golaemRow(std::span<const float> memory);
void setGolaemRow(const GolaemRow& row, std::span<float> memory);

/// 1 <= samples, points etc. are assumed as told above; what is out of range is moved into it.
std::unique_ptr<const Model> makeGolaem(const GolaemParameters& parameters = {});

/// What an agent chooses from: for pictures and tests. `problem` looks into the vectors; do not
/// copy it.
struct TrajectorySituation {
  std::vector<Command> first, second;
  std::vector<PredictedDisc> discs;
  std::vector<PredictedWall> walls;
  TrajectoryProblem problem;
  bool contact = false;  ///< it touches somebody or something
};

/// Replaces `situation` with that of an agent, as a model with these parameters sees it. Allocates
/// only where the vectors have to grow.
void lookAround(const GolaemParameters& parameters, const PlanInput& input, std::uint32_t agent,
                const GolaemRow& row, TrajectorySituation& situation);

}  // namespace forewalk::agents
