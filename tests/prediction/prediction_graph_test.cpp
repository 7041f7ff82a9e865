#include "prediction/prediction_graph.h"

#include <gtest/gtest.h>

#include <cmath>

#include "navmesh/plan.h"
#include "prediction/predict.h"
#include "tests/support/random_mesh.h"
#include "tests/support/random_start.h"

namespace forewalk::prediction {
namespace {

using navmesh::NavGraph;

/// An L: two squares to the right of the first, then two upward from the last, each 2 m.
NavGraph corner() {
  navmesh::PolygonMesh grid = testing::gridMesh(3, 3, 2.0f);
  navmesh::PolygonMesh mesh;
  mesh.vertices = grid.vertices;
  for (const std::uint32_t kept : {0u, 1u, 2u, 5u, 8u}) {
    mesh.ring.insert(mesh.ring.end(), grid.ring.begin() + grid.ringStart[kept],
                     grid.ring.begin() + grid.ringStart[kept + 1]);
    mesh.ringStart.push_back(static_cast<std::uint32_t>(mesh.ring.size()));
  }
  return *navmesh::makeNavGraph(mesh);
}

struct CornerWalk {
  NavGraph graph = corner();
  Scratch scratch{graph};
  glm::vec2 start = graph.centroid[0];
  const PredictionGraph& found = predict(graph, {PolygonId{0}, start, 0.0f, false}, 20.0f, scratch);
  NodeId end = found.terminals.front();
};

TEST(PredictionGraph, WalksAlongAWayByArcLength) {
  const CornerWalk l;
  const Node& end = l.found.node(l.end);
  EXPECT_EQ(pointAlong(l.found, l.end, 0.0f).plan, l.start);
  EXPECT_EQ(pointAlong(l.found, l.end, -3.0f).plan, l.start);
  EXPECT_NEAR(glm::distance(pointAlong(l.found, l.end, 1e9f).plan, end.plan), 0.0f, 1e-5f);
  float walked = 0.0f;
  glm::vec2 last = l.start;
  for (float s = 0.0f; s <= end.distance; s += 0.01f) {
    const WayPoint point = pointAlong(l.found, l.end, s);
    walked += glm::distance(point.plan, last);
    last = point.plan;
    EXPECT_NEAR(walked, s, 2e-3f);
    EXPECT_NEAR(glm::length(point.direction), 1.0f, 1e-5f);
  }
}

TEST(PredictionGraph, FindsTheBendAheadAndNoneBehindIt) {
  const CornerWalk l;
  Bend bend{};
  ASSERT_TRUE(nextBend(l.found, l.end, 0.0f, 0.05f, bend));
  EXPECT_GT(bend.angle, 0.0f);  // a left turn: right along plan x, then up
  EXPECT_NEAR(glm::distance(pointAlong(l.found, l.end, bend.distance).plan, bend.plan), 0.0f,
              1e-4f);
  EXPECT_NEAR(bend.plan.x, 4.0f, 1e-5f);
  EXPECT_NEAR(bend.plan.y, 2.0f, 1e-5f);
  EXPECT_FALSE(nextBend(l.found, l.end, bend.distance, 0.05f, bend));
  EXPECT_FALSE(nextBend(l.found, l.end, 0.0f, 3.0f, bend));
}

TEST(PredictionGraph, ListsEveryWayFromTheSourceFirst) {
  const NavGraph graph = *navmesh::makeNavGraph(testing::randomMesh(4, 15, 15));
  Scratch scratch(graph);
  std::vector<glm::vec3> way;
  for (const navmesh::Location& start : testing::randomStarts(graph, 20, 4)) {
    const PredictionGraph& found = predict(graph, start, 6.0f, scratch);
    for (const NodeId terminal : found.terminals) {
      wayTo(found, terminal, way);
      EXPECT_EQ(navmesh::toPlan(way.front()), start.plan);
      EXPECT_EQ(navmesh::toPlan(way.back()), found.node(terminal).plan);
      // Every metre of it agrees with the point at that arc length.
      float s = 0.0f;
      for (std::size_t i = 1; i < way.size(); ++i) {
        s += glm::distance(navmesh::toPlan(way[i]), navmesh::toPlan(way[i - 1]));
        EXPECT_NEAR(glm::distance(pointAlong(found, terminal, s).plan, navmesh::toPlan(way[i])),
                    0.0f, 1e-3f);
      }
    }
  }
}

TEST(PredictionGraph, NamesTheBranchAheadWhereAllWaysShareIt) {
  // A T: along three squares, then up or down.
  navmesh::PolygonMesh grid = testing::gridMesh(4, 5, 2.0f);
  navmesh::PolygonMesh mesh;
  mesh.vertices = grid.vertices;
  for (const std::uint32_t kept : {8u, 9u, 10u, 11u, 7u, 3u, 15u, 19u}) {
    mesh.ring.insert(mesh.ring.end(), grid.ring.begin() + grid.ringStart[kept],
                     grid.ring.begin() + grid.ringStart[kept + 1]);
    mesh.ringStart.push_back(static_cast<std::uint32_t>(mesh.ring.size()));
  }
  const NavGraph graph = *navmesh::makeNavGraph(mesh);
  Scratch scratch(graph);
  const PredictionGraph& found =
      predict(graph, {PolygonId{0}, graph.centroid[0], 0.0f, false}, 30.0f, scratch);
  const NodeId branch = branchAhead(found);
  ASSERT_NE(branch, kNoNode);
  EXPECT_EQ(found.node(branch).polygon, PolygonId{3});
  EXPECT_EQ(found.childrenOf(branch).size(), 2u);
  EXPECT_EQ(found.terminals.size(), 2u);
  // At the branch itself the ways part at the source.
  const PredictionGraph& there =
      predict(graph, {PolygonId{3}, graph.centroid[3], 0.0f, false}, 30.0f, scratch);
  EXPECT_EQ(branchAhead(there), kNoNode);
  EXPECT_EQ(there.terminals.size(), 3u);
}

}  // namespace
}  // namespace forewalk::prediction
