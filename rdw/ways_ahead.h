// The likely ways of a frame, as a walker does them: turn, walk straight, and again.
//
// What a planner needs of a prediction graph: few ways, each cut into short straight pieces, with a
// weight. Terminals whose ways run together for the first metres count as one. The weights are the
// graph's likelihoods (prediction/likelihood.h) where there are any, made sharper or not by how
// well each way agrees with the present direction of travel; of somebody who turns on the spot the
// next ways round are the likely ones. Goals lie beside ways too, so one way leads straight on.
#pragma once

#include <array>
#include <glm/glm.hpp>
#include <span>

#include "prediction/prediction_graph.h"
#include "rdw/motion.h"
#include "rdw/pose.h"
#include "rdw/redirector.h"

namespace forewalk::rdw {

/// How likely the ways of a graph are (prediction::WayLikelihood). A view for one frame.
struct WayLikelihoods {
  std::span<const double> ways;  ///< in the order of graph.terminals, those past the end: unknown,
                                 ///< taken as 0. Empty: nothing is known
  double none = 1.0;             ///< probability of none of them; sums to 1 with the rest
};

struct WaysAheadSettings {
  double agreement = 20.0;        ///< concentration of the weights about the direction of travel
                                  ///< (von Mises), >= 0
  double likelihood = 0.0;        ///< exponent of a way's likelihood in its weight, >= 0
  double agreementReach = 2.5;    ///< a way's direction is that of its first so many metres, or up
                                  ///< to its first bend
  double turnDecay = 0.6;         ///< who turns on the spot: a way so many radians further round is
                                  ///< 1/e as likely
  double straightOn = 0.15;       ///< weight of walking straight on, wherever ways lead; that of a
                                  ///< way straight ahead is 1
  double straightOnLength = 1.0;  ///< how far that is thought of, metres
  double reach = 3.0;             ///< how far ways are followed, virtual metres
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
  bool known = false;     ///< some way of the graph is among them
  double meanTurn = 0.0;  ///< expected sum of the turns ahead, virtual radians, left positive
};

/// Where somebody faces and travels in virtual space, unit vectors.
struct Travel {
  glm::dvec2 facing;
  glm::dvec2 direction;
};

/// Of one frame: who walks faces where they walk; who stands faces where they look, and with
/// `turning` (on the spot) travels where half a second of the turn leads.
Travel travelOf(const Motion& motion, const PlanarPose& virtualPose, const Redirection& redirection,
                bool turning);

/// The ways of `graph` as somebody at its source sees them who faces unit vector `facing`
/// (virtual), from which the first piece's turn is measured, and travels along unit vector
/// `direction`. Where the two are equal they walk, and ways that agree with the walk are likely;
/// where not they turn on the spot from `facing` by way of `direction`, and the next ways round are
/// likely. Without a graph, or with one of the source alone: one way straight along `direction`.
/// O(terminals * corners), allocates nothing.
WaysAhead waysAhead(const prediction::PredictionGraph* graph, const WayLikelihoods& likelihoods,
                    glm::dvec2 direction, glm::dvec2 facing, const WaysAheadSettings& settings);

}  // namespace forewalk::rdw
