#include "navmesh/build/navmesh_dump.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "navmesh/plan.h"
#include "tests/support/random_mesh.h"

namespace forewalk::navmesh {
namespace {

using nlohmann::json;

NavGraph graphOf(const PolygonMesh& mesh) {
  auto graph = makeNavGraph(mesh);
  if (!graph) {
    ADD_FAILURE() << graph.error().message;
    return {};
  }
  return *std::move(graph);
}

json dumpOf(const PolygonMesh& mesh, const BuildSettings& settings = {}) {
  return json::parse(dumpNavMesh(mesh, graphOf(mesh), settings));
}

glm::vec3 pointOf(const json& point) {
  EXPECT_EQ(point.size(), 3u);
  return {point[0].get<float>(), point[1].get<float>(), point[2].get<float>()};
}

TEST(DumpNavMesh, NamesItsFormatAndEverySetting) {
  BuildSettings settings;
  settings.partition = Partition::kMonotone;
  settings.tile = 12.5f;
  const json dump = dumpOf(testing::gridMesh(1, 1), settings);
  EXPECT_EQ(dump["format"], "forewalk.navmesh/1");
  const json& s = dump["settings"];
  EXPECT_EQ(s["radius"].get<float>(), settings.radius);
  EXPECT_EQ(s["height"].get<float>(), settings.height);
  EXPECT_EQ(s["climb"].get<float>(), settings.climb);
  EXPECT_EQ(s["slope"].get<float>(), settings.slope);
  EXPECT_EQ(s["cell"].get<float>(), settings.cell);
  EXPECT_EQ(s["cell_height"].get<float>(), settings.cellHeight);
  EXPECT_EQ(s["region_min"].get<float>(), settings.regionMin);
  EXPECT_EQ(s["region_merge"].get<float>(), settings.regionMerge);
  EXPECT_EQ(s["edge_max"].get<float>(), settings.edgeMax);
  EXPECT_EQ(s["edge_error"].get<float>(), settings.edgeError);
  EXPECT_EQ(s["detail_sample"].get<float>(), settings.detailSample);
  EXPECT_EQ(s["detail_error"].get<float>(), settings.detailError);
  EXPECT_EQ(s["corners_max"], 6);
  EXPECT_EQ(s["partition"], "monotone");
  EXPECT_EQ(s["tile"], 12.5);
  EXPECT_EQ(s.size(), 15u);
}

TEST(DumpNavMesh, WritesNumbersAsShortAsTheyCanBeReadBack) {
  const std::string text =
      dumpNavMesh(testing::gridMesh(1, 1), graphOf(testing::gridMesh(1, 1)), BuildSettings{});
  EXPECT_NE(text.find("\"cell\":0.1,"), std::string::npos) << text;
}

TEST(DumpNavMesh, GivesEveryPolygonAsTheGraphHasIt) {
  testing::RandomMeshOptions options;
  options.heights = 0.4f;
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    const PolygonMesh mesh = testing::randomMesh(seed, 6, 5, options);
    const NavGraph graph = graphOf(mesh);
    const json dump = dumpOf(mesh);
    ASSERT_EQ(dump["polygons"].size(), mesh.polygonCount());
    for (std::uint32_t p = 0; p < mesh.polygonCount(); ++p) {
      const json& polygon = dump["polygons"][p];
      EXPECT_EQ(polygon["id"], p);
      EXPECT_EQ(polygon["component"], graph.component[p]);
      EXPECT_EQ(pointOf(polygon["centroid"]), toSpace(graph.centroid[p], graph.centroidHeight[p]));
      ASSERT_EQ(polygon["vertices"].size(), mesh.ringStart[p + 1] - mesh.ringStart[p]);
      for (std::uint32_t c = 0; c < polygon["vertices"].size(); ++c) {
        EXPECT_EQ(pointOf(polygon["vertices"][c]), mesh.vertices[mesh.ring[mesh.ringStart[p] + c]]);
      }
      const std::uint32_t begin = graph.portalStart[p];
      ASSERT_EQ(polygon["portals"].size(), graph.portalStart[p + 1] - begin);
      for (std::uint32_t i = 0; i < polygon["portals"].size(); ++i) {
        const json& portal = polygon["portals"][i];
        EXPECT_EQ(portal["to"], index(graph.portalTo[begin + i]));
        EXPECT_EQ(pointOf(portal["left"]),
                  toSpace(graph.portals[begin + i].left, graph.portalHeights[begin + i].left));
        EXPECT_EQ(pointOf(portal["right"]),
                  toSpace(graph.portals[begin + i].right, graph.portalHeights[begin + i].right));
      }
    }
  }
}

// Law: whoever walks out has the polygon behind, and the same portal the other way round is named
// there.
TEST(DumpNavMesh, NamesEachPortalFromBothSides) {
  const json dump = dumpOf(testing::joinedGrids(3, 2, 5, 4.0f));
  int portals = 0;
  for (const json& polygon : dump["polygons"]) {
    const glm::vec2 centroid = toPlan(pointOf(polygon["centroid"]));
    for (const json& portal : polygon["portals"]) {
      ++portals;
      EXPECT_GT(turn(centroid, toPlan(pointOf(portal["right"])), toPlan(pointOf(portal["left"]))),
                0.0f);
      int back = 0;
      for (const json& other : dump["polygons"][portal["to"].get<std::size_t>()]["portals"]) {
        back += other["to"] == polygon["id"] && other["left"] == portal["right"] &&
                        other["right"] == portal["left"]
                    ? 1
                    : 0;
      }
      EXPECT_EQ(back, 1);
    }
  }
  EXPECT_GT(portals, 40);
}

TEST(DumpNavMesh, GivesTheSameTextForTheSameNavMesh) {
  const PolygonMesh mesh = testing::randomMesh(4, 5, 5);
  EXPECT_EQ(dumpNavMesh(mesh, graphOf(mesh), {}), dumpNavMesh(mesh, graphOf(mesh), {}));
}

}  // namespace
}  // namespace forewalk::navmesh
