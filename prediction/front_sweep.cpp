#include "prediction/front_sweep.h"

#include <algorithm>
#include <cmath>

#include "navmesh/plan.h"

namespace forewalk::prediction {

using glm::dvec2;
using navmesh::kNoPolygon;
using navmesh::NavGraph;

namespace {

/// Extremes nearer than this to an end of their edge, or less high than this, are not told apart
/// from the end; metres.
constexpr double kApart = 1e-3;

double cross(dvec2 a, dvec2 b) { return a.x * b.y - a.y * b.x; }

}  // namespace

FrontSweep::FrontSweep(const NavGraph& graph, const PortalEnds& ends, const CellMesh& cells)
    : graph_(&graph), ends_(&ends), mesh_(&cells) {
  vertexOf_.assign(cells.plan.size(), kNone);
  firstEdgeOf_.assign(cells.edges.size(), kNone);
  edgeCountOf_.assign(cells.edges.size(), 0);
}

void FrontSweep::reset() {
  for (const std::uint32_t vertex : touchedVertices_) vertexOf_[vertex] = kNone;
  for (const std::uint32_t edge : touchedEdges_) firstEdgeOf_[edge] = kNone;
  touchedVertices_.clear();
  touchedEdges_.clear();
  vertices_.clear();
  edges_.clear();
  cells_.clear();
  records_.clear();
  order_.clear();
  arcOf_.clear();
  events_.clear();
  arcs_.clear();
  fronts_.clear();
}

// --- What was reached, as cells that each level crosses in one piece ---

std::uint32_t FrontSweep::addVertex(glm::vec2 plan, float value, PolygonId polygon) {
  vertices_.push_back({plan, value, polygon, kNoPolygon, false, false, false});
  return static_cast<std::uint32_t>(vertices_.size() - 1);
}

std::uint32_t FrontSweep::addEdge(std::uint32_t a, std::uint32_t b, PolygonId polygon) {
  edges_.push_back({a, b, {kNone, kNone}, kNone, polygon});
  return static_cast<std::uint32_t>(edges_.size() - 1);
}

std::uint32_t FrontSweep::vertexAt(std::uint32_t meshVertex, PolygonId polygon) {
  std::uint32_t& vertex = vertexOf_[meshVertex];
  if (vertex != kNone) return vertex;
  const glm::vec2 plan = mesh_->plan[meshVertex];
  const bool end = meshVertex < ends_->count();
  // Of an end the field knows the distance already, if it is within the horizon.
  const float known =
      end ? field_->endDistance(meshVertex) : std::numeric_limits<float>::infinity();
  vertex = addVertex(plan, std::min(known, field_->distanceAt(polygon, plan)), polygon);
  vertices_[vertex].forced = end && ends_->kind[meshVertex] == PortalEnds::Kind::kPinch;
  touchedVertices_.push_back(meshVertex);
  return vertex;
}

/// Adds the windows of a polygon that do not come in over an edge.
void FrontSweep::gatherViews(PolygonId polygon, std::uint32_t exceptEdge) {
  if (polygon == kNoPolygon) return;
  for (std::uint32_t w = field_->firstWindow(polygon); w != kNone; w = field_->windows()[w].next) {
    const Window& window = field_->windows()[w];
    if (window.portal != kNone && mesh_->edgeOfPortal[window.portal] == exceptEdge) continue;
    const Corner& root = field_->corners()[window.corner];
    views_.push_back({polygon, dvec2(root.plan), static_cast<double>(root.distance), &window});
  }
}

bool FrontSweep::sees(const View& view, dvec2 point) const {
  if (view.window->portal == kNone) return true;
  const dvec2 ray = point - view.root;
  const double slack = 1e-6;
  const auto inside = [&](double side, dvec2 bound) {
    return side >= 0.0 || side * side <= slack * slack * glm::dot(bound, bound);
  };
  return inside(cross(ray, view.window->left), view.window->left) &&
         inside(cross(view.window->right, ray), view.window->right);
}

/// The shortest way to a point by the views at hand.
FrontSweep::Seen FrontSweep::look(dvec2 point) const {
  Seen best{std::numeric_limits<double>::infinity(), dvec2(0.0)};
  for (const View& view : views_) {
    const double length = view.distance + glm::length(point - view.root);
    if (length < best.length && sees(view, point)) best = {length, view.root};
  }
  return best;
}

/// Where the distance is highest between two places of an edge, metres along it, if it rises at
/// the first and falls at the second; else 0.
double FrontSweep::highestBetween(dvec2 from, dvec2 along, double low, double high) const {
  const auto rises = [&](double at) {
    const dvec2 point = from + at * along;
    return glm::dot(point - look(point).root, along) > 0.0;
  };
  const double inward = std::min(kApart, 0.25 * (high - low));
  double left = low + inward;
  double right = high - inward;
  if (!rises(left) || rises(right)) return 0.0;
  for (int i = 0; i < 16 && right - left > 1e-4; ++i) {
    const double middle = 0.5 * (left + right);
    (rises(middle) ? left : right) = middle;
  }
  return 0.5 * (left + right);
}

/// Cuts an edge where the distance along it is lowest or highest.
void FrontSweep::cutEdge(std::uint32_t meshEdge) {
  if (firstEdgeOf_[meshEdge] != kNone) return;
  const CellMesh::Edge& edge = mesh_->edges[meshEdge];
  std::uint32_t at = vertexAt(edge.from, edge.left);
  const std::uint32_t end = vertexAt(edge.to, edge.left);
  firstEdgeOf_[meshEdge] = static_cast<std::uint32_t>(edges_.size());
  touchedEdges_.push_back(meshEdge);
  views_.clear();
  gatherViews(edge.left, meshEdge);
  gatherViews(edge.right, meshEdge);

  const dvec2 from(vertices_[at].plan);
  const dvec2 span = dvec2(vertices_[end].plan) - from;
  const double length = glm::length(span);
  const dvec2 along = length > 0.0 ? span / length : dvec2(0.0);
  feet_.clear();
  feet_.reserve(views_.size() + 1);
  bool oneRoot = true;
  for (const View& view : views_) {
    oneRoot = oneRoot && view.root == views_.front().root;
    const double foot = glm::dot(view.root - from, along);
    if (foot < kApart || foot > length - kApart) continue;
    const dvec2 point = from + foot * along;
    const double there = view.distance + glm::length(point - view.root);
    if (there > static_cast<double>(horizon_) || !sees(view, point)) continue;
    if (look(point).length < there - 1e-6) continue;
    feet_.push_back({foot, view.polygon});
  }
  std::sort(feet_.begin(), feet_.end(),
            [](const Foot& a, const Foot& b) { return a.along < b.along; });
  feet_.push_back({length, kNoPolygon});

  const auto cutAt = [&](double place, PolygonId front) {
    const dvec2 point = from + place * along;
    const std::uint32_t vertex =
        addVertex(glm::vec2(point), static_cast<float>(look(point).length), edge.left);
    vertices_[vertex].from = front;
    addEdge(at, vertex, edge.left);
    at = vertex;
  };
  double before = 0.0;
  for (const Foot& foot : feet_) {
    const bool last = &foot == &feet_.back();
    if (!last && foot.along - before < kApart) continue;  // two roots in one place
    if (!oneRoot && foot.along - before > 4 * kApart) {
      const double highest = highestBetween(from, along, before, foot.along);
      if (highest > 0.0) {
        cutAt(highest, kNoPolygon);
        vertices_[at].meeting = true;
      }
    }
    if (!last) cutAt(foot.along, foot.front);
    before = foot.along;
  }
  addEdge(at, end, edge.left);
  edgeCountOf_[meshEdge] = static_cast<std::uint32_t>(edges_.size()) - firstEdgeOf_[meshEdge];
}

bool FrontSweep::below(std::uint32_t a, std::uint32_t b) const {
  return vertices_[a].value < vertices_[b].value ||
         (vertices_[a].value == vertices_[b].value && a < b);
}

/// A cell with the given outline, counter-clockwise: each vertex and the edge from there on.
std::uint32_t FrontSweep::cellOf(std::span<const CycleCorner> outline, PolygonId polygon) {
  const std::uint32_t cell = static_cast<std::uint32_t>(cells_.size());
  cells_.push_back({polygon, {kNone, kNone}});
  std::uint32_t in = outline.back().edge;
  for (const CycleCorner& corner : outline) {
    records_.push_back({corner.vertex, cell, in, corner.edge});
    std::uint32_t* sides = edges_[corner.edge].cells;
    sides[sides[0] == kNone ? 0 : 1] = cell;
    in = corner.edge;
  }
  return cell;
}

/// Cells of a polygon, or of a part of it, that one front comes into at corner `low`.
void FrontSweep::addBasin(std::span<const CycleCorner> outline, std::size_t low,
                          PolygonId polygon) {
  const std::size_t count = outline.size();
  const auto at = [&](std::size_t i) { return outline[i % count]; };
  // The other lows are where the front touches edges that it goes out over.
  others_.clear();
  for (std::size_t i = low + 1; i < low + count; ++i) {
    if (below(at(i).vertex, at(i + 1).vertex) && below(at(i).vertex, at(i - 1).vertex)) {
      others_.push_back(i);
    }
  }
  std::uint32_t chord = kNone;
  std::size_t begin = low;
  for (std::size_t k = 0; k <= others_.size(); ++k) {
    const std::size_t end = k < others_.size() ? others_[k] : low + count;
    outline_.clear();
    if (chord != kNone) outline_.push_back({at(low).vertex, chord});
    for (std::size_t i = begin; i < end; ++i) outline_.push_back(at(i));
    if (k < others_.size()) {
      chord = addEdge(at(low).vertex, at(end).vertex, polygon);
      outline_.push_back({at(end).vertex, chord});
    }
    cellOf(outline_, polygon);
    begin = end;
  }
}

/// Cells of a polygon whose outline is in `cycle_`.
void FrontSweep::addCells(PolygonId polygon) {
  const std::size_t count = cycle_.size();
  lows_.clear();
  std::size_t lowest = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint32_t vertex = cycle_[i].vertex;
    if (below(vertex, cycle_[lowest].vertex)) lowest = i;
    if (vertices_[vertex].from != polygon && vertices_[vertex].value <= horizon_ &&
        below(vertex, cycle_[(i + 1) % count].vertex) &&
        below(vertex, cycle_[(i + count - 1) % count].vertex)) {
      lows_.push_back(i);
    }
  }
  if (lows_.size() < 2) {
    addBasin(cycle_, lows_.empty() ? lowest : lows_.front(), polygon);
    return;
  }
  // Fronts come in over each of the lows, and meet. Between two neighbouring ones: where they meet
  // on the outline, or where that is not known, its highest vertex.
  const std::size_t lows = lows_.size();
  highs_.clear();
  for (std::size_t i = 0; i < lows; ++i) {
    std::size_t high = lows_[i];
    const std::size_t end = lows_[(i + 1) % lows];
    for (std::size_t at = lows_[i]; at != end; at = (at + 1) % count) {
      const bool meets = vertices_[cycle_[at].vertex].meeting;
      const bool met = vertices_[cycle_[high].vertex].meeting;
      if (meets == met ? below(cycle_[high].vertex, cycle_[at].vertex) : meets) high = at;
    }
    highs_.push_back(high);
  }
  glm::vec2 plan;
  float value;
  if (lows == 2 && findMeeting(polygon, plan, value)) {
    const std::uint32_t meeting = addVertex(plan, value, polygon);
    const std::size_t stops[4] = {lows_[0], highs_[0], lows_[1], highs_[1]};
    std::uint32_t spokes[4];
    for (int i = 0; i < 4; ++i) spokes[i] = addEdge(meeting, cycle_[stops[i]].vertex, polygon);
    for (int i = 0; i < 4; ++i) {
      basin_.clear();
      basin_.push_back({meeting, spokes[i]});
      const std::size_t end = stops[(i + 1) % 4];
      for (std::size_t at = stops[i]; at != end; at = (at + 1) % count) {
        basin_.push_back(cycle_[at]);
      }
      basin_.push_back({cycle_[end].vertex, spokes[(i + 1) % 4]});
      addBasin(basin_, i % 2 == 0 ? 1 : basin_.size() - 1, polygon);
    }
    return;
  }
  // They meet first at a high of the outline: each low gets the part between its two highs.
  inner_.clear();
  for (std::size_t i = 0; i < lows; ++i) {
    const std::size_t begin = highs_[i];
    const std::size_t end = highs_[(i + 1) % lows];
    // Two highs are joined by one chord, seen from both sides.
    const std::uint32_t chord = lows == 2 && i == 1
                                    ? inner_.front().edge
                                    : addEdge(cycle_[begin].vertex, cycle_[end].vertex, polygon);
    inner_.push_back({cycle_[begin].vertex, chord});
    basin_.clear();
    std::size_t low = 0;
    for (std::size_t at = begin; at != end; at = (at + 1) % count) {
      if (at == lows_[(i + 1) % lows]) low = basin_.size();
      basin_.push_back(cycle_[at]);
    }
    basin_.push_back({cycle_[end].vertex, chord});
    addBasin(basin_, low, polygon);
  }
  if (lows < 3) return;
  // What is left between the chords, in triangles about the lowest of the highs.
  std::size_t first = 0;
  for (std::size_t i = 1; i < lows; ++i) {
    if (below(inner_[i].vertex, inner_[first].vertex)) first = i;
  }
  std::uint32_t spoke = inner_[first].edge;
  for (std::size_t i = 1; i + 1 < lows; ++i) {
    const CycleCorner& a = inner_[(first + i) % lows];
    const CycleCorner& b = inner_[(first + i + 1) % lows];
    const std::uint32_t next =
        i + 2 == lows ? b.edge : addEdge(b.vertex, inner_[first].vertex, polygon);
    const CycleCorner triangle[3] = {{inner_[first].vertex, spoke}, a, {b.vertex, next}};
    cellOf(triangle, polygon);
    spoke = next;
  }
}

/// The source is a vertex inside its polygon: triangles about it.
void FrontSweep::addSourceCells(PolygonId polygon) {
  const std::uint32_t source = 0;
  const std::uint32_t first = static_cast<std::uint32_t>(edges_.size());
  const std::uint32_t count = static_cast<std::uint32_t>(cycle_.size());
  for (const CycleCorner& corner : cycle_) addEdge(source, corner.vertex, polygon);
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::uint32_t next = (i + 1) % count;
    const CycleCorner triangle[3] = {
        {source, first + i}, cycle_[i], {cycle_[next].vertex, first + next}};
    cellOf(triangle, polygon);
  }
}

/// Where two fronts meet first inside a polygon: between two roots that see each other's way, at
/// the same distance by both.
bool FrontSweep::findMeeting(PolygonId polygon, glm::vec2& plan, float& value) {
  views_.clear();
  gatherViews(polygon, kNone);
  value = horizon_;
  bool found = false;
  for (std::size_t i = 0; i < views_.size(); ++i) {
    for (std::size_t j = i + 1; j < views_.size(); ++j) {
      const dvec2 between = views_[j].root - views_[i].root;
      const double gap = glm::length(between);
      const double half = 0.5 * (gap + views_[j].distance - views_[i].distance);
      if (!(half > 0.0 && half < gap)) continue;
      const dvec2 point = views_[i].root + half / gap * between;
      const double there = views_[i].distance + half;
      if (there >= static_cast<double>(value) || !sees(views_[i], point) ||
          !sees(views_[j], point) || look(point).length < there - 1e-6 ||
          !navmesh::contains(*graph_, polygon, glm::vec2(point))) {
        continue;
      }
      plan = glm::vec2(point);
      value = static_cast<float>(there);
      found = true;
    }
  }
  if (!found) return false;
  // Not where it lies beside the outline: then a high of the outline is as good.
  for (const std::size_t high : highs_) {
    if (!(value < vertices_[cycle_[high].vertex].value - static_cast<float>(kApart))) return false;
  }
  for (const std::size_t low : lows_) {
    if (!(value > vertices_[cycle_[low].vertex].value)) return false;
  }
  return true;
}

// --- The sweep ---

void FrontSweep::sortVertices() {
  rank_.assign(vertices_.size(), kNone);
  for (std::uint32_t v = 0; v < vertices_.size(); ++v) {
    if (vertices_[v].value > horizon_) continue;
    order_.push_back(navmesh::KeyQueue::entryOf(vertices_[v].value, PolygonId{v}));
  }
  std::sort(order_.begin(), order_.end());
  for (std::uint32_t i = 0; i < order_.size(); ++i) {
    rank_[index(navmesh::KeyQueue::polygonOf(order_[i]))] = i;
  }
  recordStart_.assign(vertices_.size() + 1, 0);
  for (const CornerRecord& record : records_) ++recordStart_[record.vertex + 1];
  for (std::size_t v = 0; v < vertices_.size(); ++v) recordStart_[v + 1] += recordStart_[v];
  recordOf_.resize(records_.size());
  for (std::uint32_t r = 0; r < records_.size(); ++r) {
    recordOf_[recordStart_[records_[r].vertex]++] = r;
  }
  for (std::size_t v = vertices_.size(); v > 0; --v) recordStart_[v] = recordStart_[v - 1];
  recordStart_[0] = 0;
  for (const Edge& edge : edges_) {
    if (edge.cells[1] != kNone) continue;
    vertices_[edge.a].border = true;
    vertices_[edge.b].border = true;
  }
}

bool FrontSweep::isLower(std::uint32_t edge, std::uint32_t vertex) const {
  const Edge& e = edges_[edge];
  return rank_[e.a == vertex ? e.b : e.a] < rank_[vertex];
}

/// The front moves over a vertex.
void FrontSweep::pass(std::uint32_t vertex) {
  int passes = 0;
  std::uint32_t piece = kNone;
  for (std::uint32_t i = recordStart_[vertex]; i < recordStart_[vertex + 1]; ++i) {
    const CornerRecord& record = records_[recordOf_[i]];
    const bool in = isLower(record.in, vertex);
    const bool out = isLower(record.out, vertex);
    passes += in != out ? 1 : 0;
    if (in) piece = edges_[record.in].piece;
    if (out) piece = edges_[record.out].piece;
  }
  if (passes != (vertices_[vertex].border ? 1 : 2) || vertices_[vertex].forced) {
    happen(vertex);
    return;
  }
  updateCells(vertex);
  for (std::uint32_t i = recordStart_[vertex]; i < recordStart_[vertex + 1]; ++i) {
    const CornerRecord& record = records_[recordOf_[i]];
    for (const std::uint32_t edge : {record.in, record.out}) {
      if (!isLower(edge, vertex)) edges_[edge].piece = piece;
    }
  }
}

/// Moves the front in the cells about a vertex from its lower edges to its upper ones.
void FrontSweep::updateCells(std::uint32_t vertex) {
  for (std::uint32_t i = recordStart_[vertex]; i < recordStart_[vertex + 1]; ++i) {
    const CornerRecord& record = records_[recordOf_[i]];
    Cell& cell = cells_[record.cell];
    const bool in = isLower(record.in, vertex);
    const bool out = isLower(record.out, vertex);
    if (in && out) {
      cell.crossed[0] = cell.crossed[1] = kNone;
    } else if (!in && !out) {
      cell.crossed[0] = record.in;
      cell.crossed[1] = record.out;
    } else {
      const std::uint32_t lower = in ? record.in : record.out;
      cell.crossed[cell.crossed[0] == lower ? 0 : 1] = in ? record.out : record.in;
    }
  }
}

/// Calls visit(edge, cell) for each edge that the front crosses after `edge`, going out of it into
/// its cell on one side, and the cell before it. True if it comes back to `edge`.
template <typename Visit>
bool FrontSweep::follow(std::uint32_t edge, int side, const Visit& visit) const {
  std::uint32_t at = edge;
  std::uint32_t cell = edges_[edge].cells[side];
  while (cell != kNone) {
    const Cell& here = cells_[cell];
    const std::uint32_t next = here.crossed[here.crossed[0] == at ? 1 : 0];
    if (next == kNone) return false;
    visit(next, cell);
    if (next == edge) return true;
    const Edge& e = edges_[next];
    cell = e.cells[e.cells[0] == cell ? 1 : 0];
    at = next;
  }
  return false;
}

/// Where the front crosses an edge at a level, by the distances of its ends.
glm::vec2 FrontSweep::crossing(std::uint32_t edge, float level) const {
  const Vertex& a = vertices_[edges_[edge].a];
  const Vertex& b = vertices_[edges_[edge].b];
  const float rise = b.value - a.value;
  const float share = rise != 0.0f ? std::clamp((level - a.value) / rise, 0.0f, 1.0f) : 0.0f;
  return std::isfinite(share) ? glm::mix(a.plan, b.plan, share) : a.plan;
}

float FrontSweep::lengthThrough(std::uint32_t edge, float level) const {
  float length = 0.0f;
  const glm::vec2 start = crossing(edge, level);
  for (const int side : {0, 1}) {
    glm::vec2 at = start;
    const bool closed = follow(edge, side, [&](std::uint32_t next, std::uint32_t) {
      const glm::vec2 there = crossing(next, level);
      length += glm::distance(at, there);
      at = there;
    });
    if (closed) break;
  }
  return length;
}

/// Gives all edges of a piece its number. Returns its length at a level.
float FrontSweep::mark(std::uint32_t edge, std::uint32_t piece, float level) {
  edges_[edge].piece = piece;
  for (const int side : {0, 1}) {
    if (follow(edge, side,
               [&](std::uint32_t next, std::uint32_t) { edges_[next].piece = piece; })) {
      break;
    }
  }
  return lengthThrough(edge, level);
}

/// Pieces of the front split, meet, begin or end at a vertex.
void FrontSweep::happen(std::uint32_t vertex) {
  const float level = vertices_[vertex].value;
  lowerArcs_.clear();
  lowerEdges_.clear();
  for (std::uint32_t i = recordStart_[vertex]; i < recordStart_[vertex + 1]; ++i) {
    const CornerRecord& record = records_[recordOf_[i]];
    for (const std::uint32_t edge : {record.in, record.out}) {
      if (!isLower(edge, vertex)) continue;
      const std::uint32_t arc = arcOf_[edges_[edge].piece];
      if (std::find(lowerArcs_.begin(), lowerArcs_.end(), arc) != lowerArcs_.end()) continue;
      lowerArcs_.push_back(arc);
      lowerEdges_.push_back(edge);
      arcs_[arc].widthAtEnd = lengthThrough(edge, level);
    }
  }
  updateCells(vertex);
  const std::uint32_t firstPiece = static_cast<std::uint32_t>(arcOf_.size());
  const std::size_t firstArc = arcs_.size();
  for (std::uint32_t i = recordStart_[vertex]; i < recordStart_[vertex + 1]; ++i) {
    const CornerRecord& record = records_[recordOf_[i]];
    for (const std::uint32_t edge : {record.in, record.out}) {
      if (isLower(edge, vertex)) continue;
      if (edges_[edge].piece != kNone && edges_[edge].piece >= firstPiece) continue;
      const std::uint32_t piece = static_cast<std::uint32_t>(arcOf_.size());
      arcOf_.push_back(static_cast<std::uint32_t>(arcs_.size()));
      const float width = mark(edge, piece, level);
      arcs_.push_back({static_cast<std::uint32_t>(events_.size()), kNone, 0, width, width, kNone});
    }
  }
  if (lowerArcs_.size() == 1 && arcs_.size() == firstArc + 1) {
    // The same piece in another shape, a loop that opened at a wall.
    arcs_.pop_back();
    arcOf_.back() = lowerArcs_.front();
    return;
  }
  for (std::size_t i = 0; i < lowerArcs_.size(); ++i) {
    FrontArc& arc = arcs_[lowerArcs_[i]];
    arc.to = static_cast<std::uint32_t>(events_.size());
    arc.corner = cornerToward(vertex, lowerEdges_[i]);
  }
  events_.push_back({vertices_[vertex].plan, vertices_[vertex].polygon, level});
}

/// The last corner on the shortest path to a vertex that comes the way of one of its lower edges.
std::uint32_t FrontSweep::cornerToward(std::uint32_t vertex, std::uint32_t edge) const {
  const Edge& e = edges_[edge];
  const glm::vec2 plan = vertices_[vertex].plan;
  const glm::vec2 below = vertices_[e.a == vertex ? e.b : e.a].plan;
  const glm::vec2 toward = glm::normalize(below - plan);
  std::uint32_t best = field_->cornerBefore(vertices_[vertex].polygon, plan);
  float bestAlong = -2.0f;
  for (std::uint32_t i = recordStart_[vertex]; i < recordStart_[vertex + 1]; ++i) {
    const PolygonId polygon = cells_[records_[recordOf_[i]].cell].polygon;
    for (std::uint32_t w = field_->firstWindow(polygon); w != kNone;
         w = field_->windows()[w].next) {
      const std::uint32_t corner = field_->windows()[w].corner;
      const Corner& root = field_->corners()[corner];
      const float step = glm::distance(root.plan, plan);
      if (std::abs(root.distance + step - vertices_[vertex].value) > 2e-3f || step == 0.0f)
        continue;
      const float along = glm::dot(toward, (root.plan - plan) / step);
      if (along > bestAlong) {
        bestAlong = along;
        best = corner;
      }
    }
  }
  return best;
}

/// Where the front crosses an edge at a level, by exact distances.
glm::vec2 FrontSweep::exactCrossing(std::uint32_t edge, float level) const {
  const Edge& e = edges_[edge];
  const glm::vec2 a = vertices_[e.a].plan;
  const glm::vec2 b = vertices_[e.b].plan;
  const float length = glm::distance(a, b);
  if (length == 0.0f) return a;
  const glm::vec2 along = (b - a) / length;
  float at = glm::dot(crossing(edge, level) - a, along);
  float missing = 0.0f;
  for (int i = 0; i < 4; ++i) {
    const glm::vec2 point = a + at * along;
    const std::uint32_t corner = field_->cornerBefore(e.polygon, point);
    if (corner == kNone) return point;
    const Corner& root = field_->corners()[corner];
    const float step = glm::distance(root.plan, point);
    const float slope = step > 0.0f ? glm::dot(point - root.plan, along) / step : 0.0f;
    missing = level - root.distance - step;
    if (std::abs(missing) < 1e-5f) return point;
    if (std::abs(slope) < 0.05f) break;
    at = std::clamp(at + missing / slope, 0.0f, length);
  }
  // Where roots change along the edge, by halves: distances rise or fall all along it.
  const bool rises = vertices_[e.a].value < vertices_[e.b].value;
  float low = 0.0f;
  float high = length;
  for (int i = 0; i < 22; ++i) {
    at = 0.5f * (low + high);
    const bool beyond = field_->distanceAt(e.polygon, a + at * along) > level;
    (beyond == rises ? high : low) = at;
  }
  return a + at * along;
}

/// The piece that crosses `edge` reaches the horizon.
void FrontSweep::addFront(std::uint32_t edge) {
  // From one wall to the other: go to one end first.
  std::uint32_t first = edge;
  int side = 0;
  const bool closed = follow(edge, 0, [&](std::uint32_t next, std::uint32_t cell) {
    first = next;
    side = edges_[next].cells[0] == cell ? 0 : 1;
  });
  if (closed) {
    first = edge;
    side = 0;
  }
  polyline_.clear();
  polylinePolygons_.clear();
  polyline_.push_back(exactCrossing(first, horizon_));
  const std::uint32_t piece = edges_[edge].piece;
  edges_[first].piece = kNone;
  follow(first, side, [&](std::uint32_t next, std::uint32_t cell) {
    polyline_.push_back(exactCrossing(next, horizon_));
    polylinePolygons_.push_back(cells_[cell].polygon);
    edges_[next].piece = kNone;
  });
  float length = 0.0f;
  for (std::size_t i = 1; i < polyline_.size(); ++i) {
    length += glm::distance(polyline_[i - 1], polyline_[i]);
  }
  HorizonFront front{polyline_.front(), polyline_.back(), polyline_.front(), edges_[first].polygon,
                     length};
  float before = 0.0f;
  std::size_t middle = 0;
  for (std::size_t i = 1; i < polyline_.size(); ++i) {
    const float chord = glm::distance(polyline_[i - 1], polyline_[i]);
    if (before + chord < 0.5f * length) {
      before += chord;
      continue;
    }
    const float share = chord > 0.0f ? (0.5f * length - before) / chord : 0.0f;
    front.crossing = glm::mix(polyline_[i - 1], polyline_[i], share);
    front.polygon = polylinePolygons_[i - 1];
    middle = share < 0.5f ? i - 1 : i;
    break;
  }
  // From the chord out to the front itself, if that is in the same polygon: by the root that is
  // nearest there in the end.
  FrontArc& arc = arcs_[arcOf_[piece]];
  glm::vec2 place = front.crossing;
  bool found = false;
  for (int i = 0; i < 5 && !found; ++i) {
    arc.corner = field_->cornerBefore(front.polygon, place);
    if (arc.corner == kNone) break;
    const Corner& root = field_->corners()[arc.corner];
    const glm::vec2 ray = place - root.plan;
    const float step = glm::length(ray);
    found = std::abs(root.distance + step - horizon_) < 1e-4f;
    if (step > 0.0f) place = root.plan + (horizon_ - root.distance) / step * ray;
    if (!navmesh::contains(*graph_, front.polygon, place, 1e-3f)) break;
  }
  if (found) {
    front.crossing = place;
  } else {
    // Where it crosses an edge, near its middle, is as good.
    front.crossing = polyline_[middle];
    arc.corner = field_->cornerBefore(front.polygon, front.crossing);
    if (arc.corner == kNone) arc.corner = 0;
  }
  arc.widthAtEnd = length;
  arc.front = static_cast<std::uint32_t>(fronts_.size());
  fronts_.push_back(front);
}

void FrontSweep::endAtHorizon() {
  for (std::uint32_t edge = 0; edge < edges_.size(); ++edge) {
    const bool crossed = (rank_[edges_[edge].a] == kNone) != (rank_[edges_[edge].b] == kNone);
    if (crossed && edges_[edge].piece != kNone) addFront(edge);
  }
}

void FrontSweep::run(const DistanceField& field, const navmesh::Location& source, float horizon) {
  reset();
  field_ = &field;
  horizon_ = horizon;
  addVertex(source.plan, 0.0f, source.polygon);
  for (const PolygonId polygon : field.polygons()) {
    for (const CellMesh::Corner& corner : mesh_->cornersOf(polygon)) cutEdge(corner.edge);
  }
  for (const PolygonId polygon : field.polygons()) {
    cycle_.clear();
    for (const CellMesh::Corner& corner : mesh_->cornersOf(polygon)) {
      const std::uint32_t first = firstEdgeOf_[corner.edge];
      const std::uint32_t count = edgeCountOf_[corner.edge];
      for (std::uint32_t i = 0; i < count; ++i) {
        const std::uint32_t edge = corner.forward ? first + i : first + count - 1 - i;
        cycle_.push_back({corner.forward ? edges_[edge].a : edges_[edge].b, edge});
      }
    }
    if (polygon == source.polygon) {
      addSourceCells(polygon);
    } else {
      addCells(polygon);
    }
  }
  sortVertices();
  for (const std::uint64_t entry : order_) pass(index(navmesh::KeyQueue::polygonOf(entry)));
  endAtHorizon();
}

}  // namespace forewalk::prediction
