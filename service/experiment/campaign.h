// An experiment carried out: all runs of a plan, or a share of them, on all cores, into a folder.
//
// What is finished is in the folder at once, a line each (results.h). A second start does only what
// is left; a run that fails is recorded with its reason and stops nothing.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <tl/expected.hpp>
#include <vector>

#include "navmesh/build/build.h"
#include "navmesh/error.h"
#include "service/experiment/plan.h"
#include "service/experiment/results.h"
#include "service/simulation_file.h"

namespace forewalk::service {

/// How wide a body is taken to be where a room is too small for it, metres (BuildSettings::radius).
inline constexpr double kBodyRadius = 0.25;

struct CampaignSettings {
  std::filesystem::path out;          ///< folder of the results
  std::string version;                ///< of the program, for the manifest
  unsigned threads = 0;               ///< 0: all cores
  std::size_t shard = 1, shards = 1;  ///< 1 <= shard <= shards
  std::function<double()>
      microseconds;  ///< a clock that any thread may read; empty: nothing is timed
  std::function<bool()>
      interrupted;  ///< asked from any thread, often; true: end soon, keeping what is done
  std::function<void(std::size_t done, std::size_t total)> progress;  ///< one thread at a time
};

/// What a campaign came to.
struct CampaignEnd {
  std::size_t done = 0;    ///< rows in the folder
  std::size_t total = 0;   ///< runs of this shard
  std::size_t before = 0;  ///< of `done`, there already
  std::size_t failed = 0;  ///< of `done`
  std::size_t stuck = 0;   ///< of `done`
  bool finished() const { return done == total; }
};

/// An experiment whose files are read and found to be sound.
class Experiment {
 public:
  /// Reads the plan and all that it names, and tries what can go wrong: every scene with every room
  /// and user, every controller with every scene, all with a first frame.
  ///
  /// Fails as parseExperiment, parseSimulation, loadSimulation and simulate do, naming the entries
  /// of the plan; kSettingOutOfRange where a room has no place for a body, or a walk begins outside
  /// its room.
  [[nodiscard]] static tl::expected<Experiment, Error> load(const std::filesystem::path& file,
                                                            const navmesh::BuildRun& run = {});

  const ExperimentPlan& plan() const { return plan_; }

  /// One run, made ready: what `simulate` takes. Fails as loadSimulation, which after load() means
  /// a file that has changed meanwhile.
  [[nodiscard]] tl::expected<LoadedSimulation, Error> simulation(std::size_t run) const;

  /// Carries the runs out that `settings.out` does not hold yet. The rows depend on nothing but the
  /// plan, its files and the program. Writes the tables once all runs of an unsharded campaign are
  /// there.
  ///
  /// Fails before anything runs when the folder cannot be written, belongs to another plan, version
  /// or shard, is damaged (results.h), or the disk has no room for the tables; and when it is full
  /// all the same, after the last row that fitted.
  [[nodiscard]] tl::expected<CampaignEnd, Error> carryOut(const CampaignSettings& settings) const;

 private:
  tl::expected<LoadedSimulation, Error> load(const std::array<std::size_t, kAxes>& chosen,
                                             std::uint64_t seed) const;
  std::string namesOf(const std::array<std::size_t, kAxes>& chosen) const;
  tl::expected<void, Error> check(const LoadedSimulation& loaded,
                                  const std::array<std::size_t, kAxes>& chosen) const;
  tl::expected<void, Error> tryOut(const std::array<std::size_t, kAxes>& chosen,
                                   bool withController) const;
  tl::expected<void, Error> writeTraces(const std::filesystem::path& folder, std::size_t run,
                                        const LoadedSimulation& loaded,
                                        std::span<const rdw::SimulationResult> results) const;
  // The row of a run, its traces written; without an end where it was interrupted, or where they
  // could not be written, which `unwritable` says then. Fails with the reason of a failed run.
  tl::expected<Row, Error> walk(std::size_t run, const CampaignSettings& settings,
                                const std::function<bool()>& interrupted,
                                std::optional<Error>& unwritable) const;
  tl::expected<Manifest, Error> manifest(const CampaignSettings& settings) const;

  ExperimentPlan plan_;
  std::filesystem::path file_;
  std::shared_ptr<SimulationLoader> loader_;
};

/// Joins the folders of all shards into one that one process would have made.
///
/// Fails (kDataDamaged) when folders belong to different experiments (named), runs are missing
/// (named, with their shards) or there twice (named), or as readRows.
[[nodiscard]] tl::expected<Results, Error> mergeShards(
    std::span<const std::filesystem::path> folders, const std::filesystem::path& out);

}  // namespace forewalk::service
