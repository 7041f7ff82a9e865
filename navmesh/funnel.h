// Pulls the shortest path taut through a corridor of portals.
//
// The funnel algorithm of Lee and Preparata (Networks 14, 1984), in the form that rescans from each
// new apex: no queue to keep, and corridors within a horizon are short.
#pragma once

#include <span>
#include <vector>

#include "navmesh/nav_graph.h"

namespace forewalk::navmesh {

/// Replaces `path` with the shortest path from `start` to `goal` that crosses `corridor` in order:
/// `start`, then each apex where the path bends, then `goal`. No two neighbours are equal; where
/// `start == goal` and nothing lies between, the path is that one point.
///
/// The portals come in walking order, already narrowed by the walker's radius, all coordinates
/// finite. An empty corridor gives the straight segment, so there is no failure to report.
///
/// Costs O(portals) on most corridors, O(portals * waypoints) at worst. Allocates only where `path`
/// has to grow, so a caller that keeps `path` from frame to frame soon allocates nothing.
void pullString(glm::vec2 start, glm::vec2 goal, std::span<const Portal> corridor,
                std::vector<glm::vec2>& path);

/// The same for a corridor given as a row of half-portals of `graph`, in walking order.
void pullString(const NavGraph& graph, glm::vec2 start, glm::vec2 goal,
                std::span<const std::uint32_t> corridor, std::vector<glm::vec2>& path);

/// Lifts a taut path onto the surface: `path` (from pullString through `corridor`, a row of half-portals
/// of `graph`, walking order, starting in `first`) with heights, and with a point wherever the ground
/// under it bends by more than `tolerance` metres from the straight line between its neighbours (where
/// stairs begin and end). The plan of the result is the same path. Replaces `lifted`; world space.
void liftPath(const NavGraph& graph, PolygonId first, std::span<const std::uint32_t> corridor,
              std::span<const glm::vec2> path, float tolerance, std::vector<glm::vec3>& lifted);

/// The same, behind what is in `lifted` already: for ways that go on elsewhere (links.h).
void appendLifted(const NavGraph& graph, PolygonId first, std::span<const std::uint32_t> corridor,
                  std::span<const glm::vec2> path, float tolerance, std::vector<glm::vec3>& lifted);

/// Length of a polyline, metres. 0 for fewer than two points.
float lengthOf(std::span<const glm::vec2> path);

}  // namespace forewalk::navmesh
