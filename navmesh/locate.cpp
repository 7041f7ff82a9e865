#include "navmesh/locate.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "navmesh/plan.h"

namespace forewalk::navmesh {
namespace {

struct Bounds {
  glm::vec2 low{std::numeric_limits<float>::infinity()};
  glm::vec2 high{-std::numeric_limits<float>::infinity()};

  void add(glm::vec2 point) {
    low = glm::min(low, point);
    high = glm::max(high, point);
  }
};

Bounds boundsOf(std::span<const glm::vec2> points) {
  Bounds bounds;
  for (const glm::vec2 point : points) bounds.add(point);
  return bounds;
}

// Both corners included.
struct CellRange {
  std::uint32_t lowColumn, lowRow, highColumn, highRow;

  std::uint64_t count() const {
    return std::uint64_t{highColumn - lowColumn + 1} * (highRow - lowRow + 1);
  }
};

// Rounding is monotone, so a point inside a polygon's bounds falls into one of the polygon's cells.
CellRange cellsOf(const LocationIndex& index, const Bounds& bounds) {
  const auto cell = [&](float coordinate, float origin, std::uint32_t count) {
    const float cells = (coordinate - origin) / index.cellSize;
    return static_cast<std::uint32_t>(std::clamp(cells, 0.0f, static_cast<float>(count - 1)));
  };
  return {cell(bounds.low.x, index.origin.x, index.columns),
          cell(bounds.low.y, index.origin.y, index.rows),
          cell(bounds.high.x, index.origin.x, index.columns),
          cell(bounds.high.y, index.origin.y, index.rows)};
}

template <typename Visit>
void forCells(const LocationIndex& index, const CellRange& range, const Visit& visit) {
  for (std::uint32_t row = range.lowRow; row <= range.highRow; ++row) {
    for (std::uint32_t column = range.lowColumn; column <= range.highColumn; ++column) {
      visit(row * index.columns + column);
    }
  }
}

void setCells(LocationIndex& index, glm::dvec2 size, double cell) {
  index.cellSize = static_cast<float>(cell);
  index.columns = static_cast<std::uint32_t>(size.x / cell) + 1;
  index.rows = static_cast<std::uint32_t>(size.y / cell) + 1;
}

glm::vec2 nearestOnSegment(glm::vec2 from, glm::vec2 to, glm::vec2 plan) {
  const glm::vec2 edge = to - from;
  const float length = glm::dot(edge, edge);
  if (!(length > 0.0f)) return from;
  const float share = std::clamp(glm::dot(plan - from, edge) / length, 0.0f, 1.0f);
  return share < 1.0f ? from + share * edge : to;
}

float squaredDistance(glm::vec2 a, glm::vec2 b) { return glm::dot(a - b, a - b); }

glm::vec2 nearestInPolygon(const NavGraph& graph, PolygonId polygon, glm::vec2 plan) {
  if (contains(graph, polygon, plan)) return plan;
  const std::span<const glm::vec2> ring = graph.ringOf(polygon);
  glm::vec2 nearest = ring[0];
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const glm::vec2 next = ring[i + 1 < ring.size() ? i + 1 : 0];
    const glm::vec2 point = nearestOnSegment(ring[i], next, plan);
    if (squaredDistance(point, plan) < squaredDistance(nearest, plan)) nearest = point;
  }
  return nearest;
}

bool inReach(float height, glm::vec3 position, const SnapLimits& limits) {
  return height >= position.y - limits.below && height <= position.y + limits.above;
}

// Written where it is returned: copying a Location that was just written stalls for longer than
// finding it took.
std::optional<Location> placeIn(PolygonId polygon, glm::vec2 plan, float height) {
  std::optional<Location> place(std::in_place);
  place->polygon = polygon;
  place->plan = plan;
  place->height = height;
  return place;
}

// Keeps the best place of those offered: nearest on the plan, then in height, then the smallest id.
class NearestPlace {
 public:
  NearestPlace(const NavGraph& graph, glm::vec3 position, const SnapLimits& limits)
      : graph_(graph), position_(position), plan_(toPlan(position)), limits_(limits) {}

  void offer(PolygonId polygon) {
    const glm::vec2 plan = nearestInPolygon(graph_, polygon, plan_);
    const float distance = glm::distance(plan, plan_);
    if (!(distance <= limits_.distance) || distance > distance_) return;
    const float height = heightAt(graph_, polygon, plan);
    if (!inReach(height, position_, limits_)) return;
    const float apart = std::abs(height - position_.y);
    const bool nearer = distance < distance_ || apart < apart_ ||
                        (apart == apart_ && index(polygon) < index(place_.polygon));
    if (!nearer) return;
    distance_ = distance;
    apart_ = apart;
    place_ = {polygon, plan, height, distance > 0.0f};
  }

  // Whether the place found holds the query itself, so that nothing beside it can be nearer.
  bool exact() const { return distance_ == 0.0f; }

  std::optional<Location> result() const {
    return place_.polygon == kNoPolygon ? std::nullopt : std::optional(place_);
  }

 private:
  const NavGraph& graph_;
  glm::vec3 position_;
  glm::vec2 plan_;
  SnapLimits limits_;
  Location place_;
  float distance_ = std::numeric_limits<float>::infinity();
  float apart_ = std::numeric_limits<float>::infinity();
};

bool isFinite(glm::vec3 p) {
  return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
}

// The half-portal by which the straight walk from `from`, inside `polygon`, to `to`, outside,
// leaves it; graph.portalCount() where a wall is in the way. Never the way it came in by, which
// `to` is not outside of.
std::uint32_t portalCrossed(const NavGraph& graph, PolygonId polygon, glm::vec2 from,
                            glm::vec2 to) {
  const glm::vec2 walk = to - from;
  const std::uint32_t end = graph.portalStart[index(polygon) + 1];
  for (std::uint32_t h = graph.portalStart[index(polygon)]; h < end; ++h) {
    const Portal& portal = graph.portals[h];
    const bool beyond = cross(portal.right - to, portal.left - to) < 0.0f;
    if (beyond && cross(walk, portal.left - from) >= 0.0f &&
        cross(walk, portal.right - from) <= 0.0f) {
      return h;
    }
  }
  return graph.portalCount();
}

// The nearest place around `polygon`, over portals within the snapping distance. The ways round are
// few: a fixed list will do, and where it is full the nearest place of those seen is taken.
std::optional<Location> nearestAround(const NavGraph& graph, PolygonId polygon, glm::vec3 position,
                                      const SnapLimits& limits) {
  constexpr std::uint32_t kMost = 64;
  std::array<PolygonId, kMost> seen;
  std::uint32_t count = 0;
  seen[count++] = polygon;
  const glm::vec2 plan = toPlan(position);
  NearestPlace nearest(graph, position, limits);
  for (std::uint32_t i = 0; i < count && !nearest.exact(); ++i) {
    nearest.offer(seen[i]);
    const std::uint32_t end = graph.portalStart[index(seen[i]) + 1];
    for (std::uint32_t h = graph.portalStart[index(seen[i])]; h < end && count < kMost; ++h) {
      const Portal& portal = graph.portals[h];
      const glm::vec2 point = nearestOnSegment(portal.left, portal.right, plan);
      if (!(glm::distance(point, plan) <= limits.distance)) continue;
      const PolygonId to = graph.portalTo[h];
      const auto seenEnd = seen.begin() + count;
      if (std::find(seen.begin(), seenEnd, to) == seenEnd) seen[count++] = to;
    }
  }
  return nearest.result();
}

}  // namespace

LocationIndex makeLocationIndex(const NavGraph& graph) {
  LocationIndex made;
  const std::uint32_t polygons = graph.polygonCount();
  if (polygons == 0) {
    made.cellStart.push_back(0);
    return made;
  }
  std::vector<Bounds> bounds;
  bounds.reserve(polygons);
  for (std::uint32_t p = 0; p < polygons; ++p) {
    bounds.push_back(boundsOf(graph.ringOf(PolygonId{p})));
  }
  const Bounds all = boundsOf(graph.ring);
  made.origin = all.low;
  const glm::dvec2 size = glm::dvec2(all.high) - glm::dvec2(all.low);
  const double count = polygons;
  constexpr double kSmallest = 1e-3;  // metres
  double cell =
      std::max({std::sqrt(size.x * size.y / count), size.x / count, size.y / count, kSmallest});
  // Polygons much longer than a cell would fill the index: then cells grow.
  constexpr std::uint64_t kCellsPerPolygon = 16;
  for (std::uint64_t covered = 0;; cell *= 2.0) {
    setCells(made, size, cell);
    covered = 0;
    for (const Bounds& b : bounds) covered += cellsOf(made, b).count();
    if (covered <= kCellsPerPolygon * polygons || made.columns * made.rows == 1) break;
  }

  made.cellStart.assign(made.columns * made.rows + 1, 0);
  for (const Bounds& b : bounds) {
    forCells(made, cellsOf(made, b), [&](std::uint32_t c) { ++made.cellStart[c + 1]; });
  }
  for (std::size_t c = 1; c < made.cellStart.size(); ++c)
    made.cellStart[c] += made.cellStart[c - 1];
  made.polygons.resize(made.cellStart.back());
  std::vector<std::uint32_t> next(made.cellStart.begin(), made.cellStart.end() - 1);
  for (std::uint32_t p = 0; p < polygons; ++p) {
    forCells(made, cellsOf(made, bounds[p]),
             [&](std::uint32_t c) { made.polygons[next[c]++] = PolygonId{p}; });
  }
  return made;
}

std::optional<Location> locate(const NavGraph& graph, const LocationIndex& index,
                               glm::vec3 position, const SnapLimits& limits) {
  if (!isFinite(position) || index.columns == 0) return std::nullopt;
  NearestPlace nearest(graph, position, limits);
  const auto offerCells = [&](const CellRange& range) {
    forCells(index, range, [&](std::uint32_t cell) {
      for (std::uint32_t i = index.cellStart[cell]; i < index.cellStart[cell + 1]; ++i) {
        nearest.offer(index.polygons[i]);
      }
    });
  };
  // Whatever holds the query lies in its own cell.
  const glm::vec2 plan = toPlan(position);
  offerCells(cellsOf(index, {plan, plan}));
  if (!nearest.exact() && limits.distance > 0.0f) {
    offerCells(cellsOf(index, {plan - limits.distance, plan + limits.distance}));
  }
  return nearest.result();
}

namespace {

// The place of a user who has left the polygon of `last`. Apart from locateFrom, whose way in and
// out stays short without it.
[[gnu::noinline]] std::optional<Location> walkFrom(const NavGraph& graph,
                                                   const LocationIndex& index, const Location& last,
                                                   glm::vec3 position, const SnapLimits& limits) {
  if (!isFinite(position)) return std::nullopt;
  const glm::vec2 plan = toPlan(position);
  // A frame's walk crosses one portal or two; whoever crosses more has jumped.
  constexpr int kMostPortals = 32;
  PolygonId polygon = last.polygon;
  for (int crossed = 0; crossed < kMostPortals; ++crossed) {
    const std::uint32_t h = portalCrossed(graph, polygon, last.plan, plan);
    if (h == graph.portalCount()) {
      const auto place = nearestAround(graph, polygon, position, limits);
      return place ? place : locate(graph, index, position, limits);
    }
    polygon = graph.portalTo[h];
    if (contains(graph, polygon, plan)) {
      const float height = heightAt(graph, polygon, plan);
      if (inReach(height, position, limits)) return placeIn(polygon, plan, height);
      break;
    }
  }
  return locate(graph, index, position, limits);
}

}  // namespace

std::optional<Location> locateFrom(const NavGraph& graph, const LocationIndex& index,
                                   const Location& last, glm::vec3 position,
                                   const SnapLimits& limits) {
  if (navmesh::index(last.polygon) >= graph.polygonCount()) {
    return locate(graph, index, position, limits);
  }
  // 98 frames of 100 end here; a position that is not finite lies in no polygon.
  const glm::vec2 plan = toPlan(position);
  if (contains(graph, last.polygon, plan)) {
    const float height = heightAt(graph, last.polygon, plan);
    if (inReach(height, position, limits)) return placeIn(last.polygon, plan, height);
    return locate(graph, index, position, limits);
  }
  return walkFrom(graph, index, last, position, limits);
}

}  // namespace forewalk::navmesh
