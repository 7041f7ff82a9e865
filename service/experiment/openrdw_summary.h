// Results in the summary form of OpenRDW 2 (Statistics Logger, CSV with semicolons), so that what
// reads its experiments reads these: a block a run, a line a user.
//
// Gains are theirs there as here: translation and rotation virtual over physical, curvature 1/m;
// what is injected is metres and degrees, averages are those of samples of a tenth of a second.
// Distances and times between resets count the pieces before the first and after the last. Real
// time is not told (execute_duration 0), so that equal runs give equal files; the way to walk
// (virtual_way_distance) is the one that was walked.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <string>

#include "rdw/trace.h"

namespace forewalk::service {

struct Row;
struct ExperimentPlan;

/// What that form says beyond the metrics of a row, of one user.
enum class OpenRdwValue : std::uint8_t {
  kInjectedTranslation,  ///< m, sums
  kInjectedByRotation,   ///< degrees
  kInjectedByCurvature,  ///< degrees
  kTranslationLeast,     ///< NaN, as the other extremes, where there was none
  kTranslationMost,
  kRotationLeast,
  kRotationMost,
  kCurvatureLeast,
  kCurvatureMost,
  kTranslationMean,  ///< of samples, as all that follow
  kRotationMean,
  kCurvatureMean,            ///< of the absolute values
  kInjectedTranslationMean,  ///< m a frame
  kInjectedByRotationMean,   ///< degrees a frame
  kInjectedByCurvatureMean,  ///< degrees a frame
  kTranslationChangeMost,    ///< 1/s
  kCurvatureChangeMost,      ///< 1/m/s
  kTranslationChangeMean,
  kCurvatureChangeMean,
  kRealX,  ///< m; the plan's x, y
  kRealY,
  kVirtualX,
  kVirtualY,
  kSampleSeconds,
};
inline constexpr std::size_t kOpenRdwValues = 24;
using OpenRdwValues = std::array<double, kOpenRdwValues>;

/// Of a walk's frames. O(frames).
OpenRdwValues openRdwValues(std::span<const rdw::FrameRecord> frames);

/// The file, of rows in the order of runs; a run that failed or got stuck is `Invalid`.
std::string openRdwSummary(const ExperimentPlan& plan, std::span<const Row> rows);

}  // namespace forewalk::service
