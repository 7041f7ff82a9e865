// Recorded walks cut into legs that several people walked: from one place to the same other place.
//
// People who search a building have no start and goal in common. But they stop at the same places,
// and between two of these each walks much as if sent from one to the other. The rule:
//
// 1. A rest is a stretch of at least `restSeconds` within `restRadius` of where it begins; its
// place
//    is the mean of its samples.
// 2. Regions are discs of `regionRadius` about rests: the rest with the most different walkers
// (then
//    the most rests, then the first) resting within that radius, and on among those at least two
//    radii from all before, while `restingWalkers` rest there.
// 3. A leg from region A to region B begins with the last sample in A before the walker first comes
//    into B, and ends with the first in B; other regions may lie between. It counts where it is
//    `shortest` metres or more, and straight: at most `detour` times as long as the shortest way
//    between its two ends. Of several a walker's shortest is taken, so that one set has one leg of
//    a walker.
// 4. Legs from A to B of at least `walkers` people are a set. Sets are taken one after the other,
//    the one with the most legs first (then the one whose legs are shortest on average), and no
//    stretch of a walk is in two sets.
//
// Rule 3 leaves out who strayed: what is judged is how people walk to a place, not whether they
// know the way. Redirected walkers also rest where they were turned around; that is not told apart.
#pragma once

#include <cstddef>
#include <functional>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "rdw/walk_file.h"

namespace forewalk::service {

struct LegRule {
  double restSeconds = 2.0;        ///< > 0
  double restRadius = 0.5;         ///< metres, > 0
  double regionRadius = 1.0;       ///< metres, > 0
  std::size_t restingWalkers = 3;  ///< different ones, >= 1
  double shortest = 4.0;           ///< metres, > 0
  double detour = 1.5;             ///< >= 1
  std::size_t walkers = 4;         ///< different ones, >= 2
};

/// A stretch of one walk.
struct WalkLeg {
  std::size_t walk;         ///< index into the walks
  std::size_t first, last;  ///< samples, both of the leg
  double metres;            ///< walked
  double shortestWay;       ///< metres, from its first sample to its last
};

/// Legs of different people between the same two regions.
struct LegSet {
  std::size_t from, to;       ///< regions
  std::vector<WalkLeg> legs;  ///< ascending by walk
};

struct WalkLegs {
  std::vector<glm::dvec2> regions;  ///< their centres, plan, metres
  std::size_t rests = 0;            ///< found
  std::vector<LegSet> sets;         ///< ascending by (from, to)
};

/// Length of the shortest way between two places, metres; infinity where there is none.
using ShortestWay = std::function<double(glm::dvec2 from, glm::dvec2 to)>;

/// Cuts walks by the rule. The order of walks decides nothing but exact ties. Costs
/// O(rests^2 * regions + regions^2 * samples), and one `shortestWay` a leg that is looked at.
WalkLegs cutLegs(std::span<const rdw::Walk> walks, const LegRule& rule,
                 const ShortestWay& shortestWay);

/// How fast somebody walks when they walk: the median speed over half a second, of those above 0.3
/// m/s; m/s. 1.3 where there is none.
double comfortSpeed(const rdw::Walk& walk);

}  // namespace forewalk::service
