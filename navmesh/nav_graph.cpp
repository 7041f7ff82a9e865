#include "navmesh/nav_graph.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>
#include <utility>

#include "navmesh/graph_rows.h"
#include "navmesh/plan.h"

namespace forewalk::navmesh {
namespace {

// Successor rows grow with the square of a polygon's portals. A building has some nine entries a
// half-portal; this many say that a file is damaged, and would need a gigabyte.
constexpr std::uint64_t kSuccessorLimit = 1u << 28;

tl::unexpected<Error> damaged(std::string message) {
  return tl::unexpected(Error{ErrorCode::kDataDamaged, std::move(message)});
}

double crossPrecise(glm::dvec2 a, glm::dvec2 b) { return a.x * b.y - a.y * b.x; }

// One way out of a polygon, before it has its place in the rows.
struct HalfPortal {
  std::uint32_t from, to;
  std::uint32_t edge;
  float along;           // of its midpoint on that edge, metres; sorts the portals of one edge
  std::uint32_t number;  // of its portal; the two halves share it
  Portal ends;
  PortalHeights heights;
};

class PortalFinder {
 public:
  explicit PortalFinder(const PolygonMesh& mesh) : mesh_(mesh) {}

  tl::expected<std::vector<HalfPortal>, Error> find() {
    if (auto done = joinSharedEdges(); !done) return tl::unexpected(done.error());
    for (const BorderPortal& portal : mesh_.borderPortals) {
      add({index(portal.from), portal.fromEdge}, {index(portal.to), portal.toEdge}, portal.left,
          portal.right);
    }
    const auto place = [](const HalfPortal& h) {
      return std::tie(h.from, h.edge, h.along, h.to, h.number);
    };
    std::sort(halves_.begin(), halves_.end(),
              [&](const HalfPortal& a, const HalfPortal& b) { return place(a) < place(b); });
    return std::move(halves_);
  }

 private:
  struct Side {
    std::uint32_t polygon, edge;
  };
  struct SharedEdge {
    std::uint32_t low, high;  // its vertices, ascending
    Side side;
    bool ascending;  // the ring walks it from low to high
  };

  std::uint32_t vertexAt(Side side, std::uint32_t step) const {
    const std::uint32_t begin = mesh_.ringStart[side.polygon];
    const std::uint32_t corners = mesh_.ringStart[side.polygon + 1] - begin;
    return mesh_.ring[begin + (side.edge + step) % corners];
  }

  // Equal edges stand side by side once sorted; no hash map, so the order is the mesh's own.
  tl::expected<void, Error> joinSharedEdges() {
    std::vector<SharedEdge> edges;
    edges.reserve(mesh_.ring.size());
    for (std::uint32_t polygon = 0; polygon < mesh_.polygonCount(); ++polygon) {
      const std::uint32_t corners = mesh_.ringStart[polygon + 1] - mesh_.ringStart[polygon];
      for (std::uint32_t edge = 0; edge < corners; ++edge) {
        const Side side{polygon, edge};
        const auto [low, high] = std::minmax({vertexAt(side, 0), vertexAt(side, 1)});
        edges.push_back({low, high, side, low == vertexAt(side, 0)});
      }
    }
    const auto key = [](const SharedEdge& e) {
      return std::tie(e.low, e.high, e.side.polygon, e.side.edge);
    };
    std::sort(edges.begin(), edges.end(),
              [&](const SharedEdge& a, const SharedEdge& b) { return key(a) < key(b); });
    for (std::size_t i = 0; i + 1 < edges.size(); ++i) {
      const auto same = [&](std::size_t j) {
        return j < edges.size() && edges[j].low == edges[i].low && edges[j].high == edges[i].high;
      };
      if (!same(i + 1)) continue;
      const SharedEdge& a = edges[i];
      const SharedEdge& b = edges[i + 1];
      if (same(i + 2)) {
        return damaged(
            fmt::format("the edge between vertices {} and {} has more than two polygons: "
                        "{}, {} and {}. Build the navmesh again.",
                        a.low, a.high, a.side.polygon, b.side.polygon, edges[i + 2].side.polygon));
      }
      if (a.ascending == b.ascending) {
        return damaged(
            fmt::format("polygons {} and {} lie on the same side of the edge between "
                        "vertices {} and {}. Build the navmesh again.",
                        a.side.polygon, b.side.polygon, a.low, a.high));
      }
      // Counter-clockwise, whoever walks out over an edge has its end on the left.
      add(a.side, b.side, mesh_.vertices[vertexAt(a.side, 1)], mesh_.vertices[vertexAt(a.side, 0)]);
      ++i;
    }
    return {};
  }

  void add(Side from, Side to, glm::vec3 left, glm::vec3 right) {
    addHalf(from, to.polygon, left, right);
    addHalf(to, from.polygon, right, left);
    ++count_;
  }

  void addHalf(Side side, std::uint32_t to, glm::vec3 left, glm::vec3 right) {
    const Portal ends{toPlan(left), toPlan(right)};
    const glm::vec2 begin = toPlan(mesh_.vertices[vertexAt(side, 0)]);
    const glm::vec2 end = toPlan(mesh_.vertices[vertexAt(side, 1)]);
    const float along = alongEdge(begin, end, ends);
    halves_.push_back({side.polygon, to, side.edge, along, count_, ends, {left.y, right.y}});
  }

  const PolygonMesh& mesh_;
  std::vector<HalfPortal> halves_;
  std::uint32_t count_ = 0;
};

void placePortals(const std::vector<HalfPortal>& halves, std::uint32_t polygons, NavGraph& graph) {
  const auto count = static_cast<std::uint32_t>(halves.size());
  graph.portalStart.assign(polygons + 1, 0);
  graph.portalTwin.resize(count);
  std::vector<std::uint32_t> firstOf(count / 2, count);
  for (std::uint32_t h = 0; h < count; ++h) {
    const HalfPortal& half = halves[h];
    ++graph.portalStart[half.from + 1];
    graph.portalTo.push_back(PolygonId{half.to});
    graph.portals.push_back(half.ends);
    graph.portalMidpoint.push_back(midpointOf(half.ends));
    graph.portalEdge.push_back(half.edge);
    graph.portalHeights.push_back(half.heights);
    graph.portalToCentroid.push_back(
        glm::distance(graph.portalMidpoint[h], graph.centroid[half.to]));
    std::uint32_t& first = firstOf[half.number];
    if (first == count) {
      first = h;
    } else {
      graph.portalTwin[h] = first;
      graph.portalTwin[first] = h;
    }
  }
  for (std::uint32_t p = 0; p < polygons; ++p) graph.portalStart[p + 1] += graph.portalStart[p];
}

tl::expected<void, Error> placeSuccessors(NavGraph& graph) {
  std::uint64_t total = 0;
  for (const PolygonId to : graph.portalTo) {
    total += graph.portalStart[index(to) + 1] - graph.portalStart[index(to)];
  }
  if (total > kSuccessorLimit) {
    return tl::unexpected(
        Error{ErrorCode::kTooLarge,
              fmt::format(
                  "the navmesh has {} ways through polygons from portal to portal, at most {} can "
                  "be kept. Build it with fewer portals a polygon.",
                  total, kSuccessorLimit)});
  }
  graph.successorStart.resize(graph.portalCount());
  graph.successorLength.resize(total);
  std::uint32_t at = 0;
  for (std::uint32_t h = 0; h < graph.portalCount(); ++h) {
    const std::uint32_t to = index(graph.portalTo[h]);
    const glm::vec2 from = graph.portalMidpoint[h];
    graph.successorStart[h] = at;
    for (std::uint32_t next = graph.portalStart[to]; next < graph.portalStart[to + 1]; ++next) {
      graph.successorLength[at++] = glm::distance(from, graph.portalMidpoint[next]);
    }
  }
  return {};
}

void countNeighbours(NavGraph& graph) {
  graph.neighbourCount.resize(graph.polygonCount());
  std::vector<PolygonId> row;
  for (std::uint32_t p = 0; p < graph.polygonCount(); ++p) {
    row.assign(graph.portalTo.begin() + graph.portalStart[p],
               graph.portalTo.begin() + graph.portalStart[p + 1]);
    std::sort(row.begin(), row.end());
    const auto end = std::unique(row.begin(), row.end());
    graph.neighbourCount[p] = static_cast<std::uint32_t>(end - row.begin());
  }
}

// Flood fill from ascending ids, so that components are numbered by their smallest polygon.
void labelComponents(NavGraph& graph) {
  constexpr std::uint32_t kUnlabelled = 0xffffffffu;
  graph.component.assign(graph.polygonCount(), kUnlabelled);
  std::vector<std::uint32_t> open;
  for (std::uint32_t seed = 0; seed < graph.polygonCount(); ++seed) {
    if (graph.component[seed] != kUnlabelled) continue;
    graph.component[seed] = graph.componentCount;
    open.push_back(seed);
    while (!open.empty()) {
      const std::uint32_t p = open.back();
      open.pop_back();
      for (std::uint32_t h = graph.portalStart[p]; h < graph.portalStart[p + 1]; ++h) {
        const std::uint32_t to = index(graph.portalTo[h]);
        if (graph.component[to] != kUnlabelled) continue;
        graph.component[to] = graph.componentCount;
        open.push_back(to);
      }
    }
    ++graph.componentCount;
  }
}

// Around its first corner, in double precision: far from the origin the products would cancel.
struct AreaAndCentroid {
  double area;
  glm::vec2 centroid;
};

AreaAndCentroid areaAndCentroid(std::span<const glm::vec2> ring) {
  const glm::dvec2 origin(ring[0]);
  double area = 0.0;
  glm::dvec2 moment(0.0);
  glm::dvec2 mean(0.0);
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const glm::dvec2 a = glm::dvec2(ring[i]) - origin;
    const glm::dvec2 b = glm::dvec2(ring[(i + 1) % ring.size()]) - origin;
    area += 0.5 * crossPrecise(a, b);
    moment += crossPrecise(a, b) / 6.0 * (a + b);
    mean += a / static_cast<double>(ring.size());
  }
  // A sliver thinner than the tolerance has no area to speak of: its corners' mean will do.
  constexpr double kSliver = 1e-9;
  return {std::max(area, 0.0), glm::vec2(origin + (area > kSliver ? moment / area : mean))};
}

bool hasHeights(const NavGraph& graph, PolygonId polygon) {
  const std::uint32_t p = index(polygon);
  return !graph.heightStart.empty() && graph.heightStart[p] < graph.heightStart[p + 1];
}

// What a query is to a triangle: twice the areas that it spans with each edge, named after the
// corner that the edge faces. Seen from the query, the two sides of a shared edge give opposite
// numbers to the last bit, so that no point falls between two triangles.
struct Areas {
  float ofA, ofB, ofC;

  bool inside() const { return ofA >= 0.0f && ofB >= 0.0f && ofC >= 0.0f; }
  float sum() const { return ofA + ofB + ofC; }
  // Not where the triangle is so thin that it says nothing of the height inside it: its edges do.
  bool thin() const { return sum() < 1e-5f; }
  float mean(float a, float b, float c) const {
    if (a == b && b == c) return a;  // floors are flat, mostly
    return (ofA * a + ofB * b + ofC * c) / sum();
  }
};

// The height in one of the polygon's height triangles, or nothing.
bool heightInTriangles(const NavGraph& graph, PolygonId polygon, glm::vec2 plan, float& height) {
  const std::uint32_t end = graph.heightStart[index(polygon) + 1];
  for (std::uint32_t i = graph.heightStart[index(polygon)]; i < end; ++i) {
    const HeightTriangle& t = graph.heightTriangles[i];
    const glm::vec2 toA = toPlan(t.a) - plan;
    const glm::vec2 toB = toPlan(t.b) - plan;
    const glm::vec2 toC = toPlan(t.c) - plan;
    Areas areas{cross(toB, toC), cross(toC, toA), cross(toA, toB)};
    if (areas.sum() < 0.0f) areas = {-areas.ofA, -areas.ofB, -areas.ofC};  // listed clockwise
    if (!areas.inside() || areas.thin()) continue;
    height = areas.mean(t.a.y, t.b.y, t.c.y);
    return true;
  }
  return false;
}

// The height in the ring, fanned out from its first corner, or nothing.
bool heightInRing(const NavGraph& graph, PolygonId polygon, glm::vec2 plan, float& height) {
  const std::uint32_t first = graph.ringStart[index(polygon)];
  const std::uint32_t end = graph.ringStart[index(polygon) + 1];
  const glm::vec2 toFirst = graph.ring[first] - plan;
  glm::vec2 toB = graph.ring[first + 1] - plan;
  float ofC = cross(toFirst, toB);
  for (std::uint32_t c = first + 2; c < end; ++c) {
    const glm::vec2 toC = graph.ring[c] - plan;
    const float ofB = -cross(toFirst, toC);
    const Areas areas{cross(toB, toC), ofB, ofC};
    if (areas.inside() && !areas.thin()) {
      height = areas.mean(graph.ringHeight[first], graph.ringHeight[c - 1], graph.ringHeight[c]);
      return true;
    }
    toB = toC;
    ofC = -ofB;
  }
  return false;
}

// The height of the nearest point of the polygon's outline, or of any edge of its height triangles.
float heightBeside(const NavGraph& graph, PolygonId polygon, glm::vec2 plan) {
  float nearest = std::numeric_limits<float>::infinity();
  float height = 0.0f;
  const auto takeEdge = [&](glm::vec3 from, glm::vec3 to) {
    const glm::vec2 a = toPlan(from) - plan;
    const glm::vec2 edge = toPlan(to) - toPlan(from);
    const float length = glm::dot(edge, edge);
    const float share = length > 0.0f ? std::clamp(-glm::dot(a, edge) / length, 0.0f, 1.0f) : 0.0f;
    const glm::vec2 point = a + share * edge;
    const float squared = glm::dot(point, point);
    if (squared < nearest) {
      nearest = squared;
      height = from.y + share * (to.y - from.y);
    }
  };
  if (hasHeights(graph, polygon)) {
    const std::uint32_t end = graph.heightStart[index(polygon) + 1];
    for (std::uint32_t i = graph.heightStart[index(polygon)]; i < end; ++i) {
      const HeightTriangle& t = graph.heightTriangles[i];
      takeEdge(t.a, t.b);
      takeEdge(t.b, t.c);
      takeEdge(t.c, t.a);
    }
  } else {
    const std::uint32_t end = graph.ringStart[index(polygon) + 1];
    for (std::uint32_t i = graph.ringStart[index(polygon)], last = end - 1; i < end; last = i++) {
      takeEdge(toSpace(graph.ring[last], graph.ringHeight[last]),
               toSpace(graph.ring[i], graph.ringHeight[i]));
    }
  }
  return height;
}

}  // namespace

tl::expected<NavGraph, Error> makeNavGraph(const PolygonMesh& mesh) {
  if (auto valid = validate(mesh); !valid) return tl::unexpected(valid.error());
  const std::uint32_t polygons = mesh.polygonCount();

  NavGraph graph;
  graph.ringStart = mesh.ringStart;
  for (const std::uint32_t vertex : mesh.ring) {
    graph.ring.push_back(toPlan(mesh.vertices[vertex]));
    graph.ringHeight.push_back(mesh.vertices[vertex].y);
  }
  graph.heightStart = mesh.heightStart;
  graph.heightTriangles = mesh.heightTriangles;
  for (std::uint32_t p = 0; p < polygons; ++p) {
    graph.centroid.push_back(areaAndCentroid(graph.ringOf(PolygonId{p})).centroid);
  }
  for (std::uint32_t p = 0; p < polygons; ++p) {
    graph.centroidHeight.push_back(heightAt(graph, PolygonId{p}, graph.centroid[p]));
  }
  auto halves = PortalFinder(mesh).find();
  if (!halves) return tl::unexpected(halves.error());
  placePortals(*halves, polygons, graph);
  if (auto completed = completeRows(graph); !completed) return tl::unexpected(completed.error());
  return graph;
}

tl::expected<void, Error> completeRows(NavGraph& graph) {
  if (auto placed = placeSuccessors(graph); !placed) return placed;
  countNeighbours(graph);
  labelComponents(graph);
  graph.chains = findChains(graph);
  return {};
}

float heightAt(const NavGraph& graph, PolygonId polygon, glm::vec2 plan) {
  float height = 0.0f;
  const bool inside = hasHeights(graph, polygon) ? heightInTriangles(graph, polygon, plan, height)
                                                 : heightInRing(graph, polygon, plan, height);
  return inside ? height : heightBeside(graph, polygon, plan);
}

bool contains(const NavGraph& graph, PolygonId polygon, glm::vec2 plan, float tolerance) {
  if (contains(graph, polygon, plan)) return true;
  if (!(tolerance > 0.0f)) return false;
  const std::span<const glm::vec2> ring = graph.ringOf(polygon);
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const glm::vec2 a = ring[i] - plan;
    const glm::vec2 edge = ring[i + 1 < ring.size() ? i + 1 : 0] - ring[i];
    const float length = glm::dot(edge, edge);
    const float share = length > 0.0f ? std::clamp(-glm::dot(a, edge) / length, 0.0f, 1.0f) : 0.0f;
    if (glm::length(a + share * edge) <= tolerance) return true;
  }
  return false;
}

float areaOf(const NavGraph& graph, PolygonId polygon) {
  return static_cast<float>(areaAndCentroid(graph.ringOf(polygon)).area);
}

}  // namespace forewalk::navmesh
