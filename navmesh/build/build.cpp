#include "navmesh/build/build.h"

#include <utility>

#include "navmesh/build/all_tiles.h"

namespace forewalk::navmesh {

tl::expected<std::vector<DetourTile>, Error> buildTiles(const Scene& scene,
                                                        const BuildSettings& settings,
                                                        const BuildRun& run) {
  const auto grid = checkedGrid(scene, settings);
  if (!grid) return tl::unexpected(grid.error());
  const TileBuilder builder(scene, settings, *grid);
  auto results = buildAll(builder, {}, run);
  if (!results) return tl::unexpected(results.error());

  std::vector<DetourTile> tiles;
  for (TileResult& result : *results) {
    if (!result.bytes.empty()) tiles.push_back(std::move(result.bytes));
  }
  return tiles;
}

tl::expected<NavMesh, Error> buildNavMesh(const Scene& scene, const BuildSettings& settings,
                                          const BuildRun& run) {
  const auto tiles = buildTiles(scene, settings, run);
  if (!tiles) return tl::unexpected(tiles.error());
  const auto polygons = polygonsFromTiles(*tiles, settings.climb, scene.name);
  if (!polygons) return tl::unexpected(polygons.error());
  return makeNavMesh(*polygons, settings);
}

}  // namespace forewalk::navmesh
