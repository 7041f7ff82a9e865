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
  /// `links`: null where there are none.
  Assembly(const NavGraph& navGraph, const navmesh::Links* links, HorizonSearch& search,
           PredictionGraph& out, std::vector<std::uint32_t>& nodeOf,
           std::vector<std::uint32_t>& treeOf, std::vector<Portal>& corridor,
           std::vector<glm::vec2>& path)
      : navGraph_(navGraph),
        links_(links),
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
    for (std::uint32_t from = 0; from < count && links_ != nullptr; ++from) {
      if (nodeOf_[treeOf_[from]] == from) joinLoopsByLinksOf(from);
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
    if (links_ != nullptr && addCutByLinks(at, corner)) return;
    bool onLastLeg = true;
    // Not across a link before prevPG, which a rounding may put at the horizon.
    const std::uint32_t first = links_ == nullptr ? kNone : lastExitBefore(tree_[at].prevPG);
    for (; corners[corner].distance > out_.horizon && corner != first;
         corner = corners[corner].previous) {
      ahead = corners[corner].plan;
      onLastLeg = false;
    }
    const glm::vec2 plan = cutBetween(corners[corner], ahead);
    const std::uint32_t holder = onLastLeg ? holderOnLastLeg(at, plan) : holderAmongAll(at, plan);
    addCutAt(at, corner, holder, plan, navmesh::heightAt(navGraph_, tree_[holder].polygon, plan));
    joinTree(plan, out_.nodes.back().prev, holder, tree_[at].prevPG);
  }

  /// The tree node whose polygon holds a point of the path's last straight leg, which ends in `at`:
  /// the leg crosses each portal's line once, so the point is past the portals that it lies beyond.
  std::uint32_t holderOnLastLeg(std::uint32_t at, glm::vec2 point) const {
    while (tree_[at].portal < kByLink) {  // neither the source nor behind a link: there it begins
      const Portal& portal = navGraph_.portals[tree_[at].portal];
      if (navmesh::turn(portal.right, portal.left, point) <= 0.0f) break;
      at = tree_[at].parent;
    }
    return at;
  }

  /// The same for a point anywhere on the path to `at`, behind its last link. Where polygons touch
  /// the one farther along wins.
  std::uint32_t holderAmongAll(std::uint32_t at, glm::vec2 point) const {
    constexpr float kOnBorder = 1e-3f;
    while (tree_[at].portal < kByLink &&
           !navmesh::contains(navGraph_, tree_[at].polygon, point, kOnBorder)) {
      at = tree_[at].parent;
    }
    return at;
  }

  const navmesh::LinkWay& wayInto(std::uint32_t at) const {
    return links_->ways[tree_[at].portal & ~kByLink];
  }

  /// The corner where the way to a node leaves its last link; kNone where it has none.
  std::uint32_t lastExitBefore(std::uint32_t node) const {
    while (node != 0 && !isLink(tree_[node].portal)) node = tree_[node].parent;
    return node == 0 ? kNone : search_.funnels().exitCorner(node);
  }

  /// addCut where the way to `at` leads through links behind its prevPG. False where the cut lies
  /// behind all of them; `corner` is the last one on the path to the centroid.
  [[gnu::noinline]] bool addCutByLinks(std::uint32_t at, std::uint32_t corner) {
    std::uint32_t beyond = kNone;  // the first node behind a link that is left beyond the horizon
    for (std::uint32_t node = at; node > tree_[at].prevPG; node = tree_[node].parent) {
      if (!isLink(tree_[node].portal)) continue;
      if (out_.corners[search_.funnels().exitCorner(node)].distance > out_.horizon) beyond = node;
    }
    if (beyond == kNone) return false;
    const navmesh::LinkWay& way = wayInto(beyond);
    const std::uint32_t holder = tree_[beyond].parent;
    corner = search_.funnels().entryCorner(beyond);
    const float entered = out_.corners[corner].distance;
    if (entered <= out_.horizon) {
      const float part = out_.horizon - entered;
      const float share = std::min(1.0f, part / way.length);
      const glm::vec2 plan = way.entry + share * (way.exit - way.entry);
      const float height = way.entryHeight + share * (way.exitHeight - way.entryHeight);
      addCutAt(at, corner, holder, plan, height);
      joinTreeByLinks(plan, out_.nodes.back().prev, holder, tree_[at].prevPG, {&way, part});
      return true;
    }
    // On the way to the entry.
    glm::vec2 ahead = way.entry;
    for (; out_.corners[corner].distance > out_.horizon; corner = out_.corners[corner].previous)
      ahead = out_.corners[corner].plan;
    const glm::vec2 plan = cutBetween(out_.corners[corner], ahead);
    const std::uint32_t in = holderAmongAll(holder, plan);
    addCutAt(at, corner, in, plan, navmesh::heightAt(navGraph_, tree_[in].polygon, plan));
    joinTree(plan, out_.nodes.back().prev, in, tree_[at].prevPG);
    return true;
  }

  /// The point at the horizon on the leg from a corner within it.
  [[gnu::always_inline]] glm::vec2 cutBetween(const Corner& before, glm::vec2 ahead) const {
    const float leg = glm::distance(before.plan, ahead);
    const float share =
        leg > 0.0f ? std::clamp((out_.horizon - before.distance) / leg, 0.0f, 1.0f) : 0.0f;
    return before.plan + share * (ahead - before.plan);
  }

  [[gnu::always_inline]] void addCutAt(std::uint32_t at, std::uint32_t corner, std::uint32_t holder,
                                       glm::vec2 plan, float height) {
    Node& node = addNode(at, NodeKind::kTerminal, plan, height, out_.horizon, corner);
    node.branch = false;
    node.polygon = tree_[holder].polygon;
    addTerminal(node, TerminalReason::kHorizon);
  }

  /// Tree edge of the latest node, which lies at `plan` in the polygon of tree node `holder`.
  void joinTree(glm::vec2 plan, NodeId prev, std::uint32_t holder, std::uint32_t prevTree) {
    if (links_ != nullptr && leadsThroughLink(holder, prevTree)) {
      joinTreeByLinks(plan, prev, holder, prevTree, {});
      return;
    }
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

  bool leadsThroughLink(std::uint32_t holder, std::uint32_t prevTree) const {
    for (; holder > prevTree; holder = tree_[holder].parent) {
      if (isLink(tree_[holder].portal)) return true;
    }
    return false;
  }

  /// A link that the horizon cuts, and how much of it lies before the cut, metres.
  struct CutLink {
    const navmesh::LinkWay* way = nullptr;
    float part = 0.0f;
  };

  /// joinTree through links: from `plan`, in `cut` or else in the polygon of `holder`, which is no
  /// nearer than `prevTree`.
  [[gnu::noinline]] void joinTreeByLinks(glm::vec2 plan, NodeId prev, std::uint32_t holder,
                                         std::uint32_t prevTree, CutLink cut) {
    const auto polygonStart = static_cast<std::uint32_t>(out_.corridorPolygons.size());
    const auto pathStart = static_cast<std::uint32_t>(out_.pathPoints.size());
    const NodeId from{static_cast<std::uint32_t>(out_.nodes.size() - 1)};
    float length = 0.0f;
    const auto step = [&](const navmesh::LinkWay& way, float part) {
      LinkStep& at = out_.linkSteps.emplace_back();
      at.edge = static_cast<std::uint32_t>(out_.edges.size());
      at.point = static_cast<std::uint32_t>(out_.pathPoints.size()) - 1 - pathStart;
      at.polygons = static_cast<std::uint32_t>(out_.corridorPolygons.size()) - polygonStart;
      at.length = part;
      at.link = way.link;
      at.forward = false;
      length += part;
      plan = way.entry;
    };
    if (cut.way != nullptr) {
      out_.pathPoints.push_back(plan);
      step(*cut.way, cut.part);
    }
    corridor_.clear();
    for (std::uint32_t at = holder;; at = tree_[at].parent) {
      out_.corridorPolygons.push_back(tree_[at].polygon);
      if (at == prevTree) break;
      if (isLink(tree_[at].portal)) {
        const navmesh::LinkWay& way = wayInto(at);
        length += addPath(plan, way.exit);
        step(way, way.length);
        corridor_.clear();
      } else {
        const Portal& portal = navGraph_.portals[tree_[at].portal];
        corridor_.push_back({portal.right, portal.left});
      }
    }
    length += addPath(plan, out_.nodes[index(prev)].plan);
    finishEdge(from, prev, EdgeKind::kTree, length, polygonStart, pathStart);
  }

  /// Links between the polygons of two nodes that neither the tree nor portals join. Each pair
  /// once, by its shortest link.
  [[gnu::noinline]] void joinLoopsByLinksOf(std::uint32_t from) {
    const PolygonId polygon = out_.nodes[from].polygon;
    const auto ways = links_->from(polygon);
    for (auto way = ways.begin(); way != ways.end(); ++way) {
      const std::uint32_t tree = search_.treeIndexOf(way->to);
      const std::uint32_t to = tree == kNone ? kNone : nodeOf_[tree];
      const bool seen =
          std::any_of(ways.begin(), way, [&](const auto& w) { return w.to == way->to; });
      if (to == kNone || to == from || seen || isJoined(from, to)) continue;
      const navmesh::LinkWay* best = &*way;
      bool forward = true;
      const auto offer = [&](const navmesh::LinkWay& other, bool ahead) {
        if (lengthByLink(other, ahead, from, to) >= lengthByLink(*best, forward, from, to)) return;
        best = &other;
        forward = ahead;
      };
      for (auto other = way + 1; other != ways.end(); ++other) {
        if (other->to == way->to) offer(*other, true);
      }
      bool joinedAlready = false;  // from the other end
      for (const navmesh::LinkWay& other : links_->from(way->to)) {
        if (other.to != polygon) continue;
        joinedAlready = joinedAlready || to < from;
        offer(other, false);
      }
      if (!joinedAlready) addLoopByLink(from, to, *best, forward);
    }
  }

  bool isJoined(std::uint32_t one, std::uint32_t other) const {
    if (out_.nodes[one].prev == NodeId{other} || out_.nodes[other].prev == NodeId{one}) return true;
    const std::uint32_t polygon = index(out_.nodes[one].polygon);
    const auto begin = navGraph_.portalTo.begin() + navGraph_.portalStart[polygon];
    const auto end = navGraph_.portalTo.begin() + navGraph_.portalStart[polygon + 1];
    return std::find(begin, end, out_.nodes[other].polygon) != end;
  }

  /// `ahead`: the link leads from the polygon of `from` to that of `to`, else the other way.
  float lengthByLink(const navmesh::LinkWay& way, bool ahead, std::uint32_t from,
                     std::uint32_t to) const {
    return glm::distance(out_.nodes[ahead ? from : to].plan, way.entry) + way.length +
           glm::distance(way.exit, out_.nodes[ahead ? to : from].plan);
  }

  /// From the later node to the earlier, as loops through portals.
  void addLoopByLink(std::uint32_t from, std::uint32_t to, const navmesh::LinkWay& way,
                     bool forward) {
    const float length = lengthByLink(way, forward, from, to);
    if (from < to) {
      std::swap(from, to);
      forward = !forward;
    }
    const auto polygonStart = static_cast<std::uint32_t>(out_.corridorPolygons.size());
    const auto pathStart = static_cast<std::uint32_t>(out_.pathPoints.size());
    out_.corridorPolygons.push_back(out_.nodes[from].polygon);
    out_.corridorPolygons.push_back(out_.nodes[to].polygon);
    const glm::vec2 begin = forward ? way.entry : way.exit, end = forward ? way.exit : way.entry;
    corridor_.clear();
    addPath(out_.nodes[from].plan, begin);
    out_.linkSteps.push_back({static_cast<std::uint32_t>(out_.edges.size()),
                              static_cast<std::uint32_t>(out_.pathPoints.size()) - 1 - pathStart, 1,
                              way.length, way.link, forward});
    addPath(end, out_.nodes[to].plan);
    finishEdge(NodeId{from}, NodeId{to}, EdgeKind::kLoop, length, polygonStart, pathStart);
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
    finishEdge(from, to, kind, length, polygonStart, pathStart);
  }

  [[gnu::always_inline]] void finishEdge(NodeId from, NodeId to, EdgeKind kind, float length,
                                         std::uint32_t polygonStart, std::uint32_t pathStart) {
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
  const navmesh::Links* links_;
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
  const bool linked = states != nullptr && !states->links.empty();
  Assembly assembly(navGraph, linked ? &states->links : nullptr, scratch.search_, graph,
                    scratch.nodeOf_, scratch.treeOf_, scratch.corridor_, scratch.path_);
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
