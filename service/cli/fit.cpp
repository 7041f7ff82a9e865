// forewalk fit: the likelihood's parameters from recorded walks.
#include "service/fitting.h"

#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <string>

#include "service/cli/method_option.h"
#include "service/cli/verb.h"
#include "service/cli/walks_options.h"
#include "service/console.h"
#include "service/files.h"
#include "service/likelihood_file.h"
#include "service/parallel.h"

namespace forewalk::cli {
namespace {

struct FitOptions {
  std::vector<std::string> pairs;
  std::string horizons = "3,5";
  prediction::Method method = prediction::Method::kFront;
  float radius = 0.25f;
  double rate = 15.0;
  double every = 0.5;
  double pull = service::FitSettings{}.pull;
  std::filesystem::path out;
};

tl::expected<void, Error> run(const FitOptions& options) {
  service::LikelihoodRecord record;
  std::vector<SceneAndWalks> pairs;
  for (const std::string& pair : options.pairs) {
    pairs.push_back(parseSceneAndWalks("SCENE=WALKS", pair));
  }
  const std::vector<float> horizons = parseSteps("--horizons", options.horizons);
  if (auto writable = service::checkWritable(options.out); !writable) return writable;
  record.method = nameOf(options.method);
  for (const float horizon : horizons) record.horizons.push_back(static_cast<double>(horizon));

  std::vector<std::vector<service::RecordedWalk>> recordings;
  for (const SceneAndWalks& pair : pairs) {
    const auto walks = loadWalks(pair.walks);
    if (!walks) return tl::unexpected(walks.error());
    navmesh::BuildSettings build;
    build.radius = options.radius;
    const auto navMesh = service::loadNavMesh(pair.scene, {}, build, {service::onThreads(0), {}});
    if (!navMesh) return tl::unexpected(navMesh.error());
    const auto world = service::makeWorld(*navMesh);
    if (!world) return tl::unexpected(world.error());
    service::TrainingData from{pair.scene.string(), pair.walks.string(), {}};
    for (const rdw::Walk& walk : *walks) from.walkers.push_back(walk.walker);
    record.trainedOn.push_back(std::move(from));
    for (const float horizon : horizons) {
      recordings.push_back(service::recordAll(**world, *walks, service::factoryOf(options.method),
                                              {horizon, options.rate, options.every, 0.0}));
      if (auto on = checkOnNavMesh(recordings.back(), pair.scene, pair.walks); !on) return on;
    }
  }
  std::vector<const service::RecordedWalk*> all;
  for (const auto& recording : recordings) {
    for (const service::RecordedWalk& walk : recording) all.push_back(&walk);
  }
  service::FitSettings settings;
  settings.pull = options.pull;
  const service::Fit fit = service::fitLikelihood(all, settings);
  record.parameters = fit.parameters;
  record.samples = fit.samples;
  record.nll = fit.nll;
  if (auto written = service::writeFile(options.out, service::toJson(record)); !written) {
    return written;
  }
  // Where the file itself goes to stdout, nothing else may.
  if (options.out != "-") {
    fmt::print("{} samples, {:.4f} nats each, places off by {:.3f} m on average. Wrote {}\n",
               fit.samples, fit.nll, fit.displacement, options.out.string());
  }
  return {};
}

}  // namespace

Verb addFit(CLI::App& program) {
  CLI::App* verb = program.add_subcommand("fit", "Fit which way people take to recorded walks");
  const auto options = std::make_shared<FitOptions>();
  verb->add_option("SCENE=WALKS", options->pairs,
                   "Scenes, each with a CSV of walks in it (walker_id,t,x,z)")
      ->required();
  verb->add_option("--out", options->out, "Parameters to write (JSON); - is stdout")
      ->required()
      ->check(fileName);
  verb->add_option("--horizons", options->horizons,
                   "How far ways go: a,b,c or from:to:step, metres")
      ->capture_default_str();
  addMethodOption(*verb, options->method);
  verb->add_option("--radius", options->radius, "Of the walker, metres")
      ->check(CLI::Range(0.0f, 10.0f))
      ->capture_default_str();
  verb->add_option("--rate", options->rate, "Frames per second")
      ->check(CLI::Range(1.0, 1000.0))
      ->capture_default_str();
  verb->add_option("--every", options->every, "Seconds between samples")
      ->check(CLI::Range(0.01, 60.0))
      ->capture_default_str();
  verb->add_option("--pull", options->pull,
                   "How strongly parameters are held near the built-in ones, samples")
      ->check(CLI::Range(0.0, 1e9))
      ->capture_default_str();
  verb->footer(
      "Example:\n"
      "  forewalk fit a/scene.obj=a/walks.csv b/scene.obj=b/walks.csv --out likelihood.json\n"
      "The same walks and settings give the same bytes. Judge the result with forewalk evaluate\n"
      "--likelihood likelihood.json on walks that it was not fitted on.");
  return {verb, [options] { return run(*options); }};
}

}  // namespace forewalk::cli
