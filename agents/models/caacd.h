// CAACD: fields around every body, the nearest approach, and a steering force.
//
// Sakr, Sudama and Doumit. Every body has three circles, alert, precaution and repulsive; the sum
// of two bodies' circles tells how bad a distance between them is. The nearest approach of a pair
// within some time ahead (OpenSteer's prediction, equations 1 to 9) is tolerable, alert or
// critical, and so is answered by nothing, by half or by all of the force.
//
//   tau = R_v . R_p / |R_v|^2,  R_v = v_B - v_A,  R_p = p_A - p_B
//   force = avoidance (lateral and forward) + path amendment,  clipped to the largest force
//   v += force / mass * seconds,  clipped to the largest speed
//
// Departs from the source, which cannot work as printed: its basis vectors start at zero; (11)
// projects on `up`, which has no part in the plane; (12) speeds up into the threat; mass and the
// limit of the force are named and never used. Here forward is the way one goes and side is left of
// it; the avoidance points from where the other will be to where this one will be; several threats
// count the more the sooner they come; whoever stops at the target sooner is not met beyond it. The
// `literal` form keeps what is printed, to be compared with.
//
// Walls are not in the source: they are braked for as late as half the force allows, and never
// entered. Round things are bodies that do not yield.
#pragma once

#include "agents/model.h"

namespace forewalk::agents {

struct CaacdParameters {
  float mass = 1.0f;   ///< > 0; an agent's own is in its memory row
  float force = 8.0f;  ///< the largest, mass * m/s^2, > 0; an agent's own is in its memory row

  // The circles, in radii of the body, which is the repulsive one. The source's 2 and 4 are for
  // open ground: in a dense crowd nobody would move.
  float precaution = 1.1f;  ///< >= 1: a nearest approach within is critical
  float alert = 1.4f;       ///< >= precaution: one within is answered by half the force

  float horizon = 3.0f;  ///< T_3: approaches later than this do not count, seconds, > 0
  float slowest = 0.0f;  ///< l_3: who walks slower than this share of the preferred speed does not
                         ///< brake for others, [0, 1]

  std::uint32_t neighbourCount = 12;
  float neighbourRadius = 8.0f;  ///< metres

  /// As printed: no lateral force, a forward force that speeds up, neither mass nor its limit,
  /// distances by the weighted sum of components.
  bool literal = false;
};

/// The parameters that the published collisions are reproduced with (caacdScene in scenes.h), for a
/// mass and a force in units of that world: the source's circles and T_3.
CaacdParameters caacdCalibration(float mass, float force);

/// Two floats an agent: its mass and its largest force; 0: the parameter.
inline constexpr std::uint32_t kCaacdMemory = 2;

std::unique_ptr<const Model> makeCaacd(const CaacdParameters& parameters = {});

/// The source's cheap distance, max * l_1 + (sum - max) * l_2 of the absolute components with l_1 =
/// 0.96 and l_2 = 0.398: within 4 % of the length. Metres.
float weightedLength(glm::vec2 v);

}  // namespace forewalk::agents
