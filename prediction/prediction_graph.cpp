#include "prediction/prediction_graph.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "navmesh/plan.h"

namespace forewalk::prediction {

namespace {

/// One straight piece of the taut path to a node, walked toward the node.
struct Piece {
  glm::vec2 from, to;
  float fromHeight, toHeight;
  float fromDistance, toDistance;
};

/// Calls `visit(piece)` from the node back to the source until it returns false.
template <typename Visit>
void forEachPieceBackwards(const PredictionGraph& graph, const Node& node, Visit visit) {
  glm::vec2 to = node.plan;
  float toHeight = node.height;
  float toDistance = node.distance;
  for (std::uint32_t at = node.corner;; at = graph.corners[at].previous) {
    const Corner& corner = graph.corners[at];
    if (corner.distance < toDistance) {
      const Piece piece{corner.plan, to, corner.height, toHeight, corner.distance, toDistance};
      if (!visit(piece)) return;
      to = corner.plan;
      toHeight = corner.height;
      toDistance = corner.distance;
    }
    if (at == 0) return;
  }
}

std::uint64_t mix(std::uint64_t hash, std::uint64_t value) {
  // FNV-1a over 8 bytes at once, then a multiply-shift to spread the high bits.
  hash = (hash ^ value) * 0x100000001b3ull;
  return hash ^ (hash >> 29);
}

std::uint64_t bitsOf(float value) {
  std::uint32_t bits;
  std::memcpy(&bits, &value, sizeof bits);
  return bits;
}

}  // namespace

WayPoint pointAlong(const PredictionGraph& graph, NodeId id, float s) {
  const Node& node = graph.node(id);
  WayPoint point{node.plan, node.height, glm::vec2(0.0f)};
  s = std::clamp(s, 0.0f, node.distance);
  forEachPieceBackwards(graph, node, [&](const Piece& piece) {
    const float length = piece.toDistance - piece.fromDistance;
    const float share = std::max(0.0f, s - piece.fromDistance) / length;
    point.plan = piece.from + share * (piece.to - piece.from);
    point.height = piece.fromHeight + share * (piece.toHeight - piece.fromHeight);
    const glm::vec2 walk = piece.to - piece.from;
    const float walked = glm::length(walk);
    if (walked > 0.0f) point.direction = walk / walked;
    return piece.fromDistance > s;  // goes on until the piece holds s
  });
  return point;
}

bool nextBend(const PredictionGraph& graph, NodeId id, float after, float minAngle, Bend& bend) {
  bool found = false;
  glm::vec2 next(0.0f);
  bool hasNext = false;
  forEachPieceBackwards(graph, graph.node(id), [&](const Piece& piece) {
    const glm::vec2 walk = piece.to - piece.from;
    if (hasNext && piece.toDistance > after) {
      const float angle = std::atan2(navmesh::cross(walk, next), glm::dot(walk, next));
      if (std::abs(angle) >= minAngle) {
        bend = {piece.toDistance, angle, piece.to};
        found = true;  // the last one found going backwards is the first ahead
      }
    }
    next = walk;
    hasNext = true;
    return piece.toDistance > after;
  });
  return found;
}

NodeId branchAhead(const PredictionGraph& graph) {
  if (graph.nodes.empty()) return kNoNode;
  const auto children = graph.childrenOf(NodeId{0});
  if (children.size() != 1 || !graph.node(children[0]).branch) return kNoNode;
  return children[0];
}

void wayTo(const PredictionGraph& graph, NodeId id, std::vector<glm::vec3>& way) {
  const Node& node = graph.node(id);
  way.clear();
  way.push_back(node.position());
  forEachPieceBackwards(graph, node, [&](const Piece& piece) {
    way.push_back(navmesh::toSpace(piece.from, piece.fromHeight));
    return true;
  });
  std::reverse(way.begin(), way.end());
}

std::uint64_t hashOf(const PredictionGraph& graph) {
  std::uint64_t hash = 0xcbf29ce484222325ull;
  const auto add = [&](std::uint64_t value) { hash = mix(hash, value); };
  const auto addFloat = [&](float value) { hash = mix(hash, bitsOf(value)); };
  addFloat(graph.horizon);
  addFloat(graph.completeTo);
  add(graph.flags);
  add(graph.nodes.size());
  for (const Node& node : graph.nodes) {
    add(static_cast<std::uint64_t>(node.kind) << 16 | static_cast<std::uint64_t>(node.reason) << 8 |
        static_cast<std::uint64_t>(node.branch));
    add(index(node.polygon));
    addFloat(node.plan.x);
    addFloat(node.plan.y);
    addFloat(node.height);
    addFloat(node.distance);
    add(index(node.prev));
  }
  add(graph.edges.size());
  for (const Edge& edge : graph.edges) {
    add(static_cast<std::uint64_t>(edge.kind));
    add(std::uint64_t{index(edge.from)} << 32 | index(edge.to));
    addFloat(edge.length);
    for (const PolygonId polygon : graph.corridorOf(edge)) add(index(polygon));
    for (const glm::vec2 point : graph.pathOf(edge)) {
      addFloat(point.x);
      addFloat(point.y);
    }
  }
  return hash;
}

}  // namespace forewalk::prediction
