#include "prediction/predict.h"

#include <algorithm>

#include "navmesh/funnel.h"
#include "navmesh/plan.h"

namespace forewalk::prediction {

using navmesh::NavGraph;
using navmesh::Portal;

namespace {

/// Builds one graph. Lives for one predict() call; every buffer is the scratch's. Nodes and edges
/// are filled field by field in their places: built aside and copied, they would wait for the store
/// buffer.
class Assembly {
 public:
  Assembly(const NavGraph& navGraph, HorizonSearch& search, PredictionGraph& out,
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
    addNode(0, NodeKind::kSource, out_.source.plan, out_.source.height, 0.0f, 0).prev = kNoNode;
    nodeOf_[0] = 0;
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

 private:
  Node& addNode(std::uint32_t at, NodeKind kind, glm::vec2 plan, float height, float distance,
                std::uint32_t corner) {
    treeOf_.push_back(at);
    Node& node = out_.nodes.emplace_back();
    node.kind = kind;
    node.reason = TerminalReason::kNone;
    node.branch = tree_[at].branch;
    node.polygon = tree_[at].polygon;
    node.plan = plan;
    node.height = height;
    node.distance = distance;
    node.prev = NodeId{nodeOf_[tree_[at].prevPG]};
    node.corner = corner;
    node.firstChild = 0;
    node.childCount = 0;
    return node;
  }

  void addTerminal(Node& node, TerminalReason reason) {
    node.kind = NodeKind::kTerminal;
    node.reason = reason;
    out_.terminals.push_back(NodeId{static_cast<std::uint32_t>(out_.nodes.size() - 1)});
  }

  void addAtCentroid(std::uint32_t at, bool wayGoesOn) {
    const std::uint32_t polygon = index(tree_[at].polygon);
    const glm::vec2 plan = navGraph_.centroid[polygon];
    const std::uint32_t corner = cornerBeforeCentroid(at);
    const Corner& before = out_.corners[corner];
    // A taut length that rounding puts a hair beyond the horizon was within it as a bound.
    const float distance =
        std::min(out_.horizon, before.distance + glm::distance(before.plan, plan));
    nodeOf_[at] = static_cast<std::uint32_t>(out_.nodes.size());
    Node& node =
        addNode(at, NodeKind::kBranch, plan, navGraph_.centroidHeight[polygon], distance, corner);
    if (!wayGoesOn) {
      addTerminal(node, tree_[at].dropped ? TerminalReason::kHorizon : TerminalReason::kDeadEnd);
    }
    joinTree(plan, node.prev, at, tree_[at].prevPG);
  }

  /// Or a corner of the path that is beyond the horizon already.
  std::uint32_t cornerBeforeCentroid(std::uint32_t at) {
    if (tree_[at].corner != kNone) return tree_[at].corner;
    return search_.cornerBefore(at, navGraph_.centroid[index(tree_[at].polygon)], out_.horizon);
  }

  /// A terminal at arc length `horizon` on the taut path to the centroid of a tree node beyond it.
  void addCut(std::uint32_t at) {
    const std::vector<Corner>& corners = out_.corners;
    glm::vec2 ahead = navGraph_.centroid[index(tree_[at].polygon)];
    std::uint32_t corner = cornerBeforeCentroid(at);
    bool onLastLeg = true;
    for (; corners[corner].distance > out_.horizon; corner = corners[corner].previous) {
      ahead = corners[corner].plan;
      onLastLeg = false;
    }
    const Corner& before = corners[corner];
    const float leg = glm::distance(before.plan, ahead);
    const float share = leg > 0.0f ? std::min(1.0f, (out_.horizon - before.distance) / leg) : 0.0f;
    const glm::vec2 plan = before.plan + share * (ahead - before.plan);

    const std::uint32_t holder = onLastLeg ? holderOnLastLeg(at, plan) : holderAmongAll(at, plan);
    const PolygonId polygon = tree_[holder].polygon;
    Node& node = addNode(at, NodeKind::kTerminal, plan, navmesh::heightAt(navGraph_, polygon, plan),
                         out_.horizon, corner);
    node.branch = false;
    node.polygon = polygon;
    addTerminal(node, TerminalReason::kHorizon);
    joinTree(plan, node.prev, holder, tree_[at].prevPG);
  }

  /// The tree node whose polygon holds a point of the path's last straight leg, which ends in `at`:
  /// the leg crosses each portal's line once, so the point is past the portals that it lies beyond.
  std::uint32_t holderOnLastLeg(std::uint32_t at, glm::vec2 point) const {
    while (at != 0) {
      const Portal& portal = navGraph_.portals[tree_[at].portal];
      if (navmesh::turn(portal.right, portal.left, point) <= 0.0f) break;
      at = tree_[at].parent;
    }
    return at;
  }

  /// The same for a point anywhere on the path to `at`. Where polygons touch the one farther along
  /// wins.
  std::uint32_t holderAmongAll(std::uint32_t at, glm::vec2 point) const {
    constexpr float kOnBorder = 1e-3f;
    while (at != 0 && !navmesh::contains(navGraph_, tree_[at].polygon, point, kOnBorder)) {
      at = tree_[at].parent;
    }
    return at;
  }

  /// Tree edge of the latest node, which lies at `plan` in the polygon of tree node `holder`.
  void joinTree(glm::vec2 plan, NodeId prev, std::uint32_t holder, std::uint32_t prevTree) {
    // A cut can lie before the polygon of its prevPG, where that is wide and the way leaves it far
    // from its centroid: then the corridor runs the other way.
    const bool back = holder < prevTree;
    const std::uint32_t deep = back ? prevTree : holder;
    const std::uint32_t shallow = back ? holder : prevTree;
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
    const NodeId from{static_cast<std::uint32_t>(out_.nodes.size() - 1)};
    addEdge(from, plan, prev, out_.nodes[index(prev)].plan, EdgeKind::kTree, polygonStart);
  }

  void joinLoopsOf(std::uint32_t from) {
    const PolygonId polygon = out_.nodes[from].polygon;
    const std::uint32_t begin = navGraph_.portalStart[index(polygon)];
    const std::uint32_t end = navGraph_.portalStart[index(polygon) + 1];
    const PolygonId* portalTo = navGraph_.portalTo.data();
    for (std::uint32_t portal = begin; portal < end; ++portal) {
      const PolygonId neighbour = portalTo[portal];
      const std::uint32_t tree = search_.treeIndexOf(neighbour);
      if (tree == kNone) continue;
      const std::uint32_t to = nodeOf_[tree];
      if (to >= from || out_.nodes[from].prev == NodeId{to}) continue;  // kNone is larger than any
      if (std::find(portalTo + begin, portalTo + portal, neighbour) != portalTo + portal) continue;
      const std::uint32_t polygonStart = static_cast<std::uint32_t>(out_.corridorPolygons.size());
      out_.corridorPolygons.push_back(polygon);
      out_.corridorPolygons.push_back(neighbour);
      corridor_.clear();
      corridor_.push_back(navGraph_.portals[portal]);
      addEdge(NodeId{from}, out_.nodes[from].plan, NodeId{to}, out_.nodes[to].plan, EdgeKind::kLoop,
              polygonStart);
    }
  }

  /// `corridor_` runs from `start` to `goal`.
  void addEdge(NodeId from, glm::vec2 start, NodeId to, glm::vec2 goal, EdgeKind kind,
               std::uint32_t polygonStart) {
    const std::uint32_t pathStart = static_cast<std::uint32_t>(out_.pathPoints.size());
    const float length = corridor_.size() == 1 ? addPathThroughOne(start, goal, corridor_.front())
                                               : addPath(start, goal);
    Edge& edge = out_.edges.emplace_back();
    edge.from = from;
    edge.to = to;
    edge.kind = kind;
    edge.length = length;
    edge.polygonStart = polygonStart;
    edge.polygonCount = static_cast<std::uint32_t>(out_.corridorPolygons.size()) - polygonStart;
    edge.pathStart = pathStart;
    edge.pathCount = static_cast<std::uint32_t>(out_.pathPoints.size()) - pathStart;
  }

  float addPath(glm::vec2 start, glm::vec2 goal) {
    if (start != goal && isStraight(start, goal)) {
      out_.pathPoints.push_back(start);
      out_.pathPoints.push_back(goal);
      return glm::distance(start, goal);
    }
    navmesh::pullString(start, goal, corridor_, path_);
    out_.pathPoints.insert(out_.pathPoints.end(), path_.begin(), path_.end());
    return navmesh::lengthOf(path_);
  }

  /// Whether `corridor_` can be walked straight through.
  bool isStraight(glm::vec2 start, glm::vec2 goal) const {
    for (const Portal& portal : corridor_) {
      if (navmesh::exactTurn(start, goal, portal.left) < 0.0 ||
          navmesh::exactTurn(start, goal, portal.right) > 0.0) {
        return false;
      }
    }
    return true;
  }

  /// The same through a single portal, which most edges have: straight, or around one of its ends.
  float addPathThroughOne(glm::vec2 start, glm::vec2 goal, const Portal& portal) {
    out_.pathPoints.push_back(start);
    const bool aroundLeft = navmesh::exactTurn(start, portal.left, goal) > 0.0;
    const bool aroundRight = navmesh::exactTurn(start, portal.right, goal) < 0.0;
    float length;
    if (aroundLeft || aroundRight) {
      const glm::vec2 bend = aroundLeft ? portal.left : portal.right;
      out_.pathPoints.push_back(bend);
      length = glm::distance(start, bend) + glm::distance(bend, goal);
    } else {
      length = glm::distance(start, goal);
      if (start == goal) return length;
    }
    out_.pathPoints.push_back(goal);
    return length;
  }

  const NavGraph& navGraph_;
  HorizonSearch& search_;
  std::span<const SearchNode> tree_;
  PredictionGraph& out_;
  std::vector<std::uint32_t>& nodeOf_;
  std::vector<std::uint32_t>& treeOf_;
  std::vector<Portal>& corridor_;
  std::vector<glm::vec2>& path_;
};

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
  // A tree edge a polygon, a loop edge a pair of neighbours; corridors of tree edges share only
  // their ends.
  const std::size_t pairs = std::min<std::size_t>(graph.portalCount() / 2, 4 * polygons);
  graph_.edges.reserve(polygons + pairs);
  graph_.corridorPolygons.reserve(3 * polygons + 2 * pairs);
  graph_.pathPoints.reserve(5 * polygons + 3 * pairs);
}

const PredictionGraph& predict(const NavGraph& navGraph, const navmesh::Location& source,
                               float horizon, Scratch& scratch,
                               const navmesh::PolygonStates* states) {
  PredictionGraph& graph = scratch.graph_;
  clear(graph);
  graph.horizon = horizon > 0.0f ? horizon : 0.0f;
  graph.completeTo = graph.horizon;
  graph.source = source;
  if (index(source.polygon) >= navGraph.polygonCount()) {
    sourceAlone(graph);
    return graph;
  }

  scratch.search_.run(source, graph.horizon, graph.corners, HorizonSearch::Limit::kTaut, states);
  const std::span<const SearchNode> tree = scratch.search_.tree();
  scratch.nodeOf_.resize(tree.size());
  scratch.treeOf_.clear();
  Assembly assembly(navGraph, scratch.search_, graph, scratch.nodeOf_, scratch.treeOf_,
                    scratch.corridor_, scratch.path_);
  assembly.addSource();
  for (std::uint32_t at = 1; at < tree.size(); ++at) assembly.addTreeNode(at);
  assembly.joinLoops();
  listChildren(graph);

  graph.stats.settled = static_cast<std::uint32_t>(tree.size());
  graph.stats.expanded = static_cast<std::uint32_t>(
      std::count_if(tree.begin(), tree.end(), [](const SearchNode& node) { return node.within; }));
  graph.stats.relaxed = scratch.search_.relaxed();
  if (scratch.search_.limitReached()) {
    graph.flags |= kPolygonLimit;
    graph.completeTo = std::min(graph.horizon, scratch.search_.completeTo());
  }
  return graph;
}

}  // namespace forewalk::prediction
