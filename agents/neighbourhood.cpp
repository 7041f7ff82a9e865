#include "agents/neighbourhood.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "agents/slices.h"

namespace forewalk::agents {
namespace {

constexpr float kStoreyReach = 2.0f;  // metres: who is farther above or below is on another floor

float squared(float x) { return x * x; }

/// A grid over [low, high] with cells of about `cell` metres, at most `cells` of them.
struct Cells {
  float cell;
  int columns, rows;

  Cells(glm::vec2 low, glm::vec2 high, float wanted, std::size_t limit) {
    const glm::dvec2 size = glm::dvec2(high) - glm::dvec2(low);
    double edge = std::max(static_cast<double>(wanted), 1e-3);
    const auto count = [&](double e) {
      return (std::floor(size.x / e) + 1.0) * (std::floor(size.y / e) + 1.0);
    };
    while (count(edge) > static_cast<double>(limit)) edge *= 1.5;
    cell = static_cast<float>(edge);
    columns = static_cast<int>(size.x / edge) + 1;
    rows = static_cast<int>(size.y / edge) + 1;
  }
};

// NaN and what lies outside fall into the border's cells: a place far off makes cells coarse, not
// wrong.
int cellAlong(float coordinate, float origin, float cell, int count) {
  const float at = (coordinate - origin) / cell;
  if (!(at > 0.0f)) return 0;
  return at < static_cast<float>(count) ? static_cast<int>(at) : count - 1;
}

}  // namespace

void WallIndex::assign(std::span<const Wall> walls) {
  walls_.assign(walls.begin(), walls.end());
  cellStart_.clear();
  cellWalls_.clear();
  columns_ = rows_ = 0;
  if (walls_.empty()) return;
  glm::vec2 low(std::numeric_limits<float>::infinity()), high = -low;
  double length = 0.0;
  const auto reach = [](const Wall& wall) {
    return wall.isCircle() ? glm::vec2(std::max(-wall.clearance, 0.0f)) : glm::vec2(0.0f);
  };
  for (const Wall& wall : walls_) {
    low = glm::min(low, glm::min(wall.from, wall.to) - reach(wall));
    high = glm::max(high, glm::max(wall.from, wall.to) + reach(wall));
    length += static_cast<double>(glm::distance(wall.from, wall.to) + reach(wall).x);
  }
  origin_ = low;
  const float average = static_cast<float>(length / static_cast<double>(walls_.size()));
  const Cells cells(low, high, std::max(average, 0.5f), 4 * walls_.size() + 16);
  cell_ = cells.cell;
  columns_ = cells.columns;
  rows_ = cells.rows;
  // A segment is listed in every cell that its bounds touch; long diagonal ones in more than they
  // cross, which only costs.
  const auto forCells = [&](const Wall& wall, const auto& visit) {
    const glm::vec2 a = glm::min(wall.from, wall.to) - reach(wall);
    const glm::vec2 b = glm::max(wall.from, wall.to) + reach(wall);
    const int left = cellAlong(a.x, origin_.x, cell_, columns_);
    const int right = cellAlong(b.x, origin_.x, cell_, columns_);
    const int top = cellAlong(b.y, origin_.y, cell_, rows_);
    for (int row = cellAlong(a.y, origin_.y, cell_, rows_); row <= top; ++row) {
      for (int column = left; column <= right; ++column) {
        visit(static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) +
              static_cast<std::size_t>(column));
      }
    }
  };
  cellStart_.assign(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_) + 1, 0);
  for (const Wall& wall : walls_) forCells(wall, [&](std::size_t c) { ++cellStart_[c + 1]; });
  for (std::size_t c = 1; c < cellStart_.size(); ++c) cellStart_[c] += cellStart_[c - 1];
  cellWalls_.resize(cellStart_.back());
  for (std::size_t w = walls_.size(); w-- > 0;) {
    forCells(walls_[w], [&](std::size_t c) {
      cellWalls_[--cellStart_[c + 1]] = static_cast<std::uint32_t>(w);
    });
  }
  // The fill moved every end to its begin: shift them back.
  cellStart_.erase(cellStart_.begin());
  cellStart_.push_back(static_cast<std::uint32_t>(cellWalls_.size()));
}

// By distance. Walls that meet in a corner are often equally far: then the one whose middle is
// nearer comes first, as it does in the mirror, and only then the one with the smaller index.
bool WallIndex::comesBefore(const NearWall& a, const NearWall& b, glm::vec2 position) const {
  if (a.squaredDistance != b.squaredDistance) return a.squaredDistance < b.squaredDistance;
  if (a.index == b.index) return false;
  const auto toMiddle = [&](const NearWall& near) {
    const glm::vec2 off = 0.5f * (walls_[near.index].from + walls_[near.index].to) - position;
    return glm::dot(off, off);
  };
  const float toA = toMiddle(a), toB = toMiddle(b);
  return toA != toB ? toA < toB : a.index < b.index;
}

void WallIndex::nearest(glm::vec2 position, float height, float radius, std::uint32_t count,
                        std::vector<NearWall>& found) const {
  found.clear();
  if (columns_ == 0 || count == 0) return;
  found.reserve(count);
  // Into a sorted row of the nearest so many. A wall in several cells comes several times, each
  // time to the same place.
  const auto offer = [&](const NearWall& wall) {
    std::size_t at = found.size();
    while (at > 0 && comesBefore(wall, found[at - 1], position)) --at;
    if (at > 0 && found[at - 1].index == wall.index) return;
    if (at == count) return;
    if (found.size() == count) found.pop_back();
    found.insert(found.begin() + static_cast<std::ptrdiff_t>(at), wall);
  };
  const int left = cellAlong(position.x - radius, origin_.x, cell_, columns_);
  const int right = cellAlong(position.x + radius, origin_.x, cell_, columns_);
  const int bottom = cellAlong(position.y - radius, origin_.y, cell_, rows_);
  const int top = cellAlong(position.y + radius, origin_.y, cell_, rows_);
  for (int row = bottom; row <= top; ++row) {
    for (int column = left; column <= right; ++column) {
      const std::size_t c = static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) +
                            static_cast<std::size_t>(column);
      for (std::uint32_t k = cellStart_[c]; k < cellStart_[c + 1]; ++k) {
        const std::uint32_t w = cellWalls_[k];
        const Wall& wall = walls_[w];
        float squaredDistance;
        if (wall.isCircle()) {
          const float rim = glm::distance(wall.from, position) + wall.clearance;
          squaredDistance = rim > 0.0f ? squared(rim) : 0.0f;
        } else {
          if (navmesh::exactTurn(wall.from, wall.to, position) < 0.0) continue;
          const glm::vec2 nearest = nearestOn(wall, position);
          squaredDistance = glm::dot(nearest - position, nearest - position);
        }
        if (!(squaredDistance <= squared(radius))) continue;
        if (!(std::min(wall.fromHeight, wall.toHeight) - wall.reach <= height &&
              std::max(wall.fromHeight, wall.toHeight) + wall.reach >= height)) {
          continue;
        }
        offer({w, squaredDistance});
      }
    }
  }
}

int NeighbourIndex::columnOf(float x) const { return cellAlong(x, origin_.x, cell_, columns_); }
int NeighbourIndex::rowOf(float y) const { return cellAlong(y, origin_.y, cell_, rows_); }

void NeighbourIndex::build(const AgentsView& agents, float reach) {
  const std::uint32_t n = agents.size();
  columns_ = rows_ = 0;
  if (n == 0) return;
  glm::vec2 low(std::numeric_limits<float>::infinity()), high = -low;
  float widest = 0.0f;
  for (std::uint32_t i = 0; i < n; ++i) {
    low = glm::min(low, agents.position[i]);
    high = glm::max(high, agents.position[i]);
    widest = std::max(widest, agents.radius[i]);
  }
  widest_ = widest;
  origin_ = low;
  // About four agents a cell, and never finer than a body or coarser than what is asked for.
  const glm::dvec2 size = glm::dvec2(high) - glm::dvec2(low);
  const double wanted = std::sqrt(4.0 * size.x * size.y / static_cast<double>(n));
  const double fine = 2.0 * static_cast<double>(widest);
  const Cells cells(
      low, high,
      static_cast<float>(std::clamp(wanted, fine, std::max(fine, static_cast<double>(reach)))),
      8 * static_cast<std::size_t>(n));
  cell_ = cells.cell;
  columns_ = cells.columns;
  rows_ = cells.rows;

  cellStart_.assign(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_) + 2, 0);
  cellOf_.resize(n);
  sorted_.resize(n);
  for (std::uint32_t i = 0; i < n; ++i) {
    const std::uint32_t cell = static_cast<std::uint32_t>(rowOf(agents.position[i].y)) *
                                   static_cast<std::uint32_t>(columns_) +
                               static_cast<std::uint32_t>(columnOf(agents.position[i].x));
    cellOf_[i] = cell;
    ++cellStart_[cell + 2];
  }
  for (std::size_t c = 2; c < cellStart_.size(); ++c) cellStart_[c] += cellStart_[c - 1];
  for (std::uint32_t i = 0; i < n; ++i) {
    sorted_[cellStart_[cellOf_[i] + 1]++] = {agents.position[i], agents.height[i], agents.radius[i],
                                             number(agents.id[i]), i};
  }
}

// The nearest so many, by insertion into a sorted row: rows are short, and most of what comes later
// is farther than all of them. Rings of cells around the own one, until none can hold anybody
// nearer.
std::uint32_t NeighbourIndex::nearest(const Entry& self, float radius, std::uint32_t count,
                                      Neighbour* found) const {
  if (count == 0) return 0;
  std::uint32_t size = 0;
  // Until the row is full, whoever is within `radius` of the body with theirs.
  const float reach = radius + self.radius;
  float limit = squared(reach + widest_);
  std::uint32_t limitId = 0xffffffffu;  // of the last in the row, once it is full
  const auto offer = [&](const Entry& other) {
    const glm::vec2 apart = other.position - self.position;
    const float squaredDistance = apart.x * apart.x + apart.y * apart.y;
    if (!(squaredDistance <= limit)) return;
    if (other.index == self.index || squaredDistance > squared(reach + other.radius)) return;
    if (!(std::abs(other.height - self.height) <= kStoreyReach)) return;
    if (size == count && squaredDistance == limit && other.id > limitId) return;
    std::uint32_t at = size < count ? size : count - 1;
    while (at > 0) {
      const Neighbour& before = found[at - 1];
      if (before.squaredDistance < squaredDistance) break;
      // Ids of those in the row are looked up only where distances tie: `index` stands for the
      // entry here.
      if (before.squaredDistance == squaredDistance && sorted_[before.index].id < other.id) break;
      found[at] = before;
      --at;
    }
    found[at] = {static_cast<std::uint32_t>(&other - sorted_.data()), squaredDistance};
    if (size < count) ++size;
    if (size == count) {
      limit = found[count - 1].squaredDistance;
      limitId = sorted_[found[count - 1].index].id;
    }
  };
  const auto scan = [&](int row, int lowColumn, int highColumn) {
    if (row < 0 || row >= rows_) return;
    lowColumn = std::max(lowColumn, 0);
    highColumn = std::min(highColumn, columns_ - 1);
    if (lowColumn > highColumn) return;
    const std::size_t line = static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_);
    const Entry* entry = sorted_.data() + cellStart_[line + static_cast<std::size_t>(lowColumn)];
    const Entry* end = sorted_.data() + cellStart_[line + static_cast<std::size_t>(highColumn) + 1];
    for (; entry != end; ++entry) offer(*entry);
  };
  const int column = columnOf(self.position.x), row = rowOf(self.position.y);
  // From the position to the nearest side of its own cell; rounding may put it a hair outside.
  const glm::vec2 corner =
      origin_ + cell_ * glm::vec2(static_cast<float>(column), static_cast<float>(row));
  const glm::vec2 inside = self.position - corner;
  const float side =
      std::max(0.0f, std::min(std::min(inside.x, inside.y), cell_ - std::max(inside.x, inside.y)));
  // The own row first: whoever is near makes the rest quick to turn away.
  scan(row, column - 1, column + 1);
  scan(row - 1, column - 1, column + 1);
  scan(row + 1, column - 1, column + 1);
  for (int ring = 2;; ++ring) {
    // All within this distance has been seen. A thousandth less, for what rounding does to cells.
    const float seen = (side + cell_ * static_cast<float>(ring - 1)) * 0.999f;
    if (squared(seen) > limit) break;
    if (row - ring < 0 && row + ring >= rows_ && column - ring < 0 && column + ring >= columns_)
      break;
    scan(row - ring, column - ring, column + ring);
    for (int r = row - ring + 1; r < row + ring; ++r) {
      scan(r, column - ring, column - ring);
      scan(r, column + ring, column + ring);
    }
    scan(row + ring, column - ring, column + ring);
  }
  for (std::uint32_t k = 0; k < size; ++k) found[k].index = sorted_[found[k].index].index;
  return size;
}

const Neighbourhoods& NeighbourIndex::gather(const AgentsView& agents, const WallIndex& walls,
                                             std::span<const Needs* const> needsOf,
                                             const navmesh::ForEach& forEach) {
  const std::uint32_t n = agents.size();
  rowOf_.resize(n);
  std::uint32_t neighbours = 0, nearWalls = 0;
  const std::uint32_t wallTotal = static_cast<std::uint32_t>(walls.walls().size());
  for (std::uint32_t i = 0; i < n; ++i) {
    rowOf_[i] = {neighbours, 0, nearWalls, 0};
    if (!needsOf[i]) continue;
    neighbours += std::min(needsOf[i]->neighbourCount, n - 1);
    nearWalls += std::min(needsOf[i]->wallCount, wallTotal);
  }
  neighbours_.resize(std::max<std::size_t>(neighbours_.size(), neighbours));
  nearWalls_.resize(std::max<std::size_t>(nearWalls_.size(), nearWalls));
  wallScratch_.resize(kSlices);
  // In the order of cells, so that what a slice reads stays in its caches.
  forSlices(n, forEach, [&](std::size_t slice, std::uint32_t begin, std::uint32_t end) {
    for (std::uint32_t k = begin; k < end; ++k) {
      const Entry& self = sorted_[k];
      const Needs* needs = needsOf[self.index];
      if (!needs) continue;
      Neighbourhoods::Row& row = rowOf_[self.index];
      row.neighbourCount =
          nearest(self, needs->neighbourRadius, std::min(needs->neighbourCount, n - 1),
                  neighbours_.data() + row.neighbours);
      std::vector<NearWall>& found = wallScratch_[slice];
      walls.nearest(self.position, self.height, needs->wallRadius + agents.radius[self.index],
                    needs->wallCount, found);
      std::copy(found.begin(), found.end(), nearWalls_.begin() + row.walls);
      row.wallCount = static_cast<std::uint32_t>(found.size());
    }
  });
  result_ = {walls.walls(), neighbours_, nearWalls_, rowOf_};
  return result_;
}

}  // namespace forewalk::agents
