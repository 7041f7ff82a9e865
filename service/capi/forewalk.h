/*
 * forewalk: redirected walking that knows where the user can go next. The C interface.
 *
 * What a VR runtime calls once per frame. C99, no other include than the standard ones.
 *
 *   forewalk_navmesh  where one can walk. Made once from a scene file, from triangles in memory or
 *                     from a .fwmesh; then only read, and shared by any number of sessions on any
 *                     threads.
 *   forewalk_session  one user: tracked space, limits, controller, horizon. One thread at a time
 *                     each.
 *
 * Units: metres, seconds, radians. Axes by default: right-handed, +Y up, forward -Z (OpenXR, glTF).
 * A session can be made in Unity's or Unreal's convention; then every pose, position, direction and
 * angle that goes in or comes out of that session is in that convention (see forewalk_axes).
 *
 * Errors: every function that can fail returns a forewalk_status. forewalk_last_error() gives the
 * sentence of the calling thread's latest failure. No call throws, aborts or prints. Null pointers
 * are refused with FOREWALK_ERROR_ARGUMENT.
 *
 * Structs carry their own size. Settings: call their _init function, then change what should
 * differ. What a call fills (forewalk_frame_out, forewalk_graph_view): set struct_size = sizeof(the
 * struct). Fields are only ever added at the end. A library that knows more fields than the caller
 * fills or reads only the caller's; one that knows fewer leaves the rest alone. A struct_size that
 * no version has had is refused.
 *
 * Frames: forewalk_frame allocates nothing, locks nothing and never blocks.
 */
#ifndef FOREWALK_H
#define FOREWALK_H

#include <stddef.h>
#include <stdint.h>

#if defined(_WIN32) && defined(FOREWALK_BUILDS_LIBRARY)
#define FOREWALK_API __declspec(dllexport)
#elif defined(_WIN32)
#define FOREWALK_API __declspec(dllimport)
#elif defined(__GNUC__)
#define FOREWALK_API __attribute__((visibility("default")))
#else
#define FOREWALK_API
#endif

#ifdef __cplusplus
extern "C" {
#endif

#define FOREWALK_VERSION_MAJOR 0
#define FOREWALK_VERSION_MINOR 1
#define FOREWALK_VERSION_PATCH 0

/* Version of the library that is loaded: major << 16 | minor << 8 | patch. */
FOREWALK_API uint32_t forewalk_version(void);

/* ---- errors --------------------------------------------------------------------------------- */

typedef int32_t forewalk_status;
enum {
  FOREWALK_OK = 0,
  FOREWALK_ERROR_FILE_UNREADABLE = 1,
  FOREWALK_ERROR_FORMAT_UNKNOWN = 2,
  FOREWALK_ERROR_FORMAT_UNSUPPORTED = 3,
  FOREWALK_ERROR_DATA_DAMAGED = 4,
  FOREWALK_ERROR_SCENE_EMPTY = 5,
  FOREWALK_ERROR_SETTING_OUT_OF_RANGE = 6,
  FOREWALK_ERROR_NOTHING_WALKABLE = 7,
  FOREWALK_ERROR_TOO_LARGE = 8,
  FOREWALK_ERROR_POSITION_OFF_NAVMESH = 9,
  FOREWALK_ERROR_FILE_UNWRITABLE = 10,
  FOREWALK_ERROR_ARGUMENT = 100, /* null, an unknown constant, a wrong struct_size */
  FOREWALK_ERROR_OUT_OF_MEMORY = 101,
  FOREWALK_ERROR_INTERNAL = 102 /* a defect of ours; the sentence says what is known */
};

/* The calling thread's latest failure: one sentence, UTF-8, "" if there was none. Lives until the
 * thread's next failing call, or its end. */
FOREWALK_API const char* forewalk_last_error(void);

/* ---- plain values --------------------------------------------------------------------------- */

typedef struct forewalk_vec3 {
  float x, y, z;
} forewalk_vec3;

/* Unit quaternion: turns the head's own axes into the world's, both named as in forewalk_axes. */
typedef struct forewalk_quat {
  float x, y, z, w;
} forewalk_quat;

typedef struct forewalk_pose {
  forewalk_vec3 position;
  forewalk_quat orientation;
} forewalk_pose;

/* Whose axes and units a session speaks. Angles follow the axes: what turns left is positive in
 * FOREWALK_AXES_OPENXR (seen from above, counter-clockwise) and negative in the left-handed two, as
 * is a yaw there; so does the sign of a curvature. Positions and displacements have the axes' unit;
 * what is called a distance, a length or a horizon is in metres everywhere. */
typedef int32_t forewalk_axes;
enum {
  FOREWALK_AXES_OPENXR = 0, /* right-handed, +Y up, forward -Z, metres; also glTF, Godot, WebXR */
  FOREWALK_AXES_UNITY = 1,  /* left-handed, +Y up, forward +Z, metres */
  FOREWALK_AXES_UNREAL = 2  /* left-handed, +Z up, forward +X, right +Y, centimetres */
};

/* ---- navmesh -------------------------------------------------------------------------------- */

typedef struct forewalk_navmesh forewalk_navmesh;

typedef int32_t forewalk_partition;
enum {
  FOREWALK_PARTITION_WATERSHED = 0,
  FOREWALK_PARTITION_MONOTONE = 1,
  FOREWALK_PARTITION_LAYERS = 2
};

/* How to read a scene and whom to build for. forewalk_build_settings_init gives the defaults: a
 * walking person in a scene in metres, +Y up. */
typedef struct forewalk_build_settings {
  uint32_t struct_size;
  int32_t z_up;          /* 0: +Y is up in the scene; 1: +Z is */
  float metres_per_unit; /* > 0 */
  float radius;          /* walker, metres, >= 0 */
  float height;          /* walker, metres, > 0 */
  float climb;           /* highest step, metres, >= 0 */
  float slope;           /* steepest ground, radians, [0, pi/2) */
  float cell;            /* voxel size on the ground, metres, > 0 */
  float cell_height;     /* voxel height, metres, > 0 */
  float tile;            /* side of a tile, metres; 0: one piece */
  forewalk_partition partition;
} forewalk_build_settings;

FOREWALK_API void forewalk_build_settings_init(forewalk_build_settings* settings);

/* Builds from a scene file (.obj .off .ply .stl .gltf .glb), or loads a .fwmesh or RecastDemo's
 * tile set (.bin; settings are then not used). `path` is UTF-8. `settings` may be null: defaults.
 * On success *navmesh is the caller's to release, on failure null. Tiles are built on all cores;
 * the threads end with the call. */
FOREWALK_API forewalk_status forewalk_navmesh_from_file(const char* path,
                                                        const forewalk_build_settings* settings,
                                                        forewalk_navmesh** navmesh);

/* Builds from triangles an engine has in memory: `vertex_count` times x, y, z, and `index_count`
 * indices, three a triangle. The arrays are only read during the call. Vertices are in `axes`, and
 * the winding is the one that the engine's own meshes have, seen from outside: counter-clockwise
 * for FOREWALK_AXES_OPENXR and FOREWALK_AXES_UNREAL, clockwise for FOREWALK_AXES_UNITY. z_up is
 * used with FOREWALK_AXES_OPENXR only. metres_per_unit scales what the axes' unit gives: leave it
 * at 1 for Unreal's centimetres. */
FOREWALK_API forewalk_status forewalk_navmesh_from_triangles(
    const float* vertices, size_t vertex_count, const uint32_t* indices, size_t index_count,
    forewalk_axes axes, const forewalk_build_settings* settings, forewalk_navmesh** navmesh);

/* Loads the bytes of a .fwmesh. They are only read during the call. */
FOREWALK_API forewalk_status forewalk_navmesh_from_fwmesh(const void* bytes, size_t byte_count,
                                                          forewalk_navmesh** navmesh);

/* The bytes of a .fwmesh of this navmesh. Call with `buffer` null to learn the size; then with a
 * buffer of *byte_count bytes. *byte_count is set to the size in every case; a buffer that is
 * smaller is not written to (FOREWALK_ERROR_ARGUMENT). */
FOREWALK_API forewalk_status forewalk_navmesh_save(const forewalk_navmesh* navmesh, void* buffer,
                                                   size_t* byte_count);

/* 0 for null. */
FOREWALK_API uint32_t forewalk_navmesh_polygon_count(const forewalk_navmesh* navmesh);

/* One more owner; thread-safe. Sessions are owners of their own: a navmesh may be released while
 * sessions on it live. */
FOREWALK_API void forewalk_navmesh_retain(forewalk_navmesh* navmesh);
FOREWALK_API void forewalk_navmesh_release(forewalk_navmesh* navmesh); /* null is fine */

/* ---- session -------------------------------------------------------------------------------- */

typedef struct forewalk_session forewalk_session;

typedef int32_t forewalk_controller;
enum {
  FOREWALK_CONTROLLER_NONE = 0,
  FOREWALK_CONTROLLER_S2C = 1,            /* steer-to-center as published */
  FOREWALK_CONTROLLER_S2O = 2,            /* steer-to-orbit as published */
  FOREWALK_CONTROLLER_S2C_PREDICTIVE = 3, /* the same fed by the prediction graph; the default */
  FOREWALK_CONTROLLER_S2O_PREDICTIVE = 4
};

typedef int32_t forewalk_limits;
enum {
  FOREWALK_LIMITS_STEINICKE = 0,  /* detection thresholds of Steinicke et al. 2010; the default */
  FOREWALK_LIMITS_LABORATORY = 1, /* the same with curvature up to 1/7.5 per metre */
  FOREWALK_LIMITS_NETH = 2,       /* the same with curvature up to 1/10 per metre */
  FOREWALK_LIMITS_TOOLKIT = 3,    /* what RDWT and OpenRDW ship */
  FOREWALK_LIMITS_CUSTOM = 4      /* the numbers in the settings */
};

/* Horizontal point: x to the right in all axes; `forward` along the axes' forward direction. Metres
 * (Unreal: centimetres). */
typedef struct forewalk_point2 {
  float right, forward;
} forewalk_point2;

typedef struct forewalk_session_settings {
  uint32_t struct_size;
  forewalk_axes axes;
  forewalk_controller controller;
  forewalk_limits limits;
  float horizon; /* metres ahead along the virtual path, (0, 1000]; default 10 */

  /* The tracked space: a polygon, in the tracking system's coordinates. The points are only read
   * while the session is made. border_count 0: a rectangle of width (right) by depth (forward)
   * about the origin. */
  const forewalk_point2* border;
  size_t border_count;
  float width, depth; /* metres (Unreal: centimetres); default 0: 4 metres */

  /* Pillars and tables inside the border, `hole_count` of them: hole_sizes[i] points each, one
   * after the other in hole_points. Only read while the session is made; default none. */
  const forewalk_point2* hole_points;
  const size_t* hole_sizes;
  size_t hole_count;

  /* Where the first frame's head is put: above this point of the virtual floor, looking along this
   * heading (radians; 0 is forward; sign as forewalk_axes says). has_start 0: virtual space is
   * physical space at first. */
  int32_t has_start;
  forewalk_vec3 start_floor;
  float start_heading;

  /* For FOREWALK_LIMITS_CUSTOM; virtual over physical, and 1/metre. */
  float translation_min, translation_max;
  float rotation_min, rotation_max;
  float curvature_max;
  float bending_min, bending_max;

  uint32_t polygon_limit; /* most polygons in one prediction, >= 1; default 16384 */
  int32_t resets;         /* 0: never stop the user; default 1 */
  int32_t always_predict; /* 0: only where the controller asks for it; default 1 */
  uint32_t reserved;      /* 0 */
} forewalk_session_settings;

FOREWALK_API void forewalk_session_settings_init(forewalk_session_settings* settings);

/* `settings` may be null: defaults. On success *session is the caller's to destroy, on failure
 * null. */
FOREWALK_API forewalk_status forewalk_session_create(const forewalk_navmesh* navmesh,
                                                     const forewalk_session_settings* settings,
                                                     forewalk_session** session);
FOREWALK_API void forewalk_session_destroy(forewalk_session* session); /* null is fine */

/* What to tell the user in a reset. */
typedef int32_t forewalk_instruction;
enum {
  FOREWALK_INSTRUCTION_NONE = 0,
  FOREWALK_INSTRUCTION_TURN_AROUND = 1,  /* stop, and turn on the spot, either way */
  FOREWALK_INSTRUCTION_KEEP_TURNING = 2, /* go on turning the same way */
  FOREWALK_INSTRUCTION_WALK_BACK = 3     /* walk back into the tracked space */
};

/* Bits of forewalk_frame_out.flags. */
enum {
  FOREWALK_FLAG_FIRST_FRAME = 1 << 0,
  FOREWALK_FLAG_TIME_STOOD_STILL = 1 << 1,
  FOREWALK_FLAG_TIME_RAN_BACKWARDS = 1 << 2, /* or was not a number */
  FOREWALK_FLAG_TIME_GAP = 1 << 3,
  FOREWALK_FLAG_TRACKING_JUMP = 1 << 4,   /* moved more than 1 m: no gain was applied */
  FOREWALK_FLAG_POSE_NOT_FINITE = 1 << 5, /* the last sound position was taken */
  FOREWALK_FLAG_ORIENTATION_NOT_UNIT = 1 << 6,
  FOREWALK_FLAG_ORIENTATION_UNUSABLE = 1 << 7,
  FOREWALK_FLAG_OUTSIDE_SPACE = 1 << 8,
  FOREWALK_FLAG_BORDER_NEAR = 1 << 9, /* a reset is about to be needed */
  FOREWALK_FLAG_OFF_NAVMESH = 1 << 10,
  FOREWALK_FLAG_SNAPPED = 1 << 11,    /* beside the navmesh: its nearest point was taken */
  FOREWALK_FLAG_GRAPH_LIMIT = 1 << 12 /* raise polygon_limit or shorten the horizon */
};

typedef struct forewalk_frame_out {
  uint32_t struct_size;
  uint32_t flags;
  forewalk_pose virtual_pose; /* what to render from */
  float translation;          /* gains as applied: virtual over physical */
  float rotation;
  float curvature; /* 1/metre whatever the axes' unit; positive as an angle is */
  float bending;
  float injected_yaw; /* radians by which the world was turned about the head this frame */
  forewalk_vec3 injected_translation; /* by which the user was pushed this frame, virtual */
  int32_t resetting;                  /* 1 while the user is being turned */
  forewalk_instruction instruction;
  float reset_remaining; /* physical radians to go, >= 0 */
  float reset_turned;    /* physical radians turned since it began; its sign is the way to go on */
  uint32_t reset_count;  /* begun so far */
  uint32_t graph_nodes;
  float predict_seconds; /* time spent: finding the place and the graph */
  float steer_seconds;   /* and choosing and applying gains */
} forewalk_frame_out;

/* One frame: the tracked head in the tracking system's space (its floor at height 0), and a time
 * that does not run backwards. Odd input is reported in out->flags and leaves the session usable;
 * whatever comes in, what comes out is finite. Fails only for null pointers and a wrong
 * struct_size. */
FOREWALK_API forewalk_status forewalk_frame(forewalk_session* session, forewalk_vec3 head_position,
                                            forewalk_quat head_orientation, double seconds,
                                            forewalk_frame_out* out);

/* Puts the user's next frame at another place of the virtual floor (a teleport, a lift), looking
 * along `heading`. Off the navmesh (more than 0.5 m beside it, above or below) it fails with
 * FOREWALK_ERROR_POSITION_OFF_NAVMESH, and nothing changes. */
FOREWALK_API forewalk_status forewalk_session_teleport(forewalk_session* session,
                                                       forewalk_vec3 floor, float heading);

/* ---- the prediction graph ------------------------------------------------------------------- */

typedef uint8_t forewalk_node_kind;
enum { FOREWALK_NODE_SOURCE = 0, FOREWALK_NODE_BRANCH = 1, FOREWALK_NODE_TERMINAL = 2 };

typedef uint8_t forewalk_terminal_reason;
enum { FOREWALK_REASON_NONE = 0, FOREWALK_REASON_HORIZON = 1, FOREWALK_REASON_DEAD_END = 2 };

typedef struct forewalk_node {
  forewalk_vec3 position;
  float distance;   /* of the taut path from the source, metres */
  uint32_t prev;    /* the branch node or source before it; of the source: UINT32_MAX */
  uint32_t polygon; /* UINT32_MAX: none, the user is off the navmesh */
  forewalk_node_kind kind;
  forewalk_terminal_reason reason;
  uint8_t branch; /* 1: a branch node (a terminal can be one too) */
  uint8_t reserved;
} forewalk_node;

typedef struct forewalk_edge {
  uint32_t from, to; /* nodes */
  float length;      /* of the taut path between them, metres */
  /* Its points in forewalk_graph_view.points, from `from` to `to`. They lie on the floor, with one
   * wherever the floor bends (stairs). */
  uint32_t path_start, path_count;
  int32_t loop; /* 0: to its prev; 1: joins neighbours that the tree leaves apart */
} forewalk_edge;

/* This frame's graph as flat arrays. Owned by the session; they live until its next call of
 * forewalk_frame, forewalk_graph or forewalk_session_destroy. */
typedef struct forewalk_graph_view {
  uint32_t struct_size;
  uint32_t node_count;
  const forewalk_node* nodes; /* nodes[0] is the source */
  uint32_t edge_count;
  uint32_t point_count;
  const forewalk_edge* edges;
  const forewalk_vec3* points;
  float horizon;     /* metres */
  float complete_to; /* all ways are known out to here; less than horizon at a limit */
} forewalk_graph_view;

/* No nodes before the first frame, and where nothing was predicted (always_predict). Costs
 * O(points); a frame whose graph nobody asks for costs nothing here. Allocates only where this
 * frame's graph is larger than all before. */
FOREWALK_API forewalk_status forewalk_graph(forewalk_session* session, forewalk_graph_view* view);

#ifdef __cplusplus
}
#endif

#endif /* FOREWALK_H */
