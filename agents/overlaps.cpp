#include "agents/overlaps.h"

#include <algorithm>
#include <cmath>

#include "navmesh/plan.h"

namespace forewalk::agents {
namespace {

/// Whether `point` is inside a loop of walls that has its free ground outside: of the walls nearest
/// to it, the one it is behind decides, and the winding number of the loop says so without rounding
/// questions at corners.
int windingOf(std::span<const Wall> walls, glm::vec2 point) {
  int winding = 0;
  for (const Wall& wall : walls) {
    if (wall.isCircle()) continue;
    const bool below = wall.from.y <= point.y, after = wall.to.y <= point.y;
    if (below == after) continue;
    const float side = navmesh::turn(wall.from, wall.to, point);
    if (below && side > 0.0f) ++winding;
    if (!below && side < 0.0f) --winding;
  }
  return winding;
}

}  // namespace

OverlapCount OverlapCounter::count(const AgentsView& agents, float tolerance) {
  OverlapCount result;
  const std::uint32_t n = agents.size();
  if (n < 2) return result;
  float widest = 0.0f;
  for (const float radius : agents.radius) widest = std::max(widest, radius);
  index_.build(agents, 2.0f * widest);
  for (std::uint32_t i = 0; i < n; ++i) {
    index_.visitNear(agents.position[i], agents.radius[i] + widest, [&](std::uint32_t j) {
      if (j <= i || std::abs(agents.height[i] - agents.height[j]) > 2.0f) return;
      const float reach = agents.radius[i] + agents.radius[j];
      const float gap = glm::distance(agents.position[i], agents.position[j]) - reach;
      result.leastGap = std::min(result.leastGap, gap);
      result.deepest = std::max(result.deepest, -gap / reach);
      if (-gap > tolerance * reach) ++result.pairSteps;
    });
  }
  return result;
}

std::uint32_t CollisionCounter::count(const AgentsView& agents, float tolerance) {
  std::swap(touching_, before_);
  touching_.clear();
  const std::uint32_t n = agents.size();
  if (n < 2) return 0;
  const float widest = *std::max_element(agents.radius.begin(), agents.radius.end());
  index_.build(agents, 2.0f * widest);
  for (std::uint32_t i = 0; i < n; ++i) {
    index_.visitNear(agents.position[i], agents.radius[i] + widest, [&](std::uint32_t j) {
      const std::uint64_t low = number(agents.id[i]), high = number(agents.id[j]);
      if (low >= high || std::abs(agents.height[i] - agents.height[j]) > 2.0f) return;
      const float reach = agents.radius[i] + agents.radius[j];
      const float distance = glm::distance(agents.position[i], agents.position[j]);
      if (distance < (1.0f - tolerance) * reach) touching_.push_back(low << 32 | high);
    });
  }
  std::sort(touching_.begin(), touching_.end());
  std::uint32_t begun = 0;
  auto was = before_.begin();
  for (const std::uint64_t pair : touching_) {
    while (was != before_.end() && *was < pair) ++was;
    begun += was == before_.end() || *was != pair;
  }
  return begun;
}

bool entersWall(glm::vec2 position, float height, float radius, std::span<const Wall> walls,
                float tolerance) {
  if (windingOf(walls, position) < 0) return true;
  return std::any_of(walls.begin(), walls.end(), [&](const Wall& wall) {
    const float low = std::min(wall.fromHeight, wall.toHeight) - wall.reach;
    const float high = std::max(wall.fromHeight, wall.toHeight) + wall.reach;
    if (height < low || height > high) return false;
    return glm::distance(position, nearestOn(wall, position)) <
           wallRadius(radius, wall) - tolerance;
  });
}

std::uint64_t countWallsEntered(const AgentsView& agents, std::span<const Wall> walls,
                                float tolerance) {
  std::uint64_t entered = 0;
  for (std::uint32_t i = 0; i < agents.size(); ++i) {
    entered += entersWall(agents.position[i], agents.height[i], agents.radius[i], walls, tolerance);
  }
  return entered;
}

}  // namespace forewalk::agents
