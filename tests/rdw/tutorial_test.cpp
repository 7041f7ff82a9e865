// The code of rdw/controllers/README.md, compiled and walked with.
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <string>

#include "rdw/controllers/follow.h"
#include "rdw/simulation.h"

namespace {

using namespace forewalk;

// [tutorial]
class AwayFromBorder final : public rdw::Controller {
 public:
  rdw::Gains steer(const rdw::SteerInput& input) override {
    const auto border = input.space.nearestBorder(input.physical.position);
    return follow_.toward(border.inward, input);
  }
  void restart() override { follow_.restart(); }
  std::string_view name() const override { return "away"; }
  bool wantsPrediction() const override { return false; }

 private:
  rdw::Follow follow_;
};
// [tutorial]

std::string contents(const std::string& path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), {}};
}

TEST(Tutorial, IsWhatTheReadmeSays) {
  const std::string test = contents(FOREWALK_SOURCE "/tests/rdw/tutorial_test.cpp");
  const std::string mark = "// [tutorial]\n";
  const std::size_t begin = test.find(mark) + mark.size();
  const std::string code = test.substr(begin, test.find(mark, begin) - begin);
  EXPECT_NE(contents(FOREWALK_SOURCE "/rdw/controllers/README.md").find(code), std::string::npos);
}

TEST(Tutorial, NeedsFewerResetsThanNothing) {
  const auto resetsWith = [](rdw::ControllerMaker maker) {
    std::uint64_t resets = 0;
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
      rdw::SimulationConfig config;
      config.session.space = *rdw::TrackedSpace::rectangle(15.0, 15.0);
      config.session.limits = *rdw::gainLimitsByName("toolkit");
      config.session.controller = "none";
      config.session.makeController = maker;
      config.user.plan = rdw::Legs{};
      config.stop.virtualMetres = 500.0;
      config.keepFrames = false;
      config.seed = seed;
      resets += rdw::simulate(nullptr, config)->summary.resets;
    }
    return resets;
  };
  const std::uint64_t without = resetsWith({});
  const std::uint64_t with = resetsWith([] { return std::make_unique<AwayFromBorder>(); });
  EXPECT_LT(with, without);
}

}  // namespace
