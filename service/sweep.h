// The paper's figure: what a prediction graph costs as its horizon grows.
//
// Azmandian et al. 2016 report the mean over 25 random starting points per horizon: 7.5 ms for
// horizons up to 20 m, in Unity.
#pragma once

#include <cstdint>
#include <functional>
#include <random>
#include <span>
#include <string>
#include <vector>

#include "navmesh/locate.h"
#include "navmesh/nav_graph.h"
#include "prediction/prediction_graph.h"

namespace forewalk::service {

/// Random places on a navgraph, as likely everywhere by area (all storeys and components).
/// O(polygons) to make, O(log polygons) a draw. The graph must outlive it.
class PlacesByArea {
 public:
  explicit PlacesByArea(const navmesh::NavGraph& graph);
  navmesh::Location draw(std::mt19937_64& rng) const;

 private:
  const navmesh::NavGraph& graph_;
  std::vector<double> areaUpTo_;  // running sum over polygons
};

struct SweepSettings {
  std::vector<float> horizons;  ///< metres, > 0
  std::uint32_t starts = 25;    ///< per horizon, each horizon its own, >= 1
  std::uint32_t repeats =
      9;  ///< each start is timed so often, between other starts; its median counts
  std::uint64_t seed = 1;
  prediction::Method method = prediction::Method::kPolygon;
};

/// One horizon. Times are over starts, in microseconds; counts are means over starts.
struct SweepRow {
  float horizon;  ///< metres
  std::uint32_t starts;
  double mean, median, p99, worst;
  double settled, nodes, branches, terminals;
  std::uint64_t hash;  ///< of all graphs; the same on every run of one build
};

/// Times predict() or predictFronts(). Starts of all horizons are timed in turn, round after round:
/// a start timed again at once would find its polygons in the cache and flatter the result.
/// `progress` is told (done, total).
std::vector<SweepRow> sweep(const navmesh::NavGraph& graph, const SweepSettings& settings,
                            const std::function<void(std::size_t, std::size_t)>& progress = {});

/// Header and one row per horizon.
std::string toCsv(std::span<const SweepRow> rows);

/// The figure, with the paper's headline beside it.
std::string toPlot(std::span<const SweepRow> rows, const std::string& sceneName);

}  // namespace forewalk::service
