// What a pose in the room is worth: the resets that somebody who walks on from there has to expect.
//
// A planner that walks likely ways in thought sees a few metres ahead; most of what a pose is worth
// lies beyond. This is that rest, for a user of whom nothing is known but how people walk in
// buildings: straight, and now and then round a corner or back, while the gains are chosen at best.
// It is the value function of a Markov decision process over places and headings, found once for a
// room by value iteration (Bellman 1957). The published planners (FORCE, Zmuda et al., TVCG 2013;
// MPCRed, Nescher et al., 3DUI 2014) end their look-ahead with a fixed cost instead; with one that
// did not know the room ours was worse than no prediction at all.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "rdw/gains.h"
#include "rdw/steer_to.h"
#include "rdw/tracked_space.h"

namespace forewalk::rdw {

/// Where somebody looks in the room after a reset.
enum class ThoughtReset : std::uint8_t {
  kTurnRound,  ///< back where they came from, as after the 2:1 turn
  kAnyWay,     ///< wherever the room is worth most
};

/// How a corner of buildings turns, and how often; to either side alike.
struct CornerOdds {
  double turn;  ///< virtual radians, (0, pi]
  double odds;
};

struct RoomValueSettings {
  double straight = 4.0;  ///< mean length of walking between corners, virtual metres, > 0
  std::array<CornerOdds, 4> corners{{{0.5 * kPi, 0.7}, {kPi, 0.3}, {kPi, 0.0}, {kPi, 0.0}}};
  ///< odds sum to 1
  bool translation = false;  ///< walking is scaled: translationMax virtual metres a metre
  ThoughtReset reset = ThoughtReset::kTurnRound;
  double foresight = 15.0;    ///< a reset so many metres later counts 1/e as much, metres, > 0
  double stopsBefore = 0.25;  ///< free floor ahead of somebody whom a reset stopped, metres, >= 0
  double stopping = 0.43;     ///< walked between a reset's sign and standing, metres, >= 0
  double rule = 0.02;         ///< weight of the target rule's bearing, per metre walked, >= 0
  int headings = 24;          ///< of the grid, a multiple of 4
  int places = 600;           ///< of the grid, about so many at most
  int sweeps = 40;            ///< of the iteration
  double step = 0.0;          ///< of walking between choices, metres; 0: two places of the grid
};

/// Somebody who walks through the room in thought: where a stretch of walking ends.
struct ThoughtStep {
  glm::dvec2 position;
  double heading;  ///< radians
  double walked;   ///< metres, > 0
  bool reset;      ///< stopped and turned round at its end
};

/// Walks up to `length` metres (physical) from `position` along `heading` while the path bends by
/// `curvature` (1/m, left positive). Where the border would be too near at the end, the user is
/// stopped before it as a reset would, and turned round. Good for bends of up to about a right
/// angle. O(corners).
ThoughtStep stepInThought(const TrackedSpace& space, glm::dvec2 position, double heading,
                          double length, double curvature, const RoomValueSettings& settings);

/// Empty until made; then only read.
class RoomValue {
 public:
  RoomValue() = default;

  /// O(places * headings * (corners of the space + sweeps)), some 50 ms for a room of few corners.
  RoomValue(const TrackedSpace& space, const GainLimits& limits, SteerRule rule,
            const RoomValueSettings& settings = {});

  bool empty() const { return values_.empty(); }

  /// The expected number of resets, discounted by foresight, for somebody at `position` (physical)
  /// about to walk on along `heading` (radians), plus the rule's share. Interpolated between the
  /// places and headings of the grid; outside it the nearest place counts. Must not be empty. O(1).
  double at(glm::dvec2 position, double heading) const {
    return sample(values_, position, heading);
  }

  /// About the distance to the border, metres, negative outside. Must not be empty. O(1).
  double borderDistance(glm::dvec2 position) const { return sampleFlat(borders_, position); }

  /// What `at` is at best, whatever the heading. Must not be empty. O(1).
  double least(glm::dvec2 position) const { return sampleFlat(least_, position); }

  /// The heading that is worth most near `position`. Must not be empty. O(1).
  double bestHeading(glm::dvec2 position) const;

 private:
  std::size_t node(int x, int y) const {
    return static_cast<std::size_t>(y * width_ + x) * static_cast<std::size_t>(headings_);
  }
  double sample(const std::vector<float>& field, glm::dvec2 position, double heading) const;
  void foreseeCorners(const GainLimits& limits, double corner, std::span<const CornerOdds> corners,
                      std::vector<float>& onward) const;
  void rankHeadings();
  double sampleFlat(const std::vector<float>& field, glm::dvec2 position) const;

  glm::dvec2 origin_{0.0};
  glm::dvec2 cell_{
      1.0};  ///< metres; places lie on the bounds, so that mirrored rooms have mirrored ones
  int width_ = 0, depth_ = 0, headings_ = 0;
  std::vector<float> values_;  ///< row after row of places, at each all headings from 0 on
  std::vector<float>
      borders_;  ///< of each place: the distance to the border, metres, negative outside
  std::vector<float> least_;         ///< of each place
  std::vector<std::uint16_t> best_;  ///< the heading that it is of
};

}  // namespace forewalk::rdw
