// The potential field of Messinger, Hodgson and Bachmann, IEEE VR 2019 (border_force.h), with other
// users as in Bachmann, Hodgson, Hoffbauer and Messinger, "Multi-User Redirected Walking and
// Resetting Using Artificial Potential Fields", TVCG 2019: sum of k * d / |d|^4.091.
//
// Turns the user toward the force. Theirs raises the rate from v / R toward 15 degrees a second as
// the nearest distance falls under R, beyond what the curvature limit allows; ours keeps to the
// limit, at which the rate is v / R already.
#include "rdw/controllers/border_force.h"
#include "rdw/controllers/controllers.h"
#include "rdw/controllers/follow.h"

namespace forewalk::rdw {
namespace {

class Messinger final : public Controller {
 public:
  void prepare(const TrackedSpace& space, const GainLimits&) override { border_.prepare(space); }

  Gains steer(const SteerInput& input) override {
    const glm::dvec2 position = input.physical.position;
    const glm::dvec2 facing = directionOf(input.physical.heading);
    glm::dvec2 force = border_.at(position);
    for (const OtherUser& other : input.others) {
      const glm::dvec2 d = position - other.position;
      const double distance = std::max(glm::length(d), 0.01);
      force += mutualSight(position, facing, other) * d / std::pow(distance, 4.091);
    }
    return follow_.toward(force, input);
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
