// From a goal to the sub-goal in sight: corridors and taut paths over the navmesh, or paths over
// cells (cell_navigation.h), or ways that somebody else has found.
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "agents/cell_navigation.h"
#include "navmesh/corridor.h"
#include "navmesh/locate.h"
#include "navmesh/polygon_states.h"
#include "navmesh/world.h"

namespace forewalk::agents {

struct NavigationSettings {
  std::uint32_t pathsPerTick = 64;  ///< paths found in one tick, the longest waiting first
  float walkerRadius = 0.3f;        ///< of the walker that the navmesh was built for, metres
  float cornerReach = 0.3f;         ///< a corner so near counts as passed, metres
  navmesh::SnapLimits snap{1.0f, 2.2f, 1.0f};  ///< how far beside the navmesh an agent may be put
};

/// The way of one agent. Only the next few corners are kept; more are found when these are used up.
struct Route {
  static constexpr std::uint32_t kCorners = 8;
  enum class State : std::uint8_t {
    none,    ///< no goal
    wanted,  ///< a path has to be found; until then whoever has one (`count`) walks on along it
    found,   ///< `corners` lead to the goal, or on towards it
    closed,  ///< there is no way
  };

  State state = State::none;
  bool toTheGoal = false;  ///< the last corner kept is the goal
  bool given = false;      ///< by setWay: never found anew
  std::uint8_t count = 0;
  std::uint8_t next = 0;
  std::uint8_t lost = 0;          ///< ticks for which the next corner has been out of sight
  std::uint32_t wantedSince = 0;  ///< order of asking
  glm::vec2 goal{0.0f};
  float goalHeight = 0.0f;
  float beyond = 0.0f;  ///< metres from the last corner kept to the goal
  std::array<glm::vec2, kCorners> corners{};
  navmesh::Location place;  ///< where the agent is on the navmesh; kNoPolygon: not on it
};

/// Where an agent is to head now.
struct SubGoal {
  glm::vec2 target;
  float remaining;  ///< metres along the path to the goal; 0 where there is none
};

/// The routes of a crowd. Without a world every goal is in sight.
class Navigation {
 public:
  explicit Navigation(NavigationSettings settings = {}) : settings_(settings) {}

  void setWorld(std::shared_ptr<const navmesh::World> world);

  /// Finds paths over cells from now on; places on the navmesh stay its own. Empty: as before.
  void setCells(std::optional<GroundCells> cells);
  CellNavigation* cells() { return cells_ ? &*cells_ : nullptr; }
  const CellNavigation* cells() const { return cells_ ? &*cells_ : nullptr; }

  const navmesh::World* world() const { return world_.get(); }

  /// What is closed in the world and what costs more (null: all is open): paths lead to what is
  /// cheapest, and nobody is sent into what is closed. Paths are found anew for all, within the
  /// budget, the nearest to what changed first; until then everybody walks on. A new world has none
  /// until it is given some. O(agents * polygons changed).
  void setStates(std::shared_ptr<const navmesh::PolygonStates> states);
  const navmesh::PolygonStates* states() const { return states_.get(); }

  // Agents by index, kept in step with the crowd's arrays.
  void add();
  void removeBySwap(std::uint32_t agent);  ///< the last agent takes its index
  const Route& route(std::uint32_t agent) const { return routes_[agent]; }

  void setGoal(std::uint32_t agent, glm::vec2 goal, float height);
  void clearGoal(std::uint32_t agent);

  /// A way that was found elsewhere instead of a goal: `corners` (at least 1, the first
  /// Route::kCorners count), and `beyond` metres from the last of them to the goal.
  void setWay(std::uint32_t agent, std::span<const glm::vec2> corners, float beyond);
  void moved(std::uint32_t agent);  ///< it was put elsewhere: its place and its path are found anew

  /// Finds the paths that are wanted, at most NavigationSettings::pathsPerTick, the longest waiting
  /// first. O(paths * corridor). Allocates only where a path is longer than any before.
  /// Over cells, whoever's path crosses a cell that changed and whoever has none asks first.
  void findPaths(std::span<const glm::vec2> positions, std::span<const float> heights,
                 std::span<const float> radii);

  /// Where `agent` is to head; passes corners it has reached or can see beyond. Who was pushed to
  /// where the next corner cannot be seen asks for another path after a while. Changes this agent's
  /// route alone: any number of threads, each with its own agents.
  SubGoal advance(std::uint32_t agent, glm::vec2 position);

  /// Follows an agent that moved from where it was to `position`: its place on the navmesh, moved
  /// to the nearest walkable point where it has none under it. Same threads as `advance`. Returns
  /// false where there is no world or no navmesh near.
  bool follow(std::uint32_t agent, glm::vec2& position, float& height);

  std::uint32_t waiting() const { return waiting_; }
  std::uint32_t closed() const { return closed_; }
  std::uint32_t notified() const { return notified_; }  ///< asked because cells changed

 private:
  void want(Route& route);
  void wantAnew(Route& route);
  void updateCells();
  void find(std::uint32_t agent, glm::vec2 position, float height, float radius);
  bool findOnNavMesh(Route& route, glm::vec2 position, float height);
  bool sees(const navmesh::Location& from, glm::vec2 to) const;

  NavigationSettings settings_;
  std::shared_ptr<const navmesh::World> world_;
  std::optional<CellNavigation> cells_;
  std::shared_ptr<const navmesh::PolygonStates> states_;  // null: all is open
  std::vector<Route> routes_;
  std::uint32_t asked_ = 0;
  std::uint32_t waiting_ = 0, closed_ = 0, notified_ = 0;
  navmesh::CorridorScratch scratch_;
  std::vector<std::uint32_t> corridor_, queue_;
  std::vector<glm::vec2> path_;
};

}  // namespace forewalk::agents
