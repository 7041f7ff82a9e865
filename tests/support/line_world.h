// Prediction graphs for tests of what comes after them: ways given as polylines, and a corridor
// that ends in a T, walked along its middle.
#pragma once

#include <algorithm>
#include <glm/glm.hpp>
#include <vector>

#include "prediction/prediction_graph.h"

namespace forewalk::testing {

/// A way from the source: its corners after the source, the end last.
struct LineWay {
  std::vector<glm::vec2> points;
  prediction::TerminalReason reason = prediction::TerminalReason::kHorizon;
};

/// A graph whose ways all part at the source; only what likelihoods and trackers look at is made.
inline prediction::PredictionGraph lineGraph(glm::vec2 source, float horizon,
                                             const std::vector<LineWay>& ways) {
  using namespace prediction;
  PredictionGraph graph;
  graph.horizon = graph.completeTo = horizon;
  graph.source.polygon = navmesh::PolygonId{0};
  graph.source.plan = source;
  graph.corners.push_back({source, 0.0f, 0.0f, 0});
  const auto count = static_cast<std::uint32_t>(ways.size());
  graph.nodes.push_back({NodeKind::kSource, TerminalReason::kNone, false, navmesh::PolygonId{0},
                         source, 0.0f, 0.0f, kNoNode, 0, 0, count});
  for (const LineWay& way : ways) {
    std::uint32_t corner = 0;
    float distance = 0.0f;
    for (std::size_t i = 0; i + 1 < way.points.size(); ++i) {
      distance += glm::distance(graph.corners[corner].plan, way.points[i]);
      graph.corners.push_back({way.points[i], 0.0f, distance, corner});
      corner = static_cast<std::uint32_t>(graph.corners.size() - 1);
    }
    distance += glm::distance(graph.corners[corner].plan, way.points.back());
    const NodeId id{static_cast<std::uint32_t>(graph.nodes.size())};
    graph.nodes.push_back({NodeKind::kTerminal, way.reason, false, navmesh::PolygonId{0},
                           way.points.back(), 0.0f, distance, NodeId{0}, corner, 0, 0});
    graph.children.push_back(id);
    graph.terminals.push_back(id);
  }
  return graph;
}

/// Somebody at (x, 0) in a corridor along x that comes from far behind and ends in a T at
/// `crossing`: to the left (y > 0) and to the right. Ways are cut at `horizon`: behind first, then
/// left, right; before the T is in reach, behind and ahead.
inline std::vector<LineWay> waysBeforeT(float x, float crossing, float horizon) {
  std::vector<LineWay> ways{{{{x - horizon, 0.0f}}}};
  const float beyond = horizon - (crossing - x);
  if (beyond <= 0.0f) {
    ways.push_back({{{x + horizon, 0.0f}}});
  } else {
    ways.push_back({{{crossing, 0.0f}, {crossing, beyond}}});
    ways.push_back({{{crossing, 0.0f}, {crossing, -beyond}}});
  }
  return ways;
}

}  // namespace forewalk::testing
