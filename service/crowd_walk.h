// A crowd from its file on its way: places, goals that follow one another, humans, tick by tick.
//
// What came of it is measured by who walks it: crowd_run.h for crowds alone, walk_company.h for
// those around a redirected user.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <memory>
#include <optional>
#include <random>
#include <span>
#include <string>
#include <string_view>
#include <tl/expected.hpp>
#include <utility>
#include <vector>

#include "agents/crowd.h"
#include "navmesh/error.h"
#include "navmesh/for_each.h"
#include "navmesh/world.h"
#include "service/crowd_config.h"
#include "service/sweep.h"

namespace forewalk::service {

class CrowdWalk {
 public:
  /// Somebody of a group, and how far they are on their way.
  struct Member {
    agents::AgentId id;
    std::uint32_t group;
    std::uint32_t place;  ///< within the group
    float radius;
    std::vector<glm::vec2> goals{};
    std::size_t next = 0;  ///< of goals, the one that is walked to
    bool departed = false, arrived = false;
    bool legMeasured = false;
    double legShortest = 0.0, legWalked = 0.0;
    double speed = 0.0;  ///< m/s, from place to place: whoever is pushed back where they were has
                         ///< none
    glm::vec2 last{0.0f};
  };

  /// Somebody who is there already, for whom the members leave room.
  struct Body {
    glm::vec2 plan;
    float height, radius;
  };

  /// `config` has to outlive it. `world` null: an open plane; `walkerRadius`: of who the navmesh
  /// was built for, metres.
  CrowdWalk(const CrowdConfig& config, std::shared_ptr<const navmesh::World> world,
            float walkerRadius);

  /// Lays walls and obstacles, and puts everybody at their start. Once. Fails as runCrowd does.
  [[nodiscard]] tl::expected<void, Error> populate(std::span<const Body> others = {});

  /// A tick of the config's: goals, humans, the crowd's step, and what it made of everybody's way.
  /// Bit-identical for any `forEach`.
  void tick(const navmesh::ForEach& forEach = {});

  double seconds() const { return static_cast<double>(ticks_) * config_.tick; }
  std::span<const Member> members() const { return members_; }
  agents::Crowd& crowd() { return crowd_; }
  const agents::Crowd& crowd() const { return crowd_; }
  bool hasFinalGoal(const Member& member) const;

  /// Seconds from departure of those with a goal that can be reached for good, as they arrived.
  const std::vector<double>& arrivals() const { return arrivals_; }
  /// Shortest way over walked way, a leg each, in (0, 1].
  const std::vector<double>& efficiency() const { return efficiency_; }

 private:
  class Occupied;

  static agents::CrowdSettings settings(const CrowdConfig& config, float walkerRadius);
  void layGround();
  void placeObstacles();
  Error groupError(std::uint32_t group, ErrorCode code, const std::string& sentence) const;
  std::optional<glm::vec3> onGround(glm::vec2 at, float height, float radius);
  glm::vec2 randomIn(const PlanArea& area);
  float within(glm::vec2 range);
  std::pair<glm::vec2, float> anywhere();
  template <typename Draw>
  tl::expected<glm::vec3, Error> roomFor(std::uint32_t g, float radius, const Occupied* occupied,
                                         std::string_view what, const Draw& draw);
  tl::expected<glm::vec3, Error> given(std::uint32_t g, glm::vec2 at, std::string_view what);
  tl::expected<glm::vec3, Error> startOf(std::uint32_t g, std::uint32_t k, float radius,
                                         const Occupied& occupied);
  tl::expected<std::vector<glm::vec2>, Error> goalsOf(std::uint32_t g, std::uint32_t k,
                                                      float radius, glm::vec2 start);
  tl::expected<void, Error> add(std::uint32_t g, std::uint32_t k, agents::ModelId model,
                                Occupied& occupied);
  void setOut(Member& member);
  void setGoals(double now, double seconds);
  void moveHumans(double seconds);
  void follow(const Member& member);
  void measureLegs();
  void arrive(Member& member, double now);

  const CrowdConfig& config_;
  std::shared_ptr<const navmesh::World> world_;
  std::optional<PlacesByArea> places_;
  std::mt19937_64 rng_;
  agents::Crowd crowd_;
  std::vector<Member> members_;
  std::vector<std::size_t> firstOf_;  // of each group, in members_
  std::vector<std::optional<navmesh::ObstacleId>>
      obstacles_;  // of the file's: those that are there
  double nextFollow_ = 0.0;
  std::uint64_t ticks_ = 0;
  std::vector<double> arrivals_, efficiency_;
};

}  // namespace forewalk::service
