#include "service/cli/scene_options.h"

#include <fmt/format.h>

#include <glm/gtc/constants.hpp>
#include <glm/trigonometric.hpp>

#include "service/console.h"
#include "service/files.h"
#include "service/parallel.h"

namespace forewalk::cli {

void addSceneOptions(CLI::App& verb, SceneOptions& options) {
  verb.add_option("SCENE", options.scene,
                  "Scene (.obj .off .ply .stl .gltf .glb), built navmesh (.fwmesh) or RecastDemo's "
                  "tile set (.bin)")
      ->required();
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
  setting(verb.add_option("--partition", options.partition, "watershed, monotone or layers")
              ->check(CLI::IsMember({"watershed", "monotone", "layers"})),
          kBuild)
      ->capture_default_str();
  number("--tile", build.tile, "Side of a tile, metres; 0: one piece", kBuild);
  verb.add_option("--threads", options.threads, "Threads that build tiles; 0: all cores")
      ->group(std::string(kBuild))
      ->capture_default_str();
}

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
  // The default stays the default to the last bit.
  if (options.slopeDegrees != 45.0f) build.slope = glm::radians(options.slopeDegrees);
  build.partition = options.partition == "monotone" ? navmesh::Partition::kMonotone
                    : options.partition == "layers" ? navmesh::Partition::kLayers
                                                    : navmesh::Partition::kWatershed;
  service::ProgressBar bar("building " + options.scene.filename().string());
  navmesh::BuildRun run;
  run.forEach = service::onThreads(options.threads);
  run.progress = [&](std::size_t done, std::size_t total) { bar.update(done, total); };
  return service::loadNavMesh(options.scene, import, build, run);
}

tl::expected<std::shared_ptr<const navmesh::World>, Error> loadWorld(const SceneOptions& options) {
  return loadNavMesh(options).and_then(
      [](const navmesh::NavMesh& navMesh) { return service::makeWorld(navMesh); });
}

}  // namespace forewalk::cli
