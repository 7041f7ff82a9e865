#include "navmesh/build/carve.h"

#include <algorithm>
#include <cmath>

namespace forewalk::navmesh {
namespace {

constexpr double kCell = 256.0;            // grid units
constexpr double kHeightTolerance = 1e-3;  // metres; heights closer than that are one height

glm::dvec2 gridPlace(glm::dvec2 plan, glm::dvec2 origin, double cell) {
  return glm::round((glm::dvec2(plan.x, -plan.y) - origin) * (kCell / cell));
}

/// The most that a cell reaches to the left of an edge: n.p is linear, so one corner decides.
double mostLeftOf(glm::dvec2 from, glm::dvec2 to, glm::dvec2 cellLow) {
  const glm::dvec2 normal(from.y - to.y, to.x - from.x);
  const glm::dvec2 corner(cellLow.x + (normal.x > 0.0 ? kCell : 0.0),
                          cellLow.y + (normal.y > 0.0 ? kCell : 0.0));
  return glm::dot(normal, corner - from);
}

}  // namespace

GridObstacle onGrid(const Obstacle& obstacle, glm::dvec2 origin, double cell) {
  const ObstacleOutline outline = outlineOf(obstacle);
  GridObstacle result;
  result.bottom = outline.bottom;
  result.top = outline.top;
  if (outline.corners.empty()) {
    result.centre = gridPlace(outline.centre, origin, cell);
    result.radius = std::ceil(outline.radius * (kCell / cell));
    result.low = result.centre - result.radius;
    result.high = result.centre + result.radius;
    return result;
  }
  // z runs against plan y, so the turn is the other way round.
  for (auto corner = outline.corners.rbegin(); corner != outline.corners.rend(); ++corner) {
    result.corners.push_back(gridPlace(*corner, origin, cell));
  }
  result.low = result.high = result.corners.front();
  for (const glm::dvec2 corner : result.corners) {
    result.low = glm::min(result.low, corner);
    result.high = glm::max(result.high, corner);
  }
  return result;
}

bool coversCell(const GridObstacle& obstacle, std::int64_t column, std::int64_t row) {
  const glm::dvec2 low = kCell * glm::dvec2(static_cast<double>(column), static_cast<double>(row));
  const glm::dvec2 high = low + kCell;
  if (obstacle.corners.empty()) {
    const glm::dvec2 away = obstacle.centre - glm::clamp(obstacle.centre, low, high);
    return glm::dot(away, away) < obstacle.radius * obstacle.radius;
  }
  // Two convex shapes are apart if a side of either has them on its two sides.
  for (int axis = 0; axis < 2; ++axis) {
    const double least = obstacle.low[axis], most = obstacle.high[axis];
    const bool line = least == most;  // thinner than the grid's unit: in the cell it begins
    if (least >= high[axis] || most < low[axis] || (most == low[axis] && !line)) return false;
  }
  for (std::size_t i = 0; i < obstacle.corners.size(); ++i) {
    const glm::dvec2 from = obstacle.corners[i];
    const glm::dvec2 to = obstacle.corners[(i + 1) % obstacle.corners.size()];
    if (from != to && mostLeftOf(from, to, low) <= 0.0) return false;
  }
  return true;
}

void carve(const GridObstacle& obstacle, const CarvedField& where, rcCompactHeightfield& field) {
  const auto first = [](double units, std::int64_t shift, int count) {
    const double cell = std::floor(units / kCell) - static_cast<double>(shift);
    return static_cast<int>(std::clamp(cell, 0.0, static_cast<double>(count)));
  };
  const auto end = [](double units, std::int64_t shift, int count) {
    const double cell = std::floor(units / kCell) + 1.0 - static_cast<double>(shift);
    return static_cast<int>(std::clamp(cell, 0.0, static_cast<double>(count)));
  };
  const int x1 = end(obstacle.high.x, where.columnShift, field.width);
  const int z1 = end(obstacle.high.y, where.rowShift, field.height);
  for (int z = first(obstacle.low.y, where.rowShift, field.height); z < z1; ++z) {
    for (int x = first(obstacle.low.x, where.columnShift, field.width); x < x1; ++x) {
      if (!coversCell(obstacle, where.columnShift + x, where.rowShift + z)) continue;
      const rcCompactCell& column = field.cells[x + z * field.width];
      const unsigned begin = column.index;
      for (unsigned i = begin; i < begin + column.count; ++i) {
        if (field.areas[i] == RC_NULL_AREA) continue;
        const double ground = where.bottom + field.spans[i].y * where.cellHeight;
        if (ground + where.walkerHeight > obstacle.bottom + kHeightTolerance &&
            ground + where.climb < obstacle.top - kHeightTolerance) {
          field.areas[i] = obstacle.area;
        }
      }
    }
  }
}

}  // namespace forewalk::navmesh
