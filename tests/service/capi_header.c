/* The header as a C99 compiler sees it, and a session from C. */
#include "forewalk.h"

#include "tests/service/capi_header.h"

const size_t capi_sizes_in_c[] = {
    sizeof(forewalk_vec3),           sizeof(forewalk_quat),
    sizeof(forewalk_pose),           sizeof(forewalk_build_settings),
    sizeof(forewalk_point2),         sizeof(forewalk_session_settings),
    sizeof(forewalk_frame_out),      sizeof(forewalk_node),
    sizeof(forewalk_edge),           sizeof(forewalk_graph_view),
    sizeof(forewalk_front),          sizeof(forewalk_space_settings),
    sizeof(forewalk_way),            sizeof(forewalk_way_event),
    sizeof(forewalk_link),           sizeof(forewalk_standing),
    sizeof(forewalk_door),           sizeof(forewalk_obstacle),
    sizeof(forewalk_world_settings),
};
const size_t capi_size_count = sizeof capi_sizes_in_c / sizeof capi_sizes_in_c[0];

int capi_walk_in_c(forewalk_frame_out *out) {
  static const float vertices[] = {-5, 0, 5, 5, 0, 5, 5, 0, -5, -5, 0, -5};
  static const uint32_t indices[] = {0, 1, 2, 0, 2, 3};
  const forewalk_vec3 head = {0.0f, 1.7f, 0.0f};
  const forewalk_quat ahead = {0.0f, 0.0f, 0.0f, 1.0f};
  forewalk_build_settings build;
  forewalk_session_settings settings;
  forewalk_navmesh *navmesh = NULL;
  forewalk_session *session = NULL;
  forewalk_status status;
  forewalk_build_settings_init(&build, sizeof build);
  forewalk_session_settings_init(&settings, sizeof settings);
  status = forewalk_navmesh_from_triangles(vertices, 4, indices, 6, FOREWALK_AXES_OPENXR, &build,
                                           &navmesh);
  if (status == FOREWALK_OK) status = forewalk_session_create(navmesh, &settings, &session);
  out->struct_size = sizeof *out;
  if (status == FOREWALK_OK) status = forewalk_frame(session, head, ahead, 0.0, out);
  forewalk_session_destroy(session);
  forewalk_navmesh_release(navmesh);
  return (int)status;
}
