#include "service/capi/flat_graph.h"

#include <algorithm>
#include <limits>

#include "navmesh/funnel.h"
#include "service/capi/axes.h"

namespace forewalk::capi {

namespace {

using navmesh::NavGraph;
using prediction::PredictionGraph;

constexpr float kLiftTolerance = 0.02f;  // how far a path may leave the floor, metres

constexpr std::uint32_t kNone = 0xffffffffu;

static_assert(FOREWALK_NODE_SOURCE == static_cast<int>(prediction::NodeKind::kSource));
static_assert(FOREWALK_NODE_BRANCH == static_cast<int>(prediction::NodeKind::kBranch));
static_assert(FOREWALK_NODE_TERMINAL == static_cast<int>(prediction::NodeKind::kTerminal));
static_assert(FOREWALK_REASON_NONE == static_cast<int>(prediction::TerminalReason::kNone));
static_assert(FOREWALK_REASON_HORIZON == static_cast<int>(prediction::TerminalReason::kHorizon));
static_assert(FOREWALK_REASON_DEAD_END == static_cast<int>(prediction::TerminalReason::kDeadEnd));
static_assert(prediction::index(prediction::kNoNode) == kNone);
static_assert(navmesh::index(navmesh::kNoPolygon) == kNone);

float squaredDistance(glm::vec2 point, glm::vec2 a, glm::vec2 b) {
  const glm::vec2 along = b - a;
  const float squared = glm::dot(along, along);
  const float t =
      squared > 0.0f ? glm::clamp(glm::dot(point - a, along) / squared, 0.0f, 1.0f) : 0.0f;
  const glm::vec2 off = point - (a + t * along);
  return glm::dot(off, off);
}

float squaredDistance(glm::vec2 point, std::span<const glm::vec2> path) {
  if (path.size() == 1) return squaredDistance(point, path[0], path[0]);
  float nearest = std::numeric_limits<float>::infinity();
  for (std::size_t i = 0; i + 1 < path.size(); ++i) {
    nearest = std::min(nearest, squaredDistance(point, path[i], path[i + 1]));
  }
  return nearest;
}

// The half-portal from `from` to `to`. Two polygons can be joined by several; the path goes through
// the one whose middle it comes nearest to.
std::uint32_t portalBetween(const NavGraph& graph, navmesh::PolygonId from, navmesh::PolygonId to,
                            std::span<const glm::vec2> path) {
  const std::uint32_t end = graph.portalStart[navmesh::index(from) + 1];
  std::uint32_t best = kNone;
  float nearest = 0.0f;
  for (std::uint32_t h = graph.portalStart[navmesh::index(from)]; h < end; ++h) {
    if (graph.portalTo[h] != to) continue;
    const float distance = squaredDistance(graph.portalMidpoint[h], path);
    if (best == kNone || distance < nearest) {
      best = h;
      nearest = distance;
    }
  }
  return best;
}

}  // namespace

FlatGraph::FlatGraph(std::uint32_t polygons) {
  const std::size_t count = polygons;
  nodes_.reserve(count + 1);
  edges_.reserve(2 * count);
  points_.reserve(6 * count);
  portals_.reserve(count);
  lifted_.reserve(4 * count);
}

void FlatGraph::clear() {
  horizon_ = 0.0f;
  completeTo_ = 0.0f;
  nodes_.clear();
  edges_.clear();
  points_.clear();
}

void FlatGraph::flatten(const NavGraph& navGraph, const PredictionGraph& graph,
                        forewalk_axes axes) {
  clear();
  horizon_ = graph.horizon;
  completeTo_ = graph.completeTo;
  for (const prediction::Node& node : graph.nodes) {
    nodes_.push_back({.position = positionTo(axes, node.position()),
                      .distance = node.distance,
                      .prev = prediction::index(node.prev),
                      .polygon = navmesh::index(node.polygon),
                      .kind = static_cast<forewalk_node_kind>(node.kind),
                      .reason = static_cast<forewalk_terminal_reason>(node.reason),
                      .branch = node.branch,
                      .reserved = 0});
  }
  for (const prediction::Edge& edge : graph.edges) liftEdge(navGraph, graph, edge, axes);
}

void FlatGraph::liftEdge(const NavGraph& navGraph, const PredictionGraph& graph,
                         const prediction::Edge& edge, forewalk_axes axes) {
  const auto path = graph.pathOf(edge);
  const auto polygons = graph.corridorOf(edge);
  portals_.clear();
  for (std::size_t i = 0; i + 1 < polygons.size(); ++i) {
    portals_.push_back(portalBetween(navGraph, polygons[i], polygons[i + 1], path));
  }
  navmesh::liftPath(navGraph, polygons.front(), portals_, path, kLiftTolerance, lifted_);
  edges_.push_back({.from = prediction::index(edge.from),
                    .to = prediction::index(edge.to),
                    .length = edge.length,
                    .path_start = static_cast<std::uint32_t>(points_.size()),
                    .path_count = static_cast<std::uint32_t>(lifted_.size()),
                    .loop = edge.kind == prediction::EdgeKind::kLoop});
  for (const glm::vec3 point : lifted_) points_.push_back(positionTo(axes, point));
}

forewalk_graph_view FlatGraph::view() const {
  return {.struct_size = sizeof(forewalk_graph_view),
          .node_count = static_cast<std::uint32_t>(nodes_.size()),
          .nodes = nodes_.data(),
          .edge_count = static_cast<std::uint32_t>(edges_.size()),
          .point_count = static_cast<std::uint32_t>(points_.size()),
          .edges = edges_.data(),
          .points = points_.data(),
          .horizon = horizon_,
          .complete_to = completeTo_};
}

}  // namespace forewalk::capi
