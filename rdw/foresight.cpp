#include "rdw/foresight.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

namespace forewalk::rdw {

namespace {

constexpr double kTurningRate = 1.5 * kPi / 180.0;  // rad/s; slower head turns are not scaled
constexpr double kIndifferent = 1e-9;  // resets; choices closer than this are equally good

/// Somebody turns on the spot, nobody knows how far: a few ends of the turn, alike.
WaysAhead turnsAhead(double turned, double sense, double reach) {
  WaysAhead ahead;
  ahead.count = WaysAhead::kMost;
  const double most = std::max(0.3, kPi - std::abs(turned));
  for (int i = 0; i < ahead.count; ++i) {
    LikelyWay& way = ahead.ways[static_cast<std::size_t>(i)];
    way.weight = 1.0 / ahead.count;
    way.count = static_cast<int>(std::ceil(reach));
    for (int p = 0; p < way.count; ++p) {
      way.pieces[static_cast<std::size_t>(p)] = {0.0, reach / way.count};
    }
    way.pieces[0].turn = sense * most * (i + 0.5) / ahead.count;
    ahead.meanTurn += way.weight * way.pieces[0].turn;
  }
  return ahead;
}

class Foresight final : public Controller {
 public:
  explicit Foresight(const ForesightSettings& settings) : settings_(settings) {}

  void prepare(const TrackedSpace& space, const GainLimits& limits) override {
    settings_.building.translation = settings_.translation;
    settings_.plane.translation = settings_.translation;
    building_ = RoomValue(space, limits, SteerRule::kCentre, settings_.building);
    plane_ = RoomValue(space, limits, SteerRule::kCentre, settings_.plane);
  }

  Gains steer(const SteerInput& input) override {
    const Motion& motion = input.motion;
    if (!motion.usable() || motion.dt <= 0.0 || plane_.empty()) return {};
    untilPlan_ -= motion.dt;
    sideHeld_ += motion.dt;

    // What acts in this frame: the turn of the head, or the step.
    const double bent =
        motion.walking ? motion.distance * static_cast<double>(input.limits.curvatureMax) : 0.0;
    const double scaled =
        std::abs(motion.turnRate) >= kTurningRate
            ? std::abs(motion.turn) * (1.0 - static_cast<double>(input.limits.rotationMin))
            : 0.0;
    const bool acts = bent > 0.0 || scaled > 0.0 || motion.walking;
    if (!acts) {
      turned_ = 0.0;
      return {};
    }
    const bool turning =
        scaled > bent &&
        (!motion.walking ||
         (motion.speed < kStroll && std::abs(motion.turnRate) > kTightestBend * motion.speed));
    turned_ = turning ? turned_ + motion.turn / std::max(0.1, rotation_) : 0.0;
    if (turning != turning_ || untilPlan_ <= 0.0) {
      turning_ = turning;
      plan(input);
      untilPlan_ = turning ? 0.5 * settings_.planEvery : settings_.planEvery;
    }

    Gains gains;
    if (motion.walking) gains.translation = static_cast<float>(translation_);
    if (turning) {
      if (motion.walking) gains.translation = static_cast<float>(translationOf(input));
      gains.rotation = static_cast<float>(rotation_);
      return clamped(gains, input.limits);
    }
    smoothed_ += -std::expm1(-motion.dt / settings_.smoothing) * (curvature_ - smoothed_);
    if (scaled > bent && curvature_ != 0.0) {
      // A bend that is walked: scaling it does more for the side that is wanted than curvature.
      gains.rotation =
          motion.turn * curvature_ > 0.0 ? input.limits.rotationMin : input.limits.rotationMax;
    } else {
      gains.curvature = static_cast<float>(smoothed_);
    }
    return clamped(gains, input.limits);
  }

  void restart() override {
    untilPlan_ = 0.0;
    turned_ = 0.0;
    smoothed_ = 0.0;
    curvature_ = 0.0;
    rotation_ = 1.0;
    translation_ = 1.0;
    turning_ = false;
    side_ = 0;
    sideHeld_ = settings_.sideHeld;
  }

  std::string_view name() const override { return "foresight"; }
  bool wantsPrediction() const override { return true; }
  bool wantsLikelihoods() const override { return true; }
  bool steersWithoutGraph() const override { return true; }

 private:
  void plan(const SteerInput& input) {
    const Travel travel = travelOf(input.motion, input.virtualPose, input.redirection, turning_);
    WaysAhead ahead =
        waysAhead(input.graph, input.likelihoods, travel.direction, travel.facing, settings_.ways);
    const bool known = ahead.known;
    if (!known && turning_) {
      ahead = turnsAhead(turned_, input.motion.turn < 0.0 ? -1.0 : 1.0, settings_.ways.reach);
    }
    const ThoughtPose pose{input.physical.position,
                           headingOf(input.redirection.directionToPhysical(travel.facing))};
    const RoomValueSettings& prior = known ? settings_.building : settings_.plane;
    const WaySearch search(input.space, input.limits, known ? building_ : plane_, prior,
                           settings_.search);
    if (turning_) {
      planTurn(input, search, pose, ahead);
    } else {
      planWalk(input, search, pose, ahead);
    }
  }

  void planTurn(const SteerInput& input, const WaySearch& search, const ThoughtPose& pose,
                const WaysAhead& ahead) {
    std::array<Choice, kRotationChoices> choices;
    std::array<double, kRotationChoices> costs;
    for (int r = 0; r < kRotationChoices; ++r) {
      choices[static_cast<std::size_t>(r)] = {translationOf(input), rotationChoice(r, input.limits),
                                              0.0};
    }
    search.costs(pose, ahead, true, choices, costs);
    rotation_ = choices[best(costs, kRotationChoices / 2)].rotation;
  }

  void planWalk(const SteerInput& input, const WaySearch& search, const ThoughtPose& pose,
                const WaysAhead& ahead) {
    const double curvature = static_cast<double>(input.limits.curvatureMax);
    const double translation = translationOf(input);
    const std::array<Choice, 4> choices{{{translation, 1.0, 0.0},
                                         {translation, 1.0, -curvature},
                                         {translation, 1.0, curvature},
                                         {1.0, 1.0, 0.0}}};
    std::array<double, 4> costs;
    search.costs(pose, ahead, false, choices, costs);
    // A side is left for the other one only after a while.
    if (side_ != 0 && sideHeld_ < settings_.sideHeld) costs[side_ > 0 ? 1 : 2] = INFINITY;
    const Choice& chosen = choices[best(costs, 0)];
    curvature_ = chosen.curvature;
    translation_ = chosen.translation;
    const int side = curvature_ > 0.0 ? 1 : curvature_ < 0.0 ? -1 : 0;
    if (side != 0 && side != side_) {
      // What is left of the other side ends here.
      if (smoothed_ * side < 0.0) smoothed_ = 0.0;
      side_ = side;
      sideHeld_ = 0.0;
    }
  }

  double translationOf(const SteerInput& input) const {
    return settings_.translation ? static_cast<double>(input.limits.translationMax) : 1.0;
  }

  /// Of choices that are as good `preferred`.
  template <std::size_t kCount>
  static std::size_t best(const std::array<double, kCount>& costs, std::size_t preferred) {
    std::size_t least = preferred;
    for (std::size_t c = 0; c < kCount; ++c) {
      if (costs[c] < costs[least] - kIndifferent) least = c;
    }
    return least;
  }

  static constexpr double kStroll = 0.5;        // m/s; who is faster does not turn on the spot
  static constexpr double kTightestBend = 1.0;  // 1/m; a tighter turn is one on the spot

  ForesightSettings settings_;
  RoomValue building_, plane_;
  double untilPlan_ = 0.0;
  double turned_ = 0.0;  // virtual radians since the turn on the spot began
  double curvature_ = 0.0;
  double rotation_ = 1.0;
  double translation_ = 1.0;
  double smoothed_ = 0.0;
  bool turning_ = false;
  int side_ = 0;           // of the last curvature that was not none
  double sideHeld_ = 1.0;  // seconds since it became that
};

}  // namespace

RoomValueSettings buildingValue() {
  RoomValueSettings value;
  value.reset = ThoughtReset::kAnyWay;
  value.rule = 0.0;
  return value;
}

RoomValueSettings openPlaneValue() {
  RoomValueSettings value = buildingValue();
  value.straight = 5.0;
  value.corners = {
      {{0.125 * kPi, 0.25}, {0.375 * kPi, 0.25}, {0.625 * kPi, 0.25}, {0.875 * kPi, 0.25}}};
  return value;
}

std::unique_ptr<Controller> makeForesight(const ForesightSettings& settings) {
  return std::make_unique<Foresight>(settings);
}

}  // namespace forewalk::rdw
