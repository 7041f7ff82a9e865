#include "navmesh/nav_graph.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <set>

#include "navmesh/plan.h"
#include "navmesh/random.h"
#include "tests/support/random_mesh.h"

namespace forewalk::navmesh {
namespace {

using ::testing::HasSubstr;

NavGraph graphOf(const PolygonMesh& mesh) {
  auto graph = makeNavGraph(mesh);
  EXPECT_TRUE(graph) << graph.error().message;
  return graph ? *graph : NavGraph{};
}

// Meshes of every kind the tests can make, with and without heights and partial portals.
std::vector<PolygonMesh> meshes() {
  std::vector<PolygonMesh> all{testing::gridMesh(1, 1), testing::gridMesh(4, 3, 2.5f),
                               testing::corridorMesh(std::vector<float>{1.0f, 0.5f, 3.0f}),
                               testing::joinedGrids(3, 2, 3, 6.0f)};
  testing::RandomMeshOptions uneven;
  uneven.heights = 0.4f;
  for (std::uint64_t seed = 0; seed < 8; ++seed) {
    all.push_back(testing::randomMesh(seed, 9, 7));
    all.push_back(testing::randomMesh(seed + 100, 6, 6, uneven));
    all.push_back(
        testing::joinedAlong(testing::randomMesh(seed, 4, 6), testing::randomMesh(seed + 1, 5, 6)));
  }
  return all;
}

std::vector<PolygonId> neighboursOf(const NavGraph& graph, std::uint32_t polygon) {
  return {graph.portalTo.begin() + graph.portalStart[polygon],
          graph.portalTo.begin() + graph.portalStart[polygon + 1]};
}

void expectRefused(const PolygonMesh& mesh, ErrorCode code, const std::string& words) {
  const auto graph = makeNavGraph(mesh);
  ASSERT_FALSE(graph) << "expected: " << words;
  EXPECT_EQ(graph.error().code, code);
  EXPECT_THAT(graph.error().message, HasSubstr(words));
}

TEST(MakeNavGraph, RefusesAMeshWithoutPolygons) {
  expectRefused(PolygonMesh{}, ErrorCode::kSceneEmpty, "no polygon");
}

TEST(MakeNavGraph, RefusesIndicesOutOfRange) {
  PolygonMesh mesh = testing::gridMesh(2, 1);
  mesh.ring[5] = 77;
  expectRefused(mesh, ErrorCode::kDataDamaged, "polygon 1 names vertex 77");
}

TEST(MakeNavGraph, RefusesCoordinatesThatAreNotFinite) {
  for (const float wild :
       {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
    PolygonMesh mesh = testing::gridMesh(2, 1);
    mesh.vertices[3].y = wild;
    expectRefused(mesh, ErrorCode::kDataDamaged, "vertex 3");
  }
}

TEST(MakeNavGraph, RefusesRingsThatAreNoConvexPolygon) {
  PolygonMesh two = testing::gridMesh(2, 2);
  two.ringStart.assign({0, 2, 8, 12, 16});
  expectRefused(two, ErrorCode::kDataDamaged, "polygon 0 has 2 corners");

  PolygonMesh clockwise = testing::gridMesh(1, 1);
  std::reverse(clockwise.ring.begin(), clockwise.ring.end());
  expectRefused(clockwise, ErrorCode::kDataDamaged, "polygon 0");

  PolygonMesh dented = testing::gridMesh(1, 1);
  dented.vertices[dented.ring[0]] = toSpace({0.52f, 0.52f}, 0.0f);
  expectRefused(dented, ErrorCode::kDataDamaged, "polygon 0");
}

TEST(MakeNavGraph, KeepsARingWithinAMillimetreOfConvex) {
  PolygonMesh mesh = testing::gridMesh(2, 1);
  mesh.vertices[mesh.ring[0]] = toSpace({0.5003f, 0.5003f}, 0.0f);
  EXPECT_TRUE(makeNavGraph(mesh));
}

TEST(MakeNavGraph, RefusesAnEdgeOfThreePolygons) {
  PolygonMesh mesh = testing::gridMesh(2, 1);
  const std::vector<std::uint32_t> again(mesh.ring.begin() + 4, mesh.ring.end());
  mesh.ring.insert(mesh.ring.end(), again.begin(), again.end());
  mesh.ringStart.push_back(12);
  expectRefused(mesh, ErrorCode::kDataDamaged, "");
  EXPECT_THAT(makeNavGraph(mesh).error().message, HasSubstr("edge between vertices"));
}

TEST(MakeNavGraph, RefusesTwoPolygonsOnTheSameSideOfAnEdge) {
  PolygonMesh mesh = testing::gridMesh(1, 1);
  mesh.ring.insert(mesh.ring.end(), {mesh.ring[0], mesh.ring[1], mesh.ring[2]});
  mesh.ringStart.push_back(7);
  expectRefused(mesh, ErrorCode::kDataDamaged, "same side");
}

TEST(MakeNavGraph, RefusesBorderPortalsThatNameNoEdge) {
  PolygonMesh mesh = testing::joinedGrids(1, 2, 3, 6.0f);
  ASSERT_FALSE(mesh.borderPortals.empty());
  PolygonMesh wild = mesh;
  wild.borderPortals[1].to = PolygonId{99};
  expectRefused(wild, ErrorCode::kDataDamaged, "border portal 1 names polygon 99");
  wild = mesh;
  wild.borderPortals[0].fromEdge = 4;
  expectRefused(wild, ErrorCode::kDataDamaged, "border portal 0 names edge 4");
}

TEST(MakeNavGraph, GivesALonePolygonNoPortals) {
  const NavGraph graph = graphOf(testing::gridMesh(1, 1, 2.0f));
  EXPECT_EQ(graph.polygonCount(), 1u);
  EXPECT_EQ(graph.portalCount(), 0u);
  EXPECT_EQ(graph.componentCount, 1u);
  EXPECT_EQ(graph.neighbourCount[0], 0u);
  EXPECT_EQ(graph.centroid[0], glm::vec2(1.0f, 1.0f));
  EXPECT_EQ(areaOf(graph, PolygonId{0}), 4.0f);
}

TEST(MakeNavGraph, JoinsTheSquaresOfAGridToTheirNeighbours) {
  const NavGraph graph = graphOf(testing::gridMesh(3, 2));
  EXPECT_EQ(graph.polygonCount(), 6u);
  EXPECT_EQ(graph.portalCount(), 14u);
  // Edges run counter-clockwise from the lower left corner: below, right, above, left.
  EXPECT_EQ(neighboursOf(graph, 1), (std::vector{PolygonId{2}, PolygonId{4}, PolygonId{0}}));
  EXPECT_EQ(neighboursOf(graph, 3), (std::vector{PolygonId{0}, PolygonId{4}}));
  // Walking along plan +x from square 0 into square 1, plan +y is on the left.
  const Portal& ahead = graph.portals[graph.portalStart[0]];
  EXPECT_EQ(ahead.left, glm::vec2(1.0f, 1.0f));
  EXPECT_EQ(ahead.right, glm::vec2(1.0f, 0.0f));
}

TEST(MakeNavGraph, JoinsTilesWhereTheirEdgesOverlap) {
  // Left squares of 3 m, right squares of 2 m along the same border.
  const NavGraph graph = graphOf(testing::joinedGrids(1, 2, 3, 6.0f));
  EXPECT_EQ(neighboursOf(graph, 0), (std::vector{PolygonId{2}, PolygonId{3}, PolygonId{1}}));
  const Portal& partial = graph.portals[graph.portalStart[0] + 1];
  EXPECT_EQ(partial.left, glm::vec2(3.0f, 3.0f));
  EXPECT_EQ(partial.right, glm::vec2(3.0f, 2.0f));
}

TEST(MakeNavGraph, CountsANeighbourOnceHoweverManyPortalsLeadThere) {
  // Two polygons that meet along two edges in a line: hexagons with a corner in their long sides.
  PolygonMesh mesh;
  for (const glm::vec2 p : {glm::vec2{0, 0}, {2, 0}, {2, 1}, {1, 1}, {0, 1}, {2, 2}, {0, 2}}) {
    mesh.vertices.push_back(toSpace(p, 0.0f));
  }
  mesh.ring = {0, 1, 2, 3, 4, 4, 3, 2, 5, 6};
  mesh.ringStart = {0, 5, 10};
  const NavGraph graph = graphOf(mesh);
  EXPECT_EQ(graph.portalCount(), 4u);
  EXPECT_EQ(graph.neighbourCount[0], 1u);
}

TEST(MakeNavGraph, StoresEachPortalOnceASide) {
  for (const PolygonMesh& mesh : meshes()) {
    const NavGraph graph = graphOf(mesh);
    for (std::uint32_t p = 0; p < graph.polygonCount(); ++p) {
      for (std::uint32_t h = graph.portalStart[p]; h < graph.portalStart[p + 1]; ++h) {
        const std::uint32_t twin = graph.portalTwin[h];
        ASSERT_NE(twin, h);
        EXPECT_EQ(graph.portalTwin[twin], h);
        EXPECT_EQ(graph.portalTo[twin], PolygonId{p});
        EXPECT_EQ(graph.portals[twin].left, graph.portals[h].right);
        EXPECT_EQ(graph.portals[twin].right, graph.portals[h].left);
        EXPECT_EQ(graph.portalMidpoint[twin], graph.portalMidpoint[h]);
        EXPECT_EQ(graph.portalHeights[twin].left, graph.portalHeights[h].right);
      }
    }
  }
}

TEST(MakeNavGraph, LaysPortalsOnTheirEdgesWithLeftOnTheLeft) {
  for (const PolygonMesh& mesh : meshes()) {
    const NavGraph graph = graphOf(mesh);
    for (std::uint32_t p = 0; p < graph.polygonCount(); ++p) {
      const auto ring = graph.ringOf(PolygonId{p});
      for (std::uint32_t h = graph.portalStart[p]; h < graph.portalStart[p + 1]; ++h) {
        const glm::vec2 a = ring[graph.portalEdge[h]];
        const glm::vec2 b = ring[(graph.portalEdge[h] + 1) % ring.size()];
        for (const glm::vec2 end : {graph.portals[h].left, graph.portals[h].right}) {
          EXPECT_NEAR(glm::distance(a, end) + glm::distance(end, b), glm::distance(a, b), 1e-5f);
        }
        EXPECT_GT(turn(graph.centroid[p], graph.portals[h].right, graph.portals[h].left), 0.0f);
        EXPECT_LT(turn(graph.centroid[index(graph.portalTo[h])], graph.portals[h].right,
                       graph.portals[h].left),
                  0.0f);
      }
    }
  }
}

TEST(MakeNavGraph, SortsPortalsByEdgeAndPlaceAlongIt) {
  for (const PolygonMesh& mesh : meshes()) {
    const NavGraph graph = graphOf(mesh);
    for (std::uint32_t p = 0; p < graph.polygonCount(); ++p) {
      const auto ring = graph.ringOf(PolygonId{p});
      for (std::uint32_t h = graph.portalStart[p] + 1; h < graph.portalStart[p + 1]; ++h) {
        ASSERT_LE(graph.portalEdge[h - 1], graph.portalEdge[h]);
        if (graph.portalEdge[h - 1] < graph.portalEdge[h]) continue;
        const glm::vec2 corner = ring[graph.portalEdge[h]];
        EXPECT_LT(glm::distance(corner, graph.portalMidpoint[h - 1]),
                  glm::distance(corner, graph.portalMidpoint[h]));
      }
    }
  }
}

TEST(MakeNavGraph, KnowsTheLengthsBetweenMidpointsAndCentroids) {
  for (const PolygonMesh& mesh : meshes()) {
    const NavGraph graph = graphOf(mesh);
    for (std::uint32_t h = 0; h < graph.portalCount(); ++h) {
      const std::uint32_t to = index(graph.portalTo[h]);
      EXPECT_FLOAT_EQ(graph.portalToCentroid[h],
                      glm::distance(graph.portalMidpoint[h], graph.centroid[to]));
      const std::uint32_t first = graph.portalStart[to];
      for (std::uint32_t next = first; next < graph.portalStart[to + 1]; ++next) {
        EXPECT_EQ(graph.successorLength[graph.successorStart[h] + next - first],
                  glm::distance(graph.portalMidpoint[h], graph.portalMidpoint[next]));
      }
    }
  }
}

TEST(MakeNavGraph, LabelsComponentsAsAFloodFillWould) {
  for (const PolygonMesh& mesh : meshes()) {
    const NavGraph graph = graphOf(mesh);
    std::set<std::uint32_t> labels;
    for (std::uint32_t p = 0; p < graph.polygonCount(); ++p) {
      const std::set<PolygonId> distinct = [&] {
        const auto row = neighboursOf(graph, p);
        return std::set<PolygonId>(row.begin(), row.end());
      }();
      EXPECT_EQ(graph.neighbourCount[p], distinct.size());
      for (const PolygonId q : distinct) EXPECT_EQ(graph.component[p], graph.component[index(q)]);
      // A new label appears in order of the smallest polygon.
      EXPECT_LE(graph.component[p], labels.size());
      labels.insert(graph.component[p]);
    }
    EXPECT_EQ(graph.componentCount, labels.size());
    // Not fewer labels than parts: joining equal labels by portals leaves as many parts as labels.
    std::vector<std::uint32_t> part(graph.polygonCount());
    for (std::uint32_t p = 0; p < part.size(); ++p) part[p] = p;
    for (bool changed = true; changed;) {
      changed = false;
      for (std::uint32_t p = 0; p < part.size(); ++p) {
        for (const PolygonId q : neighboursOf(graph, p)) {
          if (part[index(q)] < part[p]) {
            part[p] = part[index(q)];
            changed = true;
          }
        }
      }
    }
    EXPECT_EQ(std::set<std::uint32_t>(part.begin(), part.end()).size(), graph.componentCount);
  }
}

TEST(MakeNavGraph, TellsCopiesThatOnlyTouchNothingFromCopiesThatAreJoined) {
  const PolygonMesh mesh = testing::randomMesh(3, 5, 5);
  const NavGraph one = graphOf(mesh);
  const NavGraph many = graphOf(testing::repeated(mesh, 3, 2));
  EXPECT_EQ(many.polygonCount(), 6 * one.polygonCount());
  EXPECT_EQ(many.componentCount, 6 * one.componentCount);
}

TEST(NavGraph, HoldsItsCentroidsAndAddsUpItsAreas) {
  double total = 0.0;
  testing::RandomMeshOptions whole;
  whole.holeShare = 0.0;
  const NavGraph graph = graphOf(testing::randomMesh(5, 12, 9, whole));
  for (std::uint32_t p = 0; p < graph.polygonCount(); ++p) {
    EXPECT_TRUE(contains(graph, PolygonId{p}, graph.centroid[p]));
    total += static_cast<double>(areaOf(graph, PolygonId{p}));
  }
  EXPECT_NEAR(total, 12.0 * 9.0, 1e-3);
}

TEST(NavGraph, KeepsAreasAndCentroidsFarFromTheOrigin) {
  const PolygonMesh near = testing::gridMesh(2, 2, 0.5f);
  PolygonMesh far = near;
  for (glm::vec3& v : far.vertices) v += glm::vec3(4096.0f, 0.0f, -8192.0f);
  const NavGraph graph = graphOf(far);
  for (std::uint32_t p = 0; p < graph.polygonCount(); ++p) {
    EXPECT_EQ(areaOf(graph, PolygonId{p}), 0.25f);
    EXPECT_EQ(graph.centroid[p] - glm::vec2(4096.0f, 8192.0f), graphOf(near).centroid[p]);
  }
}

TEST(Contains, LeavesNoGapBetweenNeighbours) {
  testing::RandomMeshOptions whole;
  whole.holeShare = 0.0;
  const NavGraph graph = graphOf(testing::randomMesh(7, 8, 8, whole));
  std::mt19937_64 rng(1);
  for (int i = 0; i < 20000; ++i) {
    glm::vec2 query(uniform(rng, 0.0, 8.0), uniform(rng, 0.0, 8.0));
    if (i % 2 == 0) {  // on a portal, where rounding decides
      const auto h =
          static_cast<std::uint32_t>(uniformInt(rng, static_cast<int>(graph.portalCount())));
      query =
          glm::mix(graph.portals[h].left, graph.portals[h].right, static_cast<float>(uniform(rng)));
    }
    int holders = 0;
    for (std::uint32_t p = 0; p < graph.polygonCount(); ++p) {
      holders += contains(graph, PolygonId{p}, query) ? 1 : 0;
    }
    EXPECT_GE(holders, 1) << query.x << ", " << query.y;
  }
}

TEST(Contains, WidensBySoManyMetresAndNotMore) {
  const NavGraph graph = graphOf(testing::gridMesh(1, 1));
  const PolygonId square{0};
  EXPECT_TRUE(contains(graph, square, {1.0f, 1.0f}));
  EXPECT_FALSE(contains(graph, square, {1.05f, 0.5f}));
  EXPECT_TRUE(contains(graph, square, {1.05f, 0.5f}, 0.06f));
  EXPECT_FALSE(contains(graph, square, {1.05f, 1.05f}, 0.06f));  // 0.07 m from the corner
  EXPECT_TRUE(contains(graph, square, {1.05f, 1.05f}, 0.08f));
  EXPECT_FALSE(contains(graph, square, {std::numeric_limits<float>::quiet_NaN(), 0.5f}, 1.0f));
}

TEST(HeightAt, FollowsTheCornersWhereThereIsNothingFiner) {
  PolygonMesh ramp = testing::gridMesh(3, 3);
  for (glm::vec3& v : ramp.vertices) v.y = 0.5f * v.x + 0.25f * toPlan(v).y + 2.0f;
  const NavGraph graph = graphOf(ramp);
  std::mt19937_64 rng(2);
  for (std::uint32_t p = 0; p < graph.polygonCount(); ++p) {
    EXPECT_FLOAT_EQ(graph.centroidHeight[p],
                    0.5f * graph.centroid[p].x + 0.25f * graph.centroid[p].y + 2.0f);
    for (int i = 0; i < 20; ++i) {
      const auto ring = graph.ringOf(PolygonId{p});
      const glm::vec2 inside = ring[0] + glm::vec2(uniform(rng), uniform(rng));
      EXPECT_NEAR(heightAt(graph, PolygonId{p}, inside), 0.5f * inside.x + 0.25f * inside.y + 2.0f,
                  1e-5f);
    }
  }
}

TEST(HeightAt, FollowsTheTrianglesWhereThereAreSome) {
  // A square with a ridge along its diagonal, and a flat neighbour without triangles.
  PolygonMesh mesh = testing::gridMesh(2, 1, 2.0f);
  mesh.heightStart = {0, 3, 3};
  const glm::vec3 a = toSpace({0, 0}, 0.0f), b = toSpace({2, 0}, 0.0f), c = toSpace({2, 2}, 0.0f),
                  d = toSpace({0, 2}, 0.0f), top = toSpace({1, 1}, 1.0f);
  mesh.heightTriangles = {{a, b, top}, {b, c, top}, {c, d, top}};  // d, a, top is missing
  const NavGraph graph = graphOf(mesh);
  EXPECT_FLOAT_EQ(heightAt(graph, PolygonId{0}, {1.0f, 1.0f}), 1.0f);
  EXPECT_FLOAT_EQ(heightAt(graph, PolygonId{0}, {1.0f, 0.5f}), 0.5f);
  EXPECT_FLOAT_EQ(heightAt(graph, PolygonId{0}, {1.5f, 1.0f}), 0.5f);
  EXPECT_FLOAT_EQ(graph.centroidHeight[0], 1.0f);
  // Uncovered or outside: the nearest point's height.
  EXPECT_FLOAT_EQ(heightAt(graph, PolygonId{0}, {0.5f, 1.0f}), 0.75f);
  EXPECT_FLOAT_EQ(heightAt(graph, PolygonId{0}, {1.0f, -3.0f}), 0.0f);
  EXPECT_FLOAT_EQ(heightAt(graph, PolygonId{1}, {3.0f, 1.0f}), 0.0f);
}

TEST(HeightAt, AgreesAcrossPortals) {
  testing::RandomMeshOptions uneven;
  uneven.heights = 0.5f;
  const NavGraph graph = graphOf(testing::randomMesh(11, 8, 8, uneven));
  for (std::uint32_t h = 0; h < graph.portalCount(); ++h) {
    const glm::vec2 on = glm::mix(graph.portals[h].left, graph.portals[h].right, 0.3f);
    const float expected = 0.7f * graph.portalHeights[h].left + 0.3f * graph.portalHeights[h].right;
    EXPECT_NEAR(heightAt(graph, graph.portalTo[h], on), expected, 1e-5f);
    EXPECT_NEAR(heightAt(graph, graph.portalTo[graph.portalTwin[h]], on), expected, 1e-5f);
  }
}

TEST(MakeNavGraph, IsTheSameWhereverTheSceneStands) {
  for (const PolygonMesh& mesh : meshes()) {
    const NavGraph graph = graphOf(mesh);
    const NavGraph mirror = graphOf(testing::mirrored(mesh));
    const NavGraph turned = graphOf(testing::turned(mesh, 1.0f));
    const NavGraph large = graphOf(testing::scaled(mesh, 8.0f));
    EXPECT_EQ(graph.portalTo, turned.portalTo);
    EXPECT_EQ(graph.portalTo, large.portalTo);
    EXPECT_EQ(graph.component, mirror.component);
    for (std::uint32_t p = 0; p < graph.polygonCount(); ++p) {
      EXPECT_NEAR(areaOf(graph, PolygonId{p}), areaOf(mirror, PolygonId{p}), 1e-4f);
      EXPECT_NEAR(areaOf(graph, PolygonId{p}), areaOf(turned, PolygonId{p}), 1e-4f);
      EXPECT_NEAR(glm::distance(glm::vec2(-1, 1) * graph.centroid[p], mirror.centroid[p]), 0.0f,
                  1e-5f);
      EXPECT_EQ(8.0f * graph.centroid[p], large.centroid[p]);
      auto here = neighboursOf(graph, p);
      auto there = neighboursOf(mirror, p);
      std::sort(here.begin(), here.end());
      std::sort(there.begin(), there.end());
      EXPECT_EQ(here, there);
    }
  }
}

}  // namespace
}  // namespace forewalk::navmesh
