// What it costs to choose among 22,500 trajectories, and that the choice is that of rating all of
// them: 100 agents, 10 x 15 commands for each half, 10 points.
//
// The clips span a rectangle and acceleration is not limited, so that no sample is dropped. Time is
// CPU time of planning for all agents, tick by tick while the scene runs; choices are compared
// for some agents of every tick, on their real situations.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <ctime>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "agents/crowd.h"
#include "agents/models/golaem.h"
#include "agents/overlaps.h"
#include "agents/scenes.h"
#include "bench/timing.h"
#include "tests/agents/trajectory_situations.h"

namespace {

using namespace forewalk;
using namespace forewalk::agents;

double cpuSeconds() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// The model, with its time taken and some of its choices compared with those of rating all.
class Watched final : public Model {
 public:
  struct Count {
    std::vector<double> milliseconds;  ///< of each tick
    std::uint64_t compared = 0, equal = 0, trajectories = 0;
    double rateAll = 0.0;  ///< CPU seconds of rating them all
  };

  Watched(const GolaemParameters& parameters, std::uint32_t every, Count& count)
      : p_(parameters), model_(makeGolaem(parameters)), every_(every), count_(count) {}

  const char* name() const override { return model_->name(); }
  Needs needs() const override { return model_->needs(); }
  std::unique_ptr<Scratch> makeScratch() const override { return model_->makeScratch(); }

  void plan(const PlanInput& input, Memory memory, Scratch& scratch,
            std::span<Plan> plans) const override {
    compare(input, memory);  // before the rows are written
    const double begin = cpuSeconds();
    model_->plan(input, memory, scratch, plans);
    const double spent = 1e3 * (cpuSeconds() - begin);
    if (input.tick != tick_ || count_.milliseconds.empty()) count_.milliseconds.push_back(0.0);
    tick_ = input.tick;
    count_.milliseconds.back() += spent;  // the crowd plans in slices
  }

 private:
  void compare(const PlanInput& input, Memory memory) const {
    if (every_ == 0) return;
    for (const std::uint32_t agent : input.which) {
      if ((agent + 7 * input.tick) % every_ != 0) continue;
      lookAround(p_, input, agent, golaemRow(memory.of(agent)), situation_);
      search_.prepare(situation_.problem);
      const double begin = cpuSeconds();
      const TrajectoryChoice all = search_.bestByScores();
      count_.rateAll += cpuSeconds() - begin;
      ++count_.compared;
      count_.equal += search_.best() == all;
      count_.trajectories +=
          situation_.first.size() * std::max<std::size_t>(1, situation_.second.size());
    }
  }

  GolaemParameters p_;
  std::unique_ptr<const Model> model_;
  std::uint32_t every_;
  Count& count_;
  mutable std::uint64_t tick_ = 0;
  mutable TrajectorySituation situation_;
  mutable TrajectorySearch search_;
};

void run(const CrowdScene& scene, const char* form, const GolaemParameters& parameters,
         std::uint32_t every, double limit) {
  Watched::Count count;
  Crowd crowd;
  const auto ids =
      populate(scene, crowd.addModel(std::make_unique<Watched>(parameters, every, count)), crowd);
  OverlapCounter overlaps;
  OverlapCount overlapped;
  double arrived = 0.0;
  for (double t = 0.0; t < limit && arrived == 0.0; t += static_cast<double>(scene.seconds)) {
    crowd.step(scene.seconds);
    overlapped += overlaps.count(crowd.view());
    if (allArrived(scene, ids, crowd)) arrived = t + static_cast<double>(scene.seconds);
  }
  std::vector<double> sorted = count.milliseconds;
  std::sort(sorted.begin(), sorted.end());
  const double perAll = count.compared ? 1e3 * count.rateAll * static_cast<double>(ids.size()) /
                                             static_cast<double>(count.compared)
                                       : 0.0;
  fmt::print("{:<14} {:<10} {:>7} {:>8.2f} {:>8.2f} {:>8.2f} {:>9.0f} {:>9} {:>8} {:>9}  {:016x}\n",
             scene.name, form, count.compared ? count.trajectories / count.compared : 0,
             bench::medianOf(sorted), sorted[sorted.size() * 99 / 100], sorted.back(), perAll,
             fmt::format("{}/{}", count.equal, count.compared),
             arrived > 0.0 ? fmt::format("{:.1f}", arrived) : "never", overlapped.pairSteps,
             crowd.hash());
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{"The search among trajectories: its price, and whether it is right."};
  std::uint32_t every = 100;
  double limit = 60.0;
  app.add_option("--every", every, "compare the choice of one agent in so many; 0: of none");
  app.add_option("--limit", limit, "simulated seconds of each scene at most");
  CLI11_PARSE(app, argc, argv);

  GolaemParameters full;
  full.clips = std::make_shared<const LocomotionDatabase>(testing::rectangularClips());
  full.secondLinear = full.secondAngular = 0;
  full.linearAcceleration = full.angularAcceleration = std::numeric_limits<float>::infinity();
  full.period = 0.0f;
  GolaemParameters usual;
  usual.period = 0.0f;
  GolaemParameters single = usual;
  single.dual = false;

  fmt::print("{:<14} {:<10} {:>7} {:>8} {:>8} {:>8} {:>9} {:>9} {:>8} {:>9}  {}\n", "scene", "form",
             "each", "ms", "p99 ms", "worst", "all ms", "equal", "arrived", "overlaps", "hash");
  for (const CrowdScene& scene : {circleScene(100), randomScene(100, 1), blocksScene(5)}) {
    run(scene, "full", full, every, limit);
    run(scene, "2 x 3", usual, every, limit);
    run(scene, "single", single, every, limit);
  }
  fmt::print(
      "each: trajectories of an agent; ms: CPU time to plan for all 100 agents, median, 99th "
      "percentile and worst of the ticks; all ms: the same by rating all trajectories; equal: "
      "choices that are the same to the last bit\n");
  return 0;
}
