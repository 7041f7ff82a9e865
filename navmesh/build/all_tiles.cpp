#include "navmesh/build/all_tiles.h"

#include <functional>
#include <mutex>

#include "navmesh/build/nothing_walkable.h"

namespace forewalk::navmesh {

tl::expected<Grid, Error> checkedGrid(const Scene& scene, const BuildSettings& settings) {
  if (auto checked = checkSettings(settings); !checked) return tl::unexpected(checked.error());
  if (auto checked = validate(scene); !checked) return tl::unexpected(checked.error());
  return makeGrid(scene, settings);
}

tl::expected<std::vector<TileResult>, Error> buildAll(const TileBuilder& builder,
                                                      std::span<const GridObstacle* const> carved,
                                                      const BuildRun& run) {
  std::vector<TileResult> results(builder.tileCount());
  std::mutex progressMutex;
  std::size_t done = 0;
  const std::function<void(std::size_t)> work = [&](std::size_t tile) {
    results[tile] = builder.build(tile, carved);
    if (!run.progress) return;
    const std::lock_guard lock(progressMutex);
    run.progress(++done, results.size());
  };
  if (run.forEach) {
    run.forEach(results.size(), work);
  } else {
    for (std::size_t tile = 0; tile < results.size(); ++tile) work(tile);
  }
  bool ground = false;
  for (const TileResult& result : results) {
    if (result.error) return tl::unexpected(*result.error);
    ground = ground || !result.bytes.empty();
  }
  if (!ground) return tl::unexpected(nothingWalkable(builder, results));
  return results;
}

}  // namespace forewalk::navmesh
