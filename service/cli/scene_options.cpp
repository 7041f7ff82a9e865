#include "service/cli/scene_options.h"

#include <fmt/format.h>

#include <glm/gtc/constants.hpp>
#include <glm/trigonometric.hpp>
#include <string_view>
#include <utility>

#include "service/cli/verb.h"
#include "service/console.h"
#include "service/files.h"
#include "service/parallel.h"

namespace forewalk::cli {

void addSceneOptions(CLI::App& verb, SceneOptions& options) {
  verb.add_option("SCENE", options.scene,
                  "Scene (.obj .off .ply .stl .gltf .glb), built navmesh (.fwmesh) or RecastDemo's "
                  "tile set (.bin)")
      ->required()
      ->check(fileName);
  const auto setting = [&](CLI::Option* option, std::string_view group) {
    option->group(std::string(group));
    options.settings.push_back(option);
    return option;
  };
  constexpr std::string_view kImport = "Reading the scene", kWalker = "Walker", kBuild = "Building";
  setting(
      verb.add_option("--unit", options.import.metresPerUnit, "Metres per unit of the scene file"),
      kImport)
      ->capture_default_str();
  setting(verb.add_option("--up", options.up, "Axis of the scene file that points up, y or z")
              ->check(CLI::IsMember({"y", "z"})),
          kImport)
      ->capture_default_str();

  navmesh::BuildSettings& build = options.build;
  const auto number = [&](const char* name, float& value, const char* meaning,
                          std::string_view group) {
    setting(verb.add_option(name, value, meaning), group)->capture_default_str();
  };
  number("--radius", build.radius, "Of the walker, metres", kWalker);
  number("--height", build.height, "Of the walker, metres", kWalker);
  number("--climb", build.climb, "Highest step, metres", kWalker);
  number("--slope-deg", options.slopeDegrees, "Steepest ground, degrees", kWalker);
  number("--cell", build.cell, "Voxel size on the ground, metres", kBuild);
  number("--cell-height", build.cellHeight, "Voxel height, metres", kBuild);
  number("--region-min", build.regionMin, "Drop regions smaller than this, square metres", kBuild);
  number("--region-merge", build.regionMerge, "Join regions smaller than this, square metres",
         kBuild);
  number("--edge-max", build.edgeMax, "Longest border edge, metres; 0: no limit", kBuild);
  number("--edge-error", build.edgeError, "How far a border may leave the voxels, metres", kBuild);
  number("--detail-sample", build.detailSample,
         "Spacing of height samples, metres; 0: corners only", kBuild);
  number("--detail-error", build.detailError, "How far the height may leave the voxels, metres",
         kBuild);
  setting(verb.add_option("--corners", build.cornersMax, "Most corners of a polygon, 3 to 6"),
          kBuild)
      ->capture_default_str();
  setting(verb.add_option("--partition", options.partition, "How the ground is cut into regions")
              ->check(CLI::IsMember({"watershed", "monotone", "layers"})),
          kBuild)
      ->capture_default_str();
  number("--tile", build.tile, "Side of a tile, metres; 0: one piece", kBuild);
  verb.add_option("--threads", options.threads, "Threads that build tiles; 0: all cores")
      ->group(std::string(kBuild))
      ->capture_default_str();
}

namespace {

// Settings have names of their own below; who typed an option looks for that.
Error inOptionWords(Error error) {
  constexpr std::pair<std::string_view, std::string_view> kNames[] = {
      {"radius", "--radius"},
      {"height", "--height"},
      {"climb", "--climb"},
      {"cell", "--cell"},
      {"cellHeight", "--cell-height"},
      {"regionMin", "--region-min"},
      {"regionMerge", "--region-merge"},
      {"edgeMax", "--edge-max"},
      {"edgeError", "--edge-error"},
      {"detailSample", "--detail-sample"},
      {"detailError", "--detail-error"},
      {"cornersMax", "--corners"},
      {"tile", "--tile"},
      {"metresPerUnit", "--unit"},
  };
  if (error.code != ErrorCode::kSettingOutOfRange) return error;
  const auto replace = [&](std::size_t at, std::string_view name, std::string_view option) {
    error.message.replace(at, name.size(), option);
  };
  for (const auto& [name, option] : kNames) {
    const std::string isWhat = fmt::format("{} is ", name);
    if (error.message.rfind(isWhat, 0) == 0) {
      replace(0, name, option);
    } else if (const auto at = error.message.find(": " + isWhat); at != std::string::npos) {
      replace(at + 2, name, option);
    }
    if (const auto at = error.message.find(fmt::format("with {} ", name)); at != std::string::npos)
      replace(at + 5, name, option);
  }
  return error;
}

}  // namespace

tl::expected<navmesh::NavMesh, Error> loadNavMesh(const SceneOptions& options) {
  if (service::isBuiltNavMesh(options.scene)) {
    for (const CLI::Option* setting : options.settings) {
      if (setting->count() == 0) continue;
      throw CLI::ValidationError(
          setting->get_name(),
          fmt::format("has no effect on {}, which is built already; leave it out or give the scene",
                      options.scene.string()));
    }
  }
  navmesh::ImportSettings import = options.import;
  import.up = options.up == "z" ? navmesh::UpAxis::kZ : navmesh::UpAxis::kY;
  navmesh::BuildSettings build = options.build;
  if (!(options.slopeDegrees >= 0.0f && options.slopeDegrees < 90.0f)) {
    return tl::unexpected(Error{
        ErrorCode::kSettingOutOfRange,
        fmt::format("--slope-deg is {:g} degrees, it must be 0 or more, and less than 90 degrees.",
                    options.slopeDegrees)});
  }
  // The default stays the default to the last bit.
  if (options.slopeDegrees != 45.0f) build.slope = glm::radians(options.slopeDegrees);
  build.partition = options.partition == "monotone" ? navmesh::Partition::kMonotone
                    : options.partition == "layers" ? navmesh::Partition::kLayers
                                                    : navmesh::Partition::kWatershed;
  service::ProgressBar bar("building " + options.scene.filename().string());
  navmesh::BuildRun run;
  run.forEach = service::onThreads(options.threads);
  run.progress = [&](std::size_t done, std::size_t total) { bar.update(done, total); };
  return service::loadNavMesh(options.scene, import, build, run).map_error(inOptionWords);
}

tl::expected<std::shared_ptr<const navmesh::World>, Error> loadWorld(const SceneOptions& options) {
  return loadNavMesh(options).and_then(
      [](const navmesh::NavMesh& navMesh) { return service::makeWorld(navMesh); });
}

}  // namespace forewalk::cli
