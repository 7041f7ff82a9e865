// Passive haptics. Thomas, Hutton Pospick and Suma Rosenberg, "Towards Physically Interactive
// Virtual Environments: Reactive Alignment with Redirected Walking", VRST 2020: the user is to
// reach a virtual thing just when they reach the physical one (SessionSettings::haptic).
//
// Until it can be aligned: down -grad = 2 (target - p) + the repulsion of the room
// (potential_field.h). It can be where one constant curvature and one translation gain within the
// limits bring both distances and both directions to nothing at once: with c the physical distance,
// D the virtual one, and delta by how much further left the thing lies physically than virtually,
// the body has to walk the arc of chord c that leaves its tangent by delta, L = c delta / sin
// delta, k = 2 delta / L, and the translation gain is D / L. Without a thing to reach the centre is
// one that only pulls.
#include <algorithm>
#include <cmath>

#include "rdw/controllers/controllers.h"
#include "rdw/controllers/follow.h"
#include "rdw/potential_field.h"

namespace forewalk::rdw {
namespace {

constexpr double kStraight = 1e-6;      // radians
constexpr double kLargest = 0.5 * kPi;  // radians off, beyond which no arc is tried
constexpr double kTouched = 0.05;       // metres; nearer there is nothing to align

class PassiveHaptics final : public Controller {
 public:
  Gains steer(const SteerInput& input) override {
    const glm::dvec2 position = input.physical.position;
    const glm::dvec2 target = input.haptic ? input.haptic->physical : input.space.centre();
    if (input.haptic != nullptr) {
      if (const auto gains = aligned(input, *input.haptic)) return *gains;
    }
    return follow_.toward(
        2.0 * (target - position) + repulsion(input.space, input.others, position), input);
  }
  void restart() override { follow_.restart(); }
  std::string_view name() const override { return "haptics"; }
  bool wantsPrediction() const override { return false; }

 private:
  static std::optional<Gains> aligned(const SteerInput& input, const HapticTarget& haptic) {
    const Motion& motion = input.motion;
    if (!motion.walking) return std::nullopt;
    const glm::dvec2 ahead = motion.walkingDirection;
    const glm::dvec2 chord = haptic.physical - input.physical.position;
    const glm::dvec2 seen = haptic.virtualPlan - input.virtualPose.position;
    const double c = glm::length(chord);
    const double d = glm::length(seen);
    if (c < kTouched || d < kTouched) return std::nullopt;
    const double off = wrapAngle(angleBetween(ahead, chord) -
                                 angleBetween(input.redirection.directionToVirtual(ahead), seen));
    if (std::abs(off) > kLargest) return std::nullopt;
    const double length = std::abs(off) < kStraight ? c : c * off / std::sin(off);
    const double curvature = 2.0 * off / length;
    const double translation = d / length;
    const GainLimits& limits = input.limits;
    if (std::abs(curvature) > static_cast<double>(limits.curvatureMax) ||
        translation < static_cast<double>(limits.translationMin) ||
        translation > static_cast<double>(limits.translationMax))
      return std::nullopt;
    Gains gains;
    gains.curvature = static_cast<float>(curvature);
    gains.translation = static_cast<float>(translation);
    return clamped(gains, limits);
  }

  Follow follow_;
};

}  // namespace

std::unique_ptr<Controller> makePassiveHaptics() { return std::make_unique<PassiveHaptics>(); }

}  // namespace forewalk::rdw
