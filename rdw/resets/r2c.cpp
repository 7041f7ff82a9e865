// Reset to centre. Thomas and Suma Rosenberg, "Reactive Alignment of Virtual and Physical
// Environments", ISMAR 2019 adjunct: the user ends facing the centre, after 360 virtual degrees.
// The centre is the pole of inaccessibility.
#include "rdw/resets/resets.h"

namespace forewalk::rdw {
namespace {

class R2C final : public ResetPolicy {
 public:
  ResetPlan plan(const SteerInput& input) override {
    const glm::dvec2 way = input.space.centre() - input.physical.position;
    if (glm::length(way) < 1e-6) return {};
    return turnTo(aheadOf(input), glm::normalize(way));
  }
  std::string_view name() const override { return "r2c"; }
};

}  // namespace

std::unique_ptr<ResetPolicy> makeR2C() { return std::make_unique<R2C>(); }

}  // namespace forewalk::rdw
