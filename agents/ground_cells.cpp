#include "agents/ground_cells.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "navmesh/locate.h"
#include "navmesh/plan.h"

namespace forewalk::agents {
namespace {

constexpr double kMostSamples = 4e6;
constexpr std::uint8_t kNoGround = 1, kInWall = 2;
constexpr double kHalfDiagonal = 0.70711;  // of a sample's square, rounded up

constexpr int kStep[8][2] = {{1, 0}, {1, 1}, {0, 1}, {-1, 1}, {-1, 0}, {-1, -1}, {0, -1}, {1, -1}};

double distanceTo(glm::dvec2 point, glm::dvec2 from, glm::dvec2 to) {
  const glm::dvec2 edge = to - from;
  const double squaredLength = glm::dot(edge, edge);
  const double share = squaredLength > 0.0
                           ? std::clamp(glm::dot(point - from, edge) / squaredLength, 0.0, 1.0)
                           : 0.0;
  return glm::distance(point, from + share * edge);
}

bool isWithin(const navmesh::ObstacleOutline& outline, glm::dvec2 point, double margin) {
  if (outline.corners.empty()) {
    return glm::distance(point, outline.centre) <= outline.radius + margin;
  }
  bool inside = true;
  for (std::size_t k = 0; k < outline.corners.size(); ++k) {
    const glm::dvec2 a = outline.corners[k];
    const glm::dvec2 b = outline.corners[(k + 1) % outline.corners.size()];
    if (distanceTo(point, a, b) <= margin) return true;
    inside = inside && (b.x - a.x) * (point.y - a.y) - (b.y - a.y) * (point.x - a.x) >= 0.0;
  }
  return inside;
}

Error outOfRange(const char* name, double value, const char* range) {
  return {ErrorCode::kSettingOutOfRange,
          fmt::format("cells.{} is {}: it has to be {}.", name, value, range)};
}

}  // namespace

tl::expected<GroundCells, Error> GroundCells::make(const CellSettings& s) {
  const glm::vec2 size = s.high - s.low;
  if (!std::isfinite(s.low.x + s.low.y) || !std::isfinite(size.x + size.y) ||
      !(size.x > 0.0f && size.y > 0.0f)) {
    return tl::unexpected(
        outOfRange("size", std::min(size.x, size.y), "finite and above 0 m both ways"));
  }
  if (!std::isfinite(s.cell) || !(s.cell > 0.0f)) {
    return tl::unexpected(outOfRange("cell", s.cell, "above 0 m"));
  }
  if (s.samples % 2 == 0 || s.samples > 15) {
    return tl::unexpected(outOfRange("samples", s.samples, "odd, from 1 to 15"));
  }
  if (!std::isfinite(s.height)) {
    return tl::unexpected(outOfRange("height", s.height, "finite"));
  }
  if (!(s.reach > 0.0f) || !(s.reach <= 32.0f * s.cell)) {
    return tl::unexpected(outOfRange("reach", s.reach, "above 0 m and at most 32 cells"));
  }
  const double across = std::ceil(size.x / s.cell) * s.samples;
  const double samples = across * std::ceil(size.y / s.cell) * s.samples;
  if (samples > kMostSamples) {
    return tl::unexpected(
        Error{ErrorCode::kTooLarge,
              fmt::format("cells of {} m with {} x {} samples make {:.1f} million samples, 4 are "
                          "the most. Make the cells larger or the rectangle smaller.",
                          s.cell, s.samples, s.samples, samples / 1e6)});
  }
  return GroundCells(s);
}

GroundCells::GroundCells(const CellSettings& settings) : settings_(settings) {
  const glm::vec2 size = settings.high - settings.low;
  columns_ = static_cast<std::uint32_t>(std::ceil(size.x / settings.cell));
  rows_ = static_cast<std::uint32_t>(std::ceil(size.y / settings.cell));
  spacing_ = settings.cell / static_cast<float>(settings.samples);
  const int most = static_cast<int>(std::ceil(settings.reach / spacing_));
  for (int row = -most; row <= most; ++row) {
    for (int column = -most; column <= most; ++column) {
      const float distance = spacing_ * std::sqrt(static_cast<float>(column * column + row * row));
      if (distance < settings.reach) offsets_.push_back({column, row, distance});
    }
  }
  std::stable_sort(offsets_.begin(), offsets_.end(),
                   [](const Offset& a, const Offset& b) { return a.distance < b.distance; });
  const std::size_t samples = std::size_t{sampleColumns()} * sampleRows();
  ground_.assign(samples, 0);
  covers_.assign(samples, 0);
  room_.assign(samples, -1.0f);
  blockedIn_.assign(this->size(), 0);
  place_.assign(this->size(), 0);
  way_.assign(this->size(), {});
  dirty_.assign(this->size(), 0);
  near_.assign(this->size(), 0);
  for (std::uint32_t cell = 0; cell < this->size(); ++cell) markDirty(cell);
  update();
}

glm::vec2 GroundCells::pointOf(std::uint32_t sample) const {
  const std::uint32_t column = sample % sampleColumns(), row = sample / sampleColumns();
  return settings_.low +
         spacing_ * (glm::vec2(static_cast<float>(column), static_cast<float>(row)) + 0.5f);
}

std::uint32_t GroundCells::cellOfSample(std::uint32_t sample) const {
  const std::uint32_t column = sample % sampleColumns() / settings_.samples;
  const std::uint32_t row = sample / sampleColumns() / settings_.samples;
  return row * columns_ + column;
}

CellKind GroundCells::kind(std::uint32_t cell) const {
  if (blockedIn_[cell] == 0) return CellKind::free;
  return blockedIn_[cell] == settings_.samples * settings_.samples ? CellKind::full
                                                                   : CellKind::mixed;
}

std::uint32_t GroundCells::cellAt(glm::vec2 point) const {
  const glm::dvec2 at = inSamples(point);
  if (!(at.x >= 0.0 && at.y >= 0.0 && at.x < sampleColumns() && at.y < sampleRows())) {
    return kOutside;
  }
  return cellOfSample(static_cast<std::uint32_t>(at.y) * sampleColumns() +
                      static_cast<std::uint32_t>(at.x));
}

glm::vec2 GroundCells::placeOf(std::uint32_t cell) const { return pointOf(place_[cell]); }

float GroundCells::roomAt(glm::vec2 point) const { return lineRoom(point, point); }

std::uint32_t GroundCells::neighbour(std::uint32_t cell, std::uint32_t direction) const {
  const std::uint32_t column = cell % columns_ + static_cast<std::uint32_t>(kStep[direction][0]);
  const std::uint32_t row = cell / columns_ + static_cast<std::uint32_t>(kStep[direction][1]);
  // One below 0 wraps to a number beyond any.
  return column < columns_ && row < rows_ ? row * columns_ + column : kOutside;
}

float GroundCells::wayRoom(std::uint32_t cell, std::uint32_t direction) const {
  if (direction < 4) return way_[cell][direction];
  const std::uint32_t other = neighbour(cell, direction);
  return other == kOutside ? 0.0f : way_[other][direction - 4];
}

void GroundCells::markDirty(std::uint32_t cell) {
  if (dirty_[cell]) return;
  dirty_[cell] = 1;
  dirtyCells_.push_back(cell);
}

template <typename Visit>
void GroundCells::forSamplesIn(glm::dvec2 low, glm::dvec2 high, const Visit& visit) const {
  const auto first = [&](double at, float origin) {
    return std::max(0.0, std::floor((at - origin) / spacing_ - 0.5));
  };
  const auto last = [&](double at, float origin, std::uint32_t count) {
    return std::min(static_cast<double>(count), std::ceil((at - origin) / spacing_ + 0.5));
  };
  const double endColumn = last(high.x, settings_.low.x, sampleColumns());
  const double endRow = last(high.y, settings_.low.y, sampleRows());
  for (double row = first(low.y, settings_.low.y); row < endRow; ++row) {
    for (double column = first(low.x, settings_.low.x); column < endColumn; ++column) {
      visit(static_cast<std::uint32_t>(row) * sampleColumns() + static_cast<std::uint32_t>(column));
    }
  }
}

void GroundCells::setGround(const navmesh::World* world, float walkerRadius,
                            std::span<const Wall> walls) {
  groundMargin_ = world ? walkerRadius : 0.0f;
  std::fill(ground_.begin(), ground_.end(), std::uint8_t{0});
  if (world) {
    const navmesh::SnapLimits exactly{1e-4f, 1.0f, 1.0f};
    for (std::uint32_t sample = 0; sample < ground_.size(); ++sample) {
      const glm::vec3 at = navmesh::toSpace(pointOf(sample), settings_.height);
      if (!navmesh::locate(world->graph, world->locations, at, exactly))
        ground_[sample] = kNoGround;
    }
  }
  const double margin = kHalfDiagonal * spacing_;
  for (const Wall& wall : walls) {
    const float low = std::min(wall.fromHeight, wall.toHeight) - wall.reach;
    const float high = std::max(wall.fromHeight, wall.toHeight) + wall.reach;
    if (!(settings_.height >= low && settings_.height <= high)) continue;
    const double kept = margin + (wall.isCircle() ? -static_cast<double>(wall.clearance) : 0.0);
    forSamplesIn(glm::dvec2(glm::min(wall.from, wall.to)) - kept,
                 glm::dvec2(glm::max(wall.from, wall.to)) + kept, [&](std::uint32_t sample) {
                   if (distanceTo(pointOf(sample), wall.from, wall.to) <= kept) {
                     ground_[sample] = kInWall;
                   }
                 });
  }
  for (std::uint32_t cell = 0; cell < size(); ++cell) markDirty(cell);
}

void GroundCells::cover(const navmesh::Obstacle& shape, int by) {
  const navmesh::ObstacleOutline outline = navmesh::outlineOf(shape);
  // As a crowd's walls have it: who stands from a foot below its bottom to its top goes around.
  if (settings_.height < outline.bottom - 0.3 || settings_.height > outline.top + 0.3) return;
  const double margin = kHalfDiagonal * spacing_;
  glm::dvec2 low = outline.centre - outline.radius, high = outline.centre + outline.radius;
  if (!outline.corners.empty()) {
    low = high = outline.corners[0];
    for (const glm::dvec2 corner : outline.corners) {
      low = glm::min(low, corner);
      high = glm::max(high, corner);
    }
  }
  forSamplesIn(low - margin, high + margin, [&](std::uint32_t sample) {
    if (!isWithin(outline, pointOf(sample), margin)) return;
    const bool was = blocked(sample);
    covers_[sample] = static_cast<std::uint16_t>(covers_[sample] + by);
    if (blocked(sample) != was) markDirty(cellOfSample(sample));
  });
}

void GroundCells::setObject(navmesh::ObstacleId id, const navmesh::Obstacle& shape) {
  const auto at = std::find_if(objects_.begin(), objects_.end(),
                               [&](const Object& object) { return object.id == id; });
  if (at != objects_.end()) {
    if (at->shape == shape) return;
    cover(at->shape, -1);
    at->shape = shape;
  } else {
    objects_.push_back({id, shape});
  }
  cover(shape, 1);
}

bool GroundCells::removeObject(navmesh::ObstacleId id) {
  const auto at = std::find_if(objects_.begin(), objects_.end(),
                               [&](const Object& object) { return object.id == id; });
  if (at == objects_.end()) return false;
  cover(at->shape, -1);
  objects_.erase(at);
  return true;
}

float GroundCells::findRoom(std::uint32_t sample) const {
  if (blocked(sample)) return 0.0f;
  const int column = static_cast<int>(sample % sampleColumns());
  const int row = static_cast<int>(sample / sampleColumns());
  const int columns = static_cast<int>(sampleColumns()), rows = static_cast<int>(sampleRows());
  float room = settings_.reach;
  for (const Offset& offset : offsets_) {
    if (offset.distance >= room) break;
    const int x = column + offset.column, y = row + offset.row;
    if (x < 0 || y < 0 || x >= columns || y >= rows) continue;  // the rectangle's edge is no wall
    const std::uint32_t other = static_cast<std::uint32_t>(y * columns + x);
    if (covers_[other] != 0 || ground_[other] == kInWall) return offset.distance;
    if (ground_[other] == kNoGround) room = std::min(room, offset.distance + groundMargin_);
  }
  return room;
}

void GroundCells::findPlace(std::uint32_t cell) {
  const std::uint32_t side = settings_.samples;
  const std::uint32_t first = cell / columns_ * side * sampleColumns() + cell % columns_ * side;
  const int middle = static_cast<int>(side / 2);
  std::uint32_t best = first;
  float bestRoom = -1.0f;
  int bestOff = 0;
  for (std::uint32_t row = 0; row < side; ++row) {
    for (std::uint32_t column = 0; column < side; ++column) {
      const std::uint32_t sample = first + row * sampleColumns() + column;
      const int x = static_cast<int>(column) - middle, y = static_cast<int>(row) - middle;
      const int off = x * x + y * y;
      if (room_[sample] > bestRoom || (room_[sample] == bestRoom && off < bestOff)) {
        best = sample;
        bestRoom = room_[sample];
        bestOff = off;
      }
    }
  }
  place_[cell] = best;
}

std::span<const std::uint32_t> GroundCells::update() {
  changed_.clear();
  if (dirtyCells_.empty()) return changed_;
  const std::uint32_t side = settings_.samples;
  const auto firstSample = [&](std::uint32_t cell) {
    return cell / columns_ * side * sampleColumns() + cell % columns_ * side;
  };
  // Calls visit(cell) once for every cell within `cells` of those in `of`.
  const auto forNear = [&](std::span<const std::uint32_t> of, int cells, const auto& visit) {
    nearCells_.clear();
    for (const std::uint32_t cell : of) {
      const int column = static_cast<int>(cell % columns_), row = static_cast<int>(cell / columns_);
      const int lastRow = std::min(row + cells, static_cast<int>(rows_) - 1);
      const int lastColumn = std::min(column + cells, static_cast<int>(columns_) - 1);
      for (int y = std::max(row - cells, 0); y <= lastRow; ++y) {
        for (int x = std::max(column - cells, 0); x <= lastColumn; ++x) {
          const std::uint32_t near =
              static_cast<std::uint32_t>(y) * columns_ + static_cast<std::uint32_t>(x);
          if (near_[near]) continue;
          near_[near] = 1;
          nearCells_.push_back(near);
        }
      }
    }
    for (const std::uint32_t cell : nearCells_) {
      near_[cell] = 0;
      visit(cell);
    }
  };

  for (const std::uint32_t cell : dirtyCells_) {
    dirty_[cell] = 0;
    std::uint16_t count = 0;
    for (std::uint32_t k = 0; k < side * side; ++k) {
      count += blocked(firstSample(cell) + k / side * sampleColumns() + k % side);
    }
    blockedIn_[cell] = count;
  }
  const int reach = static_cast<int>(std::ceil(settings_.reach / settings_.cell));
  forNear(dirtyCells_, reach, [&](std::uint32_t cell) {
    bool changed = false;
    for (std::uint32_t k = 0; k < side * side; ++k) {
      const std::uint32_t sample = firstSample(cell) + k / side * sampleColumns() + k % side;
      const float room = findRoom(sample);
      changed = changed || room != room_[sample];
      room_[sample] = room;
    }
    if (!changed) return;
    findPlace(cell);
    changed_.push_back(cell);
  });
  dirtyCells_.clear();
  std::sort(changed_.begin(), changed_.end());
  // A way is its two cells' affair, and a diagonal one also that of those beside it.
  forNear(changed_, 1, [&](std::uint32_t cell) {
    for (std::uint32_t direction = 0; direction < 4; ++direction) {
      const std::uint32_t other = neighbour(cell, direction);
      float room = 0.0f;
      if (other != kOutside) {
        room = lineRoom(placeOf(cell), placeOf(other));
        if (direction % 2 == 1) {
          const std::uint32_t before = neighbour(cell, direction - 1);
          const std::uint32_t after = neighbour(cell, direction + 1);
          room = std::min({room, roomOf(before), roomOf(after)});
        }
      }
      way_[cell][direction] = room;
    }
  });
  return changed_;
}

// The samples whose squares the line from `from` to `to` touches, in order, until visit(sample)
// says false. Through a corner it touches all four. False where it leaves the grid or was stopped.
template <typename Visit>
bool GroundCells::walkLine(glm::vec2 from, glm::vec2 to, const Visit& visit) const {
  const std::uint32_t columns = sampleColumns(), rows = sampleRows();
  const glm::dvec2 a = inSamples(from), b = inSamples(to);
  const auto inside = [&](glm::dvec2 p) {
    return p.x >= 0.0 && p.y >= 0.0 && p.x < columns && p.y < rows;
  };
  if (!inside(a) || !inside(b)) return false;
  std::int64_t x = static_cast<std::int64_t>(a.x), y = static_cast<std::int64_t>(a.y);
  const std::int64_t endX = static_cast<std::int64_t>(b.x), endY = static_cast<std::int64_t>(b.y);
  const auto at = [&](std::int64_t column, std::int64_t row) {
    return visit(static_cast<std::uint32_t>(row) * columns + static_cast<std::uint32_t>(column));
  };
  if (!at(x, y)) return false;
  const std::int64_t stepX = endX > x ? 1 : -1, stepY = endY > y ? 1 : -1;
  const glm::dvec2 way = b - a;
  // The share of the line at which it enters the next column, and the next row.
  const auto enters = [](double start, double length, std::int64_t line) {
    return (static_cast<double>(line) - start) / length;
  };
  while (x != endX || y != endY) {
    const double atX =
        x == endX ? std::numeric_limits<double>::infinity() : enters(a.x, way.x, x + (stepX > 0));
    const double atY =
        y == endY ? std::numeric_limits<double>::infinity() : enters(a.y, way.y, y + (stepY > 0));
    if (x != endX && y != endY && std::abs(atX - atY) < 1e-9) {
      if (!at(x + stepX, y) || !at(x, y + stepY)) return false;
      x += stepX;
      y += stepY;
    } else if (atX < atY) {
      x += stepX;
    } else {
      y += stepY;
    }
    if (!at(x, y)) return false;
  }
  return true;
}

float GroundCells::lineRoom(glm::vec2 from, glm::vec2 to) const {
  float least = settings_.reach;
  const bool whole = walkLine(from, to, [&](std::uint32_t sample) {
    least = std::min(least, room_[sample]);
    return least > 0.0f;
  });
  return whole ? least : 0.0f;
}

void GroundCells::appendCrossed(glm::vec2 from, glm::vec2 to,
                                std::vector<std::uint32_t>& cells) const {
  // By its samples, so that it agrees with lineRoom to the last bit.
  walkLine(from, to, [&](std::uint32_t sample) {
    const std::uint32_t cell = cellOfSample(sample);
    if (cells.empty() || cells.back() != cell) cells.push_back(cell);
    return true;
  });
}

}  // namespace forewalk::agents
