// MPCRed: model predictive control over the ways ahead.
//
// Nescher, Hong and Kunz, "Planning redirection techniques for optimal free walking experience
// using model predictive control", IEEE 3DUI 2014. The future is cut into stages; at each a
// redirection is chosen, and the user chooses a way:
//
//   J(node, depth) = min over actions a of sum over branches b of
//                    P(b) * [cost(a) + 0.8 * J(next(b, a), depth - 1)]
//
// Actions: nothing (cost 0), curvature to either side or rotation gain at either end (1 each); a
// reset or collision on the way costs 500. Stages of 2 s, four deep, at most three branches, as in
// a public restatement. The first action is applied until the next plan.
//
// Where we depart: the ways and P(b) are those of our prediction graph (the paper draws its graph
// by hand); the branches part at the user, so that later stages know which way was taken; who is
// stopped in thought goes on turned round. Searching is depth first, and stops at a free stage that
// costs nothing. Without a graph the user is taken to walk straight on.
#pragma once

#include <memory>

#include "rdw/controller.h"
#include "rdw/room_value.h"

namespace forewalk::rdw {

struct MpcredSettings {
  WaysAheadSettings ways{.likelihood = 0.5};  ///< `reach` is depth * stageSeconds * speed
  double stageSeconds = 2.0;                  ///< > 0
  double speed = 1.0;                         ///< of the user in thought, m/s, > 0
  int depth = 4;             ///< stages, [1, 6]: the search takes up to 5^depth of them a branch
  int branches = 3;          ///< ways looked at, the likeliest, >= 1
  double discount = 0.8;     ///< of a stage, (0, 1]
  double actionCost = 1.0;   ///< of a stage under curvature or rotation gain, >= 0
  double resetCost = 500.0;  ///< of a reset, >= 0
  double stopsBefore = 0.5;  ///< a user nearer to the border counts as stopped, metres, >= 0
  double planEvery = 0.5;    ///< seconds between plans, > 0
};

/// A plan costs at most branches * 5^depth stages of a few steps each, some 0.4 ms; allocates
/// nothing.
std::unique_ptr<Controller> makeMpcred(const MpcredSettings& settings = {});

}  // namespace forewalk::rdw
