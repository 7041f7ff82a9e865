// Walks of OpenRDW: waypoints that somebody visits, and recorded walks with their times.
//
// A point a line, `x,y`, metres on the plan (openrdw_text.h). A recording is two files: where
// somebody was (user_virtual_positions.csv), and how long each step took (sampling_intervals.csv),
// a number a line, as many as there are points; the first of them led to the first point and is not
// used, as OpenRDW does not use it.
#pragma once

#include <cstddef>
#include <glm/glm.hpp>
#include <span>
#include <string>
#include <tl/expected.hpp>
#include <vector>

#include "navmesh/error.h"
#include "rdw/walk_file.h"

namespace forewalk::rdw {

/// The points of a path in order; blank lines are skipped. `name` stands for the file in messages.
///
/// Fails (kDataDamaged, naming line and value) where a line is no point or lies farther than 100 km
/// out, and kSceneEmpty where there is none. O(size).
[[nodiscard]] tl::expected<std::vector<glm::dvec2>, Error> parseOpenRdwPath(
    std::span<const std::byte> bytes, const std::string& name);

/// A recorded walk, its first point at 0 s. `pathName` and `timesName` stand for the files.
///
/// Fails as parseOpenRdwPath, and (kDataDamaged, naming file and line) where an interval is not a
/// number above 0 s, there are more or fewer intervals than points, or fewer than two points, and
/// as parseWalks where somebody moves faster than a person or walks for more than a day. O(size).
[[nodiscard]] tl::expected<Walk, Error> parseOpenRdwWalk(std::span<const std::byte> path,
                                                         const std::string& pathName,
                                                         std::span<const std::byte> intervals,
                                                         const std::string& timesName);

}  // namespace forewalk::rdw
