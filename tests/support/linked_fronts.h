// Floors with links and graphs by fronts on them, and whether two such graphs are the same.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <tuple>
#include <utility>
#include <vector>

#include "prediction/front_graph.h"
#include "tests/support/linked_world.h"
#include "tests/support/random_mesh.h"

namespace forewalk::testing {

/// A floor and its links, and graphs by fronts on it.
struct Linked {
  explicit Linked(const navmesh::PolygonMesh& mesh, const std::vector<navmesh::Link>& links = {})
      : world(worldOf(mesh)) {
    set(links);
  }
  Linked(const Linked&) = delete;

  void set(const std::vector<navmesh::Link>& links) { set(statesOf(world, links)); }
  void set(navmesh::PolygonStates to) {
    scratch.reset();
    states = std::move(to);
    index = prediction::makeFrontIndex(world.graph, &states);
    scratch = std::make_unique<prediction::FrontScratch>(world.graph, index);
  }

  navmesh::Location at(glm::vec3 place) const {
    return *navmesh::locate(world.graph, world.locations, place, navmesh::kLinkSnap);
  }
  const prediction::PredictionGraph& from(const navmesh::Location& source, float horizon,
                                          float persistence = 0.75f) {
    return predictFronts(world.graph, source, horizon, *scratch, {persistence});
  }
  const prediction::DistanceField& distances() const { return scratch->distances(); }

  navmesh::World world;
  navmesh::PolygonStates states;
  prediction::FrontIndex index;
  std::unique_ptr<prediction::FrontScratch> scratch;
};

/// Holes, triangles, merged polygons.
inline navmesh::PolygonMesh meshOf(std::uint64_t seed, int columns = 9, int rows = 8) {
  RandomMeshOptions options;
  options.holeShare = 0.05 * static_cast<double>(seed % 6);
  options.mergeShare = 0.1 * static_cast<double>(seed % 9);
  options.splitShare = 0.15 * static_cast<double>(seed % 5);
  options.jitter = seed % 3 == 0 ? 0.0 : 0.2;
  return randomMesh(seed, columns, rows, options);
}

using Seen = std::tuple<float, float, float, int, int, bool>;  // distance, place, kind, reason

inline std::vector<Seen> seenIn(const prediction::PredictionGraph& graph,
                                float addedDistance = 0.0f) {
  std::vector<Seen> seen;
  for (const prediction::Node& node : graph.nodes) {
    if (node.kind == prediction::NodeKind::kSource) continue;
    seen.emplace_back(node.distance + addedDistance, node.plan.x, node.plan.y,
                      static_cast<int>(node.kind), static_cast<int>(node.reason), node.branch);
  }
  std::sort(seen.begin(), seen.end());
  return seen;
}

/// Whether two nodes are one, but for rounding.
inline bool areOne(const Seen& a, const Seen& b) {
  return std::get<3>(a) == std::get<3>(b) && std::get<4>(a) == std::get<4>(b) &&
         std::get<5>(a) == std::get<5>(b) && std::abs(std::get<0>(a) - std::get<0>(b)) <= 2e-3f &&
         std::abs(std::get<1>(a) - std::get<1>(b)) <= 2e-2f &&
         std::abs(std::get<2>(a) - std::get<2>(b)) <= 2e-2f;
}

/// Those of `a` that are none of `b`, each of which is one at most.
inline std::vector<Seen> missing(const std::vector<Seen>& a, const std::vector<Seen>& b) {
  std::vector<bool> taken(b.size(), false);
  std::vector<Seen> left;
  for (const Seen& one : a) {
    std::size_t i = 0;
    while (i < b.size() && (taken[i] || !areOne(one, b[i]))) ++i;
    if (i < b.size()) {
      taken[i] = true;
    } else {
      left.push_back(one);
    }
  }
  return left;
}

inline void expectSame(const std::vector<Seen>& a, const std::vector<Seen>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (const Seen& one : missing(a, b)) {
    FAIL() << "a node of kind " << std::get<3>(one) << " at " << std::get<0>(one) << " m, ("
           << std::get<1>(one) << ", " << std::get<2>(one) << ")";
  }
}

}  // namespace forewalk::testing
