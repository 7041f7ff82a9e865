// Predictive steer-to-center and steer-to-orbit: the same target rules, fed by the prediction
// graph.
//
// Reactive steering takes the direction of facing for the direction of the walk. Here the graph
// says where the user can walk: its ways out are weighted by how well each agrees with the present
// direction of travel, and their weighted mean is the way ahead. The target rule is asked about
// that direction. Because the graph knows the next corners as well, the likely ways are walked in
// thought through the room under each choice that the gains allow, resets included, in the manner
// of Zmuda et al. (FORCE, TVCG 2013) and Nescher et al. (MPCRed, 3DUI 2014): curvature to either
// side or none on the straights, rotation gain between its ends in the corners. The choice with the
// lowest expected cost is made. Where a thought ends, or the user may have left the way that is
// thought of, the pose's value in the room goes on (rdw/room_value.h), in which the target rule has
// its share.
#pragma once

#include <array>
#include <memory>

#include "rdw/room_value.h"
#include "rdw/steer_to.h"

namespace forewalk::rdw {

struct PredictiveSettings {
  double agreement = 20.0;        ///< concentration of the weights about the direction of travel
                                  ///< (von Mises)
  double agreementReach = 2.5;    ///< a way's direction is that of its first so many metres, or up
                                  ///< to its first bend
  double turnDecay = 0.6;         ///< who turns on the spot: a way so many radians further round is
                                  ///< 1/e as likely
  double straightOn = 0.15;       ///< weight of walking straight on, wherever ways lead; that of a
                                  ///< way straight ahead is 1
  double straightOnLength = 1.0;  ///< how far that is thought of, metres
  double faith = 1.5;             ///< a way is left, for reasons unknown, every so many metres, > 0
  double reach = 3.0;             ///< how far ways are walked in thought, virtual metres
  double replanEvery = 0.1;  ///< seconds between plans, half of that while turning on the spot; the
                             ///< chosen gains are kept meanwhile
  double rule = 0.1;         ///< weight of the target rule's bearing in a choice, resets
  bool translation = false;  ///< also scale translation: less physical way toward walls
  RoomValueSettings room;
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
/// one, and one straight on.
struct WaysAhead {
  static constexpr int kMost = 5;
  std::array<LikelyWay, kMost> ways{};
  int count = 0;
  glm::dvec2 meanDirection{
      0.0};               ///< virtual, of the mean way ahead; unit, or zero where ways cancel out
  double meanTurn = 0.0;  ///< expected sum of the turns ahead, virtual radians, left positive
};

/// The ways of `graph` as somebody at its source sees them who faces unit vector `facing`
/// (virtual), from which the first piece's turn is measured, and travels along unit vector
/// `direction`. Where the two are equal they walk, and ways that agree with the walk are likely;
/// where not they turn on the spot from `facing` by way of `direction`, and the next ways round are
/// likely. Without a graph, or with one of the source alone: one way straight along `direction`.
/// O(terminals * corners), allocates nothing.
WaysAhead waysAhead(const prediction::PredictionGraph* graph, glm::dvec2 direction,
                    glm::dvec2 facing, const PredictiveSettings& settings);

/// A controller that has to be prepared for its room (Controller::prepare); until then it follows
/// the target rule alone. A plan costs about 50 us; it is spread over the frames of 0.04 s, at least
/// one of the likely ways (about 10 us) a frame.
std::unique_ptr<Controller> makePredictive(SteerRule rule, const PredictiveSettings& settings = {});

}  // namespace forewalk::rdw
