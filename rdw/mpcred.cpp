#include "rdw/mpcred.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace forewalk::rdw {

namespace {

constexpr double kTurningRate = 1.5 * kPi / 180.0;  // rad/s; slower head turns are not scaled
constexpr double kSmallestBend = 0.17;              // radians; smaller bends are walked, not turned

/// What MPCRed chooses between, in this order: of equal ones the first is taken.
enum Action { kNothing, kCurveRight, kCurveLeft, kRotateLess, kRotateMore, kActions };

class Mpcred final : public Controller {
 public:
  explicit Mpcred(const MpcredSettings& settings) : settings_(settings) {
    thought_.stopsBefore = settings.stopsBefore;
    thought_.stopping = 0.0;
  }

  Gains steer(const SteerInput& input) override {
    const Motion& motion = input.motion;
    if (!motion.usable() || motion.dt <= 0.0) return {};
    const bool turning = std::abs(motion.turnRate) >= kTurningRate;
    if (!motion.walking && !turning) return {};
    untilPlan_ -= motion.dt;
    if (untilPlan_ <= 0.0) {
      plan(input);
      untilPlan_ = settings_.planEvery;
    }
    Gains gains;
    const double curvature = static_cast<double>(input.limits.curvatureMax);
    if (action_ == kCurveRight) gains.curvature = static_cast<float>(-curvature);
    if (action_ == kCurveLeft) gains.curvature = static_cast<float>(curvature);
    if (action_ == kRotateLess) gains.rotation = input.limits.rotationMin;
    if (action_ == kRotateMore) gains.rotation = input.limits.rotationMax;
    return clamped(gains, input.limits);
  }

  void restart() override {
    untilPlan_ = 0.0;
    action_ = kNothing;
  }

  std::string_view name() const override { return "mpcred"; }
  bool wantsPrediction() const override { return true; }
  bool wantsLikelihoods() const override { return true; }
  bool steersWithoutGraph() const override { return true; }

 private:
  /// Where a stage of one way begins: which piece, and how much of it has been walked.
  struct Place {
    int piece = 0;
    double into = 0.0;
  };

  void plan(const SteerInput& input) {
    const Travel travel = travelOf(input.motion, input.virtualPose, input.redirection, false);
    WaysAheadSettings ways = settings_.ways;
    ways.reach = settings_.stageSeconds * settings_.speed * settings_.depth;
    const WaysAhead ahead =
        waysAhead(input.graph, input.likelihoods, travel.direction, travel.facing, ways);
    // The likeliest ways only: the tree has few branches. Of equally likely ones the first.
    std::array<bool, WaysAhead::kMost> taken{};
    const int branches = std::min(ahead.count, settings_.branches);
    const double heading = headingOf(input.redirection.directionToPhysical(travel.facing));
    std::array<double, kActions> costs{};
    for (int b = 0; b < branches; ++b) {
      int likeliest = -1;
      for (int w = 0; w < ahead.count; ++w) {
        const auto k = static_cast<std::size_t>(w);
        if (taken[k]) continue;
        if (likeliest < 0 ||
            ahead.ways[k].weight > ahead.ways[static_cast<std::size_t>(likeliest)].weight) {
          likeliest = w;
        }
      }
      taken[static_cast<std::size_t>(likeliest)] = true;
      const LikelyWay& way = ahead.ways[static_cast<std::size_t>(likeliest)];
      double unturned = 0.0;
      for (int a = 0; a < kActions; ++a) {
        const auto action = static_cast<Action>(a);
        // Where the stage has no corner a rotation gain is for nothing.
        const double cost = scalesTurns(action) && !hasCorner(way, {})
                                ? unturned + settings_.actionCost
                                : after(input, way, {}, input.physical.position, heading, action,
                                        settings_.depth, INFINITY);
        if (action == kNothing) unturned = cost;
        costs[static_cast<std::size_t>(a)] += way.weight * cost;
      }
    }
    int best = kNothing;
    for (int a = 1; a < kActions; ++a) {
      if (costs[static_cast<std::size_t>(a)] < costs[static_cast<std::size_t>(best)] - 1e-9)
        best = a;
    }
    action_ = static_cast<Action>(best);
  }

  static bool scalesTurns(Action action) { return action == kRotateLess || action == kRotateMore; }

  /// Whether a stage of `way` from `at` has a corner that rotation gain could scale.
  bool hasCorner(const LikelyWay& way, Place at) const {
    double left = settings_.stageSeconds * settings_.speed;
    while (left > 1e-6 && at.piece < way.count) {
      const LikelyWay::Piece& piece = way.pieces[static_cast<std::size_t>(at.piece)];
      if (at.into == 0.0 && std::abs(piece.turn) > kSmallestBend) return true;
      left -= piece.length - at.into;
      at = {at.piece + 1, 0.0};
    }
    return false;
  }

  /// Cost of `action` for a stage of `way` from `at`, and of the best from there on; where that is
  /// `enough` or more, any number from there up. Branch and bound: costs only add up.
  double after(const SteerInput& input, const LikelyWay& way, Place at, glm::dvec2 position,
               double heading, Action action, int depth, double enough) const {
    const GainLimits& limits = input.limits;
    const double curvature = action == kCurveLeft    ? static_cast<double>(limits.curvatureMax)
                             : action == kCurveRight ? -static_cast<double>(limits.curvatureMax)
                                                     : 0.0;
    const double rotation = action == kRotateLess   ? static_cast<double>(limits.rotationMin)
                            : action == kRotateMore ? static_cast<double>(limits.rotationMax)
                                                    : 1.0;
    double cost = action == kNothing ? 0.0 : settings_.actionCost;
    double left = settings_.stageSeconds * settings_.speed;
    while (left > 1e-6) {
      const bool known = at.piece < way.count;
      // Beyond what is known they walk straight on.
      double length = left;
      if (known) {
        const LikelyWay::Piece& piece = way.pieces[static_cast<std::size_t>(at.piece)];
        if (at.into == 0.0) {
          heading += std::abs(piece.turn) > kSmallestBend ? piece.turn / rotation : piece.turn;
        }
        length = std::min(left, piece.length - at.into);
        at.into += length;
        if (at.into >= piece.length - 1e-9) at = {at.piece + 1, 0.0};
      }
      for (double rest = length; rest > 1e-6;) {
        const ThoughtStep step =
            stepInThought(input.space, position, heading, std::min(rest, 1.0), curvature, thought_);
        position = step.position;
        heading = step.heading;
        rest -= step.walked;
        if (step.reset) cost += settings_.resetCost;
        if (cost >= enough) return cost;
      }
      left -= length;
    }
    if (depth == 1) return cost;
    const bool corner = hasCorner(way, at);
    double least = (enough - cost) / settings_.discount;
    for (int a = 0; a < kActions && least > 0.0; ++a) {
      const auto next = static_cast<Action>(a);
      if (scalesTurns(next) && !corner) continue;
      least = std::min(least, after(input, way, at, position, heading, next, depth - 1, least));
    }
    return cost + settings_.discount * least;
  }

  MpcredSettings settings_;
  RoomValueSettings thought_;  // how stepInThought stops
  double untilPlan_ = 0.0;
  Action action_ = kNothing;
};

}  // namespace

std::unique_ptr<Controller> makeMpcred(const MpcredSettings& settings) {
  return std::make_unique<Mpcred>(settings);
}

}  // namespace forewalk::rdw
