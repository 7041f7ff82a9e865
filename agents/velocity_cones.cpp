#include "agents/velocity_cones.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "navmesh/plan.h"

namespace forewalk::agents {
namespace {

using navmesh::cross;
constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr float kNoCut = -kInfinity;

float squaredLength(glm::vec2 v) { return glm::dot(v, v); }

/// Sets scratch.from and scratch.to to the stretch of a line that each cone forbids, an
/// intersection of three half-lines; empty where from >= to. All cones in one loop without
/// branches.
void forbiddenOn(const ConeScratch::Edge& edge, ConeScratch& scratch) {
  const std::size_t n = scratch.from.size();
  const glm::vec2 point = edge.point, direction = edge.direction;
  const float* const sides = scratch.sides.data();
  float* const from = scratch.from.data();
  float* const to = scratch.to.data();
  for (std::size_t c = 0; c < n; ++c) {
    float low = -kInfinity, high = kInfinity;
    // Forbidden is where offset + slope * t > kOnBorder.
    for (std::size_t k = 0; k < 3; ++k) {
      const float* const side = sides + 3 * k * n;
      const float room =
          VelocityCone::kOnBorder - (side[c] * point.x + side[n + c] * point.y - side[2 * n + c]);
      const float slope = side[c] * direction.x + side[n + c] * direction.y;
      const float at = room / slope;
      const bool rises = slope > 1e-7f, falls = slope < -1e-7f;
      const float lower = rises ? at : -kInfinity;
      const float never = room >= 0.0f ? -kInfinity : kInfinity;
      const float level = rises ? kInfinity : never;
      const float upper = falls ? at : level;
      low = low > lower ? low : lower;
      high = high < upper ? high : upper;
    }
    from[c] = low;
    to[c] = high;
  }
}

/// The cones as three rows of half-planes each, dot(normal, v) > offset, for forbiddenOn.
void setSides(std::span<const VelocityCone> cones, ConeScratch& scratch) {
  const std::size_t n = cones.size();
  scratch.from.resize(n);
  scratch.to.resize(n);
  scratch.sides.resize(9 * n);
  for (std::size_t c = 0; c < n; ++c) {
    const VelocityCone& cone = cones[c];
    const glm::vec2 normals[3] = {
        {-cone.right.y, cone.right.x}, {cone.left.y, -cone.left.x}, cone.cutDirection};
    for (std::size_t k = 0; k < 3; ++k) {
      float* const side = scratch.sides.data() + 3 * k * n + c;
      side[0] = normals[k].x;
      side[n] = normals[k].y;
      side[2 * n] = glm::dot(normals[k], cone.apex) + (k == 2 ? cone.cut : 0.0f);
    }
  }
}

/// The nearest point of an edge that is free, from `start` by steps of whole stretches, upward or
/// downward; beyond the edge's end or `limit` where there is none.
float freeFrom(float start, bool up, float limit, const ConeScratch& scratch) {
  const std::size_t n = scratch.from.size();
  float at = start;
  for (bool moved = true; moved;) {
    moved = false;
    for (std::size_t c = 0; c < n; ++c) {
      if (!(scratch.from[c] < at && at < scratch.to[c])) continue;
      at = up ? scratch.to[c] : scratch.from[c];
      moved = true;
    }
    if (up ? at > limit : at < limit) return at;
  }
  return at;
}

/// Seconds until the cone's disc is touched at velocity `v`; 0 where it is already. Infinity:
/// never.
float timeTo(const VelocityCone& cone, glm::vec2 v) {
  const glm::vec2 w = v - cone.apex;
  const float along = glm::dot(w, cone.apart);
  if (along <= 0.0f) return kInfinity;
  const float gap = squaredLength(cone.apart) - cone.reach * cone.reach;
  if (gap <= 0.0f) return 0.0f;
  const float squaredSpeed = squaredLength(w);
  const float discriminant = along * along - squaredSpeed * gap;
  if (discriminant <= 0.0f) return kInfinity;
  return gap / (along + std::sqrt(discriminant));
}

}  // namespace

VelocityCone coneOfDisc(glm::vec2 apart, float reach, glm::vec2 apex, float horizon) {
  const float squaredDistance = squaredLength(apart);
  const float distance = std::sqrt(squaredDistance);
  const float leg = std::sqrt(std::max(0.0f, squaredDistance - reach * reach));
  const float c = leg / distance, s = reach / distance;
  const glm::vec2 u = apart / distance;
  VelocityCone cone;
  cone.apex = apex;
  cone.left = {c * u.x - s * u.y, s * u.x + c * u.y};
  cone.right = {c * u.x + s * u.y, -s * u.x + c * u.y};
  cone.cutDirection = horizon > 0.0f ? u : glm::vec2(0.0f);
  cone.cut = horizon > 0.0f ? (distance - reach) / horizon : kNoCut;
  cone.hard = false;
  cone.apart = apart;
  cone.reach = reach;
  return cone;
}

VelocityCone halfPlaneCone(glm::vec2 towards, glm::vec2 apex, float speed) {
  VelocityCone cone;
  cone.apex = apex + speed * towards;
  cone.left = {-towards.y, towards.x};
  cone.right = {towards.y, -towards.x};
  cone.cutDirection = glm::vec2(0.0f);
  cone.cut = kNoCut;
  cone.hard = false;
  cone.apart = towards;
  cone.reach = 2.0f;  // touched now
  return cone;
}

bool nearestFree(std::span<const VelocityCone> cones, glm::vec2 preferred, float maximumSpeed,
                 float side, ConeScratch& scratch, glm::vec2& velocity) {
  auto& edges = scratch.edges;
  edges.clear();
  velocity = preferred;
  bool free = true;
  for (const VelocityCone& cone : cones) {
    if (!cone.forbids(preferred)) continue;
    free = false;
    break;
  }
  if (free) return true;

  for (const VelocityCone& cone : cones) {
    const auto add = [&](glm::vec2 point, glm::vec2 direction, float from) {
      const float along = glm::dot(direction, point);
      const float discriminant = along * along + maximumSpeed * maximumSpeed - squaredLength(point);
      if (discriminant <= 0.0f) return;  // nowhere slow enough
      const float half = std::sqrt(discriminant);
      const float low = std::max(from, -along - half), high = -along + half;
      if (low > high) return;
      const float foot = glm::dot(direction, preferred - point);
      const float start = std::clamp(foot, low, high);
      edges.push_back({point, direction, low, high, foot, start,
                       squaredLength(point + start * direction - preferred)});
    };
    // Of two equally near the first one stays: the side to take comes first.
    add(cone.apex, side >= 0.0f ? cone.left : cone.right, 0.0f);
    add(cone.apex, side >= 0.0f ? cone.right : cone.left, 0.0f);
    if (cone.hasCut()) {
      add(cone.apex + cone.cut * cone.cutDirection,
          side * glm::vec2(-cone.cutDirection.y, cone.cutDirection.x), -kInfinity);
    }
  }
  setSides(cones, scratch);
  // The nearest free point of each edge: from the nearest point of its line outward both ways, out
  // of one forbidden stretch after the other. Its ends are the crossings with other sides, and the
  // edge's own ends those with the circle, so no other candidates are needed. Nearest edges first:
  // what follows is soon too far.
  float best = kInfinity;
  std::size_t left = edges.size();
  scratch.order.resize(left);
  for (std::size_t k = 0; k < left; ++k) scratch.order[k] = static_cast<std::uint32_t>(k);
  while (left > 0) {
    std::size_t nearest = 0;
    for (std::size_t k = 1; k < left; ++k) {
      if (edges[scratch.order[k]].squaredDistance < edges[scratch.order[nearest]].squaredDistance)
        nearest = k;
    }
    const ConeScratch::Edge& edge = edges[scratch.order[nearest]];
    if (!(edge.squaredDistance < best)) break;
    scratch.order.erase(scratch.order.begin() + static_cast<std::ptrdiff_t>(nearest));
    --left;
    forbiddenOn(edge, scratch);
    const auto offer = [&](float at) {
      if (at < edge.from || at > edge.to) return;
      const glm::vec2 v = edge.point + at * edge.direction;
      const float distance = squaredLength(v - preferred);
      if (!(distance < best)) return;
      best = distance;
      velocity = v;
    };
    // No farther along than the best so far.
    const float across = squaredLength(edge.point + edge.foot * edge.direction - preferred);
    const float reach = best < kInfinity ? std::sqrt(std::max(0.0f, best - across)) : kInfinity;
    offer(freeFrom(edge.start, true, std::min(edge.to, edge.foot + reach), scratch));
    offer(freeFrom(edge.start, false, std::max(edge.from, edge.foot - reach), scratch));
  }
  return best < kInfinity;
}

glm::vec2 leastDangerous(std::span<const VelocityCone> cones, glm::vec2 preferred,
                         glm::vec2 present, float maximumSpeed, float weight, float seconds,
                         float side, const ConeScratch& scratch) {
  constexpr float kIntoWall = 1e3f;
  float best = kInfinity;
  glm::vec2 velocity(0.0f);
  const auto offer = [&](glm::vec2 v) {
    const float detour = glm::length(v - preferred);
    if (!(detour < best)) return;
    float cost = detour;
    float soonest = kInfinity;
    for (const VelocityCone& cone : cones) {
      if (cone.hard) {
        if (cone.forbids(v))
          cost += kIntoWall *
                  (1.0f + glm::dot(v - cone.apex, cone.apart) - (cone.hasCut() ? cone.cut : 0.0f));
      } else {
        const float time = timeTo(cone, v);
        // In contact: the faster towards the other, the worse.
        if (time <= 0.0f) {
          cost += weight / seconds *
                  (0.1f + glm::dot(v - cone.apex, cone.apart) / glm::length(cone.apart));
        } else {
          soonest = std::min(soonest, time);
        }
      }
      if (cost + weight / std::max(soonest, seconds) >= best) return;
    }
    cost += weight / std::max(soonest, seconds);
    best = cost;
    velocity = v;
  };
  offer(preferred);
  offer(present);
  offer(glm::vec2(0.0f));
  for (const ConeScratch::Edge& edge : scratch.edges) {
    offer(edge.point + edge.start * edge.direction);
  }
  // Around the preferred velocity, to the agreed side first.
  constexpr int kDirections = 16;
  static const std::array<glm::vec2, kDirections> circle = [] {
    std::array<glm::vec2, kDirections> points;
    for (int k = 0; k < kDirections; ++k) {
      const double angle = 2.0 * 3.14159265358979323846 * k / kDirections;
      points[static_cast<std::size_t>(k)] = {static_cast<float>(std::cos(angle)),
                                             static_cast<float>(std::sin(angle))};
    }
    return points;
  }();
  const float speed = glm::length(preferred);
  const glm::vec2 ahead = speed > 1e-3f ? preferred / speed : glm::vec2(0.0f, 1.0f);
  for (const float share : {1.0f, 0.5f}) {
    for (const glm::vec2 at : circle) {
      const glm::vec2 turned = {at.x * ahead.x - side * at.y * ahead.y,
                                side * at.y * ahead.x + at.x * ahead.y};
      offer(turned * (share * maximumSpeed));
    }
  }
  return velocity;
}

}  // namespace forewalk::agents
