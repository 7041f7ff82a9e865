#include "service/experiment/run_quality.h"

#include "rdw/controller.h"
#include "rdw/reset_policy.h"
#include "service/recording.h"

namespace forewalk::service {
namespace {

constexpr double kRate = 15.0;     // frames per second
constexpr double kEvery = 0.5;     // seconds between moments
constexpr double kSpacing = 0.25;  // metres between their places

}  // namespace

bool looksAhead(const rdw::SimulationConfig& config) {
  const auto controller = rdw::makeController(config.session.controller);
  const auto reset = rdw::makeReset(config.session.resetPolicy);
  return (controller && (*controller)->wantsPrediction()) || (reset && (*reset)->wantsPrediction());
}

PredictionQuality qualityOf(const navmesh::World& world, const rdw::SimulationConfig& config,
                            const rdw::SimulationResult& result) {
  rdw::Walk walk;
  double cut = 0.0;
  for (std::size_t i = 0; i < result.frames.size(); ++i) {
    const rdw::FrameRecord& frame = result.frames[i];
    if (frame.reset) {
      if (i > 0) cut += frame.t - result.frames[i - 1].t;
      continue;
    }
    walk.samples.push_back({frame.t - cut, frame.virtualPosition});
  }
  if (walk.samples.size() < 2) return {};
  RecordingSettings settings;
  settings.horizon = config.session.horizon;
  settings.rate = kRate;
  settings.sampleEvery = kEvery;
  settings.spacing = kSpacing;
  settings.height = result.startHeight;
  const RecordedWalk recorded = record(world, walk, factoryOf(config.session.method), settings);
  return qualityOf(recorded, config.session.likelihood);
}

}  // namespace forewalk::service
