// Freeze-turn. Williams et al., APGV 2007: the picture is fixed to the head while the body turns by
// 180 degrees, either way; steps taken meanwhile move nothing either.
#include "rdw/resets/resets.h"

namespace forewalk::rdw {
namespace {

class FreezeTurn final : public ResetPolicy {
 public:
  ResetPlan plan(const SteerInput&) override {
    ResetPlan plan;
    plan.seen = 0.0;
    plan.frozen = true;
    return plan;
  }
  std::string_view name() const override { return "freeze-turn"; }
};

}  // namespace

std::unique_ptr<ResetPolicy> makeFreezeTurn() { return std::make_unique<FreezeTurn>(); }

}  // namespace forewalk::rdw
