// Random places by area, and what is said about times.
#include "service/sweep.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "navmesh/plan.h"
#include "service/timing.h"

namespace forewalk::service {
namespace {

// Three rectangles in a row: 1 m, 2 m and 7 m long, 1 m deep.
navmesh::NavGraph row() {
  navmesh::PolygonMesh mesh;
  for (const float x : {0.0f, 1.0f, 3.0f, 10.0f}) {
    mesh.vertices.push_back({x, 0, 0});
    mesh.vertices.push_back({x, 0, -1});
  }
  for (const std::uint32_t first : {0u, 2u, 4u}) {
    for (const std::uint32_t vertex : {first, first + 2, first + 3, first + 1})
      mesh.ring.push_back(vertex);
    mesh.ringStart.push_back(static_cast<std::uint32_t>(mesh.ring.size()));
  }
  auto graph = navmesh::makeNavGraph(mesh);
  EXPECT_TRUE(graph.has_value());
  return *graph;
}

TEST(PlacesByArea, LieInTheirPolygonsAndSpreadByArea) {
  const navmesh::NavGraph graph = row();
  const PlacesByArea places(graph);
  std::mt19937_64 rng(5);
  constexpr int kDraws = 20000;
  std::vector<int> hits(graph.polygonCount(), 0);
  double sumX = 0.0, sumY = 0.0;
  for (int i = 0; i < kDraws; ++i) {
    const navmesh::Location place = places.draw(rng);
    ASSERT_TRUE(navmesh::contains(graph, place.polygon, place.plan, 1e-4f));
    ++hits[navmesh::index(place.polygon)];
    sumX += place.plan.x;
    sumY += place.plan.y;
  }
  // Six standard deviations of the counts and means at most.
  EXPECT_NEAR(hits[0], 0.1 * kDraws, 6 * std::sqrt(0.09 * kDraws));
  EXPECT_NEAR(hits[1], 0.2 * kDraws, 6 * std::sqrt(0.16 * kDraws));
  EXPECT_NEAR(sumX / kDraws, 5.0, 6 * 10 / std::sqrt(12.0 * kDraws));
  EXPECT_NEAR(sumY / kDraws, 0.5, 6 / std::sqrt(12.0 * kDraws));
}

TEST(Sweep, HasTheSameHashesWheneverItRunsAndOthersForOtherSeeds) {
  const navmesh::NavGraph graph = row();
  SweepSettings settings;
  settings.horizons = {1.0f, 3.0f};
  settings.starts = 4;
  settings.repeats = 1;
  const auto first = sweep(graph, settings);
  settings.repeats = 3;
  const auto again = sweep(graph, settings);
  settings.seed = 2;
  const auto other = sweep(graph, settings);
  settings.seed = 1;
  settings.method = prediction::Method::kFront;
  const auto byFronts = sweep(graph, settings);
  ASSERT_EQ(first.size(), 2u);
  for (std::size_t i = 0; i < first.size(); ++i) {
    EXPECT_EQ(first[i].hash, again[i].hash);
    EXPECT_NE(first[i].hash, other[i].hash);
    EXPECT_NE(first[i].hash, byFronts[i].hash);
    EXPECT_EQ(byFronts[i].hash, sweep(graph, settings)[i].hash);
    EXPECT_LE(first[i].median, first[i].p99);
    EXPECT_LE(first[i].p99, first[i].worst);
  }
}

TEST(Quantile, IsAValueThatWasMeasured) {
  std::vector<double> none, one{3.0}, four{4.0, 1.0, 3.0, 2.0};
  EXPECT_EQ(quantile(none, 0.5), 0.0);
  EXPECT_EQ(quantile(one, 0.99), 3.0);
  EXPECT_EQ(quantile(four, 0.0), 1.0);
  EXPECT_EQ(quantile(four, 0.5), 2.0);
  EXPECT_EQ(quantile(four, 0.51), 3.0);
  EXPECT_EQ(quantile(four, 1.0), 4.0);
}

TEST(StandardError, ShrinksWithTheRootOfTheCount) {
  EXPECT_EQ(standardError({5.0}), 0.0);
  EXPECT_NEAR(standardError({1.0, 3.0}), 1.0, 1e-12);
  const std::vector<double> eight{1, 3, 1, 3, 1, 3, 1, 3};
  EXPECT_NEAR(standardError(eight), std::sqrt(8.0 / 7.0 / 8.0), 1e-12);
}

}  // namespace
}  // namespace forewalk::service
