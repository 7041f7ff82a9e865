// Foresight: plans gains along the likely ways of the prediction graph. Ours.
//
// Each cycle the likely ways ahead (ways_ahead.h, weighted by the graph's likelihoods) are walked
// in thought through the room under sequences of gains (way_search.h), and the first gains of the
// least expected cost are applied until the next cycle. The cost, in resets:
//
//   J(c) = sum over ways w of P(w) * min over gains after c of
//            sum over steps of S * exp(-s / L) * (reset + felt + border)
//            + sum over steps of S * P(left here) * exp(-s / L) * V(pose)
//
// S: the chance that the user still follows w after s metres, exp(-s / faith); V: the resets to
// expect of a pose of whom nothing is known but how people walk (room_value.h), discounted over L.
//
// Gains: curvature, translation, rotation. Walking more virtual than physical metres is always on
// where a wall may come near; in the middle of a hall nothing is injected. In a bend that is walked
// rotation takes the place of curvature where it does more (as in steer-to), toward the side that
// the search wants: people who search a building hardly ever walk straight. Kin are
// MPCRed (mpcred.h) and FORCE (force.h); what is new is the value at the end of each thought (they
// end with a fixed cost), evidence-weighted ways, and resets that look where the room is free.
//
// Without a graph, or where it knows no way, the rule is reactive: the same search along one
// straight way, or, of somebody who turns on the spot, along five that end the turn sooner or
// later (a turn of which nothing is known is taken to be uniform up to half a turn).
//
// Cycles come ten times a second, twenty while turning, at times of their own: within them gains
// are kept. The side of curvature changes at most once a second. Never leaves the limits.
#pragma once

#include <memory>

#include "rdw/controller.h"
#include "rdw/room_value.h"
#include "rdw/way_search.h"

namespace forewalk::rdw {

/// How people walk of whom there is no graph: any turn is as likely as another.
RoomValueSettings openPlaneValue();

/// How people walk in buildings.
RoomValueSettings buildingValue();

struct ForesightSettings {
  WaysAheadSettings ways{.likelihood = 0.5, .reach = 10.0};
  RoomValueSettings building = buildingValue();  ///< where a graph shows ways
  RoomValueSettings plane = openPlaneValue();    ///< elsewhere
  WaySearchSettings search;
  double planEvery = 0.1;   ///< seconds between plans, half of that while turning on the spot
  double sideHeld = 1.0;    ///< seconds between two changes of the curvature's side
  double smoothing = 0.1;   ///< time constant of the curvature applied, seconds, > 0
  bool translation = true;  ///< scale walking
};

/// Has to be prepared for its room (Controller::prepare); until then it injects nothing. A plan
/// costs at most ForesightSettings::search.nodes steps of thought, 0.1 us each in a rectangle.
std::unique_ptr<Controller> makeForesight(const ForesightSettings& settings = {});

}  // namespace forewalk::rdw
