// Do ways keep their names? How many are born, die, split and merge per metre walked along recorded
// walks, for both methods under the same settings (prediction/way_tracker.h).
//
// Where ways truly part or come together, splits and merges are right: the walk passes a junction.
// Births and deaths come from nowhere: they are what a method makes up, or the tracker lost.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "service/cli/walks_options.h"
#include "service/console.h"
#include "service/files.h"
#include "service/recording.h"
#include "service/timing.h"

namespace forewalk {
namespace {

struct Options {
  std::vector<std::string> pairs;
  std::vector<float> horizons{3.0f, 5.0f, 10.0f, 20.0f};
  prediction::WayTrackerSettings ways;
};

service::WayTurnover turnoverOf(const navmesh::World& world, const std::vector<rdw::Walk>& walks,
                                const service::MethodFactory& method, float horizon,
                                const prediction::WayTrackerSettings& ways) {
  service::RecordingSettings settings;
  settings.horizon = horizon;
  settings.sampleEvery = 1e6;  // no samples: only names are looked at
  settings.ways = ways;
  service::WayTurnover sum;
  for (const auto& walk : service::recordAll(world, walks, method, settings)) sum += walk.turnover;
  return sum;
}

tl::expected<void, Error> run(const Options& options) {
  fmt::print("Per metre walked; gate {:g} m, linger {:g} m\n\n{:<16} {:>4}", options.ways.gate,
             options.ways.linger, "", "d");
  for (const char* method : {"polygon", "front"}) {
    fmt::print("  | {:<8} {:>6} {:>6} {:>6} {:>6} {:>6}", method, "born", "died", "split", "merged",
               "back");
  }
  fmt::print("  | front/polygon {:>11} {:>11}\n", "born+died", "all four");
  for (const std::string& text : options.pairs) {
    const cli::SceneAndWalks pair = cli::parseSceneAndWalks("SCENE=WALKS", text);
    const auto walks = cli::loadWalks(pair.walks);
    if (!walks) return tl::unexpected(walks.error());
    const auto world = service::loadNavMesh(pair.scene).and_then([](const auto& mesh) {
      return service::makeWorld(mesh);
    });
    if (!world) return tl::unexpected(world.error());
    for (const float horizon : options.horizons) {
      fmt::print("{:<16} {:>4g}", pair.scene.parent_path().filename().string(), horizon);
      std::array<double, 2> made{}, changes{};
      for (std::size_t m = 0; m < 2; ++m) {
        const auto turnover =
            turnoverOf(**world, *walks, m == 0 ? service::polygonMethod : service::frontMethod,
                       horizon, options.ways);
        const auto perMetre = [&](std::size_t count) {
          return static_cast<double>(count) / turnover.metres;
        };
        fmt::print("  | {:8} {:6.3f} {:6.3f} {:6.3f} {:6.3f} {:6.3f}", "",
                   perMetre(turnover.births), perMetre(turnover.deaths), perMetre(turnover.splits),
                   perMetre(turnover.merges), perMetre(turnover.returns));
        made[m] = perMetre(turnover.births + turnover.deaths);
        changes[m] = made[m] + perMetre(turnover.splits + turnover.merges);
      }
      fmt::print("  | {:13} {:11.3f} {:11.3f}\n", "", made[1] / made[0], changes[1] / changes[0]);
    }
  }
  return {};
}

}  // namespace
}  // namespace forewalk

int main(int argc, char** argv) {
  forewalk::Options options;
  CLI::App program("How often ways change their names along recorded walks, by method.",
                   "way_names");
  program.add_option("SCENE=WALKS", options.pairs,
                     "Scenes, each with a CSV of walks in it; default: those in shared data");
  program.add_option("--horizons", options.horizons, "How far ways go, metres")
      ->delimiter(',')
      ->capture_default_str();
  program.add_option("--gate", options.ways.gate, "How far an end may lie off, metres")
      ->check(CLI::Range(0.01f, 100.0f))
      ->capture_default_str();
  program.add_option("--linger", options.ways.linger, "How long a name is kept, metres walked")
      ->check(CLI::Range(0.0f, 1000.0f))
      ->capture_default_str();
  CLI11_PARSE(program, argc, argv);
  if (options.pairs.empty()) {
    const std::filesystem::path walks = std::filesystem::path(FOREWALK_SHARED_DATA) / "walks";
    for (const char* name : {"searching-a", "searching-b"}) {
      const auto folder = walks / name;
      if (!std::filesystem::exists(folder)) {
        fmt::print(stderr, "no walks under {}: name SCENE=WALKS\n", walks.string());
        return 1;
      }
      options.pairs.push_back((folder / "scene.obj").string() + "=" +
                              (folder / "walks.csv").string());
    }
  }
  if (const auto result = forewalk::run(options); !result) {
    forewalk::service::printError(result.error().message);
    return 1;
  }
  return 0;
}
