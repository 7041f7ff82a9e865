// The tick of a crowd.
#include <algorithm>
#include <cmath>

#include "agents/crowd.h"
#include "agents/slices.h"

namespace forewalk::agents {
namespace {

// Below this a body does not turn to where it drifts, m/s.
constexpr float kTurningSpeed = 0.05f;

// So near to the goal nobody goes round a jam, metres.
constexpr float kNearGoal = 1.0f;

bool isFinite(glm::vec2 v) { return std::isfinite(v.x) && std::isfinite(v.y); }

glm::vec2 clipped(glm::vec2 v, float limit) {
  const float squared = glm::dot(v, v);
  return squared > limit * limit ? v * (limit / std::sqrt(squared)) : v;
}

float wrapped(float angle) { return std::remainder(angle, 2.0f * 3.14159265358979f); }

}  // namespace

void Crowd::moveObstacles(float seconds) {
  for (PlacedObstacle& placed : obstacles_) {
    if (placed.velocity == glm::vec2(0.0f)) continue;
    const glm::vec2 by = placed.velocity * seconds;
    if (auto* box = std::get_if<navmesh::BoxObstacle>(&placed.shape)) {
      box->centre += navmesh::toSpace(by, 0.0f);
    } else if (auto* prism = std::get_if<navmesh::PrismObstacle>(&placed.shape)) {
      for (glm::vec2& corner : prism->corners) corner += by;
    } else if (auto* cylinder = std::get_if<navmesh::CylinderObstacle>(&placed.shape)) {
      cylinder->foot += navmesh::toSpace(by, 0.0f);
    }
    if (CellNavigation* cells = navigation_.cells()) {
      cells->ground().setObject(placed.id, placed.shape);
    }
    wallsChanged_ = true;
  }
}

void Crowd::refreshWalls() {
  if (!wallsChanged_) return;
  wallsChanged_ = false;
  allWalls_ = borderWalls_;
  const auto append = [&](const Wall& wall, std::uint32_t base) {
    allWalls_.push_back(wall);
    if (wall.previous != kNoWall) allWalls_.back().previous += base;
    if (wall.next != kNoWall) allWalls_.back().next += base;
  };
  const std::uint32_t base = static_cast<std::uint32_t>(allWalls_.size());
  for (const Wall& wall : fixedWalls_) append(wall, base);
  std::vector<glm::vec2> corners;
  for (const PlacedObstacle& placed : obstacles_) {
    const navmesh::ObstacleOutline outline = navmesh::outlineOf(placed.shape);
    const std::size_t first = allWalls_.size();
    if (outline.corners.empty()) {
      appendCircle(glm::vec2(outline.centre), static_cast<float>(outline.radius), placed.velocity,
                   allWalls_);
    } else {
      corners.clear();
      for (auto corner = outline.corners.rbegin(); corner != outline.corners.rend(); ++corner) {
        corners.push_back(glm::vec2(*corner));  // clockwise: free ground is outside
      }
      appendLoop(corners, placed.velocity, allWalls_);
    }
    // Whoever stands beside it, from a foot below its bottom to its top, has to go around.
    const float bottom = static_cast<float>(outline.bottom), top = static_cast<float>(outline.top);
    for (std::size_t w = first; w < allWalls_.size(); ++w) {
      allWalls_[w].fromHeight = allWalls_[w].toHeight = 0.5f * (bottom + top);
      allWalls_[w].reach = 0.5f * (top - bottom) + 0.3f;
    }
  }
  wallIndex_.assign(allWalls_);
}

void Crowd::setPreferredVelocities(float seconds, const navmesh::ForEach& forEach) {
  navigation_.findPaths(position_, height_, radius_);
  const float sign = settings_.side >= 0.0f ? 1.0f : -1.0f;
  const float c = std::cos(sign * settings_.symmetryBreak),
              s = std::sin(sign * settings_.symmetryBreak);
  forSlices(static_cast<std::uint32_t>(id_.size()), forEach,
            [&](std::size_t, std::uint32_t begin, std::uint32_t end) {
              for (std::uint32_t i = begin; i < end; ++i) {
                const SubGoal goal = navigation_.advance(i, position_[i]);
                target_[i] = goal.target;
                remaining_[i] = goal.remaining;
                preferredVelocity_[i] = glm::vec2(0.0f);
                if (goal.remaining <= goalRadius_[i]) continue;
                const glm::vec2 towards = goal.target - position_[i];
                const float distance = glm::length(towards);
                if (!(distance > 0.0f)) continue;
                // Not beyond the goal within this tick.
                const float speed = std::min(preferredSpeed_[i], goal.remaining / seconds);
                const glm::vec2 v = towards * (speed / distance);
                preferredVelocity_[i] = {c * v.x - s * v.y, s * v.x + c * v.y};
                // Held up: by how much what it wants differs from what it gets.
                // Who is nearly there turns or waits for its place, and is not held up; people
                // stand for reasons of their own.
                const bool held = flags_[i] == 0 && goal.remaining > kNearGoal &&
                                  glm::length(velocity_[i]) < 0.1f * speed;
                heldUp_[i] =
                    std::clamp(heldUp_[i] + (held ? seconds : -2.0f * seconds), 0.0f, 10.0f);
                if (heldUp_[i] > 0.0f && settings_.unknot > 0.0f) {
                  const float turn = sign * std::min(settings_.unknot * heldUp_[i], 2.5f);
                  const float tc = std::cos(turn), ts = std::sin(turn);
                  preferredVelocity_[i] = {tc * v.x - ts * v.y, ts * v.x + tc * v.y};
                }
              }
            });
}

void Crowd::planFor(OwnModel& own, std::uint32_t modelNumber, std::uint32_t subStep, float seconds,
                    const navmesh::ForEach& forEach) {
  own.due.clear();
  for (std::uint32_t i = 0; i < id_.size(); ++i) {
    if (static_cast<std::uint32_t>(modelOf_[i]) != modelNumber || !isPlannedFor(i)) continue;
    if (needsOf_[i] && (subStep == 0 || own.needs.longestSubStep > 0.0f)) own.due.push_back(i);
  }
  if (own.due.empty()) return;
  own.plans.resize(own.due.size());
  while (own.scratch.size() < kSlices) own.scratch.push_back(own.model->makeScratch());
  const AgentsView agents = view();
  const Memory memory{memory_.data(), memoryStride_, own.needs.memory};
  // A model without sub-steps plans for the whole tick.
  const float horizon =
      own.needs.longestSubStep > 0.0f ? seconds / static_cast<float>(report_.subSteps) : seconds;
  forSlices(static_cast<std::uint32_t>(own.due.size()), forEach,
            [&](std::size_t slice, std::uint32_t begin, std::uint32_t end) {
              const PlanInput input{agents,
                                    index_.neighbourhoods(),
                                    std::span(own.due).subspan(begin, end - begin),
                                    horizon,
                                    report_.tick,
                                    settings_.side};
              own.model->plan(input, memory, *own.scratch[slice],
                              std::span(own.plans).subspan(begin, end - begin));
            });
  for (std::size_t k = 0; k < own.due.size(); ++k) {
    Plan& plan = own.plans[k];
    // A model that breaks its promise stops its own agent and nobody else.
    if (!isFinite(plan.velocity) || !std::isfinite(plan.heading) || !std::isfinite(plan.speed) ||
        !std::isfinite(plan.turnRate)) {
      plan = Plan::walk(glm::vec2(0.0f), PlanStatus::infeasible);
    }
    plan_[own.due[k]] = plan;
    planAge_[own.due[k]] = 0.0f;
  }
}

void Crowd::move(std::uint32_t i, float seconds) {
  if (flags_[i] & kHuman) return;
  if (flags_[i] & kStatic) {
    velocity_[i] = glm::vec2(0.0f);
    return;
  }
  const Plan plan = flags_[i] & kPassive ? Plan::walk(preferredVelocity_[i]) : plan_[i];
  const float change = maximumAcceleration_[i] * seconds;
  if (plan.kind == Plan::Kind::arc) {
    const float was = glm::length(velocity_[i]);
    const float wanted = std::clamp(plan.speed, was - change, was + change);
    const float speed = std::clamp(wanted, 0.0f, maximumSpeed_[i]);
    const float turned = plan.turnRate * seconds;
    // The chord of the arc; its length is that of the arc times sin(x)/x of half the turn.
    const float half = 0.5f * turned;
    const float shortened =
        std::abs(half) < 1e-3f ? 1.0f - half * half / 6.0f : std::sin(half) / half;
    const glm::vec2 way = navmesh::directionOf(heading_[i] + half) * (speed * seconds * shortened);
    position_[i] += way;
    heading_[i] = wrapped(heading_[i] + turned);
    velocity_[i] = navmesh::directionOf(heading_[i]) * speed;
    return;
  }
  const bool turns = plan.kind == Plan::Kind::heading;
  const glm::vec2 wanted = turns ? navmesh::directionOf(plan.heading) * plan.speed : plan.velocity;
  velocity_[i] += clipped(wanted - velocity_[i], change);
  velocity_[i] = clipped(velocity_[i], maximumSpeed_[i]);
  position_[i] += velocity_[i] * seconds;
  if (turns) {
    heading_[i] = wrapped(plan.heading);
  } else if (glm::dot(velocity_[i], velocity_[i]) > kTurningSpeed * kTurningSpeed) {
    heading_[i] = navmesh::headingOf(velocity_[i]);
  }
}

void Crowd::countStatus() {
  report_.infeasible = report_.contact = 0;
  for (std::size_t i = 0; i < id_.size(); ++i) {
    if (flags_[i] != 0) continue;
    report_.infeasible += plan_[i].status == PlanStatus::infeasible;
    report_.contact += plan_[i].status == PlanStatus::contact;
  }
  report_.waitingForPath = navigation_.waiting();
  report_.withoutPath = navigation_.closed();
  report_.notified = navigation_.notified();
}

const StepReport& Crowd::step(float seconds, const navmesh::ForEach& forEach) {
  if (!(seconds > 0.0f) || !std::isfinite(seconds)) return report_;
  const std::uint32_t n = static_cast<std::uint32_t>(id_.size());
  refreshWalls();
  setPreferredVelocities(seconds, forEach);

  // Who is planned for in this tick, and what that asks of the gather.
  needsOf_.assign(n, nullptr);
  float reach = 0.0f, longest = seconds;
  for (std::uint32_t i = 0; i < n; ++i) {
    if (!isPlannedFor(i)) continue;
    const Needs& needs = models_[static_cast<std::size_t>(modelOf_[i])].needs;
    if (planAge_[i] + 1e-5f < needs.period) continue;
    needsOf_[i] = &needs;
    reach = std::max(reach, needs.neighbourRadius);
    if (needs.longestSubStep > 0.0f) longest = std::min(longest, needs.longestSubStep);
  }
  index_.build(view(), reach);
  index_.gather(view(), wallIndex_, needsOf_, forEach);

  before_.assign(position_.begin(), position_.end());
  // A hair less, so that a tick of five sub-steps is not cut into six by rounding.
  report_.subSteps = static_cast<std::uint32_t>(std::ceil(seconds / longest - 1e-3f));
  const float subStep = seconds / static_cast<float>(report_.subSteps);
  for (std::uint32_t s = 0; s < report_.subSteps; ++s) {
    for (std::uint32_t m = 0; m < models_.size(); ++m) planFor(models_[m], m, s, seconds, forEach);
    forSlices(n, forEach, [&](std::size_t, std::uint32_t begin, std::uint32_t end) {
      for (std::uint32_t i = begin; i < end; ++i) move(i, subStep);
    });
  }
  moveObstacles(seconds);

  report_.deepestOverlap = 0.0f;
  if (settings_.project) {
    refreshWalls();
    moved_.assign(position_.begin(), position_.end());
    report_.deepestOverlap = projection_.apply(view(), before_, wallIndex_, settings_.projection,
                                               index_, forEach, position_);
    // Whoever was held up goes on from what came of its step, not from what it wanted.
    for (std::uint32_t i = 0; i < n; ++i) {
      if (flags_[i] & (kHuman | kStatic) || position_[i] == moved_[i]) continue;
      velocity_[i] = clipped((position_[i] - before_[i]) / seconds, maximumSpeed_[i]);
    }
  }
  if (navigation_.world()) {
    forSlices(n, forEach, [&](std::size_t, std::uint32_t begin, std::uint32_t end) {
      for (std::uint32_t i = begin; i < end; ++i) {
        if (flags_[i] & kHuman) {
          glm::vec2 place = position_[i];
          navigation_.follow(i, place, height_[i]);
        } else {
          navigation_.follow(i, position_[i], height_[i]);
        }
      }
    });
  }
  for (float& age : planAge_) age += seconds;
  ++report_.tick;
  countStatus();
  if (record_) record_(view(), report_);
  return report_;
}

}  // namespace forewalk::agents
