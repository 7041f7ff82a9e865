#include "agents/evaluation/distance_table.h"

#include <limits>

namespace forewalk::agents {

DistanceTable makeDistanceTable(std::size_t paths) {
  return {paths, std::vector<double>(paths * paths, 0.0)};
}

std::vector<std::vector<double>> columnsOf(const DistanceTable& table) {
  std::vector<std::vector<double>> columns(table.paths, std::vector<double>(table.paths));
  for (std::size_t i = 0; i < table.paths; ++i) {
    for (std::size_t j = 0; j < table.paths; ++j) columns[j][i] = table.at(i, j);
  }
  return columns;
}

std::vector<double> meanDistancesTo(const DistanceTable& table,
                                    std::span<const std::size_t> reference) {
  std::vector<double> means(table.paths);
  for (std::size_t path = 0; path < table.paths; ++path) {
    double sum = 0.0;
    std::size_t others = 0;
    for (const std::size_t other : reference) {
      assert(other < table.paths);
      if (other == path) continue;
      sum += table.at(path, other);
      ++others;
    }
    means[path] =
        others > 0 ? sum / static_cast<double>(others) : std::numeric_limits<double>::quiet_NaN();
  }
  return means;
}

}  // namespace forewalk::agents
