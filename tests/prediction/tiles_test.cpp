// Prediction on built navmeshes: tiles against one piece, both against exact shortest paths.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "navmesh/build/build.h"
#include "navmesh/build/scene.h"
#include "navmesh/plan.h"
#include "prediction/predict.h"
#include "tests/support/random_start.h"
#include "tests/support/visibility.h"

namespace forewalk::prediction {
namespace {

using navmesh::Location;
using navmesh::NavGraph;

NavGraph built(float tile) {
  navmesh::BuildSettings settings;
  settings.tile = tile;
  const auto scene =
      navmesh::importScene(std::filesystem::path(FOREWALK_ASSETS "/scenes/office.obj"));
  const auto mesh = navmesh::buildNavMesh(*scene, settings);
  return *navmesh::makeNavGraph(navmesh::flatten(*mesh));
}

/// Length of the taut path from the source of the last run to a place, or infinity where the search
/// did not come.
float distanceTo(HorizonSearch& search, const std::vector<Corner>& corners, const Location& place) {
  const std::uint32_t at = search.treeIndexOf(place.polygon);
  if (at == kNone) return INFINITY;
  const Corner& before = corners[search.cornerBefore(at, place.plan)];
  return before.distance + glm::distance(before.plan, place.plan);
}

TEST(PredictOnTiles, FindsTheSameDistancesAsInOnePiece) {
  const NavGraph solo = built(0.0f), tiled = built(6.4f);
  const navmesh::LocationIndex soloPlaces = navmesh::makeLocationIndex(solo);
  const navmesh::LocationIndex tiledPlaces = navmesh::makeLocationIndex(tiled);
  const testing::VisibilityGraph exactly(solo);
  HorizonSearch soloSearch(solo, solo.polygonCount()), tiledSearch(tiled, tiled.polygonCount());
  std::vector<Corner> soloCorners, tiledCorners;

  std::vector<float> differences;
  for (const Location& start : testing::randomStarts(solo, 12, 1)) {
    const auto tiledStart = navmesh::locate(tiled, tiledPlaces, start.position());
    ASSERT_TRUE(tiledStart);
    soloSearch.run(start, 200.0f, soloCorners);
    tiledSearch.run(*tiledStart, 200.0f, tiledCorners);
    const std::vector<Location> goals = testing::randomStarts(solo, 40, 2);
    std::vector<testing::PlanPlace> places;
    for (const Location& goal : goals) places.push_back({goal.polygon, goal.plan});
    const std::vector<float> exact = exactly.shortest({start.polygon, start.plan}, places);
    for (std::size_t i = 0; i < goals.size(); ++i) {
      const auto tiledGoal = navmesh::locate(tiled, tiledPlaces, goals[i].position());
      ASSERT_TRUE(tiledGoal);
      const float inOnePiece = distanceTo(soloSearch, soloCorners, goals[i]);
      const float inTiles = distanceTo(tiledSearch, tiledCorners, *tiledGoal);
      ASSERT_TRUE(std::isfinite(inOnePiece));
      ASSERT_TRUE(std::isfinite(inTiles));
      EXPECT_GE(inOnePiece, exact[i] - 1e-3f);
      // The border of tiles is simplified piece by piece: it may leave the solo border by a voxel.
      EXPECT_GE(inTiles, exact[i] - 0.3f);
      differences.push_back(std::abs(inTiles - inOnePiece) / (1.0f + exact[i]));
    }
  }
  std::sort(differences.begin(), differences.end());
  EXPECT_LT(differences[differences.size() / 2], 0.01f);
  EXPECT_LT(differences[differences.size() * 8 / 10], 0.05f);
}

TEST(PredictOnTiles, EndsNoWayNearerThanTheStraightLineOrBeyondTheHorizon) {
  for (const float tile : {0.0f, 6.4f}) {
    const NavGraph graph = built(tile);
    Scratch scratch(graph);
    for (const Location& start : testing::randomStarts(graph, 30, 3)) {
      const PredictionGraph& found = predict(graph, start, 15.0f, scratch);
      EXPECT_FALSE(found.terminals.empty());
      for (const NodeId terminal : found.terminals) {
        const Node& node = found.node(terminal);
        EXPECT_GE(node.distance, glm::distance(node.plan, start.plan) - 1e-3f);
        EXPECT_LE(node.distance, 15.0f);
      }
    }
  }
}

}  // namespace
}  // namespace forewalk::prediction
