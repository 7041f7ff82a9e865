#include "service/sweep.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <iterator>
#include <memory>

#include "navmesh/plan.h"
#include "navmesh/random.h"
#include "prediction/front_graph.h"
#include "prediction/predict.h"
#include "service/plot.h"
#include "service/timing.h"

namespace forewalk::service {
namespace {

constexpr double kPaperMicroseconds = 7500.0;  // mean up to 20 m, Azmandian et al. 2016
constexpr double kPaperHorizon = 20.0;

struct Start {
  navmesh::Location place;
  std::size_t row;
  std::vector<double> times;
  std::uint32_t settled = 0, nodes = 0, branches = 0, terminals = 0;
  std::uint64_t hash = 0;
};

// What is timed: one method with room for the whole graph, since a cut one costs less.
class Contestant {
 public:
  Contestant(const navmesh::NavGraph& graph, prediction::Method method) : graph_(graph) {
    if (method == prediction::Method::kFront) {
      index_ = prediction::makeFrontIndex(graph);
      prediction::DistanceLimits limits;
      limits.windows = std::max(limits.windows, 4 * graph.polygonCount());
      fronts_ = std::make_unique<prediction::FrontScratch>(graph, index_, limits);
    } else {
      prediction::PredictionLimits limits;
      limits.polygons = std::max(limits.polygons, graph.polygonCount());
      polygons_ = std::make_unique<prediction::Scratch>(graph, limits);
    }
  }

  const prediction::PredictionGraph& predict(const navmesh::Location& place, float horizon) const {
    return fronts_ ? prediction::predictFronts(graph_, place, horizon, *fronts_)
                   : prediction::predict(graph_, place, horizon, *polygons_);
  }

 private:
  const navmesh::NavGraph& graph_;
  prediction::FrontIndex index_;
  std::unique_ptr<prediction::FrontScratch> fronts_;
  std::unique_ptr<prediction::Scratch> polygons_;
};

// Order matters, so that exchanged graphs are noticed.
std::uint64_t combined(std::uint64_t hash, std::uint64_t next) {
  return (hash ^ next) * 0x100000001b3ull;
}

}  // namespace

PlacesByArea::PlacesByArea(const navmesh::NavGraph& graph) : graph_(graph) {
  double sum = 0.0;
  for (std::uint32_t p = 0; p < graph.polygonCount(); ++p) {
    sum += navmesh::areaOf(graph, navmesh::PolygonId{p});
    areaUpTo_.push_back(sum);
  }
}

navmesh::Location PlacesByArea::draw(std::mt19937_64& rng) const {
  assert(!areaUpTo_.empty());
  const double area = navmesh::uniform(rng) * areaUpTo_.back();
  const auto found = std::upper_bound(areaUpTo_.begin(), areaUpTo_.end(), area);
  const auto p = static_cast<std::uint32_t>(
      std::min<std::ptrdiff_t>(found - areaUpTo_.begin(), std::ssize(areaUpTo_) - 1));
  const navmesh::PolygonId polygon{p};
  const auto ring = graph_.ringOf(polygon);

  // A triangle of the fan from the first corner, by area; then a place in it.
  double left = navmesh::uniform(rng) * 2.0 * navmesh::areaOf(graph_, polygon);
  std::size_t triangle = 1;
  for (; triangle + 2 < ring.size(); ++triangle) {
    const double twice = navmesh::turn(ring[0], ring[triangle], ring[triangle + 1]);
    if (left < twice) break;
    left -= twice;
  }
  const auto root = static_cast<float>(std::sqrt(navmesh::uniform(rng)));
  const auto across = static_cast<float>(navmesh::uniform(rng));
  const glm::vec2 plan =
      glm::mix(ring[0], glm::mix(ring[triangle], ring[triangle + 1], across), root);
  return {polygon, plan, navmesh::heightAt(graph_, polygon, plan), false};
}

std::vector<SweepRow> sweep(const navmesh::NavGraph& graph, const SweepSettings& settings,
                            const std::function<void(std::size_t, std::size_t)>& progress) {
  const PlacesByArea places(graph);
  std::mt19937_64 rng(settings.seed);
  std::vector<Start> starts;
  for (std::size_t row = 0; row < settings.horizons.size(); ++row) {
    for (std::uint32_t i = 0; i < settings.starts; ++i)
      starts.push_back({places.draw(rng), row, {}});
  }
  const Contestant contestant(graph, settings.method);

  // One round more than is counted: in the first, buffers still grow.
  for (std::uint32_t round = 0; round <= settings.repeats; ++round) {
    for (Start& start : starts) {
      const Stopwatch watch;
      const prediction::PredictionGraph& made =
          contestant.predict(start.place, settings.horizons[start.row]);
      const double time = watch.microseconds();
      if (round > 0) {
        start.times.push_back(time);
        continue;
      }
      start.settled = made.stats.settled;
      start.nodes = static_cast<std::uint32_t>(made.nodes.size());
      start.terminals = static_cast<std::uint32_t>(made.terminals.size());
      start.branches = static_cast<std::uint32_t>(
          std::count_if(made.nodes.begin(), made.nodes.end(),
                        [](const prediction::Node& n) { return n.branch; }));
      start.hash = prediction::hashOf(made);
    }
    if (progress) progress(round + 1, settings.repeats + 1);
  }

  std::vector<SweepRow> rows;
  for (std::size_t row = 0; row < settings.horizons.size(); ++row) {
    SweepRow result{};
    result.horizon = settings.horizons[row];
    result.starts = settings.starts;
    result.hash = 0xcbf29ce484222325ull;
    std::vector<double> times;
    const double share = 1.0 / settings.starts;
    for (Start& start : starts) {
      if (start.row != row) continue;
      times.push_back(quantile(start.times, 0.5));
      result.settled += share * start.settled;
      result.nodes += share * start.nodes;
      result.branches += share * start.branches;
      result.terminals += share * start.terminals;
      result.hash = combined(result.hash, start.hash);
    }
    result.mean = mean(times);
    result.median = quantile(times, 0.5);
    result.p99 = quantile(times, 0.99);
    result.worst = quantile(times, 1.0);
    rows.push_back(result);
  }
  return rows;
}

std::string toCsv(std::span<const SweepRow> rows) {
  std::string text =
      "horizon_m,starts,mean_us,median_us,p99_us,worst_us,settled,nodes,branch_nodes,terminals,"
      "hash\n";
  for (const SweepRow& row : rows) {
    fmt::format_to(std::back_inserter(text),
                   "{:g},{},{:.3f},{:.3f},{:.3f},{:.3f},{:.1f},{:.1f},{:.1f},{:.1f},{:016x}\n",
                   row.horizon, row.starts, row.mean, row.median, row.p99, row.worst, row.settled,
                   row.nodes, row.branches, row.terminals, row.hash);
  }
  return text;
}

std::string toPlot(std::span<const SweepRow> rows, const std::string& sceneName) {
  PlotSeries averages{"mean", "#2f5fb3", {}};
  PlotSeries medians{"median", "#1f9d55", {}};
  PlotSeries tails{"99th percentile", "#d6353a", {}, true};
  const SweepRow* paper = nullptr;
  for (const SweepRow& row : rows) {
    averages.points.emplace_back(row.horizon, row.mean);
    medians.points.emplace_back(row.horizon, row.median);
    tails.points.emplace_back(row.horizon, row.p99);
    if (row.horizon <= kPaperHorizon && (!paper || row.horizon > paper->horizon)) paper = &row;
  }
  LinePlot plot;
  plot.title = "What a prediction graph costs";
  plot.subtitle = fmt::format("{}: {} random starting points per horizon, spread by area",
                              sceneName, rows.empty() ? 0 : rows.front().starts);
  plot.xName = "horizon, m";
  plot.yName = "time per graph, µs";
  plot.series = {averages, medians, tails};
  plot.notes.emplace_back(
      "For comparison: 7.5 ms (7500 µs) on average up to 20 m in Azmandian et al. 2016 (Unity, "
      "their scene);");
  if (paper && paper->mean > 0) {
    plot.notes.push_back(
        fmt::format("here {:.1f} µs on average at {:g} m on this machine, {:.0f} times less.",
                    paper->mean, paper->horizon, kPaperMicroseconds / paper->mean));
  }
  return toSvg(plot);
}

}  // namespace forewalk::service
