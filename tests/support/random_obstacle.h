// Obstacles of all shapes, thrown anywhere.
#pragma once

#include <cmath>
#include <numbers>
#include <random>

#include "navmesh/build/obstacle.h"
#include "navmesh/random.h"

namespace forewalk::testing {

/// The part of the world that obstacles are thrown into; world axes, metres.
struct Region {
  glm::vec3 low, high;
};

/// A box, prism or cylinder up to `size` metres across, its middle anywhere in the region.
inline navmesh::Obstacle randomObstacle(std::mt19937_64& rng, const Region& region, double size) {
  using navmesh::uniform;
  const auto within = [&](double low, double high) {
    return static_cast<float>(uniform(rng, low, high));
  };
  const glm::vec3 middle{within(region.low.x, region.high.x), within(region.low.y, region.high.y),
                         within(region.low.z, region.high.z)};
  const float half = within(0.05, 0.5 * size);
  switch (navmesh::uniformInt(rng, 3)) {
    case 0:
      return navmesh::BoxObstacle{
          middle, {half, within(0.05, 1.0), within(0.05, 0.5 * size)}, within(-4.0, 4.0)};
    case 1: {
      // Corners on a circle, in turn, are convex; three thirds of it keep them apart.
      navmesh::PrismObstacle prism;
      const int corners = 3 * (1 + navmesh::uniformInt(rng, 3));
      const double begin = uniform(rng, 0.0, 6.0);
      for (int i = 0; i < corners; ++i) {
        const double angle =
            begin + 2.0 * std::numbers::pi * (i + uniform(rng, 0.0, 0.6)) / corners;
        prism.corners.push_back({middle.x + half * static_cast<float>(std::cos(angle)),
                                 -middle.z + half * static_cast<float>(std::sin(angle))});
      }
      prism.bottom = middle.y - 0.5f;
      prism.top = middle.y + within(0.0, 1.0);
      return prism;
    }
    default:
      return navmesh::CylinderObstacle{middle, half, within(0.1, 2.0)};
  }
}

}  // namespace forewalk::testing
