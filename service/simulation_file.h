// A simulation file with everything it names: scene, tracked space and recorded walk.
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <tl/expected.hpp>
#include <utility>
#include <vector>

#include "navmesh/build/build.h"
#include "navmesh/error.h"
#include "navmesh/world.h"
#include "rdw/simulation.h"
#include "rdw/simulation_config.h"
#include "rdw/tracked_space.h"
#include "rdw/walk_file.h"
#include "service/company_config.h"

namespace forewalk::service {

struct LoadedSimulation {
  std::shared_ptr<const navmesh::World> world;  ///< null: an open plane
  rdw::SimulationConfig config;                 ///< of the only user, or the first
  std::vector<rdw::SimulationConfig> others{};  ///< who walk at the same time
  rdw::Sharing sharing = rdw::Sharing::kRoom;   ///< what they have in common with them
  std::optional<CompanyConfig> company;         ///< who else is in the building
  float walkerRadius = 0.0f;                    ///< of who the navmesh was built for, metres
};

/// Reads what simulations name, each scene, room and recording once. Any number of threads may use
/// one loader; who comes while another loads waits.
class SimulationLoader {
 public:
  /// Scenes are built with `run`.
  explicit SimulationLoader(navmesh::BuildRun run = {}) : run_(std::move(run)) {}

  /// What the files that `file` names make of it; they lie in `folder` unless their paths are
  /// absolute. `name` stands for the file itself in messages. Fails as loadSimulation.
  [[nodiscard]] tl::expected<LoadedSimulation, Error> load(const rdw::SimulationFile& file,
                                                           const std::filesystem::path& folder,
                                                           const std::string& name);

  /// All files read so far, sorted.
  std::vector<std::filesystem::path> files() const;

 private:
  struct BuiltScene {
    std::filesystem::path file;
    navmesh::ImportSettings import;
    navmesh::BuildSettings build;
    std::shared_ptr<const navmesh::World> world;
    float walkerRadius;  // metres
  };

  tl::expected<BuiltScene, Error> sceneOf(const rdw::SimulationFile& file,
                                          const std::filesystem::path& folder);
  tl::expected<rdw::TrackedSpace, Error> spaceOf(const std::filesystem::path& file);
  tl::expected<const std::vector<rdw::Walk>*, Error> walksIn(
      const std::filesystem::path& file, const std::filesystem::path& intervals);
  tl::expected<rdw::Walk, Error> walkOf(const rdw::UserFile& user,
                                        const std::filesystem::path& folder, std::size_t i);
  tl::expected<std::vector<glm::vec3>, Error> waypointsOf(const std::filesystem::path& file,
                                                          float height);
  tl::expected<std::vector<rdw::SimulationConfig>, Error> usersOf(
      const rdw::SimulationFile& file, const std::filesystem::path& folder,
      const rdw::SimulationConfig& config, const std::string& name);
  tl::expected<std::vector<std::byte>, Error> bytesOf(const std::filesystem::path& file);

  navmesh::BuildRun run_;
  mutable std::mutex mutex_;
  std::vector<BuiltScene> scenes_;
  std::map<std::filesystem::path, rdw::TrackedSpace> spaces_;
  std::map<std::pair<std::filesystem::path, std::filesystem::path>, std::vector<rdw::Walk>>
      walks_;  // by the files of their places and times
  std::map<std::filesystem::path, std::vector<glm::dvec2>> paths_;
  std::set<std::filesystem::path> read_;
};

/// All users, in their order. `forEach` as below. Fails as rdw::simulateTogether does.
[[nodiscard]] tl::expected<std::vector<rdw::SimulationResult>, Error> simulateAll(
    const LoadedSimulation& loaded, rdw::SimulationRun run = {},
    const navmesh::ForEach& forEach = {});

/// The first user, with all others there. Walks, in the company that the file asks for; `forEach`:
/// who runs slices of a crowd's step, with the same result whoever does. Fails as rdw::simulate
/// does.
[[nodiscard]] tl::expected<rdw::SimulationResult, Error> simulate(
    const LoadedSimulation& loaded, rdw::SimulationRun run = {},
    const navmesh::ForEach& forEach = {});

/// Reads a `forewalk.simulation/1` file (rdw/simulation_config.h) and the files it names, which lie
/// beside it unless their paths are absolute; builds the scene with `run`.
/// Fails as parseSimulation, loadNavMesh, TrackedSpace::read and parseWalks do, and when the file
/// names a walker that its recording does not hold (kDataDamaged).
[[nodiscard]] tl::expected<LoadedSimulation, Error> loadSimulation(
    const std::filesystem::path& file, const navmesh::BuildRun& run = {});

}  // namespace forewalk::service
