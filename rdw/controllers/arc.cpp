// ARC, the alignment-based controller. Williams, Bera and Manocha, "ARC: Alignment-based
// Redirection Controller for Redirected Walking in Complex Environments", TVCG 2021.
//
// Free ways ahead, left and right, in the room and in the virtual world; A is the sum of their
// differences. A of nothing: no gains. Translation is the virtual way ahead over the physical one;
// curvature bends to the side that has more room physically than virtually, by min(1, that much) of
// the limit; turning is sped up while it makes A smaller, slowed while it makes it larger. We
// depart in that ways count up to 50 m only (an endless plane has no end), and that the blend of
// the rotation gain is a time constant that equals their 0.125 at 60 Hz.
#include <algorithm>
#include <cmath>

#include "navmesh/sight.h"
#include "rdw/controllers/controllers.h"
#include "rdw/free_way.h"

namespace forewalk::rdw {
namespace {

constexpr double kFarthest = 50.0;              // metres
constexpr double kAligned = 0.01;               // metres
constexpr double kTurning = 1.5 * kPi / 180.0;  // rad/s
constexpr double kBlend = 0.125;                // share of the new at 60 Hz

class Arc final : public Controller {
 public:
  Gains steer(const SteerInput& input) override {
    const Motion& motion = input.motion;
    const GainLimits& limits = input.limits;
    const glm::dvec2 ahead = directionOf(input.physical.heading);
    const glm::dvec2 left(-ahead.y, ahead.x);
    const Pair front = along(ahead, input);
    const Pair toLeft = along(left, input);
    const Pair toRight = along(-left, input);
    const double misaligned = front.off() + toLeft.off() + toRight.off();
    const double before = misaligned_;
    misaligned_ = misaligned;
    if (misaligned < kAligned) {
      rotation_ = 1.0;
      return {};
    }
    Gains gains;
    gains.translation = front.physical > 0.0 ? static_cast<float>(front.seen / front.physical)
                                             : limits.translationMax;
    const double leftMore = toLeft.physical - toLeft.seen;
    const double rightMore = toRight.physical - toRight.seen;
    const double side = leftMore > rightMore ? 1.0 : -1.0;
    const double strength = std::min(1.0, std::abs(std::max(leftMore, rightMore)));
    if (leftMore != rightMore)
      gains.curvature = static_cast<float>(side * strength) * limits.curvatureMax;
    double wanted = 1.0;
    if (std::abs(motion.turnRate) >= kTurning && before >= 0.0 && misaligned != before) {
      wanted = static_cast<double>(misaligned < before ? limits.rotationMax : limits.rotationMin);
    }
    const double kept = std::pow(1.0 - kBlend, 60.0 * motion.dt);
    rotation_ = kept * rotation_ + (1.0 - kept) * wanted;
    gains.rotation = static_cast<float>(rotation_);
    return clamped(gains, limits);
  }

  void restart() override {
    misaligned_ = -1.0;
    rotation_ = 1.0;
  }
  std::string_view name() const override { return "arc"; }
  bool wantsPrediction() const override { return false; }

 private:
  struct Pair {
    double physical, seen;  // metres
    double off() const { return std::abs(physical - seen); }
  };

  static Pair along(glm::dvec2 direction, const SteerInput& input) {
    const double physical = std::min(
        kFarthest, freeAlong(input.space, input.others, input.physical.position, direction));
    if (input.world == nullptr || input.place.polygon == navmesh::kNoPolygon)
      return {physical, kFarthest};
    return {physical,
            navmesh::sightAlong(input.world->graph, input.place,
                                input.redirection.directionToVirtual(direction), kFarthest)};
  }

  double misaligned_ = -1.0;  // in the last frame; below 0: none
  double rotation_ = 1.0;
};

}  // namespace

std::unique_ptr<Controller> makeArc() { return std::make_unique<Arc>(); }

}  // namespace forewalk::rdw
