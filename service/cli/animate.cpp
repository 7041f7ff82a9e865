// forewalk animate: a walk as a moving picture, with the ways ahead as wide as they are likely.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "rdw/simulation.h"
#include "service/cli/method_option.h"
#include "service/cli/scene_options.h"
#include "service/cli/verb.h"
#include "service/cli/walks_options.h"
#include "service/files.h"
#include "service/walk_animation.h"

namespace forewalk::cli {
namespace {

struct AnimateOptions {
  SceneOptions scene;
  std::filesystem::path walks;
  std::string walker;
  std::uint64_t seed = 1;
  prediction::Method method = prediction::Method::kFront;
  std::filesystem::path likelihood;
  service::WalkAnimationSettings animation;
  std::filesystem::path out;
};

tl::expected<rdw::Walk, Error> recorded(const AnimateOptions& options) {
  auto walks = loadWalks(options.walks);
  if (!walks) return tl::unexpected(std::move(walks.error()));
  if (options.walker.empty()) return std::move(walks->front());
  std::vector<std::string> names;
  for (rdw::Walk& walk : *walks) {
    if (walk.walker == options.walker) return std::move(walk);
    names.push_back(walk.walker);
  }
  return tl::unexpected(
      Error{ErrorCode::kDataDamaged,
            fmt::format("{}: there is no walker \"{}\"; give one of {}.", options.walks.string(),
                        options.walker, fmt::join(names, ", "))});
}

// Somebody who wanders through the building, never steered and never stopped.
tl::expected<rdw::Walk, Error> wandered(const AnimateOptions& options,
                                        const std::shared_ptr<const navmesh::World>& world) {
  rdw::SimulationConfig config;
  config.session.controller = "none";
  config.session.resets = false;
  config.rate = 30.0;
  config.seed = options.seed;
  config.stop.seconds = options.animation.from + options.animation.seconds + 1.0;
  const auto result = rdw::simulate(world, config);
  if (!result) return tl::unexpected(result.error());
  rdw::Walk walk;
  for (const rdw::FrameRecord& frame : result->frames) {
    walk.samples.push_back({frame.t, frame.virtualPosition});
  }
  return walk;
}

tl::expected<void, Error> run(const AnimateOptions& options) {
  if (options.walks.empty() && !options.walker.empty()) {
    throw CLI::ValidationError("--walker", "names one of WALKS; give that file too");
  }
  if (auto writable = service::checkWritable(options.out); !writable) return writable;
  const auto parameters = likelihoodOf(options.likelihood);
  if (!parameters) return tl::unexpected(parameters.error());
  const auto world = loadWorld(options.scene);
  if (!world) return tl::unexpected(world.error());
  const auto walk = options.walks.empty() ? wandered(options, *world) : recorded(options);
  if (!walk) return tl::unexpected(walk.error());
  const double lasts = walk->samples.back().seconds - walk->samples.front().seconds;
  if (options.animation.from >= lasts) {
    return tl::unexpected(
        Error{ErrorCode::kSettingOutOfRange,
              fmt::format("--from is {:g} s, but the walk lasts {:.1f} s; give less than that.",
                          options.animation.from, lasts)});
  }
  const std::string subtitle = fmt::format(
      "{}, {}; ways out to {:g} m, every {:g} s", options.scene.scene.stem().string(),
      options.walks.empty() ? "a simulated walk" : fmt::format("walker {}", walk->walker),
      options.animation.horizon, options.animation.step);
  return service::writeFile(
      options.out, service::animateWalk(**world, *walk, service::factoryOf(options.method),
                                        *parameters, options.animation,
                                        "The ways ahead, as wide as they are likely", subtitle));
}

}  // namespace

Verb addAnimate(CLI::App& program) {
  CLI::App* verb = program.add_subcommand(
      "animate", "A walk as a moving picture (SVG): the ways ahead, as wide as they are likely");
  const auto options = std::make_shared<AnimateOptions>();
  addSceneOptions(*verb, options->scene);
  verb->add_option("WALKS", options->walks,
                   "Walks in the scene: CSV walker_id,t,x,z; without it somebody wanders about")
      ->check(fileName);
  verb->add_option("--walker", options->walker, "Whose walk; default: the first of the file");
  verb->add_option("--seed", options->seed, "Of the wandering, where there are no WALKS")
      ->check(wholeNumber)
      ->capture_default_str();
  verb->add_option("--from", options->animation.from, "Seconds into the walk")
      ->check(CLI::Range(0.0, 86400.0))
      ->capture_default_str();
  verb->add_option("--seconds", options->animation.seconds, "How long")
      ->check(CLI::Range(1.0, 600.0))
      ->capture_default_str();
  verb->add_option("--horizon", options->animation.horizon, "How far ways go, metres")
      ->check(CLI::Range(0.1f, 1000.0f))
      ->capture_default_str();
  addMethodOption(*verb, options->method);
  addLikelihoodOption(*verb, options->likelihood);
  verb->add_option("--out", options->out, "SVG to write; - is stdout")->required()->check(fileName);
  verb->footer(
      "Examples:\n"
      "  forewalk animate house.obj walks.csv --walker u3 --from 40 --out walk.svg\n"
      "  forewalk animate assets/scenes/museum.obj --seed 2 --seconds 25 --out museum.svg\n"
      "Any browser plays the result; it needs no network and no script.");
  return {verb, [options] { return run(*options); }};
}

}  // namespace forewalk::cli
