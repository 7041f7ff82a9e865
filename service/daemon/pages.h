// The inspector page's files, held in memory: what is served is what was there at the start, and no
// request names a path on the disk.
#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <tl/expected.hpp>

#include "navmesh/error.h"

namespace forewalk::daemon {

struct Page {
  std::string_view type;  ///< for Content-Type
  std::string bytes;
};

/// By path below the folder, "/index.html"; "/" is the same page.
using Pages = std::map<std::string, Page, std::less<>>;

/// Reads a folder and those below it. Hidden files, links, and files whose ending has no type are
/// left out. Fails where the folder is missing (kFileUnreadable) or without index.html
/// (kDataDamaged), and beyond 4096 files or 64 MiB (kTooLarge).
[[nodiscard]] tl::expected<Pages, Error> loadPages(const std::filesystem::path& folder);

}  // namespace forewalk::daemon
