// Where to look after a reset: the heading from which the likely ways ahead fit the room best.
//
// Ours. The published resets look at the room alone: back (2:1 turn), to its centre (R2C), down the
// gradient of a potential (R2G). The user goes on, though, along a way that the prediction graph
// knows more or less. Here the likely ways are walked in thought from every heading (way_search.h)
// and the one of the least expected cost is taken; without a graph, a straight way of which nothing
// more is known.
#pragma once

#include <glm/glm.hpp>
#include <memory>

#include "prediction/prediction_graph.h"
#include "rdw/reset_policy.h"
#include "rdw/room_value.h"
#include "rdw/tracked_space.h"
#include "rdw/way_search.h"
#include "rdw/ways_ahead.h"

namespace forewalk::rdw {

/// What a reset knows when it begins. References live for the call.
struct ResetAheadInput {
  const TrackedSpace& space;                 ///< the one it was made for
  glm::dvec2 position;                       ///< physical, where the user will stand
  glm::dvec2 virtualDirection;               ///< unit, where they will walk on after the reset
  const prediction::PredictionGraph* graph;  ///< null: nothing is predicted
  WayLikelihoods likelihoods;
};

/// Made for one room.
class ResetAhead {
 public:
  ResetAhead(const TrackedSpace& space, const GainLimits& limits, bool translation = true);

  /// The physical heading to face after the reset, radians in (-pi, pi]. The least expected cost
  /// of kHeadings and of two between them; of equal ones the first, counted from the direction to
  /// the room's centre outward. Allocates nothing; about 0.3 ms, once a reset.
  double heading(const ResetAheadInput& input) const;

 private:
  static constexpr int kHeadings = 24;
  static constexpr double kNearReach = 6.0;  // metres; how far ways are followed at first
  static constexpr int kFinalists = 3;       // headings that are thought of again
  static constexpr int kFinalWidth = 2;      // with a beam so wide
  GainLimits limits_;
  RoomValueSettings building_, plane_;
  RoomValue buildingRoom_, planeRoom_;
};

/// The same as a reset (`ahead`): turns by the longer way round, a virtual turn of 360 degrees.
std::unique_ptr<ResetPolicy> makeResetAhead();

}  // namespace forewalk::rdw
