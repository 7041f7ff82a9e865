// Which groups differ? All pairs at once, with the chance of any false alarm held.
//
// Tukey's honestly significant difference (1953), for groups of different size in the form of
// Kramer (Biometrics 12, 1956), and the test of Games and Howell (J. Educational Statistics 1,
// 1976), which does not need equal variances. Both compare q = |difference| / standard error with
// the studentized range of as many means as there are groups:
//
//   Tukey-Kramer    se^2 = MSW / 2 (1/n_i + 1/n_j)            df = N - k
//   Games-Howell    se^2 = (s_i^2 / n_i + s_j^2 / n_j) / 2    df = Welch's, of the pair
#pragma once

#include <cstddef>
#include <vector>

#include "agents/evaluation/one_way.h"

namespace forewalk::agents {

struct PairDifference {
  std::size_t first = 0, second = 0;  ///< groups, first < second
  double difference = 0.0;            ///< mean of the first minus mean of the second
  double standardError = 0.0;         ///< as above, the one that q is taken with
  double df = 0.0;
  double q = 0.0;
  double p = 0.0;          ///< adjusted for all pairs
  double halfWidth = 0.0;  ///< the difference's simultaneous interval is difference +- halfWidth
};

/// All pairs in order (0 1, 0 2, ..., 1 2, ...). `confidence` is that of the intervals, in (0, 1).
/// Where a pair has no spread, p is 0 for means that differ and NaN for equal ones, halfWidth 0 or
/// NaN.
///
/// REQUIRES 2 to 1000 groups, as one_way.h does. About 0.2 ms a pair, and Games-Howell about 2 ms.
std::vector<PairDifference> tukeyHsd(Groups groups, double confidence = 0.95);
std::vector<PairDifference> gamesHowell(Groups groups, double confidence = 0.95);

}  // namespace forewalk::agents
