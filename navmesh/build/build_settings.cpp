// What buildNavMesh can work with.
#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "navmesh/build/build.h"
#include "navmesh/build/recast_limits.h"
#include "navmesh/build/voxel_grid.h"

namespace forewalk::navmesh {
namespace {

Error settingError(std::string message) {
  return Error{ErrorCode::kSettingOutOfRange, std::move(message)};
}

}  // namespace

tl::expected<void, Error> checkSettings(const BuildSettings& s) {
  struct Range {
    const char* name;
    float value;
    const char* unit;
    bool inside;
    const char* range;
  };
  // NaN fails every comparison, so it is inside no range; infinity is excluded by the upper bound.
  constexpr float kHuge = 1e9f;
  const Range ranges[] = {
      {"cell", s.cell, " m", s.cell > 0.0f && s.cell < kHuge, "more than 0 m"},
      {"cellHeight", s.cellHeight, " m", s.cellHeight > 0.0f && s.cellHeight < kHuge,
       "more than 0 m"},
      {"radius", s.radius, " m", s.radius >= 0.0f && s.radius < kHuge, "0 m or more"},
      {"height", s.height, " m", s.height > 0.0f && s.height < kHuge, "more than 0 m"},
      {"climb", s.climb, " m", s.climb >= 0.0f && s.climb < s.height,
       "0 m or more, and less than height"},
      {"slope", s.slope, " rad", s.slope >= 0.0f && s.slope < std::numbers::pi_v<float> / 2.0f,
       "0 or more, and less than pi/2 (90 degrees)"},
      {"regionMin", s.regionMin, " m^2", s.regionMin >= 0.0f && s.regionMin < kHuge,
       "0 m^2 or more"},
      {"regionMerge", s.regionMerge, " m^2", s.regionMerge >= 0.0f && s.regionMerge < kHuge,
       "0 m^2 or more"},
      {"edgeMax", s.edgeMax, " m", s.edgeMax >= 0.0f && s.edgeMax < kHuge,
       "0 m (no limit) or more"},
      {"edgeError", s.edgeError, " m", s.edgeError >= 0.0f && s.edgeError < kHuge, "0 m or more"},
      {"detailSample", s.detailSample, " m",
       s.detailSample == 0.0f || (s.detailSample >= 0.9f * s.cell && s.detailSample < kHuge),
       "0 m (corners only), or at least 0.9 cells"},
      {"detailError", s.detailError, " m", s.detailError >= 0.0f && s.detailError < kHuge,
       "0 m or more"},
      {"cornersMax", static_cast<float>(s.cornersMax), "", s.cornersMax >= 3 && s.cornersMax <= 6,
       "3 to 6"},
      {"partition", static_cast<float>(s.partition), "", s.partition <= Partition::kLayers,
       "watershed, monotone or layers"},
      {"tile", s.tile, " m", s.tile >= 0.0f && s.tile < kHuge, "0 m (one piece) or more"},
  };
  for (const Range& range : ranges) {
    if (!range.inside) {
      return tl::unexpected(settingError(fmt::format("{} is {:g}{}, it must be {}.", range.name,
                                                     range.value, range.unit, range.range)));
    }
  }

  // In proportion: Recast keeps these in a few bits each.
  const double cell = s.cell, cellHeight = s.cellHeight;
  if (s.radius / cell > kRadiusCellsMax) {
    return tl::unexpected(settingError(fmt::format(
        "cell is {:g} m, with radius {:g} m it must be at least {:.4f} m (radius / {}).", s.cell,
        s.radius, s.radius / static_cast<double>(kRadiusCellsMax), kRadiusCellsMax)));
  }
  if (s.height / cellHeight > kHeightVoxelsMax ||
      s.height / cellHeight < kHeightVoxelsMin - 1 + kQuotientSlack) {
    return tl::unexpected(settingError(fmt::format(
        "cellHeight is {:g} m, with height {:g} m it must be {:.4f} to {:.4f} m (height / {} to "
        "height / "
        "{}).",
        s.cellHeight, s.height, s.height / static_cast<double>(kHeightVoxelsMax),
        s.height / static_cast<double>(kHeightVoxelsMin), kHeightVoxelsMax, kHeightVoxelsMin)));
  }
  const double tileCells = s.tile / cell;
  const double tileCellsMax =
      std::sqrt(static_cast<double>(kCellsMax)) - 2.0 * (kRadiusCellsMax + 3);
  if (s.tile > 0.0f && (tileCells < kTileCellsMin - kQuotientSlack || tileCells > tileCellsMax)) {
    return tl::unexpected(settingError(fmt::format(
        "tile is {:g} m, with cell {:g} m it must be 0 m (one piece) or {:g} to {:g} m ({} to "
        "{:.0f} cells).",
        s.tile, s.cell, kTileCellsMin * cell, std::floor(tileCellsMax) * cell, kTileCellsMin,
        std::floor(tileCellsMax))));
  }
  return {};
}

}  // namespace forewalk::navmesh
