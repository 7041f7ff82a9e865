// What a frame has to say besides its result. A frame never fails; it reports (DESIGN.md section
// 2).
#pragma once

#include <cstdint>

namespace forewalk::rdw {

enum FrameFlags : std::uint32_t {
  kFrameSound = 0,
  kFirstFrame = 1u << 0,          ///< nothing to compare with yet: no motion
  kTimeStoodStill = 1u << 1,      ///< same time stamp again: no motion; it counts in the next frame
  kTimeRanBackwards = 1u << 2,    ///< or is not a number: no motion; time starts again from here
  kTimeGap = 1u << 3,             ///< longer than MotionSettings::longestFrame: no motion
  kTrackingJump = 1u << 4,        ///< moved more than MotionSettings::jumpDistance: no motion
  kPoseNotFinite = 1u << 5,       ///< position unusable: the last one was taken
  kOrientationNotUnit = 1u << 6,  ///< was normalised
  kOrientationUnusable = 1u << 7,  ///< the last one was taken
  kOutsideSpace = 1u << 8,         ///< the body is outside the tracked space
  kBorderNear = 1u << 9,           ///< a reset is about to be needed
  kOffNavMesh = 1u << 10,   ///< no polygon within SessionSettings::snap; the last place is kept
  kSnapped = 1u << 11,      ///< beside the navmesh: its nearest point was taken
  kGraphLimit = 1u << 12,   ///< raise PredictionLimits::polygons or shorten the horizon
  kGroundTaken = 1u << 13,  ///< the world changed under the user, who now stands in an obstacle or
                            ///< closer to it than they can: the nearest walkable ground was taken
};

}  // namespace forewalk::rdw
