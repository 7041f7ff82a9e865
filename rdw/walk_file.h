// Recorded walks: who was where, when. CSV `walker_id,t,x,z` in virtual metres and seconds.
//
// No head direction is recorded, so the heading is taken from the motion.
#pragma once

#include <cstddef>
#include <glm/glm.hpp>
#include <span>
#include <string>
#include <tl/expected.hpp>
#include <vector>

#include "navmesh/error.h"

namespace forewalk::rdw {

/// Where a walker was at one moment.
struct WalkSample {
  double seconds;   ///< since whenever the recording counts from
  glm::dvec2 plan;  ///< virtual, metres (see navmesh/plan.h)
};

/// One person's recording: at least two samples, times strictly increasing.
struct Walk {
  std::string walker;  ///< its id in the file; empty where the file has no `walker_id` column
  std::vector<WalkSample> samples;
};

/// Whether a file of walks has to say when its walkers were where they were. Where it does not have
/// to and has no column `t`, a walker's rows are in order and count as a second each.
enum class WalkTimes { kRequired, kOptional };

/// Reads every walk of a CSV file, in order of each walker's first row; rows of several walkers may
/// be interleaved. The first line names the columns, in any order: `t`, `x`, `z` (seconds, metres,
/// world axes), and `walker_id` if there are several walkers; other columns are skipped. `name`
/// stands for the file in messages.
///
/// Fails (kDataDamaged, naming line and value) when a column is missing or named twice, a row is
/// short, a number is malformed, NaN, infinite or farther than 100 km out, a walker's time does not
/// increase, a walk lasts more than a day, a walker moves more than 0.5 m at more than 12 m/s, or a
/// walker has one row only; and kSceneEmpty when there is no row. What is said of time and speed
/// holds where there is a column `t`. Costs O(size).
[[nodiscard]] tl::expected<std::vector<Walk>, Error> parseWalks(
    std::span<const std::byte> bytes, const std::string& name,
    WalkTimes times = WalkTimes::kRequired);

/// A walk at a fixed frame rate.
struct WalkFrame {
  glm::dvec2 plan;  ///< virtual, metres
  double heading;   ///< radians, 0 = -Z, counter-clockwise positive, in [-pi, pi]
};

/// The walk at times first + k / rate, linear between samples; the last frame is the last one that
/// is not after the end. The heading of a frame is the direction of the displacement from 0.25 s
/// before to 0.25 s after it where that exceeds 5 cm; while standing it turns evenly, the shorter
/// way, from the last heading to the next. A walk that never moves faces forward (0).
///
/// REQUIRES: two samples or more, times increasing, rate > 0 (1/s). Costs O(samples + frames).
std::vector<WalkFrame> resample(const Walk& walk, double rate);

}  // namespace forewalk::rdw
