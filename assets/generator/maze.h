// A seeded maze on a grid, and what is known about it without any navmesh.
#pragma once

#include <cstdint>
#include <vector>

#include "obj_writer.h"

namespace forewalk::assets {

struct Cell {
  int column, row;
  bool operator==(const Cell&) const = default;
};

/// Cells in rows. Starts as a perfect maze (one way between any two cells, depth-first), then
/// `extra` walls are taken away, each of which adds one loop.
class Maze {
 public:
  Maze(int columns, int rows, int extra, std::uint64_t seed);

  int columns() const { return columns_; }
  int rows() const { return rows_; }
  bool openEast(Cell c) const { return east_[place(c)]; }    ///< to the cell at column + 1
  bool openSouth(Cell c) const { return south_[place(c)]; }  ///< to the cell at row + 1

  /// Openings - cells + 1.
  int loops() const;

  /// Openings of a cell; 1 is a dead end.
  int degree(Cell c) const;

  /// Steps from `from` to each cell, breadth first.
  std::vector<int> steps(Cell from) const;
  int stepsTo(const std::vector<int>& steps, Cell c) const { return steps[place(c)]; }

  /// Bounds of the shortest walk between two cell middles for a walker who keeps `clearance` from
  /// the ends of the walls, metres; cells are `pitch` apart, walls `wall` thick. `upper` goes
  /// through the middles of openings. `lower` crosses each opening wherever it likes (sampled; what
  /// sampling can cost is taken off each leg) and ignores all else.
  struct Bounds {
    double lower, upper;
  };
  Bounds shortestWalk(Cell from, Cell to, double pitch, double wall, double clearance) const;

  /// Wall runs as boxes, the outer wall included. The middle of cell (0, 0) is at (pitch/2,
  /// pitch/2).
  std::vector<Rect> walls(int pitch, int wall) const;

 private:
  std::size_t place(Cell c) const { return static_cast<std::size_t>(c.row * columns_ + c.column); }
  bool inside(Cell c) const {
    return c.column >= 0 && c.row >= 0 && c.column < columns_ && c.row < rows_;
  }
  bool connected(Cell a, Cell b) const;
  int wallsAtPost(int column, int row) const;
  /// Shortest walk over `samples` points on each opening; each leg counts `slack` metres less.
  double walkThroughOpenings(Cell from, Cell to, double pitch, double halfWidth, int samples,
                             double slack) const;

  int columns_, rows_;
  std::vector<char> east_, south_;
};

}  // namespace forewalk::assets
