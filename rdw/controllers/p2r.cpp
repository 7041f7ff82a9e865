// P2R, push/pull reactive. Thomas and Suma Rosenberg, "A General Reactive Algorithm for Redirected
// Walking Using Artificial Potential Functions", IEEE VR 2019.
//
// Turns the user toward n = -grad U (potential_field.h) by curvature or rotation, whichever is
// more; somebody who goes against n is slowed physically: the translation gain is at its upper
// limit.
#include "rdw/controllers/controllers.h"
#include "rdw/controllers/follow.h"
#include "rdw/potential_field.h"

namespace forewalk::rdw {
namespace {

class P2R final : public Controller {
 public:
  Gains steer(const SteerInput& input) override {
    const glm::dvec2 down = repulsion(input.space, input.others, input.physical.position);
    Gains gains = follow_.toward(down, input);
    if (glm::dot(down, directionOf(input.physical.heading)) < 0.0)
      gains.translation = input.limits.translationMax;
    return gains;
  }
  void restart() override { follow_.restart(); }
  std::string_view name() const override { return "p2r"; }
  bool wantsPrediction() const override { return false; }

 private:
  Follow follow_;
};

}  // namespace

std::unique_ptr<Controller> makeP2R() { return std::make_unique<P2R>(); }

}  // namespace forewalk::rdw
