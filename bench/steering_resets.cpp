// Does predictive steering earn its place? Resets per 100 m over the bundled scenes and many seeds.
//
// Every controller walks the same seeds: the same start, the same goals in the same order. So the
// difference predictive minus reactive is taken seed by seed, which leaves out what the scenes and
// walks have in common; its standard error says how much of it is chance.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <array>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "rdw/simulation.h"
#include "service/cli/method_option.h"
#include "service/console.h"
#include "service/files.h"
#include "service/parallel.h"
#include "service/timing.h"

namespace forewalk {
namespace {

constexpr std::array<const char*, 5> kControllers = {"none", "s2c", "s2c-predictive", "s2o",
                                                     "s2o-predictive"};
constexpr std::array<const char*, 5> kScenes = {"office", "museum", "two_storey", "corridor",
                                                "maze"};

struct Options {
  std::string scenes = "all";
  std::uint32_t seeds = 20;
  std::uint64_t firstSeed = 1;
  double metres = 200.0;
  double room = 6.0;
  std::string limits = "laboratory";
  float horizon = 10.0f;
  prediction::Method method = prediction::Method::kPolygon;
  unsigned threads = 0;
};

// One walk of one controller.
struct Walk {
  std::size_t scene;
  std::size_t controller;
  std::uint64_t seed;
  double resetsPer100Metres = 0.0;
  double metres = 0.0;
  double violationMetres = 0.0;
  bool stuck = false;
  std::uint64_t hash = 0;
  std::string failure{};
};

std::vector<std::string> scenesOf(const std::string& text) {
  if (text == "all") return {kScenes.begin(), kScenes.end()};
  return CLI::detail::split(text, ',');
}

// Resets per 100 m of one controller over all seeds, in the order of seeds; all scenes where
// `scene` is kAllScenes.
constexpr std::size_t kAllScenes = static_cast<std::size_t>(-1);

std::vector<double> resetsOf(const std::vector<Walk>& walks, std::size_t scene,
                             std::size_t controller) {
  std::vector<double> values;
  for (const Walk& walk : walks) {
    if (walk.controller == controller && (scene == kAllScenes || walk.scene == scene)) {
      values.push_back(walk.resetsPer100Metres);
    }
  }
  return values;
}

void printRow(const std::string& name, const std::vector<Walk>& walks, std::size_t scene) {
  fmt::print("{:<12}", name);
  for (std::size_t c = 0; c < kControllers.size(); ++c) {
    const auto values = resetsOf(walks, scene, c);
    fmt::print("  {:>7.2f} +-{:>5.2f}", service::mean(values), service::standardError(values));
  }
  for (const std::size_t reactive : {std::size_t{1}, std::size_t{3}}) {
    const auto before = resetsOf(walks, scene, reactive),
               after = resetsOf(walks, scene, reactive + 1);
    std::vector<double> differences;
    for (std::size_t i = 0; i < before.size(); ++i) differences.push_back(after[i] - before[i]);
    fmt::print("  {:>+7.2f} +-{:>5.2f}", service::mean(differences),
               service::standardError(differences));
  }
  fmt::print("\n");
}

tl::expected<void, Error> run(const Options& options) {
  const auto limits = rdw::gainLimitsByName(options.limits);
  if (!limits) {
    return tl::unexpected(Error{
        ErrorCode::kSettingOutOfRange,
        fmt::format("--limits {}: no such preset. Try laboratory or steinicke.", options.limits)});
  }
  const auto room = rdw::TrackedSpace::rectangle(options.room, options.room);
  if (!room) return tl::unexpected(room.error());
  const std::vector<std::string> names = scenesOf(options.scenes);
  std::vector<std::shared_ptr<const navmesh::World>> worlds;
  std::vector<std::shared_ptr<const prediction::FrontIndex>> fronts;
  for (const std::string& name : names) {
    const std::filesystem::path bundled =
        std::filesystem::path(FOREWALK_ASSETS) / "scenes" / (name + ".obj");
    auto world =
        service::loadNavMesh(std::filesystem::exists(bundled) ? bundled
                                                              : std::filesystem::path(name))
            .and_then([](const navmesh::NavMesh& navMesh) { return service::makeWorld(navMesh); });
    if (!world) return tl::unexpected(std::move(world.error()));
    worlds.push_back(std::move(*world));
    fronts.push_back(rdw::makeFrontIndex(*worlds.back()));
  }

  std::vector<Walk> walks;
  for (std::size_t scene = 0; scene < names.size(); ++scene) {
    for (std::uint64_t seed = 0; seed < options.seeds; ++seed) {
      for (std::size_t controller = 0; controller < kControllers.size(); ++controller) {
        walks.push_back({scene, controller, options.firstSeed + seed});
      }
    }
  }
  const service::Stopwatch watch;
  {
    service::ProgressBar bar("walking");
    std::mutex mutex;
    std::size_t done = 0;
    service::onThreads(options.threads)(walks.size(), [&](std::size_t i) {
      Walk& walk = walks[i];
      rdw::SimulationConfig config;
      config.session.space = *room;
      config.session.limits = *limits;
      config.session.controller = kControllers[walk.controller];
      config.session.horizon = options.horizon;
      config.session.method = options.method;
      config.session.frontIndex = fronts[walk.scene];
      config.session.alwaysPredict = false;
      config.stop.virtualMetres = options.metres;
      config.seed = walk.seed;
      config.keepFrames = false;
      const auto result = rdw::simulate(worlds[walk.scene], config);
      if (!result) {
        walk.failure = result.error().message;
      } else {
        walk.resetsPer100Metres = result->summary.resetsPer100Metres();
        walk.metres = result->summary.virtualMetres;
        walk.violationMetres = result->summary.violationMetres;
        walk.stuck = result->summary.end == rdw::WalkEnd::kStuck;
        walk.hash = result->summary.traceHash;
      }
      const std::lock_guard lock(mutex);
      bar.update(++done, walks.size());
    });
  }
  const double seconds = watch.microseconds() * 1e-6;
  std::uint64_t hash = 0xcbf29ce484222325ull;
  double metres = 0.0, violations = 0.0;
  std::size_t stuck = 0;
  for (const Walk& walk : walks) {
    if (!walk.failure.empty()) return tl::unexpected(Error{ErrorCode::kDataDamaged, walk.failure});
    hash = (hash ^ walk.hash) * 0x100000001b3ull;
    metres += walk.metres;
    violations += walk.violationMetres;
    stuck += walk.stuck;
  }

  fmt::print(
      "Resets per 100 virtual metres in a {0:g} m x {0:g} m room, limits \"{1}\", horizon {2:g} m, "
      "graphs by {4}; {3} "
      "seeds of {5:g} m;\nmean +- standard error over seeds. Predictive minus reactive is paired "
      "by "
      "seed: below 0, prediction helps.\n\n",
      options.room, options.limits, options.horizon, options.seeds,
      options.method == prediction::Method::kFront ? "fronts" : "polygons", options.metres);
  fmt::print("{:<12}  {:>15}  {:>15}  {:>15}  {:>15}  {:>15}  {:>15}  {:>15}\n", "", "none",
             "S2C reactive", "S2C predictive", "S2O reactive", "S2O predictive", "S2C pred-react",
             "S2O pred-react");
  for (std::size_t scene = 0; scene < names.size(); ++scene) {
    printRow(std::filesystem::path(names[scene]).stem().string(), walks, scene);
  }
  printRow("all", walks, kAllScenes);
  fmt::print(
      "\n{} walks, {:.0f} m in {:.1f} s; {:.2f} m walked outside the room; {} ended stuck; traces "
      "{:016x}\n",
      walks.size(), metres, seconds, violations, stuck, hash);
  return {};
}

}  // namespace
}  // namespace forewalk

int main(int argc, char** argv) {
  forewalk::Options options;
  CLI::App program("Resets per 100 m: no steering, reactive and predictive S2C and S2O.",
                   "steering_resets");
  program.add_option("--scenes", options.scenes, "all, or names or files with commas between")
      ->capture_default_str();
  program.add_option("--seeds", options.seeds, "Walks of each controller in each scene")
      ->check(CLI::Range(1, 100000))
      ->capture_default_str();
  program.add_option("--first-seed", options.firstSeed, "Of the walks")->capture_default_str();
  program.add_option("--metres", options.metres, "Of a walk, virtual metres")
      ->check(CLI::Range(1.0, 1e6))
      ->capture_default_str();
  program.add_option("--room", options.room, "Side of the square room, metres")
      ->capture_default_str();
  program.add_option("--limits", options.limits, "Preset of gain limits")->capture_default_str();
  program.add_option("--horizon", options.horizon, "Of prediction, metres")->capture_default_str();
  forewalk::cli::addMethodOption(program, options.method);
  program.add_option("--threads", options.threads, "0: all cores; results do not depend on it")
      ->capture_default_str();
  CLI11_PARSE(program, argc, argv);
  if (const auto result = forewalk::run(options); !result) {
    forewalk::service::printError(result.error().message);
    return 1;
  }
  return 0;
}
