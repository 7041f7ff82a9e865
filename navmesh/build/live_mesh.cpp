#include "navmesh/build/live_mesh.h"

#include <algorithm>
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
  mesh.tiles_ = mesh.source_.takeTiles();
  std::vector<const DetourTile*> tiles;
  for (const DetourTile& tile : mesh.tiles_) tiles.push_back(&tile);
  auto world = assemble(mesh.source_, tiles);
  if (!world) return tl::unexpected(world.error());
  mesh.world_ = std::move(*world);
  return mesh;
}

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
  std::vector<const DetourTile*> tiles;
  for (const DetourTile& tile : tiles_) tiles.push_back(&tile);
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    if (!built[i]) return tl::unexpected(built[i].error());
    tiles[numbers[i]] = &*built[i];
  }
  auto world = assemble(source_, tiles);
  if (!world) return tl::unexpected(world.error());
  // Nothing fails from here on.
  for (std::size_t i = 0; i < numbers.size(); ++i) tiles_[numbers[i]].swap(*built[i]);
  placed_.swap(placed);
  world_ = std::move(*world);
  return LiveUpdate{world_, static_cast<std::uint32_t>(numbers.size())};
}

tl::expected<std::shared_ptr<const World>, Error> LiveMesh::assemble(
    const TileSource& source, std::span<const DetourTile* const> tiles) {
  std::vector<DetourTile> withGround;
  for (const DetourTile* tile : tiles) {
    if (!tile->empty()) withGround.push_back(*tile);
  }
  if (withGround.empty()) return std::make_shared<const World>(makeWorld(NavGraph{}));
  const auto polygons = polygonsFromTiles(withGround, source.settings().climb, source.name());
  if (!polygons) return tl::unexpected(polygons.error());
  auto graph = makeNavGraph(*polygons);
  if (!graph) return tl::unexpected(graph.error());
  return std::make_shared<const World>(makeWorld(std::move(*graph)));
}

}  // namespace forewalk::navmesh
