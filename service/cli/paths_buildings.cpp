#include "service/cli/paths_buildings.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "navmesh/locate.h"
#include "navmesh/plan.h"
#include "service/cli/walks_options.h"
#include "service/console.h"
#include "service/files.h"
#include "service/likeness.h"

namespace forewalk::cli {
namespace {

// Whoever lies farther off than this was not recorded here.
constexpr navmesh::SnapLimits kOnFloor{0.5f, 2.2f, 2.2f};

tl::expected<void, Error> checkOnFloor(const service::RecordedBuilding& building,
                                       const SceneAndWalks& pair) {
  std::size_t samples = 0, off = 0;
  for (const rdw::Walk& walk : building.walks) {
    for (const rdw::WalkSample& sample : walk.samples) {
      ++samples;
      off += !navmesh::locate(building.world->graph, building.world->locations,
                              navmesh::toSpace(glm::vec2(sample.plan), 0.0f), kOnFloor);
    }
  }
  if (2 * off <= samples) return {};
  return tl::unexpected(
      Error{ErrorCode::kPositionOffNavMesh,
            fmt::format("{}: {:.0f} % of its samples lie off the navmesh of {}. Give the scene "
                        "that was walked in.",
                        pair.walks.string(),
                        100.0 * static_cast<double>(off) / static_cast<double>(samples),
                        pair.scene.string())});
}

// After the folder that holds the walks, which tells recordings apart that are all "walks.csv".
std::string nameOf(const std::filesystem::path& walks,
                   const std::vector<service::RecordedBuilding>& others) {
  const std::string folder = walks.parent_path().filename().string();
  const std::string name = folder.empty() ? walks.stem().string() : folder;
  std::string unique = name;
  for (int k = 2; std::any_of(others.begin(), others.end(),
                              [&](const auto& other) { return other.name == unique; });
       ++k) {
    unique = fmt::format("{}-{}", name, k);
  }
  return unique;
}

// "test 1, 8 objects": "test-1-8-objects"
std::string fileWords(const std::string& name) {
  std::string words;
  for (const char c : name) {
    const bool plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
    if (plain) {
      words += c;
    } else if (!words.empty() && words.back() != '-') {
      words += '-';
    }
  }
  return words;
}

}  // namespace

void addBuildingsOptions(CLI::App& verb, BuildingsOptions& options) {
  CLI::Option* building =
      verb.add_option("--building", options.pairs,
                      "Recorded people in a building, SCENE=WALKS: cut into legs, which every "
                      "model walks too; may be repeated")
          ->allow_extra_args(false);
  verb.add_option("--rest", options.rule.restSeconds,
                  "Who stays within half a metre for so long rests, seconds")
      ->check(CLI::Range(0.1, 600.0))
      ->capture_default_str()
      ->needs(building);
  verb.add_option("--region", options.rule.regionRadius,
                  "Radius of the places that legs begin and end at, metres")
      ->check(CLI::Range(0.1, 100.0))
      ->capture_default_str()
      ->needs(building);
  verb.add_option("--leg", options.rule.shortest, "Shortest leg, metres")
      ->check(CLI::Range(0.1, 10000.0))
      ->capture_default_str()
      ->needs(building);
  verb.add_option("--detour", options.rule.detour,
                  "Longest leg, in shortest ways from its start to its end")
      ->check(CLI::Range(1.0, 100.0))
      ->capture_default_str()
      ->needs(building);
  verb.add_option("--people", options.rule.walkers, "Fewest people in a set of legs")
      ->check(CLI::Range(2, 1000))
      ->capture_default_str()
      ->needs(building);
}

tl::expected<void, Error> runBuildings(const BuildingsOptions& options,
                                       const service::ComparisonSettings& settings,
                                       const std::filesystem::path& out) {
  const std::string prefix = out.string();
  if (!prefix.empty()) {
    if (auto writable = service::checkWritable(prefix + ".csv"); !writable) return writable;
  }
  std::vector<service::RecordedBuilding> buildings;
  for (const std::string& text : options.pairs) {
    const SceneAndWalks pair = parseSceneAndWalks("--building", text);
    auto walks = loadWalks(pair.walks);
    if (!walks) return tl::unexpected(std::move(walks.error()));
    const auto navMesh = service::loadNavMesh(pair.scene);
    if (!navMesh) return tl::unexpected(navMesh.error());
    auto world = service::makeWorld(*navMesh);
    if (!world) return tl::unexpected(std::move(world.error()));
    service::RecordedBuilding building{nameOf(pair.walks, buildings), std::move(*walks),
                                       std::move(*world), navMesh->settings.radius};
    if (auto on = checkOnFloor(building, pair); !on) return on;
    buildings.push_back(std::move(building));
  }
  auto likeness = [&] {
    service::ProgressBar bar("walking in people's place");
    return service::compareWithPeople(
        buildings, service::sentWalkers(), options.rule, settings,
        [&](std::size_t done, std::size_t total) { bar.update(done, total); });
  }();
  if (!likeness) return tl::unexpected(std::move(likeness.error()));
  likeness->scenes = service::compareInScenes(settings.spacing, settings.threads);
  fmt::print("{}", service::toText(*likeness));
  if (prefix.empty()) return {};

  std::vector<std::pair<std::string, std::string>> files{
      {prefix + ".csv", service::toCsv(*likeness)},
      {prefix + ".json", service::toJson(*likeness)},
      {prefix + "-paths.csv", service::toPathsCsv(*likeness)}};
  for (std::size_t b = 0; b < buildings.size(); ++b) {
    files.emplace_back(fmt::format("{}-{}.svg", prefix, fileWords(buildings[b].name)),
                       service::likenessPlan(*likeness, b, buildings[b].world->graph));
  }
  for (const service::SceneLikeness& scene : likeness->scenes) {
    files.emplace_back(fmt::format("{}-{}.svg", prefix, fileWords(std::string(scene.scene->name))),
                       service::scenePlan(scene));
  }
  std::string written;
  for (const auto& [file, text] : files) {
    if (auto wrote = service::writeFile(file, text); !wrote) return wrote;
    written += (written.empty() ? "" : ", ") + file;
  }
  fmt::print("\nWrote {}\n", written);
  return {};
}

}  // namespace forewalk::cli
