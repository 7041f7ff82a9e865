// How deep bodies are in each other and in walls: what a crowd must not do, counted.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "agents/agents_view.h"
#include "agents/neighbourhood.h"
#include "agents/walls.h"

namespace forewalk::agents {

struct OverlapCount {
  std::uint64_t pairSteps =
      0;                 ///< pairs deeper than the tolerance, added up over the steps counted
  float deepest = 0.0f;  ///< share of the sum of the two radii
  float leastGap =
      1e30f;  ///< smallest distance between two bodies that was seen, metres; negative inside

  OverlapCount& operator+=(const OverlapCount& other) {
    pairSteps += other.pairSteps;
    deepest = deepest > other.deepest ? deepest : other.deepest;
    leastGap = leastGap < other.leastGap ? leastGap : other.leastGap;
    return *this;
  }
};

/// Counts pairs of bodies; keeps its index from step to step.
class OverlapCounter {
 public:
  /// `tolerance`: share of the sum of the radii. O(agents) where they are no denser than bodies.
  OverlapCount count(const AgentsView& agents, float tolerance = 0.01f);

 private:
  NeighbourIndex index_;
};

/// Counts collisions as events: a pair that was apart at the last step and is not any more.
class CollisionCounter {
 public:
  /// Collisions begun since the last call; `tolerance`: share of the sum of the radii that bodies
  /// may be in each other, since touching is none. Pairs by id, so agents may come and go.
  /// O(agents) where they are no denser than bodies.
  std::uint32_t count(const AgentsView& agents, float tolerance = 0.01f);

 private:
  NeighbourIndex index_;
  std::vector<std::uint64_t> touching_, before_;  ///< ascending, the lower id in the upper half
};

/// Whether a body at `position` and `height` reaches deeper than `tolerance` metres into a wall, or
/// its centre is inside a closed row of walls that keeps agents out. O(walls).
bool entersWall(glm::vec2 position, float height, float radius, std::span<const Wall> walls,
                float tolerance);

/// Agents whose body reaches deeper than `tolerance` metres into a wall (wallRadius), or whose
/// centre is inside a closed row of walls that keeps agents out. O(agents * walls).
std::uint64_t countWallsEntered(const AgentsView& agents, std::span<const Wall> walls,
                                float tolerance);

}  // namespace forewalk::agents
