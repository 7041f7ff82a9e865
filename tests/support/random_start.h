// Places on a navmesh, spread by area.
#pragma once

#include <algorithm>
#include <random>
#include <vector>

#include "navmesh/locate.h"
#include "navmesh/nav_graph.h"
#include "navmesh/random.h"

namespace forewalk::testing {

/// `count` places: a polygon drawn by its area, then a point well inside it.
inline std::vector<navmesh::Location> randomStarts(const navmesh::NavGraph& graph, int count,
                                                   std::uint64_t seed) {
  std::vector<double> upTo;
  double total = 0.0;
  for (std::uint32_t polygon = 0; polygon < graph.polygonCount(); ++polygon) {
    total += static_cast<double>(navmesh::areaOf(graph, navmesh::PolygonId{polygon}));
    upTo.push_back(total);
  }
  std::mt19937_64 rng(seed);
  std::vector<navmesh::Location> starts;
  while (static_cast<int>(starts.size()) < count) {
    const double drawn = navmesh::uniform(rng) * total;
    const auto at = std::upper_bound(upTo.begin(), upTo.end(), drawn);
    if (at == upTo.end()) continue;
    const navmesh::PolygonId polygon{static_cast<std::uint32_t>(at - upTo.begin())};
    // Random weights of the corners: always inside, denser around the middle.
    const auto ring = graph.ringOf(polygon);
    glm::vec2 plan(0.0f);
    float sum = 0.0f;
    for (const glm::vec2 corner : ring) {
      const float weight = static_cast<float>(0.02 + navmesh::uniform(rng));
      plan += weight * corner;
      sum += weight;
    }
    plan /= sum;
    starts.push_back({polygon, plan, navmesh::heightAt(graph, polygon, plan), false});
  }
  return starts;
}

}  // namespace forewalk::testing
