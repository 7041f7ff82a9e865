#include "agents/walls.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "navmesh/plan.h"

namespace forewalk::agents {
namespace {

constexpr float kStoreyReach = 2.0f;  // metres; storeys lie at least 2.6 m apart (locate.h)

}  // namespace

bool pointsOut(std::span<const Wall> walls, std::uint32_t wall) {
  const Wall& here = walls[wall];
  if (here.next == kNoWall) return true;
  const Wall& after = walls[here.next];
  return navmesh::cross(here.to - here.from, after.to - after.from) <= 0.0f;
}

void appendLoop(std::span<const glm::vec2> corners, glm::vec2 velocity, std::vector<Wall>& walls) {
  if (corners.size() < 2) return;
  const std::uint32_t first = static_cast<std::uint32_t>(walls.size());
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const glm::vec2 to = corners[i + 1 < corners.size() ? i + 1 : 0];
    if (to == corners[i]) continue;
    const std::uint32_t self = static_cast<std::uint32_t>(walls.size());
    walls.push_back({corners[i], to, self - 1, self + 1, 0.0f, 0.0f, 0.0f,
                     std::numeric_limits<float>::infinity(), velocity});
  }
  if (walls.size() == first) return;
  walls[first].previous = static_cast<std::uint32_t>(walls.size()) - 1;
  walls.back().next = first;
}

void appendCircle(glm::vec2 centre, float radius, glm::vec2 velocity, std::vector<Wall>& walls) {
  walls.push_back({centre, centre, kNoWall, kNoWall, -radius, 0.0f, 0.0f,
                   std::numeric_limits<float>::infinity(), velocity});
}

void appendBorder(const navmesh::NavGraph& graph, float clearance, std::vector<Wall>& walls,
                  const navmesh::PolygonStates* states) {
  const std::uint32_t first = static_cast<std::uint32_t>(walls.size());
  const auto add = [&](glm::vec2 from, glm::vec2 to, float fromHeight, float toHeight) {
    // Tile borders cut portals to fractions of a millimetre: no wall is so short.
    if (glm::dot(to - from, to - from) < 1e-6f) return;
    walls.push_back({from, to, kNoWall, kNoWall, clearance, fromHeight, toHeight, kStoreyReach,
                     glm::vec2(0.0f)});
  };
  const auto isClosed = [&](navmesh::PolygonId polygon) {
    return states != nullptr && states->isClosed(polygon);
  };
  for (std::uint32_t polygon = 0; polygon < graph.polygonCount(); ++polygon) {
    const bool inside = isClosed(navmesh::PolygonId{polygon});
    const std::span<const glm::vec2> ring = graph.ringOf(navmesh::PolygonId{polygon});
    const float* heights = graph.ringHeight.data() + graph.ringStart[polygon];
    std::uint32_t h = graph.portalStart[polygon];
    const std::uint32_t end = graph.portalStart[polygon + 1];
    for (std::uint32_t edge = 0; edge < ring.size(); ++edge) {
      const std::uint32_t after = edge + 1 < ring.size() ? edge + 1 : 0;
      // Portals come in order along the edge, and walking out of the polygon their right end comes
      // first. What they leave of the edge is border.
      glm::vec2 at = ring[edge];
      float atHeight = heights[edge];
      for (; h < end && graph.portalEdge[h] == edge; ++h) {
        if (!inside && isClosed(graph.portalTo[h])) continue;
        add(at, graph.portals[h].right, atHeight, graph.portalHeights[h].right);
        at = graph.portals[h].left;
        atHeight = graph.portalHeights[h].left;
      }
      add(at, ring[after], atHeight, heights[after]);
    }
  }
  // Link each end to the wall that begins there. Where several do (two rooms touch in a point), the
  // one that turns most to the left bounds the same free ground.
  std::vector<std::uint32_t> byStart;
  for (std::uint32_t w = first; w < walls.size(); ++w) byStart.push_back(w);
  const auto before = [](glm::vec2 a, glm::vec2 b) {
    return a.x < b.x || (a.x == b.x && a.y < b.y);
  };
  std::sort(byStart.begin(), byStart.end(), [&](std::uint32_t a, std::uint32_t b) {
    if (before(walls[a].from, walls[b].from)) return true;
    if (before(walls[b].from, walls[a].from)) return false;
    return a < b;
  });
  for (std::uint32_t w = first; w < walls.size(); ++w) {
    auto candidate = std::lower_bound(
        byStart.begin(), byStart.end(), walls[w].to,
        [&](std::uint32_t a, glm::vec2 point) { return before(walls[a].from, point); });
    std::uint32_t best = kNoWall;
    float bestTurn = 0.0f;
    const glm::vec2 along = walls[w].to - walls[w].from;
    for (; candidate != byStart.end() && walls[*candidate].from == walls[w].to; ++candidate) {
      const Wall& other = walls[*candidate];
      if (other.previous != kNoWall) continue;
      if (!(std::abs(other.fromHeight - walls[w].toHeight) < kStoreyReach)) continue;
      const glm::vec2 onward = other.to - other.from;
      const float turn = std::atan2(navmesh::cross(along, onward), glm::dot(along, onward));
      if (best == kNoWall || turn > bestTurn) {
        best = *candidate;
        bestTurn = turn;
      }
    }
    if (best == kNoWall) continue;
    walls[w].next = best;
    walls[best].previous = w;
  }
}

}  // namespace forewalk::agents
