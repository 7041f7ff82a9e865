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

}  // namespace

World buildWorld(const std::string& name, const std::string& sceneFile,
                 const navmesh::BuildSettings& settings) {
  World world;
  world.name = name;
  const navmesh::Scene scene = orAbort(navmesh::importScene(std::filesystem::path(sceneFile)));
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
