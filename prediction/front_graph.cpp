#include "prediction/front_graph.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace forewalk::prediction {

using navmesh::NavGraph;

namespace {

/// The links from what is open to what is open.
navmesh::Links openLinks(const navmesh::PolygonStates& states) {
  navmesh::Links open = states.links;
  const auto leadsNowhere = [&](const navmesh::LinkWay& way) {
    return states.isClosed(way.from) || states.isClosed(way.to);
  };
  open.ways.erase(std::remove_if(open.ways.begin(), open.ways.end(), leadsNowhere),
                  open.ways.end());
  if (open.ways.size() == states.links.ways.size()) return open;
  if (open.ways.empty()) return {};
  std::uint32_t way = 0;  // they are ordered by `from`
  for (std::uint32_t p = 0; p < open.wayStart.size(); ++p) {
    while (way < open.ways.size() && index(open.ways[way].from) < p) ++way;
    open.wayStart[p] = way;
  }
  return open;
}

}  // namespace

FrontIndex makeFrontIndex(const NavGraph& graph, const navmesh::PolygonStates* states) {
  FrontIndex index;
  const auto isClosed = [](float cost) { return cost == navmesh::kClosed; };
  if (states != nullptr && std::any_of(states->cost.begin(), states->cost.end(), isClosed)) {
    for (const float cost : states->cost) index.closed.push_back(isClosed(cost));
    index.open = std::make_shared<const NavGraph>(navmesh::openPart(graph, *states));
  }
  if (states != nullptr) index.links = openLinks(*states);
  const NavGraph& open = index.open != nullptr ? *index.open : graph;
  index.ends = makePortalEnds(open);
  index.cells = makeCellMesh(open, index.ends);
  return index;
}

FrontScratch::FrontScratch(const NavGraph& graph, const FrontIndex& index,
                           const DistanceLimits& limits)
    : index_(&index),
      navGraph_(index.open != nullptr ? index.open.get() : &graph),
      field_(*navGraph_, index.ends, limits, &index.links),
      sweep_(*navGraph_, index.ends, index.cells, limits.windows) {
  // Hardly more than one node a polygon.
  const std::size_t polygons = 64 + std::min<std::size_t>(graph.polygonCount(), limits.windows);
  ways_.reserve(polygons);
  for (auto* events : {&firstOut_, &firstIn_, &nodeOf_}) events->reserve(polygons);
  graph_.nodes.reserve(polygons);
  graph_.children.reserve(polygons);
  graph_.edges.reserve(polygons);
  graph_.corners.reserve(polygons);
  graph_.pathPoints.reserve(4 * polygons);
  graph_.terminals.reserve(polygons);
  graph_.fronts.reserve(polygons);
  if (index.links.empty()) return;
  graph_.linkSteps.reserve(polygons);
  graph_.corridorPolygons.reserve(4 * polygons);
}

/// Builds one graph from one sweep. Lives for one predictFronts() call.
class FrontAssembly {
 public:
  FrontAssembly(const NavGraph& navGraph, FrontScratch& scratch, const FrontSettings& settings)
      : navGraph_(navGraph),
        scratch_(scratch),
        events_(scratch.sweep_.events()),
        arcs_(scratch.sweep_.arcs()),
        out_(scratch.graph_),
        ways_(scratch.ways_),
        persistence_(settings.persistence) {}

  void assemble() {
    listWays();
    dropRootless();
    for (std::uint32_t e = static_cast<std::uint32_t>(events_.size()); e-- > 0;) simplifyAt(e);
    out_.corners.assign(scratch_.field_.corners().begin(), scratch_.field_.corners().end());
    addNodes();
    addLoops();
    listChildren(out_);
  }

 private:
  using Way = FrontScratch::Way;

  // --- Simplification ---

  void listWays() {
    ways_.clear();
    scratch_.firstOut_.assign(events_.size(), kNone);
    scratch_.firstIn_.assign(events_.size(), kNone);
    for (std::uint32_t a = 0; a < arcs_.size(); ++a) {
      const FrontArc& arc = arcs_[a];
      Way& way = ways_.emplace_back();
      way.from = arc.from;
      way.to = arc.to;
      way.last = a;
      way.gone = arc.to == kNone && arc.front == kNone;
      way.nextOut = std::exchange(scratch_.firstOut_[arc.from], a);
      way.nextIn = arc.to == kNone ? kNone : std::exchange(scratch_.firstIn_[arc.to], a);
      way.mergedInto = a;
      way.front = arc.front == kNone ? HorizonFront{} : scratch_.sweep_.fronts()[arc.front];
    }
  }

  std::uint32_t resolved(std::uint32_t way) const {
    while (ways_[way].mergedInto != way) way = ways_[way].mergedInto;
    return way;
  }

  template <typename Visit>
  void forEachOut(std::uint32_t event, const Visit& visit) const {
    for (std::uint32_t w = scratch_.firstOut_[event]; w != kNone; w = ways_[w].nextOut) {
      if (!ways_[w].gone) visit(w);
    }
  }
  template <typename Visit>
  void forEachIn(std::uint32_t event, const Visit& visit) const {
    for (std::uint32_t w = scratch_.firstIn_[event]; w != kNone; w = ways_[w].nextIn) {
      const std::uint32_t way = resolved(w);
      if (!ways_[way].gone && ways_[way].to == event) visit(way);
    }
  }
  std::uint32_t outCount(std::uint32_t event) const {
    std::uint32_t count = 0;
    forEachOut(event, [&](std::uint32_t) { ++count; });
    return count;
  }
  std::uint32_t inCount(std::uint32_t event) const {
    std::uint32_t count = 0;
    forEachIn(event, [&](std::uint32_t) { ++count; });
    return count;
  }

  /// Rounding can make a piece of the front begin where another only touches an edge: it joins that
  /// one at once, and is no way.
  void dropRootless() {
    for (std::uint32_t e = 1; e < events_.size(); ++e) {
      if (inCount(e) > 0) continue;
      forEachOut(e, [&](std::uint32_t w) {
        Way& way = ways_[w];
        if (way.to != kNone && inCount(way.to) > 1) {
          way.gone = true;
        } else {
          way.from = 0;
        }
      });
    }
  }

  float endOf(const Way& way) const {
    return way.to == kNone ? out_.horizon : events_[way.to].distance;
  }

  float widthOf(const Way& way) const { return scratch_.sweep_.widthOf(way.last); }

  bool isLeaf(const Way& way) const {
    return way.to == kNone || (outCount(way.to) == 0 && inCount(way.to) == 1);
  }

  /// Merges the short ways that leave an event; all beyond it is simple already.
  void simplifyAt(std::uint32_t event) {
    const float limit = events_[event].distance + persistence_;
    for (std::uint32_t count = outCount(event); count > 1; --count) {
      std::uint32_t shortest = kNone;
      forEachOut(event, [&](std::uint32_t w) {
        const Way& way = ways_[w];
        if (endOf(way) >= limit || !(isLeaf(way) || hasTwin(event, w))) return;
        if (shortest == kNone || endOf(way) < endOf(ways_[shortest]) ||
            (endOf(way) == endOf(ways_[shortest]) && widthOf(way) < widthOf(ways_[shortest]))) {
          shortest = w;
        }
      });
      if (shortest == kNone) break;
      ways_[shortest].gone = true;
      if (ways_[shortest].to == kNone) leaveFront(event, ways_[shortest].front);
    }
    // Two ways that meet have hardly anywhere to go: they end where they meet.
    if (outCount(event) == 1 && inCount(event) > 1) {
      forEachOut(event, [&](std::uint32_t w) {
        Way& way = ways_[w];
        if (way.to != kNone && isLeaf(way) && endOf(way) < limit) way.gone = true;
      });
    }
    if (event == 0 || outCount(event) != 1 || inCount(event) != 1) return;
    std::uint32_t in = kNone;
    std::uint32_t out = kNone;
    forEachIn(event, [&](std::uint32_t w) { in = w; });
    forEachOut(event, [&](std::uint32_t w) { out = w; });
    Way& way = ways_[in];
    way.to = ways_[out].to;
    way.last = ways_[out].last;
    way.front = ways_[out].front;
    ways_[out].gone = true;
    ways_[out].mergedInto = in;
  }

  /// A way cut at the horizon that is no way of its own leaves its piece of the front to its
  /// neighbour at the horizon, if it has one: the two are one front still, with what stands between
  /// them. Neighbours are known by the ends that lie closest together.
  void leaveFront(std::uint32_t event, const HorizonFront& gone) {
    Way* heir = nullptr;
    glm::vec2 from(0.0f), to(0.0f);  // ends of the two together
    float gap = 0.0f;
    forEachOut(event, [&](std::uint32_t w) {
      Way& way = ways_[w];
      if (way.to != kNone || way.front.from == way.front.to) return;
      const auto consider = [&](glm::vec2 near, glm::vec2 nearOfGone, glm::vec2 far,
                                glm::vec2 farOfGone) {
        const float apart = glm::distance(near, nearOfGone);
        if (heir != nullptr && apart >= gap) return;
        heir = &way;
        from = far;
        to = farOfGone;
        gap = apart;
      };
      consider(way.front.to, gone.from, way.front.from, gone.to);
      consider(way.front.to, gone.to, way.front.from, gone.from);
      consider(way.front.from, gone.from, way.front.to, gone.to);
      consider(way.front.from, gone.to, way.front.to, gone.from);
    });
    if (heir == nullptr || gone.from == gone.to) return;
    heir->front.from = from;
    heir->front.to = to;
    heir->front.length += gap + gone.length;
  }

  /// Whether another way from the event ends where this one does: around a pillar too thin to tell
  /// them apart.
  bool hasTwin(std::uint32_t event, std::uint32_t w) const {
    bool twin = false;
    forEachOut(event, [&](std::uint32_t other) {
      twin = twin || (other != w && ways_[other].to == ways_[w].to && ways_[w].to != kNone);
    });
    return twin;
  }

  // --- Nodes and edges ---

  void addNodes() {
    scratch_.nodeOf_.assign(events_.size(), kNone);
    addNode(NodeKind::kSource, events_[0].plan, out_.source.polygon, 0.0f, kNoNode, 0);
    out_.nodes.back().height = out_.source.height;
    scratch_.nodeOf_[0] = 0;
    for (std::uint32_t e = 1; e < events_.size(); ++e) addEventNodes(e);
    for (std::uint32_t w = 0; w < ways_.size(); ++w) {
      if (!ways_[w].gone && ways_[w].to == kNone) addHorizonNode(ways_[w]);
    }
  }

  void addEventNodes(std::uint32_t e) {
    const std::uint32_t outs = outCount(e);
    const std::uint32_t ins = inCount(e);
    if (ins == 0) return;
    const FrontEvent& event = events_[e];
    std::uint32_t seen = 0;
    forEachIn(e, [&](std::uint32_t w) {
      // Ways that end here each have an end of their own; what goes on has one.
      if (seen++ > 0 && outs > 0) return;
      const Way& way = ways_[w];
      const NodeKind kind = outs == 0 ? NodeKind::kTerminal
                            : ins > 1 ? NodeKind::kJoin
                                      : NodeKind::kBranch;
      Node& node = addNode(kind, event.plan, event.polygon, event.distance, nodeAt(way.from),
                           arcs_[way.last].corner);
      node.branch = outs > 1;
      const std::uint32_t id = static_cast<std::uint32_t>(out_.nodes.size() - 1);
      if (seen == 1) scratch_.nodeOf_[e] = id;
      if (outs == 0) {
        node.reason = ins > 1 ? TerminalReason::kMeeting : TerminalReason::kDeadEnd;
        out_.terminals.push_back(NodeId{id});
        out_.fronts.push_back({event.plan, event.plan, 0.0f});
      }
      addPathEdge(NodeId{id}, node.prev, arcs_[way.last].corner, EdgeKind::kTree, widthOf(way));
    });
  }

  void addHorizonNode(const Way& way) {
    const FrontArc& arc = arcs_[way.last];
    const HorizonFront& front = way.front;
    Node& node = addNode(NodeKind::kTerminal, front.crossing, front.polygon, out_.horizon,
                         nodeAt(way.from), arc.corner);
    node.reason = TerminalReason::kHorizon;
    const LinkPassage* cut = nullptr;
    if (front.link != kNone) {
      cut = &scratch_.field_.passages()[front.link];
      node.height = heightIn(*cut);
    }
    const NodeId id{static_cast<std::uint32_t>(out_.nodes.size() - 1)};
    out_.terminals.push_back(id);
    out_.fronts.push_back({front.from, front.to, front.length});
    addPathEdge(id, node.prev, arc.corner, EdgeKind::kTree, widthOf(way), cut);
  }

  /// Where the horizon falls into a link, metres.
  float heightIn(const LinkPassage& cut) const {
    const navmesh::LinkWay& way = wayOf(cut);
    const float walked = out_.horizon - out_.corners[cut.entry].distance;
    const float share = way.length > 0.0f ? std::clamp(walked / way.length, 0.0f, 1.0f) : 0.0f;
    return way.entryHeight + share * (way.exitHeight - way.entryHeight);
  }

  const navmesh::LinkWay& wayOf(const LinkPassage& passage) const {
    return scratch_.field_.links()->ways[passage.way];
  }

  NodeId nodeAt(std::uint32_t event) const {
    const std::uint32_t node = scratch_.nodeOf_[event];
    return NodeId{node == kNone ? 0 : node};
  }

  Node& addNode(NodeKind kind, glm::vec2 plan, PolygonId polygon, float distance, NodeId prev,
                std::uint32_t corner) {
    Node& node = out_.nodes.emplace_back();
    node.kind = kind;
    node.reason = TerminalReason::kNone;
    node.branch = false;
    node.polygon = polygon;
    node.plan = plan;
    node.height = navmesh::heightAt(navGraph_, polygon, plan);
    node.distance = distance;
    node.prev = prev;
    node.corner = corner;
    node.firstChild = 0;
    node.childCount = 0;
    return node;
  }

  /// An edge along the shortest path to `from` by `corner`, back to the distance of `to`. `cut`:
  /// the link that `from` lies in.
  void addPathEdge(NodeId from, NodeId to, std::uint32_t corner, EdgeKind kind, float width,
                   const LinkPassage* cut = nullptr) {
    const Node& node = out_.node(from);
    const float end = out_.node(to).distance;
    Edge& edge = out_.edges.emplace_back();
    edge.from = from;
    edge.to = to;
    edge.kind = kind;
    edge.length = node.distance - end;
    edge.polygonStart = static_cast<std::uint32_t>(out_.corridorPolygons.size());
    edge.pathStart = static_cast<std::uint32_t>(out_.pathPoints.size());
    edge.width = width;
    out_.pathPoints.push_back(node.plan);
    glm::vec2 at = node.plan;
    float distance = node.distance;
    const LinkPassage* link = cut;  // that leads to `at`
    const auto stepBackTo = [&](glm::vec2 place, float before) {
      if (link != nullptr) {
        addLinkStep(*link, distance - before);
        out_.pathPoints.push_back(place);
      } else if (out_.pathPoints.back() != place) {
        out_.pathPoints.push_back(place);
      }
      at = place;
      distance = before;
    };
    while (out_.corners[corner].distance > end || beginsWithLink(corner, out_.node(to))) {
      stepBackTo(out_.corners[corner].plan, out_.corners[corner].distance);
      link = scratch_.field_.passageTo(corner);
      corner = out_.corners[corner].previous;
    }
    const Corner& before = out_.corners[corner];
    const float leg = distance - before.distance;
    const float share = leg > 0.0f ? (distance - end) / leg : link != nullptr ? 1.0f : 0.0f;
    stepBackTo(glm::mix(at, before.plan, std::clamp(share, 0.0f, 1.0f)), end);
    edge.polygonCount =
        static_cast<std::uint32_t>(out_.corridorPolygons.size()) - edge.polygonStart;
    edge.pathCount = static_cast<std::uint32_t>(out_.pathPoints.size()) - edge.pathStart;
  }

  /// Whether `corner`, no farther than `to`, lies behind it nevertheless: behind links of no
  /// length.
  bool beginsWithLink(std::uint32_t corner, const Node& to) const {
    for (; corner != 0 && out_.corners[corner].distance == to.distance;
         corner = out_.corners[corner].previous) {
      const LinkPassage* link = scratch_.field_.passageTo(corner);
      if (link == nullptr) continue;
      const Corner& entry = out_.corners[link->entry];
      if (entry.distance == to.distance && entry.plan == to.plan &&
          std::abs(entry.height - to.height) < 0.01f) {
        return true;
      }
    }
    return false;
  }

  /// Of the edge at hand, which goes backwards through the link from the latest point of its path.
  void addLinkStep(const LinkPassage& link, float length) {
    const Edge& edge = out_.edges.back();
    const navmesh::LinkWay& way = wayOf(link);
    const auto known = [&] {
      return static_cast<std::uint32_t>(out_.corridorPolygons.size()) - edge.polygonStart;
    };
    const auto point = static_cast<std::uint32_t>(out_.pathPoints.size()) - 1 - edge.pathStart;
    if (link.exit != kNone) {  // over the floor behind the link
      if (known() == 0) out_.corridorPolygons.push_back(out_.node(edge.from).polygon);
      out_.corridorPolygons.push_back(way.to);
    }
    // A link walked to its end is as long as it says, not as distances round.
    out_.linkSteps.push_back({static_cast<std::uint32_t>(out_.edges.size()) - 1, point, known(),
                              link.exit != kNone ? way.length : length, way.link, false});
    out_.corridorPolygons.push_back(way.from);
  }

  /// What a tree cannot show: the other ways into a join, and ways that end in a meeting.
  void addLoops() {
    for (std::uint32_t e = 1; e < events_.size(); ++e) {
      const std::uint32_t node = scratch_.nodeOf_[e];
      if (node == kNone || inCount(e) < 2) continue;
      std::uint32_t seen = 0;
      const bool ends = out_.nodes[node].kind == NodeKind::kTerminal;
      forEachIn(e, [&](std::uint32_t w) {
        if (seen++ == 0) return;
        const Way& way = ways_[w];
        if (ends) {
          addMeetingEdge(NodeId{node + seen - 1}, NodeId{node + seen - 2});
        } else {
          addPathEdge(NodeId{node}, nodeAt(way.from), arcs_[way.last].corner, EdgeKind::kLoop,
                      widthOf(way));
        }
      });
    }
  }

  void addMeetingEdge(NodeId from, NodeId to) {
    Edge& edge = out_.edges.emplace_back();
    edge.from = from;
    edge.to = to;
    edge.kind = EdgeKind::kLoop;
    edge.length = 0.0f;
    edge.polygonStart = static_cast<std::uint32_t>(out_.corridorPolygons.size());
    edge.polygonCount = 0;
    edge.pathStart = static_cast<std::uint32_t>(out_.pathPoints.size());
    edge.pathCount = 1;
    out_.pathPoints.push_back(out_.node(from).plan);
  }

  const NavGraph& navGraph_;
  FrontScratch& scratch_;
  std::span<const FrontEvent> events_;
  std::span<const FrontArc> arcs_;
  PredictionGraph& out_;
  std::vector<Way>& ways_;
  float persistence_;
};

namespace {

/// The nearest place of a portal that leads from the polygon of `source`, which is closed, to one
/// that is not; in no polygon where there is none.
navmesh::Location wayOut(const NavGraph& all, const std::vector<bool>& closed,
                         const navmesh::Location& source) {
  navmesh::Location out = source;
  out.polygon = navmesh::kNoPolygon;
  float nearest = std::numeric_limits<float>::infinity();
  const std::uint32_t from = index(source.polygon);
  for (std::uint32_t h = all.portalStart[from]; h < all.portalStart[from + 1]; ++h) {
    if (closed[index(all.portalTo[h])]) continue;
    const navmesh::Portal& portal = all.portals[h];
    const glm::vec2 along = portal.left - portal.right;
    const float squared = glm::dot(along, along);
    const float share =
        squared > 0.0f
            ? std::clamp(glm::dot(source.plan - portal.right, along) / squared, 0.0f, 1.0f)
            : 0.0f;
    const glm::vec2 place = portal.right + share * along;
    const float apart = glm::distance(place, source.plan);
    if (apart >= nearest) continue;
    nearest = apart;
    out.polygon = all.portalTo[h];
    out.plan = place;
  }
  return out;
}

}  // namespace

const PredictionGraph& predictFronts(const NavGraph& navGraph, const navmesh::Location& place,
                                     float horizon, FrontScratch& scratch,
                                     const FrontSettings& settings) {
  PredictionGraph& graph = scratch.graph_;
  clear(graph);
  graph.method = Method::kFront;
  graph.horizon = horizon > 0.0f ? horizon : 0.0f;
  graph.completeTo = graph.horizon;
  graph.source = place;
  navmesh::Location source = place;
  const std::vector<bool>& closed = scratch.index_->closed;
  if (index(place.polygon) < closed.size() && closed[index(place.polygon)]) {
    source = wayOut(navGraph, closed, place);
  }
  if (index(source.polygon) >= navGraph.polygonCount()) {
    sourceAlone(graph);
    return graph;
  }
  scratch.field_.run(source, graph.horizon);
  scratch.sweep_.run(scratch.field_, source, graph.horizon);
  FrontAssembly(*scratch.navGraph_, scratch, settings).assemble();
  graph.stats.settled = static_cast<std::uint32_t>(scratch.field_.polygons().size());
  graph.stats.expanded = graph.stats.settled;
  if (scratch.field_.limitReached()) {
    graph.flags |= kPolygonLimit;
    graph.completeTo = std::min(graph.horizon, scratch.field_.completeTo());
  }
  return graph;
}

}  // namespace forewalk::prediction
