// The scenes that benchmarks run on, built once into all the forms that they need.
#pragma once

#include <string>
#include <vector>

#include "navmesh/build/build.h"
#include "navmesh/build/detour_tiles.h"
#include "navmesh/locate.h"
#include "navmesh/nav_graph.h"

namespace forewalk::bench {

struct World {
  std::string name;
  std::vector<navmesh::DetourTile> tiles;
  navmesh::PolygonMesh mesh;
  navmesh::NavGraph graph;
};

/// The bundled scenes, solo and (the office) tiled, a campus of 40 offices, and nav_test where the
/// shared data is found. Aborts with the message where one cannot be built.
std::vector<World> bundledWorlds();

/// `columns * rows` copies of the scene in a file side by side, a metre apart. Aborts as above.
navmesh::Scene sceneOf(const std::string& sceneFile, int columns = 1, int rows = 1);

/// The same, built.
World buildWorld(const std::string& name, const std::string& sceneFile,
                 const navmesh::BuildSettings& settings, int columns = 1, int rows = 1);

/// `mesh` copied side by side, not joined: the same floor on `columns * rows` times the area. Copy
/// 0 keeps its ids and its place.
World repeatedWorld(const World& world, int columns, int rows);

}  // namespace forewalk::bench
