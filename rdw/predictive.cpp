#include "rdw/predictive.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "rdw/ways_ahead.h"

namespace forewalk::rdw {

namespace {

constexpr double kSmallestBend = 0.17;  // radians; smaller bends are walked, not turned
constexpr int kCurvatures = 3;          // right, none, left
constexpr int kRotations = 5;           // from the lowest gain to the highest, the third neutral
constexpr int kMostChoices = kRotations;
constexpr int kBeam = 2;  // walkers kept of each first choice, piece after piece

using Costs = std::array<double, kMostChoices>;

/// A low rotation gain turns the body further than the eyes.
double rotationOf(int choice, const GainLimits& limits) {
  const double low = static_cast<double>(limits.rotationMin);
  const double high = static_cast<double>(limits.rotationMax);
  return choice < 2 ? low + 0.5 * choice * (1.0 - low) : 1.0 + 0.5 * (choice - 2) * (high - 1.0);
}

double curvatureOf(int choice, const GainLimits& limits) {
  return (choice - 1) * static_cast<double>(limits.curvatureMax);
}

/// Somebody in the room, in thought.
struct Walker {
  glm::dvec2 position;
  double heading;         ///< radians
  int first;              ///< which first choice this one descends from
  double walked = 0.0;    ///< virtual metres from now
  double faithful = 1.0;  ///< how likely the user still follows the way that is thought of
  double cost = 0.0;      ///< up to here, and of having left the way before
  double value = 0.0;     ///< cost, and what the pose promises
};

class Predictive final : public Controller {
 public:
  Predictive(SteerRule rule, const PredictiveSettings& settings)
      : rule_(rule), settings_(settings) {}

  void prepare(const TrackedSpace& space, const GainLimits& limits) override {
    room_ = RoomValue(space, limits, rule_, settings_.room);
  }

  Gains steer(const SteerInput& input) override {
    const Motion& motion = input.motion;
    if (!motion.usable() || motion.dt <= 0.0) return {};
    untilPlan_ -= motion.dt;

    // What acts in this frame: the turn of the head, or the step.
    const double curvatureRoom =
        motion.walking ? motion.distance * static_cast<double>(input.limits.curvatureMax) : 0.0;
    const double rotationRoom =
        std::abs(motion.turnRate) >= core_.turningRate
            ? std::abs(motion.turn) * (1.0 - static_cast<double>(input.limits.rotationMin))
            : 0.0;
    if (curvatureRoom == 0.0 && rotationRoom == 0.0) return {};
    const bool turning = rotationRoom > curvatureRoom;
    if (turning != plan_.turning || untilPlan_ <= 0.0) {
      const bool changed = turning != plan_.turning;
      startPlan(input, turning);
      // What was chosen for a walk says nothing of a turn: the target rule decides until the ways
      // are thought of.
      if (changed) choose(input.limits);
      untilPlan_ = turning ? 0.5 * settings_.replanEvery : settings_.replanEvery;
    }
    if (plan_.pending) think(input);

    Gains gains;
    if (turning) {
      gains.rotation = static_cast<float>(rotation_);
    } else {
      const double kept = std::pow(1.0 - core_.smoothing, 60.0 * motion.dt);
      smoothed_ = kept * smoothed_ + (1.0 - kept) * curvature_;
      gains.curvature = static_cast<float>(smoothed_);
    }
    if (settings_.translation && motion.walking) gains.translation = translationFor(input);
    return clamped(gains, input.limits);
  }

  void restart() override {
    centre_.restart();
    untilPlan_ = 0.0;
    smoothed_ = 0.0;
    plan_ = {};
    curvature_ = 0.0;
    rotation_ = 1.0;
  }

  std::string_view name() const override {
    return rule_ == SteerRule::kCentre ? "s2c-predictive" : "s2o-predictive";
  }
  bool wantsPrediction() const override { return true; }
  bool wantsLikelihoods() const override { return settings_.ways.likelihood > 0.0; }

 private:
  /// A plan in the making: ways are walked in thought in the frames after it was started, so that
  /// no frame costs much more than the others.
  struct Plan {
    WaysAhead ahead;
    Costs costs{};
    glm::dvec2 position{0.0};  // physical, when it was started
    double heading = 0.0;
    int next = 0;  // the way to think of
    bool turning = false;
    bool pending = false;
  };

  void startPlan(const SteerInput& input, bool turning) {
    const Travel travel = travelOf(input.motion, input.virtualPose, input.redirection, turning);
    plan_.ahead =
        waysAhead(input.graph, input.likelihoods, travel.direction, travel.facing, settings_.ways);
    plan_.costs = ruleCosts(input, turning, travel.facing, travel.direction, plan_.ahead);
    plan_.position = input.physical.position;
    plan_.heading = headingOf(input.redirection.directionToPhysical(travel.facing));
    plan_.next = 0;
    plan_.turning = turning;
    plan_.pending = true;
  }

  /// Thinks of as many ways as this frame's share of the time for a plan; after the last, chooses.
  void think(const SteerInput& input) {
    const int count = room_.empty() ? 0 : plan_.ahead.count;
    const double share = input.motion.dt / kThinkingTime;
    int left = std::max(1, static_cast<int>(std::ceil(share * static_cast<double>(count))));
    for (; plan_.next < count && left > 0; ++plan_.next) {
      const LikelyWay& way = plan_.ahead.ways[static_cast<std::size_t>(plan_.next)];
      if (way.weight < kUnlikely) continue;
      const Costs walked = walkInThought(input, way);
      for (std::size_t c = 0; c < walked.size(); ++c) plan_.costs[c] += way.weight * walked[c];
      --left;
    }
    if (plan_.next < count) return;
    choose(input.limits);
    plan_.pending = false;
  }

  /// Of choices that are as good the neutral one.
  void choose(const GainLimits& limits) {
    const int count = plan_.turning ? kRotations : kCurvatures;
    int best = count / 2;
    for (int c = 0; c < count; ++c) {
      if (plan_.costs[static_cast<std::size_t>(c)] < plan_.costs[static_cast<std::size_t>(best)]) {
        best = c;
      }
    }
    if (plan_.turning) {
      rotation_ = rotationOf(best, limits);
    } else {
      curvature_ = curvatureOf(best, limits);
    }
  }

  /// What the target rule has against each choice: the bearing of its target after the turn, or
  /// whether the curvature leads away from it.
  Costs ruleCosts(const SteerInput& input, bool turning, glm::dvec2 from, glm::dvec2 travel,
                  const WaysAhead& ahead) {
    const glm::dvec2 mean = ahead.meanDirection == glm::dvec2(0.0) ? travel : ahead.meanDirection;
    const glm::dvec2 expected = input.redirection.directionToPhysical(mean);
    const glm::dvec2 toTarget =
        targetFor(input, expected, ahead.meanTurn) - input.physical.position;
    const glm::dvec2 heading = input.redirection.directionToPhysical(from);
    const double turnLeft = angleBetween(from, mean);
    Costs costs{};
    if (turning) {
      for (int c = 0; c < kRotations; ++c) {
        const glm::dvec2 after = rotated(heading, turnLeft / rotationOf(c, input.limits));
        costs[static_cast<std::size_t>(c)] =
            settings_.rule * std::abs(angleBetween(after, toTarget)) / kPi;
      }
    } else {
      // Damped near the right bearing, as the reactive rule is.
      const double side =
          std::clamp(angleBetween(expected, toTarget) / core_.dampedBearing, -1.0, 1.0);
      for (int c = 0; c < kCurvatures; ++c) {
        costs[static_cast<std::size_t>(c)] = -0.1 * settings_.rule * (c - 1) * side;
      }
    }
    return costs;
  }

  glm::dvec2 targetFor(const SteerInput& input, glm::dvec2 expected, double meanTurn) {
    const glm::dvec2 position = input.physical.position;
    if (rule_ == SteerRule::kCentre) return centre_.target(position, expected, input.space);
    const OrbitTargets targets = orbitTargets(position, expected, input.space);
    // Left turns ahead wind the body's path to the left too, along a counter-clockwise orbit.
    const double counterClockwise =
        std::abs(angleBetween(expected, targets.counterClockwise - position)) - 0.5 * meanTurn;
    const double clockwise =
        std::abs(angleBetween(expected, targets.clockwise - position)) + 0.5 * meanTurn;
    return clockwise < counterClockwise ? targets.clockwise : targets.counterClockwise;
  }

  /// The least cost of walking `way` after each of the first choices, the later ones free.
  Costs walkInThought(const SteerInput& input, const LikelyWay& way) const {
    const bool turning = plan_.turning;
    std::array<Walker, kMostChoices * kBeam> beam;
    std::array<Walker, kMostChoices * kBeam * kCurvatures> next;
    int alive = 0;
    for (int c = 0; c < (turning ? kRotations : kCurvatures); ++c) {
      beam[static_cast<std::size_t>(alive++)] = {plan_.position, plan_.heading, c};
    }
    for (int p = 0; p < way.count; ++p) {
      const LikelyWay::Piece& piece = way.pieces[static_cast<std::size_t>(p)];
      int born = 0;
      for (int i = 0; i < alive; ++i) {
        Walker walker = beam[static_cast<std::size_t>(i)];
        if (p == 0 && turning) {
          walker.heading += piece.turn / rotationOf(walker.first, input.limits);
        } else {
          walker.heading += cornerInThought(walker, piece.turn, input.limits);
        }
        for (int c = 0; c < kCurvatures; ++c) {
          if (p == 0 && !turning && c != walker.first) continue;
          next[static_cast<std::size_t>(born++)] =
              walkPiece(input.space, piece.length, curvatureOf(c, input.limits), walker);
        }
      }
      alive = survivors(next, born, beam);
    }
    Costs costs{};
    // The best of each first choice comes first, so it is written last.
    for (int i = alive - 1; i >= 0; --i) {
      const Walker& walker = beam[static_cast<std::size_t>(i)];
      costs[static_cast<std::size_t>(walker.first)] = walker.value;
    }
    return costs;
  }

  /// The physical turn that a virtual one becomes: in corners the best that gains can make of it.
  double cornerInThought(const Walker& walker, double turn, const GainLimits& limits) const {
    if (std::abs(turn) <= kSmallestBend) return turn;
    double best = turn;
    double least = INFINITY;
    for (int r = 0; r < kRotations; ++r) {
      const double physical = turn / rotationOf(r, limits);
      const double value = room_.at(walker.position, walker.heading + physical);
      if (value < least) {
        least = value;
        best = physical;
      }
    }
    return best;
  }

  /// Walks straight in virtual space, curved in the room; a reset turns the body round and costs.
  Walker walkPiece(const TrackedSpace& space, double length, double curvature,
                   Walker walker) const {
    for (double left = length; left > 1e-6;) {
      const ThoughtStep step =
          stepInThought(space, walker.position, walker.heading, std::min(left, kLongestStep),
                        curvature, settings_.room);
      walker.position = step.position;
      walker.heading = step.heading;
      walker.walked += step.walked;
      left -= step.walked;
      if (step.reset) walker.cost += walker.faithful * discount(walker);
    }
    const double onward = discount(walker) * room_.at(walker.position, walker.heading);
    walker.value = walker.cost + walker.faithful * onward;
    const double strays = -std::expm1(-length / settings_.faith);
    walker.cost += walker.faithful * strays * onward;
    walker.faithful *= 1.0 - strays;
    return walker;
  }

  double discount(const Walker& walker) const {
    return std::exp(-walker.walked / settings_.room.foresight);
  }

  /// Keeps the kBeam best of each first choice, the best before the next. Spoils `next`.
  static int survivors(std::array<Walker, kMostChoices * kBeam * kCurvatures>& next, int born,
                       std::array<Walker, kMostChoices * kBeam>& beam) {
    int alive = 0;
    for (int first = 0; first < kMostChoices; ++first) {
      for (int k = 0; k < kBeam; ++k) {
        int best = -1;
        for (int i = 0; i < born; ++i) {
          const Walker& walker = next[static_cast<std::size_t>(i)];
          if (walker.first == first &&
              (best < 0 || walker.value < next[static_cast<std::size_t>(best)].value))
            best = i;
        }
        if (best < 0) break;
        beam[static_cast<std::size_t>(alive++)] = next[static_cast<std::size_t>(best)];
        next[static_cast<std::size_t>(best)].first = -1;
      }
    }
    return alive;
  }

  float translationFor(const SteerInput& input) const {
    const double free =
        input.space.distanceAlong(input.physical.position, input.motion.walkingDirection);
    // Toward the nearer half of the room the body walks less than the eyes, else the other way
    // round.
    return free < input.space.clearance() ? input.limits.translationMax : 1.0f;
  }

  static constexpr double kUnlikely = 0.02;      // weight of ways that are not worth a thought
  static constexpr double kLongestStep = 1.0;    // metres between looks at the border
  static constexpr double kThinkingTime = 0.04;  // seconds over which a plan is spread

  SteerRule rule_;
  PredictiveSettings settings_;
  SteerToSettings core_;
  CentreTarget centre_;
  RoomValue room_;
  double untilPlan_ = 0.0;
  Plan plan_;
  double curvature_ = 0.0;
  double rotation_ = 1.0;
  double smoothed_ = 0.0;
};

}  // namespace

std::unique_ptr<Controller> makePredictive(SteerRule rule, const PredictiveSettings& settings) {
  return std::make_unique<Predictive>(rule, settings);
}

}  // namespace forewalk::rdw
