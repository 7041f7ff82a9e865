// Corridors made by hand, as portals alone.
#pragma once

#include <vector>

#include "navmesh/nav_graph.h"

namespace forewalk::testing {

struct Corridor {
  glm::vec2 start;
  glm::vec2 goal;
  std::vector<navmesh::Portal> portals;  ///< in walking order
};

/// Along plan x, a slit of 1 m every metre, left and right of the straight line in turn: the taut
/// path bends at every one.
inline Corridor zigzag(int portals) {
  Corridor corridor{{0, 0}, {static_cast<float>(portals + 1), 0}, {}};
  for (int i = 1; i <= portals; ++i) {
    const float x = static_cast<float>(i);
    const float right = i % 2 == 0 ? 0.5f : -1.5f;
    corridor.portals.push_back({{x, right + 1.0f}, {x, right}});
  }
  return corridor;
}

}  // namespace forewalk::testing
