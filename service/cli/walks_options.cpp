#include "service/cli/walks_options.h"

#include <fmt/format.h>

#include "service/cli/verb.h"
#include "service/files.h"
#include "service/likelihood_file.h"

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

CLI::Option* addLikelihoodOption(CLI::App& verb, std::filesystem::path& file) {
  return verb
      .add_option("--likelihood", file,
                  "Parameters (JSON, from forewalk fit); default: the built-in ones")
      ->check(fileName);
}

tl::expected<prediction::LikelihoodParameters, Error> likelihoodOf(
    const std::filesystem::path& file) {
  if (file.empty()) return prediction::LikelihoodParameters{};
  return service::readLikelihood(file);
}

}  // namespace forewalk::cli
