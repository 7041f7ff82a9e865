// From a goal to a path over free, mixed and full cells, and who has to find a new one when they
// change.
//
// The global navigation of the virtual-agents paper: A* over eight neighbours without cutting
// corners (ground_cells.h), then pulled straight where the straight way has room. It stands in for
// the corridors of a navmesh in Navigation, which does the rest for both.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "agents/ground_cells.h"

namespace forewalk::agents {

/// A step straight and a diagonal one as whole numbers in the ratio of 1 to sqrt(2) within two
/// millionths: costs are exact, so equal ways are equal, and ties go to the smaller cell.
inline constexpr std::uint32_t kStraightCost = 408, kDiagonalCost = 577;

/// A* with scratch that is stamped, not cleared.
class CellSearch {
 public:
  /// Replaces `cells` with the cheapest way for a body of `radius` (wider ones than `reach` count
  /// as that wide) from cell to cell, both included. Returns its cost, or kNoWay. The start need
  /// not have room. O(cells log cells) at worst.
  std::uint32_t find(const GroundCells& ground, std::uint32_t from, std::uint32_t to, float radius,
                     std::vector<std::uint32_t>& cells);

  static constexpr std::uint32_t kNoWay = 0xffffffffu;

 private:
  struct Open {
    std::uint32_t estimate, cell;
  };
  std::vector<std::uint32_t> stamp_, cost_, from_;
  std::vector<Open> heap_;
  std::uint32_t run_ = 0;
};

/// The paths of a crowd over one map of cells. Agents by index, kept in step by Navigation.
class CellNavigation {
 public:
  explicit CellNavigation(GroundCells ground) : ground_(std::move(ground)) {}

  GroundCells& ground() { return ground_; }
  const GroundCells& ground() const { return ground_; }

  void add() { ways_.emplace_back(); }
  void removeBySwap(std::uint32_t agent);

  /// Replaces `path` with the way from `position` to `goal`, or to the place nearest to the goal
  /// within `snap` metres where the goal itself has no room: `position`, each bend, the end. False
  /// where there is none.
  bool find(std::uint32_t agent, glm::vec2 position, glm::vec2 goal, float radius, float snap,
            std::vector<glm::vec2>& path);
  void forget(std::uint32_t agent) { ways_[agent].cells.clear(); }  ///< it follows no path any more

  /// Whether an agent whose path was found has room on the straight way.
  bool sees(std::uint32_t agent, glm::vec2 from, glm::vec2 to) const;

  /// Whether it stands where a line can begin, and that to `to` is blocked: it was pushed off its
  /// path.
  bool lost(glm::vec2 position, glm::vec2 to) const {
    return ground_.roomAt(position) > 0.0f && !(ground_.lineRoom(position, to) > 0.0f);
  }

  /// Brings the map up to date and calls notify(agent), ascending, for everybody whose path crosses
  /// a changed cell. O(what moved), and where something did O(cells of all paths). Returns whether
  /// any cell changed.
  template <typename Notify>
  bool update(const Notify& notify) {
    const std::span<const std::uint32_t> changed = ground_.update();
    if (changed.empty()) return false;
    changed_.resize(ground_.size(), 0);
    for (const std::uint32_t cell : changed) changed_[cell] = 1;
    for (std::uint32_t agent = 0; agent < ways_.size(); ++agent) {
      for (const std::uint32_t cell : ways_[agent].cells) {
        if (!changed_[cell]) continue;
        notify(agent);
        break;
      }
    }
    for (const std::uint32_t cell : changed) changed_[cell] = 0;
    return true;
  }

  /// The cells that the last path of an agent crosses, in order.
  std::span<const std::uint32_t> cellsOf(std::uint32_t agent) const { return ways_[agent].cells; }

 private:
  struct Way {
    std::vector<std::uint32_t> cells;
    float radius = 0.0f;
  };
  std::uint32_t nearestPlace(glm::vec2 point, float radius, float within, bool inSight) const;

  GroundCells ground_;
  CellSearch search_;
  std::vector<Way> ways_;
  std::vector<std::uint8_t> changed_;
  std::vector<std::uint32_t> cells_;
};

}  // namespace forewalk::agents
