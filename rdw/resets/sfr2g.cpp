// Step-forward reset to gradient. Thomas and Suma Rosenberg, as R2G: five steps of 0.1 m down the
// gradient; the user ends facing the point that they lead to.
#include "rdw/potential_field.h"
#include "rdw/resets/resets.h"

namespace forewalk::rdw {
namespace {

constexpr int kSteps = 5;
constexpr double kStep = 0.1;  // metres

class SFR2G final : public ResetPolicy {
 public:
  ResetPlan plan(const SteerInput& input) override {
    glm::dvec2 point = input.physical.position;
    for (int i = 0; i < kSteps; ++i) {
      const glm::dvec2 down = repulsion(input.space, input.others, point);
      if (glm::length(down) < 1e-9) break;
      point += kStep * glm::normalize(down);
    }
    const glm::dvec2 way = point - input.physical.position;
    if (glm::length(way) < 1e-6) return {};
    return turnTo(aheadOf(input), glm::normalize(way));
  }
  std::string_view name() const override { return "sfr2g"; }
};

}  // namespace

std::unique_ptr<ResetPolicy> makeSFR2G() { return std::make_unique<SFR2G>(); }

}  // namespace forewalk::rdw
