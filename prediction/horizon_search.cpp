#include "prediction/horizon_search.h"

#include <algorithm>
#include <cassert>

namespace forewalk::prediction {

using navmesh::KeyQueue;
using navmesh::NavGraph;

HorizonSearch::HorizonSearch(const NavGraph& graph, std::uint32_t polygonLimit)
    : graph_(&graph), limit_(std::max(1u, std::min(polygonLimit, graph.polygonCount()))) {
  for (std::uint32_t polygon = 0; polygon < graph.polygonCount(); ++polygon) {
    mostNeighbours_ =
        std::max(mostNeighbours_, graph.portalStart[polygon + 1] - graph.portalStart[polygon]);
  }
  reach_.resize(graph.polygonCount());
  // Each half-portal of a settled polygon is pushed at most once. That many for the whole limit
  // would be wasteful in large graphs; a queue that fills up is reported like a tree that does.
  queue_.reserve(std::min<std::size_t>(graph.portalCount(), std::size_t{8} * limit_) +
                 mostNeighbours_ + 1);
  tree_.resize(limit_);
  funnels_.reserve(limit_);
  funnels_.reserve(limit_);
  improved_.resize(mostNeighbours_ + 1);
}

void HorizonSearch::reset() {
  for (const SearchNode& node : tree()) reach_[index(node.polygon)] = Reach{};
  for (std::size_t i = 0; i < queue_.size(); ++i) {
    reach_[index(KeyQueue::polygonOf(queue_.at(i)))] = Reach{};
  }
  count_ = 0;
  queue_.clear();
  relaxed_ = 0;
  limitReached_ = false;
}

void HorizonSearch::settle(PolygonId polygon, const Reach& reach) {
  if (count_ > 0) funnels_.add({reach.parent, reach.portal});
  // Field by field into its place: built aside and copied, it would wait for the store buffer.
  SearchNode& node = tree_[count_++];
  node.polygon = polygon;
  node.parent = reach.parent;
  node.portal = reach.portal;
  node.key = reach.key;
  node.corner = kNone;
  node.prevPG = 0;
  node.within = true;
  node.branch = false;
  node.hasWithinChild = false;
  node.hasCutChild = false;
  node.dropped = false;
}

void HorizonSearch::relaxFromSource(const navmesh::Location& source) {
  const std::uint32_t begin = graph_->portalStart[index(source.polygon)];
  const std::uint32_t end = graph_->portalStart[index(source.polygon) + 1];
  relaxed_ += end - begin;
  for (std::uint32_t portal = begin; portal < end; ++portal) {
    const PolygonId to = graph_->portalTo[portal];
    Reach& reach = reach_[index(to)];
    const float key = glm::distance(source.plan, graph_->portalMidpoint[portal]);
    if (key >= reach.key) continue;
    reach.key = key;
    reach.portal = portal;
    reach.parent = 0;
    queue_.push(KeyQueue::entryOf(key, to));
  }
}

/// Looks at the neighbours of the node whose entry is still the queue's top, and takes that out.
void HorizonSearch::relax(std::uint32_t node) {
  const SearchNode& from = tree_[node];
  const std::uint32_t begin = graph_->portalStart[index(from.polygon)];
  const std::uint32_t end = graph_->portalStart[index(from.polygon) + 1];
  const float* length = graph_->successorLength.data() + graph_->successorStart[from.portal];
  const PolygonId* to = graph_->portalTo.data();
  relaxed_ += end - begin;

  // Which neighbours improve is as good as random to the branch predictor, so they are listed
  // without a branch first. A settled polygon's key is not larger than any that comes later: no
  // test of its own.
  std::uint32_t improvedCount = 0;
  for (std::uint32_t portal = begin; portal < end; ++portal) {
    improved_[improvedCount] = portal;
    improvedCount += from.key + length[portal - begin] < reach_[index(to[portal])].key ? 1u : 0u;
  }
  bool topTaken = false;
  for (std::uint32_t i = 0; i < improvedCount; ++i) {
    const std::uint32_t portal = improved_[i];
    Reach& reach = reach_[index(to[portal])];
    const float key = from.key + length[portal - begin];
    if (key >= reach.key) continue;  // two portals to the same neighbour
    reach.key = key;
    reach.portal = portal;
    reach.parent = node;
    const KeyQueue::Entry entry = KeyQueue::entryOf(key, to[portal]);
    if (topTaken) {
      queue_.push(entry);
    } else {
      queue_.replaceTop(entry);
      topTaken = true;
    }
  }
  if (!topTaken) queue_.pop();
}

bool HorizonSearch::isWithin(std::uint32_t node, glm::vec2 source, float horizon,
                             const std::vector<Corner>& corners, Limit limit) {
  SearchNode& at = tree_[node];
  if (at.key + graph_->portalToCentroid[at.portal] <= horizon) return true;
  if (limit == Limit::kKey) return false;
  const glm::vec2 centroid = graph_->centroid[index(at.polygon)];
  if (glm::distance(source, centroid) > horizon) return false;
  // The way by the last bend that all paths through the parent share is no longer than the taut
  // path.
  const Corner& shared = corners[funnels_.cornerShared(at.parent)];
  if (shared.distance + glm::distance(shared.plan, centroid) > horizon) return false;
  at.corner = cornerBefore(node, centroid, horizon);
  const Corner& before = corners[at.corner];
  return before.distance + glm::distance(before.plan, centroid) <= horizon;
}

/// The limit stops the search: the ways that are still in the queue are dropped.
void HorizonSearch::dropQueue() {
  limitReached_ = true;
  for (std::size_t i = 0; i < queue_.size(); ++i) {
    const Reach& reach = reach_[index(KeyQueue::polygonOf(queue_.at(i)))];
    if (reach.treeIndex == kNone) tree_[reach.parent].dropped = true;
  }
}

void HorizonSearch::run(const navmesh::Location& source, float horizon,
                        std::vector<Corner>& corners, Limit limit) {
  assert(index(source.polygon) < graph_->polygonCount());
  reset();
  funnels_.restart(*graph_, source.plan, source.height, corners);

  reach_[index(source.polygon)] = {0.0f, kNone, 0, 0};
  settle(source.polygon, reach_[index(source.polygon)]);
  relaxFromSource(source);

  while (!queue_.empty()) {
    const PolygonId polygon = KeyQueue::polygonOf(queue_.top());
    Reach& reach = reach_[index(polygon)];
    if (reach.treeIndex != kNone) {  // stale: settled by a better key
      queue_.pop();
      continue;
    }
    if (count_ == limit_ || queue_.size() + mostNeighbours_ > queue_.capacity()) {
      dropQueue();
      break;
    }
    const std::uint32_t node = count_;
    reach.treeIndex = node;
    settle(polygon, reach);
    SearchNode& at = tree_[node];
    SearchNode& parent = tree_[at.parent];
    at.prevPG = parent.branch ? at.parent : parent.prevPG;
    at.within = isWithin(node, source.plan, horizon, corners, limit);
    if (at.within) {
      parent.hasWithinChild = true;
      at.branch = graph_->neighbourCount[index(polygon)] > 2;
      relax(node);
    } else {
      parent.hasCutChild = true;
      queue_.pop();
    }
  }
}

}  // namespace forewalk::prediction
