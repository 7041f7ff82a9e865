#include "navmesh/corridor.h"

#include <algorithm>

#include "navmesh/plan.h"

namespace forewalk::navmesh {

bool findCorridor(const NavGraph& graph, const Location& from, const Location& to,
                  CorridorScratch& scratch, std::vector<std::uint32_t>& corridor,
                  const PolygonStates* states) {
  corridor.clear();
  const std::uint32_t polygons = graph.polygonCount();
  if (index(from.polygon) >= polygons || index(to.polygon) >= polygons) return false;
  if (graph.component[index(from.polygon)] != graph.component[index(to.polygon)]) return false;
  if (from.polygon == to.polygon) return true;
  if (states != nullptr && states->cost.empty()) states = nullptr;
  if (states != nullptr && states->isClosed(to.polygon)) return false;
  const auto costOf = [&](PolygonId polygon) {
    return states == nullptr ? 1.0f : states->costOf(polygon);
  };
  const float goalCost = costOf(to.polygon);

  if (scratch.states_.size() < graph.portalCount()) {
    scratch.states_.resize(graph.portalCount(),
                           CorridorScratch::State{0.0f, 0, scratch.stamp_, true});
    scratch.heap_.reserve(graph.portalCount());
  }
  if (++scratch.stamp_ == 0) {  // once in four billion searches the stamps repeat
    for (CorridorScratch::State& state : scratch.states_) state.stamp = 0;
    scratch.stamp_ = 1;
  }
  scratch.heap_.clear();

  using Candidate = CorridorScratch::Candidate;
  const auto later = [](const Candidate& a, const Candidate& b) {
    return a.total != b.total ? a.total > b.total : a.halfPortal > b.halfPortal;
  };
  const auto relax = [&](std::uint32_t h, float length, std::uint32_t previous) {
    CorridorScratch::State& state = scratch.states_[h];
    if (state.stamp == scratch.stamp_ && (state.settled || state.length <= length)) return;
    state = {length, previous, scratch.stamp_, false};
    // Never more than what is left to pay, and just that from the goal's border on.
    const float left = glm::distance(graph.portalMidpoint[h], to.plan);
    const float total = length + (graph.portalTo[h] == to.polygon ? goalCost * left : left);
    scratch.heap_.push_back({total, length, h});
    std::push_heap(scratch.heap_.begin(), scratch.heap_.end(), later);
  };

  const std::uint32_t start = index(from.polygon);
  const float startCost = costOf(from.polygon) == kClosed ? 1.0f : costOf(from.polygon);
  for (std::uint32_t h = graph.portalStart[start]; h < graph.portalStart[start + 1]; ++h) {
    if (costOf(graph.portalTo[h]) == kClosed) continue;
    relax(h, startCost * glm::distance(from.plan, graph.portalMidpoint[h]), h);
  }
  while (!scratch.heap_.empty()) {
    std::pop_heap(scratch.heap_.begin(), scratch.heap_.end(), later);
    const Candidate candidate = scratch.heap_.back();
    scratch.heap_.pop_back();
    const std::uint32_t h = candidate.halfPortal;
    CorridorScratch::State& state = scratch.states_[h];
    if (state.settled || candidate.length != state.length)
      continue;  // a shorter way was found since
    state.settled = true;
    const PolygonId polygon = graph.portalTo[h];
    if (polygon == to.polygon) {
      // `total` of a half-portal into the goal's polygon is the whole walk: nothing beats the
      // first.
      for (std::uint32_t i = h;; i = scratch.states_[i].previous) {
        corridor.push_back(i);
        if (scratch.states_[i].previous == i) break;
      }
      std::reverse(corridor.begin(), corridor.end());
      return true;
    }
    const std::uint32_t first = graph.portalStart[index(polygon)];
    const std::uint32_t end = graph.portalStart[index(polygon) + 1];
    const float cost = costOf(polygon);
    for (std::uint32_t next = first; next < end; ++next) {
      if (next == graph.portalTwin[h]) continue;  // turning round never shortens a way
      if (costOf(graph.portalTo[next]) == kClosed) continue;
      const float step = cost * graph.successorLength[graph.successorStart[h] + next - first];
      relax(next, candidate.length + step, h);
    }
  }
  return false;
}

namespace {

constexpr float kBeside = 1e-3f;  // how far a path may pass beside, metres

/// Whether somebody at `corner`, on the outline of a polygon, who walks toward `goal` walks into
/// it.
bool headsInto(const NavGraph& graph, PolygonId polygon, glm::vec2 corner, glm::vec2 goal) {
  const std::span<const glm::vec2> ring = graph.ringOf(polygon);
  glm::vec2 from = ring.back();
  for (const glm::vec2 to : ring) {
    const glm::vec2 edge = to - from;
    const float length = glm::length(edge);
    const float along = glm::dot(corner - from, edge) / length;
    const bool touches = std::abs(cross(edge, corner - from)) < kBeside * length &&
                         along > -kBeside && along < length + kBeside;
    if (touches && cross(edge, goal - from) < -kBeside * length) return false;
    from = to;
  }
  return true;
}

/// Goes round `corner`, kept on the left (or right), up to the polygon that somebody who goes on to
/// `goal` walks into. Appends the half-portals crossed.
PolygonId goRound(const NavGraph& graph, PolygonId polygon, glm::vec2 corner, glm::vec2 goal,
                  bool onLeft, std::vector<std::uint32_t>& corridor) {
  for (std::uint32_t steps = 0; steps < graph.polygonCount(); ++steps) {
    if (headsInto(graph, polygon, corner, goal)) break;
    const std::uint32_t end = graph.portalStart[index(polygon) + 1];
    std::uint32_t h = graph.portalStart[index(polygon)];
    for (; h < end; ++h) {
      const glm::vec2 inner = onLeft ? graph.portals[h].left : graph.portals[h].right;
      if (glm::distance(inner, corner) < kBeside) break;
    }
    if (h == end) break;
    corridor.push_back(h);
    polygon = graph.portalTo[h];
  }
  return polygon;
}

}  // namespace

bool corridorAlong(const NavGraph& graph, PolygonId first, std::span<const glm::vec2> path,
                   std::vector<std::uint32_t>& corridor) {
  corridor.clear();
  PolygonId polygon = first;
  for (std::size_t i = 1; i < path.size(); ++i) {
    const glm::vec2 goal = path[i];
    const glm::vec2 walk = goal - path[i - 1];
    const float length = glm::length(walk);
    if (i > 1) {
      const bool left = turn(path[i - 2], path[i - 1], goal) > 0.0f;
      polygon = goRound(graph, polygon, path[i - 1], goal, left, corridor);
    }
    // No straight walk crosses a polygon twice, but it may graze many about one corner.
    for (std::uint32_t steps = 0; !contains(graph, polygon, goal, kBeside); ++steps) {
      if (steps > graph.polygonCount()) return false;
      std::uint32_t best = graph.portalCount();
      float bestBeside = kBeside;
      const std::uint32_t end = graph.portalStart[index(polygon) + 1];
      for (std::uint32_t h = graph.portalStart[index(polygon)]; h < end; ++h) {
        if (!corridor.empty() && h == graph.portalTwin[corridor.back()]) continue;
        const Portal& portal = graph.portals[h];
        if (turn(portal.right, portal.left, goal) > 0.0f) continue;  // not beyond it
        // How far beside the portal the walk passes.
        const float left = cross(walk, portal.left - path[i - 1]) / length;
        const float right = cross(walk, portal.right - path[i - 1]) / length;
        const float beside = std::max({0.0f, -left, right});
        if (beside < bestBeside) {
          bestBeside = beside;
          best = h;
        }
      }
      if (best == graph.portalCount()) return false;
      corridor.push_back(best);
      polygon = graph.portalTo[best];
    }
  }
  return true;
}

}  // namespace forewalk::navmesh
