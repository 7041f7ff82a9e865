#include "rdw/controller.h"

#include <fmt/format.h>

#include <array>

#include "rdw/force.h"
#include "rdw/foresight.h"
#include "rdw/mpcred.h"
#include "rdw/predictive.h"
#include "rdw/steer_to.h"

namespace forewalk::rdw {

namespace {

constexpr std::array<std::string_view, 8> kNames{
    "none", "s2c", "s2o", "s2c-predictive", "s2o-predictive", "foresight", "mpcred", "force"};

}  // namespace

std::span<const std::string_view> controllerNames() { return kNames; }

tl::expected<std::unique_ptr<Controller>, Error> makeController(std::string_view name) {
  if (name == kNames[0]) return makeNoController();
  if (name == kNames[1]) return makeReactive(SteerRule::kCentre);
  if (name == kNames[2]) return makeReactive(SteerRule::kOrbit);
  if (name == kNames[3]) return makePredictive(SteerRule::kCentre);
  if (name == kNames[4]) return makePredictive(SteerRule::kOrbit);
  if (name == kNames[5]) return makeForesight();
  if (name == kNames[6]) return makeMpcred();
  if (name == kNames[7]) return makeForce();
  std::string known;
  for (std::string_view each : kNames) known += (known.empty() ? "" : ", ") + std::string(each);
  return tl::unexpected(
      Error{ErrorCode::kSettingOutOfRange,
            fmt::format("controller \"{}\" is not known, use one of {}.", name, known)});
}

}  // namespace forewalk::rdw
