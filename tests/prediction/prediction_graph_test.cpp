#include "prediction/prediction_graph.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "navmesh/plan.h"
#include "prediction/front_graph.h"
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

/// How far below or above the surface of the corridor's polygons `point` lies, metres.
float offTheGround(const NavGraph& graph, std::span<const PolygonId> corridor, glm::vec3 point) {
  float nearest = 1e9f;
  for (const PolygonId polygon : corridor) {
    const glm::vec2 plan = navmesh::toPlan(point);
    if (!navmesh::contains(graph, polygon, plan, 1e-3f)) continue;
    nearest = std::min(nearest, std::abs(point.y - navmesh::heightAt(graph, polygon, plan)));
  }
  return nearest;
}

TEST(PredictionGraph, LiftsEveryEdgeOntoTheGround) {
  testing::RandomMeshOptions rough;
  rough.heights = 0.6f;
  const NavGraph graph = *navmesh::makeNavGraph(testing::randomMesh(7, 12, 12, rough));
  Scratch scratch(graph);
  std::vector<std::uint32_t> portals;
  std::vector<glm::vec3> lifted;
  std::size_t bends = 0;
  for (const navmesh::Location& start : testing::randomStarts(graph, 40, 7)) {
    const PredictionGraph& found = predict(graph, start, 8.0f, scratch);
    for (const Edge& edge : found.edges) {
      liftEdge(graph, found, edge, portals, lifted);
      const auto path = found.pathOf(edge);
      ASSERT_GE(lifted.size(), path.size());
      bends += lifted.size() - path.size();
      std::size_t corner = 0;
      for (const glm::vec3 point : lifted) {
        if (corner < path.size() && navmesh::toPlan(point) == path[corner]) ++corner;
      }
      EXPECT_EQ(corner, path.size()) << "a corner of the path is missing";
      for (std::size_t i = 1; i < lifted.size(); ++i) {
        for (float share = 0.0f; share <= 1.0f; share += 0.125f) {
          const glm::vec3 point = glm::mix(lifted[i - 1], lifted[i], share);
          ASSERT_LT(offTheGround(graph, found.corridorOf(edge), point), 0.022f);
        }
      }
    }
  }
  EXPECT_GT(bends, 1000u);
}

TEST(PredictionGraph, LiftsEdgesOfFrontsThroughThePolygonsUnderTheirPath) {
  testing::RandomMeshOptions rough;
  rough.heights = 0.6f;
  rough.holeShare = 0.15;
  const NavGraph graph = *navmesh::makeNavGraph(testing::randomMesh(7, 12, 12, rough));
  const FrontIndex index = makeFrontIndex(graph);
  FrontScratch scratch(graph, index);
  std::vector<std::uint32_t> portals;
  std::vector<glm::vec3> lifted;
  std::vector<PolygonId> corridor;
  std::size_t edges = 0;
  float worst = 0.0f;
  for (const navmesh::Location& start : testing::randomStarts(graph, 60, 7)) {
    const PredictionGraph& found = predictFronts(graph, start, 8.0f, scratch, {0.2f});
    for (const Edge& edge : found.edges) {
      liftEdge(graph, found, edge, portals, lifted);
      corridor.assign(1, found.node(edge.from).polygon);
      for (const std::uint32_t portal : portals) corridor.push_back(graph.portalTo[portal]);
      for (std::size_t i = 1; i < lifted.size(); ++i) {
        for (float share = 0.0f; share <= 1.0f; share += 0.125f) {
          const glm::vec3 point = glm::mix(lifted[i - 1], lifted[i], share);
          worst = std::max(worst, offTheGround(graph, corridor, point));
        }
      }
      ++edges;
    }
  }
  EXPECT_GT(edges, 300u);
  EXPECT_LT(worst, 0.04f);
}

TEST(PredictionGraph, LiftsEdgesThroughWhicheverDoorJoinsTwoFloors) {
  // A level floor and a ramp that begins where it ends, with a narrow and a wide door between them.
  navmesh::PolygonMesh mesh;
  mesh.vertices = {{0, 0, 0}, {4, 0, 0},  {4, 0, -4},  {0, 0, -4},
                   {4, 0, 0}, {12, 4, 0}, {12, 4, -4}, {4, 0, -4}};
  mesh.ring = {0, 1, 2, 3, 4, 5, 6, 7};
  mesh.ringStart = {0, 4, 8};
  mesh.borderPortals = {{PolygonId{0}, PolygonId{1}, 1, 3, {4, 0, -0.5f}, {4, 0, -0.2f}},
                        {PolygonId{0}, PolygonId{1}, 1, 3, {4, 0, -3.8f}, {4, 0, -1.5f}}};
  const NavGraph graph = *navmesh::makeNavGraph(mesh);
  Scratch scratch(graph);
  std::vector<std::uint32_t> portals;
  std::vector<glm::vec3> lifted;
  for (const navmesh::Location& start : testing::randomStarts(graph, 50, 3)) {
    const PredictionGraph& found = predict(graph, start, 20.0f, scratch);
    ASSERT_EQ(found.edges.size(), 1u);
    liftEdge(graph, found, found.edges[0], portals, lifted);
    ASSERT_EQ(portals.size(), 1u);
    EXPECT_EQ(graph.portalTo[portals[0]], start.polygon);
    for (std::size_t i = 1; i < lifted.size(); ++i) {
      const glm::vec3 middle = glm::mix(lifted[i - 1], lifted[i], 0.5f);
      EXPECT_NEAR(middle.y, 0.5f * std::max(0.0f, middle.x - 4.0f), 0.021f);
    }
  }
}

}  // namespace
}  // namespace forewalk::prediction
