// How far off is the search's notion of distance? Keys and taut paths against exact shortest paths.
//
// For every polygon within 20 m of random starts on the bundled scenes: the length of the shortest
// path on the walkable area to its centroid (prediction/distance_field.h, which agrees with a
// visibility graph), against
//   key   the length of the walk through portal midpoints that orders our search, plus the last
//   step taut  the length we report: the taut path through the corridor that the search found
// and both once more with centroid-to-centroid lengths in the search, the other reading of the
// paper. A corridor is wrong where its taut path is longer than the shortest by more than 0.1 %.
#include <fmt/core.h>

#include <CLI/CLI.hpp>

#include "bench/timing.h"
#include "bench/worlds.h"
#include "prediction/distance_field.h"
#include "tests/support/paper_listing.h"
#include "tests/support/random_start.h"

namespace forewalk::bench {
namespace {

/// Relative errors of lengths that should be `exact`; at least 0 up to rounding.
struct Errors {
  std::vector<double> values;
  void add(double length, double exact) { values.push_back(length / exact - 1.0); }
  std::string row() const {
    double sum = 0.0, wrong = 0.0;
    for (const double value : values) {
      sum += value;
      wrong += value > 1e-3 ? 1.0 : 0.0;
    }
    const double n = static_cast<double>(values.size());
    return fmt::format("{:>8.2f} {:>8.2f} {:>8.2f} {:>8.2f} {:>10.1f}", 100 * sum / n,
                       100 * medianOf(values), 100 * quantileOf(values, 0.99),
                       100 * quantileOf(values, 1.0), 100 * wrong / n);
  }
};

void measure(const World& world, int starts, float horizon, std::uint64_t seed) {
  const navmesh::NavGraph& graph = world.graph;
  const prediction::PortalEnds ends = prediction::makePortalEnds(graph);
  prediction::DistanceField exactly(graph, ends, {1u << 18});
  struct Reading {
    const char* name;
    testing::EdgeLength length;
    Errors key, taut;
  };
  Reading readings[] = {{"portal midpoints", testing::EdgeLength::kPortalMidpoints, {}, {}},
                        {"centroids", testing::EdgeLength::kCentroids, {}, {}}};
  std::size_t paths = 0;
  for (const navmesh::Location& start : testing::randomStarts(graph, starts, seed)) {
    exactly.run(start, horizon);
    for (Reading& reading : readings) {
      const testing::Listing listing = testing::paperListing(graph, start, horizon, reading.length);
      for (const testing::ListingNode& node : listing.settled) {
        const float exact =
            exactly.distanceAt(navmesh::PolygonId{node.polygon}, graph.centroid[node.polygon]);
        const double shortest = static_cast<double>(exact);
        if (!node.within || node.polygon == index(start.polygon) || shortest < 0.5) continue;
        double key = static_cast<double>(node.dist);
        if (reading.length == testing::EdgeLength::kPortalMidpoints) {
          key += static_cast<double>(graph.portalToCentroid[node.entry]);
        }
        reading.key.add(key, shortest);
        reading.taut.add(static_cast<double>(node.taut), shortest);
        ++paths;
      }
    }
  }
  fmt::print("\n{}: {} polygons, {} starts, {} paths of 0.5 to {:.0f} m; error in per cent\n",
             world.name, graph.polygonCount(), starts, paths, horizon);
  fmt::print("{:<26} {:>8} {:>8} {:>8} {:>8} {:>10}\n", "", "mean", "median", "99th", "worst",
             "wrong, %");
  for (const Reading& reading : readings) {
    fmt::print("{:<26} {}\n", fmt::format("{}: key", reading.name), reading.key.row());
    fmt::print("{:<26} {}\n", fmt::format("{}: taut", reading.name), reading.taut.row());
  }
}

}  // namespace
}  // namespace forewalk::bench

int main(int argc, char** argv) {
  int starts = 20;
  float horizon = 20.0f;
  std::uint64_t seed = 1;
  CLI::App app{"Errors of predicted path lengths against exact shortest paths"};
  app.add_option("--starts", starts, "random starts a scene");
  app.add_option("--horizon", horizon, "metres");
  app.add_option("--seed", seed, "of the starts");
  CLI11_PARSE(app, argc, argv);
  for (const forewalk::bench::World& world : forewalk::bench::bundledWorlds()) {
    forewalk::bench::measure(world, starts, horizon, seed);
  }
}
