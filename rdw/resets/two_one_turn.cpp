// The 2:1 turn. Williams et al., "Exploring Large Virtual Environments with an HMD when Physical
// Space is Limited", APGV 2007: the body turns by 180 degrees, either way, while the user sees 360.
#include "rdw/resets/resets.h"

namespace forewalk::rdw {
namespace {

class TwoOneTurn final : public ResetPolicy {
 public:
  ResetPlan plan(const SteerInput&) override { return {}; }
  std::string_view name() const override { return "two-one-turn"; }
};

}  // namespace

std::unique_ptr<ResetPolicy> makeTwoOneTurn() { return std::make_unique<TwoOneTurn>(); }

}  // namespace forewalk::rdw
