#include "rdw/predictive.h"

#include <algorithm>
#include <cmath>

namespace forewalk::rdw {

namespace {

using prediction::PredictionGraph;

constexpr double kLongestPiece = 2.0;   // metres
constexpr double kSmallestBend = 0.17;  // radians; smaller bends are walked, not turned
constexpr double kNearestBend = 0.8;    // metres; a nearer bend says little about the direction
constexpr int kMostCorners = 24;  // of a way, nearest the user; the rest lies beyond the reach

double dot(glm::dvec2 a, glm::dvec2 b) { return a.x * b.x + a.y * b.y; }
double lengthOf(glm::dvec2 v) { return std::sqrt(dot(v, v)); }
glm::dvec2 unit(glm::dvec2 v) {
  const double length = lengthOf(v);
  return length > 1e-9 ? v / length : glm::dvec2(0.0);
}

/// A way's corners up to the reach, the user first.
struct Corners {
  std::array<glm::dvec2, kMostCorners + 2> points;
  int count = 0;
};

Corners cornersOf(const PredictionGraph& graph, prediction::NodeId id, double reach) {
  const prediction::Node& node = graph.node(id);
  // Corners are chained from the far end; of a long chain only the near end is wanted.
  std::array<glm::dvec2, kMostCorners> chain;
  int pushed = 0;
  glm::dvec2 beyond(node.plan);
  for (std::uint32_t c = node.corner; c != 0; c = graph.corners[c].previous) {
    if (graph.corners[c].distance > reach) {
      beyond = glm::dvec2(graph.corners[c].plan);
      continue;
    }
    if (pushed == kMostCorners) {
      // Too many bends within reach: the furthest is forgotten.
      beyond = chain[0];
      std::move(chain.begin() + 1, chain.end(), chain.begin());
      --pushed;
    }
    chain[static_cast<std::size_t>(pushed++)] = glm::dvec2(graph.corners[c].plan);
  }
  Corners corners;
  corners.points[0] = glm::dvec2(graph.source.plan);
  corners.count = 1;
  for (int i = pushed - 1; i >= 0; --i) {
    corners.points[static_cast<std::size_t>(corners.count++)] = chain[static_cast<std::size_t>(i)];
  }
  corners.points[static_cast<std::size_t>(corners.count++)] = beyond;
  return corners;
}

/// The point at arc length `s` along the corners; the last one beyond their end.
glm::dvec2 pointAt(const Corners& corners, double s) {
  for (int i = 1; i < corners.count; ++i) {
    const glm::dvec2 a = corners.points[static_cast<std::size_t>(i - 1)];
    const glm::dvec2 b = corners.points[static_cast<std::size_t>(i)];
    const double length = lengthOf(b - a);
    if (s <= length && length > 0.0) return a + (s / length) * (b - a);
    s -= length;
  }
  return corners.points[static_cast<std::size_t>(corners.count - 1)];
}

LikelyWay asWay(const Corners& corners, glm::dvec2 facing, double reach) {
  LikelyWay way;
  glm::dvec2 heading = facing;
  double left = reach;
  double pendingTurn = 0.0;
  for (int i = 1; i < corners.count && left > 0.0 && way.count < LikelyWay::kMostPieces; ++i) {
    const glm::dvec2 leg = corners.points[static_cast<std::size_t>(i)] -
                           corners.points[static_cast<std::size_t>(i - 1)];
    double length = std::min(lengthOf(leg), left);
    if (length < 1e-3) continue;
    pendingTurn += angleBetween(heading, leg);
    heading = leg;
    left -= length;
    const int pieces = static_cast<int>(std::ceil(length / kLongestPiece));
    for (int p = 0; p < pieces && way.count < LikelyWay::kMostPieces; ++p) {
      way.pieces[static_cast<std::size_t>(way.count++)] = {pendingTurn, length / pieces};
      pendingTurn = 0.0;
    }
  }
  return way;
}

double turnsOf(const LikelyWay& way) {
  double sum = 0.0;
  for (int i = 0; i < way.count; ++i) sum += way.pieces[static_cast<std::size_t>(i)].turn;
  return sum;
}

/// How likely a way is, by its direction over the first metres; of a way straight ahead: 1.
/// `sense` is zero for somebody who walks, else the way they turn on the spot.
double likelihood(glm::dvec2 way, glm::dvec2 direction, glm::dvec2 facing, double sense,
                  const PredictiveSettings& settings) {
  if (sense == 0.0) {
    return std::exp(settings.agreement * (dot(unit(way), direction) - 1.0));
  }
  // A turn goes on to the next ways round; hardly anybody turns back. What lies nearly behind may
  // have been passed, or be what the turn is for.
  constexpr double kBehind = -2.6;    // radians
  constexpr double kTurnsBack = 8.0;  // 1/radian
  const double left = angleBetween(facing, way) * (sense > 0.0 ? 1.0 : -1.0);
  if (left < kBehind) return std::exp(kBehind / settings.turnDecay);
  return std::exp(left < 0.0 ? kTurnsBack * left : -left / settings.turnDecay);
}

/// One more way; with the table full the unlikeliest one makes room.
LikelyWay& slotFor(WaysAhead& ahead) {
  if (ahead.count < WaysAhead::kMost) return ahead.ways[static_cast<std::size_t>(ahead.count++)];
  return *std::min_element(
      ahead.ways.begin(), ahead.ways.end(),
      [](const LikelyWay& a, const LikelyWay& b) { return a.weight < b.weight; });
}

}  // namespace

WaysAhead waysAhead(const PredictionGraph* graph, glm::dvec2 direction, glm::dvec2 facing,
                    const PredictiveSettings& settings) {
  WaysAhead ahead;
  const double sense = dot(facing, direction) < 1.0 - 1e-12 ? angleBetween(facing, direction) : 0.0;
  std::array<glm::dvec2, WaysAhead::kMost> near{};
  std::array<glm::dvec2, WaysAhead::kMost> far{};
  std::array<double, WaysAhead::kMost> best{};
  glm::dvec2 mean(0.0);
  double total = 0.0;
  if (graph != nullptr) {
    const glm::dvec2 source(graph->source.plan);
    for (prediction::NodeId terminal : graph->terminals) {
      const double distance = static_cast<double>(graph->node(terminal).distance);
      if (distance < 0.3) continue;  // to where the user stands already
      const Corners corners = cornersOf(*graph, terminal, settings.reach);
      // A bend within reach must not make the way up to it look unlikely.
      const double bendAt = lengthOf(corners.points[1] - source);
      const double reach =
          std::min(std::clamp(bendAt, kNearestBend, settings.agreementReach), distance);
      const glm::dvec2 there = pointAt(corners, reach);
      // A way that ends at once is a corner of the room rather than a destination.
      const double weight = likelihood(there - source, direction, facing, sense, settings) *
                            std::min(1.0, distance / settings.agreementReach);
      total += weight;
      mean += weight * (there - source) / reach;

      const glm::dvec2 beyond = pointAt(corners, 2.0 * settings.agreementReach);
      int slot = -1;
      for (int i = 0; i < ahead.count && slot < 0; ++i) {
        const auto k = static_cast<std::size_t>(i);
        if (lengthOf(near[k] - there) < 0.5 && lengthOf(far[k] - beyond) < 1.0) slot = i;
      }
      if (slot < 0 && ahead.count < WaysAhead::kMost) slot = ahead.count++;
      if (slot < 0) {
        // The unlikeliest one makes room, its weight lost with it.
        int least = 0;
        for (int i = 1; i < ahead.count; ++i) {
          if (ahead.ways[static_cast<std::size_t>(i)].weight <
              ahead.ways[static_cast<std::size_t>(least)].weight)
            least = i;
        }
        if (ahead.ways[static_cast<std::size_t>(least)].weight >= weight) continue;
        slot = least;
        ahead.ways[static_cast<std::size_t>(slot)].weight = 0.0;
        best[static_cast<std::size_t>(slot)] = 0.0;
      }
      const auto k = static_cast<std::size_t>(slot);
      const double merged = ahead.ways[k].weight + weight;
      // Of ways that run together the longest speaks for all.
      const double merit = std::min(distance, settings.reach) + 1e-3 * weight;
      if (merit > best[k]) {
        best[k] = merit;
        near[k] = there;
        far[k] = beyond;
        ahead.ways[k] = asWay(corners, facing, settings.reach);
      }
      ahead.ways[k].weight = merged;
    }
  }
  if (ahead.count > 0 && sense == 0.0) {
    // Goals lie beside ways too: who walks where no way leads will go on for a while.
    LikelyWay& straight = slotFor(ahead);
    straight = LikelyWay{};
    straight.pieces[0] = {0.0, settings.straightOnLength};
    straight.count = 1;
    straight.weight = settings.straightOn;
    mean += settings.straightOn * direction;
    total += settings.straightOn;
  }
  double kept = 0.0;
  for (int i = 0; i < ahead.count; ++i) kept += ahead.ways[static_cast<std::size_t>(i)].weight;
  if (!(kept > 1e-12)) {
    ahead.count = 1;
    ahead.ways[0] = LikelyWay{};
    double turn = angleBetween(facing, direction);
    for (double left = settings.reach; left > 1e-9 && ahead.ways[0].count < LikelyWay::kMostPieces;
         left -= kLongestPiece) {
      ahead.ways[0].pieces[static_cast<std::size_t>(ahead.ways[0].count++)] = {
          turn, std::min(left, kLongestPiece)};
      turn = 0.0;
    }
    ahead.ways[0].weight = 1.0;
    ahead.meanDirection = direction;
    return ahead;
  }
  for (int i = 0; i < ahead.count; ++i) {
    LikelyWay& way = ahead.ways[static_cast<std::size_t>(i)];
    way.weight /= kept;
    ahead.meanTurn += way.weight * turnsOf(way);
  }
  ahead.meanDirection = unit(mean / total);
  return ahead;
}

namespace {

constexpr int kCurvatures = 3;  // right, none, left
constexpr int kRotations = 5;   // from the lowest gain to the highest, the third neutral
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
    const Motion& motion = input.motion;
    const glm::dvec2 facing = directionOf(input.virtualPose.heading);
    glm::dvec2 travel =
        motion.walking ? input.redirection.directionToVirtual(motion.walkingDirection) : facing;
    // Somebody who turns on the spot will walk where the turn leads: half a second of it.
    if (turning) travel = rotated(facing, std::clamp(0.5 * motion.turnRate, -1.2, 1.2));
    const glm::dvec2 from = turning ? facing : travel;
    plan_.ahead = waysAhead(input.graph, travel, from, settings_);
    plan_.costs = ruleCosts(input, turning, from, travel, plan_.ahead);
    plan_.position = input.physical.position;
    plan_.heading = headingOf(input.redirection.directionToPhysical(from));
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
