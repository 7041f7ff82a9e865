// FORCE: search over steering instructions and what the user may do next.
//
// Zmuda, Wonser, Bachmann and Hodgson, "Optimizing Constrained-Environment Redirected Walking
// Instructions Using Search Techniques", TVCG 2013. The known virtual map gives the user's possible
// next steps with probabilities, the search alternates instructions and steps, and the instruction
// of the greatest expected score is given; so the user may go near a wall where the likely future
// leads away from it:
//
//   U(pose, n) = max over instructions i of sum over steps w of P(w) * U(pose after (i, w), n - 1)
//   U(pose, 0) = 1/2 + (1 - exp(-free(pose) / 2 m)) / 2
//   a collision on the way: half the share of the way that lies behind it
//
// Instructions: curvature to either side or none, rotation gain at either end or none; one for each
// leg between corners of a way.
//
// Where we depart: the steps are the ways of our prediction graph with its likelihoods, each as
// long as `reach`, rather than hand-made segments; the score at the end is ours (the published one
// is a fitness of positions that we do not have in full): the floor free ahead, in metres, with
// diminishing returns; a collision scores by how far off it is, so that what cannot be avoided is
// put off. Without a graph the user walks straight on.
#pragma once

#include <memory>

#include "rdw/controller.h"

namespace forewalk::rdw {

struct ForceSettings {
  WaysAheadSettings ways{.likelihood = 0.5, .reach = 6.0};
  double stopsBefore = 0.5;  ///< a user nearer to the border ahead has collided, metres, >= 0
  double planEvery = 0.2;    ///< seconds between plans, > 0
};

/// A plan costs up to 9^4 legs for each way ahead in the worst case; legs are cut so that there are
/// at most four. Allocates nothing.
std::unique_ptr<Controller> makeForce(const ForceSettings& settings = {});

}  // namespace forewalk::rdw
