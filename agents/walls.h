// Walls: line segments with free ground on their left, linked to their neighbours.
//
// They come from the border of a navmesh and from obstacles added at run time. The navmesh was
// built for a walker of some radius, so its border is where that walker's centre may still go: the
// true wall lies `clearance` behind it, and `wallRadius` takes that off the agent's own radius.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "navmesh/nav_graph.h"
#include "navmesh/polygon_states.h"

namespace forewalk::agents {

inline constexpr std::uint32_t kNoWall = 0xffffffffu;

/// Something round that is no agent: a pillar, a robot, a cart. It moves at `velocity` and never
/// yields. Where walls are asked for, it is among them as a wall of no length (`from == to`) with
/// `clearance` = -radius, so that whoever keeps wallRadius away from it stays outside.
struct Wall {
  glm::vec2 from;          ///< metres on the plan
  glm::vec2 to;            ///< free ground is left of the walk from `from` to `to`
  std::uint32_t previous;  ///< the wall that ends in `from`, kNoWall where it is a loose end
  std::uint32_t next;      ///< the wall that begins in `to`, kNoWall where it is a loose end
  float clearance;         ///< see wallRadius; metres
  float fromHeight;        ///< of the ground along it, world y, metres
  float toHeight;
  float reach;         ///< how far above and below it still counts, metres; infinity: any height
  glm::vec2 velocity;  ///< m/s; 0 for what stands
  float attraction = 0.0f;  ///< how much people like to stop there (a shop window), share of what
                            ///< their model has for it; 0: not at all

  bool isCircle() const { return from == to; }
};

/// How far the centre of an agent of `radius` has to stay away from `wall`. At least 1 cm, so that
/// a thin agent on a navmesh built for thick ones still stops at its border. Metres.
inline float wallRadius(float radius, const Wall& wall) {
  const float kept = radius - wall.clearance;
  return kept > 0.01f ? kept : 0.01f;
}

/// The nearest point of a wall's segment (its centre, for a circle). Measured from the nearer end,
/// so that the mirrored wall, which runs the other way, has the mirrored point to the last bit.
inline glm::vec2 nearestOn(const Wall& wall, glm::vec2 point) {
  const glm::vec2 edge = wall.to - wall.from;
  const float fromStart = glm::dot(point - wall.from, edge);
  const float fromEnd = glm::dot(wall.to - point, edge);
  if (fromStart <= 0.0f) return wall.from;
  if (fromEnd <= 0.0f) return wall.to;
  const float squaredLength = glm::dot(edge, edge);
  if (fromStart < fromEnd) return wall.from + fromStart / squaredLength * edge;
  if (fromEnd < fromStart) return wall.to - fromEnd / squaredLength * edge;
  return 0.5f * (wall.from + wall.to);
}

/// Whether the corner at the end of `wall` points into free ground (one can walk around it); also
/// true of a loose end.
bool pointsOut(std::span<const Wall> walls, std::uint32_t wall);

/// Appends a closed row of walls, each linked to the next. `corners` clockwise: an obstacle, free
/// ground outside; counter-clockwise: a room, free ground inside. Fewer than 2 corners add nothing.
/// Two corners give both sides of one thin wall.
void appendLoop(std::span<const glm::vec2> corners, glm::vec2 velocity, std::vector<Wall>& walls);

/// Appends a circle as a wall of no length (see Wall).
void appendCircle(glm::vec2 centre, float radius, glm::vec2 velocity, std::vector<Wall>& walls);

/// Appends the border of a navmesh: every stretch of a polygon's edge that is no portal, linked
/// along the border. `clearance` is the radius the navmesh was built for, metres. Where `states` of
/// this graph are given, a portal into what is closed is a wall to whoever is outside, and none to
/// who comes out. O(n log n) of the corners.
void appendBorder(const navmesh::NavGraph& graph, float clearance, std::vector<Wall>& walls,
                  const navmesh::PolygonStates* states = nullptr);

}  // namespace forewalk::agents
