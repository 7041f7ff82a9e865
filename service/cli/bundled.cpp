#include "service/cli/bundled.h"

#include <fmt/format.h>

#include <algorithm>
#include <system_error>
#include <vector>

namespace forewalk::cli {
namespace {

std::vector<std::filesystem::path> assetFolders() {
  std::vector<std::filesystem::path> folders{FOREWALK_ASSETS};
  std::error_code failure;
  const auto program = std::filesystem::read_symlink("/proc/self/exe", failure);
  if (!failure) folders.push_back(program.parent_path().parent_path() / "share/forewalk");
  return folders;
}

}  // namespace

tl::expected<std::filesystem::path, Error> sceneFile(const std::string& nameOrPath) {
  std::error_code failure;
  if (std::filesystem::is_regular_file(nameOrPath, failure)) return nameOrPath;
  std::vector<std::string> known;
  for (const std::filesystem::path& folder : assetFolders()) {
    const std::filesystem::path file = folder / "scenes" / (nameOrPath + ".obj");
    if (std::filesystem::is_regular_file(file, failure)) return file;
    for (const auto& entry : std::filesystem::directory_iterator(folder / "scenes", failure)) {
      if (entry.path().extension() == ".obj") known.push_back(entry.path().stem().string());
    }
  }
  std::sort(known.begin(), known.end());
  known.erase(std::unique(known.begin(), known.end()), known.end());
  return tl::unexpected(Error{
      ErrorCode::kFileUnreadable,
      fmt::format("{}: no such file, and no bundled scene of that name. Bundled: {}.", nameOrPath,
                  known.empty() ? "none found" : fmt::format("{}", fmt::join(known, ", ")))});
}

}  // namespace forewalk::cli
