#include "agents/evaluation/dtw.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>

namespace forewalk::agents {
namespace {

// Cells lo..hi of one anti-diagonal (index: sample of `a`), from the two before it. `back` is b in
// reverse, shifted so that the partner of a[i] is back[i]. Nothing here waits for its neighbour, so
// compilers make vectors of it.
void fillDiagonal(std::size_t lo, std::size_t hi, const double* __restrict ax,
                  const double* __restrict ay, const double* __restrict backX,
                  const double* __restrict backY, const double* __restrict before,
                  const double* __restrict twoBefore, double* __restrict cells) {
  for (std::size_t i = lo; i <= hi; ++i) {
    const double dx = ax[i] - backX[i];
    const double dy = ay[i] - backY[i];
    // Cells are kept one place to the right: place 0 is the border.
    const double side = before[i] < before[i + 1] ? before[i] : before[i + 1];
    const double least = side < twoBefore[i] ? side : twoBefore[i];
    cells[i + 1] = std::sqrt(dx * dx + dy * dy) + least;
  }
}

}  // namespace

double dtw(std::span<const glm::dvec2> a, std::span<const glm::dvec2> b) {
  assert(!a.empty() && !b.empty());
  if (a.size() > b.size()) std::swap(a, b);  // short diagonals; every cell keeps its value
  const std::size_t n = a.size(), m = b.size();
  std::vector<double> ax(n), ay(n);
  for (std::size_t i = 0; i < n; ++i) {
    ax[i] = a[i].x;
    ay[i] = a[i].y;
  }
  // b in reverse, with n places on either side that are never read but may be pointed to.
  std::vector<double> backX(m + 2 * n), backY(m + 2 * n);
  for (std::size_t j = 0; j < m; ++j) {
    backX[n + m - 1 - j] = b[j].x;
    backY[n + m - 1 - j] = b[j].y;
  }
  constexpr double kOutside = std::numeric_limits<double>::infinity();
  std::vector<double> before(n + 1, kOutside), twoBefore(n + 1, kOutside), cells(n + 1, kOutside);
  twoBefore[0] = 0.0;                             // before the first cell
  for (std::size_t k = 0; k <= n + m - 2; ++k) {  // the diagonal i + j = k
    const std::size_t lo = k + 1 > m ? k + 1 - m : 0;
    const std::size_t hi = std::min(k, n - 1);
    const std::size_t shift = n + m - 1 - k;  // of b's reverse: j = k - i stands at shift + i
    fillDiagonal(lo, hi, ax.data(), ay.data(), backX.data() + shift, backY.data() + shift,
                 before.data(), twoBefore.data(), cells.data());
    twoBefore[0] = kOutside;
    std::swap(twoBefore, before);
    std::swap(before, cells);
  }
  return before[n];
}

double pathLength(std::span<const glm::dvec2> path) {
  double length = 0.0;
  for (std::size_t i = 1; i < path.size(); ++i) length += glm::distance(path[i - 1], path[i]);
  return length;
}

std::vector<glm::dvec2> resampleByLength(std::span<const glm::dvec2> path, double spacing) {
  assert(!path.empty() && spacing > 0.0);
  const double length = pathLength(path);
  if (!(length > 0.0)) return {path.front()};
  const auto steps = static_cast<std::size_t>(std::max(1.0, std::round(length / spacing)));
  std::vector<glm::dvec2> points;
  points.reserve(steps + 1);
  points.push_back(path.front());
  std::size_t leg = 1;     // the leg that ends at path[leg]
  double legBegins = 0.0;  // metres along the path
  double legLength = glm::distance(path[0], path[1]);
  for (std::size_t step = 1; step < steps; ++step) {
    const double along = length * static_cast<double>(step) / static_cast<double>(steps);
    while (leg + 1 < path.size() && legBegins + legLength < along) {
      legBegins += legLength;
      ++leg;
      legLength = glm::distance(path[leg - 1], path[leg]);
    }
    const double share =
        legLength > 0.0 ? std::clamp((along - legBegins) / legLength, 0.0, 1.0) : 0.0;
    points.push_back(path[leg - 1] + share * (path[leg] - path[leg - 1]));
  }
  points.push_back(path.back());
  return points;
}

double normalisedDtw(std::span<const glm::dvec2> a, std::span<const glm::dvec2> b, double spacing) {
  const std::vector<glm::dvec2> evenA = resampleByLength(a, spacing);
  const std::vector<glm::dvec2> evenB = resampleByLength(b, spacing);
  return dtw(evenA, evenB) / (0.5 * static_cast<double>(evenA.size() + evenB.size()));
}

}  // namespace forewalk::agents
