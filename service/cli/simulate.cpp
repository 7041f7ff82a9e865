// forewalk simulate: one walk from a configuration file, as a trace and a summary.
#include "rdw/simulation.h"

#include <fmt/format.h>

#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "service/cli/verb.h"
#include "service/console.h"
#include "service/files.h"
#include "service/parallel.h"
#include "service/simulation_file.h"
#include "service/timing.h"

namespace forewalk::cli {
namespace {

struct SimulateOptions {
  std::filesystem::path config;
  std::filesystem::path trace;
  std::filesystem::path summary;
  bool untimed = false;
};

tl::expected<service::LoadedSimulation, Error> load(const SimulateOptions& options) {
  service::ProgressBar bar("building the scene");
  navmesh::BuildRun run;
  run.forEach = service::onThreads(0);
  run.progress = [&](std::size_t done, std::size_t total) { bar.update(done, total); };
  return service::loadSimulation(options.config, run);
}

/// A crowd of hundreds is worth threads; a few are stepped sooner than threads are woken.
navmesh::ForEach forEachOf(const service::LoadedSimulation& loaded) {
  constexpr std::uint64_t kWorthThreads = 500;
  std::uint64_t agents = 0;
  if (loaded.company) {
    for (const service::CrowdGroup& group : loaded.company->crowd.groups) agents += group.count;
  }
  return agents < kWorthThreads ? navmesh::ForEach{} : service::onThreads(0);
}

/// walk.csv, walk-2.csv, ...; stdout is there for all.
std::filesystem::path ofUser(const std::filesystem::path& file, std::size_t user) {
  if (user == 0 || file == "-") return file;
  std::filesystem::path name = file.stem();
  name += fmt::format("-{}", user + 1);
  name += file.extension();
  return file.parent_path() / name;
}

void report(const rdw::Summary& summary) {
  fmt::print("{}: {:.1f} m in {:.1f} s, {} resets ({:.2f} per 100 m), ended: {}\n",
             summary.controller, summary.virtualMetres, summary.seconds, summary.resets,
             summary.resetsPer100Metres(), rdw::nameOf(summary.end));
  if (const auto& company = summary.company) {
    fmt::print("among {} others: {} collisions, nearest {:.2f} m, ways blocked for {:.1f} s\n",
               company->others, company->collisions, company->minimumSeparation,
               company->blockedSeconds);
  }
}

tl::expected<void, Error> run(const SimulateOptions& options) {
  refuseBothToStdout("--trace", options.trace, "--summary", options.summary);
  for (const std::filesystem::path& file : {options.trace, options.summary}) {
    if (auto writable = service::checkWritable(file); !writable) return writable;
  }
  auto loaded = load(options);
  if (!loaded) return tl::unexpected(std::move(loaded.error()));
  loaded->config.keepFrames = !options.trace.empty();
  for (rdw::SimulationConfig& other : loaded->others) other.keepFrames = !options.trace.empty();
  std::optional<service::ProgressBar> bar("walking");
  const service::Stopwatch watch;
  rdw::SimulationRun simulation;
  if (!options.untimed) simulation.microseconds = [&] { return watch.microseconds(); };
  simulation.progress = [&](double done) {
    bar->update(static_cast<std::size_t>(1000.0 * done), 1000);
  };
  const auto results = service::simulateAll(*loaded, simulation, forEachOf(*loaded));
  bar.reset();
  if (!results) {
    // The simulation knows no file names.
    return tl::unexpected(Error{results.error().code, fmt::format("{}: {}", options.config.string(),
                                                                  results.error().message)});
  }
  for (std::size_t user = 0; user < results->size(); ++user) {
    const rdw::SimulationResult& result = (*results)[user];
    if (!options.trace.empty()) {
      if (auto written =
              service::writeFile(ofUser(options.trace, user), rdw::traceCsv(result.frames));
          !written) {
        return written;
      }
    }
    if (!options.summary.empty()) {
      if (auto written =
              service::writeFile(ofUser(options.summary, user), rdw::summaryJson(result.summary));
          !written) {
        return written;
      }
    }
    if (options.trace == "-" || options.summary == "-") continue;  // stdout is taken
    if (results->size() > 1) fmt::print("user {}, ", user + 1);
    report(result.summary);
  }
  return {};
}

}  // namespace

Verb addSimulate(CLI::App& program) {
  CLI::App* verb =
      program.add_subcommand("simulate", "Walk a simulated user, and record what happened");
  const auto options = std::make_shared<SimulateOptions>();
  verb->add_option("CONFIG", options->config,
                   "forewalk.simulation/1: scene, tracked space, limits, controller, user, seed")
      ->required();
  verb->add_option("--trace", options->trace,
                   "CSV to write, a row per frame; - is stdout; of more users: FILE-2.csv, ...")
      ->check(fileName);
  verb->add_option("--summary", options->summary, "JSON to write, the walk in numbers; - is stdout")
      ->check(fileName);
  verb->add_flag("--untimed", options->untimed,
                 "Leave the times out, so that equal walks give equal files");
  verb->footer(
      "Example: a CONFIG that walks 200 m through an office in a 6 m x 6 m room\n"
      "  {\"format\": \"forewalk.simulation/1\", \"scene\": \"office.obj\",\n"
      "   \"space\": {\"rectangle\": [6, 6]}, \"limits\": \"laboratory\",\n"
      "   \"controller\": \"s2c-predictive\", \"seed\": 1, \"stop\": {\"virtual_m\": 200},\n"
      "   \"user\": {\"kind\": \"wander\"}}\n"
      "  forewalk simulate walk.json --trace walk.csv --summary summary.json\n"
      "Files that CONFIG names lie beside it. Every key is described in rdw/simulation_config.h.");
  return {verb, [options] { return run(*options); }};
}

}  // namespace forewalk::cli
