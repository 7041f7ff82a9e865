#include "agents/projection.h"

#include <algorithm>
#include <cmath>

#include "agents/slices.h"

namespace forewalk::agents {
namespace {

constexpr float kGap = 1e-3f;  // share of the radii's sum

bool stays(const AgentsView& agents, std::uint32_t agent) {
  return (agents.flags[agent] & (kHuman | kStatic)) != 0;
}

/// How far two bodies reach into each other, metres; negative: the gap.
float depthOf(const AgentsView& agents, std::uint32_t a, std::uint32_t b, glm::vec2 atA,
              glm::vec2 atB) {
  return agents.radius[a] + agents.radius[b] - glm::distance(atA, atB);
}

/// From b to a. Coincident bodies part along an axis that depends on their ids alone, and opposite
/// ways.
glm::vec2 apart(const AgentsView& agents, std::uint32_t a, std::uint32_t b, glm::vec2 atA,
                glm::vec2 atB) {
  const glm::vec2 between = atA - atB;
  const float distance = glm::length(between);
  if (distance > 1e-6f) return between / distance;
  return {number(agents.id[a]) < number(agents.id[b]) ? -1.0f : 1.0f, 0.0f};
}

}  // namespace

float Projection::apply(const AgentsView& agents, std::span<const glm::vec2> before,
                        const WallIndex& walls, const ProjectionSettings& settings,
                        NeighbourIndex& index, const navmesh::ForEach& forEach,
                        std::span<glm::vec2> positions) {
  const std::uint32_t n = agents.size();
  if (n == 0) return 0.0f;
  float widest = 0.0f, farthest = 0.0f;
  for (std::uint32_t i = 0; i < n; ++i) {
    widest = std::max(widest, agents.radius[i]);
    farthest = std::max(farthest, glm::distance(before[i], positions[i]));
  }
  // No correction moves anybody farther than this, so the contacts found once are all there are.
  const float leash = widest;
  index.build(agents, 2.0f * widest);
  slices_.resize(kSlices);
  rows_.resize(n);
  forSlices(n, forEach, [&](std::size_t slice, std::uint32_t begin, std::uint32_t end) {
    Slice& own = slices_[slice];
    own.contacts.clear();
    own.walls.clear();
    for (std::uint32_t i = begin; i < end; ++i) {
      Row& row = rows_[i];
      row = {static_cast<std::uint32_t>(own.contacts.size()), 0,
             static_cast<std::uint32_t>(own.walls.size()), 0};
      if (stays(agents, i)) continue;
      index.visitNear(positions[i], agents.radius[i] + widest + 2.0f * (leash + farthest),
                      [&](std::uint32_t j) {
                        if (j == i || std::abs(agents.height[i] - agents.height[j]) > 2.0f) return;
                        const glm::vec2 between = positions[i] - positions[j];
                        const float reach =
                            agents.radius[i] + agents.radius[j] + 2.0f * (leash + farthest);
                        const float squared = glm::dot(between, between);
                        if (squared < reach * reach) own.contacts.push_back({j, squared});
                      });
      row.contactCount = static_cast<std::uint32_t>(own.contacts.size()) - row.contacts;
      std::sort(own.contacts.begin() + row.contacts, own.contacts.end(),
                [&](const Neighbour& a, const Neighbour& b) {
                  return a.squaredDistance < b.squaredDistance ||
                         (a.squaredDistance == b.squaredDistance &&
                          number(agents.id[a.index]) < number(agents.id[b.index]));
                });
      // Seen from where the step began, so that who was pushed through a wall comes back.
      walls.nearest(before[i], agents.height[i], agents.radius[i] + farthest + leash, 16, own.near);
      for (const NearWall& wall : own.near) own.walls.push_back(wall.index);
      row.wallCount = static_cast<std::uint32_t>(own.near.size());
    }
  });

  from_.assign(positions.begin(), positions.end());
  now_ = from_;
  next_ = from_;
  const auto keepFromWalls = [&](const Slice& own, std::uint32_t i, glm::vec2 at) {
    const Row& row = rows_[i];
    for (std::uint32_t k = row.walls; k < row.walls + row.wallCount; ++k) {
      const Wall& wall = walls.walls()[own.walls[k]];
      const float kept = wallRadius(agents.radius[i], wall);
      const glm::vec2 nearest = nearestOn(wall, at);
      const glm::vec2 off = at - nearest;
      const float distance = glm::length(off);
      if (wall.isCircle()) {
        if (distance < kept) {
          at = nearest + (distance > 1e-6f ? off / distance : glm::vec2(1.0f, 0.0f)) * kept;
        }
        continue;
      }
      const glm::vec2 along = glm::normalize(wall.to - wall.from);
      const glm::vec2 inward(-along.y, along.x);
      const bool behind = glm::dot(off, inward) < 0.0f;
      // Behind the wall beside its ends is where one goes around the corner, not through.
      const bool beside = nearest == wall.from || nearest == wall.to;
      if (behind && beside) continue;
      if (behind) {
        at = nearest + inward * kept;
      } else if (distance < kept) {
        at = nearest + (distance > 1e-6f ? off / distance : inward) * kept;
      }
    }
    return at;
  };

  for (std::uint32_t round = 0; round < settings.iterations; ++round) {
    forSlices(n, forEach, [&](std::size_t slice, std::uint32_t begin, std::uint32_t end) {
      Slice& own = slices_[slice];
      own.deepest = 0.0f;
      for (std::uint32_t i = begin; i < end; ++i) {
        next_[i] = now_[i];
        if (stays(agents, i)) continue;
        const Row& row = rows_[i];
        glm::vec2 sum(0.0f);
        float count = 0.0f;
        for (std::uint32_t k = row.contacts; k < row.contacts + row.contactCount; ++k) {
          const std::uint32_t j = own.contacts[k].index;
          // A hair's gap is left, so that models do not take who stands close for who overlaps.
          const float depth = depthOf(agents, i, j, now_[i], now_[j]) +
                              kGap * (agents.radius[i] + agents.radius[j]);
          if (depth <= 0.0f) continue;
          own.deepest = std::max(own.deepest, depth / (agents.radius[i] + agents.radius[j]));
          const float share = stays(agents, j) ? 1.0f : 0.5f;
          sum += share * depth * apart(agents, i, j, now_[i], now_[j]);
          count += 1.0f;
        }
        // A little more than the average: packs spread faster, pairs still part at once.
        if (count > 0.0f) next_[i] += sum * (count > 1.0f ? 1.5f / count : 1.0f);
        next_[i] = keepFromWalls(own, i, next_[i]);
        const glm::vec2 moved = next_[i] - from_[i];
        const float length = glm::length(moved);
        if (length > leash) next_[i] = from_[i] + moved * (leash / length);
      }
    });
    std::swap(now_, next_);
    float deepest = 0.0f;
    for (const Slice& own : slices_) deepest = std::max(deepest, own.deepest);
    if (deepest <= kGap + 0.25f * settings.tolerance) break;
  }

  // Undo what is still too deep, until nobody is undone any more.
  undone_.assign(n, 0);
  for (bool changed = true; changed;) {
    forSlices(n, forEach, [&](std::size_t slice, std::uint32_t begin, std::uint32_t end) {
      Slice& own = slices_[slice];
      own.changed = false;
      own.deepest = 0.0f;
      for (std::uint32_t i = begin; i < end; ++i) {
        next_[i] = now_[i];
        if (stays(agents, i)) continue;
        const Row& row = rows_[i];
        for (std::uint32_t k = row.contacts; k < row.contacts + row.contactCount; ++k) {
          const std::uint32_t j = own.contacts[k].index;
          const float reach = agents.radius[i] + agents.radius[j];
          const float depth = depthOf(agents, i, j, now_[i], now_[j]) / reach;
          if (depth <= 0.0f) continue;
          own.deepest = std::max(own.deepest, depth);
          if (undone_[i] || depth <= settings.tolerance) continue;
          if (depth <= depthOf(agents, i, j, before[i], before[j]) / reach) continue;
          next_[i] = before[i];
        }
        if (next_[i] != now_[i]) own.changed = true;
      }
    });
    changed = false;
    for (const Slice& own : slices_) changed = changed || own.changed;
    for (std::uint32_t i = 0; changed && i < n; ++i) {
      if (next_[i] != now_[i]) undone_[i] = 1;
    }
    std::swap(now_, next_);
  }
  float deepest = 0.0f;
  for (const Slice& own : slices_) deepest = std::max(deepest, own.deepest);
  std::copy(now_.begin(), now_.end(), positions.begin());
  return deepest;
}

}  // namespace forewalk::agents
