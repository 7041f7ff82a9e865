// What a graph says in numbers, for answers that are known by looking at a floor.
#pragma once

#include <cstddef>
#include <ostream>

#include "prediction/prediction_graph.h"

namespace forewalk::testing {

struct Ways {
  std::size_t horizon = 0, deadEnds = 0, meetings = 0, branches = 0, joins = 0, links = 0;

  bool operator==(const Ways&) const = default;
};

inline std::ostream& operator<<(std::ostream& out, const Ways& ways) {
  return out << ways.horizon << " to the horizon, " << ways.deadEnds << " dead ends, "
             << ways.meetings << " meetings, " << ways.branches << " branches, " << ways.joins
             << " joins, " << ways.links << " times through a link";
}

inline Ways waysOf(const prediction::PredictionGraph& graph) {
  Ways ways;
  for (const prediction::Node& node : graph.nodes) {
    ways.horizon += node.reason == prediction::TerminalReason::kHorizon;
    ways.deadEnds += node.reason == prediction::TerminalReason::kDeadEnd;
    ways.meetings += node.reason == prediction::TerminalReason::kMeeting;
    ways.branches += node.branch;
    ways.joins += node.kind == prediction::NodeKind::kJoin;
  }
  ways.links = graph.linkSteps.size();
  return ways;
}

}  // namespace forewalk::testing
