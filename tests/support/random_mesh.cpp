#include "tests/support/random_mesh.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <random>
#include <tuple>
#include <utility>

#include "navmesh/plan.h"
#include "navmesh/random.h"

namespace forewalk::testing {
namespace {

using navmesh::BorderPortal;
using navmesh::PolygonId;
using navmesh::PolygonMesh;
using navmesh::toPlan;
using navmesh::toSpace;
using navmesh::uniform;

using Ring = std::vector<std::uint32_t>;  // vertex indices, counter-clockwise

// Drops vertices that no ring names.
PolygonMesh meshOf(const std::vector<glm::vec3>& vertices, const std::vector<Ring>& rings) {
  constexpr std::uint32_t kUnused = 0xffffffffu;
  PolygonMesh mesh;
  std::vector<std::uint32_t> newIndex(vertices.size(), kUnused);
  for (const Ring& ring : rings) {
    for (const std::uint32_t vertex : ring) {
      if (newIndex[vertex] == kUnused) {
        newIndex[vertex] = static_cast<std::uint32_t>(mesh.vertices.size());
        mesh.vertices.push_back(vertices[vertex]);
      }
      mesh.ring.push_back(newIndex[vertex]);
    }
    mesh.ringStart.push_back(static_cast<std::uint32_t>(mesh.ring.size()));
  }
  return mesh;
}

// The rings of a and b as one, where they share exactly one edge and the union is convex and has at
// most six corners; else empty.
Ring mergedRing(const std::vector<glm::vec3>& vertices, const Ring& a, const Ring& b) {
  constexpr std::size_t kCornersMax = 6;
  if (a.size() + b.size() - 2 > kCornersMax) return {};
  Ring merged;
  int shared = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    merged.push_back(a[i]);
    const std::uint32_t next = a[(i + 1) % a.size()];
    for (std::size_t j = 0; j < b.size(); ++j) {
      if (b[j] != next || b[(j + 1) % b.size()] != a[i]) continue;
      ++shared;
      for (std::size_t k = 2; k < b.size(); ++k) merged.push_back(b[(j + k) % b.size()]);
    }
  }
  if (shared != 1) return {};
  for (std::size_t i = 0; i < merged.size(); ++i) {
    const auto at = [&](std::size_t k) {
      return toPlan(vertices[merged[(i + k) % merged.size()]]);
    };
    if (navmesh::turn(at(0), at(1), at(2)) < 0.0f) return {};
  }
  return merged;
}

void append(PolygonMesh& mesh, const PolygonMesh& more, glm::vec3 moved) {
  const auto vertices = static_cast<std::uint32_t>(mesh.vertices.size());
  const std::uint32_t polygons = mesh.polygonCount();
  const auto corners = static_cast<std::uint32_t>(mesh.ring.size());
  assert(mesh.heightStart.empty() && more.heightStart.empty());
  for (const glm::vec3 v : more.vertices) mesh.vertices.push_back(v + moved);
  for (const std::uint32_t v : more.ring) mesh.ring.push_back(v + vertices);
  for (std::uint32_t p = 0; p < more.polygonCount(); ++p) {
    mesh.ringStart.push_back(more.ringStart[p + 1] + corners);
  }
  for (BorderPortal portal : more.borderPortals) {
    portal.from = PolygonId{index(portal.from) + polygons};
    portal.to = PolygonId{index(portal.to) + polygons};
    portal.left += moved;
    portal.right += moved;
    mesh.borderPortals.push_back(portal);
  }
}

template <typename Map>
PolygonMesh mapped(PolygonMesh mesh, const Map& map) {
  for (glm::vec3& v : mesh.vertices) v = map(v);
  for (BorderPortal& portal : mesh.borderPortals) {
    portal.left = map(portal.left);
    portal.right = map(portal.right);
  }
  for (navmesh::HeightTriangle& t : mesh.heightTriangles) t = {map(t.a), map(t.b), map(t.c)};
  return mesh;
}

// An edge that lies on the line x = const.
struct VerticalEdge {
  PolygonId polygon;
  std::uint32_t edge;
  float low, high;  // plan y
  glm::vec3 atLow, atHigh;

  glm::vec3 at(float y) const { return atLow + (y - low) / (high - low) * (atHigh - atLow); }
};

std::vector<VerticalEdge> edgesAt(const PolygonMesh& mesh, float x) {
  std::vector<VerticalEdge> edges;
  for (std::uint32_t p = 0; p < mesh.polygonCount(); ++p) {
    const std::uint32_t begin = mesh.ringStart[p];
    const std::uint32_t corners = mesh.ringStart[p + 1] - begin;
    for (std::uint32_t e = 0; e < corners; ++e) {
      const glm::vec3 a = mesh.vertices[mesh.ring[begin + e]];
      const glm::vec3 b = mesh.vertices[mesh.ring[begin + (e + 1) % corners]];
      if (a.x != x || b.x != x) continue;
      const bool up = toPlan(a).y < toPlan(b).y;
      const glm::vec3 low = up ? a : b;
      const glm::vec3 high = up ? b : a;
      edges.push_back({PolygonId{p}, e, toPlan(low).y, toPlan(high).y, low, high});
    }
  }
  return edges;
}

float extremeX(const PolygonMesh& mesh, float sign) {
  float extreme = -std::numeric_limits<float>::infinity();
  for (const glm::vec3 v : mesh.vertices) extreme = std::max(extreme, sign * v.x);
  return sign * extreme;
}

}  // namespace

PolygonMesh randomMesh(std::uint64_t seed, int columns, int rows,
                       const RandomMeshOptions& options) {
  assert(columns >= 1 && rows >= 1 && options.jitter <= 0.24);
  std::mt19937_64 rng(seed);
  std::vector<glm::vec3> vertices;
  for (int row = 0; row <= rows; ++row) {
    for (int column = 0; column <= columns; ++column) {
      const double x = uniform(rng, -1.0, 1.0) * (column > 0 && column < columns ? 1.0 : 0.0);
      const double y = uniform(rng, -1.0, 1.0) * (row > 0 && row < rows ? 1.0 : 0.0);
      const float height = static_cast<float>(uniform(rng)) * options.heights;
      const glm::dvec2 plan = glm::dvec2(column, row) + options.jitter * glm::dvec2(x, y);
      vertices.push_back(toSpace(glm::vec2(plan * static_cast<double>(options.cell)), height));
    }
  }
  std::vector<Ring> rings;
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      const auto at = [&](int x, int y) {
        return static_cast<std::uint32_t>((row + y) * (columns + 1) + column + x);
      };
      const Ring quad{at(0, 0), at(1, 0), at(1, 1), at(0, 1)};
      const bool hole = uniform(rng) < options.holeShare;
      const bool split = uniform(rng) < options.splitShare;
      const bool rising = uniform(rng) < 0.5;
      const bool last = row == rows - 1 && column == columns - 1 && rings.empty();
      if (hole && !last) continue;
      if (!split) {
        rings.push_back(quad);
      } else if (rising) {
        rings.push_back({quad[0], quad[1], quad[2]});
        rings.push_back({quad[0], quad[2], quad[3]});
      } else {
        rings.push_back({quad[0], quad[1], quad[3]});
        rings.push_back({quad[1], quad[2], quad[3]});
      }
    }
  }
  // Each pair of neighbours has one chance; a merged polygon may grow again.
  const std::size_t reach = 2 * static_cast<std::size_t>(columns) + 3;  // a row of triangles
  for (std::size_t a = 0; a < rings.size(); ++a) {
    for (std::size_t b = a + 1; b < std::min(a + reach, rings.size()); ++b) {
      if (rings[a].empty() || rings[b].empty()) continue;
      Ring merged = mergedRing(vertices, rings[a], rings[b]);
      if (!merged.empty() && uniform(rng) < options.mergeShare) {
        rings[a] = std::move(merged);
        rings[b].clear();
      }
    }
  }
  rings.erase(std::remove_if(rings.begin(), rings.end(), [](const Ring& r) { return r.empty(); }),
              rings.end());
  return meshOf(vertices, rings);
}

PolygonMesh gridMesh(int columns, int rows, float cell) {
  RandomMeshOptions options;
  options.holeShare = options.splitShare = options.mergeShare = options.jitter = 0.0;
  options.cell = cell;
  return randomMesh(0, columns, rows, options);
}

PolygonMesh corridorMesh(std::span<const float> lengths, float width) {
  std::vector<glm::vec3> vertices{toSpace({0.0f, 0.0f}, 0.0f), toSpace({0.0f, width}, 0.0f)};
  std::vector<Ring> rings;
  float x = 0.0f;
  for (std::uint32_t i = 0; i < lengths.size(); ++i) {
    x += lengths[i];
    vertices.push_back(toSpace({x, 0.0f}, 0.0f));
    vertices.push_back(toSpace({x, width}, 0.0f));
    rings.push_back({2 * i, 2 * i + 2, 2 * i + 3, 2 * i + 1});
  }
  return meshOf(vertices, rings);
}

PolygonMesh joinedAlong(const PolygonMesh& left, const PolygonMesh& right) {
  const float border = extremeX(left, 1.0f);
  PolygonMesh moved = mapped(right, [&, start = extremeX(right, -1.0f)](glm::vec3 v) {
    // Exactly on the border, whatever the rounding elsewhere.
    return glm::vec3(v.x == start ? border : v.x - start + border, v.y, v.z);
  });
  const std::uint32_t polygons = left.polygonCount();
  PolygonMesh joined = left;
  append(joined, moved, glm::vec3(0.0f));
  std::vector<BorderPortal> portals;
  for (const VerticalEdge& from : edgesAt(left, border)) {
    for (const VerticalEdge& to : edgesAt(moved, border)) {
      const float low = std::max(from.low, to.low);
      const float high = std::min(from.high, to.high);
      if (low >= high) continue;
      // Walking along +x, plan +y is on the left.
      portals.push_back({from.polygon, PolygonId{index(to.polygon) + polygons}, from.edge, to.edge,
                         from.at(high), from.at(low)});
    }
  }
  joined.borderPortals.insert(joined.borderPortals.end(), portals.begin(), portals.end());
  std::sort(joined.borderPortals.begin(), joined.borderPortals.end(),
            [](const BorderPortal& a, const BorderPortal& b) {
              return std::tie(a.from, a.fromEdge, a.to, a.toEdge) <
                     std::tie(b.from, b.fromEdge, b.to, b.toEdge);
            });
  return joined;
}

PolygonMesh joinedGrids(int columns, int leftRows, int rightRows, float height) {
  return joinedAlong(gridMesh(columns, leftRows, height / static_cast<float>(leftRows)),
                     gridMesh(columns, rightRows, height / static_cast<float>(rightRows)));
}

PolygonMesh together(const PolygonMesh& first, const PolygonMesh& second, glm::vec3 moved) {
  PolygonMesh both = first;
  append(both, second, moved);
  return both;
}

PolygonMesh turned(const PolygonMesh& mesh, float angle) {
  const double c = std::cos(static_cast<double>(angle));
  const double s = std::sin(static_cast<double>(angle));
  return mapped(mesh, [&](glm::vec3 v) {
    const glm::dvec2 p(toPlan(v));
    return toSpace(glm::vec2(c * p.x - s * p.y, s * p.x + c * p.y), v.y);
  });
}

PolygonMesh mirrored(const PolygonMesh& mesh) {
  PolygonMesh result = mapped(mesh, [](glm::vec3 v) { return glm::vec3(-v.x, v.y, v.z); });
  for (std::uint32_t p = 0; p < result.polygonCount(); ++p) {
    std::reverse(result.ring.begin() + result.ringStart[p],
                 result.ring.begin() + result.ringStart[p + 1]);
  }
  // Reversed, the edge from corner i to i + 1 runs from corner n - 2 - i to the next.
  const auto edge = [&](PolygonId polygon, std::uint32_t old) {
    const std::uint32_t n = mesh.ringStart[index(polygon) + 1] - mesh.ringStart[index(polygon)];
    return (2 * n - 2 - old) % n;
  };
  for (BorderPortal& portal : result.borderPortals) {
    portal.fromEdge = edge(portal.from, portal.fromEdge);
    portal.toEdge = edge(portal.to, portal.toEdge);
    std::swap(portal.left, portal.right);
  }
  std::sort(result.borderPortals.begin(), result.borderPortals.end(),
            [](const BorderPortal& a, const BorderPortal& b) {
              return std::tie(a.from, a.fromEdge, a.to, a.toEdge) <
                     std::tie(b.from, b.fromEdge, b.to, b.toEdge);
            });
  for (navmesh::HeightTriangle& t : result.heightTriangles) std::swap(t.b, t.c);
  return result;
}

PolygonMesh scaled(const PolygonMesh& mesh, float factor) {
  return mapped(mesh, [&](glm::vec3 v) { return factor * v; });
}

PolygonMesh repeated(const PolygonMesh& mesh, int columns, int rows) {
  glm::vec3 low(std::numeric_limits<float>::infinity());
  glm::vec3 high = -low;
  for (const glm::vec3 v : mesh.vertices) {
    low = glm::min(low, v);
    high = glm::max(high, v);
  }
  // Whole metres, so that small coordinates move without rounding.
  const glm::vec3 step = glm::ceil(high - low) + 1.0f;
  PolygonMesh all;
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      append(all, mesh,
             {step.x * static_cast<float>(column), 0.0f, -step.z * static_cast<float>(row)});
    }
  }
  return all;
}

}  // namespace forewalk::testing
