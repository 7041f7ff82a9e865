// Who and what is near: one gather a tick, shared by all models.
//
// A uniform grid filled by counting sort. Results do not depend on its cells: neighbours are the
// nearest ones, ordered by squared distance and then by id, walls by squared distance and then by
// index.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "agents/agents_view.h"
#include "agents/walls.h"
#include "navmesh/for_each.h"

namespace forewalk::agents {

/// What a model has to see, and how often.
struct Needs {
  float neighbourRadius = 5.0f;       ///< from body to body, metres
  std::uint32_t neighbourCount = 10;  ///< the nearest so many; 0: none
  float wallRadius = 5.0f;            ///< from the body to the nearest point of a wall (a circle's
                                      ///< rim), metres
  std::uint32_t wallCount = 16;       ///< the nearest so many; 0: none
  float period = 0.0f;                ///< plan anew after so many seconds; 0: every tick
  float longestSubStep = 0.0f;  ///< seconds; 0: any. A tick is cut into equal sub-steps no longer
                                ///< than this, and the model plans in each of them
  std::uint32_t memory = 0;     ///< floats kept for each agent, see Memory
};

struct Neighbour {
  std::uint32_t index;    ///< in AgentsView
  float squaredDistance;  ///< when gathered: in later sub-steps both have moved on; m^2
};

struct NearWall {
  std::uint32_t index;    ///< in Neighbourhoods::walls
  float squaredDistance;  ///< to its nearest point when gathered (a circle's rim); m^2
};

/// What is near one agent. Others within 2 m of its own height only: the floor above is another
/// world.
struct Surroundings {
  std::span<const Neighbour> neighbours;  ///< ascending (squaredDistance, id)
  std::span<const NearWall> walls;  ///< by squaredDistance, then as the middle is near; only those
                                    ///< that have the agent on their free side, and circles
};

/// The rows of all agents. Lives until the next gather.
struct Neighbourhoods {
  std::span<const Wall> walls;  ///< all there are
  std::span<const Neighbour> neighbours;
  std::span<const NearWall> nearWalls;
  struct Row {
    std::uint32_t neighbours, neighbourCount, walls, wallCount;
  };
  std::span<const Row> rows;  ///< per agent

  Surroundings of(std::uint32_t agent) const {
    const Row row = rows[agent];
    return {neighbours.subspan(row.neighbours, row.neighbourCount),
            nearWalls.subspan(row.walls, row.wallCount)};
  }
};

/// Walls by place. Made again when they change; read by any number of threads.
class WallIndex {
 public:
  /// Replaces the walls. O(walls + cells covered); allocates only where they became more.
  void assign(std::span<const Wall> walls);

  std::span<const Wall> walls() const { return walls_; }

  /// Replaces `found` with the nearest walls of `position` as Surroundings tells, at most `count`
  /// within `radius` metres. Allocates only where `found` has to grow beyond its capacity.
  void nearest(glm::vec2 position, float height, float radius, std::uint32_t count,
               std::vector<NearWall>& found) const;

 private:
  bool comesBefore(const NearWall& a, const NearWall& b, glm::vec2 position) const;

  std::vector<Wall> walls_;
  glm::vec2 origin_{0.0f};
  float cell_ = 1.0f;
  int columns_ = 0, rows_ = 0;
  std::vector<std::uint32_t> cellStart_;
  std::vector<std::uint32_t> cellWalls_;  ///< ascending within a cell
};

/// The index of agents, and the rows gathered from it.
class NeighbourIndex {
 public:
  /// Sorts all agents into cells. `reach` is the largest neighbourRadius anybody will ask for,
  /// metres. O(agents + cells), cells at most 8 times the agents.
  void build(const AgentsView& agents, float reach);

  /// Gathers the rows of all agents, each with the needs at `needsOf[agent]` (null: an empty row).
  /// Bit-identical for any `forEach`. Allocates only where there are more agents or larger needs
  /// than ever before.
  const Neighbourhoods& gather(const AgentsView& agents, const WallIndex& walls,
                               std::span<const Needs* const> needsOf,
                               const navmesh::ForEach& forEach);

  /// What the last gather found.
  const Neighbourhoods& neighbourhoods() const { return result_; }

  /// Calls visit(index) for every agent whose cell is within `radius` of `position`, in an order
  /// that depends on places only up to equal cells. For projection and for metrics.
  template <typename Visit>
  void visitNear(glm::vec2 position, float radius, const Visit& visit) const {
    if (columns_ == 0) return;
    const int lowColumn = columnOf(position.x - radius), highColumn = columnOf(position.x + radius);
    const int lowRow = rowOf(position.y - radius), highRow = rowOf(position.y + radius);
    for (int row = lowRow; row <= highRow; ++row) {
      const std::size_t line = static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_);
      const std::uint32_t begin = cellStart_[line + static_cast<std::size_t>(lowColumn)];
      const std::uint32_t end = cellStart_[line + static_cast<std::size_t>(highColumn) + 1];
      for (std::uint32_t k = begin; k < end; ++k) visit(sorted_[k].index);
    }
  }

 private:
  struct Entry {
    glm::vec2 position;
    float height;
    float radius;
    std::uint32_t id;
    std::uint32_t index;
  };
  int columnOf(float x) const;
  int rowOf(float y) const;
  std::uint32_t nearest(const Entry& self, float radius, std::uint32_t count,
                        Neighbour* found) const;

  glm::vec2 origin_{0.0f};
  float cell_ = 1.0f;
  float widest_ = 0.0f;  // the largest radius
  int columns_ = 0, rows_ = 0;
  std::vector<std::uint32_t> cellStart_;
  std::vector<std::uint32_t> cellOf_;
  std::vector<Entry> sorted_;
  std::vector<Neighbour> neighbours_;
  std::vector<NearWall> nearWalls_;
  std::vector<Neighbourhoods::Row> rowOf_;
  std::vector<std::vector<NearWall>> wallScratch_;  ///< one a slice
  Neighbourhoods result_;
};

}  // namespace forewalk::agents
