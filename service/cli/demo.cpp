// forewalk demo: the main job on a bundled building, with one table and pictures to open.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "navmesh/plan.h"
#include "prediction/dump.h"
#include "prediction/front_graph.h"
#include "prediction/plan_drawing.h"
#include "prediction/predict.h"
#include "rdw/simulation.h"
#include "service/cli/bundled.h"
#include "service/cli/method_option.h"
#include "service/cli/verb.h"
#include "service/console.h"
#include "service/files.h"
#include "service/parallel.h"
#include "service/plot.h"
#include "service/sweep.h"
#include "service/timing.h"
#include "service/walk_plan.h"

namespace forewalk::cli {
namespace {

constexpr double kRoomSide = 6.0;              // metres
constexpr const char* kLimits = "laboratory";  // curvature 1/7.5 per metre
constexpr float kDumpHorizon = 20.0f;          // metres; the paper's

struct DemoOptions {
  std::vector<std::string> scenes{"office", "museum"};
  double metres = 200.0;
  std::uint32_t walks = 3;
  std::uint64_t seed = 1;
  prediction::Method method = prediction::Method::kPolygon;
  std::filesystem::path out = "out";
};

// All walks of one controller in one building.
struct Walks {
  std::string name;  // for people
  std::string stem;  // for files
  std::string controller;
  double virtualMetres = 0.0;
  std::uint64_t resets = 0;
  double translation = 0.0, rotation = 0.0, curvature = 0.0;  // means over walks
  std::vector<double> graphTimes{}, frameTimes{};             // of every frame, microseconds
  std::vector<rdw::FrameRecord> frames{};                     // of the first walk
  rdw::Summary first{};

  double metresBetweenResets() const {
    return resets == 0 ? virtualMetres : virtualMetres / static_cast<double>(resets);
  }
  double resetsPer100Metres() const {
    return virtualMetres > 0 ? 100.0 * static_cast<double>(resets) / virtualMetres : 0.0;
  }
};

std::vector<Walks> controllers() {
  return {{"no steering", "none", "none"},
          {"S2C reactive", "s2c", "s2c"},
          {"S2C predictive", "s2c_predictive", "s2c-predictive"},
          {"S2O reactive", "s2o", "s2o"},
          {"S2O predictive", "s2o_predictive", "s2o-predictive"}};
}

struct Building {
  std::string name;
  std::shared_ptr<const navmesh::World> world;
  std::shared_ptr<const prediction::FrontIndex> frontIndex{};
  double area = 0.0;   // walkable, m^2
  glm::dvec2 size{0};  // metres
};

tl::expected<Building, Error> loadBuilding(const std::string& scene) {
  const auto file = sceneFile(scene);
  if (!file) return tl::unexpected(file.error());
  Building building;
  building.name = file->stem().string();
  {
    service::ProgressBar bar("building " + building.name);
    navmesh::BuildRun run;
    run.forEach = service::onThreads(0);
    run.progress = [&](std::size_t done, std::size_t total) { bar.update(done, total); };
    const auto navMesh = service::loadNavMesh(*file, {}, {}, run);
    if (!navMesh) return tl::unexpected(navMesh.error());
    auto world = service::makeWorld(*navMesh);
    if (!world) return tl::unexpected(std::move(world.error()));
    building.world = std::move(*world);
  }
  const navmesh::NavGraph& graph = building.world->graph;
  for (std::uint32_t p = 0; p < graph.polygonCount(); ++p) {
    building.area += navmesh::areaOf(graph, navmesh::PolygonId{p});
  }
  building.size = prediction::boundsOf(graph).size();
  building.frontIndex = rdw::makeFrontIndex(*building.world);
  return building;
}

tl::expected<void, Error> walk(const Building& building, const DemoOptions& options,
                               const rdw::TrackedSpace& room, Walks& walks,
                               const std::function<void()>& walked) {
  const service::Stopwatch watch;
  rdw::SimulationRun run;
  run.microseconds = [&] { return watch.microseconds(); };
  for (std::uint32_t i = 0; i < options.walks; ++i) {
    rdw::SimulationConfig config;
    config.session.space = room;
    config.session.limits = *rdw::gainLimitsByName(kLimits);
    config.session.controller = walks.controller;
    config.session.method = options.method;
    config.session.frontIndex = building.frontIndex;
    config.stop.virtualMetres = options.metres;
    config.seed = options.seed + i;
    auto result = rdw::simulate(building.world, config, run);
    if (!result) return tl::unexpected(std::move(result.error()));
    const rdw::Summary& summary = result->summary;
    const double share = 1.0 / options.walks;
    walks.virtualMetres += summary.virtualMetres;
    walks.resets += summary.resets;
    walks.translation += share * summary.meanTranslation;
    walks.rotation += share * summary.meanRotationOffset;
    walks.curvature += share * summary.meanCurvature;
    for (const rdw::FrameRecord& frame : result->frames) {
      if (frame.graphNodes > 0) walks.graphTimes.push_back(frame.predictMicroseconds);
      walks.frameTimes.push_back(frame.frameMicroseconds);
    }
    if (i == 0) {
      walks.first = summary;
      walks.frames = std::move(result->frames);
    }
    walked();
  }
  return {};
}

std::string tableOf(const Building& building, const DemoOptions& options, std::vector<Walks>& all) {
  std::string table = fmt::format(
      "{}: {:.0f} m x {:.0f} m building, {:.0f} m^2 walkable, in a {:g} m x {:g} m room; {} {} of "
      "{:g} m, "
      "limits \"{}\"\n",
      building.name, building.size.x, building.size.y, building.area, kRoomSide, kRoomSide,
      options.walks, options.walks == 1 ? "walk" : "walks", options.metres, kLimits);
  table +=
      "                 virtual          metres per  mean gains                          graph, us "
      "       "
      "frame, us\n"
      "controller             m  resets       reset  translation  |rotation-1|  |curv| 1/m  median "
      "   99 %  "
      "   median\n";
  for (Walks& walks : all) {
    table += fmt::format(
        "{:<14}  {:>7.0f} {:>7} {:>11.2f} {:>12.3f} {:>13.3f} {:>11.4f} {:>7.1f} {:>7.1f} "
        "{:>10.1f}\n",
        walks.name, walks.virtualMetres, walks.resets, walks.metresBetweenResets(),
        walks.translation, walks.rotation, walks.curvature,
        service::quantile(walks.graphTimes, 0.5), service::quantile(walks.graphTimes, 0.99),
        service::quantile(walks.frameTimes, 0.5));
  }
  return table;
}

// Everything about one building that is to be looked at. Returns the first failure to write.
class Pictures {
 public:
  explicit Pictures(std::filesystem::path folder) : folder_(std::move(folder)) {}

  void write(const std::string& name, std::string_view text) {
    if (!written_) return;
    written_ = service::writeFile(folder_ / name, text);
  }
  const tl::expected<void, Error>& written() const { return written_; }

 private:
  std::filesystem::path folder_;
  tl::expected<void, Error> written_;
};

// By both methods, to be compared.
void drawPrediction(Pictures& pictures, const Building& building,
                    const std::vector<rdw::FrameRecord>& frames) {
  // From where the first walk began: a place that a user really stood at.
  const navmesh::NavGraph& graph = building.world->graph;
  if (frames.empty()) return;
  const glm::vec2 plan = frames.front().virtualPosition;
  navmesh::SnapLimits anyHeight;
  anyHeight.below = anyHeight.above = 1e6f;
  const auto place =
      navmesh::locate(graph, building.world->locations, navmesh::toSpace(plan, 0.0f), anyHeight);
  if (!place) return;
  const auto write = [&](const std::string& stem, const std::string& how, const auto& predict) {
    predict();  // buffers grow
    const service::Stopwatch watch;
    const prediction::PredictionGraph& ways = predict();
    const double microseconds = watch.microseconds();
    const std::string title =
        fmt::format("Ways ahead within {:g} m{}: {}", kDumpHorizon, how, building.name);
    const prediction::PlanText text{title, static_cast<float>(frames.front().virtualHeading)};
    pictures.write(stem + ".svg", prediction::toSvg(graph, ways, text));
    pictures.write(stem + ".json", prediction::toJson(graph, ways, microseconds));
    pictures.write(stem + ".graphml", prediction::toGraphml(ways));
    pictures.write(stem + ".dot", prediction::toDot(ways));
  };
  prediction::Scratch polygons(graph);
  write("prediction", "", [&]() -> const prediction::PredictionGraph& {
    return prediction::predict(graph, *place, kDumpHorizon, polygons);
  });
  prediction::FrontScratch fronts(graph, *building.frontIndex);
  write("prediction_front", ", by fronts", [&]() -> const prediction::PredictionGraph& {
    return prediction::predictFronts(graph, *place, kDumpHorizon, fronts);
  });
}

void drawWalks(Pictures& pictures, const Building& building, const rdw::TrackedSpace& room,
               const std::vector<Walks>& all) {
  for (const Walks& walks : all) {
    const std::string subtitle = fmt::format(
        "{:.0f} m walked, {} {}, {:.2f} m between resets; limits \"{}\", room {:g} m x {:g} m",
        walks.first.virtualMetres, walks.first.resets, walks.first.resets == 1 ? "reset" : "resets",
        walks.first.metresBetweenResets(), kLimits, kRoomSide, kRoomSide);
    pictures.write("virtual_" + walks.stem + ".svg",
                   service::virtualPlan(building.world->graph, walks.frames,
                                        building.name + ", virtual path: " + walks.name, subtitle));
    pictures.write(
        "room_" + walks.stem + ".svg",
        service::physicalPlan(room, walks.frames, "In the room: " + walks.name, subtitle));
    pictures.write("trace_" + walks.stem + ".csv", rdw::traceCsv(walks.frames));
    pictures.write("summary_" + walks.stem + ".json", rdw::summaryJson(walks.first));
  }
  service::BarPlot plot;
  plot.title = "Resets per 100 m: " + building.name;
  plot.subtitle = fmt::format("{:g} m x {:g} m room, limits \"{}\"; fewer is better", kRoomSide,
                              kRoomSide, kLimits);
  plot.yName = "resets per 100 virtual metres";
  plot.barNames = {"none", "reactive", "predictive"};
  plot.colours = {"#aab3bd", "#6f9bd8", "#1f9d55"};
  plot.groups = {
      {"S2C",
       {all[0].resetsPer100Metres(), all[1].resetsPer100Metres(), all[2].resetsPer100Metres()}},
      {"S2O",
       {all[0].resetsPer100Metres(), all[3].resetsPer100Metres(), all[4].resetsPer100Metres()}}};
  pictures.write("resets.svg", service::toSvg(plot));
}

void drawSweep(Pictures& pictures, const Building& building, const DemoOptions& options) {
  service::SweepSettings settings;
  settings.seed = options.seed;
  settings.method = options.method;
  for (int metres = 5; metres <= 40; metres += 5)
    settings.horizons.push_back(static_cast<float>(metres));
  const auto rows = service::sweep(building.world->graph, settings);
  pictures.write("sweep.csv", service::toCsv(rows));
  pictures.write("sweep.svg", service::toPlot(rows, building.name));
}

tl::expected<void, Error> run(const DemoOptions& options) {
  if (std::isnan(options.metres)) {
    throw CLI::ValidationError("--metres", "nan is out of range; give 1 to 100000 m");
  }
  if (auto writable = service::checkWritable(options.out / "table.txt"); !writable) return writable;
  const auto room = rdw::TrackedSpace::rectangle(kRoomSide, kRoomSide);
  if (!room) return tl::unexpected(room.error());
  std::string tables;
  std::vector<std::filesystem::path> folders;
  for (const std::string& scene : options.scenes) {
    const auto building = loadBuilding(scene);
    if (!building) return tl::unexpected(building.error());
    std::vector<Walks> all = controllers();
    {
      service::ProgressBar bar("walking " + building->name);
      std::size_t done = 0;
      for (Walks& walks : all) {
        const auto result = walk(*building, options, *room, walks,
                                 [&] { bar.update(++done, all.size() * options.walks); });
        if (!result) return result;
      }
    }
    const std::string table = tableOf(*building, options, all);
    fmt::print("{}{}", tables.empty() ? "" : "\n", table);
    tables += (tables.empty() ? "" : "\n") + table;
    folders.push_back(options.out / building->name);
    Pictures pictures(folders.back());
    drawPrediction(pictures, *building, all.front().frames);
    drawWalks(pictures, *building, *room, all);
    drawSweep(pictures, *building, options);
    if (!pictures.written()) return pictures.written();
  }
  if (auto written = service::writeFile(options.out / "table.txt", tables); !written)
    return written;
  const std::string first = folders.front().string();
  fmt::print(
      "\nOpen first:\n"
      "  {0}/prediction.svg              where the user can go within {1:g} m\n"
      "  {0}/prediction_front.svg        the same by real junctions (--method front)\n"
      "  {0}/virtual_s2c_predictive.svg  the walk through the building\n"
      "  {0}/room_s2c_predictive.svg     the same walk inside the room (and room_none.svg)\n"
      "  {0}/resets.svg                  how often the user had to be stopped\n"
      "  {0}/sweep.svg                   what a prediction costs\n"
      "Also there: prediction.json .graphml .dot, and a trace and a summary of every walk.\n",
      first, kDumpHorizon);
  for (std::size_t i = 1; i < folders.size(); ++i)
    fmt::print("The same for {}/\n", folders[i].string());
  return {};
}

}  // namespace

Verb addDemo(CLI::App& program) {
  CLI::App* verb = program.add_subcommand(
      "demo",
      "Walk bundled buildings with every controller: a table, plans, plots, dumps and traces");
  const auto options = std::make_shared<DemoOptions>();
  verb->add_option(
          "--scene", options->scenes,
          "Bundled scene by name (office, museum, two_storey, corridor, maze) or a scene file; can "
          "be given more than once")
      ->capture_default_str();
  verb->add_option("--metres", options->metres, "Of each walk, virtual metres")
      ->check(CLI::Range(1.0, 100000.0))
      ->capture_default_str();
  verb->add_option("--walks", options->walks, "Walks per controller, each with a seed of its own")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  verb->add_option("--seed", options->seed, "Of the first walk")
      ->check(wholeNumber)
      ->capture_default_str();
  addMethodOption(*verb, options->method);
  verb->add_option("--out", options->out, "Folder to write to")
      ->check(fileName)
      ->capture_default_str();
  verb->footer(
      "Example:\n"
      "  forewalk demo --scene museum --metres 300 --seed 7 --out out\n"
      "The room is 6 m x 6 m, curvature goes up to 1/7.5 per metre. Everybody walks the same way: "
      "the\n"
      "controllers are compared on the same seeds.");
  return {verb, [options] { return run(*options); }};
}

}  // namespace forewalk::cli
