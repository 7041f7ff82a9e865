// Where polygons of different tiles touch: edges on a line along an axis of the plan, from its two
// sides. Internal to the builders.
#pragma once

#include <algorithm>
#include <cstdint>
#include <glm/glm.hpp>
#include <optional>

#include "navmesh/polygon_mesh.h"

namespace forewalk::navmesh {

/// Points this close are one, metres.
inline constexpr float kWeld = 1e-3f;

inline bool isWelded(glm::vec3 a, glm::vec3 b) {
  return glm::distance(glm::dvec3(a), glm::dvec3(b)) <= kWeld;
}

/// A polygon edge on a tile's border, as an interval on a line along an axis of the plan.
struct BorderEdge {
  std::uint32_t polygon, edge;
  std::uint32_t tile = 0;   ///< its number, where tiles are collected
  int axis;                 ///< of the plan, along which the line runs
  bool positive;            ///< the polygon lies on the side of smaller coordinates across the line
  float line;               ///< coordinate across, metres
  float low, high;          ///< interval along the line, metres
  glm::vec3 atLow, atHigh;  ///< its ends, world space
  std::uint32_t lowVertex = 0, highVertex = 0;  ///< where vertices are numbered

  double heightAt(double along) const {
    const double t = std::clamp((along - low) / (static_cast<double>(high) - low), 0.0, 1.0);
    return atLow.y + t * (static_cast<double>(atHigh.y) - atLow.y);
  }
};

/// The edge of a counter-clockwise polygon between two of its corners; none where it does not run
/// along an axis, or is shorter than welding.
std::optional<BorderEdge> borderEdge(std::uint32_t polygon, std::uint32_t edge, glm::vec3 from,
                                     glm::vec3 to);

/// The portal where two edges from the two sides of a line overlap by more than the weld and differ
/// by at most `climb` (metres) in height. Its polygons are the edges'.
std::optional<BorderPortal> portalBetween(const BorderEdge& from, const BorderEdge& to,
                                          float climb);

}  // namespace forewalk::navmesh
