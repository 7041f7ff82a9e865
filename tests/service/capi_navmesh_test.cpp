// Navmeshes of the C interface: made, saved, loaded, refused, and shown as polygons.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <limits>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "tests/service/capi_support.h"

namespace forewalk::capi {
namespace {

using testing::makeNavMesh;
using testing::NavMeshHandle;

TEST(CapiNavMesh, RefusesSettingsThatCannotWork) {
  const testing::SceneArrays scene = testing::arraysOf(testing::twoRooms(0.9f));
  const auto refused = [&](const std::function<void(forewalk_build_settings&)>& spoil) {
    forewalk_build_settings settings;
    forewalk_build_settings_init(&settings, sizeof settings);
    spoil(settings);
    auto* navmesh = reinterpret_cast<forewalk_navmesh*>(0x1);
    const forewalk_status status = forewalk_navmesh_from_triangles(
        scene.vertices.data(), scene.vertices.size() / 3, scene.indices.data(),
        scene.indices.size(), FOREWALK_AXES_OPENXR, &settings, &navmesh);
    EXPECT_EQ(navmesh, nullptr);
    return status;
  };
  EXPECT_EQ(refused([](auto& s) { s.struct_size = 8; }), FOREWALK_ERROR_ARGUMENT);
  EXPECT_EQ(refused([](auto& s) { s.partition = 3; }), FOREWALK_ERROR_ARGUMENT);
  EXPECT_EQ(refused([](auto& s) { s.cell = 0; }), FOREWALK_ERROR_SETTING_OUT_OF_RANGE);
  EXPECT_EQ(refused([](auto& s) { s.metres_per_unit = -1; }), FOREWALK_ERROR_SETTING_OUT_OF_RANGE);
  EXPECT_EQ(refused([](auto& s) { s.slope = std::nanf(""); }), FOREWALK_ERROR_SETTING_OUT_OF_RANGE);
  EXPECT_EQ(refused([](auto& s) { s.radius = 3; }), FOREWALK_ERROR_NOTHING_WALKABLE);
}

TEST(CapiNavMesh, RefusesTrianglesThatAreNone) {
  testing::SceneArrays scene = testing::arraysOf(testing::twoRooms(0.9f));
  forewalk_navmesh* navmesh = nullptr;
  const auto build = [&](std::size_t indexCount, forewalk_axes axes = FOREWALK_AXES_OPENXR) {
    return forewalk_navmesh_from_triangles(scene.vertices.data(), scene.vertices.size() / 3,
                                           scene.indices.data(), indexCount, axes, nullptr,
                                           &navmesh);
  };
  EXPECT_EQ(build(0), FOREWALK_ERROR_SCENE_EMPTY);
  EXPECT_EQ(build(5), FOREWALK_ERROR_DATA_DAMAGED);
  EXPECT_EQ(build(6, 7), FOREWALK_ERROR_ARGUMENT);
  EXPECT_EQ(build(SIZE_MAX), FOREWALK_ERROR_TOO_LARGE);
  // A floor that is wound the other way is a ceiling.
  std::swap(scene.indices[1], scene.indices[2]);
  std::swap(scene.indices[4], scene.indices[5]);
  EXPECT_EQ(build(6), FOREWALK_ERROR_NOTHING_WALKABLE);
  scene.indices[4] = 4000000000u;
  EXPECT_EQ(build(6), FOREWALK_ERROR_DATA_DAMAGED);
  EXPECT_NE(std::string(forewalk_last_error()).find("4000000000"), std::string::npos);
  scene.indices[4] = 0;
  scene.vertices[1] = std::numeric_limits<float>::infinity();
  EXPECT_EQ(build(6), FOREWALK_ERROR_DATA_DAMAGED);
  EXPECT_EQ(navmesh, nullptr);
}

std::vector<unsigned char> saved(const NavMeshHandle& navmesh) {
  std::size_t size = 0;
  EXPECT_EQ(forewalk_navmesh_save(navmesh.get(), nullptr, &size), FOREWALK_OK);
  std::vector<unsigned char> bytes(size);
  EXPECT_EQ(forewalk_navmesh_save(navmesh.get(), bytes.data(), &size), FOREWALK_OK);
  EXPECT_EQ(size, bytes.size());
  return bytes;
}

TEST(CapiNavMesh, IsTheSameAfterSavingAndLoading) {
  const NavMeshHandle navmesh = makeNavMesh(testing::twoStoreys());
  std::vector<unsigned char> bytes = saved(navmesh);
  forewalk_navmesh* loaded = nullptr;
  ASSERT_EQ(forewalk_navmesh_from_fwmesh(bytes.data(), bytes.size(), &loaded), FOREWALK_OK);
  const NavMeshHandle again(loaded);
  EXPECT_EQ(saved(again), bytes);
  EXPECT_EQ(forewalk_navmesh_polygon_count(loaded), forewalk_navmesh_polygon_count(navmesh.get()));

  std::size_t small = bytes.size() - 1;
  EXPECT_EQ(forewalk_navmesh_save(navmesh.get(), bytes.data(), &small), FOREWALK_ERROR_ARGUMENT);
  EXPECT_EQ(small, bytes.size());

  for (std::size_t size = 0; size < bytes.size(); size += 1 + bytes.size() / 97) {
    const std::vector<unsigned char> cut(bytes.begin(),
                                         bytes.begin() + static_cast<std::ptrdiff_t>(size));
    forewalk_navmesh* none = nullptr;
    EXPECT_NE(forewalk_navmesh_from_fwmesh(cut.data(), cut.size(), &none), FOREWALK_OK) << size;
    EXPECT_EQ(none, nullptr);
  }
}

TEST(CapiNavMesh, IsReadFromFiles) {
  const std::string scene = std::string(FOREWALK_ASSETS) + "/scenes/corridor.obj";
  forewalk_navmesh* made = nullptr;
  ASSERT_EQ(forewalk_navmesh_from_file(scene.c_str(), nullptr, &made), FOREWALK_OK)
      << forewalk_last_error();
  const NavMeshHandle built(made);
  EXPECT_GT(forewalk_navmesh_polygon_count(made), 0u);

  const auto folder = std::filesystem::path(::testing::TempDir());
  const std::string file = (folder / "forewalk capi \xc3\xa4.fwmesh").string();
  const std::vector<unsigned char> bytes = saved(built);
  std::ofstream(file, std::ios::binary)
      .write(reinterpret_cast<const char*>(bytes.data()),
             static_cast<std::streamsize>(bytes.size()));
  ASSERT_EQ(forewalk_navmesh_from_file(file.c_str(), nullptr, &made), FOREWALK_OK);
  EXPECT_EQ(saved(NavMeshHandle(made)), bytes);
  std::filesystem::remove(file);

  EXPECT_EQ(forewalk_navmesh_from_file(file.c_str(), nullptr, &made),
            FOREWALK_ERROR_FILE_UNREADABLE);
  EXPECT_EQ(made, nullptr);
  EXPECT_EQ(forewalk_navmesh_from_file("", nullptr, &made), FOREWALK_ERROR_FORMAT_UNKNOWN);
  EXPECT_EQ(forewalk_navmesh_from_file("scene.txt", nullptr, &made), FOREWALK_ERROR_FORMAT_UNKNOWN);
}

// --- an engine's triangles

TEST(CapiNavMesh, IsTheSameFromEveryEnginesTriangles) {
  const navmesh::Scene scene = testing::twoRooms(0.875f);
  testing::SceneArrays ours = testing::arraysOf(scene);
  // On a grid that centimetres hold.
  for (float& coordinate : ours.vertices) coordinate = std::round(1024.0f * coordinate) / 1024.0f;
  testing::SceneArrays unity = ours, unreal = ours, zUp = ours;
  for (std::size_t i = 0; i < ours.vertices.size(); i += 3) {
    const float x = ours.vertices[i], y = ours.vertices[i + 1], z = ours.vertices[i + 2];
    unity.vertices[i + 2] = -z;
    unreal.vertices[i] = -100.0f * z;
    unreal.vertices[i + 1] = 100.0f * x;
    unreal.vertices[i + 2] = 100.0f * y;
    zUp.vertices[i + 1] = -z;
    zUp.vertices[i + 2] = y;
  }
  for (std::size_t i = 0; i < ours.indices.size(); i += 3) {
    std::swap(unity.indices[i + 1], unity.indices[i + 2]);
  }
  forewalk_build_settings up;
  forewalk_build_settings_init(&up, sizeof up);
  up.z_up = 1;
  const std::vector<unsigned char> expected = saved(makeNavMesh(ours));
  EXPECT_EQ(saved(makeNavMesh(unity, FOREWALK_AXES_UNITY)), expected);
  EXPECT_EQ(saved(makeNavMesh(unreal, FOREWALK_AXES_UNREAL)), expected);
  EXPECT_EQ(saved(makeNavMesh(unreal, FOREWALK_AXES_UNREAL, &up)), expected);  // z_up is not used
  EXPECT_EQ(saved(makeNavMesh(zUp, FOREWALK_AXES_OPENXR, &up)), expected);
}

// --- polygons to draw

forewalk_navmesh_view polygonsOf(const NavMeshHandle& navmesh,
                                 forewalk_axes axes = FOREWALK_AXES_OPENXR) {
  forewalk_navmesh_view view{};
  view.struct_size = sizeof view;
  EXPECT_EQ(forewalk_navmesh_polygons(navmesh.get(), axes, &view), FOREWALK_OK);
  return view;
}

glm::vec3 ours(forewalk_vec3 v) { return {v.x, v.y, v.z}; }

TEST(CapiNavMesh, ShowsThePolygonsOfTheLibrary) {
  for (const navmesh::Scene& scene : {testing::twoRooms(0.9f), testing::twoStoreys()}) {
    const NavMeshHandle navmesh = makeNavMesh(scene);
    const auto world = testing::makeWorld(scene);
    const navmesh::NavGraph& graph = world->graph;
    const forewalk_navmesh_view view = polygonsOf(navmesh);
    ASSERT_EQ(view.polygon_count, graph.polygonCount());
    for (std::uint32_t p = 0; p < view.polygon_count; ++p) {
      const auto ring = graph.ringOf(navmesh::PolygonId{p});
      ASSERT_EQ(view.corner_start[p + 1] - view.corner_start[p], ring.size());
      for (std::size_t i = 0; i < ring.size(); ++i) {
        const glm::vec3 corner = ours(view.corners[view.corner_start[p] + i]);
        EXPECT_EQ(navmesh::toPlan(corner), ring[i]);
        EXPECT_EQ(corner.y, graph.ringHeight[graph.ringStart[p] + i]);
      }
      // The triangles lie on the surface and cover the polygon once.
      float area = 0.0f;
      for (std::uint32_t t = view.triangle_start[p]; t < view.triangle_start[p + 1]; ++t) {
        const forewalk_vec3* corner = view.triangles + 3 * t;
        const float twice =
            navmesh::turn(navmesh::toPlan(ours(corner[0])), navmesh::toPlan(ours(corner[1])),
                          navmesh::toPlan(ours(corner[2])));
        EXPECT_GE(twice, 0.0f);
        area += 0.5f * twice;
        for (int k = 0; k < 3; ++k) {
          const glm::vec3 at = ours(corner[k]);
          EXPECT_NEAR(navmesh::heightAt(graph, navmesh::PolygonId{p}, navmesh::toPlan(at)), at.y,
                      1e-3f);
        }
      }
      EXPECT_NEAR(area, navmesh::areaOf(graph, navmesh::PolygonId{p}), 1e-3f * (1.0f + area));
      // Each way out has its way back.
      for (std::uint32_t i = view.portal_start[p]; i < view.portal_start[p + 1]; ++i) {
        const forewalk_portal& out = view.portals[i];
        const std::span<const forewalk_portal> ways(
            view.portals + view.portal_start[out.to],
            view.portal_start[out.to + 1] - view.portal_start[out.to]);
        EXPECT_TRUE(std::any_of(ways.begin(), ways.end(), [&](const forewalk_portal& back) {
          return back.to == p && ours(back.left) == ours(out.right) &&
                 ours(back.right) == ours(out.left);
        })) << p;
      }
    }
    EXPECT_EQ(view.portal_start[view.polygon_count], graph.portalCount());
  }
}

TEST(CapiNavMesh, ShowsTheSamePolygonsInAllAxes) {
  const NavMeshHandle navmesh = makeNavMesh(testing::twoStoreys());
  const forewalk_navmesh_view view = polygonsOf(navmesh);
  const forewalk_navmesh_view unity = polygonsOf(navmesh, FOREWALK_AXES_UNITY);
  const forewalk_navmesh_view unreal = polygonsOf(navmesh, FOREWALK_AXES_UNREAL);
  for (std::uint32_t i = 0; i < view.corner_start[view.polygon_count]; ++i) {
    const forewalk_vec3 corner = view.corners[i];
    EXPECT_EQ(ours(unity.corners[i]), glm::vec3(corner.x, corner.y, -corner.z));
    EXPECT_EQ(ours(unreal.corners[i]),
              glm::vec3(-100.0f * corner.z, 100.0f * corner.x, 100.0f * corner.y));
  }
  EXPECT_EQ(polygonsOf(navmesh).corners, view.corners);  // made once
}

TEST(CapiNavMesh, RefusesToShowWhatCannotBe) {
  const NavMeshHandle navmesh = makeNavMesh(testing::twoRooms(0.9f));
  forewalk_navmesh_view view{};
  view.struct_size = sizeof view;
  EXPECT_EQ(forewalk_navmesh_polygons(nullptr, FOREWALK_AXES_OPENXR, &view),
            FOREWALK_ERROR_ARGUMENT);
  EXPECT_EQ(forewalk_navmesh_polygons(navmesh.get(), FOREWALK_AXES_OPENXR, nullptr),
            FOREWALK_ERROR_ARGUMENT);
  EXPECT_EQ(forewalk_navmesh_polygons(navmesh.get(), 3, &view), FOREWALK_ERROR_ARGUMENT);
  EXPECT_NE(std::string(forewalk_last_error()).find("axes"), std::string::npos);
  view.struct_size = 8;
  EXPECT_EQ(forewalk_navmesh_polygons(navmesh.get(), FOREWALK_AXES_OPENXR, &view),
            FOREWALK_ERROR_ARGUMENT);
  EXPECT_EQ(view.corners, nullptr);
}

}  // namespace
}  // namespace forewalk::capi
