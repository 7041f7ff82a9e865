#include "navmesh/polygon_states.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <string>
#include <utility>

#include "navmesh/graph_rows.h"
#include "navmesh/plan.h"

namespace forewalk::navmesh {
namespace {

constexpr double kTolerance = 1e-3;  // metres

using Check = tl::expected<void, Error>;

Check outOfRange(std::string message) {
  return tl::unexpected(Error{ErrorCode::kSettingOutOfRange, std::move(message)});
}

std::uint32_t openNeighboursOf(const NavGraph& graph, const PolygonStates& states,
                               std::uint32_t polygon) {
  const PolygonId* begin = graph.portalTo.data() + graph.portalStart[polygon];
  const PolygonId* end = graph.portalTo.data() + graph.portalStart[polygon + 1];
  std::uint32_t count = 0;
  for (const PolygonId* to = begin; to != end; ++to) {
    const bool first = std::find(begin, to, *to) == to;
    count += first && !states.isClosed(*to) ? 1 : 0;
  }
  const std::span<const LinkWay> ways = states.links.from(PolygonId{polygon});
  for (auto way = ways.begin(); way != ways.end(); ++way) {
    const bool first =
        way->to != PolygonId{polygon} && std::find(begin, end, way->to) == end &&
        std::none_of(ways.begin(), way, [&](const LinkWay& w) { return w.to == way->to; });
    count += first && !states.isClosed(way->to) ? 1 : 0;
  }
  return count;
}

/// Fills in what follows from the costs and the links.
void settle(const NavGraph& graph, PolygonStates& states) {
  const bool free =
      std::all_of(states.cost.begin(), states.cost.end(), [](float c) { return c == 1.0f; });
  if (free && states.links.empty()) {
    states = PolygonStates{};
    return;
  }
  if (states.cost.empty()) states.cost.assign(graph.polygonCount(), 1.0f);
  states.openNeighbours.resize(graph.polygonCount());
  for (std::uint32_t p = 0; p < graph.polygonCount(); ++p) {
    states.openNeighbours[p] = openNeighboursOf(graph, states, p);
  }
  std::vector<char> linked(states.links.empty() ? 0 : graph.polygonCount(), 0);
  for (const LinkWay& way : states.links.ways) {
    if (way.from == way.to) continue;
    linked[index(way.from)] = 1;
    linked[index(way.to)] = 1;
  }
  states.chains = findChains(graph, states.cost, states.openNeighbours, linked);
}

bool holds(const PlanArea& area, glm::vec2 plan) {
  for (std::size_t i = 0; i < area.corners.size(); ++i) {
    if (exactTurn(area.corners[i], area.corners[(i + 1) % area.corners.size()], plan) < 0.0) {
      return false;
    }
  }
  return true;
}

Check checkArea(const PlanArea& area, std::size_t number) {
  const std::vector<glm::vec2>& corners = area.corners;
  const auto wrong = [&](const std::string& what) {
    return outOfRange(fmt::format("polygon states: area {} {}.", number, what));
  };
  if (corners.size() < 3) {
    return wrong(fmt::format("has {} corners, give 3 or more", corners.size()));
  }
  const bool finite = std::all_of(corners.begin(), corners.end(), [](glm::vec2 c) {
    return std::isfinite(c.x) && std::isfinite(c.y);
  });
  if (!finite || !std::isfinite(area.bottom) || !std::isfinite(area.top)) {
    return wrong("has a number that is not finite, give metres");
  }
  if (!(area.bottom <= area.top)) {
    return wrong(
        fmt::format("reaches from {:g} m up to {:g} m, exchange them", area.bottom, area.top));
  }
  double twiceArea = 0.0;
  for (std::size_t i = 1; i + 1 < corners.size(); ++i) {
    twiceArea += exactTurn(corners[0], corners[i], corners[i + 1]);
  }
  if (!(twiceArea > 0.0)) {
    return wrong(
        fmt::format("has {:g} m^2 counter-clockwise seen from above, reverse or spread "
                    "its corners",
                    0.5 * twiceArea));
  }
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const glm::vec2 from = corners[i], to = corners[(i + 1) % corners.size()];
    const double length = glm::distance(glm::dvec2(from), glm::dvec2(to));
    for (std::size_t k = 0; k < corners.size(); ++k) {
      if (exactTurn(from, to, corners[k]) >= -kTolerance * length) continue;
      return wrong(
          fmt::format("is not convex: corner {} lies outside the edge from corner {}, "
                      "split it",
                      k, i));
    }
  }
  return {};
}

}  // namespace

Check checkCost(float cost) {
  if ((cost >= 1.0f && cost <= kHighestCost) || cost == kClosed) return {};  // false for NaN
  return outOfRange(
      fmt::format("polygon states: a cost of {:g} cannot work: give 1 to {:g}, or infinity to "
                  "close.",
                  cost, kHighestCost));
}

std::vector<PolygonId> polygonsIn(const NavGraph& graph, const PlanArea& area) {
  std::vector<PolygonId> found;
  for (std::uint32_t p = 0; p < graph.polygonCount(); ++p) {
    const float height = graph.centroidHeight[p];
    if (height >= area.bottom && height <= area.top && holds(area, graph.centroid[p])) {
      found.push_back(PolygonId{p});
    }
  }
  return found;
}

Check setCost(const NavGraph& graph, std::span<const PolygonId> polygons, float cost,
              PolygonStates& states) {
  if (Check ok = checkCost(cost); !ok) return ok;
  for (const PolygonId polygon : polygons) {
    if (index(polygon) < graph.polygonCount()) continue;
    return tl::unexpected(
        Error{ErrorCode::kDataDamaged,
              fmt::format("polygon states: polygon {} is named, the navgraph has {}. Find it "
                          "again in this graph.",
                          index(polygon), graph.polygonCount())});
  }
  if (polygons.empty()) return {};
  if (states.cost.empty()) states.cost.assign(graph.polygonCount(), 1.0f);
  for (const PolygonId polygon : polygons) states.cost[index(polygon)] = cost;
  settle(graph, states);
  return {};
}

void setLinks(const NavGraph& graph, Links links, PolygonStates& states) {
  states.links = std::move(links);
  settle(graph, states);
}

tl::expected<PolygonStates, Error> makePolygonStates(const NavGraph& graph,
                                                     std::span<const AreaCost> areas, Links links,
                                                     std::span<const PolygonCost> more) {
  PolygonStates states;
  states.links = std::move(links);
  for (std::size_t i = 0; i < areas.size(); ++i) {
    if (Check ok = checkArea(areas[i].area, i); !ok) return tl::unexpected(ok.error());
    if (Check ok = checkCost(areas[i].cost); !ok) return tl::unexpected(ok.error());
    if (areas[i].cost == 1.0f) continue;
    for (const PolygonId polygon : polygonsIn(graph, areas[i].area)) {
      if (states.cost.empty()) states.cost.assign(graph.polygonCount(), 1.0f);
      float& cost = states.cost[index(polygon)];
      cost = std::max(cost, areas[i].cost);
    }
  }
  for (const PolygonCost& one : more) {
    if (one.cost == 1.0f) continue;
    if (states.cost.empty()) states.cost.assign(graph.polygonCount(), 1.0f);
    float& cost = states.cost[index(one.polygon)];
    cost = std::max(cost, one.cost);
  }
  settle(graph, states);
  return states;
}

NavGraph openPart(const NavGraph& graph, const PolygonStates& states) {
  NavGraph open = graph;
  std::vector<std::uint32_t> kept(graph.portalCount(), graph.portalCount());  // number in `open`
  std::uint32_t count = 0;
  for (std::uint32_t p = 0; p < graph.polygonCount(); ++p) {
    open.portalStart[p] = count;
    for (std::uint32_t h = graph.portalStart[p]; h < graph.portalStart[p + 1]; ++h) {
      if (states.isClosed(PolygonId{p}) || states.isClosed(graph.portalTo[h])) continue;
      open.portalTo[count] = graph.portalTo[h];
      open.portalToCentroid[count] = graph.portalToCentroid[h];
      open.portalMidpoint[count] = graph.portalMidpoint[h];
      open.portals[count] = graph.portals[h];
      open.portalTwin[count] = graph.portalTwin[h];
      open.portalEdge[count] = graph.portalEdge[h];
      open.portalHeights[count] = graph.portalHeights[h];
      kept[h] = count++;
    }
  }
  open.portalStart.back() = count;
  open.portalTo.resize(count);
  open.portalToCentroid.resize(count);
  open.portalMidpoint.resize(count);
  open.portals.resize(count);
  open.portalTwin.resize(count);
  open.portalEdge.resize(count);
  open.portalHeights.resize(count);
  for (std::uint32_t& twin : open.portalTwin) twin = kept[twin];
  // Fewer ways through polygons than before, so that there is nothing to fail.
  [[maybe_unused]] const auto completed = completeRows(open);
  assert(completed);
  return open;
}

}  // namespace forewalk::navmesh
