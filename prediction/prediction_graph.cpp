#include "prediction/prediction_graph.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "navmesh/corridor.h"
#include "navmesh/funnel.h"
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
    }
    // Also where no length lies between: the two ends of a link of none are far apart.
    to = corner.plan;
    toHeight = corner.height;
    toDistance = corner.distance;
    if (at == 0) return;
  }
}

constexpr float kLiftTolerance = 0.02f;  // how far a lifted path may leave the ground, metres

/// The half-portal from `from` to its neighbour `to`. Where several join the two they lie on one
/// line, for both polygons are convex; the longest tells best which line that is.
std::uint32_t portalBetween(const navmesh::NavGraph& navGraph, PolygonId from, PolygonId to) {
  const std::uint32_t begin = navGraph.portalStart[navmesh::index(from)];
  const std::uint32_t end = navGraph.portalStart[navmesh::index(from) + 1];
  std::uint32_t best = begin;
  float longest = -1.0f;
  for (std::uint32_t h = begin; h < end; ++h) {
    if (navGraph.portalTo[h] != to) continue;
    const float length = glm::distance(navGraph.portals[h].left, navGraph.portals[h].right);
    if (length > longest) {
      longest = length;
      best = h;
    }
  }
  return best;
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

void clear(PredictionGraph& graph) {
  graph.flags = kGraphComplete;
  graph.nodes.clear();
  graph.children.clear();
  graph.edges.clear();
  graph.corners.clear();
  graph.corridorPolygons.clear();
  graph.pathPoints.clear();
  graph.terminals.clear();
  graph.fronts.clear();
  graph.linkSteps.clear();
  graph.stats = {};
}

void sourceAlone(PredictionGraph& graph) {
  graph.flags = kSourceOffMesh;
  graph.completeTo = 0.0f;
  graph.corners.push_back({graph.source.plan, graph.source.height, 0.0f, 0});
  graph.nodes.push_back({.kind = NodeKind::kSource,
                         .reason = TerminalReason::kNone,
                         .branch = false,
                         .polygon = navmesh::kNoPolygon,
                         .plan = graph.source.plan,
                         .height = graph.source.height,
                         .distance = 0.0f,
                         .prev = kNoNode,
                         .corner = 0,
                         .firstChild = 0,
                         .childCount = 0});
}

void listChildren(PredictionGraph& graph) {
  std::vector<Node>& nodes = graph.nodes;
  for (std::size_t i = 1; i < nodes.size(); ++i) ++nodes[index(nodes[i].prev)].childCount;
  std::uint32_t start = 0;
  for (Node& node : nodes) {
    node.firstChild = start;
    start += node.childCount;
    node.childCount = 0;
  }
  graph.children.resize(start);
  for (std::uint32_t i = 1; i < nodes.size(); ++i) {
    Node& prev = nodes[index(nodes[i].prev)];
    graph.children[prev.firstChild + prev.childCount++] = NodeId{i};
  }
}

WayPoint pointAlong(const PredictionGraph& graph, NodeId id, float s) {
  const Node& node = graph.node(id);
  WayPoint point{node.plan, node.height, glm::vec2(0.0f)};
  s = std::clamp(s, 0.0f, node.distance);
  // The piece that holds s is the last one that is visited.
  Piece last{};
  glm::vec2 walk(0.0f);
  forEachPieceBackwards(graph, node, [&](const Piece& piece) {
    last = piece;
    if (piece.to != piece.from) walk = piece.to - piece.from;
    return piece.fromDistance > s;
  });
  const float length = last.toDistance - last.fromDistance;
  if (!(length > 0.0f)) return point;
  const float share = std::max(0.0f, s - last.fromDistance) / length;
  point.plan = last.from + share * (last.to - last.from);
  point.height = last.fromHeight + share * (last.toHeight - last.fromHeight);
  const float walked = glm::length(walk);
  if (walked > 0.0f) point.direction = walk / walked;
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

/// Where no corridor is known: straight in height, too, from end to end.
static void liftStraight(std::span<const glm::vec2> path, float from, float to,
                         std::vector<glm::vec3>& lifted) {
  const float length = navmesh::lengthOf(path);
  float walked = 0.0f;
  for (std::size_t i = 0; i < path.size(); ++i) {
    if (i > 0) walked += glm::distance(path[i - 1], path[i]);
    const float share = length > 0.0f ? walked / length : 0.0f;
    lifted.push_back(navmesh::toSpace(path[i], glm::mix(from, to, share)));
  }
}

std::span<const LinkStep> PredictionGraph::linkStepsOf(const Edge& edge) const {
  if (linkSteps.empty()) return {};
  const auto number = static_cast<std::uint32_t>(&edge - edges.data());
  const auto begin =
      std::lower_bound(linkSteps.begin(), linkSteps.end(), number,
                       [](const LinkStep& step, std::uint32_t e) { return step.edge < e; });
  auto end = begin;
  while (end != linkSteps.end() && end->edge == number) ++end;
  return {linkSteps.data() + (begin - linkSteps.begin()), static_cast<std::size_t>(end - begin)};
}

/// liftEdge where corridors are not listed: a stretch of floor between links after the other.
static void liftAlongFloor(const navmesh::NavGraph& navGraph, const PredictionGraph& graph,
                           const Edge& edge, std::vector<std::uint32_t>& portals,
                           std::vector<glm::vec3>& lifted) {
  const std::span<const PolygonId> polygons = graph.corridorOf(edge);
  const std::span<const glm::vec2> path = graph.pathOf(edge);
  const float last = graph.node(edge.to).height;
  PolygonId first = graph.node(edge.from).polygon;
  float height = graph.node(edge.from).height;
  const auto lift = [&](std::span<const glm::vec2> stretch, float to) {
    if (navmesh::corridorAlong(navGraph, first, stretch, portals)) {
      navmesh::appendLifted(navGraph, first, portals, stretch, kLiftTolerance, lifted);
    } else {
      liftStraight(stretch, height, to, lifted);
    }
  };
  lifted.clear();
  std::size_t point = 0;
  for (const LinkStep& step : graph.linkStepsOf(edge)) {
    if (step.polygons == 0) {  // from within the link
      lifted.push_back(graph.node(edge.from).position());
    } else {
      lift(path.subspan(point, step.point + 1 - point),
           navmesh::heightAt(navGraph, polygons[step.polygons - 1], path[step.point]));
    }
    point = step.point + 1;
    first = polygons[step.polygons];
    height = navmesh::heightAt(navGraph, first, path[point]);
  }
  lift(path.subspan(point), last);
}

/// Appends the path that lies in a row of neighbouring polygons.
static void liftThrough(const navmesh::NavGraph& navGraph, std::span<const PolygonId> polygons,
                        std::span<const glm::vec2> path, std::vector<std::uint32_t>& portals,
                        std::vector<glm::vec3>& lifted) {
  portals.clear();
  for (std::size_t i = 0; i + 1 < polygons.size(); ++i)
    portals.push_back(portalBetween(navGraph, polygons[i], polygons[i + 1]));
  navmesh::appendLifted(navGraph, polygons.front(), portals, path, kLiftTolerance, lifted);
}

void liftEdge(const navmesh::NavGraph& navGraph, const PredictionGraph& graph, const Edge& edge,
              std::vector<std::uint32_t>& portals, std::vector<glm::vec3>& lifted) {
  const std::span<const PolygonId> polygons = graph.corridorOf(edge);
  const std::span<const glm::vec2> path = graph.pathOf(edge);
  if (polygons.empty() || graph.method == Method::kFront) {
    liftAlongFloor(navGraph, graph, edge, portals, lifted);
    return;
  }
  lifted.clear();
  std::size_t polygon = 0, point = 0;
  for (const LinkStep& step : graph.linkStepsOf(edge)) {
    if (step.polygons == 0) {  // from within the link
      lifted.push_back(graph.node(edge.from).position());
    } else {
      liftThrough(navGraph, polygons.subspan(polygon, step.polygons - polygon),
                  path.subspan(point, step.point + 1 - point), portals, lifted);
    }
    polygon = step.polygons;
    point = step.point + 1;
  }
  liftThrough(navGraph, polygons.subspan(polygon), path.subspan(point), portals, lifted);
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
    if (!graph.fronts.empty()) addFloat(edge.width);
  }
  for (const Front& front : graph.fronts) {
    for (const glm::vec2 end : {front.from, front.to}) {
      addFloat(end.x);
      addFloat(end.y);
    }
    addFloat(front.length);
  }
  for (const LinkStep& step : graph.linkSteps) {
    add(std::uint64_t{step.edge} << 32 | step.point);
    add(std::uint64_t{navmesh::index(step.link)} << 32 | step.polygons << 1 |
        static_cast<std::uint64_t>(step.forward));
    addFloat(step.length);
  }
  return hash;
}

}  // namespace forewalk::prediction
