// What a frame does to the user's motion, and how much of it stays unnoticed.
//
// The literature disagrees about gains (ratio or offset from 1, radius or 1/m, degrees or radians);
// ours are said once, here (DESIGN.md section 2).
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <tl/expected.hpp>

#include "navmesh/error.h"

namespace forewalk::rdw {

/// What a frame does to the user's motion. Ratios are virtual over physical; defaults do nothing.
struct Gains {
  float translation = 1.0f;  ///< virtual metres per physical metre walked
  float rotation = 1.0f;     ///< virtual radians per physical radian turned on the spot
  float curvature = 0.0f;    ///< 1/m; how the body turns on a straight virtual path, left positive
  float bending = 1.0f;      ///< virtual radius over physical, where the virtual path curves too

  bool operator==(const Gains&) const = default;
};

/// How far the gains may go. min <= 1 <= max for each ratio.
struct GainLimits {
  float translationMin = 0.86f;
  float translationMax = 1.26f;
  float rotationMin = 0.67f;
  float rotationMax = 1.24f;
  float curvatureMax = 1.0f / 22.0f;  ///< 1/m, >= 0; either side
  float bendingMin = 1.0f;            ///< > 0
  float bendingMax = 1.0f;

  bool operator==(const GainLimits&) const = default;
};

/// A named set of limits and where it comes from.
struct GainPreset {
  std::string_view name;
  GainLimits limits;
  std::string_view source;  ///< one line for people
};

/// All presets, the default first:
/// - `steinicke`: the detection thresholds of Steinicke et al., TVCG 2010: translation 0.86
/// to 1.26,
///   rotation 0.67 to 1.24, curvature up to 1/22 per metre.
/// - `laboratory`: the same ratios with curvature up to 1/7.5, the common laboratory setting. Three
/// times
///   tighter than the threshold: users may notice.
/// - `neth`: the same ratios with curvature up to 1/10, undetected at slow walking (Neth et al.
/// 2012).
/// - `toolkit`: what RDWT and OpenRDW ship: rotation 0.80 to 1.49 (the published band the wrong way
/// round;
///   detectable at its upper end), curvature 1/7.5. To compare with published simulations.
/// None of the sources gives a threshold for bending, so every preset leaves it at 1; set the
/// limits to use it.
std::span<const GainPreset> gainPresets();

/// The limits of a preset by name, nothing for an unknown name.
std::optional<GainLimits> gainLimitsByName(std::string_view name);

/// Each gain moved to the nearest value within the limits. A gain that is not a number becomes
/// neutral.
Gains clamped(const Gains& gains, const GainLimits& limits);

/// Fails (kSettingOutOfRange, naming the field and its value) unless all values are finite, ratios
/// are above 0 with min <= 1 <= max, and curvature lies in [0, 10] per metre.
[[nodiscard]] tl::expected<void, Error> validate(const GainLimits& limits);

}  // namespace forewalk::rdw
