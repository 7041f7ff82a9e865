// Takes bodies out of each other and out of walls, after any model has moved them.
//
// Positions are corrected like contacts in position-based dynamics (Mueller et al. 2007): every
// agent moves by the averaged corrections of its contacts, all at once, until none is deep. What is
// left then is undone: agents that still overlap go back to where they were before the step, and so
// do those they would meet there. So a crowd that had no overlaps before a step has none after it.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "agents/agents_view.h"
#include "agents/neighbourhood.h"

namespace forewalk::agents {

struct ProjectionSettings {
  float tolerance = 0.005f;       ///< overlaps that are left, share of the radii's sum
  std::uint32_t iterations = 20;  ///< corrections before what is left is undone
};

class Projection {
 public:
  /// Corrects `positions` (of `agents`, whose other arrays are as after the step; `before`: before
  /// it). Agents with kHuman or kStatic stay. `index` is rebuilt for the new positions.
  /// Bit-identical for any `forEach`. Returns the deepest overlap left, share of the radii's sum.
  float apply(const AgentsView& agents, std::span<const glm::vec2> before, const WallIndex& walls,
              const ProjectionSettings& settings, NeighbourIndex& index,
              const navmesh::ForEach& forEach, std::span<glm::vec2> positions);

 private:
  struct Row {
    std::uint32_t contacts, contactCount, walls, wallCount;  // in the lists of the agent's slice
  };
  struct Slice {
    std::vector<Neighbour> contacts;
    std::vector<std::uint32_t> walls;
    std::vector<NearWall> near;
    float deepest = 0.0f;
    bool changed = false;
  };
  std::vector<Slice> slices_;
  std::vector<Row> rows_;
  std::vector<glm::vec2> from_, now_, next_;
  std::vector<std::uint8_t> undone_;
};

}  // namespace forewalk::agents
