#include "rdw/controller.h"

#include <fmt/format.h>

#include <array>
#include <string>

#include "rdw/controllers/controllers.h"
#include "rdw/force.h"
#include "rdw/foresight.h"
#include "rdw/mpcred.h"
#include "rdw/predictive.h"
#include "rdw/steer_to.h"

namespace forewalk::rdw {

namespace {

struct Entry {
  std::string_view name;
  std::unique_ptr<Controller> (*make)();
};

// A new controller is a line here.
constexpr std::array kControllers{
    Entry{"none", makeNoController},
    Entry{"s2c", [] { return makeReactive(SteerRule::kCentre); }},
    Entry{"s2o", [] { return makeReactive(SteerRule::kOrbit); }},
    Entry{"s2c-predictive", [] { return makePredictive(SteerRule::kCentre); }},
    Entry{"s2o-predictive", [] { return makePredictive(SteerRule::kOrbit); }},
    Entry{"s2mt", [] { return makeS2MT(false); }},
    Entry{"s2mt+c", [] { return makeS2MT(true); }},
    Entry{"zigzag", makeZigzag},
    Entry{"p2r", makeP2R},
    Entry{"messinger", makeMessinger},
    Entry{"dynamic-apf", makeDynamicApf},
    Entry{"haptics", makePassiveHaptics},
    Entry{"arc", makeArc},
    Entry{"visibility", makeVisibilityPolygons},
    Entry{"foresight", [] { return makeForesight(); }},
    Entry{"mpcred", [] { return makeMpcred(); }},
    Entry{"force", [] { return makeForce(); }},
};

constexpr auto kNames = [] {
  std::array<std::string_view, kControllers.size()> names;
  for (std::size_t i = 0; i < names.size(); ++i) names[i] = kControllers[i].name;
  return names;
}();

}  // namespace

std::span<const std::string_view> controllerNames() { return kNames; }

tl::expected<std::unique_ptr<Controller>, Error> makeController(std::string_view name) {
  for (const Entry& entry : kControllers) {
    if (entry.name == name) return entry.make();
  }
  std::string known;
  for (std::string_view each : kNames) known += (known.empty() ? "" : ", ") + std::string(each);
  return tl::unexpected(
      Error{ErrorCode::kSettingOutOfRange,
            fmt::format("controller \"{}\" is not known, use one of {}.", name, known)});
}

}  // namespace forewalk::rdw
