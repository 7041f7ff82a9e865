// What a crowd's step costs and how well its models keep apart: the scenes of agents/scenes.h,
// every model, CPU time.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <ctime>
#include <memory>
#include <string>
#include <vector>

#include "agents/crowd.h"
#include "agents/overlaps.h"
#include "agents/scenes.h"
#include "bench/timing.h"
#include "tests/agents/models.h"

namespace {

using namespace forewalk;
using namespace forewalk::agents;

double cpuSeconds() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// A run of a scene until all have arrived, or so many simulated seconds.
struct Run {
  double microseconds = 0.0;  ///< CPU time per agent, step and sub-step
  double subSteps = 0.0;      ///< a step, on average
  double arrival = 0.0;       ///< simulated seconds until all had arrived; 0: they never did
  OverlapCount overlaps;
  std::uint64_t wallsEntered = 0;
  std::uint64_t hash = 0;
};

Run run(const CrowdScene& scene, const testing::NamedModel& model, bool project, double limit) {
  CrowdSettings settings;
  settings.project = project;
  Crowd crowd(settings);
  const std::vector<AgentId> ids = populate(scene, crowd.addModel(model.make()), crowd);
  OverlapCounter counter;
  Run result;
  double spent = 0.0, agentSteps = 0.0, steps = 0.0;
  for (double t = 0.0; t < limit; t += static_cast<double>(scene.seconds)) {
    const double begin = cpuSeconds();
    const StepReport& report = crowd.step(scene.seconds);
    spent += cpuSeconds() - begin;
    agentSteps += static_cast<double>(ids.size()) * report.subSteps;
    steps += 1.0;
    result.overlaps += counter.count(crowd.view());
    result.wallsEntered += countWallsEntered(crowd.view(), crowd.walls(), 0.01f);
    if (allArrived(scene, ids, crowd)) {
      result.arrival = t + static_cast<double>(scene.seconds);
      break;
    }
  }
  result.microseconds = 1e6 * spent / agentSteps;
  result.subSteps = agentSteps / steps / static_cast<double>(ids.size());
  result.hash = crowd.hash();
  return result;
}

void print(const std::string& scene, const std::string& model, const std::vector<Run>& runs) {
  std::vector<double> costs;
  for (const Run& one : runs) costs.push_back(one.microseconds);
  const Run& first = runs.front();
  fmt::print(
      "{:<14} {:<24} {:>8.3f} {:>5.1f} {:>9} {:>9} {:>7.1f} {:>7}  {:016x}{}\n", scene, model,
      bench::medianOf(costs), first.subSteps,
      first.arrival > 0.0 ? fmt::format("{:.1f}", first.arrival) : "never",
      first.overlaps.pairSteps, 100.0 * static_cast<double>(first.overlaps.deepest),
      first.wallsEntered, first.hash,
      std::all_of(runs.begin(), runs.end(), [&](const Run& r) { return r.hash == first.hash; })
          ? ""
          : "  NOT REPEATED");
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{"Cost and quality of the avoidance models, scene by scene."};
  std::string only, onlyScene;
  int repeats = 3;
  bool quick = false;
  app.add_option("--model", only, "only models whose name begins so");
  app.add_option("--scene", onlyScene, "only scenes whose name begins so");
  app.add_option("--repeats", repeats, "runs of each, of which the median cost is shown")
      ->check(CLI::Range(1, 99));
  app.add_flag("--quick", quick, "without the circle of 1,000 and the blocks");
  CLI11_PARSE(app, argc, argv);

  struct Case {
    CrowdScene scene;
    bool project;
    double limit;
  };
  std::vector<Case> cases;
  for (const std::uint32_t count : {100u, 250u}) {
    cases.push_back({circleScene(count), false, 400.0});
    cases.push_back({circleScene(count), true, 400.0});
  }
  if (!quick) {
    cases.push_back({circleScene(1000), false, 300.0});
    cases.push_back({blocksScene(5), false, 3000.0});
    cases.push_back({blocksScene(8), false, 3000.0});
  }
  fmt::print("{:<14} {:<24} {:>8} {:>5} {:>9} {:>9} {:>7} {:>7}  {}\n", "scene", "model", "us",
             "subs", "arrived s", "overlaps", "deep %", "walls", "hash");
  for (const Case& one : cases) {
    if (one.scene.name.rfind(onlyScene, 0) != 0) continue;
    for (const testing::NamedModel& model : testing::allModels()) {
      if (model.name.rfind(only, 0) != 0) continue;
      std::vector<Run> runs;
      for (int r = 0; r < repeats; ++r)
        runs.push_back(run(one.scene, model, one.project, one.limit));
      print(one.scene.name, model.name + (one.project ? " + projection" : ""), runs);
    }
  }
  fmt::print(
      "us: CPU microseconds per agent, step and sub-step; overlaps: pairs deeper than 1 %% of the "
      "sum of "
      "their radii, counted every step; walls: agents deeper than 1 cm in one, counted every "
      "step\n");
  return 0;
}
