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

FrontSweep::FrontSweep(const NavGraph& graph, const PortalEnds& ends, const CellMesh& cells,
                       std::uint32_t windows)
    : graph_(&graph), ends_(&ends), mesh_(&cells) {
  vertexOf_.assign(cells.plan.size(), kNone);
  firstEdgeOf_.assign(cells.edges.size(), kNone);
  edgeCountOf_.assign(cells.edges.size(), 0);
  viewStart_.assign(graph.polygonCount(), 0);
  viewCount_.assign(graph.polygonCount(), 0);

  // Room for what is usual: every edge of what can be reached cut once, three windows a polygon.
  const std::size_t polygons = std::min<std::size_t>(graph.polygonCount(), windows);
  const std::size_t corners =
      64 + (graph.polygonCount() > 0 ? cells.corners.size() * polygons / graph.polygonCount() : 0);
  touchedVertices_.reserve(corners);
  touchedEdges_.reserve(corners);
  views_.reserve(std::min<std::size_t>(windows, 64 + 3 * polygons));
  vertices_.reserve(2 * corners);
  keys_.reserve(2 * corners);
  edges_.reserve(2 * corners);
  ended_.reserve(2 * corners);
  records_.reserve(3 * corners);
  cells_.reserve(corners);
  order_.reserve(corners);
  arcOf_.reserve(corners);
  events_.reserve(corners);
  arcs_.reserve(corners);
  fronts_.reserve(corners);
  for (auto* few : {&cycle_, &basin_, &outline_, &inner_}) few->reserve(256);
  for (auto* few : {&lows_, &highs_, &others_}) few->reserve(64);
  for (auto* few : {&recordsHere_, &lowerArcs_, &lowerEdges_}) few->reserve(64);
  sights_.reserve(256);
  feet_.reserve(64);
  polyline_.reserve(256);
  polylinePolygons_.reserve(256);
}

void FrontSweep::reset() {
  for (const std::uint32_t vertex : touchedVertices_) vertexOf_[vertex] = kNone;
  for (const std::uint32_t edge : touchedEdges_) firstEdgeOf_[edge] = kNone;
  touchedVertices_.clear();
  touchedEdges_.clear();
  views_.clear();
  vertices_.clear();
  keys_.clear();
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
  const std::uint32_t vertex = static_cast<std::uint32_t>(vertices_.size());
  vertices_.push_back({plan, value, polygon, kNoPolygon, kNone, kNone, 0, false, false});
  keys_.push_back(navmesh::KeyQueue::entryOf(value, PolygonId{vertex}));
  return vertex;
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
  float value = end ? field_->endDistance(meshVertex) : std::numeric_limits<float>::infinity();
  if (!(value <= horizon_)) value = std::min(value, field_->distanceAt(polygon, plan));
  vertex = addVertex(plan, value, polygon);
  vertices_[vertex].forced = end && ends_->kind[meshVertex] == PortalEnds::Kind::kPinch;
  touchedVertices_.push_back(meshVertex);
  return vertex;
}

/// Lays the windows of a polygon side by side.
void FrontSweep::gatherViews(PolygonId polygon) {
  const std::uint32_t begin = static_cast<std::uint32_t>(views_.size());
  const std::span<const Window> windows = field_->windows();
  for (std::uint32_t w = field_->firstWindow(polygon); w != kNone; w = windows[w].next) {
    const Window& window = windows[w];
    const Corner& root = field_->corners()[window.corner];
    const std::uint32_t edge = window.portal == kNone ? kNone : mesh_->edgeOfPortal[window.portal];
    views_.push_back(
        {dvec2(root.plan), static_cast<double>(root.distance), &window, edge, polygon});
  }
  viewStart_[index(polygon)] = begin;
  viewCount_[index(polygon)] = static_cast<std::uint32_t>(views_.size()) - begin;
}

std::span<const FrontSweep::View> FrontSweep::viewsOf(PolygonId polygon) const {
  if (polygon == kNoPolygon || field_->firstWindow(polygon) == kNone) return {};
  return {views_.data() + viewStart_[index(polygon)], viewCount_[index(polygon)]};
}

bool FrontSweep::sees(const View& view, dvec2 point) {
  if (view.window->portal == kNone) return true;
  const dvec2 ray = point - view.root;
  const double slack = 1e-6;
  const auto inside = [&](double side, dvec2 bound) {
    return side >= 0.0 || side * side <= slack * slack * glm::dot(bound, bound);
  };
  return inside(cross(ray, view.window->left), view.window->left) &&
         inside(cross(view.window->right, ray), view.window->right);
}

/// Finds who sees an edge, not through it, and may be nearest to some of it. False if distances
/// rise or fall all along it, whoever is nearest where: then nothing more need be known.
bool FrontSweep::findSights(std::uint32_t meshEdge, float valueFrom, float valueTo) {
  const CellMesh::Edge& edge = mesh_->edges[meshEdge];
  const CellMesh::Line& line = mesh_->lines[meshEdge];
  // By one of its ends, no place of the edge is farther than this.
  const double farthest =
      0.5 * (static_cast<double>(valueFrom) + static_cast<double>(valueTo) + line.length) + kApart;
  sights_.clear();
  firstFoot_ = line.length;
  lastFoot_ = 0.0;
  for (const PolygonId polygon : {edge.left, edge.right}) {
    for (const View& view : viewsOf(polygon)) {
      if (view.edge == meshEdge) continue;
      const dvec2 ray = view.root - line.from;
      const double foot = glm::dot(ray, line.along);
      const double aside = cross(ray, line.along);
      const double beside = foot - std::clamp(foot, 0.0, line.length);
      const double spare = farthest - view.distance;
      if (spare < 0.0 || aside * aside + beside * beside > spare * spare) continue;
      firstFoot_ = std::min(firstFoot_, foot);
      lastFoot_ = std::max(lastFoot_, foot);
      sights_.push_back({foot, aside * aside, &view});
    }
  }
  return firstFoot_ <= line.length - kApart && lastFoot_ >= kApart;
}

/// The length of the shortest way to a place of the edge whose sights are at hand.
double FrontSweep::lookAt(const CellMesh::Line& line, double place, const Sight*& nearest) const {
  double best = std::numeric_limits<double>::infinity();
  const dvec2 point = line.from + place * line.along;
  for (const Sight& sight : sights_) {
    const double along = place - sight.foot;
    const double length = sight.view->distance + std::sqrt(sight.asideSquared + along * along);
    if (length < best && sees(*sight.view, point)) {
      best = length;
      nearest = &sight;
    }
  }
  return best;
}

/// Where two sights of an edge are equally long: between `left`, where distances by the first rise,
/// and `right`, where those by the second fall; metres along it.
double FrontSweep::equallyFar(const Sight& rising, const Sight& falling, double left,
                              double right) {
  double at = 0.5 * (left + right);
  for (int i = 0; i < 8; ++i) {
    const double a = at - rising.foot;
    const double b = at - falling.foot;
    const double lengthA = std::sqrt(rising.asideSquared + a * a);
    const double lengthB = std::sqrt(falling.asideSquared + b * b);
    const double excess = rising.view->distance + lengthA - falling.view->distance - lengthB;
    const double slope = a / lengthA - b / lengthB;  // Newton: it is positive all the way
    const double next = std::clamp(at - excess / slope, left, right);
    if (std::abs(next - at) < 1e-7) return next;
    at = next;
  }
  return at;
}

/// Where the distance is highest between two places of an edge, metres along it, if it rises at
/// the first and falls at the second; else 0.
double FrontSweep::highestBetween(const CellMesh::Line& line, double low, double high) const {
  const double inward = std::min(kApart, 0.25 * (high - low));
  double left = low + inward;
  double right = high - inward;
  if (!(firstFoot_ < left && lastFoot_ > right)) return 0.0;
  const Sight* rising = nullptr;
  lookAt(line, left, rising);
  if (rising == nullptr || !(rising->foot < left)) return 0.0;
  const Sight* falling = nullptr;
  lookAt(line, right, falling);
  if (falling == nullptr || !(falling->foot > right)) return 0.0;
  // Between the two a third may be nearer: then it takes the place of one of them.
  double at = left;
  for (std::size_t i = 0; i <= sights_.size(); ++i) {
    at = equallyFar(*rising, *falling, left, right);
    const Sight* nearest = nullptr;
    const double length = lookAt(line, at, nearest);
    const double along = at - rising->foot;
    const double there = rising->view->distance + std::sqrt(rising->asideSquared + along * along);
    if (nearest == nullptr || nearest == rising || nearest == falling || length > there - 1e-9) {
      break;
    }
    if (nearest->foot < at) {
      rising = nearest;
      left = at;
    } else {
      falling = nearest;
      right = at;
    }
  }
  const dvec2 point = line.from + at * line.along;
  if (sees(*rising->view, point) && sees(*falling->view, point)) return at;
  // A corner hides one of the two there, and its way around that corner is longer: by halves.
  left = low + inward;
  right = high - inward;
  for (int i = 0; i < 16 && right - left > 1e-4; ++i) {
    const double middle = 0.5 * (left + right);
    const Sight* nearest = nullptr;
    lookAt(line, middle, nearest);
    (nearest != nullptr && nearest->foot < middle ? left : right) = middle;
  }
  return 0.5 * (left + right);
}

/// Finds where the front touches the edge whose sights are at hand.
void FrontSweep::findFeet(const CellMesh::Line& line) {
  feet_.clear();
  for (const Sight& sight : sights_) {
    if (sight.foot < kApart || sight.foot > line.length - kApart) continue;
    const double there = sight.view->distance + std::sqrt(sight.asideSquared);
    if (there > static_cast<double>(horizon_)) continue;
    if (!sees(*sight.view, line.from + sight.foot * line.along)) continue;
    const Sight* nearest = nullptr;
    const double distance = lookAt(line, sight.foot, nearest);
    if (distance < there - 1e-6) continue;
    feet_.push_back({sight.foot, distance, sight.view->polygon});
  }
  if (feet_.size() > 1) {
    std::sort(feet_.begin(), feet_.end(),
              [](const Foot& a, const Foot& b) { return a.along < b.along; });
  }
}

/// Cuts an edge where the distance along it is lowest or highest.
void FrontSweep::cutEdge(std::uint32_t meshEdge) {
  if (firstEdgeOf_[meshEdge] != kNone) return;
  const CellMesh::Edge& edge = mesh_->edges[meshEdge];
  std::uint32_t at = vertexAt(edge.from, edge.left);
  const std::uint32_t end = vertexAt(edge.to, edge.left);
  const std::uint32_t firstEdge = static_cast<std::uint32_t>(edges_.size());
  firstEdgeOf_[meshEdge] = firstEdge;
  touchedEdges_.push_back(meshEdge);
  if (!findSights(meshEdge, vertices_[at].value, vertices_[end].value)) {
    addEdge(at, end, edge.left);
    edgeCountOf_[meshEdge] = 1;
    return;
  }
  const CellMesh::Line& line = mesh_->lines[meshEdge];
  findFeet(line);
  bool oneRoot = true;
  for (const Sight& sight : sights_) {
    oneRoot = oneRoot && sight.view->root == sights_.front().view->root;
  }
  const auto cutAt = [&](double place, double value, PolygonId front) {
    const std::uint32_t vertex =
        addVertex(glm::vec2(line.from + place * line.along), static_cast<float>(value), edge.left);
    vertices_[vertex].from = front;
    addEdge(at, vertex, edge.left);
    at = vertex;
  };
  double before = 0.0;
  const auto cutAtHighest = [&](double upTo) {
    if (oneRoot || !(upTo - before > 4 * kApart)) return;
    const double highest = highestBetween(line, before, upTo);
    if (highest == 0.0) return;
    const Sight* nearest = nullptr;
    cutAt(highest, lookAt(line, highest, nearest), kNoPolygon);
    vertices_[at].meeting = true;
  };
  for (const Foot& foot : feet_) {
    if (foot.along - before < kApart) continue;  // two roots in one place
    cutAtHighest(foot.along);
    cutAt(foot.along, foot.distance, foot.front);
    before = foot.along;
  }
  cutAtHighest(line.length);
  addEdge(at, end, edge.left);
  edgeCountOf_[meshEdge] = static_cast<std::uint32_t>(edges_.size()) - firstEdge;
}

/// A cell with the given outline, counter-clockwise: each vertex and the edge from there on.
void FrontSweep::cellOf(std::span<const CycleCorner> outline, PolygonId polygon) {
  const std::uint32_t cell = static_cast<std::uint32_t>(cells_.size());
  const std::uint32_t begin = static_cast<std::uint32_t>(records_.size());
  const std::uint32_t end = begin + static_cast<std::uint32_t>(outline.size());
  cells_.push_back({polygon, begin, end});
  records_.resize(end);
  Key key = keys_[outline.front().vertex];
  bool rose = keys_[outline.back().vertex] < key;
  std::uint32_t in = outline.back().edge;
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const CycleCorner& corner = outline[i];
    const std::uint32_t record = begin + static_cast<std::uint32_t>(i);
    Vertex& vertex = vertices_[corner.vertex];
    records_[record] = {corner.vertex, cell, corner.edge, vertex.records};
    vertex.records = record;
    std::uint32_t* sides = edges_[corner.edge].records;
    sides[sides[0] == kNone ? 0 : 1] = record;
    const Key next = keys_[outline[i + 1 < outline.size() ? i + 1 : 0].vertex];
    const bool rises = key < next;
    vertex.passes = static_cast<std::uint8_t>(vertex.passes + (rises == rose ? 1 : 0));
    vertex.lowerEdge = rose ? in : rises ? vertex.lowerEdge : corner.edge;
    rose = rises;
    key = next;
    in = corner.edge;
  }
}

/// Cells of a polygon, or of a part of it, that one front comes into at corner `low`.
void FrontSweep::addBasin(std::span<const CycleCorner> outline, std::size_t low,
                          PolygonId polygon) {
  const std::size_t count = outline.size();
  const auto at = [&](std::size_t i) { return outline[i < count ? i : i - count]; };
  // The other lows are where the front touches edges that it goes out over.
  others_.clear();
  Key key = keys_[at(low + 1).vertex];
  bool fell = key < keys_[at(low).vertex];
  for (std::size_t i = low + 1; i < low + count; ++i) {
    const Key next = keys_[at(i + 1 < low + count ? i + 1 : low).vertex];
    if (fell && key < next) others_.push_back(i);
    fell = next < key;
    key = next;
  }
  if (others_.empty()) {
    cellOf(outline, polygon);
    return;
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
  others_.clear();
  std::size_t lowest = 0;
  Key key = keys_[cycle_.front().vertex];
  bool fell = key < keys_[cycle_.back().vertex];
  for (std::size_t i = 0; i < count; ++i) {
    const Key next = keys_[cycle_[i + 1 < count ? i + 1 : 0].vertex];
    if (fell && key < next) {
      others_.push_back(i);
      if (below(cycle_[i].vertex, cycle_[lowest].vertex)) lowest = i;
    }
    fell = next < key;
    key = next;
  }
  if (others_.size() < 2) {
    cellOf(cycle_, polygon);
    return;
  }
  lows_.clear();
  for (const std::size_t i : others_) {
    const Vertex& vertex = vertices_[cycle_[i].vertex];
    if (vertex.from != polygon && vertex.value <= horizon_) lows_.push_back(i);
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
  const std::span<const View> views = viewsOf(polygon);
  const auto isNearer = [&](dvec2 point, double distance) {
    return std::any_of(views.begin(), views.end(), [&](const View& view) {
      return view.distance + glm::length(point - view.root) < distance && sees(view, point);
    });
  };
  value = horizon_;
  bool found = false;
  for (std::size_t i = 0; i < views.size(); ++i) {
    for (std::size_t j = i + 1; j < views.size(); ++j) {
      const dvec2 between = views[j].root - views[i].root;
      const double gap = glm::length(between);
      const double half = 0.5 * (gap + views[j].distance - views[i].distance);
      if (!(half > 0.0 && half < gap)) continue;
      const dvec2 point = views[i].root + half / gap * between;
      const double there = views[i].distance + half;
      if (there >= static_cast<double>(value) ||
          !navmesh::contains(*graph_, polygon, glm::vec2(point)) || !sees(views[i], point) ||
          !sees(views[j], point) || isNearer(point, there - 1e-6)) {
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

/// Sorts the vertices within the horizon where the front does not just pass.
void FrontSweep::listEvents() {
  for (std::uint32_t v = 0; v < vertices_.size(); ++v) {
    const Vertex& vertex = vertices_[v];
    if (vertex.value > horizon_) continue;
    // In one fan of cells from wall to wall it passes once, all around a vertex twice.
    const bool regular = vertex.passes == 1 || (vertex.passes == 2 && !onBorder(v));
    if (!regular || vertex.forced) order_.push_back(keys_[v]);
  }
  std::sort(order_.begin(), order_.end());
}

bool FrontSweep::onBorder(std::uint32_t vertex) const {
  for (std::uint32_t r = vertices_[vertex].records; r != kNone; r = records_[r].next) {
    if (edges_[records_[r].out].records[1] == kNone || edges_[edgeInto(r)].records[1] == kNone) {
      return true;
    }
  }
  return false;
}

/// Of a vertex in a cell: the edge that comes before it.
std::uint32_t FrontSweep::edgeInto(std::uint32_t record) const {
  const Cell& cell = cells_[records_[record].cell];
  return records_[record == cell.begin ? cell.end - 1 : record - 1].out;
}

/// The records of a vertex in order of cells.
void FrontSweep::listRecords(std::uint32_t vertex) {
  recordsHere_.clear();
  for (std::uint32_t r = vertices_[vertex].records; r != kNone; r = records_[r].next) {
    recordsHere_.push_back(r);
  }
  std::reverse(recordsHere_.begin(), recordsHere_.end());
}

bool FrontSweep::isLower(std::uint32_t edge, std::uint32_t vertex) const {
  const Edge& e = edges_[edge];
  return below(e.a == vertex ? e.b : e.a, vertex);
}

/// The piece of the front that crosses an edge, or did when it left it. Where nothing has happened
/// since the front came onto the edge, it came from a lower edge, in the same piece.
std::uint32_t FrontSweep::pieceOf(std::uint32_t edge) {
  std::uint32_t from = edge;
  while (from != kNone && edges_[from].piece == kNone) {
    const Edge& e = edges_[from];
    from = vertices_[below(e.a, e.b) ? e.a : e.b].lowerEdge;
  }
  const std::uint32_t piece = from != kNone ? edges_[from].piece : 0;
  // Remembered on the way: many ask for the same.
  for (std::uint32_t at = edge; at != from;) {
    Edge& e = edges_[at];
    e.piece = piece;
    at = vertices_[below(e.a, e.b) ? e.a : e.b].lowerEdge;
  }
  return piece;
}

/// The front comes into a cell over the edge from `record` on: the record of the edge that it
/// leaves by. All that lies between the two is on one side of the front.
std::uint32_t FrontSweep::across(std::uint32_t record, Key level) const {
  const Cell& cell = cells_[records_[record].cell];
  const auto after = [&](std::uint32_t r) { return r + 1 == cell.end ? cell.begin : r + 1; };
  const auto before = [&](std::uint32_t r) { return r == cell.begin ? cell.end - 1 : r - 1; };
  const auto isBelow = [&](std::uint32_t r) { return keys_[records_[r].vertex] <= level; };
  std::uint32_t at = record;
  if (isBelow(record)) {
    do at = after(at);
    while (at != record && !isBelow(after(at)));
  } else {
    do at = before(at);
    while (at != record && !isBelow(at));
  }
  return at;
}

/// Calls visit(edge, cell) for each edge that the front at a level crosses after `edge`, going out
/// of it into its cell on one side, and the cell before it. True if it comes back to `edge`.
template <typename Visit>
bool FrontSweep::follow(std::uint32_t edge, int side, Key level, const Visit& visit) const {
  std::uint32_t record = edges_[edge].records[side];
  while (record != kNone) {
    const std::uint32_t beyond = across(record, level);
    if (beyond == record) return false;
    const std::uint32_t next = records_[beyond].out;
    visit(next, records_[beyond].cell);
    if (next == edge) return true;
    const Edge& e = edges_[next];
    record = e.records[e.records[0] == beyond ? 1 : 0];
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

/// The length of the piece of the front that crosses `edge`, metres. Calls visit(edge) for each of
/// its edges.
template <typename Visit>
float FrontSweep::measure(std::uint32_t edge, Key level, float distance, const Visit& visit) const {
  float length = 0.0f;
  const glm::vec2 start = crossing(edge, distance);
  visit(edge);
  for (const int side : {0, 1}) {
    glm::vec2 at = start;
    const bool closed = follow(edge, side, level, [&](std::uint32_t next, std::uint32_t) {
      visit(next);
      const glm::vec2 there = crossing(next, distance);
      length += glm::distance(at, there);
      at = there;
    });
    if (closed) break;
  }
  return length;
}

/// Pieces of the front split, meet, begin or end at a vertex.
void FrontSweep::happen(std::uint32_t vertex) {
  const float distance = vertices_[vertex].value;
  const Key level = keys_[vertex];
  listRecords(vertex);
  lowerArcs_.clear();
  lowerEdges_.clear();
  for (const std::uint32_t record : recordsHere_) {
    for (const std::uint32_t edge : {edgeInto(record), records_[record].out}) {
      if (!isLower(edge, vertex)) continue;
      const std::uint32_t arc = arcOf_[pieceOf(edge)];
      if (std::find(lowerArcs_.begin(), lowerArcs_.end(), arc) != lowerArcs_.end()) continue;
      lowerArcs_.push_back(arc);
      lowerEdges_.push_back(edge);
      arcs_[arc].widthAtEnd = measure(edge, level - 1, distance, [](std::uint32_t) {});
    }
  }
  const std::uint32_t firstPiece = static_cast<std::uint32_t>(arcOf_.size());
  const std::size_t firstArc = arcs_.size();
  for (const std::uint32_t record : recordsHere_) {
    for (const std::uint32_t edge : {edgeInto(record), records_[record].out}) {
      if (isLower(edge, vertex)) continue;
      if (edges_[edge].piece != kNone && edges_[edge].piece >= firstPiece) continue;
      const std::uint32_t piece = static_cast<std::uint32_t>(arcOf_.size());
      arcOf_.push_back(static_cast<std::uint32_t>(arcs_.size()));
      const float width =
          measure(edge, level, distance, [&](std::uint32_t e) { edges_[e].piece = piece; });
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
  events_.push_back({vertices_[vertex].plan, vertices_[vertex].polygon, distance});
}

/// The last corner on the shortest path to a vertex that comes the way of one of its lower edges.
std::uint32_t FrontSweep::cornerToward(std::uint32_t vertex, std::uint32_t edge) const {
  const Edge& e = edges_[edge];
  const glm::vec2 plan = vertices_[vertex].plan;
  const glm::vec2 below = vertices_[e.a == vertex ? e.b : e.a].plan;
  const glm::vec2 toward = glm::normalize(below - plan);
  std::uint32_t best = kNone;
  float bestAlong = -2.0f;
  for (const std::uint32_t record : recordsHere_) {
    const PolygonId polygon = cells_[records_[record].cell].polygon;
    for (std::uint32_t w = field_->firstWindow(polygon); w != kNone;
         w = field_->windows()[w].next) {
      const std::uint32_t corner = field_->windows()[w].corner;
      const Corner& root = field_->corners()[corner];
      if (corner == best) continue;
      const float rest = vertices_[vertex].value - root.distance;
      const glm::vec2 ray = root.plan - plan;
      const float squared = glm::dot(ray, ray);
      if (std::abs(squared - rest * rest) > 1e-3f + 8e-3f * std::abs(rest)) continue;
      const float step = std::sqrt(squared);
      if (std::abs(step - rest) > 2e-3f || step == 0.0f) continue;
      const float along = glm::dot(toward, ray / step);
      if (along > bestAlong) {
        bestAlong = along;
        best = corner;
      }
    }
  }
  return best != kNone ? best : field_->cornerBefore(vertices_[vertex].polygon, plan);
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
void FrontSweep::addFront(std::uint32_t edge, Key level) {
  // From one wall to the other: go to one end first.
  std::uint32_t first = edge;
  int side = 0;
  const bool closed = follow(edge, 0, level, [&](std::uint32_t next, std::uint32_t cell) {
    first = next;
    side = records_[edges_[next].records[0]].cell == cell ? 0 : 1;
  });
  if (closed) {
    first = edge;
    side = 0;
  }
  polyline_.clear();
  polylinePolygons_.clear();
  polyline_.push_back(exactCrossing(first, horizon_));
  const std::uint32_t piece = pieceOf(edge);
  ended_[first] = true;
  follow(first, side, level, [&](std::uint32_t next, std::uint32_t cell) {
    polyline_.push_back(exactCrossing(next, horizon_));
    polylinePolygons_.push_back(cells_[cell].polygon);
    ended_[next] = true;
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
  const Key level = navmesh::KeyQueue::entryOf(horizon_, kNoPolygon);
  ended_.assign(edges_.size(), false);
  for (std::uint32_t edge = 0; edge < edges_.size(); ++edge) {
    const bool crossed = (keys_[edges_[edge].a] <= level) != (keys_[edges_[edge].b] <= level);
    if (crossed && !ended_[edge]) addFront(edge, level);
  }
}

void FrontSweep::run(const DistanceField& field, const navmesh::Location& source, float horizon) {
  reset();
  field_ = &field;
  horizon_ = horizon;
  addVertex(source.plan, 0.0f, source.polygon);
  for (const PolygonId polygon : field.polygons()) gatherViews(polygon);
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
  listEvents();
  for (const Key key : order_) happen(index(navmesh::KeyQueue::polygonOf(key)));
  endAtHorizon();
}

}  // namespace forewalk::prediction
