// A simulation file with everything it names: scene, tracked space and recorded walk.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <tl/expected.hpp>

#include "navmesh/build/build.h"
#include "navmesh/error.h"
#include "navmesh/world.h"
#include "rdw/simulation.h"
#include "service/company_config.h"

namespace forewalk::service {

struct LoadedSimulation {
  std::shared_ptr<const navmesh::World> world;  ///< null: an open plane
  rdw::SimulationConfig config;
  std::optional<CompanyConfig> company;  ///< who else is in the building
  float walkerRadius = 0.0f;             ///< of who the navmesh was built for, metres
};

/// Walks, in the company that the file asks for; `forEach`: who runs slices of a crowd's step, with
/// the same result whoever does. Fails as rdw::simulate does.
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
