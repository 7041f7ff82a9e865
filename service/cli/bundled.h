// The scenes that come with forewalk.
#pragma once

#include <filesystem>
#include <string>

#include <tl/expected.hpp>
#include "navmesh/error.h"

namespace forewalk::cli {

/// The file of a scene: a bundled one by its name ("office"), or any path. Bundled scenes lie in
/// the source tree that the program was built from, or in share/forewalk beside the installed
/// program. Fails when there is neither (kFileUnreadable), naming the bundled ones.
[[nodiscard]] tl::expected<std::filesystem::path, Error> sceneFile(const std::string& nameOrPath);

}  // namespace forewalk::cli
