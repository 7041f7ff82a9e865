// forewalk evaluate: how well predictions fit recorded walks.
#include "service/evaluation.h"

#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <string>

#include "service/cli/method_option.h"
#include "service/cli/scene_options.h"
#include "service/cli/verb.h"
#include "service/cli/walks_options.h"
#include "service/console.h"
#include "service/files.h"
#include "service/fitting.h"
#include "service/parallel.h"

namespace forewalk::cli {
namespace {

struct EvaluateOptions {
  SceneOptions scene;
  std::filesystem::path walks;
  float horizon = 5.0f;
  prediction::Method method = prediction::Method::kFront;
  std::filesystem::path likelihood;
  bool folds = false;
  std::vector<std::string> train;
  std::string fitHorizons = "3,5";
  double rate = 15.0;
  double every = 0.5;
  double spacing = 0.0;
  std::uint64_t seed = 1;
  std::filesystem::path out;
};

/// Everything that a fold may be fitted on: the walks at hand and others, at all fit horizons.
using Recordings = std::vector<std::vector<service::RecordedWalk>>;

tl::expected<Recordings, Error> trainingOf(const EvaluateOptions& options,
                                           const navmesh::World& world,
                                           const std::vector<rdw::Walk>& walks) {
  Recordings recordings;
  const std::vector<float> horizons = parseSteps("--fit-horizons", options.fitHorizons);
  const auto add = [&](const navmesh::World& where, const std::vector<rdw::Walk>& who) {
    for (const float horizon : horizons) {
      recordings.push_back(service::recordAll(
          where, who, service::factoryOf(options.method),
          {horizon, options.rate, options.every, options.spacing}, options.scene.threads));
    }
  };
  add(world, walks);
  for (const std::string& text : options.train) {
    const SceneAndWalks pair = parseSceneAndWalks("--train", text);
    const auto others = loadWalks(pair.walks);
    if (!others) return tl::unexpected(others.error());
    const auto navMesh =
        service::loadNavMesh(pair.scene, options.scene.import, options.scene.build);
    if (!navMesh) return tl::unexpected(navMesh.error());
    const auto there = service::makeWorld(*navMesh);
    if (!there) return tl::unexpected(there.error());
    add(**there, *others);
    if (auto on = checkOnNavMesh(recordings.back(), pair.scene, pair.walks); !on) {
      return tl::unexpected(on.error());
    }
  }
  return recordings;
}

tl::expected<void, Error> run(const EvaluateOptions& options) {
  const std::string prefix = options.out.string();
  const std::string files[] = {prefix + ".csv", prefix + ".json", prefix + "-reliability.svg",
                               prefix + "-displacement.svg", prefix + "-scores.svg"};
  if (!prefix.empty()) {
    for (const std::string& file : files) {
      if (auto writable = service::checkWritable(file); !writable) return writable;
    }
  }
  if (!options.train.empty() && !options.folds) {
    throw CLI::ValidationError("--train", "has no effect without --folds; leave it out or add it");
  }
  if (!options.likelihood.empty() && options.folds) {
    throw CLI::ValidationError("--likelihood", "has no effect with --folds; leave one of them out");
  }
  const auto parameters = likelihoodOf(options.likelihood);
  if (!parameters) return tl::unexpected(parameters.error());
  const auto walks = loadWalks(options.walks);
  if (!walks) return tl::unexpected(walks.error());
  const auto world = loadWorld(options.scene);
  if (!world) return tl::unexpected(world.error());
  const std::vector<service::RecordedWalk> recorded = service::recordAll(
      **world, *walks, service::factoryOf(options.method),
      {options.horizon, options.rate, options.every, options.spacing}, options.scene.threads);
  if (auto on = checkOnNavMesh(recorded, options.scene.scene, options.walks); !on) return on;

  // The rivals get what the likelihood gets: each walker's is fitted on the others where there are
  // folds.
  service::EvaluationModels models;
  models.likelihood.assign(walks->size(), *parameters);
  models.cosine.assign(walks->size(), 1.0);
  Recordings training;
  if (options.folds) {
    auto made = trainingOf(options, **world, *walks);
    if (!made) return tl::unexpected(made.error());
    training = std::move(*made);
  }
  service::onThreads(options.scene.threads)(walks->size(), [&](std::size_t w) {
    std::vector<const service::RecordedWalk*> others, here;
    for (const auto& recording : training) {
      for (const service::RecordedWalk& walk : recording) {
        if (walk.walker != (*walks)[w].walker) others.push_back(&walk);
      }
    }
    for (const service::RecordedWalk& walk : recorded) {
      if (walk.walker != (*walks)[w].walker || walks->size() == 1) here.push_back(&walk);
    }
    models.cosine[w] = service::fitCosine(here);
    if (options.folds && !others.empty()) {
      models.likelihood[w] = service::fitLikelihood(others).parameters;
    }
  });
  service::Evaluation evaluation =
      service::evaluate(recorded, models, options.horizon, options.seed);
  evaluation.folds = options.folds;
  fmt::print("{}", service::toTable(evaluation));
  if (prefix.empty()) return {};
  const std::string texts[] = {
      service::toCsv(evaluation), service::toJson(evaluation), service::reliabilityPlot(evaluation),
      service::displacementPlot(evaluation), service::scorePlot(evaluation)};
  for (std::size_t i = 0; i < std::size(files); ++i) {
    if (auto written = service::writeFile(files[i], texts[i]); !written) return written;
  }
  fmt::print("\nWrote {0}.csv, .json, -reliability.svg, -displacement.svg and -scores.svg\n",
             prefix);
  return {};
}

}  // namespace

Verb addEvaluate(CLI::App& program) {
  CLI::App* verb = program.add_subcommand(
      "evaluate", "How well the ways predicted fit recorded walks: table and figures");
  const auto options = std::make_shared<EvaluateOptions>();
  addSceneOptions(*verb, options->scene);
  verb->add_option("WALKS", options->walks, "Walks in the scene: CSV walker_id,t,x,z")
      ->required()
      ->check(fileName);
  verb->add_option("--horizon", options->horizon, "How far ways go, metres")
      ->check(CLI::Range(0.1f, 10000.0f))
      ->capture_default_str();
  addMethodOption(*verb, options->method);
  addLikelihoodOption(*verb, options->likelihood);
  verb->add_flag("--folds", options->folds,
                 "Leave one walker out: predict each by a fit on the others");
  verb->add_option("--train", options->train,
                   "More walks to fit folds on, SCENE=WALKS; walkers of the same name are left out")
      ->allow_extra_args(false);
  verb->add_option("--fit-horizons", options->fitHorizons, "Of the folds' fits, metres")
      ->capture_default_str();
  verb->add_option("--rate", options->rate, "Frames per second")
      ->check(CLI::Range(1.0, 1000.0))
      ->capture_default_str();
  verb->add_option("--every", options->every, "Seconds between samples")
      ->check(CLI::Range(0.01, 60.0))
      ->capture_default_str();
  verb->add_option("--spacing", options->spacing,
                   "Metres between the places of samples, at least; 0: sample by time alone")
      ->check(CLI::Range(0.0, 1000.0))
      ->capture_default_str();
  verb->add_option("--seed", options->seed, "Of the bootstrap")
      ->check(wholeNumber)
      ->capture_default_str();
  verb->add_option("--out", options->out,
                   "Where to write: OUT.csv, OUT.json, OUT-reliability.svg, ...");
  verb->footer(
      "Example:\n"
      "  forewalk evaluate a/scene.obj a/walks.csv --horizon 3 --folds --out out/a3\n"
      "The way taken is the one by which the walk first leaves the horizon (by shortest path), or\n"
      "the dead end that it reaches before. The heading is the direction of motion. Intervals are\n"
      "95 % of a bootstrap over walkers.");
  return {verb, [options] { return run(*options); }};
}

}  // namespace forewalk::cli
