#include "tests/support/visibility.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

namespace forewalk::testing {
namespace {

using navmesh::NavGraph;
using navmesh::PolygonId;
using navmesh::Portal;

constexpr double kEpsilon = 1e-5;  // metres; a hundred times the rounding of coordinates
constexpr double kInfinity = std::numeric_limits<double>::infinity();

double cross(glm::dvec2 a, glm::dvec2 b) { return a.x * b.y - a.y * b.x; }

double distanceToSegment(glm::dvec2 p, glm::dvec2 a, glm::dvec2 b) {
  const glm::dvec2 ab = b - a;
  const double length = glm::dot(ab, ab);
  const double t = length > 0.0 ? std::clamp(glm::dot(p - a, ab) / length, 0.0, 1.0) : 0.0;
  return glm::distance(p, a + t * ab);
}

// Where on the walk from a to b (0 to 1) the portal from c to d is touched, within epsilon.
struct Touch {
  double first = kInfinity;
  double last = -kInfinity;

  bool any() const { return first <= last; }
  void add(double t) {
    first = std::min(first, t);
    last = std::max(last, t);
  }
};

Touch touch(glm::dvec2 a, glm::dvec2 b, glm::dvec2 c, glm::dvec2 d) {
  Touch touched;
  const glm::dvec2 walk = b - a;
  const glm::dvec2 portal = d - c;
  const double lengthSquared = glm::dot(walk, walk);
  const auto placeOf = [&](glm::dvec2 p) {
    return lengthSquared > 0.0 ? std::clamp(glm::dot(p - a, walk) / lengthSquared, 0.0, 1.0) : 0.0;
  };
  if (distanceToSegment(a, c, d) <= kEpsilon) touched.add(0.0);
  if (distanceToSegment(b, c, d) <= kEpsilon) touched.add(1.0);
  if (distanceToSegment(c, a, b) <= kEpsilon) touched.add(placeOf(c));
  if (distanceToSegment(d, a, b) <= kEpsilon) touched.add(placeOf(d));
  const double parallel = cross(walk, portal);
  if (parallel != 0.0) {
    const double t = cross(c - a, portal) / parallel;
    const double s = cross(c - a, walk) / parallel;
    if (t >= 0.0 && t <= 1.0 && s >= 0.0 && s <= 1.0) touched.add(t);
  }
  return touched;
}

bool touches(glm::dvec2 a, glm::dvec2 b, const Portal& portal) {
  return touch(a, b, glm::dvec2(portal.left), glm::dvec2(portal.right)).any();
}

// The stretches of a polygon's edges that no portal opens, as places at both their ends.
void addWallEnds(const NavGraph& graph, std::uint32_t polygon, std::vector<PlanPlace>& ends) {
  const std::span<const glm::vec2> ring = graph.ringOf(PolygonId{polygon});
  std::uint32_t h = graph.portalStart[polygon];
  for (std::uint32_t edge = 0; edge < ring.size(); ++edge) {
    glm::vec2 open = ring[edge];  // where the wall so far begins
    const glm::vec2 end = ring[(edge + 1) % ring.size()];
    const auto addWall = [&](glm::vec2 to) {
      if (glm::distance(glm::dvec2(open), glm::dvec2(to)) <= kEpsilon) return;
      ends.push_back({PolygonId{polygon}, open});
      ends.push_back({PolygonId{polygon}, to});
    };
    // Portals of an edge are sorted along it; walking out, the right end comes first.
    for (; h < graph.portalStart[polygon + 1] && graph.portalEdge[h] == edge; ++h) {
      addWall(graph.portals[h].right);
      open = graph.portals[h].left;
    }
    addWall(end);
  }
}

}  // namespace

VisibilityGraph::VisibilityGraph(const NavGraph& graph)
    : graph_(graph), stamp_(graph.polygonCount(), 0) {
  std::vector<PlanPlace> ends;
  for (std::uint32_t p = 0; p < graph.polygonCount(); ++p) addWallEnds(graph, p, ends);
  // A corner where two walls meet is one place, unless the two are only touching from outside.
  std::sort(ends.begin(), ends.end(), [](const PlanPlace& a, const PlanPlace& b) {
    return std::tie(a.plan.x, a.plan.y, a.polygon) < std::tie(b.plan.x, b.plan.y, b.polygon);
  });
  std::size_t firstHere = 0;
  for (const PlanPlace& end : ends) {
    while (firstHere < corners_.size() && corners_[firstHere].plan != end.plan) ++firstHere;
    const bool known =
        std::any_of(corners_.begin() + static_cast<std::ptrdiff_t>(firstHere), corners_.end(),
                    [&](const PlanPlace& c) { return visible(c, end); });
    if (!known) corners_.push_back(end);
  }
}

bool VisibilityGraph::visible(const PlanPlace& from, const PlanPlace& to) const {
  const glm::dvec2 a(from.plan);
  const glm::dvec2 b(to.plan);
  ++flood_;
  std::vector<std::uint32_t> open{index(from.polygon)};
  stamp_[open[0]] = flood_;
  while (!open.empty()) {
    const std::uint32_t p = open.back();
    open.pop_back();
    if (PolygonId{p} == to.polygon) return true;
    for (std::uint32_t h = graph_.portalStart[p]; h < graph_.portalStart[p + 1]; ++h) {
      const std::uint32_t next = index(graph_.portalTo[h]);
      if (stamp_[next] == flood_ || !touches(a, b, graph_.portals[h])) continue;
      stamp_[next] = flood_;
      open.push_back(next);
    }
  }
  return false;
}

void VisibilityGraph::connect() const {
  if (!seen_.empty()) return;
  seen_.resize(corners_.size());
  for (std::uint32_t i = 0; i < corners_.size(); ++i) {
    for (std::uint32_t j = i + 1; j < corners_.size(); ++j) {
      if (!visible(corners_[i], corners_[j])) continue;
      seen_[i].push_back(j);
      seen_[j].push_back(i);
    }
  }
}

float VisibilityGraph::shortest(const PlanPlace& from, const PlanPlace& to) const {
  return shortest(from, std::span(&to, 1))[0];
}

std::vector<float> VisibilityGraph::shortest(const PlanPlace& from,
                                             std::span<const PlanPlace> to) const {
  connect();
  const auto apart = [](const PlanPlace& a, const PlanPlace& b) {
    return glm::distance(glm::dvec2(a.plan), glm::dvec2(b.plan));
  };
  // Dijkstra without a heap: the graph is dense.
  std::vector<double> length(corners_.size(), kInfinity);
  std::vector<bool> settled(corners_.size(), false);
  for (std::size_t c = 0; c < corners_.size(); ++c) {
    if (visible(from, corners_[c])) length[c] = apart(from, corners_[c]);
  }
  for (;;) {
    std::size_t best = corners_.size();
    for (std::size_t c = 0; c < corners_.size(); ++c) {
      if (!settled[c] && length[c] < kInfinity &&
          (best == corners_.size() || length[c] < length[best]))
        best = c;
    }
    if (best == corners_.size()) break;
    settled[best] = true;
    for (const std::uint32_t next : seen_[best]) {
      length[next] = std::min(length[next], length[best] + apart(corners_[best], corners_[next]));
    }
  }
  std::vector<float> result;
  for (const PlanPlace& goal : to) {
    double shortest = visible(from, goal) ? apart(from, goal) : kInfinity;
    for (std::size_t c = 0; c < corners_.size(); ++c) {
      // Only where it would be shorter is it worth looking.
      const double through = length[c] + apart(corners_[c], goal);
      if (through < shortest && visible(corners_[c], goal)) shortest = through;
    }
    result.push_back(static_cast<float>(shortest));
  }
  return result;
}

float visibilityShortest(const NavGraph& graph, glm::vec2 from, glm::vec2 to) {
  const auto polygonAt = [&](glm::vec2 plan) {
    for (std::uint32_t p = 0; p < graph.polygonCount(); ++p) {
      if (contains(graph, PolygonId{p}, plan)) return PolygonId{p};
    }
    return navmesh::kNoPolygon;
  };
  const PlanPlace a{polygonAt(from), from};
  const PlanPlace b{polygonAt(to), to};
  if (a.polygon == navmesh::kNoPolygon || b.polygon == navmesh::kNoPolygon) {
    return std::numeric_limits<float>::infinity();
  }
  return VisibilityGraph(graph).shortest(a, b);
}

float visibilityShortestInCorridor(std::span<const Portal> portals, glm::vec2 start,
                                   glm::vec2 goal) {
  // Nodes: the start, both ends of each portal, the goal; `rank` says how many portals lie behind.
  struct Node {
    glm::dvec2 plan;
    std::size_t rank;
    double length;
  };
  std::vector<Node> nodes{{glm::dvec2(start), 0, 0.0}};
  for (std::size_t i = 0; i < portals.size(); ++i) {
    nodes.push_back({glm::dvec2(portals[i].left), i + 1, kInfinity});
    nodes.push_back({glm::dvec2(portals[i].right), i + 1, kInfinity});
  }
  nodes.push_back({glm::dvec2(goal), portals.size() + 1, kInfinity});
  const auto inSight = [&](const Node& from, const Node& to) {
    double reached = 0.0;
    for (std::size_t i = from.rank; i + 1 < to.rank; ++i) {
      const Touch touched =
          touch(from.plan, to.plan, glm::dvec2(portals[i].left), glm::dvec2(portals[i].right));
      const double slack = kEpsilon / std::max(glm::distance(from.plan, to.plan), kEpsilon);
      if (!touched.any() || touched.last < reached - slack) return false;
      reached = std::max(reached, touched.first);
    }
    return true;
  };
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    for (std::size_t j = i + 1; j < nodes.size(); ++j) {
      if (nodes[j].rank <= nodes[i].rank) continue;
      const double length = nodes[i].length + glm::distance(nodes[i].plan, nodes[j].plan);
      if (length < nodes[j].length && inSight(nodes[i], nodes[j])) nodes[j].length = length;
    }
  }
  return static_cast<float>(nodes.back().length);
}

float visibilityShortestInCorridor(const NavGraph& graph, std::span<const std::uint32_t> corridor,
                                   glm::vec2 start, glm::vec2 goal) {
  std::vector<Portal> portals;
  for (const std::uint32_t h : corridor) portals.push_back(graph.portals[h]);
  return visibilityShortestInCorridor(portals, start, goal);
}

}  // namespace forewalk::testing
