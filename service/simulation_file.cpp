#include "service/simulation_file.h"

#include <fmt/format.h>

#include <set>
#include <string>
#include <utility>

#include "service/files.h"
#include "service/walk_company.h"

namespace forewalk::service {

tl::expected<rdw::TrackedSpace, Error> SimulationLoader::spaceOf(
    const std::filesystem::path& file) {
  if (const auto known = spaces_.find(file); known != spaces_.end()) return known->second;
  const auto bytes = readFile(file);
  if (!bytes) return tl::unexpected(bytes.error());
  auto read =
      rdw::TrackedSpace::read({reinterpret_cast<const char*>(bytes->data()), bytes->size()});
  if (!read) {
    // The reader knows no file names.
    return tl::unexpected(Error{read.error().code, file.string() + ": " + read.error().message});
  }
  return spaces_.emplace(file, std::move(*read)).first->second;
}

tl::expected<rdw::Walk, Error> SimulationLoader::walkOf(const std::filesystem::path& file,
                                                        const std::string& walker) {
  auto known = walks_.find(file);
  if (known == walks_.end()) {
    const auto bytes = readFile(file);
    if (!bytes) return tl::unexpected(bytes.error());
    auto walks = rdw::parseWalks(*bytes, file.string());
    if (!walks) return tl::unexpected(std::move(walks.error()));
    known = walks_.emplace(file, std::move(*walks)).first;
  }
  const std::vector<rdw::Walk>& walks = known->second;
  for (const rdw::Walk& walk : walks) {
    if (walker.empty() || walk.walker == walker) return walk;
  }
  return tl::unexpected(
      Error{ErrorCode::kDataDamaged,
            fmt::format("{}: holds no walker \"{}\" among its {}; the first is \"{}\".",
                        file.string(), walker, walks.size(), walks.front().walker)});
}

tl::expected<SimulationLoader::BuiltScene, Error> SimulationLoader::sceneOf(
    const rdw::SimulationFile& file, const std::filesystem::path& folder) {
  const std::filesystem::path path = folder / file.scene;
  for (const BuiltScene& scene : scenes_) {
    if (scene.file == path && scene.import == file.import && scene.build == file.build) {
      return scene;
    }
  }
  const auto navMesh = loadNavMesh(path, file.import, file.build, run_);
  if (!navMesh) return tl::unexpected(navMesh.error());
  auto world = makeWorld(*navMesh);
  if (!world) return tl::unexpected(std::move(world.error()));
  scenes_.push_back({path, file.import, file.build, std::move(*world), navMesh->settings.radius});
  return scenes_.back();
}

tl::expected<LoadedSimulation, Error> SimulationLoader::load(const rdw::SimulationFile& file,
                                                             const std::filesystem::path& folder,
                                                             const std::string& name) {
  const std::lock_guard lock(mutex_);
  LoadedSimulation loaded;
  loaded.config = file.simulation;
  if (!file.space.empty()) {
    auto space = spaceOf(folder / file.space);
    if (!space) return tl::unexpected(std::move(space.error()));
    loaded.config.session.space = std::move(*space);
  }
  if (!file.walks.empty()) {
    auto walk = walkOf(folder / file.walks, file.walker);
    if (!walk) return tl::unexpected(std::move(walk.error()));
    loaded.config.user.plan = rdw::Recorded{std::move(*walk)};
  }
  if (!file.agents.empty()) {
    auto company = parseCompany(file.agents, name, file.scene, loaded.config.seed);
    if (!company) return tl::unexpected(std::move(company.error()));
    loaded.company = std::move(*company);
  }
  if (!file.scene.empty()) {
    const auto scene = sceneOf(file, folder);
    if (!scene) return tl::unexpected(scene.error());
    loaded.world = scene->world;
    loaded.walkerRadius = scene->walkerRadius;
  }
  return loaded;
}

std::vector<std::filesystem::path> SimulationLoader::files() const {
  const std::lock_guard lock(mutex_);
  std::set<std::filesystem::path> files;
  for (const BuiltScene& scene : scenes_) files.insert(scene.file);
  for (const auto& [file, space] : spaces_) files.insert(file);
  for (const auto& [file, walks] : walks_) files.insert(file);
  return {files.begin(), files.end()};
}

tl::expected<LoadedSimulation, Error> loadSimulation(const std::filesystem::path& file,
                                                     const navmesh::BuildRun& run) {
  const auto bytes = readFile(file);
  if (!bytes) return tl::unexpected(bytes.error());
  const auto parsed = rdw::parseSimulation(*bytes, file.string());
  if (!parsed) return tl::unexpected(parsed.error());
  return SimulationLoader(run).load(*parsed, file.parent_path(), file.string());
}

tl::expected<rdw::SimulationResult, Error> simulate(const LoadedSimulation& loaded,
                                                    rdw::SimulationRun run,
                                                    const navmesh::ForEach& forEach) {
  if (!loaded.company) return rdw::simulate(loaded.world, loaded.config, run);
  WalkCompany company(*loaded.company, loaded.world, loaded.walkerRadius, loaded.config.rate,
                      forEach);
  run.company = &company;
  return rdw::simulate(loaded.world, loaded.config, run);
}

}  // namespace forewalk::service
