// forewalk predict: the ways ahead of one user, as a file.
#include "prediction/predict.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <glm/trigonometric.hpp>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "prediction/dump.h"
#include "prediction/front_graph.h"
#include "service/cli/links_option.h"
#include "service/cli/method_option.h"
#include "service/cli/scene_options.h"
#include "service/cli/verb.h"
#include "service/files.h"
#include "service/timing.h"

namespace forewalk::cli {
namespace {

struct PredictOptions {
  SceneOptions scene;
  std::string at;
  std::optional<float> headingDegrees;
  float horizon = 20.0f;
  prediction::Method method = prediction::Method::kPolygon;
  float persistence = prediction::FrontSettings{}.persistence;
  std::string format;
  bool distances = false;
  std::filesystem::path links;
  std::filesystem::path out = "-";
};

// Throws where the ending of --out names something else.
std::string formatOf(const PredictOptions& options) {
  if (!options.format.empty()) return options.format;
  const std::string ending = CLI::detail::to_lower(options.out.extension().string());
  if (ending.empty()) return "json";
  for (const char* known : {"json", "graphml", "dot", "svg"}) {
    if (ending.substr(1) == known) return known;
  }
  throw CLI::ValidationError(
      "--out", fmt::format("{}: the ending names no format we write; say which with --format json, "
                           "graphml, dot or svg",
                           options.out.string()));
}

tl::expected<void, Error> run(const PredictOptions& options) {
  const glm::vec3 at = parsePosition("--at", options.at);
  if (!(options.horizon > 0.0f) || options.horizon > 10000.0f) {
    throw CLI::ValidationError(
        "--horizon",
        fmt::format("{:g} m is out of range; give more than 0 and up to 10000 m", options.horizon));
  }
  if (options.headingDegrees && !std::isfinite(*options.headingDegrees)) {
    throw CLI::ValidationError(
        "--heading-deg", fmt::format("{:g} is no number of degrees", *options.headingDegrees));
  }
  if (!(options.persistence >= 0.0f) || options.persistence > 100.0f) {
    throw CLI::ValidationError(
        "--persistence",
        fmt::format("{:g} m is out of range; give 0 to 100 m", options.persistence));
  }
  const std::string format = formatOf(options);
  if (options.distances && format != "svg") {
    throw CLI::ValidationError("--distances",
                               fmt::format("is for plans, not for {}; add --format svg", format));
  }
  const bool byFronts = options.method == prediction::Method::kFront;
  if (auto writable = service::checkWritable(options.out); !writable) return writable;
  auto world = loadWorld(options.scene);
  if (!world) return tl::unexpected(std::move(world.error()));
  const auto place = service::placeIn(**world, at, options.scene.scene.string());
  if (!place) return tl::unexpected(place.error());

  const navmesh::NavGraph& navGraph = (*world)->graph;
  navmesh::PolygonStates states;
  if (!options.links.empty()) {
    auto links = linksOn(**world, options.links);
    if (!links) return tl::unexpected(std::move(links.error()));
    navmesh::setLinks(navGraph, std::move(*links), states);
  }
  prediction::PredictionLimits limits;
  limits.polygons = std::max(limits.polygons, navGraph.polygonCount());
  prediction::Scratch scratch(navGraph, limits);
  std::optional<prediction::FrontIndex> frontIndex;
  std::optional<prediction::FrontScratch> frontScratch;
  if (byFronts) {
    frontIndex = prediction::makeFrontIndex(navGraph, &states);
    frontScratch.emplace(navGraph, *frontIndex);
  }
  const prediction::FrontSettings settings{options.persistence};
  const prediction::PredictionGraph* graph = nullptr;
  std::vector<double> times;
  for (int round = 0; round < 10; ++round) {  // buffers grow in the first
    const service::Stopwatch watch;
    graph = byFronts ? &prediction::predictFronts(navGraph, *place, options.horizon, *frontScratch,
                                                  settings)
                     : &prediction::predict(navGraph, *place, options.horizon, scratch, &states);
    if (round > 0) times.push_back(watch.microseconds());
  }
  if (format == "graphml") return service::writeFile(options.out, prediction::toGraphml(*graph));
  if (format == "dot") return service::writeFile(options.out, prediction::toDot(*graph));
  if (format == "svg") {
    const std::string title = fmt::format("Ways ahead within {:g} m in {}", options.horizon,
                                          options.scene.scene.stem().string());
    prediction::PlanText text{title, {}, nullptr, &states.links};
    if (options.headingDegrees) text.heading = glm::radians(*options.headingDegrees);
    std::optional<prediction::PortalEnds> ends;
    std::optional<prediction::DistanceField> distances;
    if (options.distances && byFronts) text.distances = &frontScratch->distances();
    if (options.distances && !byFronts) {
      ends = prediction::makePortalEnds(navGraph);
      distances.emplace(navGraph, *ends);
      distances->run(*place, options.horizon);
      text.distances = &*distances;
    }
    return service::writeFile(options.out, prediction::toSvg(navGraph, *graph, text));
  }
  return service::writeFile(options.out,
                            prediction::toJson(navGraph, *graph, service::quantile(times, 0.5)));
}

}  // namespace

Verb addPredict(CLI::App& program) {
  CLI::App* verb = program.add_subcommand("predict", "The ways ahead of a user, out to a horizon");
  const auto options = std::make_shared<PredictOptions>();
  addSceneOptions(*verb, options->scene);
  verb->add_option("--at", options->at, "Where the user stands: x,y,z in metres, y up")->required();
  verb->add_option(
      "--heading-deg", options->headingDegrees,
      "Where the user looks, degrees: 0 is -z, counter-clockwise positive; drawn in the plan");
  verb->add_option("--horizon", options->horizon, "How far ahead, metres along the path")
      ->capture_default_str();
  addMethodOption(*verb, options->method);
  verb->add_option("--persistence", options->persistence,
                   "For --method front: ways shorter than this, metres, are part of the one they "
                   "leave")
      ->capture_default_str();
  addLinksOption(*verb, options->links);
  verb->add_option(
          "--format", options->format,
          "json, graphml (yEd, Gephi, networkx), dot (Graphviz) or svg (a plan); by default what "
          "the ending of --out says, json where it has none")
      ->check(CLI::IsMember({"json", "graphml", "dot", "svg"}));
  verb->add_flag(
      "--distances", options->distances,
      "In a plan: exact walking distances as colour, with a line every metre (every few, "
      "where the horizon is far)");
  verb->add_option("--out", options->out, "File to write; - is stdout")
      ->check(fileName)
      ->capture_default_str();
  verb->footer(
      "Example:\n"
      "  forewalk predict assets/scenes/office.obj --at 10,0,8 --heading-deg 90 --horizon 20 \\\n"
      "      --format svg --out plan.svg\n"
      "  forewalk predict assets/scenes/museum.obj --at 22,0,17 --method front --distances \\\n"
      "      --out museum.svg");
  return {verb, [options] { return run(*options); }};
}

}  // namespace forewalk::cli
