// Worlds and the links on them, for tests; what cannot be made throws.
#pragma once

#include <stdexcept>
#include <utility>
#include <vector>

#include "navmesh/links.h"
#include "navmesh/nav_graph.h"
#include "navmesh/polygon_mesh.h"
#include "navmesh/polygon_states.h"
#include "navmesh/world.h"

namespace forewalk::testing {

inline navmesh::World worldOf(const navmesh::PolygonMesh& mesh) {
  auto graph = navmesh::makeNavGraph(mesh);
  if (!graph) throw std::runtime_error(graph.error().message);
  return navmesh::makeWorld(std::move(*graph));
}

inline navmesh::PolygonStates statesOf(const navmesh::World& world,
                                       const std::vector<navmesh::Link>& links) {
  auto made = navmesh::makeLinks(world.graph, world.locations, links);
  if (!made) throw std::runtime_error(made.error().message);
  navmesh::PolygonStates states;
  navmesh::setLinks(world.graph, std::move(*made), states);
  return states;
}

}  // namespace forewalk::testing
