#include "navmesh/corridor.h"

#include <algorithm>

namespace forewalk::navmesh {

bool findCorridor(const NavGraph& graph, const Location& from, const Location& to,
                  CorridorScratch& scratch, std::vector<std::uint32_t>& corridor) {
  corridor.clear();
  const std::uint32_t polygons = graph.polygonCount();
  if (index(from.polygon) >= polygons || index(to.polygon) >= polygons) return false;
  if (graph.component[index(from.polygon)] != graph.component[index(to.polygon)]) return false;
  if (from.polygon == to.polygon) return true;

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
    const float total = length + glm::distance(graph.portalMidpoint[h], to.plan);
    scratch.heap_.push_back({total, length, h});
    std::push_heap(scratch.heap_.begin(), scratch.heap_.end(), later);
  };

  const std::uint32_t start = index(from.polygon);
  for (std::uint32_t h = graph.portalStart[start]; h < graph.portalStart[start + 1]; ++h) {
    relax(h, glm::distance(from.plan, graph.portalMidpoint[h]), h);
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
    for (std::uint32_t next = first; next < end; ++next) {
      if (next == graph.portalTwin[h]) continue;  // turning round never shortens a way
      const float step = graph.successorLength[graph.successorStart[h] + next - first];
      relax(next, candidate.length + step, h);
    }
  }
  return false;
}

}  // namespace forewalk::navmesh
