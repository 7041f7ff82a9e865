#include "service/crowd_run.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "service/crowd_walk.h"

namespace forewalk::service {
namespace {

constexpr std::size_t kMostSamples = 50'000'000;

// Density and speed in the measured area.
void measure(const CrowdConfig& config, const CrowdWalk& walk, CrowdMetrics& metrics) {
  if (!config.measure) return;
  const agents::AgentsView view = walk.crowd().view();
  std::uint32_t inside = 0;
  double speed = 0.0;
  for (const CrowdWalk::Member& member : walk.members()) {
    if (!config.measure->contains(view.position[walk.crowd().indexOf(member.id)])) continue;
    ++inside;
    speed += member.speed;
  }
  if (inside == 0) return;
  metrics.diagram.push_back(
      {static_cast<float>(inside) / config.measure->size(), static_cast<float>(speed / inside)});
}

void record(const CrowdWalk& walk, CrowdRecording& recording) {
  const agents::AgentsView view = walk.crowd().view();
  for (const CrowdWalk::Member& member : walk.members()) {
    const std::uint32_t i = walk.crowd().indexOf(member.id);
    recording.samples.push_back(
        {view.position[i], view.height[i], view.heading[i], static_cast<float>(member.speed)});
  }
}

void walkAll(const CrowdConfig& config, CrowdWalk& walk, const CrowdRun& run, CrowdResult& result) {
  CrowdMetrics& metrics = result.metrics;
  CrowdRecording& recording = result.recording;
  recording.tick = config.tick;
  recording.agents = metrics.agents = static_cast<std::uint32_t>(walk.members().size());
  for (const CrowdWalk::Member& member : walk.members()) {
    recording.group.push_back(member.group);
    recording.radius.push_back(member.radius);
    metrics.humans += config.groups[member.group].human;
    metrics.withGoal += walk.hasFinalGoal(member);
  }
  const auto ticks = static_cast<std::size_t>(std::ceil(config.seconds / config.tick - 1e-6));
  if (run.record) record(walk, recording);
  agents::OverlapCounter overlaps;
  agents::CollisionCounter collisions;
  double speeds = 0.0, walkers = 0.0;
  std::size_t tick = 0;
  while (tick < ticks && (metrics.withGoal == 0 || walk.arrivals().size() < metrics.withGoal)) {
    walk.tick(run.forEach);
    ++tick;
    const agents::AgentsView view = walk.crowd().view();
    metrics.overlaps += overlaps.count(view);
    metrics.collisions += collisions.count(view);
    metrics.wallsEntered += agents::countWallsEntered(view, walk.crowd().walls(), 0.01f);
    measure(config, walk, metrics);
    for (const CrowdWalk::Member& member : walk.members()) {
      if (config.groups[member.group].human) continue;
      speeds += member.speed;
      walkers += 1.0;
    }
    if (run.record) record(walk, recording);
    if (run.progress) run.progress(tick, ticks);
  }
  metrics.seconds = walk.seconds();
  metrics.arrivals = walk.arrivals();
  metrics.efficiency = walk.efficiency();
  metrics.arrived = static_cast<std::uint32_t>(metrics.arrivals.size());
  std::sort(metrics.arrivals.begin(), metrics.arrivals.end());
  metrics.meanSpeed = walkers > 0.0 ? speeds / walkers : 0.0;
  metrics.hash = walk.crowd().hash();
  const auto walls = walk.crowd().walls();
  result.walls.assign(walls.begin(), walls.end());
}

}  // namespace

tl::expected<CrowdResult, Error> runCrowd(const CrowdConfig& config,
                                          const std::shared_ptr<const navmesh::World>& world,
                                          float walkerRadius, const CrowdRun& run) {
  double samples = config.seconds / config.tick + 1.0, agents = 0.0;
  for (const CrowdGroup& group : config.groups) agents += group.count;
  samples *= agents;
  if (run.record && samples > static_cast<double>(kMostSamples)) {
    return tl::unexpected(
        Error{ErrorCode::kTooLarge,
              fmt::format(
                  "{} agents for {:g} s every {:g} s would be {:.0f} million recorded places, more "
                  "than {}; write metrics only, or make seconds smaller or tick_s larger.",
                  agents, config.seconds, config.tick, samples / 1e6, kMostSamples / 1000000)});
  }
  CrowdWalk walk(config, world, walkerRadius);
  if (auto populated = walk.populate(); !populated) return tl::unexpected(populated.error());
  CrowdResult result;
  walkAll(config, walk, run, result);
  return result;
}

}  // namespace forewalk::service
