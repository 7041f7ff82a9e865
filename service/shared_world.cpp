#include "service/shared_world.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "service/crowd_models.h"
#include "service/walk_company.h"

namespace forewalk::service {
namespace {

constexpr float kGoalAhead = 0.05f;  // metres; a user's goal radius

agents::CrowdSettings settingsFor(float walkerRadius) {
  agents::CrowdSettings settings;
  settings.navigation.walkerRadius = walkerRadius;
  return settings;
}

}  // namespace

/// A user, as the others see them, and what the others are to them.
class SharedWorld::Member final : public rdw::Company {
 public:
  Member(SharedWorld& shared, std::size_t users) : shared_(shared), touching_(users, false) {
    summary_.others = static_cast<std::uint32_t>(users - 1);
    summary_.userAvoids = true;
  }

  tl::expected<void, Error> begin(const rdw::CompanyUser& user) override {
    now_ = before_ = atTick_ = user;
    return shared_.add(*this, user);
  }

  void follow(std::uint64_t frame, const rdw::CompanyUser& user) override {
    shared_.begin(frame);
    now_ = user;
    frame_ = frame;
    // For the next frame: in this one some have walked already.
    way_ = wayOf(shared_.crowd_, id_);
    meet();
  }

  std::shared_ptr<const navmesh::PolygonStates> states() const override { return nullptr; }
  bool userAvoids() const override { return true; }

  std::optional<glm::dvec2> makeWay() const override { return way_; }

  rdw::CompanyRecord record() const override { return record_; }

  rdw::CompanySummary summary() const override {
    rdw::CompanySummary summary = summary_;
    summary.hash = shared_.crowd_.hash();
    return summary;
  }

 private:
  friend class SharedWorld;

  // The others are where they were in the frame before, whoever has moved since.
  void meet() {
    record_.clearance = std::numeric_limits<double>::infinity();
    bool inCollision = false;
    for (std::size_t i = 0; i < shared_.members_.size(); ++i) {
      const Member& other = *shared_.members_[i];
      if (&other == this || !other.here_ ||
          std::abs(other.before_.height - now_.height) > kStorey) {
        touching_[i] = false;
        continue;
      }
      const double bodies = 2.0 * static_cast<double>(kRadius);
      const double clearance =
          glm::distance(other.before_.pose.position, now_.pose.position) - bodies;
      record_.clearance = std::min(record_.clearance, clearance);
      const bool touches = clearance < -static_cast<double>(kTouch) * bodies;
      if (touches && !touching_[i]) ++record_.collisions;
      touching_[i] = touches;
      inCollision = inCollision || touches;
    }
    summary_.minimumSeparation = std::min(summary_.minimumSeparation, record_.clearance);
    summary_.collisions = record_.collisions;
    if (inCollision) summary_.collisionSeconds += shared_.frameSeconds_;
  }

  SharedWorld& shared_;
  agents::AgentId id_{};
  rdw::CompanyUser now_, before_, atTick_;  // in this frame, in the last, at the last tick
  std::uint64_t frame_ = 0;                 // the last one walked
  bool here_ = true;                        // not done yet
  std::optional<glm::dvec2> way_;           // to make way
  std::vector<bool> touching_;
  rdw::CompanyRecord record_;
  rdw::CompanySummary summary_;
};

SharedWorld::SharedWorld(std::shared_ptr<const navmesh::World> world, float walkerRadius,
                         double rate, std::size_t users)
    : frameSeconds_(1.0 / rate),
      framesPerTick_(static_cast<std::uint64_t>(std::max(1.0, std::round(kTick * rate)))),
      crowd_(settingsFor(walkerRadius)),
      model_(crowd_.addModel(registeredModels().front().read(nullptr)())) {
  if (world != nullptr) crowd_.setWorld(std::move(world));
  for (std::size_t i = 0; i < users; ++i) {
    members_.push_back(std::make_unique<Member>(*this, users));
    companies_.push_back(members_.back().get());
  }
}

SharedWorld::~SharedWorld() = default;

tl::expected<void, Error> SharedWorld::add(Member& member, const rdw::CompanyUser& user) {
  agents::AgentSpec spec;
  spec.flags = agents::kHuman;
  spec.position = glm::vec2(user.pose.position);
  spec.height = user.height;
  spec.heading = static_cast<float>(user.pose.heading);
  spec.radius = kRadius;
  spec.goalRadius = kGoalAhead;
  spec.preferredSpeed = static_cast<float>(user.speed);
  spec.maximumSpeed = std::max(2.0f, 1.5f * spec.preferredSpeed);
  spec.model = model_;
  const auto added = crowd_.add(spec);
  if (!added) return tl::unexpected(added.error());
  member.id_ = *added;
  return {};
}

void SharedWorld::begin(std::uint64_t frame) {
  if (frame == frame_) return;
  for (const auto& member : members_) {
    // Who did not walk the last frame is done, and gone.
    if (member->here_ && member->frame_ != frame_) {
      member->here_ = false;
      crowd_.remove(member->id_);
    }
    member->before_ = member->now_;
  }
  frame_ = frame;
  if (frame % framesPerTick_ != 0) return;
  const double seconds = static_cast<double>(framesPerTick_) * frameSeconds_;
  for (const auto& member : members_) {
    if (!member->here_) continue;
    const rdw::CompanyUser& user = member->before_;
    const glm::dvec2 moved = user.pose.position - member->atTick_.pose.position;
    member->atTick_ = user;
    crowd_.place(member->id_, glm::vec2(user.pose.position), user.height,
                 static_cast<float>(user.pose.heading), glm::vec2(moved / seconds));
    crowd_.setPreferredSpeed(member->id_, static_cast<float>(user.speed));
    if (user.goal) {
      crowd_.setGoal(member->id_, glm::vec2(*user.goal), user.height);
    } else {
      crowd_.clearGoal(member->id_);
    }
  }
  crowd_.step(static_cast<float>(seconds));
}

}  // namespace forewalk::service
