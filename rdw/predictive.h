// Predictive steer-to-center and steer-to-orbit: the same target rules, fed by the prediction
// graph.
//
// Reactive steering takes the direction of facing for the direction of the walk. Here the graph
// says where the user can walk: its ways out are weighted by how well each agrees with the present
// direction of travel, and their weighted mean is the way ahead. The target rule is asked about
// that direction. Because the graph knows the next corners as well, the likely ways are walked in
// thought through the room under each choice that the gains allow, resets included, in the manner
// of Zmuda et al. (FORCE, TVCG 2013) and Nescher et al. (MPCRed, 3DUI 2014): curvature to either
// side or none on the straights, rotation gain between its ends in the corners. The choice with the
// lowest expected cost is made. Where a thought ends, or the user may have left the way that is
// thought of, the pose's value in the room goes on (rdw/room_value.h), in which the target rule has
// its share.
#pragma once

#include <memory>

#include "rdw/room_value.h"
#include "rdw/steer_to.h"
#include "rdw/ways_ahead.h"

namespace forewalk::rdw {

struct PredictiveSettings {
  WaysAheadSettings ways;
  double faith = 1.5;        ///< a way is left, for reasons unknown, every so many metres, > 0
  double replanEvery = 0.1;  ///< seconds between plans, half of that while turning on the spot; the
                             ///< chosen gains are kept meanwhile
  double rule = 0.1;         ///< weight of the target rule's bearing in a choice, resets
  bool translation = false;  ///< also scale translation: less physical way toward walls
  RoomValueSettings room;
};

/// A controller that has to be prepared for its room (Controller::prepare); until then it follows
/// the target rule alone. A plan costs about 50 us; it is spread over the frames of 0.04 s, at
/// least one of the likely ways (about 10 us) a frame.
std::unique_ptr<Controller> makePredictive(SteerRule rule, const PredictiveSettings& settings = {});

}  // namespace forewalk::rdw
