#include "navmesh/build/nothing_walkable.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>

namespace forewalk::navmesh {
namespace {

double degrees(double radians) { return radians * 180.0 / std::numbers::pi; }

std::string slopeCloses(const Scene& scene, const BuildSettings& settings) {
  double flattest = -1.0;
  for (const glm::uvec3& triangle : scene.triangles) {
    flattest = std::max(flattest, upwardCosine(scene, triangle));
  }
  if (flattest <= 0.0) {
    return fmt::format(
        "none of {} triangles faces up. Turn their winding around, or check the up axis.",
        scene.triangles.size());
  }
  return fmt::format(
      "slope {:.1f} degrees closes all {} triangles: the flattest that faces up has {:.1f} "
      "degrees.",
      degrees(settings.slope), scene.triangles.size(), degrees(std::acos(std::min(flattest, 1.0))));
}

/// The ledge filter keeps its own counsel, so it is asked again with other values, in the tile with
/// the most ground.
std::string climbCloses(const TileBuilder& builder, std::span<const TileResult> tiles) {
  const BuildSettings& settings = builder.settings();
  const auto most = std::max_element(
      tiles.begin(), tiles.end(),
      [](const TileResult& a, const TileResult& b) { return a.left[kHeight] < b.left[kHeight]; });
  const auto tile = static_cast<std::size_t>(most - tiles.begin());
  int closes = builder.climbVoxels();
  int opens = ceilOf(static_cast<double>(settings.height) / settings.cellHeight) - 1;
  if (opens <= closes || builder.spansWithClimb(tile, opens) == 0) {
    return fmt::format(
        "cell {:g} m closes all walkable ground: no place is wider than two cells between "
        "ledges. Try half of it.",
        settings.cell);
  }
  while (opens - closes > 1) {
    const int middle = closes + (opens - closes) / 2;
    (builder.spansWithClimb(tile, middle) > 0 ? opens : closes) = middle;
  }
  return fmt::format(
      "climb {:.2f} m closes all walkable ground, because it rises or falls more from cell to "
      "cell: {:.2f} m would open it, or a smaller cell ({:g} m).",
      settings.climb, opens * settings.cellHeight, settings.cell);
}

}  // namespace

Error nothingWalkable(const TileBuilder& builder, std::span<const TileResult> tiles) {
  const BuildSettings& settings = builder.settings();
  std::array<std::size_t, kSteps> left{};
  int headroom = 0, room = 0;
  std::size_t island = 0;
  for (const TileResult& tile : tiles) {
    for (std::size_t step = 0; step < kSteps; ++step) left[step] += tile.left[step];
    headroom = std::max(headroom, tile.headroom);
    room = std::max(room, tile.room);
    island = std::max(island, tile.island);
  }
  const auto sentence = [&] {
    switch (std::find(left.begin(), left.end(), std::size_t{0}) - left.begin()) {
      case kSlope:
        return slopeCloses(builder.scene(), settings);
      case kHeight:
        return fmt::format(
            "height {:.2f} m closes all walkable ground: the highest space above it is {:.2f} m.",
            settings.height, headroom * settings.cellHeight);
      case kClimb:
        return climbCloses(builder, tiles);
      case kRadius:
        return fmt::format(
            "radius {:.2f} m closes all walkable ground: at the widest place {:.2f} m fits.",
            settings.radius, room * settings.cell);
      case kRegion:
        return fmt::format(
            "regionMin {:.2f} m^2 drops all walkable ground: the largest connected piece has "
            "{:.2f} m^2.",
            settings.regionMin,
            static_cast<double>(island) * static_cast<double>(settings.cell) * settings.cell);
      default:
        return fmt::format(
            "edgeError {:.2f} m closes all walkable ground: every outline collapses. Try {:.2f} m.",
            settings.edgeError, 1.3 * settings.cell);
    }
  };
  return Error{ErrorCode::kNothingWalkable,
               fmt::format("{}: {}", builder.scene().name, sentence())};
}

}  // namespace forewalk::navmesh
