#include "prediction/funnel_tree.h"

#include <limits>

#include "navmesh/plan.h"

namespace forewalk::prediction {

using navmesh::turn;

void FunnelTree::reserve(std::size_t nodes) {
  links_.resize(nodes);
  apex_.resize(nodes);
  left_.resize(nodes);
  right_.resize(nodes);
  opened_.resize(nodes);
  points_.resize(2 * nodes);
  cornerOf_.resize(2 * nodes);
  path_.resize(nodes);
  stack_.resize(nodes);
}

void FunnelTree::restart(const navmesh::NavGraph& graph, glm::vec2 source, float height,
                         std::vector<Corner>& corners, const navmesh::LinkWay* ways) {
  graph_ = &graph;
  ways_ = ways;
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
  if (links_[node].portal >= kByLink) {
    findBehindLink(node);
    return;
  }
  const std::uint32_t parent = links_[node].parent;
  const navmesh::Portal& portal = graph_->portals[links_[node].portal];
  points_[2 * node] = portal.left;
  points_[2 * node + 1] = portal.right;
  cornerOf_[2 * node] = kNone;
  cornerOf_[2 * node + 1] = kNone;
  stack_[0] = node;
  const Funnel funnel = narrowed({apex_[parent], left_[parent], right_[parent]}, 1);
  apex_[node] = funnel.apex;
  left_[node] = funnel.left;
  right_[node] = funnel.right;
}

/// The funnel of a node that is entered by a link opens at the exit.
void FunnelTree::findBehindLink(std::uint32_t node) {
  const navmesh::LinkWay& way = ways_[links_[node].portal & ~kByLink];
  const std::uint32_t before =
      cornerBefore(links_[node].parent, way.entry, std::numeric_limits<float>::infinity());
  const std::uint32_t exit = 2 * node, entry = exit + 1;
  points_[exit] = way.exit;
  points_[entry] = way.entry;
  cornerOf_[entry] = static_cast<std::uint32_t>(corners_->size());
  cornerOf_[exit] = cornerOf_[entry] + 1;
  const Corner& last = (*corners_)[before];
  const float reached = last.distance + glm::distance(last.plan, way.entry);
  corners_->push_back({way.entry, way.entryHeight, reached, before});
  corners_->push_back({way.exit, way.exitHeight, reached + way.length, cornerOf_[entry]});
  apex_[node] = left_[node] = right_[node] = exit;
}

/// `funnel` narrowed by the portals into the nodes of stack_[0, depth), the last of them first.
FunnelTree::Funnel FunnelTree::narrowed(Funnel funnel, std::uint32_t depth) {
  while (depth > 0) {
    const std::uint32_t node = stack_[depth - 1];
    const glm::vec2 apex = points_[funnel.apex];
    const glm::vec2 toLeft = points_[funnel.left] - apex;
    const glm::vec2 toRight = points_[funnel.right] - apex;
    const glm::vec2 toNewLeft = points_[2 * node] - apex;
    const glm::vec2 toNewRight = points_[2 * node + 1] - apex;

    // All of the portal at or beyond one side, perhaps touching its end: the path bends around that
    // end. No angle here exceeds half a turn: whatever lies beyond a portal lies on the far side of
    // its line.
    const bool beyondLeft = navmesh::cross(toLeft, toNewRight) > 0.0f;
    const bool beyondRight = navmesh::cross(toRight, toNewLeft) < 0.0f;
    if (beyondLeft || beyondRight) {
      const std::uint32_t at = beyondLeft ? funnel.left : funnel.right;
      bend(funnel.apex, at);
      funnel = open(at, links_[node].parent, depth);
      continue;
    }
    const bool narrowsLeft = navmesh::cross(toLeft, toNewLeft) <= 0.0f;
    const bool narrowsRight = navmesh::cross(toRight, toNewRight) >= 0.0f;
    funnel.left = narrowsLeft ? 2 * node : funnel.left;
    funnel.right = narrowsRight ? 2 * node + 1 : funnel.right;
    --depth;
  }
  return funnel;
}

/// A funnel from point `at`, to be narrowed by the nodes that are pushed for it, up to `node`.
FunnelTree::Funnel FunnelTree::open(std::uint32_t at, std::uint32_t node, std::uint32_t& depth) {
  for (; node != nodeOf(at); node = links_[node].parent) {
    if (opened_[node].at == at) return opened_[node].funnel;
    stack_[depth++] = node;
  }
  return {at, at, at};
}

/// The path from `apex` bends at point `at`: makes a corner of it, once.
void FunnelTree::bend(std::uint32_t apex, std::uint32_t at) {
  if (cornerOf_[at] != kNone) return;
  const std::uint32_t previous = cornerOf_[apex];
  const std::uint32_t node = nodeOf(at);
  const navmesh::PortalHeights& heights = graph_->portalHeights[links_[node].portal];
  cornerOf_[at] = static_cast<std::uint32_t>(corners_->size());
  Corner& corner = corners_->emplace_back();
  corner.plan = points_[at];
  corner.height = at == 2 * node ? heights.left : heights.right;
  corner.distance = (*corners_)[previous].distance + glm::distance(points_[apex], points_[at]);
  corner.previous = previous;
}

std::uint32_t FunnelTree::cornerBefore(std::uint32_t node, glm::vec2 end, float enough) {
  find(node);
  Funnel funnel{apex_[node], left_[node], right_[node]};
  for (;;) {
    const glm::vec2 apex = points_[funnel.apex];
    const bool beyondLeft = turn(apex, points_[funnel.left], end) > 0.0f;
    const bool beyondRight = turn(apex, points_[funnel.right], end) < 0.0f;
    if (!beyondLeft && !beyondRight) break;
    if ((*corners_)[cornerOf_[funnel.apex]].distance >= enough) break;
    const std::uint32_t at = beyondLeft ? funnel.left : funnel.right;
    bend(funnel.apex, at);
    std::uint32_t depth = 0;
    funnel = open(at, node, depth);
    if (depth == 0) continue;
    funnel = narrowed(funnel, depth);
    opened_[node].at = at;
    opened_[node].funnel.apex = funnel.apex;
    opened_[node].funnel.left = funnel.left;
    opened_[node].funnel.right = funnel.right;
  }
  return cornerOf_[funnel.apex];
}

}  // namespace forewalk::prediction
