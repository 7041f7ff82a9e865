// Compiled by ctest without exceptions and RTTI, as engines do.
#include "forewalk.h"

forewalk_status openAndFrame(const char* scene, forewalk_frame_out* out) {
  forewalk_navmesh* navmesh = nullptr;
  forewalk_session* session = nullptr;
  forewalk_session_settings settings;
  forewalk_session_settings_init(&settings, sizeof settings);
  settings.axes = FOREWALK_AXES_UNREAL;
  forewalk_status status = forewalk_navmesh_from_file(scene, nullptr, &navmesh);
  if (status == FOREWALK_OK) status = forewalk_session_create(navmesh, &settings, &session);
  out->struct_size = sizeof *out;
  if (status == FOREWALK_OK) status = forewalk_frame(session, {0, 0, 170}, {0, 0, 0, 1}, 0.0, out);
  forewalk_session_destroy(session);
  forewalk_navmesh_release(navmesh);
  return status;
}
