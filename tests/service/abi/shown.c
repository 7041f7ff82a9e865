/* Every function of the C interface with its types, so that abidiff can compare them with a release's.
 * Not linked with anything: the types are what counts. */
#include "forewalk.h"

#define SHOW(function) __typeof__(&function) shown_##function

SHOW(forewalk_build_settings_init);
SHOW(forewalk_frame);
SHOW(forewalk_graph);
SHOW(forewalk_last_error);
SHOW(forewalk_navmesh_from_file);
SHOW(forewalk_navmesh_from_fwmesh);
SHOW(forewalk_navmesh_from_triangles);
SHOW(forewalk_navmesh_polygon_count);
SHOW(forewalk_navmesh_polygons);
SHOW(forewalk_navmesh_release);
SHOW(forewalk_navmesh_retain);
SHOW(forewalk_navmesh_save);
SHOW(forewalk_session_create);
SHOW(forewalk_session_create_in_world);
SHOW(forewalk_session_destroy);
SHOW(forewalk_session_enter);
SHOW(forewalk_session_record);
SHOW(forewalk_session_set_chest);
SHOW(forewalk_session_set_gaze);
SHOW(forewalk_session_set_links);
SHOW(forewalk_session_set_standing);
SHOW(forewalk_session_settings_init);
SHOW(forewalk_session_teleport);
SHOW(forewalk_set_log);
SHOW(forewalk_space_create);
SHOW(forewalk_space_release);
SHOW(forewalk_space_retain);
SHOW(forewalk_space_settings_init);
SHOW(forewalk_version);
SHOW(forewalk_world_from_file);
SHOW(forewalk_world_from_triangles);
SHOW(forewalk_world_release);
SHOW(forewalk_world_remove_link);
SHOW(forewalk_world_remove_obstacle);
SHOW(forewalk_world_retain);
SHOW(forewalk_world_set_door);
SHOW(forewalk_world_set_link);
SHOW(forewalk_world_set_obstacles);
SHOW(forewalk_world_set_standing);
SHOW(forewalk_world_settings_init);
SHOW(forewalk_world_version);
SHOW(forewalk_world_wait);

/* And every struct by itself: what is only reached through another is not compared. */
#define SHOW_TYPE(type) type *shown_##type

SHOW_TYPE(forewalk_vec3);
SHOW_TYPE(forewalk_quat);
SHOW_TYPE(forewalk_pose);
SHOW_TYPE(forewalk_build_settings);
SHOW_TYPE(forewalk_point2);
SHOW_TYPE(forewalk_space_settings);
SHOW_TYPE(forewalk_session_settings);
SHOW_TYPE(forewalk_frame_out);
SHOW_TYPE(forewalk_node);
SHOW_TYPE(forewalk_edge);
SHOW_TYPE(forewalk_front);
SHOW_TYPE(forewalk_way);
SHOW_TYPE(forewalk_way_event);
SHOW_TYPE(forewalk_graph_view);
SHOW_TYPE(forewalk_link);
SHOW_TYPE(forewalk_standing);
SHOW_TYPE(forewalk_door);
SHOW_TYPE(forewalk_obstacle);
SHOW_TYPE(forewalk_world_settings);
