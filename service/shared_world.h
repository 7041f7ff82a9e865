// Several redirected users in one virtual world, each in a room of their own: they meet there, and
// make way for each other as the agents of a crowd do (reciprocal velocity obstacles).
//
// What they would do is planned every kTick from where all were in the frame before, so that it
// does not matter in which order they are asked.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "agents/crowd.h"
#include "navmesh/world.h"
#include "rdw/company.h"

namespace forewalk::service {

class SharedWorld {
 public:
  /// How often users decide, seconds; a whole number of frames.
  static constexpr double kTick = 0.05;
  /// Of the body that others see, metres.
  static constexpr float kRadius = 0.25f;

  /// For one walk of `users`. `world` null: an open plane. `walkerRadius`: of who the navmesh was
  /// built for, metres; `rate`: frames a second.
  SharedWorld(std::shared_ptr<const navmesh::World> world, float walkerRadius, double rate,
              std::size_t users);
  ~SharedWorld();
  SharedWorld(const SharedWorld&) = delete;
  SharedWorld& operator=(const SharedWorld&) = delete;

  /// One per user, what the others are to them; lives as long as this.
  std::span<rdw::Company* const> companies() const { return companies_; }

 private:
  class Member;

  tl::expected<void, Error> add(Member& member, const rdw::CompanyUser& user);
  void begin(std::uint64_t frame);

  double frameSeconds_;
  std::uint64_t framesPerTick_;
  agents::Crowd crowd_;
  agents::ModelId model_;
  std::vector<std::unique_ptr<Member>> members_;
  std::vector<rdw::Company*> companies_;
  std::uint64_t frame_ = 0;  // the one that is being walked
};

}  // namespace forewalk::service
