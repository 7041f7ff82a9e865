#include "navmesh/build/carve.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <set>
#include <utility>
#include <vector>

#include "navmesh/random.h"
#include "tests/support/random_obstacle.h"

namespace forewalk::navmesh {
namespace {

constexpr double kCell = 0.1;
constexpr testing::Region kRegion{{-1.5f, 0.0f, -1.5f}, {1.5f, 0.0f, 1.5f}};

using Ring = std::vector<glm::dvec2>;

/// The part of a ring left of the line from `a` to `b` (Sutherland and Hodgman).
Ring clipped(const Ring& ring, glm::dvec2 a, glm::dvec2 b) {
  const auto side = [&](glm::dvec2 p) {
    return (b.x - a.x) * (p.y - a.y) - (b.y - a.y) * (p.x - a.x);
  };
  Ring result;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const glm::dvec2 from = ring[i], to = ring[(i + 1) % ring.size()];
    const double s = side(from), t = side(to);
    if (s >= 0.0) result.push_back(from);
    if ((s > 0.0 && t < 0.0) || (s < 0.0 && t > 0.0)) {
      result.push_back(from + s / (s - t) * (to - from));
    }
  }
  return result;
}

double areaOf(const Ring& ring) {
  double twice = 0.0;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const glm::dvec2 a = ring[i], b = ring[(i + 1) % ring.size()];
    twice += a.x * b.y - a.y * b.x;
  }
  return 0.5 * twice;
}

/// The area that an obstacle covers of a cell by cutting it at the cell's sides; grid units.
double coveredArea(const GridObstacle& obstacle, double column, double row) {
  const glm::dvec2 low(256.0 * column, 256.0 * row);
  const Ring cell{low, low + glm::dvec2(256, 0), low + glm::dvec2(256, 256),
                  low + glm::dvec2(0, 256)};
  Ring ring = obstacle.corners;
  for (std::size_t i = 0; i < 4 && !ring.empty(); ++i) {
    ring = clipped(ring, cell[i], cell[(i + 1) % 4]);
  }
  return ring.empty() ? 0.0 : areaOf(ring);
}

TEST(Carve, CoversACellWhereItsOutlineHasAreaInIt) {
  std::mt19937_64 rng(2);
  int covered = 0;
  for (int trial = 0; trial < 300; ++trial) {
    const GridObstacle obstacle =
        onGrid(testing::randomObstacle(rng, kRegion, 1.2), {-3.0, -3.0}, kCell);
    if (obstacle.corners.empty()) continue;
    for (int row = 5; row < 55; ++row) {
      for (int column = 5; column < 55; ++column) {
        const double area = coveredArea(obstacle, column, row);
        const bool covers = coversCell(obstacle, column, row);
        covered += covers ? 1 : 0;
        // Less than a square unit (0.4 mm a side) may be rounding of the reference.
        if (area > 1.0) {
          ASSERT_TRUE(covers) << trial << " " << column << " " << row << " " << area;
        }
      }
    }
  }
  EXPECT_GT(covered, 1000);
}

TEST(Carve, CoversNoCellThatItsOutlineDoesNotReach) {
  std::mt19937_64 rng(3);
  for (int trial = 0; trial < 300; ++trial) {
    const GridObstacle obstacle =
        onGrid(testing::randomObstacle(rng, kRegion, 1.2), {-3.0, -3.0}, kCell);
    for (int row = 5; row < 55; ++row) {
      for (int column = 5; column < 55; ++column) {
        if (!coversCell(obstacle, column, row)) continue;
        const glm::dvec2 low(256.0 * column, 256.0 * row);
        if (obstacle.corners.empty()) {
          const glm::dvec2 nearest = glm::clamp(obstacle.centre, low, low + 256.0);
          ASSERT_LT(glm::distance(nearest, obstacle.centre), obstacle.radius);
        } else {
          ASSERT_GT(coveredArea(obstacle, column, row), 0.0) << trial;
        }
      }
    }
  }
}

TEST(Carve, MovesWithItsObstacleByWholeCells) {
  std::mt19937_64 rng(4);
  for (int trial = 0; trial < 100; ++trial) {
    const Obstacle obstacle = testing::randomObstacle(rng, kRegion, 1.2);
    const GridObstacle here = onGrid(obstacle, {-3.0, -3.0}, kCell);
    GridObstacle there = here;
    const glm::dvec2 shift = 256.0 * glm::dvec2(1 << 20, 70000);
    for (glm::dvec2& corner : there.corners) corner += shift;
    there.centre += shift;
    there.low += shift;
    there.high += shift;
    for (int row = 5; row < 55; ++row) {
      for (int column = 5; column < 55; ++column) {
        ASSERT_EQ(coversCell(here, column, row),
                  coversCell(there, column + (1 << 20), row + 70000));
      }
    }
  }
}

TEST(Carve, CoversTheOneCellThatHoldsAnObstacleThinnerThanTheGrid) {
  const PrismObstacle needle{{{0.05f, -0.05f}, {0.0501f, -0.05f}, {0.05f, -0.0499f}}, 0.0f, 1.0f};
  ASSERT_TRUE(validate(needle));
  const GridObstacle obstacle = onGrid(needle, {0.0, 0.0}, kCell);
  std::set<std::pair<int, int>> covered;
  for (int row = -3; row < 4; ++row) {
    for (int column = -3; column < 4; ++column) {
      if (coversCell(obstacle, column, row)) covered.insert({column, row});
    }
  }
  EXPECT_EQ(covered, (std::set<std::pair<int, int>>{{0, 0}}));
}

}  // namespace
}  // namespace forewalk::navmesh
