// Freeze-backup. Williams et al., APGV 2007: the picture is frozen while the user steps backwards.
//
// They go back along their own line to its point nearest the centre of the room, at least a metre
// and not into what is behind them. Where less than half a metre is free behind, stepping back
// would gain nothing: there it is a freeze-turn.
#include <algorithm>

#include "rdw/free_way.h"
#include "rdw/resets/resets.h"

namespace forewalk::rdw {
namespace {

constexpr double kLeast = 1.0;   // metres
constexpr double kUseful = 0.5;  // metres
constexpr double kBehind = 0.5;  // metres left free behind

class FreezeBackup final : public ResetPolicy {
 public:
  ResetPlan plan(const SteerInput& input) override {
    const glm::dvec2 position = input.physical.position;
    const glm::dvec2 back = -aheadOf(input);
    const double free = freeAlong(input.space, input.others, position, back) - kBehind;
    ResetPlan plan;
    plan.seen = 0.0;
    plan.frozen = true;
    if (free < kUseful) return plan;
    plan.back = std::min(free, std::max(kLeast, glm::dot(input.space.centre() - position, back)));
    plan.left = plan.right = 0.0;
    return plan;
  }
  std::string_view name() const override { return "freeze-backup"; }
};

}  // namespace

std::unique_ptr<ResetPolicy> makeFreezeBackup() { return std::make_unique<FreezeBackup>(); }

}  // namespace forewalk::rdw
