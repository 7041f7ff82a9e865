#include "navmesh/build/tile_borders.h"

#include <cmath>

#include "navmesh/plan.h"

namespace forewalk::navmesh {

std::optional<BorderEdge> borderEdge(std::uint32_t polygon, std::uint32_t edge, glm::vec3 from,
                                     glm::vec3 to) {
  const glm::vec2 a = toPlan(from), b = toPlan(to);
  const glm::vec2 run = b - a;
  const int along = std::abs(run.x) >= std::abs(run.y) ? 0 : 1, across = 1 - along;
  if (std::abs(run[across]) > kWeld || std::abs(run[along]) <= kWeld) return std::nullopt;
  BorderEdge border;
  border.polygon = polygon;
  border.edge = edge;
  border.axis = along;
  // Counter-clockwise: the polygon lies left of its edge.
  border.positive = along == 1 ? run.y > 0.0f : run.x < 0.0f;
  border.line = 0.5f * (a[across] + b[across]);
  const bool forward = run[along] > 0.0f;
  border.low = forward ? a[along] : b[along];
  border.high = forward ? b[along] : a[along];
  border.atLow = forward ? from : to;
  border.atHigh = forward ? to : from;
  return border;
}

std::optional<BorderPortal> portalBetween(const BorderEdge& from, const BorderEdge& to,
                                          float climb) {
  if (std::abs(from.line - to.line) > kWeld) return std::nullopt;
  double low = std::max(from.low, to.low), high = std::min(from.high, to.high);
  if (high - low <= kWeld) return std::nullopt;

  // Where the two edges are within a step of each other. Their difference in height is linear, so
  // that is an interval too.
  const double gapLow = from.heightAt(low) - to.heightAt(low);
  const double gapHigh = from.heightAt(high) - to.heightAt(high);
  const double slope = (gapHigh - gapLow) / (high - low);
  const double step = climb;
  const double start = low;
  const auto cut = [&](double limit) { return start + (limit - gapLow) / slope; };
  if (std::max(gapLow, gapHigh) > step) {
    if (std::min(gapLow, gapHigh) > step) return std::nullopt;
    (gapLow > step ? low : high) = cut(step);
  }
  if (std::min(gapLow, gapHigh) < -step) {
    if (std::max(gapLow, gapHigh) < -step) return std::nullopt;
    (gapLow < -step ? low : high) = cut(-step);
  }
  if (high - low <= kWeld) return std::nullopt;

  // An end that is a corner of one of them gets exactly the corner's place, so that paths around it
  // do not bend twice.
  const auto end = [&](double along) {
    glm::vec2 plan;
    plan[from.axis] = static_cast<float>(along);
    plan[1 - from.axis] = from.line;
    for (const BorderEdge* edge : {&to, &from}) {
      if (along == edge->low) plan = toPlan(edge->atLow);
      if (along == edge->high) plan = toPlan(edge->atHigh);
    }
    return toSpace(plan, static_cast<float>(0.5 * (from.heightAt(along) + to.heightAt(along))));
  };
  // Walking out of a counter-clockwise polygon, left is where its edge leads to.
  const bool leftIsHigh = from.axis == 1 ? from.positive : !from.positive;
  return BorderPortal{PolygonId{from.polygon},      PolygonId{to.polygon},       from.edge, to.edge,
                      end(leftIsHigh ? high : low), end(leftIsHigh ? low : high)};
}

}  // namespace forewalk::navmesh
