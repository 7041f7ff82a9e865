// HRVO: hybrid reciprocal velocity obstacles, with walls.
//
// Snape, van den Berg, Guy and Manocha, "Independent navigation of multiple mobile robots with
// hybrid reciprocal velocity obstacles" (IROS 2009) and "The hybrid reciprocal velocity obstacle"
// (IEEE T-RO 27, 2011). Each neighbour forbids a cone of velocities. Its apex lies between the
// other's velocity and the mean of both, so that passing on the agreed side takes half of the
// change, and passing on the other side all of it: they do not dance. Whoever does not yield
// (agents_view.h) has the plain velocity obstacle, apex at its velocity.
//
// Departs from the source:
// - Walls, which the published library leaves out: the cone of the segment widened by the agent's
//   radius, cut off at `wallHorizon`. Circles likewise, at their velocity.
// - Cones of agents may be cut off at `timeHorizon`; the published ones reach to infinity, which is
// also
//   the default: cut ones let more people through a crowd's middle and overlap more often there.
// - Where no velocity is free: the least |v - preferred| + w / (time to collision) over the
// candidates and
//   a polar sample, in place of the one that enters the farthest first-entered cone. Velocities
//   that run into walls come last.
//
// `preferredOnly` is what an avatar of Ono's thesis (UCL 2011) really did: its library returned
// the preferred velocity whatever stood in the way (thesis_navigation.h).
#pragma once

#include "agents/model.h"

namespace forewalk::agents {

struct HrvoParameters {
  float neighbourRadius = 5.0f;      ///< metres
  std::uint32_t neighbourCount = 6;  ///< as in the thesis; cost grows with its square
  float timeHorizon = 0.0f;      ///< later collisions with agents do not count, seconds; 0: all do
  float wallHorizon = 1.0f;      ///< the same for walls, seconds, > 0
  float uncertainty = 0.0f;      ///< of others' velocities, m/s: cones begin so much earlier
  float collisionWeight = 1.0f;  ///< w: metres; how much a near collision counts against a detour
  bool preferredOnly = false;
};

std::unique_ptr<const Model> makeHrvo(const HrvoParameters& parameters = {});

/// The apex of the cone that `self` sees of `other`, m/s on the plan, for bodies `apart` (from self
/// to other) that do not overlap, `reach` the sum of their radii. `leftOfCentre`: the side of the
/// cone's centre line on which the relative velocity lies.
glm::vec2 hybridApex(glm::vec2 apart, float reach, glm::vec2 velocity, glm::vec2 theirs,
                     bool leftOfCentre);

}  // namespace forewalk::agents
