// What exact distances cost, by horizon: beside the price the work that was done (polygons reached,
// windows, corners where paths bend) and a hash of all corners. How far off the paper's distances
// are without them: bench/prediction_error.
#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <cstring>

#include "bench/timing.h"
#include "bench/worlds.h"
#include "prediction/distance_field.h"
#include "tests/support/random_start.h"

namespace forewalk::bench {
namespace {

/// FNV-1a over all corners.
std::uint64_t hashOf(const prediction::DistanceField& field, std::uint64_t hash) {
  for (const prediction::Corner& corner : field.corners()) {
    std::uint32_t words[4];
    std::memcpy(words, &corner.plan, 8);
    std::memcpy(words + 2, &corner.distance, 4);
    words[3] = corner.previous;
    for (const std::uint32_t word : words) hash = (hash ^ word) * 1099511628211ull;
  }
  return hash;
}

void measureCost(const World& world, int starts, int passes) {
  const prediction::PortalEnds ends = prediction::makePortalEnds(world.graph);
  prediction::DistanceField field(world.graph, ends, {1u << 18});
  const std::vector<navmesh::Location> places = testing::randomStarts(world.graph, starts, 1);
  const double n = static_cast<double>(starts);
  for (const float horizon : {5.0f, 10.0f, 20.0f, 40.0f, 80.0f}) {
    std::vector<double> times;
    double windows = 0.0, polygons = 0.0, corners = 0.0;
    std::uint64_t hash = 14695981039346656037ull;
    for (int pass = -1; pass < passes; ++pass) {  // pass -1 warms up
      for (const navmesh::Location& place : places) {
        const auto begin = std::chrono::steady_clock::now();
        field.run(place, horizon);
        const auto end = std::chrono::steady_clock::now();
        if (field.limitReached()) fmt::print(stderr, "{}: window limit reached\n", world.name);
        if (pass < 0) {
          windows += static_cast<double>(field.windows().size()) / n;
          polygons += static_cast<double>(field.polygons().size()) / n;
          corners += static_cast<double>(field.corners().size()) / n;
          hash = hashOf(field, hash);
        } else {
          times.push_back(std::chrono::duration<double, std::micro>(end - begin).count());
        }
      }
    }
    fmt::print("{:<13} {:>4.0f} {:>9.1f} {:>9.1f} {:>9.1f} {:>9.1f} {:>8.2f} {:>8.1f} {:016x}\n",
               world.name, horizon, medianOf(times), quantileOf(times, 0.99), polygons, windows,
               windows / polygons, corners, hash);
  }
}

}  // namespace
}  // namespace forewalk::bench

int main(int argc, char** argv) {
  using namespace forewalk::bench;
  int starts = 1000;
  int passes = 3;
  std::string only;
  CLI::App app{"Exact distances within the horizon: what they cost"};
  app.add_option("--starts", starts, "random starts a scene, for the cost");
  app.add_option("--passes", passes, "over all starts");
  app.add_option("--scene", only, "one scene only");
  CLI11_PARSE(app, argc, argv);
  const std::vector<World> worlds = bundledWorlds();
  fmt::print("{:<13} {:>4} {:>9} {:>9} {:>9} {:>9} {:>8} {:>8} {}\n", "scene", "d, m", "median us",
             "99th us", "polygons", "windows", "a polyg.", "corners", "hash");
  for (const World& world : worlds) {
    if (only.empty() || world.name == only) measureCost(world, starts, passes);
  }
}
