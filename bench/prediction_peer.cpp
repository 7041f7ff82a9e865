// Our navgraph and Detour on the same navmesh, in the same process, in turns.
//
// Start points are spread over the walkable area (one repeated start flatters everybody), times are
// medians over starts, then over passes. Three kinds of ratio that are never mixed:
//   search   the same search: Detour's findPolysAroundCircle against its rules on our navgraph;
//   every
//            polygon's cost is compared first
//   key, settled  nanoseconds per settled polygon, each its own search: ours limited by its keys,
//   as a plain
//            depth-limited Dijkstra is, and by taut lengths, as predictions are
//   task     our whole graph with the taut limit against Detour's circle, and a corridor and a
//   straight
//            path to each leaf of its tree within d
// and, beside them, the whole graph against a word-for-word transcription of the paper's listing.
#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <map>

#include "bench/circle_search.h"
#include "bench/detour_peer.h"
#include "bench/timing.h"
#include "bench/worlds.h"
#include "prediction/predict.h"
#include "tests/support/paper_listing.h"
#include "tests/support/random_start.h"

namespace forewalk::bench {
namespace {

using prediction::Corner;
using prediction::hashOf;
using prediction::HorizonSearch;
using prediction::Node;
using prediction::NodeId;
using prediction::predict;
using prediction::PredictionGraph;

struct Agreement {
  std::size_t polygons = 0;
  std::size_t onlyOne = 0;    ///< settled by one of the two
  std::size_t different = 0;  ///< cost differs by more than the tolerance
  double worst = 0.0;         ///< metres
};

/// Compares every cost of the same search, one by one. Costs differ where equal ones settle in
/// another order (symmetric furniture does that): a node of Detour's stays at the portal it was
/// first seen through.
Agreement compare(DetourPeer& detour, CircleSearch& ours,
                  const std::vector<navmesh::Location>& starts, float radius, double tolerance) {
  Agreement agreement;
  std::map<std::uint32_t, float> costs;
  for (const navmesh::Location& start : starts) {
    costs.clear();
    for (const auto& visit : detour.circle(start, radius)) costs[visit.polygon] = visit.cost;
    const auto& visits = ours.run(start, radius);
    agreement.polygons += visits.size();
    for (const auto& visit : visits) {
      const auto theirs = costs.find(visit.polygon);
      if (theirs == costs.end()) {
        ++agreement.onlyOne;
        continue;
      }
      const double difference =
          std::abs(static_cast<double>(visit.cost) - static_cast<double>(theirs->second));
      agreement.worst = std::max(agreement.worst, difference);
      if (difference > tolerance) ++agreement.different;
      costs.erase(theirs);
    }
    agreement.onlyOne += costs.size();
  }
  return agreement;
}

struct Setup {
  int starts = 1000;
  int passes = 5;
  int coldStarts = 100;
  std::uint64_t seed = 1;
  std::vector<float> horizons{5.0f, 10.0f, 20.0f, 40.0f, 80.0f};
};

/// Pushes everything out of the caches.
void flushCaches() {
  static std::vector<unsigned char> junk(std::size_t{48} << 20);
  static unsigned char round = 0;
  ++round;
  for (std::size_t i = 0; i < junk.size(); i += 64)
    junk[i] = static_cast<unsigned char>(junk[i] + round);
}

void measure(World& world, const Setup& setup) {
  DetourPeer detour(world.tiles);
  CircleSearch circle(world.graph);
  HorizonSearch search(world.graph, world.graph.polygonCount());
  std::vector<Corner> corners;
  corners.reserve(search.cornerCapacity());
  prediction::Scratch scratch(world.graph, {.polygons = world.graph.polygonCount()});
  const std::vector<navmesh::Location> starts =
      testing::randomStarts(world.graph, setup.starts, setup.seed);

  fmt::print("\n{}: {} polygons, {} half-portals, {} starts, {} passes\n", world.name,
             world.graph.polygonCount(), world.graph.portalCount(), starts.size(), setup.passes);
  fmt::print(
      "{:>4} {:>8} {:>8} {:>7} {:>7} {:>8} {:>8} {:>8} {:>8} {:>8} {:>8} {:>9}  {:>7} {:>7} {:>7} "
      "{:>7} {:>7} {:>7}\n",
      "d m", "circle", "settled", "branch", "termin", "Detour", "itself", "same", "search",
      "D ways", "graph", "listing", "D/D", "search", "key", "settled", "task", "listing");

  for (const float d : setup.horizons) {
    // Detour keeps the ends of portals across tiles in 8 bits, so its costs there differ by
    // centimetres.
    const bool tiled = world.tiles.size() > 1;
    const Agreement same = compare(detour, circle, starts, d, tiled ? 0.25 : 1e-3);

    double circlePolygons = 0, settled = 0, branches = 0, terminals = 0, leaves = 0;
    double detourMetres = 0, ourMetres = 0, keySettled = 0;
    std::uint64_t hash = 0;
    for (const navmesh::Location& start : starts) {
      circlePolygons += detour.circleOnly(start, d);
      leaves += detour.ways(start, d);
      detourMetres += detour.metresOfWays();
      const PredictionGraph& graph = predict(world.graph, start, d, scratch);
      settled += graph.stats.settled;
      search.run(start, d, corners, HorizonSearch::Limit::kKey);
      keySettled += static_cast<double>(search.tree().size());
      terminals += static_cast<double>(graph.terminals.size());
      for (const Node& node : graph.nodes) branches += node.branch ? 1 : 0;
      for (const NodeId id : graph.terminals)
        ourMetres += static_cast<double>(graph.node(id).distance);
      hash = hash * 31 + hashOf(graph);
    }
    const double n = static_cast<double>(starts.size());

    volatile std::size_t sink = 0;
    Contestant theirs{"Detour circle",
                      [&](std::size_t i) {
                        sink = sink + static_cast<std::size_t>(detour.circleOnly(starts[i], d));
                      },
                      {}};
    Contestant again{"Detour circle again", theirs.run, {}};
    Contestant rules{"circle rules on our navgraph",
                     [&](std::size_t i) { sink = sink + circle.run(starts[i], d).size(); },
                     {}};
    Contestant own{"our search", [&](std::size_t i) { search.run(starts[i], d, corners); }, {}};
    Contestant key{
        "our search by keys",
        [&](std::size_t i) { search.run(starts[i], d, corners, HorizonSearch::Limit::kKey); },
        {}};
    Contestant ways{
        "Detour ways",
        [&](std::size_t i) { sink = sink + static_cast<std::size_t>(detour.ways(starts[i], d)); },
        {}};
    Contestant graph{"our graph",
                     [&](std::size_t i) {
                       sink = sink + predict(world.graph, starts[i], d, scratch).nodes.size();
                     },
                     {}};
    Contestant listing{"the paper's listing",
                       [&](std::size_t i) {
                         sink =
                             sink + testing::paperListing(world.graph, starts[i], d).settled.size();
                       },
                       {}};
    timeInTurns({&theirs, &again, &rules, &key, &own, &ways, &graph}, starts.size(), setup.passes);
    timeInTurns({&listing, &graph}, std::min<std::size_t>(starts.size(), 200), 1);

    fmt::print(
        "{:>4.0f} {:>8.1f} {:>8.1f} {:>7.1f} {:>7.1f} {:>8.2f} {:>8.2f} {:>8.2f} {:>8.2f} {:>8.2f} "
        "{:>8.2f} {:>9.2f}  {:>7.2f} {:>7.2f} {:>7.2f} {:>7.2f} {:>7.2f} {:>7.1f}\n",
        d, circlePolygons / n, settled / n, branches / n, terminals / n, theirs.median(),
        again.median(), rules.median(), own.median(), ways.median(), graph.median(),
        listing.median(), theirs.median() / again.median(), theirs.median() / rules.median(),
        (theirs.median() / circlePolygons) / (key.median() / keySettled),
        (theirs.median() / circlePolygons) / (own.median() / settled),
        ways.median() / graph.median(), listing.median() / graph.median());
    fmt::print(
        "     costs: {} polygons, {} settled by one only, {} differ, worst {:.4f} m; "
        "leaves {:.1f} of {:.0f} m, terminals of {:.0f} m; graphs {:016x}\n",
        same.polygons, same.onlyOne, same.different, same.worst, leaves / n, detourMetres / n,
        ourMetres / n, hash);

    if (d == 20.0f) {
      const std::size_t cold =
          std::min<std::size_t>(starts.size(), static_cast<std::size_t>(setup.coldStarts));
      Contestant coldTheirs = theirs, coldWays = ways, coldGraph = graph;
      for (Contestant* c : {&coldTheirs, &coldWays, &coldGraph}) c->passMedians.clear();
      timeInTurns({&coldTheirs, &coldWays, &coldGraph}, cold, 1, flushCaches);
      fmt::print(
          "     cold caches: Detour circle {:.1f} us, Detour ways {:.1f} us, our graph {:.1f} us, "
          "task {:.2f}\n",
          coldTheirs.median(), coldWays.median(), coldGraph.median(),
          coldWays.median() / coldGraph.median());
    }
  }
}

/// The same floor on 100 times the area: does a graph cost the same?
void measureArea(const World& world, const Setup& setup) {
  const World large = repeatedWorld(world, 10, 10);
  const std::vector<navmesh::Location> starts =
      testing::randomStarts(world.graph, setup.starts, setup.seed);
  prediction::Scratch a(world.graph), b(large.graph);
  std::uint64_t hashA = 0, hashB = 0;
  for (const navmesh::Location& start : starts) {
    hashA = hashA * 31 + hashOf(predict(world.graph, start, 20.0f, a));
    hashB = hashB * 31 + hashOf(predict(large.graph, start, 20.0f, b));
  }
  Contestant small{"", [&](std::size_t i) { predict(world.graph, starts[i], 20.0f, a); }, {}};
  Contestant big{"", [&](std::size_t i) { predict(large.graph, starts[i], 20.0f, b); }, {}};
  timeInTurns({&small, &big}, starts.size(), setup.passes);
  fmt::print(
      "\n100 times the area, {}: {} against {} polygons, d = 20 m: {:.2f} against {:.2f} us, ratio "
      "{:.3f}, graphs {}\n",
      world.name, large.graph.polygonCount(), world.graph.polygonCount(), big.median(),
      small.median(), big.median() / small.median(), hashA == hashB ? "equal" : "DIFFER");
}

}  // namespace
}  // namespace forewalk::bench

int main(int argc, char** argv) {
  forewalk::bench::Setup setup;
  std::string only;
  CLI::App app{"Prediction against Detour and against the paper's listing; microseconds, medians"};
  app.add_option("--starts", setup.starts, "start points a scene, spread by area");
  app.add_option("--passes", setup.passes, "timed passes over all starts");
  app.add_option("--horizons", setup.horizons, "metres");
  app.add_option("--seed", setup.seed, "of the start points");
  app.add_option("--scene", only, "only the world of this name");
  CLI11_PARSE(app, argc, argv);
  fmt::print(
      "Times in microseconds: Detour's circle, itself again, the same search on our navgraph, our\n"
      "search, Detour's ways, our graph, the listing. Then the ratios.\n");
  std::vector<forewalk::bench::World> worlds = forewalk::bench::bundledWorlds();
  for (auto& world : worlds) {
    if (only.empty() || world.name == only) forewalk::bench::measure(world, setup);
  }
  if (only.empty()) forewalk::bench::measureArea(worlds.front(), setup);
}
