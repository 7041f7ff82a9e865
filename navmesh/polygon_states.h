// Doors and areas that open and close at once, and links: what walking through each polygon costs,
// and what leads out of it beside its portals.
//
// An overlay beside the navgraph, which stays as it is and shared. Nothing is rebuilt, so that a
// door closes with the next frame; where geometry changes, obstacles are carved instead
// (build/live_mesh.h). Overlays are values: change a copy and publish that, as a World is. What a
// search needs of them beyond the costs is found here as well, off the frame.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <limits>
#include <span>
#include <tl/expected.hpp>
#include <vector>

#include "navmesh/error.h"
#include "navmesh/links.h"
#include "navmesh/nav_graph.h"

namespace forewalk::navmesh {

/// The cost of a polygon that nobody walks through.
inline constexpr float kClosed = std::numeric_limits<float>::infinity();

/// The highest cost of a polygon that is open: far above it, floats of the ways through it and of
/// the others have no digits in common.
inline constexpr float kHighestCost = 1e6f;

/// Belongs to the one graph it was made for. Changed by setCost and setLinks only: the rest follows
/// from `cost` and `links`.
struct PolygonStates {
  /// Per polygon: how many metres one metre through it counts for, 1 to kHighestCost, or kClosed.
  /// Empty, as are the others: 1 everywhere, and no links.
  std::vector<float> cost;
  Links links;

  std::vector<std::uint32_t> openNeighbours;  ///< per polygon: distinct neighbours not closed, by
                                              ///< portals and by ways of links out of it
  Chains chains;                              ///< findChains with these; ends of links lie in none

  float costOf(PolygonId polygon) const { return cost.empty() ? 1.0f : cost[index(polygon)]; }
  bool isClosed(PolygonId polygon) const { return costOf(polygon) == kClosed; }
  bool allOpen() const { return cost.empty(); }  ///< and nothing costs more, and no link

  bool operator==(const PolygonStates&) const = default;
};

/// A part of the building: a convex outline and a range of heights.
struct PlanArea {
  std::vector<glm::vec2> corners;  ///< 3 or more, counter-clockwise on the plan, metres
  float bottom = -0.5f;            ///< world y, metres
  float top = 2.0f;                ///< world y, metres

  bool operator==(const PlanArea&) const = default;
};

/// An area and what it costs.
struct AreaCost {
  PlanArea area;
  float cost = kClosed;  ///< 1 to kHighestCost, or kClosed

  bool operator==(const AreaCost&) const = default;
};

/// A polygon and what it costs.
struct PolygonCost {
  PolygonId polygon;
  float cost;

  bool operator==(const PolygonCost&) const = default;
};

/// Fails when a cost is neither 1 to kHighestCost nor kClosed (kSettingOutOfRange).
[[nodiscard]] tl::expected<void, Error> checkCost(float cost);

/// The polygons whose centroid lies in the area, border included, ascending. A polygon that only
/// reaches into it is not named: cut the ground along the outline when it is built (LiveMesh does)
/// and polygons lie on one side or the other. O(polygons * corners).
std::vector<PolygonId> polygonsIn(const NavGraph& graph, const PlanArea& area);

/// Sets the cost of some polygons in `states`, which belongs to `graph`.
///
/// Fails, and changes nothing, when a polygon is not in the graph (kDataDamaged) or the cost is
/// not one (kSettingOutOfRange). O(half-portals): set many polygons at once.
[[nodiscard]] tl::expected<void, Error> setCost(const NavGraph& graph,
                                                std::span<const PolygonId> polygons, float cost,
                                                PolygonStates& states);

/// The graph without the portals into and out of what is closed: polygons keep their numbers, and
/// what is closed has no neighbours. For searches that know of no states. O(half-portals).
NavGraph openPart(const NavGraph& graph, const PolygonStates& states);

/// Puts links that were made for `graph` into `states`, in the place of those before.
/// O(half-portals).
void setLinks(const NavGraph& graph, Links links, PolygonStates& states);

/// The states of a graph whose areas have these costs, with its links, and `more` polygons (of the
/// graph, with sound costs; standing.h finds some). Where they overlap the higher cost counts, so
/// their order does not matter. All at cost 1, or none, and no links: empty.
///
/// Fails when a cost is neither 1 to kHighestCost nor kClosed, or an area has fewer than 3 corners,
/// a number that is not finite, or is not convex and counter-clockwise (1 mm) (kSettingOutOfRange,
/// naming which). O(areas * polygons * corners + half-portals).
[[nodiscard]] tl::expected<PolygonStates, Error> makePolygonStates(
    const NavGraph& graph, std::span<const AreaCost> areas, Links links = {},
    std::span<const PolygonCost> more = {});

}  // namespace forewalk::navmesh
