#include "navmesh/build/navmesh.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <set>

#include "navmesh/nav_graph.h"
#include "navmesh/plan.h"
#include "navmesh/random.h"
#include "tests/support/random_mesh.h"

namespace forewalk::navmesh {
namespace {

using ::testing::HasSubstr;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();

// A flat mesh from plan points and rings.
PolygonMesh meshOf(const std::vector<glm::vec2>& points,
                   const std::vector<std::vector<std::uint32_t>>& rings) {
  PolygonMesh mesh;
  for (const glm::vec2 p : points) mesh.vertices.push_back(toSpace(p, 0.0f));
  for (const auto& ring : rings) {
    mesh.ring.insert(mesh.ring.end(), ring.begin(), ring.end());
    mesh.ringStart.push_back(static_cast<std::uint32_t>(mesh.ring.size()));
  }
  return mesh;
}

PolygonMesh square() { return meshOf({{0, 0}, {1, 0}, {1, 1}, {0, 1}}, {{0, 1, 2, 3}}); }

// Two squares that touch in one corner only.
PolygonMesh bowTie() {
  return meshOf({{0, 0}, {1, 0}, {1, 1}, {0, 1}, {2, 1}, {2, 2}, {1, 2}},
                {{0, 1, 2, 3}, {2, 4, 5, 6}});
}

// A square on the left, two half as high on the right, joined across the line x = 1.
PolygonMesh tileBorder() {
  PolygonMesh mesh =
      meshOf({{0, 0}, {1, 0}, {1, 2}, {0, 2}, {1, 0}, {2, 0}, {2, 1}, {1, 1}, {2, 2}, {1, 2}},
             {{0, 1, 2, 3}, {4, 5, 6, 7}, {7, 6, 8, 9}});
  const auto at = [](float y) { return toSpace({1.0f, y}, 0.0f); };
  mesh.borderPortals = {{PolygonId{0}, PolygonId{1}, 1, 3, at(1), at(0)},
                        {PolygonId{0}, PolygonId{2}, 1, 3, at(2), at(1)}};
  return mesh;
}

PolygonMesh withHeights(PolygonMesh mesh) {
  mesh.heightStart.assign(1, 0);
  for (std::uint32_t p = 0; p < mesh.polygonCount(); ++p) {
    const std::uint32_t begin = mesh.ringStart[p];
    for (std::uint32_t c = begin + 1; c + 1 < mesh.ringStart[p + 1]; ++c) {
      mesh.heightTriangles.push_back({mesh.vertices[mesh.ring[begin]], mesh.vertices[mesh.ring[c]],
                                      mesh.vertices[mesh.ring[c + 1]]});
    }
    mesh.heightStart.push_back(static_cast<std::uint32_t>(mesh.heightTriangles.size()));
  }
  return mesh;
}

NavMesh made(const PolygonMesh& polygons) {
  auto navMesh = makeNavMesh(polygons, BuildSettings{});
  if (!navMesh) {
    ADD_FAILURE() << navMesh.error().message;
    return {};
  }
  return *std::move(navMesh);
}

std::string refusal(const PolygonMesh& polygons) {
  const auto navMesh = makeNavMesh(polygons, BuildSettings{});
  return navMesh ? "accepted" : navMesh.error().message;
}

std::string complaint(const NavMesh& navMesh) {
  const auto sound = validate(navMesh);
  return sound ? "sound" : sound.error().message;
}

std::vector<PolygonMesh> manyMeshes() {
  std::vector<PolygonMesh> meshes{square(), bowTie(), tileBorder(), withHeights(tileBorder()),
                                  testing::joinedGrids(3, 4, 7, 6.0f)};
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    const int size = 1 + static_cast<int>(seed % 13);
    testing::RandomMeshOptions options;
    options.heights = seed % 3 == 0 ? 0.2f : 0.0f;
    options.holeShare = 0.02 * static_cast<double>(seed);
    const PolygonMesh mesh = testing::randomMesh(seed, size, 14 - size, options);
    meshes.push_back(seed % 5 == 0 ? withHeights(mesh) : mesh);
  }
  return meshes;
}

// ---- What is refused

TEST(MakeNavMesh, RefusesAMeshWithoutPolygons) {
  const auto navMesh = makeNavMesh(PolygonMesh{}, BuildSettings{});
  ASSERT_FALSE(navMesh);
  EXPECT_EQ(navMesh.error().code, ErrorCode::kSceneEmpty);
  PolygonMesh noOffsets;
  noOffsets.ringStart.clear();
  EXPECT_FALSE(makeNavMesh(noOffsets, BuildSettings{}));
}

TEST(MakeNavMesh, RefusesRingsOfFewerThanThreeCorners) {
  EXPECT_THAT(refusal(meshOf({{0, 0}, {1, 0}}, {{0, 1}})), HasSubstr("polygon 0 has 2 corners"));
  EXPECT_THAT(refusal(meshOf({{0, 0}}, {{0}})), HasSubstr("1 corners"));
  EXPECT_THAT(refusal(meshOf({}, {{}})), HasSubstr("0 corners"));
}

TEST(MakeNavMesh, RefusesAVertexNamedTwiceInARing) {
  EXPECT_THAT(refusal(meshOf({{0, 0}, {1, 0}, {1, 1}}, {{0, 1, 1, 2}})),
              HasSubstr("polygon 0 names vertex 1 twice"));
  EXPECT_THAT(refusal(meshOf({{0, 0}, {1, 0}, {1, 1}, {0, 1}}, {{0, 1, 2, 3}, {0, 1, 0, 2}})),
              HasSubstr("polygon 1 names vertex 0 twice"));
}

TEST(MakeNavMesh, RefusesIndicesOutOfRange) {
  PolygonMesh mesh = square();
  mesh.ring[2] = 4;
  EXPECT_THAT(refusal(mesh), HasSubstr("polygon 0 names vertex 4, the navmesh has 4"));
  mesh.ring[2] = 0xffffffffu;
  EXPECT_THAT(refusal(mesh), HasSubstr("4294967295"));
}

TEST(MakeNavMesh, RefusesOffsetsThatDoNotCoverTheirArray) {
  PolygonMesh mesh = tileBorder();
  mesh.ringStart[1] = 9;
  EXPECT_THAT(refusal(mesh),
              HasSubstr("the ring offset of polygon 1 is 9, but the next one's is 8"));
  mesh.ringStart = {0, 4, 8, 13};
  EXPECT_THAT(refusal(mesh), HasSubstr("from 0 to 13, but must cover 0 to 12"));
  mesh.ringStart = {1, 4, 8, 12};
  EXPECT_THAT(refusal(mesh), HasSubstr("from 1 to 12"));
  mesh = withHeights(tileBorder());
  mesh.heightStart.pop_back();
  EXPECT_THAT(refusal(mesh), HasSubstr("height offsets of 3 polygons: 3 are given, 4 are needed"));
  mesh.heightStart.clear();
  EXPECT_THAT(refusal(mesh), HasSubstr("0 are given"));
}

TEST(MakeNavMesh, RefusesCoordinatesThatAreNotFinite) {
  for (const float bad : {kNan, kInfinity, -kInfinity}) {
    for (int axis = 0; axis < 3; ++axis) {
      PolygonMesh mesh = tileBorder();
      mesh.vertices[5][axis] = bad;
      EXPECT_THAT(refusal(mesh), HasSubstr("vertex 5 is ("));
      mesh = tileBorder();
      mesh.borderPortals[1].right[axis] = bad;
      EXPECT_THAT(refusal(mesh), HasSubstr("border portal 1 has an end that is not finite"));
      mesh = withHeights(tileBorder());
      mesh.heightTriangles[3].b[axis] = bad;
      EXPECT_THAT(refusal(mesh), HasSubstr("height triangle 3"));
    }
  }
}

TEST(MakeNavMesh, RefusesClockwiseRings) {
  EXPECT_THAT(refusal(meshOf({{0, 0}, {1, 0}, {1, 1}, {0, 1}}, {{3, 2, 1, 0}})),
              HasSubstr("polygon 0 is clockwise seen from above: its area is -1 m^2"));
}

TEST(MakeNavMesh, RefusesRingsThatAreNotConvex) {
  EXPECT_THAT(refusal(meshOf({{0, 0}, {2, 0}, {2, 2}, {1, 0.5f}, {0, 2}}, {{0, 1, 2, 3, 4}})),
              HasSubstr("corner 3 at (1, 0.5) on the plan lies 1.5 m inside the hull"));
}

TEST(MakeNavMesh, RefusesRingsThatGoRoundTwice) {
  std::vector<glm::vec2> star;
  for (int i = 0; i < 5; ++i)
    star.push_back(directionOf(0.8f * std::numbers::pi_v<float> * static_cast<float>(i)));
  EXPECT_THAT(refusal(meshOf(star, {{0, 1, 2, 3, 4}})),
              HasSubstr("do not walk around their hull once"));
}

TEST(MakeNavMesh, RefusesRingsThatCrossThemselves) {
  EXPECT_THAT(refusal(meshOf({{0, 0}, {1, 0}, {0, 1}, {1, 1}}, {{0, 1, 2, 3}})),
              HasSubstr("polygon 0 is "));
}

TEST(MakeNavMesh, RefusesASpikeThatDoublesBackAlongAnEdge) {
  EXPECT_THAT(refusal(meshOf({{0, 0}, {2, 0}, {1, 0}, {1, 1}, {0, 1}}, {{0, 1, 2, 3, 4}})),
              HasSubstr("polygon 0 is not convex"));
}

// A crescent of many corners: no corner alone turns right by a millimetre.
TEST(MakeNavMesh, RefusesARingThatIsHollowedOutInSmallSteps) {
  std::vector<glm::vec2> points;
  std::vector<std::uint32_t> ring;
  constexpr int kSteps = 400;
  for (int i = 0; i <= kSteps; ++i) {
    const float angle = 3.0f * static_cast<float>(i) / kSteps;
    points.push_back(2.0f * directionOf(angle));
  }
  for (int i = kSteps; i >= 0; --i) points.push_back(0.5f * points[static_cast<std::size_t>(i)]);
  for (std::uint32_t i = 0; i < points.size(); ++i) ring.push_back(i);
  EXPECT_THAT(refusal(meshOf(points, {ring})), HasSubstr("polygon 0 is not convex"));
}

TEST(MakeNavMesh, AcceptsAMillimetreOfHollowAndNoMore) {
  const auto dented = [](float depth) {
    return meshOf({{0, 0}, {1, depth}, {2, 0}, {2, 2}, {0, 2}}, {{0, 1, 2, 3, 4}});
  };
  EXPECT_EQ(refusal(dented(0.0f)), "accepted");
  EXPECT_EQ(refusal(dented(0.0009f)), "accepted");
  EXPECT_THAT(refusal(dented(0.0011f)), HasSubstr("not convex"));
}

// Recast makes triangles of corners in a line; a navmesh is no worse for them.
TEST(MakeNavMesh, AcceptsSliversAndPolygonsWithoutArea) {
  EXPECT_EQ(refusal(meshOf({{0, 0}, {1, 0}, {3, 0}}, {{0, 1, 2}})), "accepted");
  EXPECT_EQ(refusal(meshOf({{0, 0}, {3, 0}, {1, 0.0005f}}, {{0, 1, 2}})), "accepted");
  EXPECT_EQ(refusal(meshOf({{0, 0}, {1, 0.0005f}, {3, 0}}, {{0, 1, 2}})), "accepted");
  EXPECT_EQ(refusal(meshOf({{0, 0}, {0, 0}, {0, 0}}, {{0, 1, 2}})), "accepted");
  EXPECT_THAT(refusal(meshOf({{0, 0}, {2, 0}, {1, 0}, {3, 0}}, {{0, 1, 2, 3}})),
              HasSubstr("not convex"));
}

TEST(MakeNavMesh, RefusesAThirdPolygonAtAnEdge) {
  EXPECT_THAT(
      refusal(meshOf({{0, 0}, {1, 0}, {0.5f, 1}, {0.5f, -1}, {0.6f, -1}},
                     {{0, 1, 2}, {1, 0, 3}, {1, 0, 4}})),
      HasSubstr("the edge between vertices 0 and 1 has more than two polygons: 0, 1 and 2"));
}

TEST(MakeNavMesh, RefusesTwoPolygonsOnTheSameSideOfAnEdge) {
  EXPECT_THAT(
      refusal(meshOf({{0, 0}, {1, 0}, {0.5f, 1}, {0.6f, 2}}, {{0, 1, 2}, {0, 1, 3}})),
      HasSubstr("polygons 0 and 1 lie on the same side of the edge between vertices 0 and 1"));
}

TEST(MakeNavMesh, RefusesBorderPortalsThatNameNothing) {
  PolygonMesh mesh = tileBorder();
  mesh.borderPortals[1].to = PolygonId{3};
  EXPECT_THAT(refusal(mesh), HasSubstr("border portal 1 names polygon 3, the navmesh has 3"));
  mesh = tileBorder();
  mesh.borderPortals[0].fromEdge = 4;
  EXPECT_THAT(refusal(mesh), HasSubstr("border portal 0 names edge 4 of polygon 0, which has 4"));
  mesh = tileBorder();
  mesh.borderPortals[0].to = PolygonId{0};
  EXPECT_THAT(refusal(mesh), HasSubstr("joins polygon 0 to itself"));
}

TEST(MakeNavMesh, NeverLetsOpenMeshSpeak) {
  ::testing::internal::CaptureStderr();
  ::testing::internal::CaptureStdout();
  for (const PolygonMesh& mesh : manyMeshes()) made(mesh);
  refusal(meshOf({{0, 0}, {1, 0}, {0.5f, 1}, {0.5f, -1}, {0.6f, -1}},
                 {{0, 1, 2}, {1, 0, 3}, {1, 0, 4}}));
  EXPECT_EQ(::testing::internal::GetCapturedStderr(), "");
  EXPECT_EQ(::testing::internal::GetCapturedStdout(), "");
}

// ---- What comes out

TEST(MakeNavMesh, GivesAMeshThatKeepsItsPromises) {
  for (const PolygonMesh& mesh : manyMeshes()) EXPECT_EQ(complaint(made(mesh)), "sound");
}

TEST(MakeNavMesh, IsUndoneByFlatten) {
  for (const PolygonMesh& mesh : manyMeshes()) EXPECT_EQ(flatten(made(mesh)), mesh);
}

TEST(MakeNavMesh, GivesTheSameHalfEdgesAgainFromItsFlatForm) {
  for (const PolygonMesh& polygons : manyMeshes()) {
    const NavMesh first = made(polygons);
    const NavMesh again = made(flatten(first));
    ASSERT_EQ(first.flatVertex, again.flatVertex);
    ASSERT_EQ(first.mesh.n_halfedges(), again.mesh.n_halfedges());
    for (int i = 0; i < static_cast<int>(first.mesh.n_halfedges()); ++i) {
      const HalfEdgeMesh::HalfedgeHandle h(i);
      EXPECT_EQ(first.mesh.next_halfedge_handle(h), again.mesh.next_halfedge_handle(h));
      EXPECT_EQ(first.mesh.to_vertex_handle(h), again.mesh.to_vertex_handle(h));
      EXPECT_EQ(first.mesh.face_handle(h), again.mesh.face_handle(h));
    }
  }
}

TEST(MakeNavMesh, GivesEveryPolygonItsOwnNumberAndCorners) {
  for (const PolygonMesh& polygons : manyMeshes()) {
    const NavMesh navMesh = made(polygons);
    ASSERT_EQ(navMesh.mesh.n_faces(), polygons.polygonCount());
    for (std::uint32_t p = 0; p < polygons.polygonCount(); ++p) {
      std::vector<glm::vec3> corners;
      for (const auto vertex :
           navMesh.mesh.fv_range(HalfEdgeMesh::FaceHandle(static_cast<int>(p)))) {
        const auto point = navMesh.mesh.point(vertex);
        corners.push_back({point[0], point[1], point[2]});
      }
      std::vector<glm::vec3> ring;
      for (std::uint32_t c = polygons.ringStart[p]; c < polygons.ringStart[p + 1]; ++c) {
        ring.push_back(polygons.vertices[polygons.ring[c]]);
      }
      EXPECT_EQ(corners, ring) << "polygon " << p;
    }
  }
}

// Brute force: every pair of polygons, every pair of their edges.
TEST(MakeNavMesh, HasAnInnerEdgeExactlyWhereTwoPolygonsShareOne) {
  for (std::uint64_t seed = 0; seed < 8; ++seed) {
    const PolygonMesh polygons = testing::randomMesh(seed, 6, 6);
    std::set<std::pair<std::uint32_t, std::uint32_t>> shared;
    std::size_t sharedEdges = 0;
    const auto edge = [&](std::uint32_t p, std::uint32_t e) {
      const std::uint32_t begin = polygons.ringStart[p];
      const std::uint32_t corners = polygons.ringStart[p + 1] - begin;
      return std::minmax({polygons.ring[begin + e], polygons.ring[begin + (e + 1) % corners]});
    };
    for (std::uint32_t p = 0; p < polygons.polygonCount(); ++p) {
      for (std::uint32_t q = p + 1; q < polygons.polygonCount(); ++q) {
        for (std::uint32_t e = 0; e < polygons.ringStart[p + 1] - polygons.ringStart[p]; ++e) {
          for (std::uint32_t f = 0; f < polygons.ringStart[q + 1] - polygons.ringStart[q]; ++f) {
            if (edge(p, e) != edge(q, f)) continue;
            shared.insert({p, q});
            ++sharedEdges;
          }
        }
      }
    }
    const HalfEdgeMesh mesh = made(polygons).mesh;
    std::set<std::pair<std::uint32_t, std::uint32_t>> joined;
    std::size_t innerEdges = 0;
    for (const auto& inner : mesh.edges()) {
      if (inner.is_boundary()) continue;
      ++innerEdges;
      const auto one = static_cast<std::uint32_t>(inner.h0().face().idx());
      const auto other = static_cast<std::uint32_t>(inner.h1().face().idx());
      joined.insert(std::minmax({one, other}));
    }
    EXPECT_EQ(joined, shared);
    EXPECT_EQ(innerEdges, sharedEdges);
  }
}

TEST(MakeNavMesh, GivesEachFanThatTouchesAVertexItsOwnCopy) {
  const NavMesh navMesh = made(bowTie());
  EXPECT_EQ(navMesh.mesh.n_vertices(), 8u);
  EXPECT_EQ(navMesh.flatVertex, (std::vector<std::uint32_t>{0, 1, 2, 3, 4, 5, 6, 2}));
  EXPECT_EQ(flatten(navMesh).vertices.size(), 7u);
}

TEST(MakeNavMesh, DoesNotCopyAVertexWithinOneFan) {
  const NavMesh navMesh = made(testing::gridMesh(5, 4));
  EXPECT_EQ(navMesh.mesh.n_vertices(), 6u * 5u);
  EXPECT_EQ(navMesh.mesh.n_edges(), 5u * 5u + 6u * 4u);
}

// Around a spiral stair's newel the fan goes round more than once, floor above floor.
TEST(MakeNavMesh, KeepsASpiralStairInOneFan) {
  constexpr std::uint32_t kSteps = 20;
  PolygonMesh mesh;
  for (std::uint32_t i = 0; i <= kSteps; ++i) {
    const glm::vec2 out = directionOf(std::numbers::pi_v<float> / 6.0f * static_cast<float>(i));
    mesh.vertices.push_back(toSpace(out, 0.17f * static_cast<float>(i)));
  }
  mesh.vertices.push_back({0, 0, 0});
  for (std::uint32_t i = 0; i < kSteps; ++i) {
    mesh.ring.insert(mesh.ring.end(), {i, i + 1, kSteps + 1});
    mesh.ringStart.push_back(static_cast<std::uint32_t>(mesh.ring.size()));
  }
  const NavMesh navMesh = made(mesh);
  EXPECT_EQ(complaint(navMesh), "sound");
  EXPECT_EQ(navMesh.mesh.n_vertices(), mesh.vertices.size());
  EXPECT_EQ(flatten(navMesh), mesh);
}

TEST(MakeNavMesh, LeavesOutVerticesThatNoPolygonNames) {
  PolygonMesh mesh = square();
  mesh.vertices.insert(mesh.vertices.begin() + 1, glm::vec3(7.0f));
  mesh.vertices.push_back(glm::vec3(9.0f));
  for (std::uint32_t& v : mesh.ring) v += v >= 1 ? 1u : 0u;
  EXPECT_EQ(flatten(made(mesh)), square());
}

TEST(MakeNavMesh, CanBeEditedWithOpenMesh) {
  HalfEdgeMesh mesh = made(testing::gridMesh(3, 3)).mesh;
  mesh.delete_face(HalfEdgeMesh::FaceHandle(4), false);
  mesh.garbage_collection();
  EXPECT_EQ(mesh.n_faces(), 8u);
  int borderEdges = 0;
  for (const auto& edge : mesh.edges()) borderEdges += edge.is_boundary() ? 1 : 0;
  EXPECT_EQ(borderEdges, 12 + 4);
}

TEST(MakeNavMesh, AcceptsWhatTheNavGraphAcceptsAndNothingElse) {
  std::mt19937_64 rng(5);
  int accepted = 0;
  for (int trial = 0; trial < 2000; ++trial) {
    PolygonMesh mesh = testing::randomMesh(static_cast<std::uint64_t>(trial), 3, 3);
    const auto anyOf = [&](std::size_t n) {
      return static_cast<std::size_t>(uniformInt(rng, static_cast<int>(n)));
    };
    if (trial % 2 == 0) {
      mesh.ring[anyOf(mesh.ring.size())] =
          static_cast<std::uint32_t>(anyOf(mesh.vertices.size() + 1));
    } else {
      mesh.vertices[anyOf(mesh.vertices.size())].x += static_cast<float>(uniform(rng) - 0.5);
    }
    const auto navMesh = makeNavMesh(mesh, BuildSettings{});
    EXPECT_EQ(navMesh.has_value(), makeNavGraph(mesh).has_value()) << "trial " << trial;
    if (!navMesh) continue;
    ++accepted;
    EXPECT_EQ(complaint(*navMesh), "sound");
  }
  EXPECT_GT(accepted, 100);
  EXPECT_LT(accepted, 1900);
}

// ---- What validate() finds

TEST(Validate, NamesASettingThatCannotBe) {
  const auto with = [](auto&& change) {
    NavMesh navMesh = made(square());
    change(navMesh.settings);
    return complaint(navMesh);
  };
  EXPECT_THAT(with([](BuildSettings& s) { s.radius = kNan; }), HasSubstr("setting radius is nan"));
  EXPECT_THAT(with([](BuildSettings& s) { s.height = 0; }),
              HasSubstr("setting height is 0, but must be"));
  EXPECT_THAT(with([](BuildSettings& s) { s.cell = -1; }), HasSubstr("setting cell is -1"));
  EXPECT_THAT(with([](BuildSettings& s) { s.tile = kInfinity; }), HasSubstr("setting tile is inf"));
  EXPECT_THAT(with([](BuildSettings& s) { s.slope = 2; }), HasSubstr("setting slope is 2 rad"));
  EXPECT_THAT(with([](BuildSettings& s) { s.cornersMax = 2; }),
              HasSubstr("setting cornersMax is 2"));
  EXPECT_THAT(with([](BuildSettings& s) { s.partition = static_cast<Partition>(3); }),
              HasSubstr("setting partition is 3"));
}

// Any one link that is moved anywhere is found, and finding it ends and stays inside the arrays.
TEST(Validate, FindsEveryHalfEdgeLinkThatIsMoved) {
  const NavMesh sound = made(testing::randomMesh(3, 4, 4));
  std::mt19937_64 rng(11);
  const auto halfEdges = static_cast<int>(sound.mesh.n_halfedges());
  for (int trial = 0; trial < 3000; ++trial) {
    NavMesh broken = sound;
    HalfEdgeMesh& mesh = broken.mesh;
    const HalfEdgeMesh::HalfedgeHandle h(uniformInt(rng, halfEdges));
    const HalfEdgeMesh::HalfedgeHandle other(uniformInt(rng, halfEdges + 2) -
                                             1);  // both ends beyond
    const bool within = other.idx() >= 0 && other.idx() < halfEdges;
    switch (trial % 5) {
      case 0:
        if (other == mesh.next_halfedge_handle(h) || !within) continue;
        mesh.set_next_halfedge_handle(h, other);
        break;
      case 1: {
        const HalfEdgeMesh::VertexHandle vertex(
            uniformInt(rng, static_cast<int>(mesh.n_vertices()) + 2) - 1);
        if (vertex == mesh.to_vertex_handle(h)) continue;
        mesh.set_vertex_handle(h, vertex);
        break;
      }
      case 2: {
        const HalfEdgeMesh::FaceHandle face(uniformInt(rng, static_cast<int>(mesh.n_faces()) + 2) -
                                            1);
        if (face == mesh.face_handle(h)) continue;
        mesh.set_face_handle(h, face);
        break;
      }
      case 3: {
        const HalfEdgeMesh::FaceHandle face(uniformInt(rng, static_cast<int>(mesh.n_faces())));
        if (within && mesh.face_handle(other) == face)
          continue;  // the ring begins elsewhere: allowed
        mesh.set_halfedge_handle(face, other);
        break;
      }
      case 4: {
        const HalfEdgeMesh::VertexHandle vertex(
            uniformInt(rng, static_cast<int>(mesh.n_vertices())));
        if (within && mesh.from_vertex_handle(other) == vertex &&
            (mesh.is_boundary(other) || !mesh.is_boundary(vertex))) {
          continue;
        }
        mesh.set_halfedge_handle(vertex, other);
        break;
      }
    }
    EXPECT_NE(complaint(broken), "sound") << "trial " << trial;
  }
}

TEST(Validate, FindsFacesThatWereDeletedButNotCollected) {
  NavMesh navMesh = made(testing::gridMesh(3, 3));
  navMesh.mesh.delete_face(HalfEdgeMesh::FaceHandle(0), false);
  EXPECT_THAT(complaint(navMesh), HasSubstr("garbage_collection()"));
}

TEST(Validate, FindsCopiesThatMovedApart) {
  NavMesh navMesh = made(bowTie());
  const HalfEdgeMesh::VertexHandle copy(7);
  navMesh.mesh.set_point(copy, navMesh.mesh.point(copy) + HalfEdgeMesh::Point(0.0f, 0.5f, 0.0f));
  EXPECT_THAT(complaint(navMesh),
              HasSubstr("vertices 2 and 7 are copies of one, but lie 0.5 m apart"));
}

TEST(Validate, FindsFlatNumbersThatDoNotFit) {
  NavMesh navMesh = made(bowTie());
  navMesh.flatVertex.pop_back();
  EXPECT_THAT(complaint(navMesh), HasSubstr("7 vertices of the flat form are named"));
  navMesh.flatVertex.push_back(9);
  EXPECT_THAT(complaint(navMesh), HasSubstr("vertex 7 names vertex 9"));
  navMesh = made(square());
  navMesh.flatVertex = {0, 1, 3, 3};
  EXPECT_NE(complaint(navMesh), "sound");
}

TEST(Validate, FindsAnEdgeThatWasSplitInTwo) {
  // Two squares side by side that do not know of each other, though they name the same vertices.
  NavMesh navMesh = made(meshOf({{0, 0}, {1, 0}, {1, 1}, {0, 1}, {1, 0}, {2, 0}, {2, 1}, {1, 1}},
                                {{0, 1, 2, 3}, {4, 5, 6, 7}}));
  ASSERT_EQ(complaint(navMesh), "sound");
  navMesh.flatVertex = {0, 1, 2, 3, 1, 4, 5, 2};
  EXPECT_THAT(complaint(navMesh), HasSubstr("is two edges of the half-edge mesh"));
}

TEST(Validate, FindsAPolygonThatWasBentOutOfShape) {
  NavMesh navMesh = made(testing::gridMesh(3, 3));
  const HalfEdgeMesh::VertexHandle inner = *navMesh.mesh.fv_begin(HalfEdgeMesh::FaceHandle(4));
  navMesh.mesh.set_point(inner, {9.0f, 0.0f, -9.0f});
  EXPECT_THAT(complaint(navMesh), HasSubstr("polygon "));
}

TEST(Validate, FindsBorderPortalsThatLeaveTheirEdges) {
  const auto moved = [](glm::vec3 left, glm::vec3 right, float climb = 0.25f) {
    NavMesh navMesh = made(tileBorder());
    navMesh.settings.climb = climb;
    navMesh.borderPortals[0].left += left;
    navMesh.borderPortals[0].right += right;
    return complaint(navMesh);
  };
  EXPECT_EQ(moved({}, {}), "sound");
  EXPECT_EQ(moved({0.009f, 0, 0}, {0, 0, 0}), "sound");
  EXPECT_THAT(moved({0.011f, 0, 0}, {}), HasSubstr("border portal 0 ends 0.01"));
  EXPECT_THAT(moved({}, {0, 0, 0.02f}), HasSubstr("beside"));  // beyond both edges' end
  EXPECT_THAT(moved({0, 0, -0.5f}, {}),
              HasSubstr("edge 3 of polygon 1"));  // beyond the second's end
  EXPECT_EQ(moved({0, 0.2f, 0}, {}), "sound");
  EXPECT_THAT(moved({0, 0.3f, 0}, {}), HasSubstr("m above or below edge 1 of polygon 0"));
  EXPECT_THAT(moved({0, 0.2f, 0}, {}, 0.1f), HasSubstr("above or below"));
}

TEST(Validate, FindsBorderPortalsSeenFromTheWrongSide) {
  NavMesh navMesh = made(tileBorder());
  std::swap(navMesh.borderPortals[0].left, navMesh.borderPortals[0].right);
  EXPECT_THAT(complaint(navMesh), HasSubstr("border portal 0 has left and right exchanged"));
}

TEST(Validate, FindsBorderPortalsOutOfOrder) {
  NavMesh navMesh = made(tileBorder());
  std::swap(navMesh.borderPortals[0], navMesh.borderPortals[1]);
  EXPECT_THAT(complaint(navMesh), HasSubstr("Sort them"));
}

TEST(Validate, FindsHeightRowsThatDoNotCover) {
  NavMesh navMesh = made(withHeights(tileBorder()));
  navMesh.heightTriangles.pop_back();
  EXPECT_THAT(complaint(navMesh), HasSubstr("height offsets"));
}

}  // namespace
}  // namespace forewalk::navmesh
