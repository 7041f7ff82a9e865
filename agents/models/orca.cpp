#include "agents/models/orca.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "agents/half_planes.h"
#include "navmesh/plan.h"

namespace forewalk::agents {
namespace {

using navmesh::cross;

glm::vec2 leftOf(glm::vec2 v) { return {-v.y, v.x}; }

glm::vec2 unit(glm::vec2 v) {
  const float length = glm::length(v);
  return length > 1e-6f ? v / length : glm::vec2(1.0f, 0.0f);
}

/// The half-plane of velocities outside the truncated cone of a moving disc at `apart` from us,
/// `reach` the sum of the radii: tangent where the cone's surface is nearest to the relative
/// velocity, and moved from our velocity by `share` of the change that takes.
HalfPlane planeOfDisc(glm::vec2 apart, glm::vec2 velocity, glm::vec2 theirs, float reach,
                      float horizon, float share, float seconds) {
  const glm::vec2 relative = velocity - theirs;
  const float squaredDistance = glm::dot(apart, apart);
  HalfPlane plane;
  glm::vec2 change;
  if (squaredDistance > reach * reach) {
    const glm::vec2 w = relative - apart / horizon;  // from the centre of the cut-off disc
    const float squaredLength = glm::dot(w, w);
    const float along = glm::dot(w, apart);
    if (along < 0.0f && along * along > reach * reach * squaredLength) {
      const float length = std::sqrt(squaredLength);
      const glm::vec2 out = w / length;
      plane.direction = {out.y, -out.x};
      change = (reach / horizon - length) * out;
    } else {
      const float leg = std::sqrt(squaredDistance - reach * reach);
      if (cross(apart, w) > 0.0f) {
        plane.direction =
            glm::vec2(apart.x * leg - apart.y * reach, apart.x * reach + apart.y * leg) /
            squaredDistance;
      } else {
        plane.direction =
            -glm::vec2(apart.x * leg + apart.y * reach, -apart.x * reach + apart.y * leg) /
            squaredDistance;
      }
      change = glm::dot(relative, plane.direction) * plane.direction - relative;
    }
  } else {  // overlapping: part within this step
    const glm::vec2 w = relative - apart / seconds;
    const float length = glm::length(w);
    const glm::vec2 out = unit(w);
    plane.direction = {out.y, -out.x};
    change = (reach / seconds - length) * out;
  }
  plane.point = velocity + share * change;
  return plane;
}

/// One end of a wall as the agent sees it. `side` is 1 for the left end, -1 for the right.
struct WallEnd {
  glm::vec2 to;      // from the agent
  bool pointsOut;    // one can walk around it
  glm::vec2 beyond;  // unit vector along the next wall, away from this end; 0 where it is loose
  float side;
  glm::vec2 leg{0.0f};   // side of the cone, unit vector
  bool foreign = false;  // the leg is the next wall itself: that one makes the plane
};

/// Tangent from the agent to the disc of `radius` about the end, on the end's own side.
glm::vec2 tangentTo(const WallEnd& end, float radius, float side) {
  const float squared = glm::dot(end.to, end.to);
  const float leg = std::sqrt(std::max(0.0f, squared - radius * radius));
  return (end.to * leg + side * leftOf(end.to) * radius) / squared;
}

/// The plane that a wall forbids, or false where its neighbours or earlier planes take care of it.
/// The wall's velocity obstacle is the cone over the wall widened by `radius`, cut off at
/// `horizon`.
bool planeOfWall(std::span<const Wall> walls, std::uint32_t which, glm::vec2 position,
                 glm::vec2 velocity, float radius, float horizon, std::span<const HalfPlane> planes,
                 HalfPlane& plane) {
  const Wall& wall = walls[which];
  velocity -= wall.velocity;
  const glm::vec2 along = unit(wall.to - wall.from);
  const auto beyond = [&](std::uint32_t next, float sign) {
    return next == kNoWall ? glm::vec2(0.0f) : sign * unit(walls[next].to - walls[next].from);
  };
  // Free ground is left of the wall: seen from there, it begins at the right.
  WallEnd left{wall.to - position, pointsOut(walls, which), beyond(wall.next, 1.0f), 1.0f};
  WallEnd right{wall.from - position, wall.previous == kNoWall || pointsOut(walls, wall.previous),
                beyond(wall.previous, -1.0f), -1.0f};
  const float cut = 1.0f / horizon;

  for (const HalfPlane& other : planes) {
    const float a = cross(other.direction, cut * left.to + wall.velocity - other.point);
    const float b = cross(other.direction, cut * right.to + wall.velocity - other.point);
    if (a <= -cut * radius + 1e-5f && b <= -cut * radius + 1e-5f) return false;  // covered
  }

  const glm::vec2 span = left.to - right.to;
  // All of this as it is from the wall's other end, so that the mirrored wall has the mirrored
  // plane to the last bit.
  const bool beyondRight = glm::dot(right.to, span) > 0.0f,
             beyondLeft = glm::dot(left.to, span) < 0.0f;
  const float area = cross(right.to, left.to);
  const float squaredToLine = area * area / glm::dot(span, span);
  const float squaredRadius = radius * radius;

  // In contact: do not go farther in.
  const auto stop = [&](glm::vec2 direction) {
    plane = {wall.velocity, direction};
    return true;
  };
  if (beyondRight && glm::dot(right.to, right.to) <= squaredRadius) {
    // Where the corner is seen from the neighbour's side as well, that wall makes this plane.
    if (!right.pointsOut || cross(right.to, right.beyond) < 0.0f) return false;
    return stop(unit(leftOf(right.to)));
  }
  if (beyondLeft && glm::dot(left.to, left.to) <= squaredRadius) {
    return left.pointsOut && stop(unit(leftOf(left.to)));
  }
  if (!beyondRight && !beyondLeft && squaredToLine <= squaredRadius) return stop(along);

  // The legs. Seen end-on, within `radius` of its line, a wall is its nearer end alone.
  bool isPoint = false;
  if (beyondLeft && squaredToLine <= squaredRadius) {
    if (!left.pointsOut) return false;
    isPoint = true;
    const glm::vec2 back = -along;
    right = {left.to, true, back, -1.0f};
    left.leg = tangentTo(left, radius, 1.0f);
    right.leg = tangentTo(left, radius, -1.0f);
  } else if (beyondRight && squaredToLine <= squaredRadius) {
    if (!right.pointsOut) return false;
    isPoint = true;
    left = {right.to, true, along, 1.0f};
    left.leg = tangentTo(right, radius, 1.0f);
    right.leg = tangentTo(right, radius, -1.0f);
  } else {
    left.leg = left.pointsOut ? tangentTo(left, radius, 1.0f) : along;
    right.leg = right.pointsOut ? tangentTo(right, radius, -1.0f) : -along;
  }
  for (WallEnd* end : {&left, &right}) {
    // A leg that would enter the next wall is that wall.
    if (end->pointsOut && end->beyond != glm::vec2(0.0f) &&
        end->side * cross(end->leg, end->beyond) >= 0.0f) {
      end->leg = end->beyond;
      end->foreign = true;
    }
  }

  const glm::vec2 leftCut = cut * left.to, rightCut = cut * right.to;
  const glm::vec2 cutSpan = leftCut - rightCut;
  const bool beforeCut = !isPoint && glm::dot(velocity - rightCut, cutSpan) < 0.0f;
  const bool behindCut = !isPoint && glm::dot(leftCut - velocity, cutSpan) < 0.0f;
  const float onLeft = glm::dot(velocity - leftCut, left.leg);
  const float onRight = glm::dot(velocity - rightCut, right.leg);
  const auto aroundEnd = [&](glm::vec2 centre) {
    const glm::vec2 out = unit(velocity - centre);
    plane = {centre + cut * radius * out + wall.velocity, {out.y, -out.x}};
    return true;
  };
  if ((behindCut && onLeft < 0.0f) || (isPoint && onLeft < 0.0f && onRight < 0.0f)) {
    return aroundEnd(leftCut);
  }
  if (beforeCut && onRight < 0.0f) return aroundEnd(rightCut);

  constexpr float kFar = std::numeric_limits<float>::infinity();
  const auto squaredTo = [&](glm::vec2 point) {
    return glm::dot(velocity - point, velocity - point);
  };
  const float cutArea = cross(rightCut - velocity, leftCut - velocity);
  const float toCut =
      isPoint || beforeCut || behindCut ? kFar : cutArea * cutArea / glm::dot(cutSpan, cutSpan);
  const float toLeft = onLeft < 0.0f ? kFar : squaredTo(leftCut + onLeft * left.leg);
  const float toRight = onRight < 0.0f ? kFar : squaredTo(rightCut + onRight * right.leg);
  const auto tangent = [&](glm::vec2 through, glm::vec2 direction) {
    plane = {through + cut * radius * leftOf(direction) + wall.velocity, direction};
    return true;
  };
  if (toCut <= toLeft && toCut <= toRight) return tangent(0.5f * (leftCut + rightCut), along);
  if (toLeft <= toRight) return !left.foreign && tangent(leftCut, left.leg);
  return !right.foreign && tangent(rightCut, -right.leg);
}

struct OrcaScratch : Scratch {
  std::vector<HalfPlane> planes, bisectors;
};

class Orca final : public Model {
 public:
  explicit Orca(const OrcaParameters& parameters) : parameters_(parameters) {}

  const char* name() const override { return "orca"; }

  Needs needs() const override {
    Needs needs;
    needs.neighbourRadius = parameters_.neighbourRadius;
    needs.neighbourCount = parameters_.neighbourCount;
    // As far as anybody gets within the horizon at a fast walk, and a body's width.
    needs.wallRadius = 2.0f * parameters_.wallHorizon + 1.0f;
    return needs;
  }

  std::unique_ptr<Scratch> makeScratch() const override { return std::make_unique<OrcaScratch>(); }

  void plan(const PlanInput& input, Memory, Scratch& scratch,
            std::span<Plan> plans) const override {
    OrcaScratch& own = static_cast<OrcaScratch&>(scratch);
    for (std::size_t k = 0; k < input.which.size(); ++k) {
      plans[k] = planFor(input, input.which[k], own);
    }
  }

 private:
  Plan planFor(const PlanInput& input, std::uint32_t agent, OrcaScratch& scratch) const {
    const AgentsView& agents = input.agents;
    const Surroundings near = input.around.of(agent);
    const glm::vec2 position = agents.position[agent], velocity = agents.velocity[agent];
    const float radius = agents.radius[agent];
    std::vector<HalfPlane>& planes = scratch.planes;
    planes.clear();
    PlanStatus status = PlanStatus::ok;

    for (const NearWall& nearWall : near.walls) {
      const Wall& wall = input.around.walls[nearWall.index];
      const float kept = wallRadius(radius, wall);
      if (wall.isCircle()) {
        planes.push_back(planeOfDisc(wall.from - position, velocity, wall.velocity, kept,
                                     parameters_.wallHorizon, 1.0f, input.seconds));
        continue;
      }
      HalfPlane plane;
      if (planeOfWall(input.around.walls, nearWall.index, position, velocity, kept,
                      parameters_.wallHorizon, planes, plane)) {
        planes.push_back(plane);
      }
    }
    const std::size_t hard = planes.size();
    for (const Neighbour& neighbour : near.neighbours) {
      const std::uint32_t other = neighbour.index;
      glm::vec2 apart = agents.position[other] - position;
      const float reach = radius + agents.radius[other];
      if (glm::dot(apart, apart) < reach * reach) {
        status = PlanStatus::contact;
        // In one spot there is no direction to part in: the ids give one, opposite for the two.
        if (apart == glm::vec2(0.0f)) {
          const bool first = number(agents.id[agent]) < number(agents.id[other]);
          apart = {first ? 1e-4f : -1e-4f, 0.0f};
        }
      }
      planes.push_back(planeOfDisc(apart, velocity, agents.velocity[other], reach,
                                   parameters_.timeHorizon, agents.yields(other) ? 0.5f : 1.0f,
                                   input.seconds));
    }
    const VelocityChoice choice = nearestAllowed(planes, hard, agents.preferredVelocity[agent],
                                                 agents.maximumSpeed[agent], scratch.bisectors);
    if (!choice.feasible && status == PlanStatus::ok) status = PlanStatus::infeasible;
    return Plan::walk(choice.velocity, status);
  }

  OrcaParameters parameters_;
};

}  // namespace

std::unique_ptr<const Model> makeOrca(const OrcaParameters& parameters) {
  return std::make_unique<Orca>(parameters);
}

}  // namespace forewalk::agents
