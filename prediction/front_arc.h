// The shape of a front, from what a graph tells of it: its two ends and the point in its middle.
//
// A front at the horizon is made of arcs about the user and about corners that hide ground from
// them; most of it is one arc. So it is taken for the arc of a circle through the three points,
// which bulges where the straight line between its ends would cut far behind it.
#pragma once

#include <array>
#include <glm/glm.hpp>
#include <span>

#include "prediction/prediction_graph.h"

namespace forewalk::prediction {

/// A front as a polyline: its ends first and last, `middle` in between. Plan, metres.
inline constexpr int kFrontPoints = 9;
using FrontLine = std::array<glm::vec2, kFrontPoints>;

/// The front of `graph.terminals[order]`: all points the terminal's own where the graph knows no
/// fronts, or the way ends in a point. O(1).
FrontLine frontLine(const PredictionGraph& graph, std::size_t order);

/// The shortest distance from `point` to a polyline of one point or more, metres. O(points).
float distanceToLine(glm::vec2 point, std::span<const glm::vec2> line);

}  // namespace forewalk::prediction
