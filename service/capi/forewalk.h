/*
 * forewalk: redirected walking that knows where the user can go next. The C interface.
 *
 * What a VR runtime calls once per frame. C99, no other include than the standard ones.
 *
 *   forewalk_navmesh  where one can walk. Made once from a scene file, from triangles in memory or
 *                     from a .fwmesh; then only read, and shared by any number of sessions on any
 *                     threads.
 *   forewalk_session  one user: tracked space, limits, controller, horizon. Any thread, but one at
 *                     a time: calls on one session must not overlap. Different sessions may run at
 *                     the same time, on one navmesh, too.
 *   forewalk_space    a tracked room that several users share: their sessions keep them apart.
 *   forewalk_world    where one can walk while doors, obstacles and people come and go.
 *
 * Two spaces: physical is the tracking system's (the real room, its floor at height 0), virtual is
 * the scene's. Each frame a session is told the physical head and answers with the virtual one.
 *
 * Units: metres, seconds, radians. Axes by default: right-handed, +Y up, forward -Z (OpenXR, glTF).
 * A session can be made in Unity's or Unreal's convention; then every pose, position, direction and
 * angle that goes in or comes out of that session is in that convention (see forewalk_axes).
 *
 * Errors: every function that can fail returns a forewalk_status. forewalk_last_error() gives the
 * sentence of the calling thread's latest failure. No call throws, aborts or prints. Null pointers
 * are refused with FOREWALK_ERROR_ARGUMENT, unless a function says that null is fine. Using a
 * handle after its release or destruction cannot be detected.
 *
 * Structs carry their own size. Settings: call their _init function with sizeof(the struct), then
 * change what should differ. What a call fills (forewalk_frame_out, forewalk_graph_view): set
 * struct_size = sizeof(the struct). Fields are only ever added at the end. A library that knows
 * more fields than the caller fills or reads only the caller's; one that knows fewer leaves the
 * rest alone. A struct_size that no version has had is refused.
 *
 * Other languages: the C calling convention (cdecl); enumerations and booleans are int32_t (uint8_t
 * in forewalk_node); structs are laid out as C compilers do by themselves (C#:
 * LayoutKind.Sequential, size_t as UIntPtr); text is UTF-8, ended by a zero.
 *
 * Costs are for one core of a desktop computer, and said at each function that is not trivial.
 * forewalk_frame and forewalk_graph allocate nothing, lock nothing and never block. Navmeshes and
 * sessions with a predictive controller take long enough to be made while a level loads.
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

/* Version of the library that is loaded: major << 16 | minor << 8 | patch. Under another major
 * number than FOREWALK_VERSION_MAJOR functions and structs may differ from this header. */
FOREWALK_API uint32_t forewalk_version(void);

/* ---- errors --------------------------------------------------------------------------------- */

typedef int32_t forewalk_status;
enum {
  FOREWALK_OK = 0,
  FOREWALK_ERROR_FILE_UNREADABLE = 1,    /* no such file, no permission */
  FOREWALK_ERROR_FORMAT_UNKNOWN = 2,     /* the ending or the first bytes name no format we read */
  FOREWALK_ERROR_FORMAT_UNSUPPORTED = 3, /* a version or an extension that we do not read */
  FOREWALK_ERROR_DATA_DAMAGED = 4,       /* ends early, index out of range, NaN, bad polygon */
  FOREWALK_ERROR_SCENE_EMPTY = 5,        /* nothing in it that could be walked on */
  FOREWALK_ERROR_SETTING_OUT_OF_RANGE = 6, /* a number in the settings that cannot work */
  FOREWALK_ERROR_NOTHING_WALKABLE = 7,     /* the sentence says which setting closed the scene */
  FOREWALK_ERROR_TOO_LARGE = 8,            /* the sentence says which limit */
  FOREWALK_ERROR_POSITION_OFF_NAVMESH = 9, /* no walkable floor there */
  FOREWALK_ERROR_FILE_UNWRITABLE = 10,     /* no such folder, no permission */
  FOREWALK_ERROR_ARGUMENT = 100,           /* null, an unknown constant, a wrong struct_size */
  FOREWALK_ERROR_OUT_OF_MEMORY = 101,
  FOREWALK_ERROR_INTERNAL = 102 /* a defect of ours; the sentence says what is known */
};

/* The calling thread's latest failure: one sentence, UTF-8, "" if there was none. Read it right
 * after a call that failed: a call that succeeds leaves it as it is. The text lives until the
 * thread's next failing call, or its end; copy it, do not free it. */
FOREWALK_API const char* forewalk_last_error(void);

/* ---- log ------------------------------------------------------------------------------------ */

typedef int32_t forewalk_log_level;
enum {
  FOREWALK_LOG_OFF = 0,
  FOREWALK_LOG_ERROR = 1, /* a call failed: the sentence that forewalk_last_error gives */
  FOREWALK_LOG_WARNING =
      2,                /* a frame met what it had to make up for: lost poses, no floor, limits */
  FOREWALK_LOG_INFO = 3 /* navmeshes and sessions made, resets begun and ended */
};

/* Told what happens, one sentence at a time (UTF-8, without a line's end), on the thread that made
 * the call, from within it; forewalk_frame, too. Must not call forewalk. `message` lives until it
 * returns. There are no poses in it. */
typedef void (*forewalk_log_function)(void* user, forewalk_log_level level, const char* message);

/* For the whole process, in the place of the one before; `function` null or `most`
 * FOREWALK_LOG_OFF: nobody is told, as at first. Messages of levels up to `most` are told. Call it
 * while no other thread is in a call: a call that has begun may still tell the one before.
 * A message costs a microsecond and allocates nothing; what is the same again frame after frame is
 * told once. */
FOREWALK_API void forewalk_set_log(forewalk_log_function function, void* user,
                                   forewalk_log_level most);

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
 * what is called a distance, a length or a horizon is in metres everywhere, and so is everything in
 * forewalk_build_settings. */
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
  int32_t z_up;          /* 0: +Y is up in the scene file; 1: +Z is */
  float metres_per_unit; /* of the scene file, > 0; 0.01 for centimetres */
  float radius;          /* walker, metres, >= 0 */
  float height;          /* walker, metres, > 0 */
  float climb;           /* highest step, metres, >= 0 */
  float slope;           /* steepest ground, radians, [0, pi/2) */
  float
      cell; /* voxel size on the ground, metres, > 0; at half of it a build takes 4 times as long */
  float cell_height; /* voxel height, metres, > 0 */
  float tile;        /* side of a tile, metres; 0: one piece, built by one thread */
  forewalk_partition partition;
} forewalk_build_settings;

/* `struct_size` is sizeof(forewalk_build_settings) of the caller. */
FOREWALK_API void forewalk_build_settings_init(forewalk_build_settings* settings,
                                               uint32_t struct_size); /* null is fine */

/* Builds from a scene file (.obj .off .ply .stl .gltf .glb), or loads a .fwmesh or RecastDemo's
 * tile set (.bin); settings are then not used. `path` is UTF-8. `settings` may be null: defaults.
 * On success *navmesh is the caller's to release, on failure null. Fails as the codes 1 to 8 say.
 *
 * Blocks until it is done: 50 to 100 ms for a scene of 40 m x 25 m, growing with the area and the
 * triangles. Call it from a loading thread, or build ahead of time and ship the .fwmesh, which
 * loads in a few milliseconds. Tiles are built on all cores; the threads end with the call. */
FOREWALK_API forewalk_status forewalk_navmesh_from_file(const char* path,
                                                        const forewalk_build_settings* settings,
                                                        forewalk_navmesh** navmesh);

/* Builds from triangles an engine has in memory: `vertex_count` times x, y, z, and `index_count`
 * indices, three a triangle. The arrays are only read during the call. Vertices are in `axes`, in
 * the places they have in the world (not in an object's own space), and the winding is the one that
 * the engine's own meshes have, seen from outside: counter-clockwise for FOREWALK_AXES_OPENXR and
 * FOREWALK_AXES_UNREAL, clockwise for FOREWALK_AXES_UNITY. z_up is used with FOREWALK_AXES_OPENXR
 * only. metres_per_unit scales what the axes' unit gives: leave it at 1 for Unreal's centimetres.
 * Otherwise as forewalk_navmesh_from_file, cost included. The navmesh can be shared by sessions in
 * other axes. */
FOREWALK_API forewalk_status forewalk_navmesh_from_triangles(
    const float* vertices, size_t vertex_count, const uint32_t* indices, size_t index_count,
    forewalk_axes axes, const forewalk_build_settings* settings, forewalk_navmesh** navmesh);

/* Loads the bytes of a .fwmesh (from forewalk_navmesh_save, or from `forewalk build`). They are
 * only read during the call. Bytes that are damaged or cut off are refused; they may come from
 * anywhere. On success *navmesh is the caller's to release, on failure null. Costs 1 to 5 ms for
 * 400 polygons. */
FOREWALK_API forewalk_status forewalk_navmesh_from_fwmesh(const void* bytes, size_t byte_count,
                                                          forewalk_navmesh** navmesh);

/* The bytes of a .fwmesh of this navmesh. Call with `buffer` null to learn the size; then with a
 * buffer of *byte_count bytes. *byte_count is set to the size in every case; a buffer that is
 * smaller is not written to (FOREWALK_ERROR_ARGUMENT). The bytes do not change while the navmesh
 * lives. Costs a copy of them. */
FOREWALK_API forewalk_status forewalk_navmesh_save(const forewalk_navmesh* navmesh, void* buffer,
                                                   size_t* byte_count);

/* O(1); 0 for null. */
FOREWALK_API uint32_t forewalk_navmesh_polygon_count(const forewalk_navmesh* navmesh);

/* A way out of a polygon into its neighbour. */
typedef struct forewalk_portal {
  uint32_t to;               /* polygon */
  uint32_t edge;             /* it lies on, from this corner of the polygon to the next */
  forewalk_vec3 left, right; /* its ends, as somebody sees them who walks out */
} forewalk_portal;

/* The walkable polygons as flat arrays, to draw and to pick from. A polygon's number is its place
 * here, as in forewalk_node. Its rows are [start[p], start[p + 1]): every _start has polygon_count
 * + 1 entries. Owned by the navmesh; they live as long as it does, and do not change. */
typedef struct forewalk_navmesh_view {
  uint32_t struct_size;
  uint32_t polygon_count;
  const uint32_t* corner_start;
  const forewalk_vec3* corners; /* convex; counter-clockwise seen from above, whatever the axes */
  const uint32_t* portal_start;
  const forewalk_portal* portals; /* in the order of edges; polygons may share more than one */
  /* The surface at its true height (stairs, ramps, uneven ground), three corners a triangle,
   * counter-clockwise seen from above. triangle_start counts triangles. */
  const uint32_t* triangle_start;
  const forewalk_vec3* triangles;
} forewalk_navmesh_view;

/* Set view->struct_size first. Any thread. The first call in each of the axes makes the arrays
 * (some 0.1 ms for 400 polygons), the rest are O(1). Fails only for null pointers, unknown axes and
 * a wrong struct_size. */
FOREWALK_API forewalk_status forewalk_navmesh_polygons(const forewalk_navmesh* navmesh,
                                                       forewalk_axes axes,
                                                       forewalk_navmesh_view* view);

/* One owner more, one less; the last release frees the navmesh. Thread-safe, O(1). Who got a
 * navmesh from one of the functions above is its first owner. Sessions are owners of their own: a
 * navmesh may be released while sessions on it live. */
FOREWALK_API void forewalk_navmesh_retain(forewalk_navmesh* navmesh);  /* null is fine */
FOREWALK_API void forewalk_navmesh_release(forewalk_navmesh* navmesh); /* null is fine */

/* ---- session -------------------------------------------------------------------------------- */

typedef struct forewalk_session forewalk_session;

typedef int32_t forewalk_controller;
enum {
  FOREWALK_CONTROLLER_NONE = 0,           /* no gains; resets all the same */
  FOREWALK_CONTROLLER_S2C = 1,            /* steer-to-center as published */
  FOREWALK_CONTROLLER_S2O = 2,            /* steer-to-orbit as published */
  FOREWALK_CONTROLLER_S2C_PREDICTIVE = 3, /* the same fed by the prediction graph; the default */
  FOREWALK_CONTROLLER_S2O_PREDICTIVE = 4,
  FOREWALK_CONTROLLER_S2MT = 5, /* the rest as rdw/controllers/README.md says */
  FOREWALK_CONTROLLER_S2MT_CENTRE = 6,
  FOREWALK_CONTROLLER_ZIGZAG = 7,
  FOREWALK_CONTROLLER_P2R = 8,
  FOREWALK_CONTROLLER_MESSINGER = 9,
  FOREWALK_CONTROLLER_DYNAMIC_APF = 10,
  FOREWALK_CONTROLLER_HAPTICS = 11,
  FOREWALK_CONTROLLER_ARC = 12,
  FOREWALK_CONTROLLER_VISIBILITY = 13,
  FOREWALK_CONTROLLER_FORESIGHT = 14, /* plans on the prediction graph, as the next two */
  FOREWALK_CONTROLLER_MPCRED = 15,
  FOREWALK_CONTROLLER_FORCE = 16
};

/* How a reset turns the user. */
typedef int32_t forewalk_reset;
enum {
  FOREWALK_RESET_TWO_ONE_TURN = 0,  /* 180 degrees either way, 360 seen; the default */
  FOREWALK_RESET_FREEZE_TURN = 1,   /* 180 degrees either way, nothing seen */
  FOREWALK_RESET_FREEZE_BACKUP = 2, /* steps back, nothing seen */
  FOREWALK_RESET_R2C = 3,           /* to the centre; this and the rest: 360 degrees seen */
  FOREWALK_RESET_MR2C = 4,          /* to the centre, or along what is in the way */
  FOREWALK_RESET_R2G = 5,           /* down the gradient of the room's potential */
  FOREWALK_RESET_SFR2G = 6,         /* five steps down it */
  FOREWALK_RESET_R2FD = 7,          /* to a way as free as the virtual one */
  FOREWALK_RESET_AHEAD = 8          /* to where the likely ways ahead fit the room best */
};

typedef int32_t forewalk_limits;
enum {
  FOREWALK_LIMITS_STEINICKE = 0,  /* detection thresholds of Steinicke et al. 2010; the default */
  FOREWALK_LIMITS_LABORATORY = 1, /* the same with curvature up to 1/7.5 per metre */
  FOREWALK_LIMITS_NETH = 2,       /* the same with curvature up to 1/10 per metre */
  FOREWALK_LIMITS_TOOLKIT = 3,    /* what RDWT and OpenRDW ship: rotation 0.80 to 1.49, 1/7.5 */
  FOREWALK_LIMITS_CUSTOM = 4      /* the numbers in the settings */
};

/* How the prediction graph is made. */
typedef int32_t forewalk_method;
enum {
  FOREWALK_METHOD_POLYGON = 0, /* as published: polygons of the navmesh with more than two
                                  neighbours are branches, their centroids the nodes; the default */
  FOREWALK_METHOD_FRONT = 1    /* real junctions, whatever the polygons: where the front of all
                                  points at one walking distance splits, meets and ends */
};

/* Horizontal point of the tracked room: `right` and `forward` along the axes' directions of these
 * names (OpenXR: x and -z, Unity: x and z, Unreal: y and x). Metres (Unreal: centimetres). */
typedef struct forewalk_point2 {
  float right, forward;
} forewalk_point2;

/* A room that several people share, each with a session of their own: in one virtual world or in
 * several, whatever axes they speak. What one session's frame finds out, where its user is and
 * goes, the others see in their next frame and keep clear of. */
typedef struct forewalk_space forewalk_space;

typedef struct forewalk_space_settings {
  uint32_t struct_size;
  forewalk_axes axes;
  /* As in forewalk_session_settings. */
  const forewalk_point2* border;
  size_t border_count;
  float width, depth;
  const forewalk_point2* hole_points;
  const size_t* hole_sizes;
  size_t hole_count;
  float body_radius; /* how near the middles of two bodies may come, metres, (0, 5]; default 0.5 */
  uint32_t user_limit; /* most sessions at one time, 1 to 64; default 16 */
} forewalk_space_settings;

/* `struct_size` is sizeof(forewalk_space_settings) of the caller. */
FOREWALK_API void forewalk_space_settings_init(forewalk_space_settings* settings,
                                               uint32_t struct_size); /* null is fine */

/* `settings` may be null: defaults. On success *space is the caller's to release, on failure null.
 * Fails as forewalk_session_create does for a tracked space. Costs some microseconds. */
FOREWALK_API forewalk_status forewalk_space_create(const forewalk_space_settings* settings,
                                                   forewalk_space** space);

/* One owner more, one less; the last release frees the space. Thread-safe, O(1). Sessions are
 * owners of their own. */
FOREWALK_API void forewalk_space_retain(forewalk_space* space);  /* null is fine */
FOREWALK_API void forewalk_space_release(forewalk_space* space); /* null is fine */

/* What a heading is taken from by controllers that follow one. */
typedef int32_t forewalk_heading_source;
enum {
  FOREWALK_HEADING_HEAD = 0,   /* where the head looks; the default */
  FOREWALK_HEADING_CHEST = 1,  /* forewalk_session_set_chest; the head where nothing was told */
  FOREWALK_HEADING_WALKING = 2 /* the direction of travel while walking, else the head */
};

typedef struct forewalk_session_settings {
  uint32_t struct_size;
  forewalk_axes axes;
  forewalk_controller controller;
  forewalk_limits limits;
  float horizon; /* metres ahead along the virtual path, (0, 1000]; default 10 */

  /* The tracked space: a simple polygon, either way round, in the tracking system's coordinates.
   * The points are only read while the session is made; 4096 at most, holes included. border_count
   * 0: a rectangle of width (right) by depth (forward) about the origin. */
  const forewalk_point2* border;
  size_t border_count;
  float width, depth; /* metres (Unreal: centimetres), 0.1 m to 10 km; default 0: 4 metres */

  /* Pillars and tables inside the border, `hole_count` of them: hole_sizes[i] points each, one
   * after the other in hole_points. They need a border in points: a rectangle by width and depth
   * takes none. Only read while the session is made; default none. */
  const forewalk_point2* hole_points;
  const size_t* hole_sizes;
  size_t hole_count;

  /* Where the first frame's head is put: above this point of the virtual floor, looking along this
   * heading (radians; 0 is forward; sign as forewalk_axes says). has_start 0: virtual space is
   * physical space at first. */
  int32_t has_start;
  forewalk_vec3 start_floor;
  float start_heading;

  /* For FOREWALK_LIMITS_CUSTOM; not read with the others. Ratios are virtual over physical, with
   * 0 < min <= 1 <= max; curvature_max is in 1/metre, [0, 10], to either side. */
  float translation_min, translation_max;
  float rotation_min, rotation_max;
  float curvature_max;
  float bending_min, bending_max;

  uint32_t polygon_limit; /* most polygons in one prediction, >= 1; default 16384 */
  int32_t resets;         /* 0: never stop the user; default 1 */
  int32_t always_predict; /* 0: only where the controller asks for it, so that forewalk_graph has
                             nothing to show with NONE, S2C and S2O; default 1 */
  uint32_t reserved;      /* 0 */

  forewalk_method method;
  float persistence; /* for FOREWALK_METHOD_FRONT: ways shorter than this are part of the one they
                        leave, so that a niche is no corridor; metres, [0, 100]; default 0.75 */

  forewalk_reset reset;
  uint32_t reserved2; /* 0 */

  int32_t likelihoods; /* 1: names and likelihoods of ways in every frame, for forewalk_graph;
                          default 0: only where the controller asks for them. They cost as much
                          again as a graph by polygons */
  forewalk_heading_source heading_source;

  /* A room that others are in as well, in the place of border, width and holes, which are then not
   * to be given (0). The session takes one of its places until it is destroyed. Default null. */
  forewalk_space* space;
} forewalk_session_settings;

/* `struct_size` is sizeof(forewalk_session_settings) of the caller. */
FOREWALK_API void forewalk_session_settings_init(forewalk_session_settings* settings,
                                                 uint32_t struct_size); /* null is fine */

/* `settings` may be null: defaults. On success *session is the caller's to destroy, on failure
 * null. Fails for settings that cannot work (FOREWALK_ERROR_SETTING_OUT_OF_RANGE, _DATA_DAMAGED or
 * _TOO_LARGE for the tracked space, _ARGUMENT), for a start_floor that is more than 0.5 m
 * beside, above or below every walkable floor (_POSITION_OFF_NAVMESH), and for a space that has no
 * place left (_TOO_LARGE).
 *
 * With a predictive controller this takes 0.05 to 0.15 s: what every place and heading of the
 * tracked space is worth is worked out once, here. Make such sessions while loading, or on another
 * thread; with the other controllers it takes 0.1 ms. A session keeps some 0.6 kB for each polygon
 * of the navmesh, up to polygon_limit. */
FOREWALK_API forewalk_status forewalk_session_create(const forewalk_navmesh* navmesh,
                                                     const forewalk_session_settings* settings,
                                                     forewalk_session** session);
/* Its graph views end with it. Null is fine. */
FOREWALK_API void forewalk_session_destroy(forewalk_session* session);

/* What to tell the user in a reset. */
typedef int32_t forewalk_instruction;
enum {
  FOREWALK_INSTRUCTION_NONE = 0,
  FOREWALK_INSTRUCTION_TURN_AROUND = 1,  /* stop, and turn on the spot, either way */
  FOREWALK_INSTRUCTION_KEEP_TURNING = 2, /* go on turning the same way */
  FOREWALK_INSTRUCTION_WALK_BACK = 3,    /* walk back into the tracked space */
  FOREWALK_INSTRUCTION_STEP_BACK = 4,    /* stop, and step backwards */
  FOREWALK_INSTRUCTION_TURN_LEFT = 5,    /* stop, and turn left on the spot */
  FOREWALK_INSTRUCTION_TURN_RIGHT = 6    /* stop, and turn right on the spot */
};

/* What a reset is at, for an application that draws one. */
typedef int32_t forewalk_reset_phase;
enum {
  FOREWALK_RESET_PHASE_NONE = 0,
  FOREWALK_RESET_PHASE_NEAR = 1,     /* the border is near: a reset is about to be needed */
  FOREWALK_RESET_PHASE_OUTSIDE = 2,  /* outside the tracked space: to walk back in */
  FOREWALK_RESET_PHASE_BACKWARD = 3, /* stopped: reset_back to step backwards */
  FOREWALK_RESET_PHASE_TURN = 4,     /* stopped: to turn by reset_remaining, not begun yet */
  FOREWALK_RESET_PHASE_TURNING = 5   /* the turn is under way */
};

/* Bits of forewalk_frame_out.flags. The first five also mean that no gain was applied. */
enum {
  FOREWALK_FLAG_FIRST_FRAME = 1 << 0,        /* nothing to compare with yet */
  FOREWALK_FLAG_TIME_STOOD_STILL = 1 << 1,   /* the same time again; the step counts in the next */
  FOREWALK_FLAG_TIME_RAN_BACKWARDS = 1 << 2, /* or was not a number; time goes on from here */
  FOREWALK_FLAG_TIME_GAP = 1 << 3,           /* more than 0.5 s since the last frame */
  FOREWALK_FLAG_TRACKING_JUMP = 1 << 4,      /* moved more than 1 m, and the virtual head as far */
  FOREWALK_FLAG_POSE_NOT_FINITE = 1 << 5,    /* the last sound position was taken */
  FOREWALK_FLAG_ORIENTATION_NOT_UNIT = 1 << 6, /* it was normalised */
  FOREWALK_FLAG_ORIENTATION_UNUSABLE = 1 << 7, /* the last sound one was taken */
  FOREWALK_FLAG_OUTSIDE_SPACE = 1 << 8,        /* the head is outside the tracked space */
  FOREWALK_FLAG_BORDER_NEAR = 1 << 9,          /* a reset is about to be needed */
  FOREWALK_FLAG_OFF_NAVMESH = 1 << 10, /* no walkable floor near: the last place was taken */
  FOREWALK_FLAG_SNAPPED = 1 << 11,     /* beside the navmesh: its nearest point was taken */
  FOREWALK_FLAG_GRAPH_LIMIT = 1 << 12, /* raise polygon_limit or shorten the horizon */
  FOREWALK_FLAG_GROUND_TAKEN = 1 << 13 /* the world changed under the user, who stands where no
                                          floor is left and was put on the nearest */
};

typedef struct forewalk_frame_out {
  uint32_t struct_size;
  uint32_t flags;
  forewalk_pose virtual_pose; /* of the head: what to render from */
  float translation;          /* gains as applied: virtual over physical, 1 does nothing */
  float rotation;             /* 2 while resetting */
  float curvature; /* 1/metre whatever the axes' unit; positive as an angle is; 0 does nothing */
  float bending;
  float injected_yaw; /* radians by which the world was turned about the head this frame */
  forewalk_vec3 injected_translation; /* by which the user was pushed this frame, virtual */
  int32_t resetting;                  /* 1 while the user is being turned */
  forewalk_instruction instruction;   /* what to tell the user now */
  float reset_remaining;              /* physical radians to go, >= 0 */
  float reset_turned;    /* physical radians turned since it began; its sign is the way to go on */
  uint32_t reset_count;  /* begun since the session was made */
  uint32_t graph_nodes;  /* of this frame's prediction graph, 0 where there is none */
  float predict_seconds; /* time spent: finding the place and the graph */
  float steer_seconds;   /* and choosing and applying gains */

  forewalk_reset_phase reset_phase;
  float reset_back;              /* metres to step back before the turn, >= 0 */
  forewalk_vec3 reset_direction; /* where the user will face when the turn is done: a horizontal
                                    unit vector of the tracked space; zero while there is no turn.
                                    Draw an arrow there that moves with the room, not the scene */
} forewalk_frame_out;

/* One frame: the tracked head in the tracking system's space (its floor at height 0), and the time
 * of that pose on any clock that does not run backwards, in seconds (a double: a float would lose
 * the milliseconds within hours). Call it once for each rendered frame, at any rate above 2 Hz.
 *
 * An engine that tracks the camera itself moves the camera's parent instead: its new pose is
 * virtual_pose * inverse(head), both as transforms.
 *
 * Odd input is reported in out->flags and leaves the session usable; whatever comes in, what comes
 * out is finite. Fails only for null pointers and a wrong struct_size, and then leaves session and
 * out alone.
 *
 * Costs some 5 microseconds for a horizon of 10 m in an office, more with the polygons within the
 * horizon, whatever the size of the scene. A predictive controller plans ten times a second; these
 * frames take up to 0.15 ms. */
FOREWALK_API forewalk_status forewalk_frame(forewalk_session* session, forewalk_vec3 head_position,
                                            forewalk_quat head_orientation, double seconds,
                                            forewalk_frame_out* out);

/* Puts the user's next frame at another place of the virtual floor (a teleport, a lift), looking
 * along `heading` (radians, as start_heading). `floor` is under the feet. Off the navmesh (more
 * than 0.5 m beside it, above or below) it fails with FOREWALK_ERROR_POSITION_OFF_NAVMESH, for a
 * heading that is not finite with _SETTING_OUT_OF_RANGE, and nothing changes. Nobody moves in the
 * tracked room. Costs a few microseconds. */
FOREWALK_API forewalk_status forewalk_session_teleport(forewalk_session* session,
                                                       forewalk_vec3 floor, float heading);

/* Where the eyes look from the next frame on, a direction of the tracked space of any length:
 * evidence for the likelihoods (forewalk_way). Null, zero, vertical or not finite: not known, as at
 * first. Fails only for a null session. Costs nothing. */
FOREWALK_API forewalk_status forewalk_session_set_gaze(forewalk_session* session,
                                                       const forewalk_vec3* direction);

/* The same for where the chest points, which FOREWALK_HEADING_CHEST steers by. */
FOREWALK_API forewalk_status forewalk_session_set_chest(forewalk_session* session,
                                                        const forewalk_vec3* direction);

/* Records the session's frames in a file from now on (from the second frame on, where there was
 * none yet), in the place of one of that name; `path` null: no more. A line a frame as JSON, which
 * `forewalk replay` walks again to the last bit (service/daemon/PROTOCOL.md); a thread writes it, a
 * kill loses at most 100 ms. It begins as a session that is resumed does: the controller's gains go
 * back to neutral once. What changes the world is noted, and ends what can be walked again, as does
 * a session in a forewalk_world. Where the disk does not keep up for 11 s, recording ends, and the
 * log hears of it. Fails with FOREWALK_ERROR_FILE_UNWRITABLE. Not for within a frame's time budget:
 * ends the recording before, and with it a thread. */
FOREWALK_API forewalk_status forewalk_session_record(forewalk_session* session, const char* path);

/* ---- the prediction graph ------------------------------------------------------------------- */

typedef uint8_t forewalk_node_kind;
enum {
  FOREWALK_NODE_SOURCE = 0,
  FOREWALK_NODE_BRANCH = 1,   /* the ways part */
  FOREWALK_NODE_TERMINAL = 2, /* prediction stops */
  FOREWALK_NODE_JOIN = 3 /* ways come together and go on as one; with `branch` 1 they part again
                            at once (FOREWALK_METHOD_FRONT only) */
};

typedef uint8_t forewalk_terminal_reason;
enum {
  FOREWALK_REASON_NONE = 0,
  FOREWALK_REASON_HORIZON = 1,
  FOREWALK_REASON_DEAD_END = 2,
  FOREWALK_REASON_MEETING = 3 /* another way comes toward this one, and both end; a loop edge of no
                                 length joins the two (FOREWALK_METHOD_FRONT only) */
};

typedef struct forewalk_node {
  forewalk_vec3 position;
  float distance;   /* of the taut path from the source, metres */
  uint32_t prev;    /* the branch node or source before it; of the source: UINT32_MAX */
  uint32_t polygon; /* UINT32_MAX: none, the user is off the navmesh */
  forewalk_node_kind kind;
  forewalk_terminal_reason reason;
  uint8_t branch; /* 1: a branch node (a terminal or a join can be one too) */
  uint8_t reserved;
} forewalk_node;

typedef struct forewalk_edge {
  uint32_t from, to; /* nodes */
  float length;      /* of the taut path between them, metres */
  /* Its points in forewalk_graph_view.points, from `from` to `to`. They lie on the floor, with one
   * wherever the floor bends (stairs). With FOREWALK_METHOD_FRONT only the ends of a path do,
   * heights between are interpolated along it; and the path is that part of the shortest path to
   * `from` which is further from the source than `to`, so it need not end in `to` itself. */
  uint32_t path_start, path_count;
  int32_t loop; /* 0: to its prev; 1: joins neighbours that the tree leaves apart */
} forewalk_edge;

/* The points at one distance from the source where people on a way would cross it. */
typedef struct forewalk_front {
  uint32_t node; /* the terminal whose way it belongs to */
  float length;  /* metres; 0 where the way ends before the horizon */
  /* Its ends, on walls, as high as the floor at the node. Equal where it is closed (all around the
   * user, on an open plane) or a point. */
  forewalk_vec3 from, to;
} forewalk_front;

/* A way from the user to a terminal, under a name that it keeps from frame to frame as long as it
 * is the same way, and how likely it is that the user takes it. */
typedef struct forewalk_way {
  uint32_t id;      /* never used twice by one session */
  uint32_t node;    /* the terminal it leads to */
  float likelihood; /* [0, 1]; all ways' and likelihood_none sum to 1 */
  uint8_t born;     /* 1: new in this frame */
  uint8_t reserved[3];
} forewalk_way;

typedef uint8_t forewalk_way_change;
enum {
  FOREWALK_WAY_BIRTH = 0, /* `way` is new and comes from nowhere known */
  FOREWALK_WAY_DEATH = 1, /* `way` is gone and none took its place */
  FOREWALK_WAY_SPLIT = 2, /* `way` is new; up to now it was one with `other` */
  FOREWALK_WAY_MERGE = 3, /* `way` is gone; from now on it is one with `other` */
  FOREWALK_WAY_RETURN = 4 /* `way` is back that had vanished a moment ago */
};

typedef struct forewalk_way_event {
  uint32_t way;
  uint32_t other; /* UINT32_MAX unless a split or a merge */
  forewalk_way_change change;
  uint8_t reserved[3];
} forewalk_way_event;

/* This frame's graph as flat arrays, in the session's axes. Owned by the session; they live until
 * its next call of forewalk_frame, forewalk_graph or forewalk_session_destroy. Copy them for
 * another thread. */
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

  const forewalk_front*
      fronts;          /* one a terminal, in the order of nodes; none with _METHOD_POLYGON */
  const float* widths; /* one an edge: of the narrower end of its way, metres; 0 with
                          _METHOD_POLYGON, and where a way begins and ends in points */
  uint32_t front_count;
  forewalk_method method; /* that it was made by */

  const forewalk_way* ways; /* one a terminal, in the order of nodes, 512 at most; none where nobody
                               wants likelihoods (forewalk_session_settings) */
  const forewalk_way_event* way_events; /* of this frame alone: ask in every frame to miss none */
  uint32_t way_count;
  uint32_t way_event_count;
  float likelihood_none; /* that the user takes none of the ways */
  uint32_t reserved;
} forewalk_graph_view;

/* The graph that the latest forewalk_frame predicted. No nodes before the first frame, and where
 * nothing was predicted (always_predict); one node, the source, while the user has not been on the
 * navmesh. Costs some 3 microseconds for 40 points, and grows with them; nothing where nobody asks.
 * Allocates nothing once its buffers have room for the largest graph: with FOREWALK_METHOD_POLYGON
 * from the first call on, with FOREWALK_METHOD_FRONT after the first few in a new place. Fails only
 * for null pointers and a wrong struct_size. */
FOREWALK_API forewalk_status forewalk_graph(forewalk_session* session, forewalk_graph_view* view);

/* ---- worlds that move ----------------------------------------------------------------------- */

/* Two ways. A forewalk_world is told what changes, from any thread, rebuilds what it must on a
 * thread of its own, and the sessions made in it take the newest finished version in their next
 * frame, without waiting. Or an application builds navmeshes itself and hands them over. */

/* The three calls below come between frames, on the session's thread, and allocate. They are for
 * sessions on a forewalk_navmesh; those in a forewalk_world are told through it
 * (FOREWALK_ERROR_ARGUMENT here). */

/* A way that is not floor: a lift, a ladder, a teleport. Graphs lead through it: to the entry,
 * `length` metres, and on from the exit. In an edge's path its two ends follow each other. With
 * FOREWALK_METHOD_FRONT it branches off at its entry, and one longer than walking is not taken. */
typedef struct forewalk_link {
  uint32_t id;               /* one of its own */
  forewalk_vec3 entry, exit; /* within 0.5 m of the floor, in the session's axes */
  float length;              /* metres of walking that it counts for, 0 to 10000 */
  int32_t both_ways;         /* 1: the exit is an entry as well */
  int32_t closed;            /* 1: as if it were not there */
} forewalk_link;

/* Puts these links in the place of those before; `count` 0: none. Fails, and changes nothing, with
 * FOREWALK_ERROR_POSITION_OFF_NAVMESH where an end is off the floor, _SETTING_OUT_OF_RANGE for a
 * length or a doubled id, _DATA_DAMAGED for a number that is not finite. Costs O(polygons). */
FOREWALK_API forewalk_status forewalk_session_set_links(forewalk_session* session,
                                                        const forewalk_link* links, size_t count);

/* Somebody who stands somewhere. Polygons that nobody can cross past them are closed, or cost
 * more; in the middle of a room they block none. */
typedef struct forewalk_standing {
  forewalk_vec3 foot; /* in the session's axes */
  float radius; /* of the floor that others cannot use: theirs and the walker's, > 0, metres */
  float cost;   /* 0: closed; else 1 to 1e6 metres for each metre through the polygon */
} forewalk_standing;

/* Says who stands where, all of them, in the place of those before. Fails, and changes nothing,
 * where a number is out of range. Costs O(polygons), 10 to 20 us for an office floor. */
FOREWALK_API forewalk_status forewalk_session_set_standing(forewalk_session* session,
                                                           const forewalk_standing* standing,
                                                           size_t count);

/* Goes on in another navmesh of the same building (a door closed, an obstacle came), where the user
 * stays at the same place of virtual space. Whose floor is no longer there is put on the nearest,
 * and frames say FOREWALK_FLAG_GROUND_TAKEN until they are on the floor again. Links and people
 * standing are found again; a link without floor leads nowhere. Costs O(polygons). */
FOREWALK_API forewalk_status forewalk_session_enter(forewalk_session* session,
                                                    const forewalk_navmesh* navmesh);

typedef struct forewalk_world forewalk_world;

/* A door, or any part of the floor that opens, closes or costs more: a convex outline on the floor,
 * 3 to 64 corners, either way round. */
typedef struct forewalk_door {
  uint32_t id;
  int32_t open; /* 1: as if it were not there */
  const forewalk_vec3* corners;
  size_t corner_count;
  float
      height; /* floor from 0.5 m under the lowest corner to so many metres over it; 0: 2 metres */
  float cost; /* of one that is not open; 0: nobody goes through; else 1 to 1e6 metres for each
                 metre */
} forewalk_door;

typedef int32_t forewalk_shape;
enum {
  FOREWALK_SHAPE_BOX = 0,      /* upright, turned about its vertical axis */
  FOREWALK_SHAPE_CYLINDER = 1, /* upright */
  FOREWALK_SHAPE_PRISM = 2     /* a convex outline drawn up, 3 to 64 corners, either way round */
};

/* Something that takes floor: furniture, a barrier, a robot. One that can be stepped over or passed
 * under takes none; nobody walks on top of one. What a shape does not name is not read. */
typedef struct forewalk_obstacle {
  uint32_t id; /* one of its own */
  forewalk_shape shape;
  forewalk_vec3 position;       /* box: its middle; cylinder: the middle of its lower end */
  forewalk_vec3 half_size;      /* box, along the axes before it is turned, > 0 */
  float heading;                /* box, radians, sign as forewalk_axes says */
  float radius;                 /* cylinder, metres, > 0 */
  float height;                 /* cylinder and prism, metres, > 0 */
  const forewalk_vec3* corners; /* prism: of its lower end, at the height of the lowest */
  size_t corner_count;
} forewalk_obstacle;

typedef struct forewalk_world_settings {
  uint32_t struct_size;
  forewalk_axes axes;                   /* of everything that this world is told */
  const forewalk_build_settings* build; /* null: defaults. With a tile of 0: 6.4 m */
  const forewalk_door* doors; /* that there will be: the floor is cut along their outlines, so that
                                 a door closes what it covers and no more. Default none */
  size_t door_count;
} forewalk_world_settings;

/* `struct_size` is sizeof(forewalk_world_settings) of the caller. */
FOREWALK_API void forewalk_world_settings_init(forewalk_world_settings* settings,
                                               uint32_t struct_size); /* null is fine */

/* Builds as forewalk_navmesh_from_file and forewalk_navmesh_from_triangles do, from a scene (a
 * .fwmesh holds no geometry to build from again: FOREWALK_ERROR_FORMAT_UNSUPPORTED), and starts a
 * thread. `settings` may be null: defaults. On success *world is the caller's to release, on
 * failure null. */
FOREWALK_API forewalk_status forewalk_world_from_file(const char* path,
                                                      const forewalk_world_settings* settings,
                                                      forewalk_world** world);
FOREWALK_API forewalk_status forewalk_world_from_triangles(
    const float* vertices, size_t vertex_count, const uint32_t* indices, size_t index_count,
    const forewalk_world_settings* settings, forewalk_world** world);

/* One owner more, one less; the last release ends its thread, which may take one tile's time.
 * Thread-safe. Sessions are owners of their own. */
FOREWALK_API void forewalk_world_retain(forewalk_world* world);  /* null is fine */
FOREWALK_API void forewalk_world_release(forewalk_world* world); /* null is fine */

/* The calls below may be made on any thread, but not within a frame's time budget: they lock. Each
 * fails, and changes nothing, for numbers that are out of range or not finite. */

/* Obstacles that come, or move to where they are now; those of one call are seen at once. Their
 * tiles are rebuilt off the frame: a moved obstacle is in the graph some 20 ms later. */
FOREWALK_API forewalk_status forewalk_world_set_obstacles(forewalk_world* world,
                                                          const forewalk_obstacle* obstacles,
                                                          size_t count);
/* One that is not there may go, too. */
FOREWALK_API forewalk_status forewalk_world_remove_obstacle(forewalk_world* world, uint32_t id);

/* A door as it is now, in the place of the one with its id. Seen by frames that begin after the
 * call; no tile is rebuilt. */
FOREWALK_API forewalk_status forewalk_world_set_door(forewalk_world* world,
                                                     const forewalk_door* door);

/* A link, in the place of the one with its id; one that is not there may go, too. As
 * forewalk_session_set_links. */
FOREWALK_API forewalk_status forewalk_world_set_link(forewalk_world* world,
                                                     const forewalk_link* link);
FOREWALK_API forewalk_status forewalk_world_remove_link(forewalk_world* world, uint32_t id);

/* Who stands where, all of them, in the place of those before. As forewalk_session_set_standing. */
FOREWALK_API forewalk_status forewalk_world_set_standing(forewalk_world* world,
                                                         const forewalk_standing* standing,
                                                         size_t count);

/* Waits until all changes so far are to be seen. Fails with the reason of the last one that could
 * not be carried out: then the floor is as before it. */
FOREWALK_API forewalk_status forewalk_world_wait(forewalk_world* world);

/* Ascending from 1 with every change that is to be seen; 0 for null. */
FOREWALK_API uint64_t forewalk_world_version(const forewalk_world* world);

/* As forewalk_session_create, in a world that moves. Its frames take the newest version, which
 * costs them one location. forewalk_graph allocates where a version has larger graphs. */
FOREWALK_API forewalk_status forewalk_session_create_in_world(
    forewalk_world* world, const forewalk_session_settings* settings, forewalk_session** session);

#ifdef __cplusplus
}
#endif

#endif /* FOREWALK_H */
