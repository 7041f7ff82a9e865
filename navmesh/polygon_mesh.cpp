#include "navmesh/polygon_mesh.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <limits>
#include <numeric>
#include <string>
#include <utility>

#include "navmesh/plan.h"

namespace forewalk::navmesh {
namespace {

constexpr double kTolerance = 1e-3;  // metres; welding's own

using Check = tl::expected<void, Error>;

tl::unexpected<Error> damaged(std::string message) {
  return tl::unexpected(Error{ErrorCode::kDataDamaged, std::move(message)});
}

bool isFinite(glm::vec3 point) {
  return std::isfinite(point.x) && std::isfinite(point.y) && std::isfinite(point.z);
}

// Offsets start at 0, never fall, and end with the array they cut into rows.
Check checkRows(const std::vector<std::uint32_t>& start, std::size_t rows, std::size_t size,
                const char* what) {
  if (start.size() != rows + 1) {
    return damaged(
        fmt::format("{} offsets of {} polygons: {} are given, {} are needed. Build the "
                    "navmesh again.",
                    what, rows, start.size(), rows + 1));
  }
  if (start.front() != 0 || start.back() != size) {
    return damaged(
        fmt::format("{} offsets run from {} to {}, but must cover 0 to {}. Build the navmesh "
                    "again.",
                    what, start.front(), start.back(), size));
  }
  const auto fall = std::adjacent_find(start.begin(), start.end(), std::greater<>());
  if (fall != start.end()) {
    return damaged(
        fmt::format("the {} offset of polygon {} is {}, but the next one's is {}. Build the "
                    "navmesh again.",
                    what, fall - start.begin(), *fall, *(fall + 1)));
  }
  return {};
}

Check checkArrays(const PolygonMesh& mesh) {
  if (mesh.ringStart.size() < 2) {
    return tl::unexpected(
        Error{ErrorCode::kSceneEmpty,
              "the navmesh has no polygon. Build it from a scene that has some floor."});
  }
  const std::size_t polygons = mesh.ringStart.size() - 1;
  if (Check rows = checkRows(mesh.ringStart, polygons, mesh.ring.size(), "ring"); !rows)
    return rows;
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    const glm::vec3 v = mesh.vertices[i];
    if (!isFinite(v)) {
      return damaged(
          fmt::format("vertex {} is ({}, {}, {}), which is not finite. Build the navmesh "
                      "again.",
                      i, v.x, v.y, v.z));
    }
  }
  if (mesh.heightStart.empty() && mesh.heightTriangles.empty()) return {};
  if (Check rows = checkRows(mesh.heightStart, polygons, mesh.heightTriangles.size(), "height");
      !rows) {
    return rows;
  }
  for (std::size_t i = 0; i < mesh.heightTriangles.size(); ++i) {
    const HeightTriangle& t = mesh.heightTriangles[i];
    if (!isFinite(t.a) || !isFinite(t.b) || !isFinite(t.c)) {
      return damaged(
          fmt::format("height triangle {} has a coordinate that is not finite. Build the "
                      "navmesh again.",
                      i));
    }
  }
  return {};
}

// A ring on the plan, in double precision: coordinates far from the origin keep their millimetres.
using Ring = std::vector<glm::dvec2>;

// The corners of the ring's convex hull, as places in the ring, counter-clockwise (Andrew's
// monotone chain). Corners in a line are left out; one place stands for all corners at the same
// point.
std::vector<std::size_t> hullOf(const Ring& ring) {
  std::vector<std::size_t> order(ring.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    if (ring[a].x != ring[b].x) return ring[a].x < ring[b].x;
    if (ring[a].y != ring[b].y) return ring[a].y < ring[b].y;
    return a < b;
  });
  std::vector<std::size_t> hull;
  const auto addChain = [&](auto begin, auto end) {
    const std::size_t first = hull.size();
    for (auto i = begin; i != end; ++i) {
      while (hull.size() >= first + 2 && cross(ring[hull.back()] - ring[hull[hull.size() - 2]],
                                               ring[*i] - ring[hull.back()]) <= 0.0) {
        hull.pop_back();
      }
      hull.push_back(*i);
    }
    hull.pop_back();  // the next chain begins with it
  };
  addChain(order.begin(), order.end());
  addChain(order.rbegin(), order.rend());
  return hull;
}

// How far the ring leaves the closed polyline through its corners `hull`, metres; infinity where
// the ring does not visit them in that order. Walking back along the polyline counts as leaving it.
double straying(const Ring& ring, const std::vector<std::size_t>& hull, std::size_t& worst) {
  constexpr double kNever = std::numeric_limits<double>::infinity();
  double most = 0.0;
  std::size_t steps = 0;
  for (std::size_t h = 0; h < hull.size(); ++h) {
    const std::size_t next = hull[(h + 1) % hull.size()];
    const glm::dvec2 from = ring[hull[h]];
    const glm::dvec2 side = ring[next] - from;
    const double length = glm::length(side);
    const glm::dvec2 direction = length > 0.0 ? side / length : glm::dvec2(0.0);
    double reached = 0.0;
    for (std::size_t i = hull[h]; i != next; i = (i + 1) % ring.size()) {
      if (++steps > ring.size()) return kNever;
      const glm::dvec2 offset = ring[i] - from;
      const double along = glm::dot(offset, direction);
      const double beside = glm::length(offset - std::clamp(along, 0.0, length) * direction);
      const double away = std::max(beside, reached - along);
      if (away > most) {
        most = away;
        worst = i;
      }
      reached = std::max(reached, along);
    }
  }
  return steps == ring.size() ? most : kNever;
}

std::size_t farthestFrom(const Ring& ring, glm::dvec2 point) {
  const auto nearer = [&](glm::dvec2 a, glm::dvec2 b) {
    return glm::distance(a, point) < glm::distance(b, point);
  };
  return static_cast<std::size_t>(std::max_element(ring.begin(), ring.end(), nearer) -
                                  ring.begin());
}

// Out and back within a millimetre of one line.
bool isSliver(const Ring& ring) {
  const std::size_t one = farthestFrom(ring, ring[0]);
  const std::size_t other = farthestFrom(ring, ring[one]);
  std::size_t worst = 0;
  return one == other || straying(ring, {one, other}, worst) <= kTolerance;
}

Check checkShape(const Ring& ring, std::uint32_t polygon) {
  std::size_t worst = 0;
  const double inside = straying(ring, hullOf(ring), worst);
  if (inside <= kTolerance || isSliver(ring)) return {};
  double area = 0.0;
  for (std::size_t i = 1; i + 1 < ring.size(); ++i) {
    area += 0.5 * cross(ring[i] - ring[0], ring[i + 1] - ring[0]);
  }
  if (area < 0.0) {
    return damaged(
        fmt::format("polygon {} is clockwise seen from above: its area is {} m^2. Reverse "
                    "its corners.",
                    polygon, area));
  }
  if (std::isfinite(inside)) {
    return damaged(
        fmt::format("polygon {} is not convex: its corner {} at ({}, {}) on the plan lies {} "
                    "m inside the hull, at most {} is allowed. Split it there.",
                    polygon, worst, ring[worst].x, ring[worst].y, inside, kTolerance));
  }
  return damaged(
      fmt::format("polygon {} is not convex: its {} corners do not walk around their hull "
                  "once. Split it.",
                  polygon, ring.size()));
}

Check checkRing(const PolygonMesh& mesh, std::uint32_t polygon, std::vector<std::uint32_t>& sorted,
                Ring& plan) {
  const auto begin = mesh.ring.begin() + mesh.ringStart[polygon];
  const auto end = mesh.ring.begin() + mesh.ringStart[polygon + 1];
  if (end - begin < 3) {
    return damaged(fmt::format("polygon {} has {} corners, 3 are needed. Build the navmesh again.",
                               polygon, end - begin));
  }
  sorted.assign(begin, end);
  std::sort(sorted.begin(), sorted.end());
  if (sorted.back() >= mesh.vertices.size()) {
    return damaged(fmt::format("polygon {} names vertex {}, the navmesh has {}. Build it again.",
                               polygon, sorted.back(), mesh.vertices.size()));
  }
  const auto repeated = std::adjacent_find(sorted.begin(), sorted.end());
  if (repeated != sorted.end()) {
    return damaged(fmt::format("polygon {} names vertex {} twice. Build the navmesh again.",
                               polygon, *repeated));
  }
  plan.clear();
  std::transform(begin, end, std::back_inserter(plan),
                 [&](std::uint32_t vertex) { return glm::dvec2(toPlan(mesh.vertices[vertex])); });
  return checkShape(plan, polygon);
}

Check checkBorderPortal(const PolygonMesh& mesh, std::size_t i) {
  const BorderPortal& portal = mesh.borderPortals[i];
  for (const auto& [polygon, edge] :
       {std::pair(portal.from, portal.fromEdge), std::pair(portal.to, portal.toEdge)}) {
    if (index(polygon) >= mesh.polygonCount()) {
      return damaged(
          fmt::format("border portal {} names polygon {}, the navmesh has {}. Build it "
                      "again.",
                      i, index(polygon), mesh.polygonCount()));
    }
    const std::uint32_t corners =
        mesh.ringStart[index(polygon) + 1] - mesh.ringStart[index(polygon)];
    if (edge >= corners) {
      return damaged(
          fmt::format("border portal {} names edge {} of polygon {}, which has {}. Build "
                      "the navmesh again.",
                      i, edge, index(polygon), corners));
    }
  }
  if (portal.from == portal.to) {
    return damaged(
        fmt::format("border portal {} joins polygon {} to itself. Build the navmesh again.", i,
                    index(portal.from)));
  }
  if (!isFinite(portal.left) || !isFinite(portal.right)) {
    return damaged(
        fmt::format("border portal {} has an end that is not finite. Build the navmesh "
                    "again.",
                    i));
  }
  return {};
}

}  // namespace

Check validate(const PolygonMesh& mesh) {
  if (Check arrays = checkArrays(mesh); !arrays) return arrays;
  std::vector<std::uint32_t> sorted;
  Ring plan;
  for (std::uint32_t polygon = 0; polygon < mesh.polygonCount(); ++polygon) {
    if (Check ring = checkRing(mesh, polygon, sorted, plan); !ring) return ring;
  }
  for (std::size_t i = 0; i < mesh.borderPortals.size(); ++i) {
    if (Check portal = checkBorderPortal(mesh, i); !portal) return portal;
  }
  return {};
}

}  // namespace forewalk::navmesh
