// ORCA: optimal reciprocal collision avoidance.
//
// van den Berg, Guy, Lin and Manocha, "Reciprocal n-body collision avoidance" (ISRR 2009, in
// Springer Tracts in Advanced Robotics 70, 2011). Each neighbour forbids a half-plane of
// velocities; the new one is the allowed velocity nearest to the preferred one (a linear program in
// two dimensions), or, where none is allowed, the one that enters the half-planes least (in three).
// Walls forbid theirs outright and are never entered to make room for agents.
//
// Departs from the source where somebody does not yield (agents_view.h): their half-plane is
// moved by the whole change of velocity, not by half of it.
#pragma once

#include "agents/model.h"

namespace forewalk::agents {

struct OrcaParameters {
  float neighbourRadius = 5.0f;  ///< metres
  std::uint32_t neighbourCount = 10;
  float timeHorizon = 3.0f;  ///< no collision with agents for so long, seconds, > 0
  float wallHorizon = 1.0f;  ///< no collision with walls for so long, seconds, > 0
};

std::unique_ptr<const Model> makeOrca(const OrcaParameters& parameters = {});

}  // namespace forewalk::agents
