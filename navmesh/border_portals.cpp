#include "navmesh/border_portals.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <tuple>
#include <utility>

#include "navmesh/plan.h"

namespace forewalk::navmesh {

namespace {

using Check = tl::expected<void, Error>;

// How far a border portal's end may leave its edge, metres.
constexpr double kPortalTolerance = 0.01;

tl::unexpected<Error> damaged(std::string message) {
  return tl::unexpected(Error{ErrorCode::kDataDamaged, std::move(message)});
}

// A border portal's end against one of the edges it must lie on, which runs from `begin` to `end`.
struct Offset {
  double plan;    // beside the edge, metres
  double height;  // above or below it, metres
  double along;   // from 0 at `begin` to 1 at `end`
};

Offset offsetFrom(glm::vec3 point, glm::vec3 begin, glm::vec3 end) {
  const glm::dvec2 from(toPlan(begin));
  const glm::dvec2 edge = glm::dvec2(toPlan(end)) - from;
  const double square = glm::dot(edge, edge);
  const glm::dvec2 offset = glm::dvec2(toPlan(point)) - from;
  const double along = square > 0.0 ? std::clamp(glm::dot(offset, edge) / square, 0.0, 1.0) : 0.0;
  const double ground = begin.y + along * (static_cast<double>(end.y) - begin.y);
  return {glm::length(offset - along * edge), std::abs(point.y - ground), along};
}

Check checkOnEdge(const PolygonMesh& flat, std::size_t number, PolygonId polygon,
                  std::uint32_t edge, glm::vec3 ahead, glm::vec3 behind, float climb) {
  const std::uint32_t start = flat.ringStart[index(polygon)];
  const std::uint32_t corners = flat.ringStart[index(polygon) + 1] - start;
  const glm::vec3 begin = flat.vertices[flat.ring[start + edge]];
  const glm::vec3 end = flat.vertices[flat.ring[start + (edge + 1) % corners]];
  for (const glm::vec3 point : {ahead, behind}) {
    const Offset offset = offsetFrom(point, begin, end);
    if (offset.plan > kPortalTolerance || offset.height > climb + kPortalTolerance) {
      return damaged(
          fmt::format("border portal {} ends {} m beside and {} m above or below edge {} of "
                      "polygon {}, at most {} and {} m are allowed. Build the navmesh again.",
                      number, offset.plan, offset.height, edge, index(polygon), kPortalTolerance,
                      climb + kPortalTolerance));
    }
  }
  const glm::dvec2 run = glm::dvec2(toPlan(end)) - glm::dvec2(toPlan(begin));
  const glm::dvec2 portal = glm::dvec2(toPlan(ahead)) - glm::dvec2(toPlan(behind));
  if (glm::dot(run, portal) < -kPortalTolerance * glm::length(run)) {
    return damaged(
        fmt::format("border portal {} has left and right exchanged, seen from polygon {}. Build "
                    "the navmesh again.",
                    number, index(polygon)));
  }
  return {};
}

}  // namespace

tl::expected<void, Error> checkBorderPortals(const PolygonMesh& flat, float climb) {
  const auto key = [](const BorderPortal& p) {
    return std::tie(p.from, p.fromEdge, p.to, p.toEdge);
  };
  for (std::size_t i = 0; i < flat.borderPortals.size(); ++i) {
    const BorderPortal& portal = flat.borderPortals[i];
    if (i > 0 && key(portal) < key(flat.borderPortals[i - 1])) {
      return damaged(
          fmt::format("border portal {} leaves polygon {} by edge {}, but stands after one of "
                      "polygon {}, edge {}. Sort them.",
                      i, index(portal.from), portal.fromEdge, index(flat.borderPortals[i - 1].from),
                      flat.borderPortals[i - 1].fromEdge));
    }
    // Counter-clockwise, whoever walks out over an edge has its end on the left, and its begin
    // there who walks in.
    Check out =
        checkOnEdge(flat, i, portal.from, portal.fromEdge, portal.left, portal.right, climb);
    if (!out) return out;
    Check in = checkOnEdge(flat, i, portal.to, portal.toEdge, portal.right, portal.left, climb);
    if (!in) return in;
  }
  return {};
}

}  // namespace forewalk::navmesh
