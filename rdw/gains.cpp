#include "rdw/gains.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace forewalk::rdw {

namespace {

constexpr GainLimits withCurvature(float curvatureMax) {
  GainLimits limits;
  limits.curvatureMax = curvatureMax;
  return limits;
}

constexpr GainLimits toolkitLimits() {
  GainLimits limits = withCurvature(1.0f / 7.5f);
  limits.rotationMin = 0.80f;
  limits.rotationMax = 1.49f;
  return limits;
}

constexpr std::array<GainPreset, 4> kPresets{{
    {"steinicke", GainLimits{},
     "Steinicke et al., Estimation of Detection Thresholds for Redirected Walking, TVCG 2010"},
    {"laboratory", withCurvature(1.0f / 7.5f),
     "Steinicke's ratios with a radius of 7.5 m, common in laboratories; a third of the undetected "
     "22 m"},
    {"neth", withCurvature(1.0f / 10.0f),
     "Steinicke's ratios with a radius of 10 m, undetected at slow walking; Neth et al., TVCG "
     "2012"},
    {"toolkit", toolkitLimits(),
     "RDWT 2016 and OpenRDW 2022 as shipped: the rotation band the wrong way round, radius 7.5 m"},
}};

float orNeutral(float gain, float low, float high, float neutral) {
  return std::isnan(gain) ? neutral : std::clamp(gain, low, high);
}

tl::expected<void, Error> validateRatio(const char* name, float low, float high) {
  if (std::isfinite(low) && std::isfinite(high) && low > 0.0f && low <= 1.0f && high >= 1.0f)
    return {};
  return tl::unexpected(Error{ErrorCode::kSettingOutOfRange,
                              fmt::format("gain limits: {} from {} to {} (virtual/physical) cannot "
                                          "work: give a range above 0 that holds 1.",
                                          name, low, high)});
}

}  // namespace

std::span<const GainPreset> gainPresets() { return kPresets; }

std::optional<GainLimits> gainLimitsByName(std::string_view name) {
  for (const GainPreset& preset : kPresets) {
    if (preset.name == name) return preset.limits;
  }
  return std::nullopt;
}

Gains clamped(const Gains& gains, const GainLimits& limits) {
  return {orNeutral(gains.translation, limits.translationMin, limits.translationMax, 1.0f),
          orNeutral(gains.rotation, limits.rotationMin, limits.rotationMax, 1.0f),
          orNeutral(gains.curvature, -limits.curvatureMax, limits.curvatureMax, 0.0f),
          orNeutral(gains.bending, limits.bendingMin, limits.bendingMax, 1.0f)};
}

tl::expected<void, Error> validate(const GainLimits& limits) {
  if (auto ok = validateRatio("translation", limits.translationMin, limits.translationMax); !ok)
    return ok;
  if (auto ok = validateRatio("rotation", limits.rotationMin, limits.rotationMax); !ok) return ok;
  if (auto ok = validateRatio("bending", limits.bendingMin, limits.bendingMax); !ok) return ok;
  if (!(limits.curvatureMax >= 0.0f && limits.curvatureMax <= 10.0f)) {
    return tl::unexpected(Error{ErrorCode::kSettingOutOfRange,
                                fmt::format("gain limits: curvature up to {} per metre cannot "
                                            "work: give 0 to 10, 1/22 = 0.045 stays unnoticed.",
                                            limits.curvatureMax)});
  }
  return {};
}

}  // namespace forewalk::rdw
