// What happened in a simulated walk: a row per frame, and the sums of a whole walk.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "rdw/company.h"
#include "rdw/gains.h"
#include "rdw/session.h"

namespace forewalk::rdw {

/// One frame. Positions are those of the head on the plan, metres; headings those of the head,
/// radians, in (-pi, pi]. The virtual ones are after this frame's gains.
struct FrameRecord {
  double t = 0.0;  ///< seconds since the first frame
  glm::dvec2 virtualPosition{0.0};
  double virtualHeading = 0.0;
  glm::dvec2 physicalPosition{0.0};
  double physicalHeading = 0.0;
  Gains gains;
  double injectedYaw = 0.0;          ///< radians by which this frame turned the world
  bool reset = false;                ///< a reset is under way
  std::uint32_t graphNodes = 0;      ///< of this frame's prediction graph; 0 without one
  double predictMicroseconds = 0.0;  ///< 0 without a clock
  double steerMicroseconds = 0.0;    ///< 0 without a clock
  double borderDistance =
      0.0;  ///< to the nearest border of the tracked space, negative outside, metres
  double frameMicroseconds = 0.0;        ///< locate, predict, steer and apply; 0 without a clock
  std::optional<CompanyRecord> company;  ///< none: nobody else is there
};

/// The trace's columns, in order: those of DESIGN.md section 5, then border_distance and frame_us.
std::string_view traceHeader();

/// The CSV: header, a row per frame, x and z in world axes, every line ended by LF. Walks in
/// company have more columns: agent_clearance (empty where nobody is there), agent_collisions and
/// blocked_polygons. O(frames).
std::string traceCsv(std::span<const FrameRecord> frames);

/// A hash of all rows that is fed row by row: equal walks, equal hash, on one build and across
/// Debug and Release. Times spent are left out, whatever the clock said.
class TraceHash {
 public:
  void add(const FrameRecord& frame);
  std::uint64_t value() const { return hash_; }

 private:
  std::uint64_t hash_ = 14695981039346656037u;  // FNV-1a
};

/// Why a walk ended.
enum class WalkEnd : std::uint8_t {
  kMetres,       ///< walked as far as asked
  kSeconds,      ///< as long as asked
  kFinished,     ///< the last waypoint or the end of the recording
  kStuck,        ///< wanted to walk, but came no further for 50 s
  kInterrupted,  ///< by the caller (SimulationRun::interrupted)
};

/// A word for each: "metres", "seconds", "finished", "stuck", "interrupted".
std::string_view nameOf(WalkEnd end);

/// Median, 99th percentile and worst of a set of times, microseconds. Nearest rank.
struct Quantiles {
  double median = 0.0;
  double p99 = 0.0;
  double worst = 0.0;
};

/// Of `values`, which are reordered. All 0 for none. O(n).
Quantiles quantilesOf(std::vector<double>& values);

/// A walk in numbers. Metres are those of the body on the plan: a head's bob and sway do not count.
struct Summary {
  std::string controller;
  GainLimits limits;
  double horizon = 0.0;  ///< metres
  double rate = 0.0;     ///< frames per second
  std::uint64_t seed = 0;
  double spaceArea = 0.0;    ///< tracked floor, m^2
  double virtualArea = 0.0;  ///< walkable floor of all components, m^2; 0 on an open plane

  std::uint64_t frames = 0;
  double seconds = 0.0;
  double virtualMetres = 0.0;
  double physicalMetres = 0.0;
  WalkEnd end = WalkEnd::kSeconds;

  std::uint64_t resets = 0;
  double resetSeconds = 0.0;  ///< spent in resets

  double meanTranslation = 1.0;  ///< over frames without reset, weighted by physical metres
  double meanRotation = 1.0;  ///< the same, weighted by physical radians, while the head turns at
                              ///< more than 20 degrees per second
  double meanRotationOffset = 0.0;  ///< mean |rotation - 1|, weighted the same
  double meanCurvature = 0.0;       ///< mean |curvature|, weighted by physical metres, 1/m

  std::uint64_t violations = 0;       ///< times the head left the tracked space
  std::uint64_t violationFrames = 0;  ///< frames it was outside
  double violationMetres = 0.0;       ///< physical metres walked there
  double violationDepth = 0.0;        ///< farthest outside, metres

  double meanGraphNodes = 0.0;  ///< over frames with a graph
  bool timed = false;           ///< whether a clock was given
  Quantiles graphMicroseconds;  ///< over frames with a graph
  Quantiles frameMicroseconds;  ///< locate, predict, steer and apply, over all frames
  std::uint64_t traceHash = 0;
  std::optional<CompanySummary> company;  ///< none: nobody else was there

  double resetsPer100Metres() const;  ///< virtual metres; 0 where nobody walked
  double metresBetweenResets()
      const;  ///< virtual metres per reset; all of them where there was none
};

/// `forewalk.summary/1`, indented, ending in LF. Times are null without a clock, so that equal
/// walks have equal summaries.
std::string summaryJson(const Summary& summary);

}  // namespace forewalk::rdw
