#include "prediction/horizon_search.h"

#include <algorithm>
#include <cassert>

#include "navmesh/plan.h"

namespace forewalk::prediction {

using navmesh::NavGraph;
using navmesh::turn;

namespace {

/// A funnel seen from one of its sides: `near` is the end of the chain a point is added to.
struct Funnel {
  std::uint32_t near;
  std::uint32_t far;
  std::uint32_t apex;
};

/// Where the taut path to `point` leaves the funnel. `side` is +1 where `near` is the left chain, -1
/// where it is the right one. Moves the apex when the path runs along the far chain.
std::uint32_t tangent(const Corner* corners, Funnel& funnel, glm::vec2 point, float side) {
  for (std::uint32_t at = funnel.near; at != funnel.apex;) {
    const std::uint32_t before = corners[at].previous;
    if (side * turn(corners[before].plan, corners[at].plan, point) > 0.0f) return at;
    at = before;
  }
  for (std::uint32_t at = funnel.far; at != funnel.apex;) {
    const std::uint32_t before = corners[at].previous;
    if (side * turn(corners[before].plan, corners[at].plan, point) < 0.0f) {
      funnel.apex = at;
      return at;
    }
    at = before;
  }
  return funnel.apex;
}

}  // namespace

HorizonSearch::HorizonSearch(const NavGraph& graph, std::uint32_t polygonLimit)
    : graph_(&graph), limit_(std::max(1u, std::min(polygonLimit, graph.polygonCount()))) {
  reach_.resize(graph.polygonCount());
  // Every settled polygon pushes each neighbour at most once, so this is enough for most graphs; a
  // queue that fills up is reported like a tree that does.
  queue_.reserve(std::min<std::size_t>(graph.portalCount(), std::size_t{8} * limit_) + 1);
  tree_.reserve(limit_);
}

void HorizonSearch::reset() {
  for (const SearchNode& node : tree_) reach_[index(node.polygon)] = Reach{};
  for (std::size_t i = 0; i < queue_.size(); ++i) reach_[index(queue_.at(i).polygon)] = Reach{};
  tree_.clear();
  queue_.clear();
  relaxed_ = 0;
  limitReached_ = false;
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
    if (queue_.full()) {
      limitReached_ = true;
      return;
    }
    reach.key = key;
    reach.portal = portal;
    reach.parent = 0;
    queue_.push(key, to);
  }
}

void HorizonSearch::relax(std::uint32_t node) {
  const SearchNode& from = tree_[node];
  const std::uint32_t begin = graph_->portalStart[index(from.polygon)];
  const std::uint32_t end = graph_->portalStart[index(from.polygon) + 1];
  const float* length = graph_->successorLength.data() + graph_->successorStart[from.portal];
  const PolygonId* to = graph_->portalTo.data();
  relaxed_ += end - begin;
  for (std::uint32_t portal = begin; portal < end; ++portal, ++length) {
    Reach& reach = reach_[index(to[portal])];
    // A settled polygon's key is not larger than any that comes later, so it needs no test of its own.
    const float key = from.key + *length;
    if (key >= reach.key) continue;
    if (queue_.full()) {
      tree_[node].dropped = true;
      limitReached_ = true;
      return;
    }
    reach.key = key;
    reach.portal = portal;
    reach.parent = node;
    queue_.push(key, to[portal]);
  }
}

void HorizonSearch::extendFunnel(SearchNode& node, std::vector<Corner>& corners) const {
  const SearchNode& parent = tree_[node.parent];
  const navmesh::Portal& portal = graph_->portals[node.portal];
  node.apex = parent.apex;
  node.left = parent.left;
  node.right = parent.right;

  // One end of the portal after the other; where it is the old end, nothing changes.
  const auto narrow = [&](std::uint32_t& nearEnd, std::uint32_t farEnd, glm::vec2 point, float height,
                          float side) {
    if (corners[nearEnd].plan == point) return;
    Funnel funnel{nearEnd, farEnd, node.apex};
    const std::uint32_t before = tangent(corners.data(), funnel, point, side);
    node.apex = funnel.apex;
    const float distance = corners[before].distance + glm::distance(corners[before].plan, point);
    nearEnd = static_cast<std::uint32_t>(corners.size());
    corners.push_back({point, height, distance, before});
  };
  const navmesh::PortalHeights& heights = graph_->portalHeights[node.portal];
  narrow(node.left, node.right, portal.left, heights.left, 1.0f);
  narrow(node.right, node.left, portal.right, heights.right, -1.0f);
}

std::uint32_t HorizonSearch::cornerBefore(const std::vector<Corner>& corners, std::uint32_t node,
                                          glm::vec2 end) const {
  const SearchNode& at = tree_[node];
  Funnel funnel{at.left, at.right, at.apex};
  return tangent(corners.data(), funnel, end, 1.0f);
}

void HorizonSearch::dropQueue() {
  limitReached_ = true;
  for (std::size_t i = 0; i < queue_.size(); ++i) {
    const Reach& reach = reach_[index(queue_.at(i).polygon)];
    if (reach.treeIndex == kNone) tree_[reach.parent].dropped = true;
  }
}

void HorizonSearch::run(const navmesh::Location& source, float horizon,
                        std::vector<Corner>& corners) {
  assert(index(source.polygon) < graph_->polygonCount());
  reset();
  corners.clear();
  corners.push_back({source.plan, source.height, 0.0f, 0});

  reach_[index(source.polygon)] = {0.0f, kNone, 0, 0};
  tree_.push_back({.polygon = source.polygon, .parent = 0, .portal = kNone, .key = 0.0f, .prevPG = 0,
                   .apex = 0, .left = 0, .right = 0, .within = true, .branch = false,
                   .hasWithinChild = false, .hasCutChild = false, .dropped = false});
  relaxFromSource(source);

  while (!queue_.empty()) {
    const auto [key, polygon] = queue_.pop();
    Reach& reach = reach_[index(polygon)];
    if (reach.treeIndex != kNone) continue;  // stale: settled by a better key
    if (tree_.size() == limit_) {
      queue_.push(key, polygon);
      dropQueue();
      return;
    }

    const std::uint32_t at = static_cast<std::uint32_t>(tree_.size());
    reach.treeIndex = at;
    SearchNode node{.polygon = polygon, .parent = reach.parent, .portal = reach.portal,
                    .key = reach.key, .prevPG = 0, .apex = 0, .left = 0, .right = 0, .within = true,
                    .branch = false, .hasWithinChild = false, .hasCutChild = false, .dropped = false};
    SearchNode& parent = tree_[node.parent];
    node.prevPG = parent.branch ? node.parent : parent.prevPG;
    extendFunnel(node, corners);
    tree_.push_back(node);

    const glm::vec2 centroid = graph_->centroid[index(polygon)];
    bool within = node.key + graph_->portalToCentroid[node.portal] <= horizon;
    if (!within && glm::distance(source.plan, centroid) <= horizon) {
      const Corner& before = corners[cornerBefore(corners, at, centroid)];
      within = before.distance + glm::distance(before.plan, centroid) <= horizon;
    }
    tree_[at].within = within;
    (within ? parent.hasWithinChild : parent.hasCutChild) = true;
    if (!within) continue;
    tree_[at].branch = graph_->neighbourCount[index(polygon)] > 2;
    relax(at);
  }
}

}  // namespace forewalk::prediction
