// What `fit` and `evaluate` share: recorded walks, and the method that predicts their ways.
#pragma once

#include <filesystem>
#include <string>
#include <tl/expected.hpp>
#include <vector>

#include "navmesh/error.h"
#include "rdw/walk_file.h"
#include "service/recording.h"

namespace forewalk::cli {

/// A building and a recording in it, typed as SCENE=WALKS.
struct SceneAndWalks {
  std::filesystem::path scene, walks;
};

/// Throws CLI::ValidationError naming `option` where there is no "=" between two names.
SceneAndWalks parseSceneAndWalks(const std::string& option, const std::string& text);

/// Reads walks from a CSV file. Fails as parseWalks.
[[nodiscard]] tl::expected<std::vector<rdw::Walk>, Error> loadWalks(
    const std::filesystem::path& file);

/// Fails (kPositionOffNavMesh) where hardly any frame of `walks` lies on the navmesh.
[[nodiscard]] tl::expected<void, Error> checkOnNavMesh(std::span<const service::RecordedWalk> walks,
                                                       const std::filesystem::path& scene,
                                                       const std::filesystem::path& file);

/// The names of methods that predict ways, and what they stand for.
std::vector<std::string> methodNames();
service::MethodFactory methodNamed(const std::string& name);

}  // namespace forewalk::cli
