// Steer-to-multiple-targets, without and with the centre. Hodgson and Bachmann, "Comparing Four
// Approaches to Generalized Redirected Walking", TVCG 2013.
//
// Three targets on a circle about the centre, 120 degrees apart; the one at the smallest bearing
// wins, anew every frame. Theirs lie 5 m out in a gymnasium; ours as far as steer-to-orbit's orbit,
// so that they lie inside smaller rooms too. The first points to the corner furthest from the
// centre.
#include <array>
#include <cmath>

#include "rdw/controllers/controllers.h"
#include "rdw/steer_to.h"

namespace forewalk::rdw {
namespace {

class S2MT final : public Controller {
 public:
  explicit S2MT(bool centre) : count_(centre ? 4 : 3) {}

  void prepare(const TrackedSpace& space, const GainLimits&) override {
    glm::dvec2 out(0.0, 1.0);
    double furthest = 0.0;
    for (const glm::dvec2 corner : space.ring(0)) {
      const double distance = glm::distance(corner, space.centre());
      if (distance <= furthest + 1e-6) continue;
      furthest = distance;
      out = (corner - space.centre()) / distance;
    }
    const double radius = orbitRadius(space);
    for (int i = 0; i < 3; ++i) {
      targets_[static_cast<std::size_t>(i)] =
          space.centre() + radius * rotated(out, 2.0 * kPi * i / 3.0);
    }
    targets_[3] = space.centre();
  }

  Gains steer(const SteerInput& input) override {
    const glm::dvec2 position = input.physical.position;
    const glm::dvec2 heading = directionOf(input.physical.heading);
    glm::dvec2 target = targets_[0];
    double smallest = INFINITY;
    for (std::size_t i = 0; i < count_; ++i) {
      const double bearing = std::abs(angleBetween(heading, targets_[i] - position));
      if (bearing < smallest) {
        smallest = bearing;
        target = targets_[i];
      }
    }
    return asGains(core_.steer(input.motion, position, heading, target, input.limits), input.motion,
                   input.limits);
  }

  void restart() override { core_.restart(); }
  std::string_view name() const override { return count_ == 4 ? "s2mt+c" : "s2mt"; }
  bool wantsPrediction() const override { return false; }

 private:
  std::size_t count_;
  std::array<glm::dvec2, 4> targets_{};
  SteerToCore core_;
};

}  // namespace

std::unique_ptr<Controller> makeS2MT(bool centre) { return std::make_unique<S2MT>(centre); }

}  // namespace forewalk::rdw
