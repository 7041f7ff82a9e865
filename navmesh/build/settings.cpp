#include "navmesh/build/settings.h"

#include <fmt/format.h>

#include <cmath>
#include <string>
#include <utility>

namespace forewalk::navmesh {

namespace {

tl::unexpected<Error> damaged(std::string message) {
  return tl::unexpected(Error{ErrorCode::kDataDamaged, std::move(message)});
}

}  // namespace

tl::expected<void, Error> validate(const BuildSettings& settings) {
  struct Range {
    const char* name;
    float value;
    float least;
    bool openBelow;  // `least` itself is too little
  };
  const Range ranges[] = {{"radius", settings.radius, 0.0f, false},
                          {"height", settings.height, 0.0f, true},
                          {"climb", settings.climb, 0.0f, false},
                          {"slope", settings.slope, 0.0f, false},
                          {"cell", settings.cell, 0.0f, true},
                          {"cellHeight", settings.cellHeight, 0.0f, true},
                          {"regionMin", settings.regionMin, 0.0f, false},
                          {"regionMerge", settings.regionMerge, 0.0f, false},
                          {"edgeMax", settings.edgeMax, 0.0f, false},
                          {"edgeError", settings.edgeError, 0.0f, false},
                          {"detailSample", settings.detailSample, 0.0f, false},
                          {"detailError", settings.detailError, 0.0f, false},
                          {"tile", settings.tile, 0.0f, false}};
  for (const Range& range : ranges) {
    const bool enough = range.openBelow ? range.value > range.least : range.value >= range.least;
    if (!enough || !std::isfinite(range.value)) {
      return damaged(fmt::format(
          "setting {} is {}, but must be finite and {} {}. Build the navmesh again.", range.name,
          range.value, range.openBelow ? "above" : "at least", range.least));
    }
  }
  if (settings.slope >= 1.57079632679f) {
    return damaged(
        fmt::format("setting slope is {} rad, but must be below pi/2. Build the navmesh again.",
                    settings.slope));
  }
  if (settings.cornersMax < 3 || settings.cornersMax > 6) {
    return damaged(
        fmt::format("setting cornersMax is {}, but must be 3 to 6. Build the navmesh again.",
                    settings.cornersMax));
  }
  if (settings.partition > Partition::kLayers) {
    return damaged(
        fmt::format("setting partition is {}, but must be 0 to 2. Build the navmesh again.",
                    static_cast<int>(settings.partition)));
  }
  return {};
}

}  // namespace forewalk::navmesh
