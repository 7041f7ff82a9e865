#include "prediction/predict.h"

#include <algorithm>

#include "navmesh/funnel.h"
#include "navmesh/plan.h"

namespace forewalk::prediction {

using navmesh::NavGraph;
using navmesh::Portal;

namespace {

/// A point on a taut path and the tree node whose polygon holds it.
struct Cut {
  glm::vec2 plan;
  float height;
  std::uint32_t corner;  // the last one before the cut
  std::uint32_t holder;  // tree index
};

/// Builds one graph. Lives for one predict() call; every buffer is the scratch's.
class Assembly {
 public:
  Assembly(const NavGraph& navGraph, const HorizonSearch& search, PredictionGraph& out,
           std::vector<std::uint32_t>& nodeOf, std::vector<std::uint32_t>& treeOf,
           std::vector<Portal>& corridor, std::vector<glm::vec2>& path)
      : navGraph_(navGraph),
        search_(search),
        tree_(search.tree()),
        out_(out),
        nodeOf_(nodeOf),
        treeOf_(treeOf),
        corridor_(corridor),
        path_(path) {}

  void addSource() {
    Node node = blankNode(NodeKind::kSource, 0);
    node.plan = out_.source.plan;
    node.height = out_.source.height;
    node.prev = kNoNode;
    nodeOf_[0] = 0;
    out_.nodes.push_back(node);
    treeOf_.push_back(0);
  }

  void addTreeNode(std::uint32_t at) {
    const SearchNode& tree = tree_[at];
    nodeOf_[at] = kNone;
    if (!tree.within) {
      addCut(at);
      return;
    }
    const bool wayGoesOn = tree.hasWithinChild || tree.hasCutChild;
    if (wayGoesOn && !tree.branch) return;
    addAtCentroid(at, wayGoesOn);
  }

  void joinLoops() {
    const std::uint32_t count = static_cast<std::uint32_t>(out_.nodes.size());
    for (std::uint32_t from = 1; from < count; ++from) {
      if (nodeOf_[treeOf_[from]] != from) continue;  // a cut has no polygon of its own
      joinLoopsOf(from);
    }
  }

  void listChildren() {
    std::vector<Node>& nodes = out_.nodes;
    for (std::size_t i = 1; i < nodes.size(); ++i) ++nodes[index(nodes[i].prev)].childCount;
    std::uint32_t start = 0;
    for (Node& node : nodes) {
      node.firstChild = start;
      start += node.childCount;
      node.childCount = 0;
    }
    out_.children.resize(start);
    for (std::uint32_t i = 1; i < nodes.size(); ++i) {
      Node& prev = nodes[index(nodes[i].prev)];
      out_.children[prev.firstChild + prev.childCount++] = NodeId{i};
    }
  }

 private:
  Node blankNode(NodeKind kind, std::uint32_t at) const {
    return {.kind = kind,
            .reason = TerminalReason::kNone,
            .branch = tree_[at].branch,
            .polygon = tree_[at].polygon,
            .plan = {},
            .height = 0.0f,
            .distance = 0.0f,
            .prev = NodeId{nodeOf_[tree_[at].prevPG]},
            .corner = 0,
            .firstChild = 0,
            .childCount = 0};
  }

  void addAtCentroid(std::uint32_t at, bool wayGoesOn) {
    Node node = blankNode(wayGoesOn ? NodeKind::kBranch : NodeKind::kTerminal, at);
    if (!wayGoesOn) {
      node.reason = tree_[at].dropped ? TerminalReason::kHorizon : TerminalReason::kDeadEnd;
    }
    node.plan = navGraph_.centroid[index(node.polygon)];
    node.height = navGraph_.centroidHeight[index(node.polygon)];
    node.corner = search_.cornerBefore(out_.corners, at, node.plan);
    const Corner& before = out_.corners[node.corner];
    // A taut length that rounding puts a hair beyond the horizon was within it as a bound.
    node.distance =
        std::min(out_.horizon, before.distance + glm::distance(before.plan, node.plan));
    nodeOf_[at] = static_cast<std::uint32_t>(out_.nodes.size());
    add(node, at, at);
  }

  void addCut(std::uint32_t at) {
    const Cut cut = cutAtHorizon(at);
    Node node = blankNode(NodeKind::kTerminal, at);
    node.reason = TerminalReason::kHorizon;
    node.branch = false;
    node.polygon = tree_[cut.holder].polygon;
    node.plan = cut.plan;
    node.height = cut.height;
    node.corner = cut.corner;
    node.distance = out_.horizon;
    add(node, at, cut.holder);
  }

  void add(const Node& node, std::uint32_t at, std::uint32_t holder) {
    const NodeId id{static_cast<std::uint32_t>(out_.nodes.size())};
    out_.nodes.push_back(node);
    treeOf_.push_back(at);
    if (node.kind == NodeKind::kTerminal) out_.terminals.push_back(id);
    joinTree(id, node, holder, tree_[at].prevPG);
  }

  /// The point at arc length `horizon` on the taut path to the centroid of a node beyond it.
  Cut cutAtHorizon(std::uint32_t at) const {
    const std::vector<Corner>& corners = out_.corners;
    glm::vec2 ahead = navGraph_.centroid[index(tree_[at].polygon)];
    float aheadHeight = navGraph_.centroidHeight[index(tree_[at].polygon)];
    std::uint32_t corner = search_.cornerBefore(corners, at, ahead);
    while (corners[corner].distance > out_.horizon) {
      ahead = corners[corner].plan;
      aheadHeight = corners[corner].height;
      corner = corners[corner].previous;
    }
    const Corner& before = corners[corner];
    const float step = glm::distance(before.plan, ahead);
    const float share =
        step > 0.0f ? std::min(1.0f, (out_.horizon - before.distance) / step) : 0.0f;
    Cut cut{before.plan + share * (ahead - before.plan), 0.0f, corner, at};

    // Almost always the last polygon or the one before it. On a tie between polygons that touch at the
    // cut the one farther along wins.
    constexpr float kOnBorder = 1e-3f;
    while (cut.holder != 0 &&
           !navmesh::contains(navGraph_, tree_[cut.holder].polygon, cut.plan, kOnBorder)) {
      cut.holder = tree_[cut.holder].parent;
    }
    cut.height = before.height + share * (aheadHeight - before.height);
    return cut;
  }

  /// Tree edge from node `id`, whose place is in the polygon of tree node `holder`, to its prevPG.
  void joinTree(NodeId id, const Node& node, std::uint32_t holder, std::uint32_t prev) {
    const Node& to = out_.nodes[index(node.prev)];
    // A cut can lie before the polygon of its prevPG, where that is wide and the way leaves it far from
    // its centroid: then the corridor runs the other way.
    const bool back = holder < prev;
    const std::uint32_t deep = back ? prev : holder;
    const std::uint32_t shallow = back ? holder : prev;
    const std::uint32_t polygonStart = static_cast<std::uint32_t>(out_.corridorPolygons.size());
    corridor_.clear();
    for (std::uint32_t at = deep;; at = tree_[at].parent) {
      out_.corridorPolygons.push_back(tree_[at].polygon);
      if (at == shallow) break;
      const Portal& portal = navGraph_.portals[tree_[at].portal];
      corridor_.push_back(back ? portal : Portal{portal.right, portal.left});
    }
    if (back) {
      std::reverse(corridor_.begin(), corridor_.end());
      std::reverse(out_.corridorPolygons.begin() + polygonStart, out_.corridorPolygons.end());
    }
    addEdge(id, node.plan, node.prev, to.plan, EdgeKind::kTree, polygonStart);
  }

  void joinLoopsOf(std::uint32_t from) {
    const PolygonId polygon = out_.nodes[from].polygon;
    const std::uint32_t begin = navGraph_.portalStart[index(polygon)];
    const std::uint32_t end = navGraph_.portalStart[index(polygon) + 1];
    for (std::uint32_t portal = begin; portal < end; ++portal) {
      const PolygonId neighbour = navGraph_.portalTo[portal];
      const std::uint32_t tree = search_.treeIndexOf(neighbour);
      if (tree == kNone) continue;
      const std::uint32_t to = nodeOf_[tree];
      if (to == kNone || to >= from || out_.nodes[from].prev == NodeId{to}) continue;
      const PolygonId* sameRow = navGraph_.portalTo.data();
      if (std::find(sameRow + begin, sameRow + portal, neighbour) != sameRow + portal) continue;
      const std::uint32_t polygonStart = static_cast<std::uint32_t>(out_.corridorPolygons.size());
      out_.corridorPolygons.push_back(polygon);
      out_.corridorPolygons.push_back(neighbour);
      corridor_.clear();
      corridor_.push_back(navGraph_.portals[portal]);
      addEdge(NodeId{from}, out_.nodes[from].plan, NodeId{to}, out_.nodes[to].plan,
              EdgeKind::kLoop, polygonStart);
    }
  }

  /// `corridor_` runs from `start` to `goal`.
  void addEdge(NodeId from, glm::vec2 start, NodeId to, glm::vec2 goal, EdgeKind kind,
               std::uint32_t polygonStart) {
    const std::uint32_t pathStart = static_cast<std::uint32_t>(out_.pathPoints.size());
    navmesh::pullString(start, goal, corridor_, path_);
    out_.pathPoints.insert(out_.pathPoints.end(), path_.begin(), path_.end());
    out_.edges.push_back(
        {.from = from,
         .to = to,
         .kind = kind,
         .length = navmesh::lengthOf(path_),
         .polygonStart = polygonStart,
         .polygonCount = static_cast<std::uint32_t>(out_.corridorPolygons.size()) - polygonStart,
         .pathStart = pathStart,
         .pathCount = static_cast<std::uint32_t>(path_.size())});
  }

  const NavGraph& navGraph_;
  const HorizonSearch& search_;
  const std::vector<SearchNode>& tree_;
  PredictionGraph& out_;
  std::vector<std::uint32_t>& nodeOf_;
  std::vector<std::uint32_t>& treeOf_;
  std::vector<Portal>& corridor_;
  std::vector<glm::vec2>& path_;
};

void clear(PredictionGraph& graph) {
  graph.flags = kGraphComplete;
  graph.nodes.clear();
  graph.children.clear();
  graph.edges.clear();
  graph.corners.clear();
  graph.corridorPolygons.clear();
  graph.pathPoints.clear();
  graph.terminals.clear();
  graph.stats = {};
}

void sourceAlone(PredictionGraph& graph) {
  graph.flags = kSourceOffMesh;
  graph.completeTo = 0.0f;
  graph.corners.push_back({graph.source.plan, graph.source.height, 0.0f, 0});
  graph.nodes.push_back({.kind = NodeKind::kSource, .reason = TerminalReason::kNone, .branch = false,
                         .polygon = navmesh::kNoPolygon, .plan = graph.source.plan,
                         .height = graph.source.height, .distance = 0.0f, .prev = kNoNode,
                         .corner = 0, .firstChild = 0, .childCount = 0});
}

}  // namespace

Scratch::Scratch(const NavGraph& graph, const PredictionLimits& limits)
    : search_(graph, limits.polygons) {
  const std::size_t polygons = std::min(limits.polygons, graph.polygonCount());
  nodeOf_.reserve(polygons);
  treeOf_.reserve(polygons);
  corridor_.reserve(polygons);
  path_.reserve(polygons + 2);
  graph_.corners.reserve(search_.cornerCapacity());
  graph_.nodes.reserve(polygons + 1);
  graph_.children.reserve(polygons);
  graph_.terminals.reserve(polygons);
  graph_.edges.reserve(2 * polygons);
  graph_.corridorPolygons.reserve(4 * polygons);
  graph_.pathPoints.reserve(6 * polygons);
}

const PredictionGraph& predict(const NavGraph& navGraph, const navmesh::Location& source,
                               float horizon, Scratch& scratch) {
  PredictionGraph& graph = scratch.graph_;
  clear(graph);
  graph.horizon = horizon > 0.0f ? horizon : 0.0f;
  graph.completeTo = graph.horizon;
  graph.source = source;
  if (index(source.polygon) >= navGraph.polygonCount()) {
    sourceAlone(graph);
    return graph;
  }

  scratch.search_.run(source, graph.horizon, graph.corners);
  const std::vector<SearchNode>& tree = scratch.search_.tree();
  scratch.nodeOf_.resize(tree.size());
  scratch.treeOf_.clear();
  Assembly assembly(navGraph, scratch.search_, graph, scratch.nodeOf_, scratch.treeOf_,
                    scratch.corridor_, scratch.path_);
  assembly.addSource();
  for (std::uint32_t at = 1; at < tree.size(); ++at) assembly.addTreeNode(at);
  assembly.joinLoops();
  assembly.listChildren();

  graph.stats.settled = static_cast<std::uint32_t>(tree.size());
  graph.stats.expanded = static_cast<std::uint32_t>(
      std::count_if(tree.begin(), tree.end(), [](const SearchNode& node) { return node.within; }));
  graph.stats.relaxed = scratch.search_.relaxed();
  if (scratch.search_.limitReached()) {
    graph.flags |= kPolygonLimit;
    graph.completeTo = std::min(graph.horizon, tree.back().key);
  }
  return graph;
}

}  // namespace forewalk::prediction
