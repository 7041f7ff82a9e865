#include "navmesh/build/tile_source.h"

#include <Recast.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "navmesh/build/all_tiles.h"
#include "navmesh/build/carve.h"

namespace forewalk::navmesh {

struct TileSource::State {
  State(Scene sceneIn, const BuildSettings& settingsIn, const Grid& gridIn)
      : scene(std::move(sceneIn)), settings(settingsIn), grid(gridIn) {}

  Scene scene;
  BuildSettings settings;
  Grid grid;
  std::vector<GridObstacle> outlines;
  TileBuilder builder{scene, settings, grid};
  std::vector<DetourTile> tiles;
};

TileSource::TileSource(std::unique_ptr<State> state) : state_(std::move(state)) {}
TileSource::TileSource(TileSource&&) noexcept = default;
TileSource& TileSource::operator=(TileSource&&) noexcept = default;
TileSource::~TileSource() = default;

tl::expected<TileSource, Error> TileSource::make(Scene scene, const BuildSettings& settings,
                                                 std::span<const Obstacle> outlines,
                                                 const BuildRun& run) {
  constexpr std::size_t kOutlinesMax = RC_WALKABLE_AREA - 1;  // area ids below the ground's own
  if (outlines.size() > kOutlinesMax) {
    return tl::unexpected(Error{ErrorCode::kTooLarge,
                                fmt::format("{}: {} outlines to cut the ground along, the limit is "
                                            "{}. Leave some out.",
                                            scene.name, outlines.size(), kOutlinesMax)});
  }
  if (!outlines.empty() && settings.partition == Partition::kLayers) {
    return tl::unexpected(Error{ErrorCode::kSettingOutOfRange,
                                fmt::format("{}: partition layers joins what {} outlines cut. Take "
                                            "watershed or monotone.",
                                            scene.name, outlines.size())});
  }
  for (const Obstacle& outline : outlines) {
    if (auto valid = validate(outline); !valid) return tl::unexpected(valid.error());
  }
  const auto grid = checkedGrid(scene, settings);
  if (!grid) return tl::unexpected(grid.error());
  auto state = std::make_unique<State>(std::move(scene), settings, *grid);
  TileSource source(std::move(state));
  State& made = *source.state_;
  std::vector<const GridObstacle*> carved;
  for (const Obstacle& outline : outlines) {
    made.outlines.push_back(*source.place(outline));
    made.outlines.back().area = static_cast<unsigned char>(made.outlines.size());
  }
  for (const GridObstacle& outline : made.outlines) carved.push_back(&outline);
  auto results = buildAll(made.builder, carved, run);
  if (!results) return tl::unexpected(results.error());
  for (TileResult& result : *results) made.tiles.push_back(std::move(result.bytes));
  return source;
}

std::size_t TileSource::tileCount() const { return state_->builder.tileCount(); }
std::size_t TileSource::columnCount() const {
  return static_cast<std::size_t>(state_->grid.tilesX);
}
const BuildSettings& TileSource::settings() const { return state_->settings; }
const std::string& TileSource::name() const { return state_->scene.name; }
std::vector<DetourTile> TileSource::takeTiles() { return std::exchange(state_->tiles, {}); }

std::shared_ptr<const GridObstacle> TileSource::place(const Obstacle& obstacle) const {
  const Grid& grid = state_->grid;
  return std::make_shared<GridObstacle>(
      onGrid(obstacle, {grid.origin.x, grid.origin.z}, grid.cell));
}

std::vector<std::uint32_t> TileSource::tilesTouchedBy(const GridObstacle& obstacle) const {
  const Grid& grid = state_->grid;
  if (grid.tileCells == 0) return {0};
  const int border = toVoxels(state_->settings).border;
  const auto range = [&](int axis, std::int64_t tiles) {
    const auto tileAt = [&](double units, int margin) {
      const double tile = std::floor((std::floor(units / kSubdivision) + margin) /
                                     static_cast<double>(grid.tileCells));
      return static_cast<std::int64_t>(std::clamp(tile, -1.0, static_cast<double>(tiles)));
    };
    return std::pair(std::max<std::int64_t>(0, tileAt(obstacle.low[axis], -border)),
                     std::min(tiles - 1, tileAt(obstacle.high[axis], border)));
  };
  const auto [x0, x1] = range(0, grid.tilesX);
  const auto [z0, z1] = range(1, grid.tilesZ);
  std::vector<std::uint32_t> touched;
  for (std::int64_t z = z0; z <= z1; ++z) {
    for (std::int64_t x = x0; x <= x1; ++x) {
      touched.push_back(static_cast<std::uint32_t>(z * grid.tilesX + x));
    }
  }
  return touched;
}

tl::expected<DetourTile, Error> TileSource::build(
    std::size_t tile, std::span<const GridObstacle* const> obstacles) const {
  std::vector<const GridObstacle*> carved;
  for (const GridObstacle& outline : state_->outlines) carved.push_back(&outline);
  carved.insert(carved.end(), obstacles.begin(), obstacles.end());
  TileResult result = state_->builder.build(tile, carved);
  if (result.error) return tl::unexpected(*result.error);
  return std::move(result.bytes);
}

}  // namespace forewalk::navmesh
