#include "service/cli/walks_options.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>

#include "service/files.h"

namespace forewalk::cli {

SceneAndWalks parseSceneAndWalks(const std::string& option, const std::string& text) {
  const std::size_t at = text.find('=');
  if (at == std::string::npos || at == 0 || at + 1 == text.size()) {
    throw CLI::ValidationError(
        option, fmt::format("\"{}\" is not SCENE=WALKS, as in house.obj=walks.csv", text));
  }
  return {text.substr(0, at), text.substr(at + 1)};
}

tl::expected<std::vector<rdw::Walk>, Error> loadWalks(const std::filesystem::path& file) {
  auto bytes = service::readFile(file);
  if (!bytes) return tl::unexpected(std::move(bytes.error()));
  return rdw::parseWalks(*bytes, file.string());
}

tl::expected<void, Error> checkOnNavMesh(std::span<const service::RecordedWalk> walks,
                                         const std::filesystem::path& scene,
                                         const std::filesystem::path& file) {
  std::size_t frames = 0, off = 0, samples = 0;
  for (const service::RecordedWalk& walk : walks) {
    frames += walk.frames.size();
    off += walk.offMesh;
    samples += walk.samples.size();
  }
  if (2 * off <= frames && samples > 0) return {};
  return tl::unexpected(Error{
      ErrorCode::kPositionOffNavMesh,
      fmt::format(
          "{}: {:.0f} % of its frames lie off the navmesh of {}, and {} samples have "
          "a way to go. Give the scene that was walked in, or a smaller --radius.",
          file.string(),
          100.0 * static_cast<double>(off) / static_cast<double>(std::max<std::size_t>(1, frames)),
          scene.string(), samples)});
}

std::vector<std::string> methodNames() { return {"polygon", "front"}; }

service::MethodFactory methodNamed(const std::string& name) {
  return name == "polygon" ? service::polygonMethod : service::frontMethod;
}

}  // namespace forewalk::cli
