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
constexpr std::uint32_t kNoCone = 0xffffffffu;

float squaredLength(glm::vec2 v) { return glm::dot(v, v); }

/// Keeps the nearest free candidate.
class Nearest {
 public:
  Nearest(std::span<const VelocityCone> cones, glm::vec2 preferred, float maximumSpeed)
      : cones_(cones),
        preferred_(preferred),
        squaredSpeed_(maximumSpeed * maximumSpeed * 1.0001f + 1e-8f) {}

  float squaredDistance() const { return best_; }
  glm::vec2 velocity() const { return velocity_; }

  /// `a` and `b`: the cones on whose border it lies.
  void offer(glm::vec2 v, std::uint32_t a, std::uint32_t b = kNoCone) {
    const float distance = squaredLength(v - preferred_);
    if (!(distance < best_) || squaredLength(v) > squaredSpeed_) return;
    // Who forbade the last candidate is likely to forbid this one too.
    if (last_ != a && last_ != b && last_ < cones_.size() && cones_[last_].forbids(v)) return;
    for (std::uint32_t c = 0; c < cones_.size(); ++c) {
      if (c == a || c == b || !cones_[c].forbids(v)) continue;
      last_ = c;
      return;
    }
    best_ = distance;
    velocity_ = v;
  }

 private:
  std::span<const VelocityCone> cones_;
  glm::vec2 preferred_;
  float squaredSpeed_;
  float best_ = kInfinity;
  glm::vec2 velocity_{0.0f};
  std::uint32_t last_ = kNoCone;
};

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
  scratch.edges.clear();
  velocity = preferred;
  bool free = true;
  for (const VelocityCone& cone : cones) {
    if (!cone.forbids(preferred)) continue;
    free = false;
    break;
  }
  if (free) return true;

  Nearest nearest(cones, preferred, maximumSpeed);
  auto& edges = scratch.edges;
  for (std::uint32_t c = 0; c < cones.size(); ++c) {
    const VelocityCone& cone = cones[c];
    const auto add = [&](glm::vec2 point, glm::vec2 direction, float from) {
      const float across = cross(direction, preferred - point);
      edges.push_back({point, direction, from, across * across, c});
      const float along = glm::dot(direction, preferred - point);
      if (along >= from) nearest.offer(point + along * direction, c);
    };
    // Of two equally near the first one stays: the side to take comes first.
    add(cone.apex, side >= 0.0f ? cone.left : cone.right, 0.0f);
    add(cone.apex, side >= 0.0f ? cone.right : cone.left, 0.0f);
    if (cone.hasCut()) {
      add(cone.apex + cone.cut * cone.cutDirection,
          side * glm::vec2(-cone.cutDirection.y, cone.cutDirection.x), -kInfinity);
    }
  }
  for (const ConeScratch::Edge& edge : edges) {
    if (edge.squaredDistance >= nearest.squaredDistance()) continue;
    // |point + t * direction| = maximumSpeed
    const float along = glm::dot(edge.point, edge.direction);
    const float discriminant =
        along * along + maximumSpeed * maximumSpeed - squaredLength(edge.point);
    if (discriminant < 0.0f) continue;
    const float half = std::sqrt(discriminant);
    for (const float t : {-along + half, -along - half}) {
      if (t >= edge.from) nearest.offer(edge.point + t * edge.direction, edge.cone);
    }
  }
  for (std::size_t i = 0; i < edges.size(); ++i) {
    if (edges[i].squaredDistance >= nearest.squaredDistance()) continue;
    for (std::size_t j = i + 1; j < edges.size(); ++j) {
      if (edges[j].squaredDistance >= nearest.squaredDistance()) continue;
      const float across = cross(edges[i].direction, edges[j].direction);
      if (std::abs(across) < 1e-5f) continue;
      const glm::vec2 between = edges[j].point - edges[i].point;
      const float t = cross(between, edges[j].direction) / across;
      if (t < edges[i].from || cross(between, edges[i].direction) / across < edges[j].from)
        continue;
      nearest.offer(edges[i].point + t * edges[i].direction, edges[i].cone, edges[j].cone);
    }
  }
  if (nearest.squaredDistance() == kInfinity) return false;
  velocity = nearest.velocity();
  return true;
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
    const float along = glm::dot(edge.direction, preferred - edge.point);
    if (along < edge.from) continue;
    const glm::vec2 v = edge.point + along * edge.direction;
    if (squaredLength(v) <= maximumSpeed * maximumSpeed) offer(v);
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
  for (const float share : {1.0f, 0.5f, 0.25f}) {
    for (const glm::vec2 at : circle) {
      const glm::vec2 turned = {at.x * ahead.x - side * at.y * ahead.y,
                                side * at.y * ahead.x + at.x * ahead.y};
      offer(turned * (share * maximumSpeed));
    }
  }
  return velocity;
}

}  // namespace forewalk::agents
