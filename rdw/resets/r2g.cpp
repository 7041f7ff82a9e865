// Reset to gradient. Thomas and Suma Rosenberg, "A General Reactive Algorithm for Redirected
// Walking Using Artificial Potential Functions", IEEE VR 2019: the user ends facing -grad U
// (potential_field.h), after 360 virtual degrees.
#include "rdw/potential_field.h"
#include "rdw/resets/resets.h"

namespace forewalk::rdw {
namespace {

class R2G final : public ResetPolicy {
 public:
  ResetPlan plan(const SteerInput& input) override {
    const glm::dvec2 down = repulsion(input.space, input.others, input.physical.position);
    if (glm::length(down) < 1e-9) return {};
    return turnTo(aheadOf(input), glm::normalize(down));
  }
  std::string_view name() const override { return "r2g"; }
};

}  // namespace

std::unique_ptr<ResetPolicy> makeR2G() { return std::make_unique<R2G>(); }

}  // namespace forewalk::rdw
