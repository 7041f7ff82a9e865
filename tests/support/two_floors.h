// Two floors that a link joins, or a corridor: to show that the two are the same.
#pragma once

#include <algorithm>
#include <cstdint>
#include <random>
#include <vector>

#include "navmesh/plan.h"
#include "navmesh/random.h"
#include "tests/support/linked_world.h"
#include "tests/support/random_mesh.h"

namespace forewalk::testing {

/// Two floors that only a link joins, or a corridor as long as the link: a straight polygon from
/// point to point, entered and left through portals a fifth of a millimetre wide.
struct TwoFloors {
  navmesh::World linked, corridor;
  std::vector<navmesh::Link> links;
  std::uint32_t corridorPolygon;
};

inline bool isWall(const navmesh::NavGraph& graph, std::uint32_t polygon, std::uint32_t edge) {
  const auto begin = graph.portalEdge.begin() + graph.portalStart[polygon];
  const auto end = graph.portalEdge.begin() + graph.portalStart[polygon + 1];
  return std::find(begin, end, edge) == end;
}

/// `left` and `right`: of 7 x 6 m; `apart`: how far, metres.
inline TwoFloors twoFloors(const navmesh::PolygonMesh& left, const navmesh::PolygonMesh& right,
                           std::uint64_t seed, float apart) {
  using navmesh::PolygonId;
  navmesh::PolygonMesh mesh = together(left, right, {7.0f + apart, 0.0f, 0.0f});
  TwoFloors floors;
  floors.linked = worldOf(mesh);
  const navmesh::NavGraph& graph = floors.linked.graph;
  std::mt19937_64 rng(seed);
  std::uint32_t polygon[2], wall[2];
  glm::vec2 point[2];
  // Outer walls that look at each other: a corridor leaves outward, over no floor.
  for (bool facing = false; !facing;) {
    glm::vec2 outward[2];
    for (int side = 0; side < 2; ++side) {
      const std::uint32_t first = side == 0 ? 0 : left.polygonCount();
      const std::uint32_t count = side == 0 ? left.polygonCount() : right.polygonCount();
      do {
        polygon[side] =
            first + static_cast<std::uint32_t>(navmesh::uniformInt(rng, static_cast<int>(count)));
        const auto corners = static_cast<int>(graph.ringOf(PolygonId{polygon[side]}).size());
        wall[side] = static_cast<std::uint32_t>(navmesh::uniformInt(rng, corners));
      } while (!isWall(graph, polygon[side], wall[side]));
      const auto ring = graph.ringOf(PolygonId{polygon[side]});
      const glm::vec2 from = ring[wall[side]], to = ring[(wall[side] + 1) % ring.size()];
      point[side] =
          from + 0.43f * (to - from);  // off the middle: where all is not the same on both sides
      outward[side] = glm::normalize(glm::vec2(to.y - from.y, from.x - to.x));
    }
    const glm::vec2 along = glm::normalize(point[1] - point[0]);
    facing = glm::dot(outward[0], along) > 0.3f && glm::dot(outward[1], along) < -0.3f &&
             point[0].x > 6.99f && point[1].x < 7.01f + apart;
  }
  const float length = glm::distance(point[0], point[1]);
  floors.links = {{navmesh::LinkId{1}, navmesh::toSpace(point[0], 0.0f),
                   navmesh::toSpace(point[1], 0.0f), length, true, true}};

  const glm::vec2 along = (point[1] - point[0]) / length;
  const glm::vec2 side = 0.1f * glm::vec2(-along.y, along.x);
  floors.corridorPolygon = mesh.polygonCount();
  const auto vertex = static_cast<std::uint32_t>(mesh.vertices.size());
  for (const glm::vec2 corner :
       {point[0] - side, point[1] - side, point[1] + side, point[0] + side}) {
    mesh.vertices.push_back(navmesh::toSpace(corner, 0.0f));
  }
  for (std::uint32_t i = 0; i < 4; ++i) mesh.ring.push_back(vertex + i);
  mesh.ringStart.push_back(static_cast<std::uint32_t>(mesh.ring.size()));
  for (std::uint32_t end = 0; end < 2; ++end) {
    const auto ring = graph.ringOf(PolygonId{polygon[end]});
    const glm::vec2 edge = ring[(wall[end] + 1) % ring.size()] - ring[wall[end]];
    const glm::vec2 half = 1e-4f * edge / glm::length(edge);
    mesh.borderPortals.push_back(
        {PolygonId{polygon[end]}, PolygonId{floors.corridorPolygon}, wall[end], end == 0 ? 3u : 1u,
         navmesh::toSpace(point[end] + half, 0.0f), navmesh::toSpace(point[end] - half, 0.0f)});
  }
  floors.corridor = worldOf(mesh);
  return floors;
}

}  // namespace forewalk::testing
