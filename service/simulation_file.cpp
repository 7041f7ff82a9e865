#include "service/simulation_file.h"

#include <fmt/format.h>

#include <string>
#include <utility>
#include <variant>

#include "rdw/simulation_config.h"
#include "rdw/walk_file.h"
#include "service/files.h"
#include "service/walk_company.h"

namespace forewalk::service {
namespace {

tl::expected<void, Error> readSpace(const std::filesystem::path& file, rdw::TrackedSpace& space) {
  const auto bytes = readFile(file);
  if (!bytes) return tl::unexpected(bytes.error());
  auto read =
      rdw::TrackedSpace::read({reinterpret_cast<const char*>(bytes->data()), bytes->size()});
  if (!read) {
    // The reader knows no file names.
    return tl::unexpected(Error{read.error().code, file.string() + ": " + read.error().message});
  }
  space = std::move(*read);
  return {};
}

tl::expected<void, Error> readWalk(const std::filesystem::path& file, const std::string& walker,
                                   rdw::User& user) {
  const auto bytes = readFile(file);
  if (!bytes) return tl::unexpected(bytes.error());
  auto walks = rdw::parseWalks(*bytes, file.string());
  if (!walks) return tl::unexpected(std::move(walks.error()));
  for (rdw::Walk& walk : *walks) {
    if (!walker.empty() && walk.walker != walker) continue;
    user.plan = rdw::Recorded{std::move(walk)};
    return {};
  }
  return tl::unexpected(
      Error{ErrorCode::kDataDamaged,
            fmt::format("{}: holds no walker \"{}\" among its {}; the first is \"{}\".",
                        file.string(), walker, walks->size(), walks->front().walker)});
}

}  // namespace

tl::expected<LoadedSimulation, Error> loadSimulation(const std::filesystem::path& file,
                                                     const navmesh::BuildRun& run) {
  const auto bytes = readFile(file);
  if (!bytes) return tl::unexpected(bytes.error());
  auto parsed = rdw::parseSimulation(*bytes, file.string());
  if (!parsed) return tl::unexpected(std::move(parsed.error()));
  const std::filesystem::path folder = file.parent_path();

  LoadedSimulation loaded;
  loaded.config = std::move(parsed->simulation);
  if (!parsed->space.empty()) {
    const auto read = readSpace(folder / parsed->space, loaded.config.session.space);
    if (!read) return tl::unexpected(read.error());
  }
  if (!parsed->walks.empty()) {
    const auto read = readWalk(folder / parsed->walks, parsed->walker, loaded.config.user);
    if (!read) return tl::unexpected(read.error());
  }
  if (!parsed->agents.empty()) {
    auto company = parseCompany(parsed->agents, file.string(), parsed->scene, loaded.config.seed);
    if (!company) return tl::unexpected(std::move(company.error()));
    loaded.company = std::move(*company);
  }
  if (!parsed->scene.empty()) {
    auto world = loadNavMesh(folder / parsed->scene, parsed->import, parsed->build, run)
                     .and_then([&](const navmesh::NavMesh& navMesh) {
                       loaded.walkerRadius = navMesh.settings.radius;
                       return makeWorld(navMesh);
                     });
    if (!world) return tl::unexpected(std::move(world.error()));
    loaded.world = std::move(*world);
  }
  return loaded;
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
