// The ends of portals: which of them are one place, and which are corners that paths bend around.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "navmesh/nav_graph.h"

namespace forewalk::prediction {

/// The ends of all portals of a navgraph: which of them are one place that one can turn about, and
/// which are corners where a shortest path may bend. Two places may have the same coordinates: on
/// two storeys, or where walkable polygons touch without being joined. Made once, then only read.
struct PortalEnds {
  /// Ends of a half-portal as one walks out through it.
  struct Pair {
    std::uint32_t left, right;
  };
  enum class Kind : std::uint8_t {
    kOpen,   ///< nothing bends here: walkable all around, or a wall that is straight or hollow
    kBend,   ///< on the border, walkable over more than half a turn
    kKnot,   ///< the same, but too thin, too wide or too rounded to be judged by `walls`
    kPinch,  ///< a portal of no width: one passes from any polygon here into any other
  };
  /// A point on each of the two walls that meet in a bend: where the walkable area about it ends
  /// counter-clockwise, and where it ends clockwise. Metres.
  struct Walls {
    glm::vec2 last, first;
  };

  std::vector<Pair> ofPortal;   ///< per half-portal
  std::vector<glm::vec2> plan;  ///< per end, metres; the same for all portals that meet there
  std::vector<float> height;    ///< per end, world y, metres
  std::vector<Kind> kind;       ///< per end
  std::vector<Walls> walls;     ///< per end; only bends have them
  std::uint32_t bendCount = 0;  ///< ends that are not kOpen

  std::uint32_t count() const { return static_cast<std::uint32_t>(plan.size()); }
};

/// O(n log n) in the half-portals. Ends of portals of one polygon that are closer than a few units
/// in the last place are one (tile borders are cut in floats).
PortalEnds makePortalEnds(const navmesh::NavGraph& graph);

/// How far apart rounding may put two ends of a graph that are one; metres.
float roundingOf(const navmesh::NavGraph& graph);

}  // namespace forewalk::prediction
