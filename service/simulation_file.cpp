#include "service/simulation_file.h"

#include <fmt/format.h>

#include <iterator>
#include <set>
#include <string>
#include <utility>
#include <variant>

#include "navmesh/plan.h"
#include "rdw/openrdw_walk.h"
#include "service/files.h"
#include "service/shared_world.h"
#include "service/walk_company.h"

namespace forewalk::service {

tl::expected<std::vector<std::byte>, Error> SimulationLoader::bytesOf(
    const std::filesystem::path& file) {
  auto bytes = readFile(file);
  if (bytes) read_.insert(file);
  return bytes;
}

tl::expected<rdw::TrackedSpace, Error> SimulationLoader::spaceOf(
    const std::filesystem::path& file) {
  if (const auto known = spaces_.find(file); known != spaces_.end()) return known->second;
  const auto bytes = bytesOf(file);
  if (!bytes) return tl::unexpected(bytes.error());
  auto read =
      rdw::TrackedSpace::read({reinterpret_cast<const char*>(bytes->data()), bytes->size()});
  if (!read) {
    // The reader knows no file names.
    return tl::unexpected(Error{read.error().code, file.string() + ": " + read.error().message});
  }
  return spaces_.emplace(file, std::move(*read)).first->second;
}

tl::expected<const std::vector<rdw::Walk>*, Error> SimulationLoader::walksIn(
    const std::filesystem::path& file, const std::filesystem::path& intervals) {
  const std::pair key(file, intervals);
  if (const auto known = walks_.find(key); known != walks_.end()) return &known->second;
  const auto bytes = bytesOf(file);
  if (!bytes) return tl::unexpected(bytes.error());
  tl::expected<std::vector<rdw::Walk>, Error> walks;
  if (intervals.empty()) {
    walks = rdw::parseWalks(*bytes, file.string());
  } else {
    const auto times = bytesOf(intervals);
    if (!times) return tl::unexpected(times.error());
    walks = rdw::parseOpenRdwWalk(*bytes, file.string(), *times, intervals.string())
                .map([](rdw::Walk&& walk) { return std::vector{std::move(walk)}; });
  }
  if (!walks) return tl::unexpected(walks.error());
  return &walks_.emplace(key, std::move(*walks)).first->second;
}

tl::expected<rdw::Walk, Error> SimulationLoader::walkOf(const rdw::UserFile& user,
                                                        const std::filesystem::path& folder,
                                                        std::size_t i) {
  const std::filesystem::path file = folder / user.walks;
  const auto walks = walksIn(file, user.intervals.empty() ? "" : folder / user.intervals);
  if (!walks) return tl::unexpected(walks.error());
  const std::vector<rdw::Walk>& all = **walks;
  const auto refuse = [&](std::string message) {
    return tl::unexpected(Error{ErrorCode::kDataDamaged, std::move(message)});
  };
  std::size_t first = 0;
  while (first < all.size() && !user.walker.empty() && all[first].walker != user.walker) ++first;
  if (first == all.size()) {
    return refuse(fmt::format("{}: holds no walker \"{}\" among its {}; the first is \"{}\".",
                              file.string(), user.walker, all.size(), all.front().walker));
  }
  if (first + i >= all.size()) {
    return refuse(fmt::format("{}: {} walkers are asked for, {} are left in it.", file.string(),
                              user.count, all.size() - first));
  }
  return all[first + i];
}

tl::expected<std::vector<glm::vec3>, Error> SimulationLoader::waypointsOf(
    const std::filesystem::path& file, float height) {
  auto known = paths_.find(file);
  if (known == paths_.end()) {
    const auto bytes = bytesOf(file);
    if (!bytes) return tl::unexpected(bytes.error());
    auto path = rdw::parseOpenRdwPath(*bytes, file.string());
    if (!path) return tl::unexpected(path.error());
    known = paths_.emplace(file, std::move(*path)).first;
  }
  std::vector<glm::vec3> points;
  for (const glm::dvec2 plan : known->second) {
    points.push_back(navmesh::toSpace(glm::vec2(plan), height));
  }
  return points;
}

tl::expected<std::vector<rdw::SimulationConfig>, Error> SimulationLoader::usersOf(
    const rdw::SimulationFile& file, const std::filesystem::path& folder,
    const rdw::SimulationConfig& config, const std::string& name) {
  constexpr float kApart = 3.0f;  // metres, of starts on a plane that is shared
  std::vector<rdw::SimulationConfig> users;
  for (const rdw::UserFile& of : file.users) {
    for (std::size_t i = 0; i < of.count; ++i) {
      rdw::SimulationConfig& user = users.emplace_back(config);
      const std::size_t number = users.size() - 1;
      user.user = of.user;
      user.seed = rdw::seedOfUser(config.seed, number);
      user.session.space = of.room;
      if (!of.space.empty()) {
        auto space = spaceOf(folder / of.space);
        if (!space) return tl::unexpected(std::move(space.error()));
        user.session.space = std::move(*space);
      }
      if (!of.walks.empty()) {
        auto walk = walkOf(of, folder, i);
        if (!walk) return tl::unexpected(std::move(walk.error()));
        user.user.plan = rdw::Recorded{std::move(*walk)};
      }
      if (!of.waypoints.empty()) {
        auto points =
            waypointsOf(folder / of.waypoints, config.start.floor ? config.start.floor->y : 0.0f);
        if (!points) return tl::unexpected(std::move(points.error()));
        std::get<rdw::Waypoints>(user.user.plan).points = std::move(*points);
      }
      if (number == 0 || file.sharing != rdw::Sharing::kWorld) continue;
      // Two bodies cannot begin in one place.
      if (std::holds_alternative<rdw::Wander>(user.user.plan)) {
        user.start.floor.reset();
      } else if (!std::holds_alternative<rdw::Waypoints>(user.user.plan)) {
        user.start.floor = user.start.floor.value_or(glm::vec3(0.0f)) +
                           glm::vec3(kApart * static_cast<float>(number), 0.0f, 0.0f);
      }
    }
  }
  if (users.size() > 1 && file.sharing == rdw::Sharing::kRoom) {
    const auto places = rdw::placesInRoom(users.front().session.space, users.size());
    if (!places) {
      return tl::unexpected(
          Error{places.error().code, fmt::format("{}: {}", name, places.error().message)});
    }
    for (std::size_t i = 0; i < users.size(); ++i) users[i].start.physical = (*places)[i];
  }
  return users;
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
  auto users = usersOf(file, folder, loaded.config, name);
  if (!users) return tl::unexpected(std::move(users.error()));
  loaded.config = std::move(users->front());
  loaded.others.assign(std::make_move_iterator(users->begin() + 1),
                       std::make_move_iterator(users->end()));
  loaded.sharing = file.sharing;
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
  std::set<std::filesystem::path> files = read_;
  for (const BuiltScene& scene : scenes_) files.insert(scene.file);
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

tl::expected<std::vector<rdw::SimulationResult>, Error> simulateAll(
    const LoadedSimulation& loaded, rdw::SimulationRun run, const navmesh::ForEach& forEach) {
  std::vector<rdw::SimulationConfig> users{loaded.config};
  users.insert(users.end(), loaded.others.begin(), loaded.others.end());
  if (users.size() > 1 && loaded.sharing == rdw::Sharing::kWorld) {
    SharedWorld shared(loaded.world, loaded.walkerRadius, loaded.config.rate, users.size());
    return rdw::simulateTogether(loaded.world, users, loaded.sharing, run, shared.companies());
  }
  if (!loaded.company) return rdw::simulateTogether(loaded.world, users, loaded.sharing, run);
  WalkCompany company(*loaded.company, loaded.world, loaded.walkerRadius, loaded.config.rate,
                      forEach);
  rdw::Company* const companies[] = {&company};
  return rdw::simulateTogether(loaded.world, users, loaded.sharing, run, companies);
}

tl::expected<rdw::SimulationResult, Error> simulate(const LoadedSimulation& loaded,
                                                    rdw::SimulationRun run,
                                                    const navmesh::ForEach& forEach) {
  auto results = simulateAll(loaded, std::move(run), forEach);
  if (!results) return tl::unexpected(results.error());
  return std::move(results->front());
}

}  // namespace forewalk::service
