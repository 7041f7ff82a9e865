// Predicts, every frame, where the user may go within a horizon.
//
// DESIGN.md section 3: depth-limited Dijkstra over the navgraph from the user's polygon. The key of a
// polygon is the length of the walk through portal midpoints, up to the midpoint of the portal it is
// entered by: closer to the truth than centroid to centroid, which swings through every polygon's
// middle (bench/prediction_error prints both against exact shortest paths). Whether a polygon is within
// the horizon is decided by its taut path (funnel), never by its key. Ties are broken by polygon id.
#pragma once

#include "prediction/prediction_graph.h"

namespace forewalk::prediction {

/// Sizes fixed at load, so that no frame allocates.
struct PredictionLimits {
  std::uint32_t polygons = 16384;  ///< settled in one graph, >= 1
};

/// What a search remembers from frame to frame: buffers, no results. One per thread of prediction.
/// Tied to the graph it was made for.
class Scratch;

}  // namespace forewalk::prediction
