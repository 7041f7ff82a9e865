#include "agents/cell_navigation.h"

#include <algorithm>
#include <cmath>

namespace forewalk::agents {

std::uint32_t CellSearch::find(const GroundCells& ground, std::uint32_t from, std::uint32_t to,
                               float radius, std::vector<std::uint32_t>& cells) {
  cells.clear();
  radius = std::min(radius, ground.settings().reach);
  if (stamp_.size() != ground.size()) {
    stamp_.assign(ground.size(), 0);
    cost_.resize(ground.size());
    from_.resize(ground.size());
    run_ = 0;
  }
  if (++run_ == 0) {
    std::fill(stamp_.begin(), stamp_.end(), 0u);
    run_ = 1;
  }
  const std::int64_t columns = ground.columns();
  const auto estimate = [&](std::uint32_t cell) {
    const auto x = static_cast<std::uint32_t>(std::abs(cell % columns - to % columns));
    const auto y = static_cast<std::uint32_t>(std::abs(cell / columns - to / columns));
    return kStraightCost * std::max(x, y) + (kDiagonalCost - kStraightCost) * std::min(x, y);
  };
  const auto later = [](const Open& a, const Open& b) {
    return a.estimate > b.estimate || (a.estimate == b.estimate && a.cell > b.cell);
  };
  heap_.clear();
  const auto reach = [&](std::uint32_t cell, std::uint32_t cost, std::uint32_t by) {
    if (stamp_[cell] == run_ && cost_[cell] <= cost) return;
    stamp_[cell] = run_;
    cost_[cell] = cost;
    from_[cell] = by;
    heap_.push_back({cost + estimate(cell), cell});
    std::push_heap(heap_.begin(), heap_.end(), later);
  };
  reach(from, 0, from);
  while (!heap_.empty()) {
    std::pop_heap(heap_.begin(), heap_.end(), later);
    const Open open = heap_.back();
    heap_.pop_back();
    if (open.estimate != cost_[open.cell] + estimate(open.cell))
      continue;  // reached for less since
    if (open.cell == to) break;
    for (std::uint32_t direction = 0; direction < GroundCells::kDirections; ++direction) {
      if (!(ground.wayRoom(open.cell, direction) >= radius)) continue;
      const std::uint32_t step = direction % 2 == 0 ? kStraightCost : kDiagonalCost;
      reach(ground.neighbour(open.cell, direction), cost_[open.cell] + step, open.cell);
    }
  }
  if (stamp_[to] != run_) return kNoWay;
  for (std::uint32_t cell = to; cell != from; cell = from_[cell]) cells.push_back(cell);
  cells.push_back(from);
  std::reverse(cells.begin(), cells.end());
  return cost_[to];
}

void CellNavigation::removeBySwap(std::uint32_t agent) {
  std::swap(ways_[agent], ways_.back());
  ways_.pop_back();
}

// The cell whose place is nearest to `point` among those with room for `radius`, within so many
// metres and, where asked for, in sight. Ties go to the smaller cell.
std::uint32_t CellNavigation::nearestPlace(glm::vec2 point, float radius, float within,
                                           bool inSight) const {
  const CellSettings& settings = ground_.settings();
  const glm::vec2 low = glm::clamp(point - within, settings.low, settings.high);
  const glm::vec2 high = glm::clamp(point + within, settings.low, settings.high);
  const auto cellOf = [&](float at, float origin, std::uint32_t count) {
    return std::min(static_cast<std::uint32_t>((at - origin) / settings.cell), count - 1);
  };
  const std::uint32_t lastColumn = cellOf(high.x, settings.low.x, ground_.columns());
  const std::uint32_t lastRow = cellOf(high.y, settings.low.y, ground_.rows());
  std::uint32_t best = GroundCells::kOutside;
  float nearest = within * within;
  for (std::uint32_t row = cellOf(low.y, settings.low.y, ground_.rows()); row <= lastRow; ++row) {
    for (std::uint32_t column = cellOf(low.x, settings.low.x, ground_.columns());
         column <= lastColumn; ++column) {
      const std::uint32_t cell = row * ground_.columns() + column;
      if (!(ground_.roomOf(cell) >= radius)) continue;
      const glm::vec2 off = ground_.placeOf(cell) - point;
      const float squared = glm::dot(off, off);
      if (!(squared < nearest)) continue;
      if (inSight && !(ground_.lineRoom(point, ground_.placeOf(cell)) > 0.0f)) continue;
      best = cell;
      nearest = squared;
    }
  }
  return best;
}

bool CellNavigation::find(std::uint32_t agent, glm::vec2 position, glm::vec2 goal, float radius,
                          float snap, std::vector<glm::vec2>& path) {
  Way& way = ways_[agent];
  way.cells.clear();
  way.radius = radius = std::min(radius, ground_.settings().reach);
  path.clear();
  // Pressed against a wall, the nearest place in sight; inside of one, any.
  const float near = 2.0f * ground_.settings().cell;
  std::uint32_t from = nearestPlace(position, radius, near, true);
  if (from == GroundCells::kOutside)
    from = nearestPlace(position, radius, std::max(near, snap), false);
  const bool roomAtGoal = ground_.roomAt(goal) >= radius;
  std::uint32_t to = GroundCells::kOutside;
  if (roomAtGoal) to = nearestPlace(goal, radius, near, true);
  const bool ends =
      to != GroundCells::kOutside && ground_.lineRoom(ground_.placeOf(to), goal) >= radius;
  if (!ends) to = nearestPlace(goal, radius, std::max(near, snap), false);
  if (from == GroundCells::kOutside || to == GroundCells::kOutside) return false;
  if (search_.find(ground_, from, to, radius, cells_) == CellSearch::kNoWay) return false;

  // Straight on for as long as there is room; from a tight spot, as much room as that has.
  glm::vec2 anchor = position;
  path.push_back(anchor);
  const std::size_t points = cells_.size() + (ends ? 1 : 0);
  const auto point = [&](std::size_t k) {
    return k < cells_.size() ? ground_.placeOf(cells_[k]) : goal;
  };
  for (std::size_t k = 0; k + 1 < points; ++k) {
    const float room = std::min(radius, ground_.roomAt(anchor));
    if (room > 0.0f && ground_.lineRoom(anchor, point(k + 1)) >= room) continue;
    anchor = point(k);
    if (anchor != path.back()) path.push_back(anchor);
  }
  if (point(points - 1) != path.back()) path.push_back(point(points - 1));
  for (std::size_t k = 0; k + 1 < path.size(); ++k) {
    ground_.appendCrossed(path[k], path[k + 1], way.cells);
  }
  return true;
}

bool CellNavigation::sees(std::uint32_t agent, glm::vec2 from, glm::vec2 to) const {
  const float room = std::min(ways_[agent].radius, ground_.roomAt(from));
  return room > 0.0f && ground_.lineRoom(from, to) >= room;
}

}  // namespace forewalk::agents
