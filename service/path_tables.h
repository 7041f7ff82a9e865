// Tables of distances between paths as files: JSON of the form
//
//   {"paths": ["H1", "H2", "Model"], "test1": [[0, 212.2, 508.7], [212.2, 0, 498.3], [508.7, 498.3,
//   0]]}
//
// Every member that is a list of lists is a table, whatever its name; others are left alone. What
// `forewalk paths --out` writes is such a file too.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <tl/expected.hpp>
#include <vector>

#include "agents/evaluation/distance_table.h"
#include "navmesh/error.h"

namespace forewalk::service {

struct NamedTable {
  std::string name;
  agents::DistanceTable table;
};

/// Two paths or more, at most kMostPaths, each named and no name twice; a table or more.
struct PathTables {
  std::vector<std::string> paths;
  std::vector<NamedTable> tables;  ///< in order of their names
};

inline constexpr std::size_t kMostPaths = 1000;

/// `name` stands for the file in messages.
///
/// Fails (kDataDamaged, naming table, row and value) where the text is not JSON, has no list of
/// names "paths" as above or no table, or where a table is not square with a row per path, has a
/// distance that is negative, infinite or no number, one that differs from its mirror image by more
/// than a millionth, or a diagonal that is not 0; and kTooLarge above kMostPaths. Costs O(size).
[[nodiscard]] tl::expected<PathTables, Error> parsePathTables(std::span<const std::byte> bytes,
                                                              const std::string& name);

}  // namespace forewalk::service
