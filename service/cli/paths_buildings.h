// forewalk paths --building: models on the errands of recorded people.
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <string>
#include <tl/expected.hpp>
#include <vector>

#include "navmesh/error.h"
#include "service/path_comparison.h"
#include "service/walk_legs.h"

namespace forewalk::cli {

struct BuildingsOptions {
  std::vector<std::string> pairs;  ///< SCENE=WALKS, as typed
  service::LegRule rule;
};

/// Adds --building and what says how legs are cut; the latter need the former.
void addBuildingsOptions(CLI::App& verb, BuildingsOptions& options);

/// Prints the comparison and, with `out`, writes OUT.csv, OUT.json, OUT-paths.csv and a plan of
/// each building and scene, OUT-NAME.svg. Fails as loading scenes and walks does, where walks lie
/// off their scene's navmesh, and as service::compareWithPeople.
[[nodiscard]] tl::expected<void, Error> runBuildings(const BuildingsOptions& options,
                                                     const service::ComparisonSettings& settings,
                                                     const std::filesystem::path& out);

}  // namespace forewalk::cli
