// Steer-to-center and steer-to-orbit: the reactive rules of rdw/steer_to.h as controllers.
#include "rdw/steer_to.h"

namespace forewalk::rdw {
namespace {

class Reactive final : public Controller {
 public:
  Reactive(SteerRule rule, const SteerToSettings& settings) : rule_(rule), core_(settings) {}

  Gains steer(const SteerInput& input) override {
    const glm::dvec2 position = input.physical.position;
    const glm::dvec2 heading = directionOf(input.physical.heading);
    const glm::dvec2 target = rule_ == SteerRule::kCentre
                                  ? centre_.target(position, heading, input.space)
                                  : orbitTarget(position, heading, input.space);
    return asGains(core_.steer(input.motion, position, heading, target, input.limits), input.motion,
                   input.limits);
  }

  void restart() override {
    core_.restart();
    centre_.restart();
  }

  std::string_view name() const override { return rule_ == SteerRule::kCentre ? "s2c" : "s2o"; }
  bool wantsPrediction() const override { return false; }

 private:
  SteerRule rule_;
  SteerToCore core_;
  CentreTarget centre_;
};

}  // namespace

std::unique_ptr<Controller> makeReactive(SteerRule rule, const SteerToSettings& settings) {
  return std::make_unique<Reactive>(rule, settings);
}

}  // namespace forewalk::rdw
