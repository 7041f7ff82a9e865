#include "rdw/predictive.h"

#include <algorithm>
#include <cmath>

namespace forewalk::rdw {

namespace {

using prediction::PredictionGraph;

constexpr double kLongestPiece = 2.0;   // metres
constexpr double kSmallestBend = 0.17;  // radians; smaller bends are walked, not turned
constexpr int kMostCorners = 24;  // of a way, nearest the user; the rest lies beyond the reach

double dot(glm::dvec2 a, glm::dvec2 b) { return a.x * b.x + a.y * b.y; }
double lengthOf(glm::dvec2 v) { return std::sqrt(dot(v, v)); }
glm::dvec2 unit(glm::dvec2 v) {
  const double length = lengthOf(v);
  return length > 1e-9 ? v / length : glm::dvec2(0.0);
}

// ---- The ways ahead
// -------------------------------------------------------------------------------

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

// ---- Walking in thought
// ---------------------------------------------------------------------------

/// Somebody in the room, in thought.
struct Walker {
  glm::dvec2 position;
  glm::dvec2 heading;   ///< unit
  double walked = 0.0;  ///< virtual metres from now
  double cost = 0.0;
  int first = 0;  ///< which first choice this one descends from
};

}  // namespace

WaysAhead waysAhead(const PredictionGraph* graph, glm::dvec2 direction, glm::dvec2 facing,
                    const PredictiveSettings& settings) {
  WaysAhead ahead;
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
      const double reach = std::min(settings.agreementReach, distance);
      const glm::dvec2 there = pointAt(corners, reach);
      const double cosine = dot(unit(there - source), direction);
      // A way that ends at once is a corner of the room rather than a destination.
      const double weight = std::exp(settings.agreement * (cosine - 1.0)) *
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

class Predictive final : public Controller {
 public:
  Predictive(SteerRule rule, const PredictiveSettings& settings)
      : rule_(rule), settings_(settings) {}

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
    if (turning != planned_ || untilPlan_ <= 0.0) {
      plan(input, turning);
      planned_ = turning;
      untilPlan_ = settings_.replanEvery;
    }

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
  }

  std::string_view name() const override {
    return rule_ == SteerRule::kCentre ? "s2c-predictive" : "s2o-predictive";
  }
  bool wantsPrediction() const override { return true; }

 private:
  static constexpr int kChoices = 3;
  static constexpr int kBeam = 4;       // survivors per first choice and piece
  static constexpr double kStep = 0.25;  // metres between looks at the border

  void plan(const SteerInput& input, bool turning) {
    const Motion& motion = input.motion;
    const glm::dvec2 facing = directionOf(input.virtualPose.heading);
    glm::dvec2 travel =
        motion.walking ? input.redirection.directionToVirtual(motion.walkingDirection) : facing;
    // Somebody who turns on the spot will walk where the turn leads: half a second of it.
    if (turning) travel = rotated(facing, std::clamp(0.5 * motion.turnRate, -1.2, 1.2));
    const glm::dvec2 from = turning ? facing : travel;
    const WaysAhead ahead = waysAhead(input.graph, travel, from, settings_);

    const glm::dvec2 meanDirection =
        ahead.meanDirection == glm::dvec2(0.0) ? travel : ahead.meanDirection;
    const glm::dvec2 expected = input.redirection.directionToPhysical(meanDirection);
    target_ = targetFor(input, expected, ahead.meanTurn);

    std::array<double, kChoices> expectedCost{};
    const glm::dvec2 heading = input.redirection.directionToPhysical(from);
    for (int i = 0; i < ahead.count; ++i) {
      const LikelyWay& way = ahead.ways[static_cast<std::size_t>(i)];
      std::array<double, kChoices> cost;
      walkInThought(input, way, heading, turning, cost);
      for (int c = 0; c < kChoices; ++c) {
        expectedCost[static_cast<std::size_t>(c)] += way.weight * cost[static_cast<std::size_t>(c)];
      }
    }
    // Ties go to the side that the target rule asks for.
    const double bearing = angleBetween(expected, target_ - input.physical.position);
    const int towardTarget =
        turning ? (bearing * motion.turn > 0.0 ? 0 : 2) : (bearing > 0.0 ? 2 : 0);
    int best = towardTarget;
    for (int c = 0; c < kChoices; ++c) {
      if (expectedCost[static_cast<std::size_t>(c)] <
          expectedCost[static_cast<std::size_t>(best)] - 1e-6)
        best = c;
    }
    if (turning) {
      rotation_ = rotationOf(best, input.limits);
    } else {
      curvature_ = curvatureOf(best, input.limits);
    }
  }

  /// Choice 0, 1, 2 as a gain. A low rotation gain turns the body further than the eyes.
  static double rotationOf(int choice, const GainLimits& limits) {
    return choice == 0   ? static_cast<double>(limits.rotationMin)
           : choice == 1 ? 1.0
                         : static_cast<double>(limits.rotationMax);
  }
  static double curvatureOf(int choice, const GainLimits& limits) {
    return (choice - 1) * static_cast<double>(limits.curvatureMax);
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
    orbitSense_ = clockwise < counterClockwise ? -1 : 1;
    return orbitSense_ < 0 ? targets.clockwise : targets.counterClockwise;
  }

  /// The least cost of walking `way` after each of the three first choices, the later ones free.
  void walkInThought(const SteerInput& input, const LikelyWay& way, glm::dvec2 heading,
                     bool turning, std::array<double, kChoices>& cost) const {
    std::array<Walker, kChoices * kBeam> beam;
    std::array<Walker, kChoices * kBeam * 9> next;
    int alive = 0;
    for (int c = 0; c < kChoices; ++c) {
      beam[static_cast<std::size_t>(alive++)] = {input.physical.position, heading, 0.0, 0.0, c};
    }
    for (int p = 0; p < way.count; ++p) {
      const LikelyWay::Piece& piece = way.pieces[static_cast<std::size_t>(p)];
      int born = 0;
      for (int i = 0; i < alive; ++i) {
        const Walker& walker = beam[static_cast<std::size_t>(i)];
        const bool bends = std::abs(piece.turn) > kSmallestBend;
        for (int r = 0; r < kChoices; ++r) {
          if (p == 0 && turning ? r != walker.first : !bends && r != 1) continue;
          for (int c = 0; c < kChoices; ++c) {
            if (p == 0 && !turning && c != walker.first) continue;
            Walker child = walker;
            child.heading = rotated(walker.heading, piece.turn / rotationOf(r, input.limits));
            walkPiece(input.space, piece.length, curvatureOf(c, input.limits), child);
            next[static_cast<std::size_t>(born++)] = child;
          }
        }
      }
      alive = survivors(input, next, born, beam);
    }
    cost.fill(INFINITY);
    for (int i = 0; i < alive; ++i) {
      const Walker& walker = beam[static_cast<std::size_t>(i)];
      double& least = cost[static_cast<std::size_t>(walker.first)];
      least = std::min(least, walker.cost + prospect(input, walker));
    }
  }

  /// Keeps the kBeam best of each first choice.
  int survivors(const SteerInput& input, const std::array<Walker, kChoices * kBeam * 9>& next,
                int born, std::array<Walker, kChoices * kBeam>& beam) const {
    std::array<double, kChoices * kBeam * 9> value;
    for (int i = 0; i < born; ++i) {
      value[static_cast<std::size_t>(i)] = next[static_cast<std::size_t>(i)].cost +
                                           prospect(input, next[static_cast<std::size_t>(i)]);
    }
    int alive = 0;
    for (int first = 0; first < kChoices; ++first) {
      for (int k = 0; k < kBeam; ++k) {
        int best = -1;
        for (int i = 0; i < born; ++i) {
          if (next[static_cast<std::size_t>(i)].first != first) continue;
          if (best < 0 ||
              value[static_cast<std::size_t>(i)] < value[static_cast<std::size_t>(best)])
            best = i;
        }
        if (best < 0 || value[static_cast<std::size_t>(best)] == INFINITY) break;
        beam[static_cast<std::size_t>(alive++)] = next[static_cast<std::size_t>(best)];
        value[static_cast<std::size_t>(best)] = INFINITY;
      }
    }
    return alive;
  }

  /// Walks straight in virtual space, curved in the room; a reset turns the body round and costs.
  void walkPiece(const TrackedSpace& space, double length, double curvature, Walker& walker) const {
    const int steps = std::max(1, static_cast<int>(std::ceil(length / kStep)));
    const double step = length / steps;
    const double c = std::cos(0.5 * curvature * step);
    const double s = std::sin(0.5 * curvature * step);
    const auto halfTurn = [&](glm::dvec2 v) {
      return glm::dvec2(c * v.x - s * v.y, s * v.x + c * v.y);
    };
    for (int i = 0; i < steps; ++i) {
      const glm::dvec2 chord = halfTurn(walker.heading);
      const glm::dvec2 ahead = walker.position + (step + settings_.stopDistance) * chord;
      if (!space.contains(ahead)) {
        // The further off, the more may happen before.
        walker.cost += std::exp(-walker.walked / 12.0);
        walker.heading = -walker.heading;
        const glm::dvec2 back = halfTurn(walker.heading);
        walker.position += step * back;
        walker.heading = halfTurn(back);
      } else {
        walker.position += step * chord;
        walker.heading = halfTurn(chord);
      }
      walker.walked += step;
    }
  }

  /// What the pose at the end of a walk promises: resets to come, by the free way ahead and by how
  /// far the target rule would have to turn it.
  double prospect(const SteerInput& input, const Walker& walker) const {
    const double free = input.space.distanceAlong(walker.position, walker.heading);
    glm::dvec2 to = input.space.centre() - walker.position;
    if (rule_ == SteerRule::kOrbit) {
      const OrbitTargets targets = orbitTargets(walker.position, walker.heading, input.space);
      to = (orbitSense_ < 0 ? targets.clockwise : targets.counterClockwise) - walker.position;
    }
    const double off = std::abs(angleBetween(walker.heading, to));
    return std::exp(-walker.walked / 12.0) * (std::exp(-free / 3.0) + 0.15 * off / kPi);
  }

  float translationFor(const SteerInput& input) const {
    const double free =
        input.space.distanceAlong(input.physical.position, input.motion.walkingDirection);
    // Toward the nearer half of the room the body walks less than the eyes, else the other way
    // round.
    return free < input.space.clearance() ? input.limits.translationMax : 1.0f;
  }

  SteerRule rule_;
  PredictiveSettings settings_;
  SteerToSettings core_;
  CentreTarget centre_;
  glm::dvec2 target_{0.0};
  int orbitSense_ = 1;
  double untilPlan_ = 0.0;
  bool planned_ = false;
  double curvature_ = 0.0;
  double rotation_ = 1.0;
  double smoothed_ = 0.0;
};

}  // namespace

std::unique_ptr<Controller> makePredictive(SteerRule rule, const PredictiveSettings& settings) {
  return std::make_unique<Predictive>(rule, settings);
}

}  // namespace forewalk::rdw
