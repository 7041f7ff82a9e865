// The potential field of Messinger, Hodgson and Bachmann, IEEE VR 2019 (border_force.h), with other
// users as in Bachmann, Hodgson, Hoffbauer and Messinger, "Multi-User Redirected Walking and
// Resetting Using Artificial Potential Fields", TVCG 2019: sum of k * d / |d|^4.091.
//
// Turns the user toward the force at a rate of v / R, R = 7.5 m, raised toward 15 degrees a second
// as the nearest distance falls under R. Theirs thereby leaves the limit of curvature; ours does
// not: only where the limits allow more than 1 / 7.5 it does what theirs does.
#include "rdw/controllers/border_force.h"
#include "rdw/controllers/controllers.h"
#include "rdw/controllers/follow.h"
#include "rdw/free_way.h"

namespace forewalk::rdw {
namespace {

constexpr double kRadius = 7.5;                 // metres
constexpr double kRaised = 15.0 * kPi / 180.0;  // rad/s
constexpr double kSlowest = 0.2;                // m/s; of slower steps the rate says little

class Messinger final : public Controller {
 public:
  void prepare(const TrackedSpace& space, const GainLimits&) override { border_.prepare(space); }

  Gains steer(const SteerInput& input) override {
    const glm::dvec2 position = input.physical.position;
    const glm::dvec2 facing = directionOf(input.physical.heading);
    glm::dvec2 force = border_.at(position, input.space);
    for (const OtherUser& other : input.others) {
      const glm::dvec2 d = position - other.position;
      const double distance = std::max(glm::length(d), 0.01);
      force += mutualSight(position, facing, other) * d / std::pow(distance, 4.091);
    }
    const double near =
        std::clamp(clearanceAt(input.space, input.others, position) / kRadius, 0.0, 1.0);
    const double speed =
        std::max(kSlowest, input.motion.dt > 0.0 ? input.motion.distance / input.motion.dt : 0.0);
    GainLimits limits = input.limits;
    limits.curvatureMax = std::min(
        limits.curvatureMax, static_cast<float>(std::max(
                                 1.0 / kRadius, near / kRadius + (1.0 - near) * kRaised / speed)));
    return follow_.toward(force, input, limits);
  }
  void restart() override { follow_.restart(); }
  std::string_view name() const override { return "messinger"; }
  bool wantsPrediction() const override { return false; }

 private:
  BorderForce border_;
  Follow follow_;
};

}  // namespace

std::unique_ptr<Controller> makeMessinger() { return std::make_unique<Messinger>(); }

}  // namespace forewalk::rdw
