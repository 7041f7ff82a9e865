// The prediction graph: the ways a user may take from where they are, out to the horizon.
//
// Azmandian, Grechkin, Bolas and Suma, "Automated Path Prediction for Redirected Walking Using
// Navigation Meshes", 3DUI 2016. Nodes are the source (the user), branch nodes (polygons with more
// than two neighbours) and terminal nodes (where prediction stops). `prev` is the paper's prevPG.
//
// Flat arrays, parents before children, in the order the search settled them. Lengths are
// horizontal metres (see navmesh/nav_graph.h); points are plan points with heights beside them.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "navmesh/links.h"
#include "navmesh/locate.h"

namespace forewalk::prediction {

using navmesh::PolygonId;

/// Index of a node in its graph; 0 is the source.
enum class NodeId : std::uint32_t {};
inline constexpr NodeId kNoNode{0xffffffffu};
constexpr std::uint32_t index(NodeId id) { return static_cast<std::uint32_t>(id); }

enum class NodeKind : std::uint8_t {
  kSource,
  kBranch,    ///< the ways part
  kTerminal,  ///< prediction stops
  kJoin,      ///< ways come together and go on as one (graphs by fronts only); they may part again
              ///< at once, then Node::branch is set
};

/// Why prediction stops at a terminal node.
enum class TerminalReason : std::uint8_t {
  kNone,     ///< not a terminal
  kHorizon,  ///< the way goes on, but is cut here at exactly the horizon
  kDeadEnd,  ///< nowhere left to go: every neighbour is on this way already or on another (a loop
             ///< edge then shows where the two meet)
  kMeeting,  ///< the way ends where another comes toward it (graphs by fronts only); a loop edge
             ///< of no length joins the two
};

/// The points at one distance from the source where people on a way would cross it: a piece of the
/// front at the horizon, or the end of a way. Pieces that are too short to be ways belong to it, and
/// what stands between them.
struct Front {
  glm::vec2 from, to;  ///< its ends, on walls; plan, metres. Equal where it is closed, or a point
  float length;        ///< metres
};

/// A corner of a taut path from the source; the corners of all paths form a tree by `previous`.
struct Corner {
  glm::vec2 plan;
  float height;            ///< world y, metres
  float distance;          ///< length of the taut path from the source to here, metres
  std::uint32_t previous;  ///< the corner before this one; of the source itself: its own index, 0
};

struct Node {
  NodeKind kind;
  TerminalReason reason;
  bool branch;  ///< a branch node (a terminal can be one too)
  PolygonId polygon;
  glm::vec2 plan;  ///< source: the user; cut terminal: the cut; others: the polygon's centroid
  float height;    ///< of the surface there, world y, metres
  float distance;  ///< length of the taut path from the source, <= horizon, metres
  NodeId prev;     ///< prevPG: the branch node or source before it; of the source: kNoNode
  std::uint32_t corner;  ///< last corner of the taut path from the source before this node
  std::uint32_t firstChild, childCount;  ///< range in PredictionGraph::children

  glm::vec3 position() const { return {plan.x, height, -plan.y}; }
};

enum class EdgeKind : std::uint8_t { kTree, kLoop };

/// A taut path between two nodes through the corridor between them.
/// Tree edges run from a node to its prev: edge i - 1 belongs to node i. Loop edges come after: two
/// nodes in neighbouring polygons that the tree does not join.
struct Edge {
  NodeId from;
  NodeId to;
  EdgeKind kind;
  float length;                              ///< metres
  std::uint32_t polygonStart, polygonCount;  ///< range in `corridorPolygons`, from `from` to `to`;
                                             ///< of graphs by fronts see front_graph.h
  std::uint32_t pathStart, pathCount;        ///< range in `pathPoints`, from `from` to `to`
  float width = 0.0f;  ///< of the way: how far apart its walls are halfway along it, metres; 0 where
                       ///< there are none, or the graph was not made by fronts
};

/// A link (navmesh/links.h) that an edge leads through: in its path, the step from point `point` to
/// the next; in its corridor, `polygons` come before the step.
struct LinkStep {
  std::uint32_t edge;      ///< index in PredictionGraph::edges
  std::uint32_t point;     ///< counted within the edge's path
  std::uint32_t polygons;  ///< counted within the edge's corridor; 0 where the edge begins in the
                           ///< link, cut there by the horizon
  float length;            ///< of the part of the link that belongs to the edge, metres
  navmesh::LinkId link;
  bool forward;  ///< people walk it in the edge's direction; on tree edges, which run to `prev`,
                 ///< never
};

/// Flags of a graph; each names the limit to raise (PredictionLimits).
enum GraphFlags : std::uint32_t {
  kGraphComplete = 0,
  kPolygonLimit = 1u << 0,   ///< `limits.polygons` reached: ways beyond `completeTo` were dropped
  kSourceOffMesh = 1u << 1,  ///< no valid source polygon was given: the graph is only the source
};

/// What the search did, for benchmarks and dumps.
struct GraphStats {
  std::uint32_t settled = 0;   ///< polygons whose shortest key is final, cut ones included
  std::uint32_t expanded = 0;  ///< of these, no further than the horizon
  std::uint32_t relaxed = 0;   ///< neighbours looked at
};

/// How a graph was made.
enum class Method : std::uint8_t {
  kPolygon,  ///< predict.h: the paper's; polygons with more than two neighbours are branches
  kFront,    ///< front_graph.h: the front of all points at one distance; what it does is a branch
};

struct PredictionGraph {
  Method method = Method::kPolygon;
  float horizon = 0.0f;     ///< metres
  float completeTo = 0.0f;  ///< all ways are known out to here; == horizon unless a limit was hit
  std::uint32_t flags = kGraphComplete;
  navmesh::Location source;
  std::vector<Node> nodes;
  std::vector<NodeId> children;  ///< node after node, ascending
  std::vector<Edge> edges;
  std::vector<Corner> corners;
  std::vector<PolygonId> corridorPolygons;
  std::vector<glm::vec2> pathPoints;  ///< plan
  std::vector<NodeId> terminals;      ///< ascending
  std::vector<Front> fronts;          ///< one a terminal, or none: only graphs by fronts have them
  std::vector<LinkStep> linkSteps;    ///< in order of edges, and along each
  GraphStats stats;

  const Node& node(NodeId id) const { return nodes[index(id)]; }
  const Edge& treeEdge(NodeId id) const { return edges[index(id) - 1]; }  ///< not for the source
  std::span<const NodeId> childrenOf(NodeId id) const {
    return {children.data() + node(id).firstChild, node(id).childCount};
  }
  std::span<const glm::vec2> pathOf(const Edge& edge) const {
    return {pathPoints.data() + edge.pathStart, edge.pathCount};
  }
  std::span<const PolygonId> corridorOf(const Edge& edge) const {
    return {corridorPolygons.data() + edge.polygonStart, edge.polygonCount};
  }
  std::span<const LinkStep> linkStepsOf(const Edge& edge) const;  ///< an element of `edges`
};

/// Empties a graph for the next prediction, keeping its buffers.
void clear(PredictionGraph& graph);

/// Makes an emptied graph one of the source alone, with kSourceOffMesh. `source` and `horizon` are
/// set.
void sourceAlone(PredictionGraph& graph);

/// Fills in `children` and each node's range of them from the nodes' `prev`. O(nodes).
void listChildren(PredictionGraph& graph);

/// A point on a way and the unit direction of walking there (zero on a way of no length). A link
/// runs straight from its entry to its exit; in one straight up or down the direction is that of
/// the way behind it.
struct WayPoint {
  glm::vec2 plan;
  float height;  ///< interpolated between corners, world y, metres
  glm::vec2 direction;
};

/// The point at arc length `s` metres from the source along the taut path to `node`; `s` is clamped
/// to [0, distance]. O(corners of that path), no allocation.
WayPoint pointAlong(const PredictionGraph& graph, NodeId node, float s);

/// A corner ahead on a way: where it bends, how far off that is, and by how much.
struct Bend {
  float distance;  ///< arc length from the source, metres
  float angle;     ///< radians, left positive, in (-pi, pi)
  glm::vec2 plan;
};

/// The first bend of at least `minAngle` radians on the way to `node` at arc length > `after`
/// metres. False where the way is straight from there on. O(corners of that path), no allocation.
bool nextBend(const PredictionGraph& graph, NodeId node, float after, float minAngle, Bend& bend);

/// The branch node ahead: the first one on the ways out, where every way has already passed or ends
/// at it. kNoNode where the ways part at the source already, or there is no branch.
NodeId branchAhead(const PredictionGraph& graph);

/// Replaces `way` with the taut path from the source to `node`, the source first; world space,
/// metres, heights at corners. Its plan length is node.distance, but for links. Every way out: call
/// it for each of graph.terminals.
void wayTo(const PredictionGraph& graph, NodeId node, std::vector<glm::vec3>& way);

/// Replaces `lifted` with the path of `edge` on the surface, from `from` to `to`: world space,
/// metres, with a point wherever the ground leaves the straight line by more than 2 cm. Its plan is
/// the edge's path; links are straight. `graph` must have been predicted on `navGraph`; `portals`
/// is scratch. O(portals and height triangles of the corridor's polygons); allocates only where one
/// of the two has to grow.
void liftEdge(const navmesh::NavGraph& navGraph, const PredictionGraph& graph, const Edge& edge,
              std::vector<std::uint32_t>& portals, std::vector<glm::vec3>& lifted);

/// A hash of all that a consumer can see (not stats or timing); equal graphs, equal hash on one
/// build.
std::uint64_t hashOf(const PredictionGraph& graph);

}  // namespace forewalk::prediction
