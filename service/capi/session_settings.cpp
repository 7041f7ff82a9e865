#include "service/capi/session_settings.h"

#include <iterator>
#include <string>
#include <utility>

#include "service/capi/axes.h"
#include "service/capi/status.h"

namespace forewalk::capi {

namespace {

static_assert(FOREWALK_METHOD_POLYGON == static_cast<int>(prediction::Method::kPolygon));
static_assert(FOREWALK_METHOD_FRONT == static_cast<int>(prediction::Method::kFront));
static_assert(FOREWALK_HEADING_HEAD == static_cast<int>(rdw::HeadingSource::kHead));
static_assert(FOREWALK_HEADING_CHEST == static_cast<int>(rdw::HeadingSource::kChest));
static_assert(FOREWALK_HEADING_WALKING == static_cast<int>(rdw::HeadingSource::kWalking));

constexpr const char* kType = "forewalk_session_settings";

// In the order of their constants.
constexpr std::string_view kControllers[] = {
    "none",   "s2c",        "s2o",       "s2c-predictive", "s2o-predictive", "s2mt",
    "s2mt+c", "zigzag",     "p2r",       "messinger",      "dynamic-apf",    "haptics",
    "arc",    "visibility", "foresight", "mpcred",         "force"};
constexpr std::string_view kResets[] = {
    "two-one-turn", "freeze-turn", "freeze-backup", "r2c", "mr2c", "r2g", "sfr2g", "r2fd", "ahead"};
static_assert(std::size(kControllers) == FOREWALK_CONTROLLER_FORCE + 1);
static_assert(std::size(kResets) == FOREWALK_RESET_AHEAD + 1);
constexpr std::string_view kLimits[] = {"steinicke", "laboratory", "neth", "toolkit"};

rdw::GainLimits limitsOf(const forewalk_session_settings& settings) {
  if (settings.limits != FOREWALK_LIMITS_CUSTOM) {
    return rdw::gainLimitsByName(kLimits[settings.limits]).value();
  }
  return {.translationMin = settings.translation_min,
          .translationMax = settings.translation_max,
          .rotationMin = settings.rotation_min,
          .rotationMax = settings.rotation_max,
          .curvatureMax = settings.curvature_max,
          .bendingMin = settings.bending_min,
          .bendingMax = settings.bending_max};
}

forewalk_status checkForm(const forewalk_session_settings& settings) {
  const struct {
    const char* field;
    std::int32_t value;
    int last;
  } constants[] = {{"axes", settings.axes, FOREWALK_AXES_UNREAL},
                   {"controller", settings.controller, FOREWALK_CONTROLLER_FORCE},
                   {"reset", settings.reset, FOREWALK_RESET_AHEAD},
                   {"limits", settings.limits, FOREWALK_LIMITS_CUSTOM},
                   {"method", settings.method, FOREWALK_METHOD_FRONT},
                   {"heading_source", settings.heading_source, FOREWALK_HEADING_WALKING}};
  for (const auto& [field, value, last] : constants) {
    if (value < 0 || value > last) return unknownConstant(kType, field, value, last);
  }
  if (settings.space == nullptr) return checkForm(spaceForm(settings), kType);
  if (settings.border_count > 0 || settings.hole_count > 0 || settings.width != 0.0f ||
      settings.depth != 0.0f) {
    return failLiteral(
        FOREWALK_ERROR_ARGUMENT,
        "forewalk_session_settings: a space and a border, holes, a width or a depth. "
        "Give one of the two.");
  }
  return FOREWALK_OK;
}

tl::expected<rdw::SessionSettings, Error> sessionSettings(
    const forewalk_session_settings& settings) {
  rdw::SessionSettings ours;
  if (settings.space != nullptr) {
    ours.space = settings.space->space;
  } else {
    auto space = makeSpace(spaceForm(settings), kType);
    if (!space) return tl::unexpected(space.error());
    ours.space = std::move(*space);
  }
  ours.limits = limitsOf(settings);
  ours.controller = controllerName(settings.controller);
  ours.horizon = settings.horizon;
  ours.alwaysPredict = settings.always_predict != 0;
  ours.alwaysLikely = settings.likelihoods != 0;
  ours.heading = static_cast<rdw::HeadingSource>(settings.heading_source);
  if (settings.has_start != 0) {
    ours.start = startFrom(settings.axes, settings.start_floor, settings.start_heading);
  }
  ours.prediction.polygons = settings.polygon_limit;
  ours.resets = settings.resets != 0;
  ours.resetPolicy = kResets[settings.reset];
  ours.method = static_cast<prediction::Method>(settings.method);
  ours.front.persistence = settings.persistence;
  return ours;
}

}  // namespace

forewalk_session_settings defaultSessionSettings() {
  const rdw::SessionSettings ours;
  const rdw::GainLimits& limits = ours.limits;
  forewalk_session_settings settings{};
  settings.struct_size = sizeof settings;
  settings.axes = FOREWALK_AXES_OPENXR;
  settings.controller = FOREWALK_CONTROLLER_S2C_PREDICTIVE;
  settings.limits = FOREWALK_LIMITS_STEINICKE;
  settings.horizon = ours.horizon;
  settings.translation_min = limits.translationMin;
  settings.translation_max = limits.translationMax;
  settings.rotation_min = limits.rotationMin;
  settings.rotation_max = limits.rotationMax;
  settings.curvature_max = limits.curvatureMax;
  settings.bending_min = limits.bendingMin;
  settings.bending_max = limits.bendingMax;
  settings.polygon_limit = ours.prediction.polygons;
  settings.resets = 1;
  settings.always_predict = 1;
  settings.method = static_cast<forewalk_method>(ours.method);
  settings.persistence = ours.front.persistence;
  return settings;
}

forewalk_status readSession(const forewalk_session_settings* given,
                            forewalk_session_settings& known, rdw::SessionSettings& ours) {
  known = defaultSessionSettings();
  if (const auto status = readSettings(given, kType, known)) return status;
  if (const auto status = checkForm(known)) return status;
  auto made = sessionSettings(known);
  if (!made) return fail(made.error());
  ours = std::move(*made);
  return FOREWALK_OK;
}

rdw::VirtualStart startFrom(forewalk_axes axes, forewalk_vec3 floor, float heading) {
  return {positionFrom(axes, floor), angleSign(axes) * heading};
}

std::string_view controllerName(forewalk_controller controller) { return kControllers[controller]; }

}  // namespace forewalk::capi
