// What others have compiled against: names, sizes, places. A change here breaks them.
#include "tests/service/capi_header.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <sstream>
#include <string>
#include <vector>

#include "forewalk.h"

namespace {

std::string outputOf(const std::string& command) {
  std::string output;
  std::FILE* pipe = popen(command.c_str(), "r");
  char chunk[4096];
  while (pipe != nullptr) {
    const std::size_t got = std::fread(chunk, 1, sizeof chunk, pipe);
    if (got == 0) break;
    output.append(chunk, got);
  }
  if (pipe != nullptr) pclose(pipe);
  return output;
}

TEST(CapiLibrary, ShowsTheseNamesAndNoOther) {
  const std::vector<std::string> expected = {
      "forewalk_build_settings_init",
      "forewalk_frame",
      "forewalk_graph",
      "forewalk_last_error",
      "forewalk_navmesh_from_file",
      "forewalk_navmesh_from_fwmesh",
      "forewalk_navmesh_from_triangles",
      "forewalk_navmesh_polygon_count",
      "forewalk_navmesh_polygons",
      "forewalk_navmesh_release",
      "forewalk_navmesh_retain",
      "forewalk_navmesh_save",
      "forewalk_session_create",
      "forewalk_session_create_in_world",
      "forewalk_session_destroy",
      "forewalk_session_enter",
      "forewalk_session_record",
      "forewalk_session_set_chest",
      "forewalk_session_set_gaze",
      "forewalk_session_set_links",
      "forewalk_session_set_standing",
      "forewalk_session_settings_init",
      "forewalk_session_teleport",
      "forewalk_set_log",
      "forewalk_space_create",
      "forewalk_space_release",
      "forewalk_space_retain",
      "forewalk_space_settings_init",
      "forewalk_version",
      "forewalk_world_from_file",
      "forewalk_world_from_triangles",
      "forewalk_world_release",
      "forewalk_world_remove_link",
      "forewalk_world_remove_obstacle",
      "forewalk_world_retain",
      "forewalk_world_set_door",
      "forewalk_world_set_link",
      "forewalk_world_set_obstacles",
      "forewalk_world_set_standing",
      "forewalk_world_settings_init",
      "forewalk_world_version",
      "forewalk_world_wait",
  };
  std::istringstream lines(
      outputOf(std::string(FOREWALK_NM) + " -D --defined-only " + FOREWALK_LIBRARY));
  std::vector<std::string> shown;
  // NAME@@FOREWALK_0.1; the version itself is a symbol, too.
  for (std::string address, kind, name; lines >> address >> kind >> name;) {
    if (kind == "A") continue;
    const std::size_t at = name.find("@@FOREWALK_0.1");
    EXPECT_NE(at, std::string::npos) << name << " has no version: see forewalk.map";
    shown.push_back(name.substr(0, at));
  }
  std::sort(shown.begin(), shown.end());
  EXPECT_EQ(shown, expected);
}

TEST(CapiHeader, LaysItsStructsOutAsEver) {
  if (sizeof(void*) != 8) GTEST_SKIP() << "the list is for 64 bits";
  EXPECT_EQ(sizeof(forewalk_vec3), 12u);
  EXPECT_EQ(sizeof(forewalk_quat), 16u);
  EXPECT_EQ(sizeof(forewalk_pose), 28u);
  EXPECT_EQ(sizeof(forewalk_point2), 8u);

  EXPECT_EQ(sizeof(forewalk_build_settings), 44u);
  EXPECT_EQ(offsetof(forewalk_build_settings, struct_size), 0u);
  EXPECT_EQ(offsetof(forewalk_build_settings, z_up), 4u);
  EXPECT_EQ(offsetof(forewalk_build_settings, metres_per_unit), 8u);
  EXPECT_EQ(offsetof(forewalk_build_settings, radius), 12u);
  EXPECT_EQ(offsetof(forewalk_build_settings, height), 16u);
  EXPECT_EQ(offsetof(forewalk_build_settings, climb), 20u);
  EXPECT_EQ(offsetof(forewalk_build_settings, slope), 24u);
  EXPECT_EQ(offsetof(forewalk_build_settings, cell), 28u);
  EXPECT_EQ(offsetof(forewalk_build_settings, cell_height), 32u);
  EXPECT_EQ(offsetof(forewalk_build_settings, tile), 36u);
  EXPECT_EQ(offsetof(forewalk_build_settings, partition), 40u);

  EXPECT_EQ(sizeof(forewalk_session_settings), 168u);
  EXPECT_EQ(offsetof(forewalk_session_settings, axes), 4u);
  EXPECT_EQ(offsetof(forewalk_session_settings, controller), 8u);
  EXPECT_EQ(offsetof(forewalk_session_settings, limits), 12u);
  EXPECT_EQ(offsetof(forewalk_session_settings, horizon), 16u);
  EXPECT_EQ(offsetof(forewalk_session_settings, border), 24u);
  EXPECT_EQ(offsetof(forewalk_session_settings, border_count), 32u);
  EXPECT_EQ(offsetof(forewalk_session_settings, width), 40u);
  EXPECT_EQ(offsetof(forewalk_session_settings, depth), 44u);
  EXPECT_EQ(offsetof(forewalk_session_settings, hole_points), 48u);
  EXPECT_EQ(offsetof(forewalk_session_settings, hole_sizes), 56u);
  EXPECT_EQ(offsetof(forewalk_session_settings, hole_count), 64u);
  EXPECT_EQ(offsetof(forewalk_session_settings, has_start), 72u);
  EXPECT_EQ(offsetof(forewalk_session_settings, start_floor), 76u);
  EXPECT_EQ(offsetof(forewalk_session_settings, start_heading), 88u);
  EXPECT_EQ(offsetof(forewalk_session_settings, translation_min), 92u);
  EXPECT_EQ(offsetof(forewalk_session_settings, curvature_max), 108u);
  EXPECT_EQ(offsetof(forewalk_session_settings, bending_max), 116u);
  EXPECT_EQ(offsetof(forewalk_session_settings, polygon_limit), 120u);
  EXPECT_EQ(offsetof(forewalk_session_settings, resets), 124u);
  EXPECT_EQ(offsetof(forewalk_session_settings, always_predict), 128u);
  EXPECT_EQ(offsetof(forewalk_session_settings, method), 136u);
  EXPECT_EQ(offsetof(forewalk_session_settings, persistence), 140u);
  EXPECT_EQ(offsetof(forewalk_session_settings, reset), 144u);
  EXPECT_EQ(offsetof(forewalk_session_settings, likelihoods), 152u);
  EXPECT_EQ(offsetof(forewalk_session_settings, heading_source), 156u);
  EXPECT_EQ(offsetof(forewalk_session_settings, space), 160u);

  EXPECT_EQ(sizeof(forewalk_space_settings), 64u);
  EXPECT_EQ(offsetof(forewalk_space_settings, border), 8u);
  EXPECT_EQ(offsetof(forewalk_space_settings, width), 24u);
  EXPECT_EQ(offsetof(forewalk_space_settings, hole_count), 48u);
  EXPECT_EQ(offsetof(forewalk_space_settings, body_radius), 56u);
  EXPECT_EQ(offsetof(forewalk_space_settings, user_limit), 60u);

  EXPECT_EQ(sizeof(forewalk_frame_out), 120u);
  EXPECT_EQ(offsetof(forewalk_frame_out, flags), 4u);
  EXPECT_EQ(offsetof(forewalk_frame_out, virtual_pose), 8u);
  EXPECT_EQ(offsetof(forewalk_frame_out, translation), 36u);
  EXPECT_EQ(offsetof(forewalk_frame_out, injected_yaw), 52u);
  EXPECT_EQ(offsetof(forewalk_frame_out, injected_translation), 56u);
  EXPECT_EQ(offsetof(forewalk_frame_out, resetting), 68u);
  EXPECT_EQ(offsetof(forewalk_frame_out, instruction), 72u);
  EXPECT_EQ(offsetof(forewalk_frame_out, reset_remaining), 76u);
  EXPECT_EQ(offsetof(forewalk_frame_out, reset_turned), 80u);
  EXPECT_EQ(offsetof(forewalk_frame_out, reset_count), 84u);
  EXPECT_EQ(offsetof(forewalk_frame_out, graph_nodes), 88u);
  EXPECT_EQ(offsetof(forewalk_frame_out, predict_seconds), 92u);
  EXPECT_EQ(offsetof(forewalk_frame_out, steer_seconds), 96u);
  EXPECT_EQ(offsetof(forewalk_frame_out, reset_phase), 100u);
  EXPECT_EQ(offsetof(forewalk_frame_out, reset_back), 104u);
  EXPECT_EQ(offsetof(forewalk_frame_out, reset_direction), 108u);

  EXPECT_EQ(sizeof(forewalk_node), 28u);
  EXPECT_EQ(offsetof(forewalk_node, distance), 12u);
  EXPECT_EQ(offsetof(forewalk_node, prev), 16u);
  EXPECT_EQ(offsetof(forewalk_node, polygon), 20u);
  EXPECT_EQ(offsetof(forewalk_node, kind), 24u);
  EXPECT_EQ(offsetof(forewalk_node, branch), 26u);

  EXPECT_EQ(sizeof(forewalk_edge), 24u);
  EXPECT_EQ(offsetof(forewalk_edge, length), 8u);
  EXPECT_EQ(offsetof(forewalk_edge, path_start), 12u);
  EXPECT_EQ(offsetof(forewalk_edge, loop), 20u);

  EXPECT_EQ(sizeof(forewalk_front), 32u);
  EXPECT_EQ(offsetof(forewalk_front, length), 4u);
  EXPECT_EQ(offsetof(forewalk_front, from), 8u);
  EXPECT_EQ(offsetof(forewalk_front, to), 20u);

  EXPECT_EQ(sizeof(forewalk_way), 16u);
  EXPECT_EQ(offsetof(forewalk_way, likelihood), 8u);
  EXPECT_EQ(offsetof(forewalk_way, born), 12u);
  EXPECT_EQ(sizeof(forewalk_way_event), 12u);
  EXPECT_EQ(offsetof(forewalk_way_event, change), 8u);

  EXPECT_EQ(sizeof(forewalk_link), 40u);
  EXPECT_EQ(sizeof(forewalk_standing), 20u);
  EXPECT_EQ(sizeof(forewalk_door), 32u);
  EXPECT_EQ(offsetof(forewalk_door, corners), 8u);
  EXPECT_EQ(offsetof(forewalk_door, cost), 28u);
  EXPECT_EQ(sizeof(forewalk_obstacle), 64u);
  EXPECT_EQ(offsetof(forewalk_obstacle, half_size), 20u);
  EXPECT_EQ(offsetof(forewalk_obstacle, radius), 36u);
  EXPECT_EQ(offsetof(forewalk_obstacle, corners), 48u);
  EXPECT_EQ(sizeof(forewalk_world_settings), 32u);
  EXPECT_EQ(offsetof(forewalk_world_settings, build), 8u);
  EXPECT_EQ(offsetof(forewalk_world_settings, door_count), 24u);

  EXPECT_EQ(sizeof(forewalk_portal), 32u);
  EXPECT_EQ(offsetof(forewalk_portal, left), 8u);
  EXPECT_EQ(sizeof(forewalk_navmesh_view), 56u);
  EXPECT_EQ(offsetof(forewalk_navmesh_view, corner_start), 8u);
  EXPECT_EQ(offsetof(forewalk_navmesh_view, portals), 32u);
  EXPECT_EQ(offsetof(forewalk_navmesh_view, triangles), 48u);

  EXPECT_EQ(sizeof(forewalk_graph_view), 104u);
  EXPECT_EQ(offsetof(forewalk_graph_view, nodes), 8u);
  EXPECT_EQ(offsetof(forewalk_graph_view, edge_count), 16u);
  EXPECT_EQ(offsetof(forewalk_graph_view, edges), 24u);
  EXPECT_EQ(offsetof(forewalk_graph_view, points), 32u);
  EXPECT_EQ(offsetof(forewalk_graph_view, complete_to), 44u);
  EXPECT_EQ(offsetof(forewalk_graph_view, fronts), 48u);
  EXPECT_EQ(offsetof(forewalk_graph_view, widths), 56u);
  EXPECT_EQ(offsetof(forewalk_graph_view, front_count), 64u);
  EXPECT_EQ(offsetof(forewalk_graph_view, method), 68u);
  EXPECT_EQ(offsetof(forewalk_graph_view, ways), 72u);
  EXPECT_EQ(offsetof(forewalk_graph_view, way_events), 80u);
  EXPECT_EQ(offsetof(forewalk_graph_view, way_count), 88u);
  EXPECT_EQ(offsetof(forewalk_graph_view, likelihood_none), 96u);
}

TEST(CapiHeader, MeansTheSameInCAndInCpp) {
  const std::vector<std::size_t> here = {
      sizeof(forewalk_vec3),          sizeof(forewalk_quat),
      sizeof(forewalk_pose),          sizeof(forewalk_build_settings),
      sizeof(forewalk_point2),        sizeof(forewalk_session_settings),
      sizeof(forewalk_frame_out),     sizeof(forewalk_node),
      sizeof(forewalk_edge),          sizeof(forewalk_graph_view),
      sizeof(forewalk_front),         sizeof(forewalk_space_settings),
      sizeof(forewalk_way),           sizeof(forewalk_way_event),
      sizeof(forewalk_link),          sizeof(forewalk_standing),
      sizeof(forewalk_door),          sizeof(forewalk_obstacle),
      sizeof(forewalk_world_settings)};
  EXPECT_EQ(std::vector<std::size_t>(capi_sizes_in_c, capi_sizes_in_c + capi_size_count), here);
}

TEST(CapiHeader, ServesAProgramInC) {
  forewalk_frame_out out{};
  ASSERT_EQ(capi_walk_in_c(&out), FOREWALK_OK) << forewalk_last_error();
  EXPECT_EQ(out.flags, static_cast<std::uint32_t>(FOREWALK_FLAG_FIRST_FRAME));
  EXPECT_EQ(out.virtual_pose.position.y, 1.7f);
}

TEST(CapiLibrary, SaysTheVersionOfItsHeader) {
  EXPECT_EQ(forewalk_version(), (FOREWALK_VERSION_MAJOR << 16) + (FOREWALK_VERSION_MINOR << 8) +
                                    FOREWALK_VERSION_PATCH);
  EXPECT_EQ(std::to_string(FOREWALK_VERSION_MAJOR) + "." + std::to_string(FOREWALK_VERSION_MINOR) +
                "." + std::to_string(FOREWALK_VERSION_PATCH),
            FOREWALK_PROJECT_VERSION);
}

}  // namespace
