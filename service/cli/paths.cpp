// forewalk paths: how like people simulated walkers walk.
#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <string>

#include "service/cli/paths_buildings.h"
#include "service/cli/verb.h"
#include "service/console.h"
#include "service/files.h"
#include "service/path_comparison.h"
#include "service/path_tables.h"

namespace forewalk::cli {
namespace {

struct PathsOptions {
  std::vector<std::string> files;
  std::filesystem::path table;
  std::vector<std::string> model;
  std::vector<std::string> groups;
  std::string form = "both";
  BuildingsOptions buildings;
  std::filesystem::path scene;
  service::ComparisonSettings settings;
  std::filesystem::path out;
};

// "NAME=A,B,C"
service::GroupMentions::Group parseGroup(const std::string& text) {
  service::GroupMentions::Group group;
  const std::size_t equals = text.find('=');
  group.name = text.substr(0, equals);
  bool sound = equals != std::string::npos && !group.name.empty();
  for (std::size_t begin = equals + 1; sound;) {
    const std::size_t comma = text.find(',', begin);
    group.members.push_back(text.substr(begin, comma - begin));
    sound = !group.members.back().empty();
    if (comma == std::string::npos) break;
    begin = comma + 1;
  }
  if (!sound) {
    throw CLI::ValidationError(
        "--group", fmt::format("\"{}\" is not NAME=WHO,WHO,..., as in hrvo=u1,u2", text));
  }
  return group;
}

// What cannot be meant together.
void refuseContradictions(const PathsOptions& options) {
  if (!options.buildings.pairs.empty()) {
    const bool others = !options.files.empty() || !options.table.empty() ||
                        !options.model.empty() || !options.groups.empty() || !options.scene.empty();
    if (others) {
      throw CLI::ValidationError("--building",
                                 "says who walks where: leave out paths, --table, --model, --group "
                                 "and --scene");
    }
    return;
  }
  if (options.files.empty() == options.table.empty()) {
    throw CLI::ValidationError(
        "PATHS", options.files.empty() ? "give files of paths, --table with their distances, or "
                                         "--building with recorded people"
                                       : "paths and --table exclude each other; give one");
  }
  if (!options.table.empty() && (options.form != "both" || !options.scene.empty())) {
    throw CLI::ValidationError(
        "--table", "holds distances, not paths: --form and --scene have no effect; leave them out");
  }
  if (!options.scene.empty() && options.out.empty()) {
    throw CLI::ValidationError("--scene", "is drawn in OUT.svg; give --out too");
  }
}

struct Input {
  std::vector<service::ComparedPath> paths;
  std::vector<service::PathGroup> groups;
  std::vector<service::NamedTable> tables;
};

tl::expected<Input, Error> readTable(const PathsOptions& options,
                                     const service::GroupMentions& mentions) {
  const auto bytes = service::readFile(options.table);
  if (!bytes) return tl::unexpected(bytes.error());
  auto read = service::parsePathTables(*bytes, options.table.string());
  if (!read) return tl::unexpected(std::move(read.error()));
  Input input;
  for (std::string& name : read->paths) input.paths.push_back({std::move(name), {}, {}, {}, {}});
  auto groups = service::groupPaths(input.paths, mentions);
  if (!groups) return tl::unexpected(std::move(groups.error()));
  input.groups = std::move(*groups);
  input.tables = std::move(read->tables);
  return input;
}

tl::expected<Input, Error> readPaths(const PathsOptions& options,
                                     const service::GroupMentions& mentions) {
  auto paths = service::readPaths(options.files);
  if (!paths) return tl::unexpected(std::move(paths.error()));
  auto groups = service::groupPaths(*paths, mentions);
  if (!groups) return tl::unexpected(std::move(groups.error()));
  service::ProgressBar bar("comparing paths");
  auto tables =
      service::tablesOf(*paths, options.settings,
                        [&](std::size_t done, std::size_t total) { bar.update(done, total); });
  if (!tables) return tl::unexpected(std::move(tables.error()));
  return Input{std::move(*paths), std::move(*groups), std::move(*tables)};
}

tl::expected<void, Error> run(PathsOptions options) {
  refuseContradictions(options);
  service::GroupMentions mentions{options.model, {}};
  for (const std::string& group : options.groups) mentions.groups.push_back(parseGroup(group));
  options.settings.raw = options.form != "normalised";
  options.settings.normalised = options.form != "raw";
  if (!options.buildings.pairs.empty()) {
    return runBuildings(options.buildings, options.settings, options.out);
  }

  const std::string prefix = options.out.string();
  const bool drawn = !options.files.empty();
  std::vector<std::string> files{prefix + ".csv", prefix + "-distances.csv", prefix + ".json"};
  if (drawn) files.push_back(prefix + ".svg");
  if (!prefix.empty()) {
    for (const std::string& file : files) {
      if (auto writable = service::checkWritable(file); !writable) return writable;
    }
  }
  std::shared_ptr<const navmesh::World> world;
  if (!options.scene.empty()) {
    const auto navMesh = service::loadNavMesh(options.scene);
    if (!navMesh) return tl::unexpected(navMesh.error());
    const auto made = service::makeWorld(*navMesh);
    if (!made) return tl::unexpected(made.error());
    world = *made;
  }
  auto input = drawn ? readPaths(options, mentions) : readTable(options, mentions);
  if (!input) return tl::unexpected(std::move(input.error()));
  const service::PathComparison comparison =
      service::comparePaths(std::move(input->paths), std::move(input->groups),
                            std::move(input->tables), options.settings);
  fmt::print("{}", service::toText(comparison));
  if (prefix.empty()) return {};
  std::vector<std::string> texts{service::toCsv(comparison), service::toDistancesCsv(comparison),
                                 service::toJson(comparison)};
  service::PathPlanFrame frame;
  if (world) frame.floor = &world->graph;
  if (drawn) texts.push_back(service::pathPlan(comparison, frame));
  for (std::size_t i = 0; i < files.size(); ++i) {
    if (auto written = service::writeFile(files[i], texts[i]); !written) return written;
  }
  fmt::print("\nWrote {0}.csv, {0}-distances.csv{1} {0}.json{2}\n", prefix, drawn ? "," : " and",
             drawn ? fmt::format(" and {}.svg", prefix) : "");
  return {};
}

}  // namespace

Verb addPaths(CLI::App& program) {
  CLI::App* verb = program.add_subcommand(
      "paths",
      "How like people simulated walkers walk: distances between paths, and tests of them");
  const auto options = std::make_shared<PathsOptions>();
  verb->add_option("PATHS", options->files,
                   "Files of paths: CSV walker_id,t,x,z; walker_id and t may be missing")
      ->check(fileName);
  verb->add_option("--table", options->table,
                   "Distances instead of paths: JSON with \"paths\" and tables")
      ->check(fileName);
  verb->add_option("--model", options->model,
                   "Whose paths are the model's: a path, a file or a walker; may be repeated")
      ->allow_extra_args(false);
  verb->add_option("--group", options->groups, "One more group, NAME=WHO,WHO,...; may be repeated")
      ->allow_extra_args(false);
  verb->add_option("--form", options->form, "Distances as raw sums, normalised, or both")
      ->check(CLI::IsMember({"raw", "normalised", "both"}))
      ->capture_default_str();
  verb->add_option("--spacing", options->settings.spacing,
                   "Between samples of the normalised form, metres")
      ->check(CLI::Range(0.001, 1000.0))
      ->capture_default_str();
  verb->add_option("--confidence", options->settings.confidence, "Of intervals")
      ->check(CLI::Range(0.5, 0.9999))
      ->capture_default_str();
  verb->add_option("--draws", options->settings.separation.draws,
                   "Labellings of the permutation test: all where there are no more")
      ->check(CLI::Range(std::size_t{100}, std::size_t{10'000'000}))
      ->capture_default_str();
  verb->add_option("--seed", options->settings.separation.seed, "Of the labellings drawn")
      ->check(wholeNumber)
      ->capture_default_str();
  verb->add_option("--threads", options->settings.threads, "0: all cores")
      ->check(wholeNumber)
      ->capture_default_str();
  verb->add_option("--scene", options->scene, "Walkable area to draw under the paths")
      ->check(fileName);
  addBuildingsOptions(*verb, options->buildings);
  verb->add_option("--out", options->out,
                   "Where to write: OUT.csv, OUT-distances.csv, OUT.json, OUT.svg")
      ->check(fileName);
  verb->footer(
      "Examples:\n"
      "  forewalk paths people.csv hrvo.csv social.csv --out out/paths\n"
      "  forewalk paths walks.csv --model u5 --scene house.obj --out out/u5\n"
      "  forewalk paths --table thesis_dtw.json\n"
      "  forewalk paths --building a/scene.obj=a/walks.csv --out out/likeness\n"
      "Whoever is in no group is one of the people. Without --model and --group, a path called\n"
      "\"model\" is the model; else each file is a group, and the first holds the people.");
  return {verb, [options] { return run(*options); }};
}

}  // namespace forewalk::cli
