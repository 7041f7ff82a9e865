#include "service/capi/flat_graph.h"

#include <algorithm>
#include <cstddef>
#include <functional>
#include <numeric>
#include <utility>

#include "service/capi/axes.h"

namespace forewalk::capi {

namespace {

using navmesh::NavGraph;
using prediction::PredictionGraph;

constexpr std::uint32_t kNone = 0xffffffffu;

static_assert(FOREWALK_NODE_SOURCE == static_cast<int>(prediction::NodeKind::kSource));
static_assert(FOREWALK_NODE_BRANCH == static_cast<int>(prediction::NodeKind::kBranch));
static_assert(FOREWALK_NODE_TERMINAL == static_cast<int>(prediction::NodeKind::kTerminal));
static_assert(FOREWALK_REASON_NONE == static_cast<int>(prediction::TerminalReason::kNone));
static_assert(FOREWALK_REASON_HORIZON == static_cast<int>(prediction::TerminalReason::kHorizon));
static_assert(FOREWALK_REASON_DEAD_END == static_cast<int>(prediction::TerminalReason::kDeadEnd));
static_assert(FOREWALK_NODE_JOIN == static_cast<int>(prediction::NodeKind::kJoin));
static_assert(FOREWALK_REASON_MEETING == static_cast<int>(prediction::TerminalReason::kMeeting));
static_assert(prediction::index(prediction::kNoNode) == kNone);
static_assert(prediction::index(prediction::kNoWay) == kNone);
static_assert(FOREWALK_WAY_BIRTH == static_cast<int>(prediction::WayChange::kBirth));
static_assert(FOREWALK_WAY_DEATH == static_cast<int>(prediction::WayChange::kDeath));
static_assert(FOREWALK_WAY_SPLIT == static_cast<int>(prediction::WayChange::kSplit));
static_assert(FOREWALK_WAY_MERGE == static_cast<int>(prediction::WayChange::kMerge));
static_assert(FOREWALK_WAY_RETURN == static_cast<int>(prediction::WayChange::kReturn));
static_assert(navmesh::index(navmesh::kNoPolygon) == kNone);

// Of the `count` largest.
std::size_t sumOfLargest(std::vector<std::size_t> numbers, std::size_t count) {
  count = std::min(count, numbers.size());
  const auto end = numbers.begin() + static_cast<std::ptrdiff_t>(count);
  std::nth_element(numbers.begin(), end, numbers.end(), std::greater<>());
  return std::accumulate(numbers.begin(), end, std::size_t{0});
}

// The most points that liftPath records where an edge's path crosses the polygon: every side that
// its height triangles have inside it, the place where the path leaves it, and a corner.
std::size_t pointsAcross(const NavGraph& graph, std::uint32_t polygon) {
  const std::size_t triangles =
      graph.heightStart.empty() ? 0 : graph.heightStart[polygon + 1] - graph.heightStart[polygon];
  const std::size_t corners = graph.ringStart[polygon + 1] - graph.ringStart[polygon];
  return (triangles > 0 ? 3 * triangles : corners - 3) + 2;
}

}  // namespace

FlatGraph::FlatGraph(const NavGraph& graph, std::uint32_t polygons, prediction::Method method)
    : method_(method) {
  const prediction::WayTrackerSettings most;
  ways_.reserve(most.ways);
  events_.reserve(2 * most.ways);
  const std::size_t count = std::min(polygons, graph.polygonCount());
  if (method == prediction::Method::kPolygon) {
    reserveForPolygons(graph, count);
    return;
  }
  // Every junction takes a wall of its own, and buildings have about as many walls as polygons.
  constexpr std::size_t kCornersOfAWay = 8;
  nodes_.reserve(2 * count + 64);
  fronts_.reserve(2 * count + 64);
  edges_.reserve(3 * count + 64);
  widths_.reserve(3 * count + 64);
  points_.reserve(kCornersOfAWay * (3 * count + 64));
  lifted_.reserve(count + 64);
}

void FlatGraph::reserveForPolygons(const NavGraph& graph, std::size_t count) {
  std::vector<std::size_t> neighbours, onePath, allPaths;
  for (std::uint32_t p = 0; p < graph.polygonCount(); ++p) {
    neighbours.push_back(graph.neighbourCount[p]);
    onePath.push_back(pointsAcross(graph, p));
    // A polygon lies on its own tree edge and on one edge at most for each other neighbour: of the
    // tree, if that comes after it, or a loop. One more for a cut that lies before its prev.
    allPaths.push_back((graph.neighbourCount[p] + 1) * onePath.back());
  }
  nodes_.reserve(count + 1);
  edges_.reserve(count + sumOfLargest(std::move(neighbours), count) / 2);
  widths_.reserve(edges_.capacity());
  portals_.reserve(count);
  lifted_.reserve(sumOfLargest(std::move(onePath), count) + 2);
  points_.reserve(sumOfLargest(std::move(allPaths), count) + 2);
}

void FlatGraph::clear() {
  horizon_ = 0.0f;
  completeTo_ = 0.0f;
  nodes_.clear();
  edges_.clear();
  points_.clear();
  fronts_.clear();
  widths_.clear();
  ways_.clear();
  events_.clear();
  none_ = 1.0f;
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
  for (const prediction::Edge& edge : graph.edges) addEdge(navGraph, graph, edge, axes);
  for (std::size_t i = 0; i < graph.fronts.size(); ++i) {
    const prediction::Front& front = graph.fronts[i];
    const float height = graph.node(graph.terminals[i]).height;
    fronts_.push_back({.node = prediction::index(graph.terminals[i]),
                       .length = front.length,
                       .from = positionTo(axes, navmesh::toSpace(front.from, height)),
                       .to = positionTo(axes, navmesh::toSpace(front.to, height))});
  }
}

void FlatGraph::addWays(const prediction::WayLikelihood& likelihood) {
  const auto probabilities = likelihood.probabilities();
  for (std::size_t i = 0; i < likelihood.ways().size(); ++i) {
    const prediction::TrackedWay& way = likelihood.ways()[i];
    ways_.push_back({.id = prediction::index(way.id),
                     .node = prediction::index(way.terminal),
                     .likelihood = static_cast<float>(probabilities[i]),
                     .born = way.born,
                     .reserved = {}});
  }
  for (const prediction::WayEvent& event : likelihood.tracker().events()) {
    events_.push_back({.way = prediction::index(event.way),
                       .other = prediction::index(event.other),
                       .change = static_cast<forewalk_way_change>(event.change),
                       .reserved = {}});
  }
  none_ = static_cast<float>(likelihood.none());
}

void FlatGraph::addEdge(const NavGraph& navGraph, const PredictionGraph& graph,
                        const prediction::Edge& edge, forewalk_axes axes) {
  prediction::liftEdge(navGraph, graph, edge, portals_, lifted_);
  edges_.push_back({.from = prediction::index(edge.from),
                    .to = prediction::index(edge.to),
                    .length = edge.length,
                    .path_start = static_cast<std::uint32_t>(points_.size()),
                    .path_count = static_cast<std::uint32_t>(lifted_.size()),
                    .loop = edge.kind == prediction::EdgeKind::kLoop});
  widths_.push_back(edge.width);
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
          .complete_to = completeTo_,
          .fronts = fronts_.data(),
          .widths = widths_.data(),
          .front_count = static_cast<std::uint32_t>(fronts_.size()),
          .method = static_cast<forewalk_method>(method_),
          .ways = ways_.data(),
          .way_events = events_.data(),
          .way_count = static_cast<std::uint32_t>(ways_.size()),
          .way_event_count = static_cast<std::uint32_t>(events_.size()),
          .likelihood_none = none_,
          .reserved = 0};
}

}  // namespace forewalk::capi
