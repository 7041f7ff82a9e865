// Where a user walks: the navgraph and the index that finds places on it, kept together because
// both are made once and then shared, read-only, by any number of sessions on any threads.
#pragma once

#include <utility>

#include "navmesh/locate.h"
#include "navmesh/nav_graph.h"

namespace forewalk::navmesh {

/// Never changed after it is made. Hold it by std::shared_ptr<const World>.
struct World {
  NavGraph graph;
  LocationIndex locations;
};

/// O(polygons).
inline World makeWorld(NavGraph graph) {
  World world{std::move(graph), {}};
  world.locations = makeLocationIndex(world.graph);
  return world;
}

}  // namespace forewalk::navmesh
