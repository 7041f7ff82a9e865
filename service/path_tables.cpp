#include "service/path_tables.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>
#include <string_view>

#include "navmesh/file_text.h"
#include "rdw/json_text.h"

namespace forewalk::service {
namespace {

using Json = nlohmann::json;

tl::unexpected<Error> damaged(std::string message) {
  return tl::unexpected(Error{ErrorCode::kDataDamaged, std::move(message)});
}

tl::expected<std::vector<std::string>, Error> readNames(const Json& json, const std::string& name) {
  const auto found = json.find("paths");
  if (found == json.end() || !found->is_array()) {
    return damaged(fmt::format(
        "{}: has no list \"paths\"; give the names of the paths, in order of the rows.", name));
  }
  if (found->size() < 2) {
    return damaged(
        fmt::format("{}: names {} path; two are needed to compare.", name, found->size()));
  }
  if (found->size() > kMostPaths) {
    return tl::unexpected(
        Error{ErrorCode::kTooLarge, fmt::format("{}: names {} paths, {} at most are compared.",
                                                name, found->size(), kMostPaths)});
  }
  std::vector<std::string> names;
  std::set<std::string> seen;
  for (const Json& path : *found) {
    if (!path.is_string() || path.get_ref<const std::string&>().empty()) {
      return damaged(fmt::format("{}: paths[{}] is no name.", name, names.size()));
    }
    names.push_back(path.get<std::string>());
    if (!seen.insert(names.back()).second) {
      return damaged(fmt::format("{}: two paths are named {}; give each a name of its own.", name,
                                 inQuotes(names.back())));
    }
  }
  return names;
}

tl::expected<agents::DistanceTable, Error> readTable(const Json& rows, std::size_t paths,
                                                     const std::string& where) {
  if (rows.size() != paths) {
    return damaged(fmt::format("{}: has {} rows for {} paths.", where, rows.size(), paths));
  }
  agents::DistanceTable table = agents::makeDistanceTable(paths);
  for (std::size_t i = 0; i < paths; ++i) {
    if (!rows[i].is_array() || rows[i].size() != paths) {
      return damaged(fmt::format("{}: row {} has {} distances for {} paths.", where, i + 1,
                                 rows[i].is_array() ? rows[i].size() : 0, paths));
    }
    for (std::size_t j = 0; j < paths; ++j) {
      const Json& cell = rows[i][j];
      const double distance = cell.is_number() ? cell.get<double>() : std::nan("");
      if (!std::isfinite(distance) || distance < 0.0) {
        return damaged(fmt::format("{}: row {}, column {} is {}, not a distance, 0 or more.", where,
                                   i + 1, j + 1,
                                   cell.is_number() ? fmt::format("{:g}", distance) : "no number"));
      }
      table.at(i, j) = distance;
    }
  }
  for (std::size_t i = 0; i < paths; ++i) {
    if (table.at(i, i) != 0.0) {
      return damaged(fmt::format("{}: row {}, column {} is {:g}; a path is 0 from itself.", where,
                                 i + 1, i + 1, table.at(i, i)));
    }
    for (std::size_t j = 0; j < i; ++j) {
      const double here = table.at(i, j), mirrored = table.at(j, i);
      if (std::abs(here - mirrored) > 1e-6 * std::max(here, mirrored)) {
        return damaged(fmt::format(
            "{}: row {}, column {} is {:g}, but row {}, column {} is {:g}; the distance "
            "between two paths is one number.",
            where, i + 1, j + 1, here, j + 1, i + 1, mirrored));
      }
    }
  }
  return table;
}

}  // namespace

tl::expected<PathTables, Error> parsePathTables(std::span<const std::byte> bytes,
                                                const std::string& name) {
  const std::string_view text =
      withoutByteOrderMark({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
  const auto json = rdw::parseJson(text, name);
  if (!json) return tl::unexpected(json.error());
  if (!json->is_object()) {
    return damaged(fmt::format("{}: is no JSON object with \"paths\" and a table.", name));
  }
  auto names = readNames(*json, name);
  if (!names) return tl::unexpected(std::move(names.error()));
  PathTables tables{std::move(*names), {}};
  for (const auto& [key, value] : json->items()) {
    if (!value.is_array() || value.empty() || !value[0].is_array()) continue;
    auto table =
        readTable(value, tables.paths.size(), fmt::format("{}: table {}", name, inQuotes(key)));
    if (!table) return tl::unexpected(std::move(table.error()));
    tables.tables.push_back({key, std::move(*table)});
  }
  if (tables.tables.empty()) {
    return damaged(fmt::format("{}: holds no table; give one as a list of {} rows of distances.",
                               name, tables.paths.size()));
  }
  return tables;
}

}  // namespace forewalk::service
