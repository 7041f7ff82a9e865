#include "agents/half_planes.h"

#include <algorithm>
#include <cmath>

#include "navmesh/plan.h"

namespace forewalk::agents {
namespace {

using navmesh::cross;

constexpr float kParallel = 1e-5f;  // of two unit vectors' cross product

/// What is optimised: nearness to a point, or progress along a direction (then `aim` is a unit
/// vector).
struct Aim {
  glm::vec2 aim;
  bool isDirection;
};

/// The best velocity on the border of planes[which], within the planes before it and the disc.
/// False where that stretch is empty.
bool bestOnLine(std::span<const HalfPlane> planes, std::size_t which, float speed, const Aim& aim,
                glm::vec2& velocity) {
  const HalfPlane& line = planes[which];
  const float along = glm::dot(line.point, line.direction);
  const float discriminant = along * along + speed * speed - glm::dot(line.point, line.point);
  if (discriminant < 0.0f) return false;  // it misses the disc
  const float half = std::sqrt(discriminant);
  float low = -along - half, high = -along + half;
  for (std::size_t i = 0; i < which; ++i) {
    const float across = cross(line.direction, planes[i].direction);
    const float behind = cross(planes[i].direction, line.point - planes[i].point);
    if (std::abs(across) <= kParallel) {
      if (behind < 0.0f) return false;
      continue;
    }
    const float at = behind / across;
    if (across > 0.0f) {
      high = std::min(high, at);
    } else {
      low = std::max(low, at);
    }
    if (low > high) return false;
  }
  float at;
  if (aim.isDirection) {
    at = glm::dot(aim.aim, line.direction) > 0.0f ? high : low;
  } else {
    at = std::clamp(glm::dot(line.direction, aim.aim - line.point), low, high);
  }
  velocity = line.point + at * line.direction;
  return true;
}

/// The best velocity in all planes. Returns the first plane at which there is none (then `velocity`
/// is the best of those before it), or their number.
std::size_t bestInPlane(std::span<const HalfPlane> planes, float speed, const Aim& aim,
                        glm::vec2& velocity) {
  if (aim.isDirection) {
    velocity = aim.aim * speed;
  } else {
    const float squared = glm::dot(aim.aim, aim.aim);
    velocity = squared > speed * speed ? aim.aim * (speed / std::sqrt(squared)) : aim.aim;
  }
  for (std::size_t i = 0; i < planes.size(); ++i) {
    if (cross(planes[i].direction, planes[i].point - velocity) <= 0.0f) continue;
    const glm::vec2 before = velocity;
    if (!bestOnLine(planes, i, speed, aim, velocity)) {
      velocity = before;
      return i;
    }
  }
  return planes.size();
}

/// From `velocity`, which fails at planes[failed]: pushes the deepest distance into planes beyond
/// the hard ones down as far as it goes. That is a linear program in velocity and depth; where
/// plane i is the deepest, each other plane forbids what lies deeper in it than in i, bounded by
/// the bisector.
void leastViolation(std::span<const HalfPlane> planes, std::size_t hard, std::size_t failed,
                    float speed, std::vector<HalfPlane>& bisectors, glm::vec2& velocity) {
  float depth = 0.0f;
  for (std::size_t i = failed; i < planes.size(); ++i) {
    if (cross(planes[i].direction, planes[i].point - velocity) <= depth) continue;
    bisectors.assign(planes.begin(), planes.begin() + static_cast<std::ptrdiff_t>(hard));
    for (std::size_t j = hard; j < i; ++j) {
      HalfPlane bisector;
      const float across = cross(planes[i].direction, planes[j].direction);
      if (std::abs(across) <= kParallel) {
        if (glm::dot(planes[i].direction, planes[j].direction) > 0.0f) continue;  // same side
        bisector.point = 0.5f * (planes[i].point + planes[j].point);
      } else {
        const float at = cross(planes[j].direction, planes[i].point - planes[j].point) / across;
        bisector.point = planes[i].point + at * planes[i].direction;
      }
      const glm::vec2 direction = planes[j].direction - planes[i].direction;
      const float length = glm::length(direction);
      if (!(length > 0.0f)) continue;
      bisector.direction = direction / length;
      bisectors.push_back(bisector);
    }
    const glm::vec2 inward(-planes[i].direction.y, planes[i].direction.x);
    glm::vec2 better;
    // By construction there is one; where rounding says otherwise, the last one stands.
    if (bestInPlane(bisectors, speed, {inward, true}, better) == bisectors.size())
      velocity = better;
    depth = cross(planes[i].direction, planes[i].point - velocity);
  }
}

}  // namespace

VelocityChoice nearestAllowed(std::span<const HalfPlane> planes, std::size_t hard,
                              glm::vec2 preferred, float maximumSpeed,
                              std::vector<HalfPlane>& scratch) {
  VelocityChoice choice;
  const std::size_t failed = bestInPlane(planes, maximumSpeed, {preferred, false}, choice.velocity);
  if (failed == planes.size()) return choice;
  choice.feasible = false;
  leastViolation(planes, hard, failed, maximumSpeed, scratch, choice.velocity);
  return choice;
}

}  // namespace forewalk::agents
