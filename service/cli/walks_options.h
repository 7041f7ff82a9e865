// What `fit`, `evaluate` and `animate` share: recorded walks, and how likely their ways are.
#pragma once

#include <CLI/CLI.hpp>
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

/// --likelihood: a file of parameters, read into `file`, which lives as long as `verb` is parsed.
CLI::Option* addLikelihoodOption(CLI::App& verb, std::filesystem::path& file);

/// The parameters of such a file; the built-in ones where none was named. Fails as readLikelihood.
[[nodiscard]] tl::expected<prediction::LikelihoodParameters, Error> likelihoodOf(
    const std::filesystem::path& file);

}  // namespace forewalk::cli
