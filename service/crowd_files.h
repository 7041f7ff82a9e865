// A walked crowd as files: trajectories as CSV and as JuPedSim's SQLite, metrics as JSON, the
// fundamental diagram as a plot.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <tl/expected.hpp>

#include "agents/walls.h"
#include "navmesh/error.h"
#include "service/crowd_run.h"

namespace forewalk::service {

/// CSV `walker_id,t,x,z,y,heading,group`, a row per agent and frame: seconds, metres in world axes,
/// radians. rdw/walk_file.h reads it, and so do the verbs that take walks.
std::string trajectoriesCsv(const CrowdRecording& recording, const CrowdConfig& config);

/// Writes version 2 of the trajectory database of JuPedSim (jupedsim.org), which its viewers and
/// PedPy open: tables trajectory_data(frame, id, pos_x, pos_y, ori_x, ori_y), metadata(key, value)
/// with version, fps and the bounds, geometry(hash, wkt) with walkableArea(), and
/// frame_data(frame, geometry_hash). pos_y is -z. Replaces the file.
/// Fails when it cannot be written (kFileUnwritable, with SQLite's reason).
[[nodiscard]] tl::expected<void, Error> writeTrajectoryDatabase(
    const std::filesystem::path& file, const CrowdRecording& recording,
    std::span<const agents::Wall> walls);

/// The walkable area as well-known text: closed rows of walls that have free ground inside, less
/// those that have it outside and circles; where there is no outline, the rectangle 2 m around all
/// places. A POLYGON, or a MULTIPOLYGON where outlines lie apart. Thin walls have no area and are
/// not in it; things that move neither.
std::string walkableArea(std::span<const agents::Wall> walls, const CrowdRecording& recording);

/// `forewalk.crowd_metrics/1`: counts, arrival times, path efficiency, least distance, density and
/// speed in steps of density, and the hash of the last state.
std::string metricsJson(const CrowdMetrics& metrics);

/// One step of the fundamental diagram.
struct DiagramRow {
  double density;  ///< agents per m^2, mean
  double speed;    ///< m/s, mean
  double flow;     ///< density * speed, 1/(m s)
  std::size_t samples;
};

/// Means over moments whose density is alike, in steps of 0.25 per m^2, ascending.
std::vector<DiagramRow> fundamentalDiagram(std::span<const DensitySample> samples);

/// Speed and flow over density, as SVG.
std::string diagramPlot(std::span<const DiagramRow> rows, const std::string& subtitle);

}  // namespace forewalk::service
