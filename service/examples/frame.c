/*
 * The hello world of forewalk's C interface: a navmesh, a session, and a few hundred frames.
 *
 *   frame                         walks around a pillar in a hall, made of triangles in memory
 *   frame SCENE x y z heading     walks in a scene file from a point of its floor (metres) and a
 *                                 heading (radians, 0 is -Z, left positive)
 *
 * Prints where the user is in the virtual world, ten times a second, and a hash of all frames.
 * Outside this project: cc -std=c99 frame.c -lforewalk -lm
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "forewalk.h"

enum { kFrames = 900, kRate = 90 };

static const float kEyeHeight = 1.7f; /* metres */
static const double kSpeed = 1.1;     /* of walking, metres per second */
static const double kTurnRate = 1.5;  /* on the spot, radians per second */

/* A hall of 16 m x 16 m and a pillar of 4 m x 4 m in its middle. */
static const float kVertices[] = {
    -8, 0, 8,  8, 0, 8,  8, 0, -8,  -8, 0, -8,                     /* floor */
    -2, 0, 2,  2, 0, 2,  2, 0, -2,  -2, 0, -2,                     /* foot of the pillar */
    -2, 3, 2,  2, 3, 2,  2, 3, -2,  -2, 3, -2,                     /* its head */
};
static const uint32_t kIndices[] = {
    0, 1, 2,  0, 2, 3,                                             /* floor */
    4, 5, 9,  4, 9, 8,  5, 6, 10,  5, 10, 9,                       /* sides of the pillar */
    6, 7, 11,  6, 11, 10,  7, 4, 8,  7, 8, 11,
};

/* Body and time of a made-up user, in the tracked room. */
typedef struct user {
  double x, z, heading;
} user;

/* Walks on in a wavy line; in a reset stands and turns left. */
static void step(user *user, int frame, int resetting) {
  const double dt = 1.0 / kRate;
  if (resetting) {
    user->heading += kTurnRate * dt;
  } else {
    user->heading += 0.4 * cos(0.02 * frame) * dt;
    user->x -= kSpeed * dt * sin(user->heading);
    user->z -= kSpeed * dt * cos(user->heading);
  }
}

/* FNV-1a. */
static void hash_bytes(uint64_t *hash, const void *bytes, size_t count) {
  const unsigned char *at = (const unsigned char *)bytes;
  size_t i;
  for (i = 0; i < count; ++i) *hash = (*hash ^ at[i]) * UINT64_C(0x100000001b3);
}

static int refused(const char *what) {
  fprintf(stderr, "%s: %s\n", what, forewalk_last_error());
  return 1;
}

int main(int argc, char **argv) {
  const int from_file = argc == 6;
  forewalk_navmesh *navmesh = NULL;
  forewalk_session *session = NULL;
  forewalk_session_settings settings;
  forewalk_frame_out out;
  user body = {0.0, 0.0, 0.0};
  uint64_t hash = UINT64_C(0xcbf29ce484222325);
  int frame;

  if (argc != 1 && !from_file) {
    fprintf(stderr, "usage: %s [SCENE x y z heading]\n", argv[0]);
    return 2;
  }

  /* Where one can walk: once, when the level is loaded. */
  if (from_file ? forewalk_navmesh_from_file(argv[1], NULL, &navmesh)
                : forewalk_navmesh_from_triangles(
                      kVertices, sizeof kVertices / sizeof kVertices[0] / 3, kIndices,
                      sizeof kIndices / sizeof kIndices[0], FOREWALK_AXES_OPENXR, NULL, &navmesh)) {
    return refused("navmesh");
  }

  /* Who walks: once per user. */
  forewalk_session_settings_init(&settings, sizeof settings);
  settings.controller = FOREWALK_CONTROLLER_S2C_PREDICTIVE;
  settings.limits = FOREWALK_LIMITS_LABORATORY;
  settings.width = 5.0f;
  settings.depth = 5.0f;
  settings.has_start = 1;
  settings.start_floor.x = from_file ? (float)atof(argv[2]) : -5.0f;
  settings.start_floor.y = from_file ? (float)atof(argv[3]) : 0.0f;
  settings.start_floor.z = from_file ? (float)atof(argv[4]) : 7.0f;
  settings.start_heading = from_file ? (float)atof(argv[5]) : 0.0f;
  if (forewalk_session_create(navmesh, &settings, &session)) return refused("session");
  forewalk_navmesh_release(navmesh); /* the session keeps what it needs */

  /* Every frame: the tracked head goes in, the pose to render from comes out. */
  out.struct_size = sizeof out;
  out.resetting = 0;
  for (frame = 0; frame < kFrames; ++frame) {
    forewalk_vec3 head;
    forewalk_quat orientation = {0.0f, 0.0f, 0.0f, 1.0f};
    if (frame > 0) step(&body, frame, out.resetting);
    head.x = (float)body.x;
    head.y = kEyeHeight;
    head.z = (float)body.z;
    orientation.y = (float)sin(0.5 * body.heading);
    orientation.w = (float)cos(0.5 * body.heading);
    if (forewalk_frame(session, head, orientation, (double)frame / kRate, &out)) {
      return refused("frame");
    }
    hash_bytes(&hash, &out.virtual_pose, sizeof out.virtual_pose);
    hash_bytes(&hash, &out.flags, sizeof out.flags);
    if (frame % 9 == 0) {
      printf("%.9g %.9g %.9g  %.9g %.9g %.9g %.9g  curvature %.9g, %u nodes ahead%s\n",
             (double)out.virtual_pose.position.x, (double)out.virtual_pose.position.y,
             (double)out.virtual_pose.position.z, (double)out.virtual_pose.orientation.x,
             (double)out.virtual_pose.orientation.y, (double)out.virtual_pose.orientation.z,
             (double)out.virtual_pose.orientation.w, (double)out.curvature,
             (unsigned)out.graph_nodes, out.resetting ? ", turning around" : "");
    }
  }
  printf("%d frames, %u resets, hash %016llx\n", kFrames, (unsigned)out.reset_count,
         (unsigned long long)hash);

  forewalk_session_destroy(session);
  return 0;
}
