// Social forces, with every term of the virtual-agents paper.
//
// Helbing, Farkas and Vicsek (Nature 407, 2000); Helbing et al. (2003); Lakoba, Kaup and
// Finkelstein (Simulation 81, 2005); and a paper on virtual agents in online worlds that adds
// attraction to friends and places and a velocity-bias force over the ground that others are about
// to sweep, which makes up for positions that arrive late over a network.
//
//   a = (v_pref - v)/tau + sum over agents (social + attraction + bias + push + friction)
//                        + sum over walls  (repulsion + attraction + push + friction)
//
// The source has no masses, so these are accelerations. Mended in the default form, kept in the
// `literal` one: walls push away from themselves (as printed they attract); the bracket of the bias
// force divides the whole difference; friction opposes the slip and cannot turn it round within a
// step (as printed it pushes along a fixed side whatever the slip).
//
// Contact is stiff: explicit steps are stable below 2/sqrt(2 kappa), 36 ms at 1500 /s^2, so the
// model asks for sub-steps of 0.6 times that.
#pragma once

#include "agents/model.h"

namespace forewalk::agents {

struct SocialForceParameters {
  float relaxation = 0.5f;  ///< tau: seconds in which the preferred velocity is taken up, > 0

  float socialStrength = 40.0f;  ///< alpha, m/s^2 at touch
  float socialRange = 0.08f;     ///< beta, metres, > 0
  float wallStrength = 40.0f;    ///< A, m/s^2 at touch
  float wallRange = 0.08f;       ///< B, metres, > 0

  // Of friends (the same group, not 0), and of walls that attract (Wall::attraction).
  float friendAttraction = 1.0f;       ///< m/s^2 at touch
  float friendAttractionRange = 3.0f;  ///< metres, > 0
  float wallAttraction = 1.0f;         ///< m/s^2 at touch
  float wallAttractionRange = 3.0f;    ///< metres, > 0
  float attractionReach = 10.0f;       ///< no attraction from beyond, metres
  float attractionLimit = 1.0f;        ///< of all attraction together, m/s^2

  float contactStiffness = 1500.0f;  ///< kappa, 1/s^2: push per metre of overlap, >= 0
  float friction = 0.5f;             ///< lambda: friction per push, >= 0

  float biasStrength = 3.0f;  ///< gamma, m/s^2 at touch of the swept body; 0: no bias
  float biasRange = 0.3f;     ///< epsilon, metres, > 0
  float biasSeconds = 0.5f;   ///< how far ahead neighbours are swept
  float sameWay = 0.7f;       ///< none from those whose heading differs less than this cosine

  float projectedSeconds = 0.75f;  ///< t_p: how far ahead the way point lies

  std::uint32_t neighbourCount = 10;
  float neighbourRadius = 3.0f;  ///< metres; attractionReach where there are groups

  bool literal = false;  ///< as printed, errors included
};

/// Two floats an agent: the way point, its place after `projectedSeconds` at its velocity. For
/// engines that steer by way points.
inline constexpr std::uint32_t kSocialForceMemory = 2;

std::unique_ptr<const Model> makeSocialForces(const SocialForceParameters& parameters = {});

/// The acceleration that friction gives to a body: against `slip` (its velocity along the other's
/// surface relative to that, m/s), `friction` times `push` (m/s^2), and no more than takes `share`
/// of the slip away in `seconds`. So it never adds energy.
glm::vec2 frictionOf(glm::vec2 slip, float push, float friction, float share, float seconds);

/// The longest stable sub-step for a contact stiffness, seconds; 0 (any) where there is no contact
/// force.
float stableSubStep(float contactStiffness);

}  // namespace forewalk::agents
