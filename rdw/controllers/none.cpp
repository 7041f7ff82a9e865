// No redirection: what every controller is compared with.
#include "rdw/controllers/controllers.h"

namespace forewalk::rdw {
namespace {

class NoController final : public Controller {
 public:
  Gains steer(const SteerInput&) override { return {}; }
  void restart() override {}
  std::string_view name() const override { return "none"; }
  bool wantsPrediction() const override { return false; }
};

}  // namespace

std::unique_ptr<Controller> makeNoController() { return std::make_unique<NoController>(); }

}  // namespace forewalk::rdw
