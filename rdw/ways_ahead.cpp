#include "rdw/ways_ahead.h"

#include <algorithm>
#include <cmath>

#include "rdw/pose.h"

namespace forewalk::rdw {

namespace {

using prediction::PredictionGraph;

constexpr double kLongestPiece = 2.0;  // metres
constexpr double kNearestBend = 0.8;   // metres; a nearer bend says little about the direction
constexpr int kMostCorners = 24;       // of a way, nearest the user; the rest lies beyond the reach

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

/// How well a way agrees with the walk, by its direction over the first metres; of a way straight
/// ahead: 1. `sense` is zero for somebody who walks, else the way they turn on the spot.
double agreement(glm::dvec2 way, glm::dvec2 direction, glm::dvec2 facing, double sense,
                 const WaysAheadSettings& settings) {
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

Travel travelOf(const Motion& motion, const PlanarPose& virtualPose, const Redirection& redirection,
                bool turning) {
  constexpr double kFurthest = 1.2;  // radians
  const glm::dvec2 facing = directionOf(virtualPose.heading);
  if (turning) {
    return {facing, rotated(facing, std::clamp(0.5 * motion.turnRate, -kFurthest, kFurthest))};
  }
  const glm::dvec2 direction =
      motion.walking ? redirection.directionToVirtual(motion.walkingDirection) : facing;
  return {direction, direction};
}

WaysAhead waysAhead(const PredictionGraph* graph, const WayLikelihoods& likelihoods,
                    glm::dvec2 direction, glm::dvec2 facing, const WaysAheadSettings& settings) {
  WaysAhead ahead;
  const double sense = dot(facing, direction) < 1.0 - 1e-12 ? angleBetween(facing, direction) : 0.0;
  std::array<glm::dvec2, WaysAhead::kMost> near{};
  std::array<glm::dvec2, WaysAhead::kMost> far{};
  std::array<double, WaysAhead::kMost> best{};
  glm::dvec2 mean(0.0);
  double total = 0.0;
  if (graph != nullptr) {
    const glm::dvec2 source(graph->source.plan);
    double likeliest = 0.0;
    for (const double each : likelihoods.ways) likeliest = std::max(likeliest, each);
    const bool weighed = settings.likelihood > 0.0 && likeliest > 0.0;
    const auto known = [&](std::size_t way) {
      if (!weighed) return 1.0;
      if (way >= likelihoods.ways.size()) return 0.0;
      return std::pow(likelihoods.ways[way] / likeliest, settings.likelihood);
    };
    for (std::size_t ordinal = 0; ordinal < graph->terminals.size(); ++ordinal) {
      const prediction::NodeId terminal = graph->terminals[ordinal];
      const double distance = static_cast<double>(graph->node(terminal).distance);
      if (distance < 0.3) continue;  // to where the user stands already
      const Corners corners = cornersOf(*graph, terminal, settings.reach);
      // A bend within reach must not make the way up to it look unlikely.
      const double bendAt = lengthOf(corners.points[1] - source);
      const double reach =
          std::min(std::clamp(bendAt, kNearestBend, settings.agreementReach), distance);
      const glm::dvec2 there = pointAt(corners, reach);
      // A way that ends at once is a corner of the room rather than a destination.
      const double weight = known(ordinal) *
                            agreement(there - source, direction, facing, sense, settings) *
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
  ahead.known = true;
  return ahead;
}

}  // namespace forewalk::rdw
