#include "maze.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <queue>
#include <random>
#include <utility>

namespace forewalk::assets {
namespace {

constexpr int kStep[4][2] = {{1, 0}, {0, 1}, {-1, 0}, {0, -1}};

/// A whole number below n. The bias of the remainder is far below what a maze could show, and
/// unlike the standard distributions it is the same number everywhere.
int below(std::mt19937_64& rng, int n) {
  return static_cast<int>(rng() % static_cast<std::uint64_t>(n));
}

}  // namespace

Maze::Maze(int columns, int rows, int extra, std::uint64_t seed)
    : columns_(columns),
      rows_(rows),
      east_(static_cast<std::size_t>(columns * rows), 0),
      south_(static_cast<std::size_t>(columns * rows), 0) {
  std::mt19937_64 rng(seed);
  std::vector<char> seen(east_.size(), 0);
  std::vector<Cell> trail{{0, 0}};
  seen[0] = 1;
  while (!trail.empty()) {
    const Cell here = trail.back();
    std::vector<Cell> fresh;
    for (const auto& step : kStep) {
      const Cell next{here.column + step[0], here.row + step[1]};
      if (inside(next) && !seen[place(next)]) fresh.push_back(next);
    }
    if (fresh.empty()) {
      trail.pop_back();
      continue;
    }
    const Cell next = fresh[static_cast<std::size_t>(below(rng, static_cast<int>(fresh.size())))];
    if (next.row == here.row) {
      east_[place({std::min(here.column, next.column), here.row})] = 1;
    } else {
      south_[place({here.column, std::min(here.row, next.row)})] = 1;
    }
    seen[place(next)] = 1;
    trail.push_back(next);
  }

  // A wall may go if both its posts keep another wall: else a post would vanish and two loops with
  // it.
  while (extra > 0) {
    const Cell c{below(rng, columns), below(rng, rows)};
    const bool eastward = below(rng, 2) == 0;
    if (eastward) {
      if (c.column + 1 == columns_ || east_[place(c)]) continue;
      if (wallsAtPost(c.column + 1, c.row) < 2 || wallsAtPost(c.column + 1, c.row + 1) < 2)
        continue;
      east_[place(c)] = 1;
    } else {
      if (c.row + 1 == rows_ || south_[place(c)]) continue;
      if (wallsAtPost(c.column, c.row + 1) < 2 || wallsAtPost(c.column + 1, c.row + 1) < 2)
        continue;
      south_[place(c)] = 1;
    }
    --extra;
  }
}

int Maze::wallsAtPost(int column, int row) const {
  if (column == 0 || row == 0 || column == columns_ || row == rows_)
    return 4;  // the outer wall stays
  int walls = 0;
  walls += !east_[place({column - 1, row - 1})];
  walls += !east_[place({column - 1, row})];
  walls += !south_[place({column - 1, row - 1})];
  walls += !south_[place({column, row - 1})];
  return walls;
}

bool Maze::connected(Cell a, Cell b) const {
  if (!inside(a) || !inside(b)) return false;
  if (a.row == b.row) return east_[place({std::min(a.column, b.column), a.row})] != 0;
  return south_[place({a.column, std::min(a.row, b.row)})] != 0;
}

int Maze::loops() const {
  const auto openings =
      std::count(east_.begin(), east_.end(), 1) + std::count(south_.begin(), south_.end(), 1);
  return static_cast<int>(openings) - columns_ * rows_ + 1;
}

int Maze::degree(Cell c) const {
  int openings = 0;
  for (const auto& step : kStep) openings += connected(c, {c.column + step[0], c.row + step[1]});
  return openings;
}

std::vector<int> Maze::steps(Cell from) const {
  std::vector<int> distance(east_.size(), -1);
  std::queue<Cell> open;
  open.push(from);
  distance[place(from)] = 0;
  while (!open.empty()) {
    const Cell here = open.front();
    open.pop();
    for (const auto& step : kStep) {
      const Cell next{here.column + step[0], here.row + step[1]};
      if (!connected(here, next) || distance[place(next)] >= 0) continue;
      distance[place(next)] = distance[place(here)] + 1;
      open.push(next);
    }
  }
  return distance;
}

double Maze::walkThroughOpenings(Cell from, Cell to, double pitch, double halfWidth, int samples,
                                 double slack) const {
  // Nodes: `samples` points on each opening, east openings first; then start and goal.
  const int cells = columns_ * rows_;
  const int openings = 2 * cells;
  const int start = openings * samples, goal = start + 1;
  const auto at = [&](int node) -> std::pair<double, double> {
    if (node >= start) {
      const Cell c = node == start ? from : to;
      return {(c.column + 0.5) * pitch, (c.row + 0.5) * pitch};
    }
    const int opening = node / samples;
    const int cell = opening % cells;
    const double along =
        samples == 1 ? 0.0 : halfWidth * (2.0 * (node % samples) / (samples - 1) - 1.0);
    const double x = (cell % columns_ + 0.5) * pitch, z = (cell / columns_ + 0.5) * pitch;
    return opening < cells ? std::pair{x + 0.5 * pitch, z + along}
                           : std::pair{x + along, z + 0.5 * pitch};
  };
  const auto openingsOf = [&](Cell c, std::vector<int>& list) {
    list.clear();
    const int here = static_cast<int>(place(c));
    if (connected(c, {c.column + 1, c.row})) list.push_back(here);
    if (connected(c, {c.column - 1, c.row})) list.push_back(here - 1);
    if (connected(c, {c.column, c.row + 1})) list.push_back(cells + here);
    if (connected(c, {c.column, c.row - 1})) list.push_back(cells + here - columns_);
  };
  const auto cellsOf = [&](int node) -> std::vector<Cell> {
    if (node == start) return {from};
    if (node == goal) return {to};
    const int opening = node / samples;
    const int cell = opening % cells;
    const Cell c{cell % columns_, cell / columns_};
    return {c, opening < cells ? Cell{c.column + 1, c.row} : Cell{c.column, c.row + 1}};
  };

  std::vector<double> distance(static_cast<std::size_t>(goal) + 1,
                               std::numeric_limits<double>::infinity());
  using Entry = std::pair<double, int>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> open;
  distance[static_cast<std::size_t>(start)] = 0.0;
  open.push({0.0, start});
  std::vector<int> list;
  while (!open.empty()) {
    const auto [length, node] = open.top();
    open.pop();
    if (node == goal) return length;
    if (length > distance[static_cast<std::size_t>(node)]) continue;
    const auto [x, z] = at(node);
    const auto reach = [&](int next) {
      const auto [nx, nz] = at(next);
      const double there = length + std::max(0.0, std::hypot(nx - x, nz - z) - slack);
      if (there < distance[static_cast<std::size_t>(next)]) {
        distance[static_cast<std::size_t>(next)] = there;
        open.push({there, next});
      }
    };
    for (const Cell c : cellsOf(node)) {
      if (c == to) reach(goal);
      openingsOf(c, list);
      for (const int opening : list) {
        if (node < start && opening == node / samples) continue;
        for (int i = 0; i < samples; ++i) reach(opening * samples + i);
      }
    }
  }
  return std::numeric_limits<double>::infinity();
}

Maze::Bounds Maze::shortestWalk(Cell from, Cell to, double pitch, double wall,
                                double clearance) const {
  constexpr int kSamples = 41;
  const double halfWidth = (pitch - wall) / 2.0 - clearance;
  const double spacing = 2.0 * halfWidth / (kSamples - 1);
  // Each end of a leg of the true walk lies within half a spacing of a sample.
  return {walkThroughOpenings(from, to, pitch, halfWidth, kSamples, spacing),
          walkThroughOpenings(from, to, pitch, 0.0, 1, 0.0)};
}

std::vector<Rect> Maze::walls(int pitch, int wall) const {
  const int half = wall / 2;
  const int width = columns_ * pitch, depth = rows_ * pitch;
  std::vector<Rect> boxes{{-half, -half, width + half, half},
                          {-half, depth - half, width + half, depth + half},
                          {-half, half, half, depth - half},
                          {width - half, half, width + half, depth - half}};
  for (int row = 0; row + 1 < rows_; ++row) {
    for (int c = 0; c < columns_; ++c) {
      if (south_[place({c, row})]) continue;
      const int begin = c;
      while (c + 1 < columns_ && !south_[place({c + 1, row})]) ++c;
      const int z = (row + 1) * pitch;
      boxes.push_back({begin * pitch - half, z - half, (c + 1) * pitch + half, z + half});
    }
  }
  for (int column = 0; column + 1 < columns_; ++column) {
    for (int r = 0; r < rows_; ++r) {
      if (east_[place({column, r})]) continue;
      const int begin = r;
      while (r + 1 < rows_ && !east_[place({column, r + 1})]) ++r;
      const int x = (column + 1) * pitch;
      boxes.push_back({x - half, begin * pitch - half, x + half, (r + 1) * pitch + half});
    }
  }
  return boxes;
}

}  // namespace forewalk::assets
