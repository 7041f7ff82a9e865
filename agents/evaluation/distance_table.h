// The distances between all pairs of a set of paths, and the samples that tests are run on.
#pragma once

#include <cassert>
#include <cstddef>
#include <span>
#include <vector>

namespace forewalk::agents {

/// A symmetric table with a zero diagonal; row by row.
struct DistanceTable {
  std::size_t paths = 0;
  std::vector<double> distances;  ///< paths * paths, each >= 0 and finite

  double at(std::size_t i, std::size_t j) const { return distances[i * paths + j]; }
  double& at(std::size_t i, std::size_t j) { return distances[i * paths + j]; }
};

/// A table with zeros, to be filled.
DistanceTable makeDistanceTable(std::size_t paths);

/// A sample per path: its column of the table, the zero on the diagonal included, as Ono's thesis
/// takes them. The samples are not independent (each distance is in two of them, and all of one
/// share a path), so p-values from them mean little; see separation.h for a test that is sound.
std::vector<std::vector<double>> columnsOf(const DistanceTable& table);

/// For every path, its mean distance to those of `reference` other than itself. NaN where there is
/// no other.
std::vector<double> meanDistancesTo(const DistanceTable& table,
                                    std::span<const std::size_t> reference);

}  // namespace forewalk::agents
