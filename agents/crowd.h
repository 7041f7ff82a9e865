// A crowd: agents, walls and models, and the step they share.
//
// Each tick: sub-goals and preferred velocities, one index and one gather, then for each sub-step a
// plan per model, limits and motion, and at the end, where asked for, a projection that takes
// bodies out of each other and out of walls (projection.h).
//
// The result of a step is the same to the last bit for any number of threads and any order in
// which agents are stored. Nothing is allocated in a step once there have been as many agents,
// walls and as long paths before.
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <span>
#include <tl/expected.hpp>
#include <vector>

#include "agents/agents_view.h"
#include "agents/model.h"
#include "agents/navigation.h"
#include "agents/neighbourhood.h"
#include "agents/projection.h"
#include "agents/walls.h"
#include "navmesh/build/obstacle.h"
#include "navmesh/error.h"
#include "navmesh/for_each.h"
#include "navmesh/world.h"

namespace forewalk::agents {

/// A model's place in its crowd, in the order of addModel.
enum class ModelId : std::uint32_t {};

/// Nobody plans for it: it walks its preferred velocity (kPassive), stands (kStatic) or is moved by
/// the caller (kHuman).
inline constexpr ModelId kNoModel{0xffffffffu};

/// Who joins a crowd.
struct AgentSpec {
  glm::vec2 position{0.0f};     ///< plan, metres
  float height = 0.0f;          ///< of the ground, world y, metres; picks the storey on a navmesh
  float heading = 0.0f;         ///< radians
  glm::vec2 velocity{0.0f};     ///< m/s
  float radius = 0.25f;         ///< metres, > 0
  float preferredSpeed = 1.3f;  ///< m/s, >= 0
  float maximumSpeed = 2.0f;    ///< m/s, >= 0
  float maximumAcceleration = std::numeric_limits<float>::infinity();  ///< m/s^2, > 0
  float goalRadius = 0.1f;  ///< arrived when so near to the goal, metres, >= 0
  std::uint8_t flags = 0;   ///< AgentFlag, or'ed
  std::uint32_t group = 0;  ///< the caller's
  /// One of the crowd's, for whoever has no flag. A human may have one too: what it would do in
  /// their place is planned and told (planOf), and not done.
  ModelId model = kNoModel;
};

struct CrowdSettings {
  bool project = false;  ///< take overlaps away after each step; on top of any model
  ProjectionSettings projection;
  NavigationSettings navigation;
  /// Preferred velocities are turned by so much, so that two who meet in exact symmetry do not stop
  /// and stare; radians. And to which side: 1 left, -1 right. A mirrored scene has the other side.
  float symmetryBreak = 1e-3f;
  float side = -1.0f;
  /// And who has been held up (walks at less than a tenth of what it wants) turns farther with
  /// every second, to the same side, until the knot comes loose; radians a second, up to 2.5. 0:
  /// never.
  float unknot = 0.5f;
};

/// What the last step met.
struct StepReport {
  std::uint64_t tick = 0;            ///< steps made so far
  std::uint32_t subSteps = 0;        ///< the tick was cut into so many
  std::uint32_t infeasible = 0;      ///< agents whose last plan said so
  std::uint32_t contact = 0;         ///< likewise
  std::uint32_t waitingForPath = 0;  ///< agents for whom the budget of paths did not suffice
  std::uint32_t withoutPath = 0;     ///< agents whose goal cannot be reached
  std::uint32_t notified = 0;        ///< agents who asked for a path because cells changed
  float deepestOverlap =
      0.0f;  ///< left after projection, share of the radii's sum; 0 where it is off
};

class Crowd {
 public:
  explicit Crowd(CrowdSettings settings = {});

  /// Models stay for the life of the crowd. The same class with other parameters is another model.
  ModelId addModel(std::unique_ptr<const Model> model);

  /// Fails when a number is not finite or out of its range, the model is not one of the crowd's, or
  /// an agent without flags has none (kSettingOutOfRange, naming the field and its value).
  [[nodiscard]] tl::expected<AgentId, Error> add(const AgentSpec& spec);
  bool remove(AgentId agent);  ///< false: not here
  bool contains(AgentId agent) const;

  /// The index of an agent until the next add or remove. It must be here.
  std::uint32_t indexOf(AgentId agent) const;

  /// Where an agent shall go, plan metres; the storey nearest to `height`. On a navmesh the path is
  /// found in the next steps, within the budget of paths.
  void setGoal(AgentId agent, glm::vec2 goal, float height = 0.0f);
  void clearGoal(AgentId agent);

  /// A way that was found elsewhere, instead of a goal: 1 to Route::kCorners corners, passed one
  /// after the other, and `beyond` metres from the last of them to the goal, >= 0.
  void setWay(AgentId agent, std::span<const glm::vec2> corners, float beyond);
  const Route& routeOf(AgentId agent) const { return navigation_.route(indexOf(agent)); }
  bool arrived(AgentId agent) const;  ///< within its goal radius, or it has no goal

  /// Moves a human, or anybody (a jump: velocities are not derived from it).
  void place(AgentId agent, glm::vec2 position, float height, float heading, glm::vec2 velocity);

  void setModel(AgentId agent, ModelId model);  ///< its memory row becomes 0
  void setPreferredSpeed(AgentId agent, float metresPerSecond);
  void setFlags(AgentId agent, std::uint8_t flags);
  std::span<float> memoryOf(AgentId agent);  ///< the model's row; see Memory

  /// Walls that stay, beside those of the navmesh: rooms and thin walls (walls.h).
  void setFixedWalls(std::vector<Wall> walls);

  /// The navmesh to walk on, or none. Its border becomes walls with the clearance of the walker it
  /// was built for (navigation.walkerRadius), agents find their places on it, and paths are found
  /// anew, within the budget. Give a new one when the world has changed.
  void setWorld(std::shared_ptr<const navmesh::World> world);

  /// Finds paths over cells (ground_cells.h) from now on, of the walls, the world and the obstacles
  /// there are and will be; places on the navmesh stay its own. Fails as GroundCells::make does.
  [[nodiscard]] tl::expected<void, Error> setCells(const CellSettings& settings);
  const CellNavigation* cells() const { return navigation_.cells(); }  ///< null without

  /// What is closed in this world and what costs more; null: all is open. Paths lead around it, and
  /// whoever is on the way turns back or aside once its path is found anew, within the budget,
  /// those near the change first. Nobody is pushed out of what closes around them: they may leave.
  ///
  /// `doors`: what is closed is shut, a wall to whoever is outside. Without: only nobody wants to
  /// go there (somebody stands in the way). setWorld() forgets the states.
  void setStates(std::shared_ptr<const navmesh::PolygonStates> states, bool doors = true);

  /// Something to walk around, which moves at `velocity` from tick to tick. On a navmesh it takes
  /// no part in finding paths: for that, carve it into the navmesh and set the world. Over cells it
  /// does. Fails as navmesh::validate does.
  [[nodiscard]] tl::expected<navmesh::ObstacleId, Error> addObstacle(
      const navmesh::Obstacle& obstacle, glm::vec2 velocity = glm::vec2(0.0f));
  [[nodiscard]] tl::expected<void, Error> moveObstacle(navmesh::ObstacleId id,
                                                       const navmesh::Obstacle& obstacle,
                                                       glm::vec2 velocity = glm::vec2(0.0f));
  bool removeObstacle(navmesh::ObstacleId id);

  /// One tick of `seconds` > 0. `forEach`: who runs the slices; empty: in turn, on this thread.
  const StepReport& step(float seconds, const navmesh::ForEach& forEach = {});

  /// Called at the end of each step with the new state: to record it.
  void onStep(std::function<void(const AgentsView&, const StepReport&)> record);

  AgentsView view() const;
  const StepReport& report() const { return report_; }
  const CrowdSettings& settings() const { return settings_; }
  std::span<const Wall> walls();  ///< as the next step will see them
  const Model& model(ModelId id) const { return *models_[static_cast<std::size_t>(id)].model; }
  ModelId modelOf(AgentId agent) const { return modelOf_[indexOf(agent)]; }

  /// The last plan of an agent, as its model gave it.
  const Plan& planOf(AgentId agent) const { return plan_[indexOf(agent)]; }

  /// A number that changes with every bit of ids, positions, velocities and headings, and not with
  /// the order in which agents are stored.
  std::uint64_t hash() const;

 private:
  struct OwnModel {
    std::unique_ptr<const Model> model;
    Needs needs;
    std::vector<std::uint32_t> due;                 // who is planned for in this sub-step
    std::vector<Plan> plans;                        // theirs
    std::vector<std::unique_ptr<Scratch>> scratch;  // one a slice
  };
  struct PlacedObstacle {
    navmesh::ObstacleId id;
    navmesh::Obstacle shape;
    glm::vec2 velocity;
  };

  bool isPlannedFor(std::uint32_t agent) const {
    return modelOf_[agent] != kNoModel && (flags_[agent] == 0 || flags_[agent] == kHuman);
  }
  void refreshWalls();
  void layCells();
  void moveObstacles(float seconds);
  void setPreferredVelocities(float seconds, const navmesh::ForEach& forEach);
  void planFor(OwnModel& own, std::uint32_t modelNumber, std::uint32_t subStep, float seconds,
               const navmesh::ForEach& forEach);
  void move(std::uint32_t agent, float seconds);
  void countStatus();
  template <typename Visit>
  void forArrays(const Visit& visit);

  CrowdSettings settings_;
  std::vector<OwnModel> models_;
  std::uint32_t memoryStride_ = 0;

  // Hot: read while planning.
  std::vector<AgentId> id_;
  std::vector<std::uint8_t> flags_;
  std::vector<std::uint32_t> group_;
  std::vector<glm::vec2> position_, velocity_;
  std::vector<float> heading_, height_, radius_;
  std::vector<float> preferredSpeed_, maximumSpeed_, maximumAcceleration_;
  std::vector<glm::vec2> preferredVelocity_, target_;
  std::vector<float> remaining_;
  // The crowd's own.
  std::vector<ModelId> modelOf_;
  std::vector<float> goalRadius_;
  std::vector<Plan> plan_;
  std::vector<float> planAge_;  // seconds since planned for; infinity: never
  std::vector<float> memory_;
  std::vector<float> heldUp_;  // seconds
  std::vector<const Needs*> needsOf_;
  std::vector<glm::vec2> before_;  // positions at the start of the tick
  std::vector<glm::vec2> moved_;   // and before projection
  std::vector<std::uint32_t> indexOfId_;
  Navigation navigation_;

  std::vector<Wall> fixedWalls_, borderWalls_, allWalls_;
  std::vector<PlacedObstacle> obstacles_;
  std::uint32_t nextObstacle_ = 0;
  bool wallsChanged_ = true;
  WallIndex wallIndex_;
  NeighbourIndex index_;
  Projection projection_;
  StepReport report_;
  std::function<void(const AgentsView&, const StepReport&)> record_;
};

}  // namespace forewalk::agents
