// A crowd around the redirected user of a simulated walk: agents and rdw meet here.
//
// Every tick the user is put where they are in the virtual world, as a human who yields to nobody;
// the crowd takes its step; and who has stood long enough blocks ways (navmesh/standing.h). Frames
// in between see agents walk on evenly.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <memory>
#include <optional>
#include <tl/expected.hpp>
#include <vector>

#include "agents/crowd.h"
#include "agents/overlaps.h"
#include "navmesh/for_each.h"
#include "navmesh/standing.h"
#include "navmesh/world.h"
#include "rdw/company.h"
#include "service/company_config.h"
#include "service/crowd_walk.h"

namespace forewalk::service {

inline constexpr float kTouch = 0.01f;  ///< share of the radii's sum; deeper is a collision
inline constexpr float kStorey = 2.0f;  ///< metres; who is farther above or below is elsewhere

/// How a human of a crowd would walk now to make way, by what its model planned in its last step,
/// m/s on the plan; none: as it likes.
std::optional<glm::dvec2> wayOf(const agents::Crowd& crowd, agents::AgentId human);

class WalkCompany final : public rdw::Company {
 public:
  /// For one walk. `world` null: an open plane. `walkerRadius`: of who the navmesh was built for,
  /// metres; `rate`: frames a second. The walk is the same for any `forEach`.
  WalkCompany(CompanyConfig config, std::shared_ptr<const navmesh::World> world, float walkerRadius,
              double rate, navmesh::ForEach forEach = {});

  WalkCompany(const WalkCompany&) = delete;
  WalkCompany& operator=(const WalkCompany&) = delete;

  [[nodiscard]] tl::expected<void, Error> begin(const rdw::CompanyUser& user) override;
  void follow(std::uint64_t frame, const rdw::CompanyUser& user) override;
  std::shared_ptr<const navmesh::PolygonStates> states() const override { return states_; }
  bool userAvoids() const override { return config_.userAvoids; }
  std::optional<glm::dvec2> makeWay() const override;
  rdw::CompanyRecord record() const override { return record_; }
  rdw::CompanySummary summary() const override;

  /// Where agent `member` is at the last frame's time, plan metres.
  glm::vec2 positionOf(std::size_t member) const;
  const CrowdWalk& crowdWalk() const { return walk_; }

 private:
  /// Somebody who may be standing: where they came to a stand, and for how long that was.
  struct Stand {
    glm::vec2 at;
    float seconds;
  };

  void tick(const rdw::CompanyUser& user);
  void block();
  void meet(const rdw::CompanyUser& user);

  CompanyConfig config_;
  std::shared_ptr<const navmesh::World> world_;
  double frameSeconds_;
  std::uint64_t framesPerTick_;
  navmesh::ForEach forEach_;
  CrowdWalk walk_;  // refers to config_
  agents::AgentId user_{};
  std::vector<glm::vec2> from_;  // of members, at the last tick
  std::vector<Stand> stands_;
  float sinceTick_ = 0.0f;  // share of the tick that has passed
  glm::dvec2 userAt_{0.0};  // at the last tick
  std::vector<navmesh::PolygonCost> blocked_, found_;
  std::shared_ptr<const navmesh::PolygonStates> states_;
  std::vector<bool> touching_;  // of members, the user
  agents::CollisionCounter amongOthers_;
  rdw::CompanyRecord record_;
  rdw::CompanySummary summary_;
};

}  // namespace forewalk::service
