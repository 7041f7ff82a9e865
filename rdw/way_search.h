// Walks likely ways through the room in thought, and finds what each choice of gains would cost.
//
// A beam search (Lowerre 1976) over sequences of gains: on straights curvature to either side or
// none, in corners rotation gain between its ends, resets where the user could no longer stop. Of
// each first choice the best walkers are kept, piece after piece of the way, and the first choice
// costs what the best of them does. At the end of the way, and wherever the user may have left it,
// counts what the pose is worth in this room (room_value.h).
//
// It is anytime: the beam is widened again and again until the nodes are used up, and an answer
// stands after each pass. Nodes are counted, not time, so that the same frame gives the same
// answer on every machine.
#pragma once

#include <array>
#include <span>

#include "rdw/gains.h"
#include "rdw/pose.h"
#include "rdw/room_value.h"
#include "rdw/tracked_space.h"
#include "rdw/ways_ahead.h"

namespace forewalk::rdw {

/// Gains that a planner chooses between. Ratios as in Gains, in doubles.
struct Choice {
  double translation = 1.0;
  double rotation = 1.0;
  double curvature = 0.0;  ///< 1/m
};

struct WaySearchSettings {
  int nodes = 2000;          ///< steps thought of in one search, >= 1; the budget
  double faith = 4.0;        ///< a way is left, for reasons unknown, every so many metres, > 0
  double feltMetre = 0.002;  ///< cost of a metre under full curvature or translation, resets, >= 0
  double feltRadian =
      0.002;  ///< cost of a radian turned under an extreme of rotation gain, resets, >= 0
  double border = 0.01;      ///< cost of a metre walked along the border, resets, >= 0
  double borderReach = 0.8;  ///< how far from the border that begins, metres, > 0
};

/// Somebody in the room, in thought.
struct ThoughtPose {
  glm::dvec2 position{0.0};  ///< physical
  double heading = 0.0;      ///< physical, radians
};

/// Searches for one room. Keeps references: `space` and `room` have to outlive it.
class WaySearch {
 public:
  static constexpr int kMostChoices = 6;
  static constexpr int kWidest = 8;  ///< walkers kept of each first choice

  WaySearch(const TrackedSpace& space, const GainLimits& limits, const RoomValue& room,
            const RoomValueSettings& roomSettings, const WaySearchSettings& settings)
      : space_(space),
        limits_(limits),
        room_(room),
        roomSettings_(roomSettings),
        settings_(settings) {}

  /// What walking on costs after each first choice, in resets, expected over the ways of `ahead`;
  /// written to `costs`, one each. `turning`: the user turns on the spot and the first choices are
  /// of rotation, else of curvature and translation. At most kMostChoices, `costs` as many.
  /// O(nodes * corners of the space), allocates nothing. Returns the nodes used.
  int costs(const ThoughtPose& from, const WaysAhead& ahead, bool turning,
            std::span<const Choice> first, std::span<double> costs) const;

  /// The same where every choice is free, from the first step on: what the pose is worth to
  /// somebody who walks the ways of `ahead`. One pass with `width` walkers, in [1, kWidest];
  /// `translation` is applied throughout. Allocates nothing.
  double cost(const ThoughtPose& from, const WaysAhead& ahead, double translation, int width) const;

 private:
  struct Walker;
  struct Beam;
  int walk(const ThoughtPose& from, const LikelyWay& way, bool turning, double translation,
           std::span<const Choice> first, int width, std::span<double> costs) const;
  void walkPiece(double length, const Choice& choice, Walker& walker, int& nodes) const;

  const TrackedSpace& space_;
  const GainLimits& limits_;
  const RoomValue& room_;
  const RoomValueSettings& roomSettings_;
  WaySearchSettings settings_;
};

/// The rotation gains that planners choose between: both ends, halfway to each, none.
inline constexpr int kRotationChoices = 5;
double rotationChoice(int choice, const GainLimits& limits);

}  // namespace forewalk::rdw
