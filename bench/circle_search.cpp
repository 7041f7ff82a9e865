#include "bench/circle_search.h"

#include <algorithm>

namespace forewalk::bench {

using navmesh::index;
using navmesh::PolygonId;

namespace {

/// Squared distance on the plan, as dtDistancePtSegSqr2D.
float distanceSquared(glm::vec2 point, const navmesh::Portal& segment) {
  const glm::vec2 along = segment.right - segment.left;
  const glm::vec2 to = point - segment.left;
  const float length = glm::dot(along, along);
  float share = glm::dot(along, to);
  if (length > 0.0f) share /= length;
  share = std::clamp(share, 0.0f, 1.0f);
  const glm::vec2 gap = share * along - to;
  return glm::dot(gap, gap);
}

}  // namespace

CircleSearch::CircleSearch(const navmesh::NavGraph& graph)
    : graph_(&graph), reach_(graph.polygonCount()) {
  for (std::uint32_t portal = 0; portal < graph.portalCount(); ++portal) {
    const navmesh::PortalHeights heights = graph.portalHeights[portal];
    midpoint_.push_back(
        glm::vec3(graph.portalMidpoint[portal], 0.5f * (heights.left + heights.right)));
  }
  successorLength_.resize(graph.successorLength.size());
  for (std::uint32_t portal = 0; portal < graph.portalCount(); ++portal) {
    const std::uint32_t to = index(graph.portalTo[portal]);
    for (std::uint32_t next = graph.portalStart[to]; next < graph.portalStart[to + 1]; ++next) {
      successorLength_[graph.successorStart[portal] + next - graph.portalStart[to]] =
          glm::distance(midpoint_[portal], midpoint_[next]);
    }
  }
  queue_.reserve(graph.portalCount() + 1);
  visits_.reserve(graph.polygonCount());
}

const std::vector<CircleSearch::Visit>& CircleSearch::run(const navmesh::Location& start,
                                                          float radius) {
  const navmesh::NavGraph& graph = *graph_;
  const glm::vec3 centre(start.plan, start.height);
  const float radiusSquared = radius * radius;
  for (const Visit& visit : visits_) reach_[visit.polygon] = Reach{};
  visits_.clear();
  reach_[index(start.polygon)].cost = 0.0f;
  queue_.push(navmesh::KeyQueue::entryOf(0.0f, start.polygon));
  while (!queue_.empty()) {
    const std::uint32_t at = index(navmesh::KeyQueue::polygonOf(queue_.top()));
    queue_.pop();
    Reach& here = reach_[at];
    if (here.closed) continue;
    here.closed = true;
    visits_.push_back({at, here.parent, here.cost});
    const std::uint32_t begin = graph.portalStart[at];
    const std::uint32_t end = graph.portalStart[at + 1];
    const float* lengths = here.seenThrough == 0xffffffffu
                               ? nullptr
                               : successorLength_.data() + graph.successorStart[here.seenThrough];
    for (std::uint32_t portal = begin; portal < end; ++portal) {
      const std::uint32_t to = index(graph.portalTo[portal]);
      Reach& there = reach_[to];
      if (there.closed || distanceSquared(start.plan, graph.portals[portal]) > radiusSquared)
        continue;
      if (there.seenThrough == 0xffffffffu) there.seenThrough = portal;
      float length;
      if (there.seenThrough == portal && lengths != nullptr) {
        length = lengths[portal - begin];
      } else {
        const glm::vec3 from = lengths == nullptr ? centre : midpoint_[here.seenThrough];
        length = glm::distance(from, midpoint_[there.seenThrough]);
      }
      const float total = here.cost + length;
      if (total >= there.cost) continue;
      there.cost = total;
      there.parent = at;
      queue_.push(navmesh::KeyQueue::entryOf(total, graph.portalTo[portal]));
    }
  }
  return visits_;
}

}  // namespace forewalk::bench
