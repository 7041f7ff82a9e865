#include "rdw/reset_policy.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "rdw/reset_ahead.h"
#include "rdw/resets/resets.h"

namespace forewalk::rdw {

namespace {

struct Entry {
  std::string_view name;
  std::unique_ptr<ResetPolicy> (*make)();
};

// A new reset is a line here.
constexpr std::array kResets{
    Entry{"two-one-turn", makeTwoOneTurn},
    Entry{"freeze-turn", makeFreezeTurn},
    Entry{"freeze-backup", makeFreezeBackup},
    Entry{"r2c", makeR2C},
    Entry{"mr2c", makeMR2C},
    Entry{"r2g", makeR2G},
    Entry{"sfr2g", makeSFR2G},
    Entry{"r2fd", makeR2FD},
    Entry{"ahead", makeResetAhead},
};

constexpr auto kNames = [] {
  std::array<std::string_view, kResets.size()> names;
  for (std::size_t i = 0; i < names.size(); ++i) names[i] = kResets[i].name;
  return names;
}();

}  // namespace

glm::dvec2 aheadOf(const SteerInput& input) {
  const Motion& motion = input.motion;
  if (motion.walking) return motion.walkingDirection;
  if (motion.distance > 1e-6) return motion.step / motion.distance;
  return directionOf(input.physical.heading);
}

ResetPlan turnTo(glm::dvec2 ahead, glm::dvec2 direction) {
  const double angle = angleBetween(ahead, direction);
  ResetPlan plan;
  plan.left = plan.right = ResetPlan::kNever;
  (angle > 0.0 ? plan.right : plan.left) = 2.0 * kPi - std::abs(angle);
  return plan;
}

std::span<const std::string_view> resetNames() { return kNames; }

tl::expected<std::unique_ptr<ResetPolicy>, Error> makeReset(std::string_view name) {
  for (const Entry& entry : kResets) {
    if (entry.name == name) return entry.make();
  }
  std::string known;
  for (std::string_view each : kNames) known += (known.empty() ? "" : ", ") + std::string(each);
  return tl::unexpected(
      Error{ErrorCode::kSettingOutOfRange,
            fmt::format("reset \"{}\" is not known, use one of {}.", name, known)});
}

}  // namespace forewalk::rdw
