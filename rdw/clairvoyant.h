// The ceiling: how few resets would do for somebody whose whole walk is known in advance.
//
// Not for use; it is what controllers are measured against. A beam search (Lowerre 1976) walks the
// virtual path piece by piece; each state is a pose in the room with the resets so far, each piece
// is walked under curvature to either side or none and the translation gain at its upper end or
// none, each corner is turned under one of five rotation gains, and where the floor ends a reset
// turns the body to any of the headings. Of states in one cell of place and heading the best is
// kept, and of cells the `width` best by resets so far plus what the pose is worth (room_value.h).
//
// It is generous where it has to choose: users stop at once, resets cost no way, corners of any
// angle are scaled. So wide beams find at most what a controller under the same limits needs; the
// width is finite, though, and the bound is as good as the search.
#pragma once

#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "rdw/gains.h"
#include "rdw/pose.h"
#include "rdw/tracked_space.h"

namespace forewalk::rdw {

struct ClairvoyantSettings {
  int width = 1000;         ///< states kept from piece to piece, >= 1
  double step = 0.25;       ///< longest piece, virtual metres, > 0
  double clearance = 0.2;   ///< free floor ahead at which a reset is due, metres, >= 0
  int headings = 36;        ///< that a reset turns to, and of the cells, >= 4
  double cell = 0.2;        ///< of places, metres, > 0
  bool translation = true;  ///< walking may be scaled
};

struct ClairvoyantWalk {
  double metres = 0.0;         ///< of the path
  std::vector<double> resets;  ///< metres along the path at which they fall, ascending
};

/// The fewest resets found for somebody at `start` (physical; position in the free floor) who walks
/// `path`: virtual plan points, at least one, equal neighbours allowed, first seen along
/// `facing` (virtual, radians). The same result on every machine. O(length / step * width * (log
/// width + corners of the space)); some seconds for 200 m.
ClairvoyantWalk clairvoyant(std::span<const glm::dvec2> path, double facing,
                            const PlanarPose& start, const TrackedSpace& space,
                            const GainLimits& limits, const ClairvoyantSettings& settings = {});

}  // namespace forewalk::rdw
