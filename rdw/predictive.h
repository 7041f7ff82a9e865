// Predictive steer-to-center and steer-to-orbit: the same target rules, fed by the prediction
// graph.
//
// Reactive steering takes the direction of facing for the direction of the walk. Here the graph
// says where the user can walk: its ways out are weighted by how well each agrees with the present
// direction of travel, and their weighted mean is the way ahead. The target rule is asked about
// that direction. Because the graph knows the next corners as well, the likely ways are walked in
// thought through the room under each choice that the gains allow, resets included, in the manner
// of Zmuda et al. (FORCE, TVCG 2013) and Nescher et al. (MPCRed, 3DUI 2014): curvature to either
// side or none on the straights, rotation gain to either end or none in the corners. The choice
// with the lowest expected cost is made; the target rule gives the value of the pose in which such
// a walk ends, and decides ties.
#pragma once

#include <array>
#include <memory>

#include "rdw/steer_to.h"

namespace forewalk::rdw {

struct PredictiveSettings {
  double agreement =
      5.0;  ///< concentration of the weights about the direction of travel (von Mises)
  double agreementReach = 2.5;  ///< a way's direction is that of its first so many metres
  double reach = 9.0;           ///< how far ways are walked in thought, virtual metres
  double replanEvery = 0.1;     ///< seconds between plans; the chosen gains are kept meanwhile
  double stopDistance = 0.25;   ///< free floor that is left ahead of somebody stopped, metres
  bool translation = false;     ///< also scale translation: less physical way toward walls
};

/// One way ahead in virtual space, as a walker does it: turn on the spot, then walk straight; and
/// again.
struct LikelyWay {
  static constexpr int kMostPieces = 10;
  struct Piece {
    double turn;    ///< virtual radians, before walking
    double length;  ///< virtual metres, (0, 2]
  };
  std::array<Piece, kMostPieces> pieces{};
  int count = 0;
  double weight = 0.0;  ///< all ways of a frame sum to 1
};

/// The likely ways of a frame: at most kMost, ways that run together for the first metres taken as
/// one.
struct WaysAhead {
  static constexpr int kMost = 5;
  std::array<LikelyWay, kMost> ways{};
  int count = 0;
  glm::dvec2 meanDirection{
      0.0};               ///< virtual, of the mean way ahead; unit, or zero where ways cancel out
  double meanTurn = 0.0;  ///< expected sum of the turns ahead, virtual radians, left positive
};

/// The ways of `graph` as somebody at its source sees them who travels along unit vector
/// `direction` (virtual) and faces unit vector `facing`, from which the first piece's turn is
/// measured. Without a graph, or with one of the source alone: one way straight along `direction`.
/// O(terminals * corners), allocates nothing.
WaysAhead waysAhead(const prediction::PredictionGraph* graph, glm::dvec2 direction,
                    glm::dvec2 facing, const PredictiveSettings& settings);

std::unique_ptr<Controller> makePredictive(SteerRule rule, const PredictiveSettings& settings = {});

}  // namespace forewalk::rdw
