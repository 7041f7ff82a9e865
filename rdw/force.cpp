#include "rdw/force.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "rdw/room_value.h"
#include "rdw/way_search.h"

namespace forewalk::rdw {

namespace {

constexpr double kTurningRate = 1.5 * kPi / 180.0;  // rad/s; slower head turns are not scaled
constexpr double kSmallestBend = 0.17;              // radians; smaller bends are walked, not turned
constexpr double kEnough = 2.0;                     // metres of free floor that are worth 63 %
constexpr int kCurvatures = 3;                      // none, right, left
constexpr int kRotations = 3;                       // none, less, more
constexpr int kMostLegs = 4;

class Force final : public Controller {
 public:
  explicit Force(const ForceSettings& settings) : settings_(settings) {
    thought_.stopsBefore = settings.stopsBefore;
    thought_.stopping = 0.0;
  }

  Gains steer(const SteerInput& input) override {
    const Motion& motion = input.motion;
    if (!motion.usable() || motion.dt <= 0.0) return {};
    const bool turning = !motion.walking && std::abs(motion.turnRate) >= kTurningRate;
    if (!motion.walking && !turning) return {};
    untilPlan_ -= motion.dt;
    if (untilPlan_ <= 0.0 || turning != turning_) {
      turning_ = turning;
      plan(input);
      untilPlan_ = settings_.planEvery;
    }
    Gains gains;
    if (turning) {
      gains.rotation = static_cast<float>(rotation_);
    } else {
      gains.curvature = static_cast<float>(curvature_);
    }
    return clamped(gains, input.limits);
  }

  void restart() override {
    untilPlan_ = 0.0;
    turning_ = false;
    curvature_ = 0.0;
    rotation_ = 1.0;
  }

  std::string_view name() const override { return "force"; }
  bool wantsPrediction() const override { return true; }
  bool wantsLikelihoods() const override { return true; }
  bool steersWithoutGraph() const override { return true; }

 private:
  static double rotationOf(int choice, const GainLimits& limits) {
    return static_cast<double>(choice == 0   ? 1.0f
                               : choice == 1 ? limits.rotationMin
                                             : limits.rotationMax);
  }
  static double curvatureOf(int choice, const GainLimits& limits) {
    const double most = static_cast<double>(limits.curvatureMax);
    return choice == 0 ? 0.0 : choice == 1 ? -most : most;
  }

  /// `way` as at most kMostLegs legs: small bends are part of a leg.
  static LikelyWay legsOf(const LikelyWay& way) {
    LikelyWay legs;
    for (int p = 0; p < way.count; ++p) {
      const LikelyWay::Piece& piece = way.pieces[static_cast<std::size_t>(p)];
      const bool corner = std::abs(piece.turn) > kSmallestBend;
      if (legs.count == 0 || (corner && legs.count < kMostLegs)) {
        legs.pieces[static_cast<std::size_t>(legs.count++)] = piece;
      } else {
        LikelyWay::Piece& last = legs.pieces[static_cast<std::size_t>(legs.count - 1)];
        last.length += piece.length;
      }
    }
    return legs;
  }

  void plan(const SteerInput& input) {
    const Travel travel = travelOf(input.motion, input.virtualPose, input.redirection, turning_);
    const WaysAhead ahead =
        waysAhead(input.graph, input.likelihoods, travel.direction, travel.facing, settings_.ways);
    const double heading = headingOf(input.redirection.directionToPhysical(travel.facing));
    std::array<double, kRotations> scores{};
    const int choices = turning_ ? kRotations : kCurvatures;
    for (int w = 0; w < ahead.count; ++w) {
      const LikelyWay legs = legsOf(ahead.ways[static_cast<std::size_t>(w)]);
      const double weight = ahead.ways[static_cast<std::size_t>(w)].weight;
      for (int c = 0; c < choices; ++c) {
        scores[static_cast<std::size_t>(c)] +=
            weight * (turning_ ? bestWalk(input, legs, 0, input.physical.position, heading, c)
                               : afterWalk(input, legs, 0, input.physical.position,
                                           heading + legs.pieces[0].turn, c));
      }
    }
    int best = 0;
    for (int c = 1; c < choices; ++c) {
      if (scores[static_cast<std::size_t>(c)] > scores[static_cast<std::size_t>(best)] + 1e-9)
        best = c;
    }
    (turning_ ? rotation_ : curvature_) =
        turning_ ? rotationOf(best, input.limits) : curvatureOf(best, input.limits);
  }

  /// The best score from before the corner of leg `leg` on, where rotation `rotation` is chosen.
  double bestWalk(const SteerInput& input, const LikelyWay& legs, int leg, glm::dvec2 position,
                  double heading, int rotation) const {
    const double turn = legs.pieces[static_cast<std::size_t>(leg)].turn;
    const double turned =
        std::abs(turn) > kSmallestBend ? turn / rotationOf(rotation, input.limits) : turn;
    double best = 0.0;
    for (int c = 0; c < kCurvatures; ++c) {
      best = std::max(best, afterWalk(input, legs, leg, position, heading + turned, c));
    }
    return best;
  }

  /// The score of walking leg `leg` under curvature `choice` and the best from there on.
  double afterWalk(const SteerInput& input, const LikelyWay& legs, int leg, glm::dvec2 position,
                   double heading, int choice) const {
    const double curvature = curvatureOf(choice, input.limits);
    for (double left = legs.pieces[static_cast<std::size_t>(leg)].length; left > 1e-6;) {
      const ThoughtStep step =
          stepInThought(input.space, position, heading, std::min(left, 1.0), curvature, thought_);
      position = step.position;
      heading = step.heading;
      left -= step.walked;
      if (step.reset) return 0.5 * (walkedShare(legs, leg, left));
    }
    if (leg + 1 == legs.count) {
      const double free = input.space.distanceAlong(position, directionOf(heading));
      return 0.5 + 0.5 * -std::expm1(-free / kEnough);
    }
    const bool corner =
        std::abs(legs.pieces[static_cast<std::size_t>(leg + 1)].turn) > kSmallestBend;
    double best = 0.0;
    for (int r = 0; r < (corner ? kRotations : 1); ++r) {
      best = std::max(best, bestWalk(input, legs, leg + 1, position, heading, r));
    }
    return best;
  }

  /// How much of the whole way lies behind somebody with `left` metres of `leg` to go.
  static double walkedShare(const LikelyWay& legs, int leg, double left) {
    double all = 0.0, behind = 0.0;
    for (int i = 0; i < legs.count; ++i) {
      const double length = legs.pieces[static_cast<std::size_t>(i)].length;
      all += length;
      if (i <= leg) behind += length;
    }
    return all > 0.0 ? std::clamp((behind - left) / all, 0.0, 1.0) : 0.0;
  }

  ForceSettings settings_;
  RoomValueSettings thought_;  // how stepInThought stops
  double untilPlan_ = 0.0;
  double curvature_ = 0.0;
  double rotation_ = 1.0;
  bool turning_ = false;
};

}  // namespace

std::unique_ptr<Controller> makeForce(const ForceSettings& settings) {
  return std::make_unique<Force>(settings);
}

}  // namespace forewalk::rdw
