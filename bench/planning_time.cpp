// What a planning frame costs: graph to the horizon, likelihoods, plan and gains, on walks through
// bundled buildings.
//
// Planners plan ten times a second; here they plan in every frame, so that every frame counts and
// the quantiles are those of planning frames alone. Times are processor time of the thread. Frames
// of resets and of standing are left out; the frame in which a reset begins (the reset `ahead` asks
// once about 36 headings) is a row of its own. Beside the price the walk's hash: the same price for
// another walk is another matter.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "bench/thread_clock.h"
#include "bench/timing.h"
#include "bench/worlds.h"
#include "navmesh/world.h"
#include "rdw/force.h"
#include "rdw/foresight.h"
#include "rdw/mpcred.h"
#include "rdw/simulation.h"

namespace forewalk {
namespace {

struct Planner {
  std::string name;
  rdw::ControllerMaker make;
};

// The same settings but for the time between plans.
template <typename Settings>
Settings inEveryFrame() {
  Settings settings;
  settings.planEvery = 0.0;
  return settings;
}

std::vector<Planner> planners() {
  return {
      {"foresight", [] { return rdw::makeForesight(inEveryFrame<rdw::ForesightSettings>()); }},
      {"mpcred", [] { return rdw::makeMpcred(inEveryFrame<rdw::MpcredSettings>()); }},
      {"force", [] { return rdw::makeForce(inEveryFrame<rdw::ForceSettings>()); }},
  };
}

// Of the frames of all walks, microseconds.
struct Prices {
  std::vector<double> graph, plan, frame, reset;
  std::uint64_t hash = 0xcbf29ce484222325ull;
};

void add(const rdw::SimulationResult& walk, Prices& prices) {
  bool before = false;
  for (const rdw::FrameRecord& frame : walk.frames) {
    const bool began = frame.reset && !before;
    before = frame.reset;
    if (began) prices.reset.push_back(frame.frameMicroseconds);
    // Who walks or turns is planned for; neutral gains are those of somebody who stands.
    if (frame.reset || frame.gains == rdw::Gains{}) continue;
    prices.graph.push_back(frame.predictMicroseconds);
    prices.plan.push_back(frame.steerMicroseconds);
    prices.frame.push_back(frame.frameMicroseconds);
  }
  prices.hash = (prices.hash ^ walk.summary.traceHash) * 0x100000001b3ull;
}

void printRow(const char* what, const std::vector<double>& times) {
  fmt::print("    {:<22} {:>8.1f} {:>8.1f} {:>8.1f} {:>9}\n", what, bench::medianOf(times),
             bench::quantileOf(times, 0.99), bench::quantileOf(times, 1.0), times.size());
}

}  // namespace
}  // namespace forewalk

int main(int argc, char** argv) {
  using namespace forewalk;
  std::string scenes = "office,museum";
  std::string rooms = "4,10";
  float horizon = 20.0f;
  int seeds = 3;
  double metres = 100.0;
  CLI::App program("What a planning frame costs, graph included.", "planning_time");
  program.add_option("--scenes", scenes, "Bundled ones, commas between")->capture_default_str();
  program.add_option("--rooms", rooms, "Sides of square rooms, metres")->capture_default_str();
  program.add_option("--horizon", horizon, "Of prediction, metres")->capture_default_str();
  program.add_option("--seeds", seeds, "Walks in each scene and room")->capture_default_str();
  program.add_option("--metres", metres, "Of a walk")->capture_default_str();
  CLI11_PARSE(program, argc, argv);

  fmt::print(
      "Processor time of planning frames, us: horizon {:g} m, a plan in every frame, 60 Hz,\n"
      "{} walks of {:g} m in each room ({} m) and scene, reset ahead.\n\n"
      "{:<26} {:>8} {:>8} {:>8} {:>9}\n",
      horizon, seeds, metres, rooms, "", "median", "p99", "worst", "frames");
  for (const std::string& scene : CLI::detail::split(scenes, ',')) {
    const bench::World built = bench::buildWorld(scene, FOREWALK_ASSETS "/scenes/" + scene + ".obj",
                                                 navmesh::BuildSettings{});
    const auto world = std::make_shared<const navmesh::World>(navmesh::makeWorld(built.graph));
    for (const Planner& planner : planners()) {
      Prices prices;
      for (const std::string& side : CLI::detail::split(rooms, ',')) {
        for (int seed = 1; seed <= seeds; ++seed) {
          rdw::SimulationConfig config;
          config.session.space = *rdw::TrackedSpace::rectangle(std::stod(side), std::stod(side));
          config.session.limits = *rdw::gainLimitsByName("toolkit");
          config.session.makeController = planner.make;
          config.session.resetPolicy = "ahead";
          config.session.horizon = horizon;
          config.stop.virtualMetres = metres;
          config.rate = 60.0;
          config.seed = static_cast<std::uint64_t>(seed);
          rdw::SimulationRun run;
          run.microseconds = bench::threadMicroseconds;
          const auto walk = rdw::simulate(world, config, run);
          if (!walk) return fmt::print(stderr, "{}\n", walk.error().message), 1;
          add(*walk, prices);
        }
      }
      fmt::print("{}, {}: walks {:016x}\n", scene, planner.name, prices.hash);
      printRow("graph, likelihoods", prices.graph);
      printRow("plan, gains", prices.plan);
      printRow("the whole frame", prices.frame);
      printRow("frames of new resets", prices.reset);
    }
  }
  return 0;
}
