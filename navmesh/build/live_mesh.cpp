#include "navmesh/build/live_mesh.h"

#include <algorithm>
#include <numeric>
#include <set>
#include <utility>

#include "navmesh/build/carve.h"

namespace forewalk::navmesh {

tl::expected<LiveMesh, Error> LiveMesh::make(Scene scene, const BuildSettings& settings,
                                             std::span<const Obstacle> outlines,
                                             const BuildRun& run) {
  auto source = TileSource::make(std::move(scene), settings, outlines, run);
  if (!source) return tl::unexpected(source.error());
  LiveMesh mesh(std::move(*source));
  const std::vector<DetourTile> tiles = mesh.source_.takeTiles();
  std::vector<std::uint32_t> numbers(tiles.size());
  std::iota(numbers.begin(), numbers.end(), 0u);
  mesh.join_.replace(numbers, tiles);
  auto world = mesh.worldOf(mesh.join_);
  if (!world) return tl::unexpected(world.error());
  mesh.world_ = std::move(*world);
  return mesh;
}

LiveMesh::LiveMesh(TileSource source)
    : source_(std::move(source)),
      join_(source_.columnCount(), source_.tileCount() / source_.columnCount(),
            source_.settings()) {}

tl::expected<LiveUpdate, Error> LiveMesh::apply(std::span<const ObstacleChange> changes,
                                                const BuildRun& run) {
  for (const ObstacleChange& change : changes) {
    if (!change.obstacle) continue;
    if (auto valid = validate(*change.obstacle); !valid) return tl::unexpected(valid.error());
  }
  Obstacles placed = placed_;
  std::set<std::uint32_t> touched;
  for (const ObstacleChange& change : changes) {
    const auto before = placed.find(change.id);
    if (before != placed.end()) {
      if (change.obstacle == before->second.obstacle) continue;
      touched.insert(before->second.tiles.begin(), before->second.tiles.end());
      placed.erase(before);
    }
    if (!change.obstacle) continue;
    Placed now{*change.obstacle, source_.place(*change.obstacle), {}};
    now.tiles = source_.tilesTouchedBy(*now.onGrid);
    touched.insert(now.tiles.begin(), now.tiles.end());
    placed.emplace(change.id, std::move(now));
  }
  if (touched.empty()) {
    placed_ = std::move(placed);
    return LiveUpdate{world_, 0};
  }

  const std::vector<std::uint32_t> numbers(touched.begin(), touched.end());
  std::vector<tl::expected<DetourTile, Error>> built(numbers.size());
  const std::function<void(std::size_t)> work = [&](std::size_t i) {
    std::vector<const GridObstacle*> inTile;
    for (const auto& [id, obstacle] : placed) {
      if (std::binary_search(obstacle.tiles.begin(), obstacle.tiles.end(), numbers[i])) {
        inTile.push_back(obstacle.onGrid.get());
      }
    }
    built[i] = source_.build(numbers[i], inTile);
  };
  if (run.forEach) {
    run.forEach(numbers.size(), work);
  } else {
    for (std::size_t i = 0; i < numbers.size(); ++i) work(i);
  }
  std::vector<DetourTile> tiles;
  for (auto& tile : built) {
    if (!tile) return tl::unexpected(tile.error());
    tiles.push_back(std::move(*tile));
  }
  TileJoin join = join_;
  join.replace(numbers, tiles);
  auto world = worldOf(join);
  if (!world) return tl::unexpected(world.error());
  // Nothing fails from here on.
  join_ = std::move(join);
  placed_.swap(placed);
  world_ = std::move(*world);
  return LiveUpdate{world_, static_cast<std::uint32_t>(numbers.size())};
}

tl::expected<std::shared_ptr<const World>, Error> LiveMesh::worldOf(const TileJoin& join) const {
  std::optional<NavGraph> joined = join.join();
  if (!joined) {  // the long way, which knows what to say
    const auto polygons =
        polygonsFromTiles(join.tilesWithGround(), settings().climb, source_.name());
    if (!polygons) return tl::unexpected(polygons.error());
    auto graph = makeNavGraph(*polygons);
    if (!graph) return tl::unexpected(graph.error());
    joined = std::move(*graph);
  }
  return std::make_shared<const World>(makeWorld(std::move(*joined)));
}

}  // namespace forewalk::navmesh
