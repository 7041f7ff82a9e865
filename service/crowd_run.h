// A crowd from its file, walked: places, goals that follow one another, humans, and what came of
// it.
#pragma once

#include <cstdint>
#include <functional>
#include <glm/glm.hpp>
#include <memory>
#include <string>
#include <tl/expected.hpp>
#include <vector>

#include "agents/overlaps.h"
#include "agents/walls.h"
#include "navmesh/error.h"
#include "navmesh/for_each.h"
#include "navmesh/world.h"
#include "service/crowd_config.h"

namespace forewalk::service {

/// One agent at the end of a tick.
struct CrowdSample {
  glm::vec2 plan;  ///< metres
  float height;    ///< metres
  float heading;   ///< radians
  float speed;     ///< m/s, of the last tick's way
};

/// Everybody after every tick, the start first. Agents are numbered in the order of the groups.
struct CrowdRecording {
  double tick = 0.1;                 ///< seconds between two frames
  std::uint32_t agents = 0;          ///< in each frame
  std::vector<CrowdSample> samples;  ///< frame after frame
  std::vector<std::uint32_t> group;  ///< per agent: which of the file's
  std::vector<float> radius;         ///< per agent, metres

  std::size_t frames() const { return agents == 0 ? 0 : samples.size() / agents; }
  const CrowdSample& at(std::size_t frame, std::uint32_t agent) const {
    return samples[frame * agents + agent];
  }
};

/// Density and speed in the measured area at one moment.
struct DensitySample {
  float density;  ///< agents per m^2
  float speed;    ///< mean of theirs, m/s
};

struct CrowdMetrics {
  std::uint32_t agents = 0, humans = 0;
  double seconds = 0.0;            ///< simulated
  std::uint32_t withGoal = 0;      ///< agents with one that can be reached for good
  std::uint32_t arrived = 0;       ///< of those
  std::vector<double> arrivals;    ///< seconds from departure, of those that arrived, ascending
  std::vector<double> efficiency;  ///< shortest way over walked way, a leg each, in (0, 1]
  std::uint64_t collisions = 0;    ///< pairs that came deeper than 1 % of the sum of their radii
  agents::OverlapCount overlaps;   ///< the same, every tick
  std::uint64_t wallsEntered = 0;  ///< agents deeper than 1 cm in a wall, every tick
  double meanSpeed = 0.0;          ///< m/s, of all with a model, all ticks
  std::vector<DensitySample> diagram;
  std::uint64_t hash = 0;  ///< of the last state
};

struct CrowdResult {
  CrowdRecording recording;  ///< empty unless asked for
  CrowdMetrics metrics;
  std::vector<agents::Wall> walls;  ///< at the end, for drawing and for files
};

struct CrowdRun {
  navmesh::ForEach forEach;                                ///< who runs the slices
  std::function<void(std::size_t, std::size_t)> progress;  ///< (ticks done, of all)
  bool record = false;
};

/// Walks the crowd for its seconds, or until everybody with a goal that can be reached for good has
/// arrived. `world` null: an open plane; `walkerRadius`: of who the navmesh was built for, metres.
/// The same result for any forEach.
///
/// Fails when an agent's place or goal is not on the navmesh (kPositionOffNavMesh), there is no
/// room for it after 1000 tries in its area (kSettingOutOfRange), or the recording would exceed 50
/// million samples (kTooLarge). Names the group.
[[nodiscard]] tl::expected<CrowdResult, Error> runCrowd(
    const CrowdConfig& config, const std::shared_ptr<const navmesh::World>& world,
    float walkerRadius, const CrowdRun& run = {});

}  // namespace forewalk::service
