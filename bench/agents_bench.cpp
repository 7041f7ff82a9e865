// What a crowd's step costs and how well its models keep apart: the scenes of agents/scenes.h,
// every model, CPU time.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <ctime>
#include <memory>
#include <mutex>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include "agents/avatar_navigation.h"
#include "agents/crowd.h"
#include "agents/overlaps.h"
#include "agents/recording.h"
#include "agents/scenes.h"
#include "bench/timing.h"
#include "navmesh/random.h"
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

/// Two threads that stay: starting some for every call costs a tenth of a step of 10,000 agents.
class Pool {
 public:
  explicit Pool(unsigned threads) {
    for (unsigned t = 1; t < threads; ++t) threads_.emplace_back([this] { serve(); });
  }
  ~Pool() {
    {
      const std::lock_guard lock(mutex_);
      stop_ = true;
    }
    wake_.notify_all();
    for (std::thread& thread : threads_) thread.join();
  }
  navmesh::ForEach forEach() {
    return [this](std::size_t count, const std::function<void(std::size_t)>& work) {
      {
        const std::lock_guard lock(mutex_);
        work_ = &work;
        count_ = count;
        next_ = 0;
        busy_ = threads_.size();
        ++round_;
      }
      wake_.notify_all();
      take(work, count);
      std::unique_lock lock(mutex_);
      done_.wait(lock, [&] { return busy_ == 0; });
    };
  }

 private:
  void take(const std::function<void(std::size_t)>& work, std::size_t count) {
    for (std::size_t k = next_++; k < count; k = next_++) work(k);
  }
  void serve() {
    std::uint64_t seen = 0;
    for (;;) {
      std::unique_lock lock(mutex_);
      wake_.wait(lock, [&] { return stop_ || round_ != seen; });
      if (stop_) return;
      seen = round_;
      const auto* work = work_;
      const std::size_t count = count_;
      lock.unlock();
      take(*work, count);
      lock.lock();
      if (--busy_ == 0) done_.notify_one();
    }
  }
  std::mutex mutex_;
  std::condition_variable wake_, done_;
  const std::function<void(std::size_t)>* work_ = nullptr;
  std::size_t count_ = 0, busy_ = 0;
  std::atomic<std::size_t> next_{0};
  std::uint64_t round_ = 0;
  bool stop_ = false;
  std::vector<std::thread> threads_;
};

/// 10,000 ORCA agents, recorded: steps a second of wall time on one thread and on two.
void printTenThousand(int repeats) {
  const CrowdScene scene = randomScene(10000, 1);
  constexpr int kSteps = 100;
  for (const unsigned threads : {1u, 2u}) {
    std::vector<double> rates;
    std::uint64_t hash = 0;
    for (int r = 0; r < repeats; ++r) {
      Pool pool(threads);
      Crowd crowd;
      populate(scene, crowd.addModel(makeOrca()), crowd);
      Recording recording;
      recording.reserve(kSteps + 1, (kSteps + 1) * scene.agents.size());
      crowd.onStep([&](const AgentsView& agents, const StepReport&) { recording.add(agents); });
      const navmesh::ForEach forEach = threads > 1 ? pool.forEach() : navmesh::ForEach{};
      crowd.step(scene.seconds, forEach);
      const auto begin = std::chrono::steady_clock::now();
      for (int k = 1; k < kSteps; ++k) crowd.step(scene.seconds, forEach);
      const std::chrono::duration<double> spent = std::chrono::steady_clock::now() - begin;
      rates.push_back((kSteps - 1) / spent.count());
      hash = recording.hash();
    }
    fmt::print("10,000 orca agents, recorded, {} thread{}: {:.0f} steps/s  {:016x}\n", threads,
               threads > 1 ? "s" : "", bench::medianOf(rates), hash);
  }
}

/// The thesis's speed test: one avatar that wanders among 10 to 50 objects.
void printThesisSpeed(int repeats) {
  for (const std::uint32_t objects : {10u, 20u, 30u, 40u, 50u}) {
    std::vector<double> costs;
    glm::vec2 end(0.0f);
    for (int r = 0; r < repeats; ++r) {
      std::mt19937_64 rng(objects);
      AvatarNavigation avatar({0.0f, 0.0f});
      for (std::uint32_t k = 0; k < objects; ++k) {
        const float x = static_cast<float>(navmesh::uniform(rng, -25.0, 25.0));
        const float y = static_cast<float>(navmesh::uniform(rng, -25.0, 25.0));
        if (glm::length(glm::vec2(x, y)) > 3.0f) {
          (void)avatar.setObject(ObjectId{k}, {x, y}, glm::vec2(0.5f), 0.1f * x);
        }
      }
      constexpr int kFrames = 3000;
      const double begin = cpuSeconds();
      for (int k = 0; k < kFrames; ++k) avatar.step(1.0f / 30.0f, true);
      costs.push_back(1e6 * (cpuSeconds() - begin) / kFrames);
      end = avatar.position();
    }
    fmt::print("avatar among {} objects: {:.2f} us a frame, ends at {:.4f}, {:.4f}\n", objects,
               bench::medianOf(costs), end.x, end.y);
  }
}

/// 50 boxes about one avatar that walks between them with HRVO, cost per avatar and frame.
void printFiftyBoxes(int repeats) {
  std::vector<double> costs;
  std::uint64_t hash = 0;
  for (int r = 0; r < repeats; ++r) {
    Crowd crowd;
    AgentSpec spec;
    spec.model = crowd.addModel(makeHrvo());
    const AgentId avatar = *crowd.add(spec);
    std::mt19937_64 rng(4);
    std::vector<navmesh::ObstacleId> boxes;
    const auto box = [&] {
      const float x = static_cast<float>(navmesh::uniform(rng, -10.0, 10.0));
      const float z = static_cast<float>(navmesh::uniform(rng, 2.0, 20.0));
      return navmesh::BoxObstacle{{x, 1.0f, -z}, {0.4f, 1.0f, 0.4f}, 0.3f};
    };
    for (int k = 0; k < 50; ++k) boxes.push_back(*crowd.addObstacle(box()));
    crowd.setGoal(avatar, {0.0f, 25.0f});
    constexpr int kFrames = 600;
    const double begin = cpuSeconds();
    for (int k = 0; k < kFrames; ++k) {
      if (k % 60 == 0) (void)crowd.moveObstacle(boxes[static_cast<std::size_t>(k / 60)], box());
      crowd.step(1.0f / 30.0f);
    }
    costs.push_back(1e6 * (cpuSeconds() - begin) / kFrames);
    hash = crowd.hash();
  }
  fmt::print("50 boxes, one avatar, hrvo: {:.2f} us a frame  {:016x}\n", bench::medianOf(costs),
             hash);
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
    std::vector<testing::NamedModel> models = testing::allModels();
    // As printed in their sources, errors included.
    if (!one.project) {
      SocialForceParameters literal;
      literal.literal = true;
      models.push_back({"social-forces-literal", [literal] { return makeSocialForces(literal); }});
      HrvoParameters thesis;
      thesis.preferredOnly = true;
      models.push_back({"hrvo-thesis", [thesis] { return makeHrvo(thesis); }});
    }
    for (const testing::NamedModel& model : models) {
      if (model.name.rfind(only, 0) != 0) continue;
      std::vector<Run> runs;
      for (int r = 0; r < repeats; ++r)
        runs.push_back(run(one.scene, model, one.project, one.limit));
      print(one.scene.name, model.name + (one.project ? " + projection" : ""), runs);
    }
  }
  fmt::print(
      "us: CPU microseconds per agent, step and sub-step; overlaps: pairs deeper than 1 % of the "
      "sum of "
      "their radii, counted every step; walls: agents deeper than 1 cm in one, counted every "
      "step\n");
  if (onlyScene.empty()) {
    printFiftyBoxes(repeats);
    printThesisSpeed(repeats);
    printTenThousand(repeats);
  }
  return 0;
}
