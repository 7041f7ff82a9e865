// What graphs by fronts cost, by horizon, beside the paper's method in the same run, in turns; and
// what a thousand users in one world cost. Beside the prices what was found, and a hash of all
// graphs, so that a faster version can show that it finds the same.
#include <fmt/core.h>
#include <malloc.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <memory>

#include "bench/timing.h"
#include "bench/worlds.h"
#include "navmesh/random.h"
#include "prediction/front_graph.h"
#include "prediction/likelihood.h"
#include "prediction/predict.h"
#include "tests/support/random_start.h"

namespace forewalk::bench {
namespace {

using Clock = std::chrono::steady_clock;

/// What was found, on average over the starts.
struct Found {
  double polygons = 0.0, nodes = 0.0, terminals = 0.0;
  std::uint64_t hash = 14695981039346656037ull;  // FNV-1a over the hashes of the graphs
};

Found findAll(const navmesh::NavGraph& graph, const std::vector<navmesh::Location>& places,
              float horizon, prediction::FrontScratch& scratch, const std::string& name) {
  Found found;
  const double n = static_cast<double>(places.size());
  for (const navmesh::Location& place : places) {
    const auto& ways = prediction::predictFronts(graph, place, horizon, scratch);
    if (ways.flags != 0) fmt::print(stderr, "{}: window limit reached at {} m\n", name, horizon);
    found.polygons += static_cast<double>(ways.stats.settled) / n;
    found.nodes += static_cast<double>(ways.nodes.size()) / n;
    found.terminals += static_cast<double>(ways.terminals.size()) / n;
    found.hash = (found.hash ^ prediction::hashOf(ways)) * 1099511628211ull;
  }
  return found;
}

void measureCost(const World& world, const std::vector<float>& horizons, int starts, int passes) {
  const prediction::FrontIndex index = prediction::makeFrontIndex(world.graph);
  const prediction::DistanceLimits limits{1u << 19};
  prediction::FrontScratch front(world.graph, index, limits);
  prediction::DistanceField field(world.graph, index.ends, limits);
  prediction::Scratch polygon(world.graph, {.polygons = world.graph.polygonCount()});
  const std::vector<navmesh::Location> places = testing::randomStarts(world.graph, starts, 1);
  for (const float horizon : horizons) {
    const Found found = findAll(world.graph, places, horizon, front, world.name);
    std::vector<double> fronts, fields, polygons;
    const auto timed = [](std::vector<double>& times, const auto& run) {
      const auto begin = Clock::now();
      run();
      times.push_back(std::chrono::duration<double, std::micro>(Clock::now() - begin).count());
    };
    for (int pass = 0; pass < passes; ++pass) {
      // In turns of a few, so that all share the machine's moods and none its caches alone.
      constexpr std::size_t kTurn = 50;
      for (std::size_t begin = 0; begin < places.size(); begin += kTurn) {
        const std::size_t end = std::min(places.size(), begin + kTurn);
        for (std::size_t i = begin; i < end; ++i) {
          timed(fronts, [&] { predictFronts(world.graph, places[i], horizon, front); });
        }
        for (std::size_t i = begin; i < end; ++i) {
          timed(polygons, [&] { predict(world.graph, places[i], horizon, polygon); });
        }
        for (std::size_t i = begin; i < end; ++i) {
          timed(fields, [&] { field.run(places[i], horizon); });
        }
      }
    }
    const double median = medianOf(fronts);
    fmt::print(
        "{:<13} {:>4.0f} {:>9.1f} {:>9.1f} {:>9.1f} {:>9.1f} {:>6.2f} {:>9.1f} {:>9.3f} {:>7.1f} "
        "{:>9.1f} {:016x}\n",
        world.name, horizon, median, quantileOf(fronts, 0.99), medianOf(fields), medianOf(polygons),
        median / medianOf(polygons), found.polygons, median / found.polygons, found.nodes,
        found.terminals, found.hash);
    std::fflush(stdout);
  }
}

std::size_t bytesInUse() {
  const struct mallinfo2 info = mallinfo2();
  return info.uordblks + info.hblkhd;
}

/// Somebody who walks along predicted ways, one after the other.
struct Walker {
  navmesh::Location at;
  std::vector<glm::vec3> way;
  std::size_t next = 1;  ///< corner of the way ahead
};

/// Moves a walker on by `step` metres, and onto another of the latest ways at the end of one.
void walk(const navmesh::NavGraph& graph, const navmesh::LocationIndex& locations,
          const prediction::PredictionGraph& ways, float step, std::mt19937_64& rng,
          Walker& walker) {
  glm::vec2 plan = walker.at.plan;
  while (step > 0.0f && walker.next < walker.way.size()) {
    const glm::vec2 corner = navmesh::toPlan(walker.way[walker.next]);
    const float leg = glm::distance(plan, corner);
    plan = leg > step ? glm::mix(plan, corner, step / leg) : corner;
    walker.next += leg > step ? 0 : 1;
    step -= leg;
  }
  const auto found = locate(graph, locations, navmesh::toSpace(plan, walker.at.height));
  if (found) walker.at = *found;
  if (found && walker.next < walker.way.size()) return;
  walker.way.clear();
  walker.next = 1;
  if (ways.terminals.empty()) return;
  const auto count = static_cast<std::uint32_t>(ways.terminals.size());
  wayTo(ways, ways.terminals[navmesh::uniformInt(rng, count)], walker.way);
}

/// What a frame costs somebody who walks: the graph, and all that is told of its ways (names and
/// likelihoods), beside the paper's graph, frame by frame in turns.
void measureWalks(const World& world, float horizon) {
  constexpr int kWalkers = 40;
  constexpr int kFrames = 270;
  constexpr float kStep = 1.3f / 90.0f;  // metres a frame
  const prediction::FrontIndex index = prediction::makeFrontIndex(world.graph);
  const navmesh::LocationIndex locations = navmesh::makeLocationIndex(world.graph);
  prediction::FrontScratch front(world.graph, index, {1u << 16});
  prediction::Scratch polygon(world.graph, {.polygons = world.graph.polygonCount()});
  std::vector<double> graphs, names, wholes, polygons;
  std::mt19937_64 rng(4);
  std::uint64_t hash = 14695981039346656037ull;
  const auto since = [](Clock::time_point begin) {
    return std::chrono::duration<double, std::micro>(Clock::now() - begin).count();
  };
  for (const navmesh::Location& place : testing::randomStarts(world.graph, kWalkers, 4)) {
    Walker walker{place, {}, 1};
    prediction::WayLikelihood likelihood;
    for (int frame = 0; frame < kFrames; ++frame) {
      auto begin = Clock::now();
      predict(world.graph, walker.at, horizon, polygon);
      polygons.push_back(since(begin));
      begin = Clock::now();
      const auto& ways = predictFronts(world.graph, walker.at, horizon, front);
      graphs.push_back(since(begin));
      begin = Clock::now();
      likelihood.update(ways, {.seconds = 1.0 / 90.0, .head = {}, .gaze = {}});
      names.push_back(since(begin));
      wholes.push_back(graphs.back() + names.back());
      hash = (hash ^ prediction::hashOf(ways)) * 1099511628211ull;
      walk(world.graph, locations, ways, kStep, rng, walker);
    }
  }
  fmt::print("{:<13} {:>4.0f} {:>9.1f} {:>9.1f} {:>9.1f} {:>9.1f} {:>9.1f} {:>6.2f} {:016x}\n",
             world.name, horizon, medianOf(graphs), medianOf(names), medianOf(wholes),
             quantileOf(wholes, 0.99), medianOf(polygons), medianOf(wholes) / medianOf(polygons),
             hash);
  std::fflush(stdout);
}

/// A thousand users in one world on one core, ten times a second.
void measureCrowd(const World& world, float horizon, std::uint32_t windows) {
  constexpr int kUsers = 1000;
  constexpr int kSeconds = 5;
  constexpr double kRate = 10.0;  // 1/s
  constexpr float kSpeed = 1.3f;  // m/s
  const prediction::FrontIndex index = prediction::makeFrontIndex(world.graph);
  const navmesh::LocationIndex locations = navmesh::makeLocationIndex(world.graph);
  std::vector<Walker> walkers;
  for (const navmesh::Location& place : testing::randomStarts(world.graph, kUsers, 2)) {
    walkers.push_back({place, {}, 1});
  }
  const std::size_t before = bytesInUse();
  std::vector<std::unique_ptr<prediction::FrontScratch>> scratches;
  for (int user = 0; user < kUsers; ++user) {
    scratches.push_back(std::make_unique<prediction::FrontScratch>(
        world.graph, index, prediction::DistanceLimits{windows}));
  }
  std::mt19937_64 rng(3);
  std::vector<double> rounds, times;
  std::size_t limited = 0;
  for (int round = 0; round < kSeconds * static_cast<int>(kRate); ++round) {
    double sum = 0.0;
    for (std::size_t user = 0; user < walkers.size(); ++user) {
      const auto begin = Clock::now();
      const auto& ways = predictFronts(world.graph, walkers[user].at, horizon, *scratches[user]);
      const double seconds = std::chrono::duration<double>(Clock::now() - begin).count();
      sum += seconds;
      times.push_back(1e6 * seconds);
      limited += (ways.flags & prediction::kPolygonLimit) != 0 ? 1 : 0;
      walk(world.graph, locations, ways, kSpeed / static_cast<float>(kRate), rng, walkers[user]);
    }
    rounds.push_back(sum * kRate);
  }
  const double bytes = static_cast<double>(bytesInUse() - before) / kUsers;
  fmt::print("{:<13} {:>4.0f} {:>7} {:>9.1f} {:>9.1f} {:>13.0f} {:>13.0f} {:>9.0f} {:>8}\n",
             world.name, horizon, kUsers, medianOf(times), quantileOf(times, 0.99),
             100.0 * medianOf(rounds), 100.0 * quantileOf(rounds, 1.0), bytes / 1024.0, limited);
}

}  // namespace
}  // namespace forewalk::bench

int main(int argc, char** argv) {
  using namespace forewalk::bench;
  int starts = 1000;
  int passes = 3;
  std::vector<float> horizons{5.0f, 10.0f, 20.0f, 40.0f, 80.0f, 100.0f};
  std::uint32_t windows = 4096;
  std::string only;
  CLI::App app{"Graphs by fronts: what they cost, beside the paper's"};
  app.add_option("--starts", starts, "random starts a scene");
  app.add_option("--passes", passes, "over all starts; 0: no costs of single users");
  app.add_option("--horizon", horizons, "metres");
  app.add_option("--scene", only, "one scene only");
  app.add_option("--crowd-windows", windows,
                 "window limit of each of the thousand users; 0: without them");
  CLI11_PARSE(app, argc, argv);
  const std::vector<World> worlds = bundledWorlds();
  const auto wanted = [&](const World& world) { return only.empty() || world.name == only; };
  if (passes > 0) {
    fmt::print("{:<13} {:>4} {:>9} {:>9} {:>9} {:>9} {:>6} {:>9} {:>9} {:>7} {:>9} {}\n", "scene",
               "d, m", "front us", "99th us", "field us", "polyg. us", "ratio", "polygons",
               "us a p.", "nodes", "terminals", "hash");
  }
  for (const World& world : worlds) {
    if (passes > 0 && wanted(world)) measureCost(world, horizons, starts, passes);
  }
  fmt::print("\n{:<13} {:>4} {:>9} {:>9} {:>9} {:>9} {:>9} {:>6} {}\n", "on a walk", "d, m",
             "front us", "names us", "both us", "99th us", "polyg. us", "ratio", "hash");
  for (const World& world : worlds) {
    if (wanted(world)) measureWalks(world, 20.0f);
  }
  if (windows == 0) return 0;
  fmt::print("\n{:<13} {:>4} {:>7} {:>9} {:>9} {:>13} {:>13} {:>9} {:>8}\n", "scene", "d, m",
             "users", "front us", "99th us", "% of a core", "worst round %", "KiB each", "limited");
  for (const World& world : worlds) {
    if (wanted(world)) measureCrowd(world, 20.0f, windows);
  }
}
