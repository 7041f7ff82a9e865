// Worlds and the links on them, for tests; what cannot be made throws.
#pragma once

#include <random>
#include <stdexcept>
#include <utility>
#include <vector>

#include "navmesh/links.h"
#include "navmesh/nav_graph.h"
#include "navmesh/polygon_mesh.h"
#include "navmesh/polygon_states.h"
#include "navmesh/random.h"
#include "navmesh/world.h"
#include "tests/support/random_start.h"

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

/// `count` links between places of the ground.
inline std::vector<navmesh::Link> randomLinks(const navmesh::World& world, int count,
                                              std::uint64_t seed, float longest) {
  std::mt19937_64 rng(seed);
  const auto places = randomStarts(world.graph, 2 * count, seed + 1000);
  std::vector<navmesh::Link> links;
  for (int i = 0; i < count; ++i) {
    const auto k = static_cast<std::size_t>(2 * i);
    links.push_back({navmesh::LinkId{static_cast<std::uint32_t>(i)}, places[k].position(),
                     places[k + 1].position(),
                     static_cast<float>(navmesh::uniform(rng, 0.0, longest)),
                     navmesh::uniformInt(rng, 2) == 0, true});
  }
  return links;
}

}  // namespace forewalk::testing
