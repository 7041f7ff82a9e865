#include "prediction/funnel_tree.h"

#include "navmesh/plan.h"

namespace forewalk::prediction {

using navmesh::turn;

void FunnelTree::reserve(std::size_t nodes) {
  links_.resize(nodes);
  apex_.resize(nodes);
  left_.resize(nodes);
  right_.resize(nodes);
  points_.resize(2 * nodes);
  cornerOf_.resize(2 * nodes);
  path_.resize(nodes);
  pending_.reserve(nodes);
}

void FunnelTree::restart(const navmesh::NavGraph& graph, glm::vec2 source, float height,
                         std::vector<Corner>& corners) {
  graph_ = &graph;
  corners_ = &corners;
  corners.clear();
  corners.push_back({source, height, 0.0f, 0});
  count_ = 0;
  add({0, kNone});
  apex_[0] = 0;
  left_[0] = 0;
  right_[0] = 0;
  points_[0] = source;
  cornerOf_[0] = 0;
}

/// Finds the funnel of a node, and those of the nodes before it that have none yet.
void FunnelTree::find(std::uint32_t node) {
  if (apex_[node] != kNone) return;
  const std::uint32_t parent = links_[node].parent;
  if (apex_[parent] == kNone) {
    std::uint32_t depth = 0;
    for (std::uint32_t at = parent; apex_[at] == kNone; at = links_[at].parent) path_[depth++] = at;
    while (depth > 0) findFromParent(path_[--depth]);
  }
  findFromParent(node);
}

void FunnelTree::findFromParent(std::uint32_t node) {
  const std::uint32_t parent = links_[node].parent;
  const navmesh::Portal& portal = graph_->portals[links_[node].portal];
  points_[2 * node] = portal.left;
  points_[2 * node + 1] = portal.right;
  cornerOf_[2 * node] = kNone;
  cornerOf_[2 * node + 1] = kNone;
  const Funnel funnel = extended({apex_[parent], left_[parent], right_[parent]}, node);
  apex_[node] = funnel.apex;
  left_[node] = funnel.left;
  right_[node] = funnel.right;
}

/// `funnel` of the parent of `node`, narrowed by the portal into `node`.
FunnelTree::Funnel FunnelTree::extended(Funnel funnel, std::uint32_t node) {
  const glm::vec2 apex = points_[funnel.apex];
  const glm::vec2 toLeft = points_[funnel.left] - apex;
  const glm::vec2 toRight = points_[funnel.right] - apex;
  const glm::vec2 toNewLeft = points_[2 * node] - apex;
  const glm::vec2 toNewRight = points_[2 * node + 1] - apex;

  // All of the portal at or beyond one side, perhaps touching its end: the path bends around that end. No
  // angle here exceeds half a turn: whatever lies beyond a portal lies on the far side of its line.
  if (navmesh::cross(toLeft, toNewRight) > 0.0f) return bent(funnel.apex, funnel.left, node);
  if (navmesh::cross(toRight, toNewLeft) < 0.0f) return bent(funnel.apex, funnel.right, node);

  const bool narrowsLeft = navmesh::cross(toLeft, toNewLeft) <= 0.0f;
  const bool narrowsRight = navmesh::cross(toRight, toNewRight) >= 0.0f;
  funnel.left = narrowsLeft ? 2 * node : funnel.left;
  funnel.right = narrowsRight ? 2 * node + 1 : funnel.right;
  return funnel;
}

/// The path from `apex` bends at point `at`: the funnel from there through the portals on the way to
/// `node`, its own included.
FunnelTree::Funnel FunnelTree::bent(std::uint32_t apex, std::uint32_t at, std::uint32_t node) {
  if (cornerOf_[at] == kNone) makeCorner(at, apex);
  Funnel opened{at, at, at};
  const std::uint32_t from = nodeOf(at);
  if (node == from) return opened;
  if (links_[node].parent == from) return extended(opened, node);
  const std::size_t mine = pending_.size();
  for (std::uint32_t next = node; next != from; next = links_[next].parent) pending_.push_back(next);
  while (pending_.size() > mine) {
    const std::uint32_t next = pending_.back();
    pending_.pop_back();
    opened = extended(opened, next);
  }
  return opened;
}

void FunnelTree::makeCorner(std::uint32_t point, std::uint32_t apex) {
  const std::uint32_t previous = cornerOf_[apex];
  const std::uint32_t node = nodeOf(point);
  const navmesh::PortalHeights& heights = graph_->portalHeights[links_[node].portal];
  cornerOf_[point] = static_cast<std::uint32_t>(corners_->size());
  Corner& corner = corners_->emplace_back();
  corner.plan = points_[point];
  corner.height = point == 2 * node ? heights.left : heights.right;
  corner.distance =
      (*corners_)[previous].distance + glm::distance(points_[apex], points_[point]);
  corner.previous = previous;
}

std::uint32_t FunnelTree::cornerBefore(std::uint32_t node, glm::vec2 end, float enough) {
  find(node);
  Funnel funnel{apex_[node], left_[node], right_[node]};
  for (;;) {
    const glm::vec2 apex = points_[funnel.apex];
    if ((*corners_)[cornerOf_[funnel.apex]].distance >= enough) break;
    if (turn(apex, points_[funnel.left], end) > 0.0f) {
      funnel = bent(funnel.apex, funnel.left, node);
    } else if (turn(apex, points_[funnel.right], end) < 0.0f) {
      funnel = bent(funnel.apex, funnel.right, node);
    } else {
      break;
    }
  }
  return cornerOf_[funnel.apex];
}

}  // namespace forewalk::prediction
