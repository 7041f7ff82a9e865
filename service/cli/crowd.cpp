// forewalk crowd: agents of any model in any scene, walked from a configuration file.
#include <fmt/format.h>

#include <ctime>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "service/cli/verb.h"
#include "service/console.h"
#include "service/crowd_config.h"
#include "service/crowd_drawing.h"
#include "service/crowd_files.h"
#include "service/crowd_models.h"
#include "service/crowd_run.h"
#include "service/files.h"
#include "service/parallel.h"
#include "service/timing.h"

namespace forewalk::cli {
namespace {

struct CrowdOptions {
  std::filesystem::path config;
  std::string model;
  double seconds = 0.0;  // 0: the file's
  std::filesystem::path trajectories, database, metrics, plan, animation, diagram;
  service::CrowdAnimationSettings moving;
  unsigned threads = 1;
};

struct Ground {
  std::shared_ptr<const navmesh::World> world;  // null: an open plane
  float walkerRadius = 0.3f;
};

tl::expected<Ground, Error> build(const service::CrowdConfig& config,
                                  const std::filesystem::path& folder) {
  Ground ground;
  if (config.scene.empty()) return ground;
  service::ProgressBar bar("building the scene");
  navmesh::BuildRun run;
  run.forEach = service::onThreads(0);
  run.progress = [&](std::size_t done, std::size_t total) { bar.update(done, total); };
  const auto navMesh =
      service::loadNavMesh(folder / config.scene, config.import, config.build, run);
  if (!navMesh) return tl::unexpected(navMesh.error());
  auto world = service::makeWorld(*navMesh);
  if (!world) return tl::unexpected(std::move(world.error()));
  ground.world = std::move(*world);
  ground.walkerRadius = navMesh->settings.radius;
  return ground;
}

double cpuSeconds() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

void print(const service::CrowdMetrics& metrics, double cpu, double tick) {
  std::vector<double> arrivals = metrics.arrivals, efficiency = metrics.efficiency;
  fmt::print("{} agents ({} human), {:.1f} s\n", metrics.agents, metrics.humans, metrics.seconds);
  if (metrics.withGoal > 0) {
    fmt::print("arrived            {} of {}{}\n", metrics.arrived, metrics.withGoal,
               arrivals.empty() ? ""
                                : fmt::format(", median {:.1f} s, last {:.1f} s",
                                              service::quantile(arrivals, 0.5),
                                              service::quantile(arrivals, 1.0)));
  }
  if (!efficiency.empty()) {
    fmt::print("path efficiency    {:.3f} (mean of {} legs)\n", service::mean(efficiency),
               efficiency.size());
  }
  fmt::print("collisions         {} (deepest overlap {:.1f} % of the radii)\n", metrics.collisions,
             100.0 * static_cast<double>(metrics.overlaps.deepest));
  if (metrics.overlaps.leastGap < 1e29f) {
    fmt::print("least separation   {:.3f} m\n", metrics.overlaps.leastGap);
  }
  fmt::print("walls entered      {}\n", metrics.wallsEntered);
  fmt::print("mean speed         {:.2f} m/s\n", metrics.meanSpeed);
  const double steps = static_cast<double>(metrics.agents) * metrics.seconds / tick;
  fmt::print("CPU time           {:.2f} us per agent and tick, counting and recording included\n",
             steps > 0.0 ? 1e6 * cpu / steps : 0.0);
  fmt::print("hash               {:016x}\n", metrics.hash);
}

tl::expected<void, Error> writeAll(const CrowdOptions& options, const service::CrowdConfig& config,
                                   const service::CrowdResult& result, const Ground& ground) {
  const navmesh::NavGraph* graph = ground.world ? &ground.world->graph : nullptr;
  const std::string title = options.config.stem().string();
  const std::string subtitle =
      fmt::format("{} agents, {:.1f} s, {} collisions", result.metrics.agents,
                  result.metrics.seconds, result.metrics.collisions);
  using Text = std::function<std::string()>;
  const std::pair<std::filesystem::path, Text> texts[] = {
      {options.trajectories, [&] { return service::trajectoriesCsv(result.recording, config); }},
      {options.metrics, [&] { return service::metricsJson(result.metrics); }},
      {options.plan, [&] { return service::crowdPlan(result, config, graph, title, subtitle); }},
      {options.animation,
       [&] {
         return service::animateCrowd(result, config, graph, options.moving, title, subtitle);
       }},
      {options.diagram, [&] {
         return service::diagramPlot(service::fundamentalDiagram(result.metrics.diagram), subtitle);
       }}};
  for (const auto& [file, text] : texts) {
    if (file.empty()) continue;
    if (auto written = service::writeFile(file, text()); !written) return written;
  }
  if (options.database.empty()) return {};
  return service::writeTrajectoryDatabase(options.database, result.recording, result.walls);
}

tl::expected<void, Error> run(const CrowdOptions& options) {
  int toStdout = 0;
  for (const auto& file : {options.trajectories, options.metrics, options.plan, options.animation,
                           options.diagram, options.database}) {
    if (auto writable = service::checkWritable(file); !writable) return writable;
    toStdout += file == "-";
  }
  if (toStdout > 1) throw CLI::ValidationError("only one output can go to stdout (-)");
  if (options.database == "-") {
    throw CLI::ValidationError("--sqlite", "is a database, which cannot go to stdout; give a file");
  }
  const auto bytes = service::readFile(options.config);
  if (!bytes) return tl::unexpected(bytes.error());
  auto config = service::parseCrowd(*bytes, options.config.string());
  if (!config) return tl::unexpected(std::move(config.error()));
  if (options.seconds > 0.0) config->seconds = options.seconds;
  if (!options.model.empty()) {
    for (service::CrowdGroup& group : config->groups) group.model = options.model;
  }
  if (!options.diagram.empty() && !config->measure) {
    return tl::unexpected(
        Error{ErrorCode::kSettingOutOfRange,
              fmt::format(
                  "{}: --diagram needs an area to measure in; add \"measure\": {{\"area\": [x, z, "
                  "x, z]}}.",
                  options.config.string())});
  }
  const auto ground = build(*config, options.config.parent_path());
  if (!ground) return tl::unexpected(ground.error());

  std::optional<service::ProgressBar> bar("walking");
  service::CrowdRun run;
  if (options.threads != 1) run.forEach = service::onThreads(options.threads);
  run.progress = [&](std::size_t done, std::size_t total) { bar->update(done, total); };
  run.record = !options.trajectories.empty() || !options.database.empty() ||
               !options.plan.empty() || !options.animation.empty();
  const double before = cpuSeconds();
  const auto result = service::runCrowd(*config, ground->world, ground->walkerRadius, run);
  const double cpu = cpuSeconds() - before;
  bar.reset();
  if (!result) {
    return tl::unexpected(Error{result.error().code, fmt::format("{}: {}", options.config.string(),
                                                                 result.error().message)});
  }
  if (auto written = writeAll(options, *config, *result, *ground); !written) return written;
  if (toStdout == 0) print(result->metrics, cpu, config->tick);
  return {};
}

}  // namespace

Verb addCrowd(CLI::App& program) {
  CLI::App* verb = program.add_subcommand(
      "crowd", "Walk a crowd of virtual agents, and record and measure what happened");
  const auto options = std::make_shared<CrowdOptions>();
  std::vector<std::string> models;
  for (const service::RegisteredModel& model : service::registeredModels()) {
    models.emplace_back(model.name);
  }
  verb->add_option("CONFIG", options->config, "forewalk.crowd/1: ground, models, groups")
      ->required();
  verb->add_option("--model", options->model, "Of all groups, instead of those in CONFIG")
      ->check(CLI::IsMember(models));
  verb->add_option("--seconds", options->seconds, "Of the walk, instead of those in CONFIG")
      ->check(CLI::Range(0.01, 86400.0));
  verb->add_option("--trajectories", options->trajectories,
                   "CSV walker_id,t,x,z,y,heading,group; - is stdout")
      ->check(fileName);
  verb->add_option("--sqlite", options->database,
                   "The same as a JuPedSim trajectory database, which PedPy and its viewers open")
      ->check(fileName);
  verb->add_option("--metrics", options->metrics, "JSON, what happened in numbers; - is stdout")
      ->check(fileName);
  verb->add_option("--plan", options->plan, "SVG, everybody's way; - is stdout")->check(fileName);
  verb->add_option("--animation", options->animation, "SVG that moves; - is stdout")
      ->check(fileName);
  verb->add_option("--from", options->moving.from, "Of the animation, seconds")
      ->check(CLI::Range(0.0, 86400.0))
      ->capture_default_str();
  verb->add_option("--for", options->moving.seconds, "Of the animation, seconds")
      ->check(CLI::Range(0.5, 3600.0))
      ->capture_default_str();
  verb->add_option("--diagram", options->diagram,
                   "SVG, speed and flow over density in the measured area; - is stdout")
      ->check(fileName);
  verb->add_option("--threads", options->threads, "0: all cores; the result does not depend on it")
      ->check(CLI::Range(0u, 256u))
      ->capture_default_str();
  verb->footer(fmt::format(
      "Examples:\n"
      "  forewalk crowd assets/crowds/circle.json --plan circle.svg --metrics circle.json\n"
      "  forewalk crowd assets/crowds/city_block.json --animation city.svg --sqlite city.sqlite\n"
      "Models: {}. Every key of CONFIG is described in service/crowd_config.h.",
      fmt::join(models, ", ")));
  return {verb, [options] { return run(*options); }};
}

}  // namespace forewalk::cli
