#include "bench/worlds.h"

#include <cstdio>
#include <cstdlib>
#include <filesystem>

#include "navmesh/build/scene.h"
#include "tests/support/random_mesh.h"

namespace forewalk::bench {

namespace {

template <typename T>
T orAbort(tl::expected<T, Error> result) {
  if (result) return std::move(*result);
  std::fprintf(stderr, "%s\n", result.error().message.c_str());
  std::exit(1);
}

/// The scene's triangles copied side by side with a gap of 1 m.
navmesh::Scene repeated(const navmesh::Scene& scene, int columns, int rows) {
  glm::vec3 low = scene.vertices.front(), high = low;
  for (const glm::vec3 vertex : scene.vertices) {
    low = glm::min(low, vertex);
    high = glm::max(high, vertex);
  }
  const glm::vec3 step = high - low + glm::vec3(1.0f);
  navmesh::Scene copies{scene.name, {}, {}};
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      const std::uint32_t base = static_cast<std::uint32_t>(copies.vertices.size());
      const glm::vec3 moved(step.x * static_cast<float>(column), 0.0f,
                            step.z * static_cast<float>(row));
      for (const glm::vec3 vertex : scene.vertices) copies.vertices.push_back(vertex + moved);
      for (const glm::uvec3 triangle : scene.triangles) copies.triangles.push_back(triangle + base);
    }
  }
  return copies;
}

}  // namespace

navmesh::Scene sceneOf(const std::string& sceneFile, int columns, int rows) {
  navmesh::Scene scene = orAbort(navmesh::importScene(std::filesystem::path(sceneFile)));
  return columns * rows > 1 ? repeated(scene, columns, rows) : scene;
}

World buildWorld(const std::string& name, const std::string& sceneFile,
                 const navmesh::BuildSettings& settings, int columns, int rows) {
  World world;
  world.name = name;
  const navmesh::Scene scene = sceneOf(sceneFile, columns, rows);
  world.tiles = orAbort(navmesh::buildTiles(scene, settings));
  world.mesh = orAbort(navmesh::polygonsFromTiles(world.tiles, settings.climb, name));
  world.graph = orAbort(navmesh::makeNavGraph(world.mesh));
  return world;
}

std::vector<World> bundledWorlds() {
  const std::string scenes = FOREWALK_ASSETS "/scenes/";
  const navmesh::BuildSettings solo;
  navmesh::BuildSettings tiled;
  tiled.tile = 6.4f;
  std::vector<World> worlds;
  for (const std::string name : {"office", "museum", "two_storey", "corridor", "maze"}) {
    worlds.push_back(buildWorld(name, scenes + name + ".obj", solo));
  }
  worlds.push_back(buildWorld("office tiled", scenes + "office.obj", tiled));
  // A campus of 200 m x 200 m: what does not fit a processor's nearest caches.
  navmesh::BuildSettings campus;
  campus.tile = 25.6f;
  worlds.push_back(buildWorld("campus", scenes + "office.obj", campus, 5, 8));
  const std::string real = FOREWALK_SHARED_DATA "/scenes/nav_test.obj";
  if (std::filesystem::exists(real)) {
    worlds.push_back(buildWorld("nav_test", real, solo));
  } else {
    std::fprintf(stderr, "nav_test is left out: %s is not here\n", real.c_str());
  }
  return worlds;
}

World repeatedWorld(const World& world, int columns, int rows) {
  World large;
  large.name = world.name + " x" + std::to_string(columns * rows);
  large.mesh = testing::repeated(world.mesh, columns, rows);
  large.graph = orAbort(navmesh::makeNavGraph(large.mesh));
  return large;
}

}  // namespace forewalk::bench
