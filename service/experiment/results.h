// What came of the runs of an experiment: a row each, and the files that hold them.
//
// rows.jsonl  a line per run in the order in which they finished: what a second start goes on from
// results.csv, results.json  all rows in the order of the plan; the same bytes however they were
// made
// users.csv  a row a user of every run that several walked
// openrdw.csv  the same in the form of OpenRDW's summaries (openrdw_summary.h)
// timing.csv  microseconds a frame, which differ from machine to machine and so are kept apart
// traces/  frames of the first seeds as CSV, and as plans of the room and the building
// manifest.json  the plan, version and the files that were read, with their hashes
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <tl/expected.hpp>
#include <vector>

#include "navmesh/error.h"
#include "rdw/simulation.h"
#include "service/evaluation.h"
#include "service/experiment/openrdw_summary.h"
#include "service/experiment/plan.h"

namespace forewalk::service {

/// The numbers of a row, in the order of the columns.
enum class Metric : std::uint8_t {
  kResets,
  kResetsPer100Metres,
  kMetresBetweenResets,
  kSecondsBetweenResets,
  kResetSeconds,
  kVirtualMetres,
  kPhysicalMetres,
  kSeconds,
  kTranslation,
  kRotation,
  kRotationOffset,
  kCurvature,
  kOverThreshold,
  kBorderMean,
  kBorderLeast,
  kFlipsPer100Metres,
  kViolations,
  kViolationDepth,
  kGraphNodes,
  kRoomArea,
  kWaySamples,
  kWayInGraph,
  kWayJunctions,
  kWayNll,
  kWayFirst,
  kWayRank,
};
inline constexpr std::size_t kMetrics = 26;

/// Of a metric in a run that cannot tell: null in JSON, an empty cell in a CSV.
inline constexpr double kNotMeasured = std::numeric_limits<double>::quiet_NaN();

struct MetricInfo {
  std::string_view column;  ///< in files: "resets_per_100_m"
  std::string_view words;   ///< for people, with the unit: "resets per 100 m"
};
const MetricInfo& infoOf(Metric metric);

/// Microseconds, of the graph alone and of all that a frame does.
enum class Timing : std::uint8_t {
  kGraphMedian,
  kGraphP99,
  kGraphWorst,
  kFrameMedian,
  kFrameP99,
  kFrameWorst
};
inline constexpr std::size_t kTimings = 6;

/// Where the body was: shares of the time in cells of the room's bounding box, row by row from its
/// corner of least x and least y on the plan.
inline constexpr std::size_t kHeatSide = 16;
using HeatMap = std::array<std::uint32_t, kHeatSide * kHeatSide>;  ///< frames

/// One user of a run.
struct UserRow {
  std::string end;  ///< a word of rdw::nameOf(WalkEnd)
  std::uint64_t traceHash = 0;
  std::array<double, kMetrics> values{};
  OpenRdwValues openRdw{};

  double operator[](Metric metric) const { return values[static_cast<std::size_t>(metric)]; }
  bool sameAs(const UserRow& other) const;  ///< to the bit; NaN is like NaN
};

struct Row {
  std::size_t run = 0;
  std::string end;                        ///< that of the users, "stuck" if one was; or "failed"
  std::string reason;                     ///< why it failed; else empty
  std::uint64_t traceHash = 0;            ///< of all users
  std::array<double, kMetrics> values{};  ///< of all users together, see together()
  std::array<double, kTimings> times{};   ///< 0 where nothing was timed
  HeatMap heat{};                         ///< of all users
  std::vector<UserRow> users{};           ///< at least one, unless it failed

  bool failed() const { return end == "failed"; }
  double operator[](Metric metric) const { return values[static_cast<std::size_t>(metric)]; }

  /// But for times, which differ from one run to the next.
  bool sameAs(const Row& other) const;
};

/// How well the ways of a walk were foreseen, by the definitions of `forewalk evaluate`: of the
/// moments whose outcome is known (kWaySamples), the share whose way was in the graph
/// (kWayInGraph); and where there was a choice (kWayJunctions), the mean negative log-likelihood of
/// the way taken, the share in which it was the likeliest, and its mean rank. Nothing is measured
/// without samples.
void setQuality(const PredictionQuality& quality, UserRow& user);

/// Measures the walks of a run's users, simulated with `keepFrames`; `spaces` are their rooms. Over
/// threshold is the share of the time outside of resets with a gain at work that people notice
/// (Steinicke et al. 2010: preset `steinicke`): translation and curvature while walking, rotation
/// while turning. A flip is a curvature gain of another sign than the last. O(frames).
Row rowOf(std::size_t run, std::span<const rdw::SimulationResult> results,
          std::span<const rdw::TrackedSpace* const> spaces);

/// Fills in what a run's users have together: counts, distances and time in resets are sums, and
/// what is per 100 m or between resets follows from these; extremes are those of all; scores of
/// ways are weighed by their samples; all other values are means over the users.
void together(Row& row);

/// A line of rows.jsonl, ended by LF, and back. `where` stands for the line in messages.
/// Fails (kDataDamaged) when it is no such line.
std::string lineOf(const Row& row);
[[nodiscard]] tl::expected<Row, Error> parseRow(std::string_view line, const std::string& where);

/// A file that an experiment read.
struct InputFile {
  std::string name;  ///< as the plan names it, beside the plan
  std::uint64_t hash = 0;
};

/// A room of the plan: its border and its obstacles, as TrackedSpace::ring gives them.
struct RoomOutline {
  std::string name;
  std::vector<std::vector<glm::dvec2>> rings;
};

/// What the rows in a folder belong to.
struct Manifest {
  std::string version;  ///< of forewalk
  std::string plan;     ///< its text
  std::vector<InputFile> inputs;
  std::vector<RoomOutline> rooms;  ///< as many as the plan has, for drawings
  std::size_t runs = 0;
  std::size_t shard = 1, shards = 1;       ///< runs r with r % shards == shard - 1
  bool operator==(const Manifest&) const;  ///< the same experiment, whichever shard
};
std::string manifestJson(const Manifest& manifest);
/// `name` stands for the file in messages. Fails when it is no such file (kDataDamaged,
/// kFormatUnsupported).
[[nodiscard]] tl::expected<Manifest, Error> parseManifest(std::string_view text,
                                                          const std::string& name);
/// That of a folder. Fails as readFile and parseManifest do.
[[nodiscard]] tl::expected<Manifest, Error> readManifest(const std::filesystem::path& folder);

/// The rows that a folder holds, in the order of runs. A last line without its end was cut off by a
/// kill: it is left out, and `soundBytes` says how long the file is without it.
///
/// Fails when a line is damaged (kDataDamaged, with its number), or a run is there twice with
/// different results. An absent file holds no rows.
struct RowLog {
  std::vector<Row> rows;
  std::uintmax_t soundBytes = 0;
};
[[nodiscard]] tl::expected<RowLog, Error> readRows(const std::filesystem::path& folder);

/// A folder of finished results, as `report` reads it.
struct Results {
  Manifest manifest;
  ExperimentPlan plan;
  std::vector<Row> rows;  ///< in the order of runs
};
/// Fails as readManifest, readRows and parseExperiment do.
[[nodiscard]] tl::expected<Results, Error> readResults(const std::filesystem::path& folder);

/// The tables, of rows in the order of runs.
std::string resultsCsv(const ExperimentPlan& plan, std::span<const Row> rows);
std::string resultsJson(const ExperimentPlan& plan, std::span<const Row> rows);
std::string timingCsv(std::span<const Row> rows);
std::string usersCsv(const ExperimentPlan& plan, std::span<const Row> rows);

/// What the files of a run's trace below traces/ are called, without their endings: its number, in
/// as many digits as the largest has.
/// Users after the first of a run have their number after it: 07, 07-2, 07-3.
std::string traceStem(const ExperimentPlan& plan, std::size_t run, std::size_t user = 0);

/// Writes all tables; users.csv only where several users walked together. Fails as writeFile.
[[nodiscard]] tl::expected<void, Error> writeTables(const std::filesystem::path& folder,
                                                    const ExperimentPlan& plan,
                                                    std::span<const Row> rows);

}  // namespace forewalk::service
