// How well a simulated walk's ways were foreseen: the walk as a recording, judged as `forewalk
// evaluate` judges recordings.
#pragma once

#include "navmesh/world.h"
#include "rdw/simulation.h"
#include "service/evaluation.h"

namespace forewalk::service {

/// Whether anybody in this walk looks at predictions: its controller or its reset.
bool looksAhead(const rdw::SimulationConfig& config);

/// The virtual way of a walk's frames, time spent in resets cut out, seen 15 times a second by the
/// method, horizon and likelihood of its session; a moment every half second, a quarter of a metre
/// apart at least. All 0 where the walk was too short to say.
///
/// REQUIRES: `result` holds its frames. Costs a prediction a frame, and an exact distance field a
/// moment: a few tenths of what the walk itself costs.
PredictionQuality qualityOf(const navmesh::World& world, const rdw::SimulationConfig& config,
                            const rdw::SimulationResult& result);

}  // namespace forewalk::service
