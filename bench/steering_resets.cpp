// Does steering earn its place? Resets per 100 m of controllers over rooms, scenes and many seeds.
//
// Every controller walks the same seeds: the same start, the same goals in the same order. So
// differences are taken walk by walk, which leaves out what the scenes and walks have in common;
// their 95 % interval says how much of them is chance. Scene "plane" is the empty plane of the
// published simulations: legs of 2 to 8 m with any turn between them.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "rdw/reset_policy.h"
#include "rdw/simulation.h"
#include "service/cli/method_option.h"
#include "service/console.h"
#include "service/files.h"
#include "service/parallel.h"
#include "service/timing.h"

namespace forewalk {
namespace {

struct Options {
  std::string scenes = "office,museum,two_storey,corridor,maze";
  std::string controllers = "none,s2c,s2c-predictive,s2o,s2o-predictive";
  std::string rooms = "6x6";
  std::string limits = "laboratory";
  std::string csv;
  std::uint32_t seeds = 20;
  std::uint64_t firstSeed = 1;
  double metres = 200.0;
  double rate = 90.0;
  float horizon = 10.0f;
  prediction::Method method = prediction::Method::kPolygon;
  unsigned threads = 0;
};

// One walk of one controller. The rest are indices of what is asked for.
struct Walk {
  std::size_t limits, room, scene, controller;
  std::uint64_t seed;
  double resetsPer100Metres = 0.0;
  double metres = 0.0;
  double violationMetres = 0.0;
  bool stuck = false;
  std::uint64_t hash = 0;
  std::string failure{};
};

// What is walked: every combination of these.
struct Campaign {
  std::vector<std::string> limits, rooms, scenes, controllers;
  std::vector<rdw::GainLimits> limitsOf;
  std::vector<rdw::TrackedSpace> spaceOf;
  std::vector<std::shared_ptr<const navmesh::World>> worldOf;  // null: the plane
  std::vector<std::shared_ptr<const prediction::FrontIndex>> frontsOf;
};

tl::unexpected<Error> refused(std::string message) {
  return tl::unexpected(Error{ErrorCode::kSettingOutOfRange, std::move(message)});
}

// NAME, with 2:1 turns, or NAME/RESET.
std::string controllerOf(const std::string& name) { return name.substr(0, name.find('/')); }

std::string resetOf(const std::string& name) {
  const std::size_t slash = name.find('/');
  return slash == std::string::npos ? "two-one-turn" : name.substr(slash + 1);
}

// WxD, metres; L: 8 m x 8 m without a quarter; furnished: 6 m x 6 m with two pieces of furniture.
tl::expected<rdw::TrackedSpace, Error> roomOf(const std::string& name) {
  using Ring = std::vector<glm::dvec2>;
  if (name == "L") {
    return rdw::TrackedSpace::polygon(Ring{{-4, -4}, {4, -4}, {4, 0}, {0, 0}, {0, 4}, {-4, 4}});
  }
  if (name == "furnished") {
    const std::vector<Ring> furniture{{{1.2, 1.0}, {2.4, 1.0}, {2.4, 1.8}, {1.2, 1.8}},
                                      {{-2.2, -1.6}, {-1.4, -1.6}, {-1.4, -0.4}, {-2.2, -0.4}}};
    return rdw::TrackedSpace::polygon(Ring{{-3, -3}, {3, -3}, {3, 3}, {-3, 3}}, furniture);
  }
  double width = 0.0, depth = 0.0;
  if (std::sscanf(name.c_str(), "%lfx%lf", &width, &depth) != 2) {
    return refused(fmt::format("--rooms {}: no such room. Try 6x6, L or furnished.", name));
  }
  return rdw::TrackedSpace::rectangle(width, depth);
}

tl::expected<Campaign, Error> campaignOf(const Options& options) {
  Campaign campaign;
  campaign.limits = CLI::detail::split(options.limits, ',');
  campaign.rooms = CLI::detail::split(options.rooms, ',');
  campaign.scenes = CLI::detail::split(options.scenes, ',');
  campaign.controllers = CLI::detail::split(options.controllers, ',');
  for (const std::string& name : campaign.controllers) {
    if (auto made = rdw::makeController(controllerOf(name)); !made) {
      return tl::unexpected(made.error());
    }
    if (auto made = rdw::makeReset(resetOf(name)); !made) return tl::unexpected(made.error());
  }
  for (const std::string& name : campaign.limits) {
    const auto limits = rdw::gainLimitsByName(name);
    if (!limits) return refused(fmt::format("--limits {}: no such preset. Try steinicke.", name));
    campaign.limitsOf.push_back(*limits);
  }
  for (const std::string& name : campaign.rooms) {
    auto room = roomOf(name);
    if (!room) return tl::unexpected(room.error());
    campaign.spaceOf.push_back(std::move(*room));
  }
  for (const std::string& name : campaign.scenes) {
    campaign.worldOf.emplace_back();
    campaign.frontsOf.emplace_back();
    if (name == "plane") continue;
    const std::filesystem::path bundled =
        std::filesystem::path(FOREWALK_ASSETS) / "scenes" / (name + ".obj");
    auto world =
        service::loadNavMesh(std::filesystem::exists(bundled) ? bundled
                                                              : std::filesystem::path(name))
            .and_then([](const navmesh::NavMesh& navMesh) { return service::makeWorld(navMesh); });
    if (!world) return tl::unexpected(std::move(world.error()));
    campaign.worldOf.back() = std::move(*world);
    campaign.frontsOf.back() = rdw::makeFrontIndex(*campaign.worldOf.back());
  }
  return campaign;
}

void walkOne(const Campaign& campaign, const Options& options, Walk& walk) {
  rdw::SimulationConfig config;
  config.session.space = campaign.spaceOf[walk.room];
  config.session.limits = campaign.limitsOf[walk.limits];
  const std::string& name = campaign.controllers[walk.controller];
  config.session.controller = controllerOf(name);
  config.session.resetPolicy = resetOf(name);
  config.session.horizon = options.horizon;
  config.session.method = options.method;
  config.session.frontIndex = campaign.frontsOf[walk.scene];
  config.session.alwaysPredict = false;
  config.stop.virtualMetres = options.metres;
  config.rate = options.rate;
  config.seed = walk.seed;
  config.keepFrames = false;
  if (campaign.worldOf[walk.scene] == nullptr) {
    config.user.plan = rdw::Legs{2.0, 8.0, rdw::kPi, false};
  }
  const auto result = rdw::simulate(campaign.worldOf[walk.scene], config);
  if (!result) {
    walk.failure = result.error().message;
    return;
  }
  walk.resetsPer100Metres = result->summary.resetsPer100Metres();
  walk.metres = result->summary.virtualMetres;
  walk.violationMetres = result->summary.violationMetres;
  walk.stuck = result->summary.end == rdw::WalkEnd::kStuck;
  walk.hash = result->summary.traceHash;
}

// Resets per 100 m of one controller over all seeds, in the order of scenes and seeds; all scenes
// where `scene` is kAllScenes.
constexpr std::size_t kAllScenes = static_cast<std::size_t>(-1);

std::vector<double> resetsOf(const std::vector<Walk>& walks, const Walk& like, std::size_t scene,
                             std::size_t controller) {
  std::vector<double> values;
  for (const Walk& walk : walks) {
    if (walk.limits == like.limits && walk.room == like.room && walk.controller == controller &&
        (scene == kAllScenes || walk.scene == scene)) {
      values.push_back(walk.resetsPer100Metres);
    }
  }
  return values;
}

// Each controller's mean, and how much it differs from the first of the table in per cent.
void printRow(const std::string& name, const Campaign& campaign, const std::vector<Walk>& walks,
              const Walk& like, std::size_t scene) {
  fmt::print("  {:<11}", name);
  const auto reference = resetsOf(walks, like, scene, 0);
  for (std::size_t c = 0; c < campaign.controllers.size(); ++c) {
    const auto values = resetsOf(walks, like, scene, c);
    std::vector<double> differences;
    for (std::size_t i = 0; i < values.size(); ++i) {
      differences.push_back(values[i] - reference[i]);
    }
    const double percent = 100.0 / std::max(service::mean(reference), 1e-9);
    fmt::print("  {:>6.2f} {:>+6.1f}+-{:<4.1f}%", service::mean(values),
               percent * service::mean(differences),
               1.96 * percent * service::standardError(differences));
  }
  fmt::print("\n");
}

void printTable(const Campaign& campaign, const std::vector<Walk>& walks, const Walk& like) {
  fmt::print("\n{} m, {}\n  {:<11}", campaign.rooms[like.room], campaign.limits[like.limits], "");
  for (const std::string& name : campaign.controllers) fmt::print("  {:>20}", name);
  fmt::print("\n");
  for (std::size_t scene = 0; scene < campaign.scenes.size(); ++scene) {
    printRow(std::filesystem::path(campaign.scenes[scene]).stem().string(), campaign, walks, like,
             scene);
  }
  if (campaign.scenes.size() > 1) printRow("all", campaign, walks, like, kAllScenes);
}

tl::expected<void, Error> writeCsv(const Campaign& campaign, const std::vector<Walk>& walks,
                                   const std::string& path) {
  std::string text = "limits,room,scene,controller,seed,resets_per_100_m,metres\n";
  for (const Walk& walk : walks) {
    text += fmt::format("{},{},{},{},{},{},{}\n", campaign.limits[walk.limits],
                        campaign.rooms[walk.room], campaign.scenes[walk.scene],
                        campaign.controllers[walk.controller], walk.seed, walk.resetsPer100Metres,
                        walk.metres);
  }
  return service::writeFile(path, text);
}

tl::expected<void, Error> run(const Options& options) {
  auto campaign = campaignOf(options);
  if (!campaign) return tl::unexpected(campaign.error());
  std::vector<Walk> walks;
  for (std::size_t limits = 0; limits < campaign->limits.size(); ++limits) {
    for (std::size_t room = 0; room < campaign->rooms.size(); ++room) {
      for (std::size_t scene = 0; scene < campaign->scenes.size(); ++scene) {
        for (std::uint64_t seed = 0; seed < options.seeds; ++seed) {
          for (std::size_t c = 0; c < campaign->controllers.size(); ++c) {
            walks.push_back({limits, room, scene, c, options.firstSeed + seed});
          }
        }
      }
    }
  }
  const service::Stopwatch watch;
  {
    service::ProgressBar bar("walking");
    std::mutex mutex;
    std::size_t done = 0;
    service::onThreads(options.threads)(walks.size(), [&](std::size_t i) {
      walkOne(*campaign, options, walks[i]);
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
      "Resets per 100 virtual metres: mean, and difference from {} in per cent with its 95 % "
      "interval,\npaired by walk. Horizon {:g} m, graphs by {}; {} seeds of {:g} m.\n",
      campaign->controllers[0], options.horizon,
      options.method == prediction::Method::kFront ? "fronts" : "polygons", options.seeds,
      options.metres);
  for (std::size_t limits = 0; limits < campaign->limits.size(); ++limits) {
    for (std::size_t room = 0; room < campaign->rooms.size(); ++room) {
      printTable(*campaign, walks, {limits, room, 0, 0, 0});
    }
  }
  fmt::print(
      "\n{} walks, {:.0f} m in {:.1f} s; {:.2f} m walked outside the room; {} ended stuck; traces "
      "{:016x}\n",
      walks.size(), metres, seconds, violations, stuck, hash);
  if (!options.csv.empty()) return writeCsv(*campaign, walks, options.csv);
  return {};
}

}  // namespace
}  // namespace forewalk

int main(int argc, char** argv) {
  forewalk::Options options;
  CLI::App program("Resets per 100 m of controllers over rooms, scenes and seeds.",
                   "steering_resets");
  program.add_option("--scenes", options.scenes, "Names or files with commas between, or plane")
      ->capture_default_str();
  program
      .add_option("--controllers", options.controllers,
                  "NAME or NAME/RESET; the first is what others differ from")
      ->capture_default_str();
  program.add_option("--rooms", options.rooms, "WxD in metres, L, furnished; commas between")
      ->capture_default_str();
  program.add_option("--seeds", options.seeds, "Walks of each controller in each scene")
      ->check(CLI::Range(1, 100000))
      ->capture_default_str();
  program.add_option("--first-seed", options.firstSeed, "Of the walks")->capture_default_str();
  program.add_option("--metres", options.metres, "Of a walk, virtual metres")
      ->check(CLI::Range(1.0, 1e6))
      ->capture_default_str();
  program.add_option("--rate", options.rate, "Frames per second")->capture_default_str();
  program.add_option("--limits", options.limits, "Presets of gain limits, commas between")
      ->capture_default_str();
  program.add_option("--horizon", options.horizon, "Of prediction, metres")->capture_default_str();
  program.add_option("--csv", options.csv, "Every walk, to this file");
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
