// The SCENE argument and the options that say how to read and build it, the same for every verb.
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>
#include <string>
#include <tl/expected.hpp>
#include <vector>

#include "navmesh/build/build.h"
#include "navmesh/error.h"
#include "navmesh/world.h"

namespace forewalk::cli {

/// Filled by parsing; must outlive the App.
struct SceneOptions {
  std::filesystem::path scene;
  navmesh::ImportSettings import;
  navmesh::BuildSettings build;
  float slopeDegrees = 45.0f;
  std::string up = "y";
  std::string partition = "watershed";
  unsigned threads = 0;                      ///< 0: all cores
  std::vector<const CLI::Option*> settings;  ///< those that need a scene to build
};

void addSceneOptions(CLI::App& verb, SceneOptions& options);

/// Reads or builds the navmesh, with a progress bar. Throws CLI::ValidationError where settings are
/// given with a navmesh that is built already and so could not take them.
[[nodiscard]] tl::expected<navmesh::NavMesh, Error> loadNavMesh(const SceneOptions& options);

/// The same, made ready for frames.
[[nodiscard]] tl::expected<std::shared_ptr<const navmesh::World>, Error> loadWorld(
    const SceneOptions& options);

}  // namespace forewalk::cli
