#include "navmesh/build/navmesh.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>
#include <utility>

#include "navmesh/border_portals.h"
#include "navmesh/plan.h"

namespace forewalk::navmesh {
namespace {

using Check = tl::expected<void, Error>;
using Mesh = HalfEdgeMesh;

constexpr std::uint32_t kNone = 0xffffffffu;

tl::unexpected<Error> damaged(std::string message) {
  return tl::unexpected(Error{ErrorCode::kDataDamaged, std::move(message)});
}

// ---- From flat polygons to half-edges

// Corners are places in `ring`. The corner also stands for the edge from it to the next corner.
struct Corners {
  explicit Corners(const PolygonMesh& mesh) : next(mesh.ring.size()), polygon(mesh.ring.size()) {
    for (std::uint32_t p = 0; p < mesh.polygonCount(); ++p) {
      const std::uint32_t begin = mesh.ringStart[p];
      const std::uint32_t end = mesh.ringStart[p + 1];
      for (std::uint32_t c = begin; c < end; ++c) {
        next[c] = c + 1 < end ? c + 1 : begin;
        polygon[c] = p;
      }
    }
  }

  std::vector<std::uint32_t> next;
  std::vector<std::uint32_t> polygon;
};

// For each edge the one on its other side, or kNone on the border.
tl::expected<std::vector<std::uint32_t>, Error> joinEdges(const PolygonMesh& mesh,
                                                          const Corners& corners) {
  struct Side {
    std::uint32_t low, high, corner;
  };
  std::vector<Side> sides;
  sides.reserve(mesh.ring.size());
  for (std::uint32_t c = 0; c < mesh.ring.size(); ++c) {
    const auto [low, high] = std::minmax(mesh.ring[c], mesh.ring[corners.next[c]]);
    sides.push_back({low, high, c});
  }
  std::sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) {
    return std::tie(a.low, a.high, a.corner) < std::tie(b.low, b.high, b.corner);
  });
  const auto sameEdge = [](const Side& a, const Side& b) {
    return a.low == b.low && a.high == b.high;
  };
  std::vector<std::uint32_t> opposite(mesh.ring.size(), kNone);
  for (std::size_t i = 0; i + 1 < sides.size(); ++i) {
    const Side& a = sides[i];
    const Side& b = sides[i + 1];
    if (!sameEdge(a, b)) continue;
    if (i + 2 < sides.size() && sameEdge(a, sides[i + 2])) {
      return damaged(
          fmt::format("the edge between vertices {} and {} has more than two polygons: {}, {} "
                      "and {}. Build the navmesh again.",
                      a.low, a.high, corners.polygon[a.corner], corners.polygon[b.corner],
                      corners.polygon[sides[i + 2].corner]));
    }
    if (mesh.ring[a.corner] == mesh.ring[b.corner]) {
      return damaged(
          fmt::format("polygons {} and {} lie on the same side of the edge between vertices {} "
                      "and {}. Build the navmesh again.",
                      corners.polygon[a.corner], corners.polygon[b.corner], a.low, a.high));
    }
    opposite[a.corner] = b.corner;
    opposite[b.corner] = a.corner;
    ++i;
  }
  return opposite;
}

// The corners around a vertex that hang together by shared edges are a fan. Union-find; the
// smallest corner of a fan stands for it.
class Fans {
 public:
  Fans(const Corners& corners, const std::vector<std::uint32_t>& opposite)
      : first_(opposite.size()) {
    std::iota(first_.begin(), first_.end(), 0u);
    for (std::uint32_t c = 0; c < opposite.size(); ++c) {
      if (opposite[c] == kNone || opposite[c] < c) continue;
      join(c, corners.next[opposite[c]]);
      join(corners.next[c], opposite[c]);
    }
  }

  std::uint32_t of(std::uint32_t corner) {
    while (first_[corner] != corner) {
      first_[corner] = first_[first_[corner]];
      corner = first_[corner];
    }
    return corner;
  }

 private:
  void join(std::uint32_t a, std::uint32_t b) {
    const auto [low, high] = std::minmax({of(a), of(b)});
    first_[high] = low;
  }

  std::vector<std::uint32_t> first_;
};

// The mesh's vertices: those of the flat form that a polygon names, in their order, then the copies
// for second and further fans, in order of the fan's first corner.
struct FanVertices {
  std::vector<std::uint32_t> ofCorner;    // vertex of the mesh
  std::vector<std::uint32_t> flatVertex;  // per vertex of the mesh
  std::vector<glm::vec3> point;           // per vertex of the mesh
};

FanVertices splitFans(const PolygonMesh& mesh, const Corners& corners,
                      const std::vector<std::uint32_t>& opposite) {
  FanVertices result;
  std::vector<std::uint32_t> compact(mesh.vertices.size(), kNone);
  for (const std::uint32_t v : mesh.ring) compact[v] = 0;
  for (std::uint32_t v = 0; v < compact.size(); ++v) {
    if (compact[v] == kNone) continue;
    compact[v] = static_cast<std::uint32_t>(result.flatVertex.size());
    result.flatVertex.push_back(compact[v]);
    result.point.push_back(mesh.vertices[v]);
  }
  Fans fans(corners, opposite);
  std::vector<bool> taken(result.point.size(), false);
  result.ofCorner.resize(mesh.ring.size());
  for (std::uint32_t c = 0; c < mesh.ring.size(); ++c) {
    const std::uint32_t fan = fans.of(c);
    const std::uint32_t flat = compact[mesh.ring[c]];
    if (fan != c) {
      result.ofCorner[c] = result.ofCorner[fan];
    } else if (!taken[flat]) {
      taken[flat] = true;
      result.ofCorner[c] = flat;
    } else {
      result.ofCorner[c] = static_cast<std::uint32_t>(result.flatVertex.size());
      result.flatVertex.push_back(flat);
      result.point.push_back(result.point[flat]);
    }
  }
  return result;
}

Mesh::Point toPoint(glm::vec3 v) { return {v.x, v.y, v.z}; }
glm::vec3 toVec(const Mesh::Point& p) { return {p[0], p[1], p[2]}; }

// Links the half-edges directly. add_face() would search the fan of every corner, and print what it
// does not like; here all edges are known, and with one fan a vertex each border vertex has one
// border half-edge coming in and one going out, so that the borders link themselves.
Mesh linkHalfEdges(const PolygonMesh& mesh, const Corners& corners,
                   const std::vector<std::uint32_t>& opposite, const FanVertices& vertices) {
  Mesh result;
  result.reserve(vertices.point.size(), mesh.ring.size(), mesh.polygonCount());
  for (const glm::vec3& point : vertices.point) result.new_vertex(toPoint(point));
  for (std::uint32_t p = 0; p < mesh.polygonCount(); ++p) result.new_face();

  const auto handle = [&](std::uint32_t corner) {
    return Mesh::VertexHandle(static_cast<int>(vertices.ofCorner[corner]));
  };
  std::vector<Mesh::HalfedgeHandle> halfEdge(mesh.ring.size());
  for (std::uint32_t c = 0; c < mesh.ring.size(); ++c) {
    const bool made = opposite[c] != kNone && opposite[c] < c;
    halfEdge[c] = made ? result.opposite_halfedge_handle(halfEdge[opposite[c]])
                       : result.new_edge(handle(c), handle(corners.next[c]));
  }
  std::vector<Mesh::HalfedgeHandle> leaving(vertices.point.size());  // border half-edge, a vertex
  for (std::uint32_t c = 0; c < mesh.ring.size(); ++c) {
    const Mesh::FaceHandle face(static_cast<int>(corners.polygon[c]));
    result.set_face_handle(halfEdge[c], face);
    result.set_next_halfedge_handle(halfEdge[c], halfEdge[corners.next[c]]);
    result.set_halfedge_handle(handle(c), halfEdge[c]);
    if (corners.next[c] < c) result.set_halfedge_handle(face, halfEdge[c]);
    if (opposite[c] == kNone) {
      leaving[vertices.ofCorner[corners.next[c]]] = result.opposite_halfedge_handle(halfEdge[c]);
    }
  }
  for (std::uint32_t c = 0; c < mesh.ring.size(); ++c) {
    if (opposite[c] != kNone) continue;
    const Mesh::HalfedgeHandle border = result.opposite_halfedge_handle(halfEdge[c]);
    result.set_next_halfedge_handle(border, leaving[vertices.ofCorner[c]]);
  }
  for (std::size_t v = 0; v < leaving.size(); ++v) {
    if (!leaving[v].is_valid()) continue;
    // OpenMesh knows a border vertex by the half-edge it holds.
    result.set_halfedge_handle(Mesh::VertexHandle(static_cast<int>(v)), leaving[v]);
  }
  return result;
}

// ---- Checks

// OpenMesh's handles are plain numbers, and following a wrong one leaves the arrays. So the ranges
// come first, for every half-edge, before anything walks.
Check checkHandles(const Mesh& mesh) {
  const int vertices = static_cast<int>(mesh.n_vertices());
  const int halfEdges = static_cast<int>(mesh.n_halfedges());
  const int faces = static_cast<int>(mesh.n_faces());
  const auto within = [](OpenMesh::BaseHandle handle, int count) {
    return handle.idx() >= 0 && handle.idx() < count;
  };
  for (int i = 0; i < halfEdges; ++i) {
    const Mesh::HalfedgeHandle h(i);
    const Mesh::FaceHandle face = mesh.face_handle(h);
    if (!within(mesh.next_halfedge_handle(h), halfEdges) ||
        !within(mesh.prev_halfedge_handle(h), halfEdges) ||
        !within(mesh.to_vertex_handle(h), vertices) || (face.is_valid() && !within(face, faces))) {
      return damaged(fmt::format(
          "half-edge {} of {} has a link that leads nowhere (next {}, previous {}, "
          "vertex {}, polygon {}). Link it or remove its edge.",
          i, halfEdges, mesh.next_halfedge_handle(h).idx(), mesh.prev_halfedge_handle(h).idx(),
          mesh.to_vertex_handle(h).idx(), face.idx()));
    }
  }
  for (int i = 0; i < vertices; ++i) {
    const Mesh::HalfedgeHandle h = mesh.halfedge_handle(Mesh::VertexHandle(i));
    if (!within(h, halfEdges)) {
      return damaged(fmt::format("vertex {} has no half-edge ({}). Remove it.", i, h.idx()));
    }
  }
  for (int i = 0; i < faces; ++i) {
    const Mesh::HalfedgeHandle h = mesh.halfedge_handle(Mesh::FaceHandle(i));
    if (!within(h, halfEdges)) {
      return damaged(fmt::format("polygon {} has no half-edge ({}). Remove it.", i, h.idx()));
    }
  }
  return {};
}

Check checkNothingDeleted(const Mesh& mesh) {
  const auto count = [](std::size_t n, auto&& isDeleted) {
    std::size_t deleted = 0;
    for (std::size_t i = 0; i < n; ++i) deleted += isDeleted(static_cast<int>(i)) ? 1u : 0u;
    return deleted;
  };
  const std::size_t deleted =
      count(mesh.n_vertices(),
            [&](int i) { return mesh.status(Mesh::VertexHandle(i)).deleted(); }) +
      count(mesh.n_edges(), [&](int i) { return mesh.status(Mesh::EdgeHandle(i)).deleted(); }) +
      count(mesh.n_faces(), [&](int i) { return mesh.status(Mesh::FaceHandle(i)).deleted(); });
  if (deleted == 0) return {};
  return damaged(
      fmt::format("the half-edge mesh still holds {} deleted elements. Call "
                  "garbage_collection() first.",
                  deleted));
}

Check checkLinks(const Mesh& mesh) {
  for (int i = 0; i < static_cast<int>(mesh.n_halfedges()); ++i) {
    const Mesh::HalfedgeHandle h(i);
    const Mesh::HalfedgeHandle next = mesh.next_halfedge_handle(h);
    const Mesh::HalfedgeHandle other = mesh.opposite_halfedge_handle(h);
    if (mesh.prev_halfedge_handle(next) != h || mesh.face_handle(next) != mesh.face_handle(h) ||
        mesh.from_vertex_handle(next) != mesh.to_vertex_handle(h)) {
      return damaged(
          fmt::format("half-edge {} and the next one, {}, do not belong together. Link them "
                      "anew.",
                      i, next.idx()));
    }
    if (mesh.is_boundary(h) && mesh.is_boundary(other)) {
      return damaged(
          fmt::format("half-edges {} and {} have no polygon on either side. Remove their edge.", i,
                      other.idx()));
    }
    if (mesh.to_vertex_handle(h) == mesh.to_vertex_handle(other)) {
      return damaged(fmt::format("half-edge {} leads from vertex {} to itself. Remove its edge.", i,
                                 mesh.to_vertex_handle(h).idx()));
    }
  }
  return {};
}

// With next and previous each other's inverse, half-edges fall into cycles. A polygon must own
// exactly one, and so must the turn around a vertex: the counts tell, without any walk that might
// not end.
Check checkCycles(const Mesh& mesh) {
  std::vector<std::uint32_t> corners(mesh.n_faces(), 0);
  std::vector<std::uint32_t> spokes(mesh.n_vertices(), 0);
  std::vector<bool> onBorder(mesh.n_vertices(), false);
  for (int i = 0; i < static_cast<int>(mesh.n_halfedges()); ++i) {
    const Mesh::HalfedgeHandle h(i);
    const auto from = static_cast<std::size_t>(mesh.from_vertex_handle(h).idx());
    ++spokes[from];
    if (mesh.is_boundary(h)) {
      onBorder[from] = true;
    } else {
      ++corners[static_cast<std::size_t>(mesh.face_handle(h).idx())];
    }
  }
  for (int i = 0; i < static_cast<int>(mesh.n_faces()); ++i) {
    const Mesh::FaceHandle face(i);
    const Mesh::HalfedgeHandle start = mesh.halfedge_handle(face);
    std::uint32_t steps = 0;
    Mesh::HalfedgeHandle h = start;
    do {
      h = mesh.next_halfedge_handle(h);
      ++steps;
    } while (h != start);
    if (mesh.face_handle(start) != face || steps != corners[static_cast<std::size_t>(i)]) {
      return damaged(
          fmt::format("polygon {} has {} half-edges, but the ring at its half-edge {} has {} of "
                      "polygon {}. Link it anew.",
                      i, corners[static_cast<std::size_t>(i)], start.idx(), steps,
                      mesh.face_handle(start).idx()));
    }
  }
  for (int i = 0; i < static_cast<int>(mesh.n_vertices()); ++i) {
    const Mesh::VertexHandle vertex(i);
    const Mesh::HalfedgeHandle start = mesh.halfedge_handle(vertex);
    std::uint32_t steps = 0;
    Mesh::HalfedgeHandle h = start;
    std::uint32_t gaps = 0;
    do {
      gaps += mesh.is_boundary(h) ? 1u : 0u;
      h = mesh.next_halfedge_handle(mesh.opposite_halfedge_handle(h));
      ++steps;
    } while (h != start);
    if (mesh.from_vertex_handle(start) != vertex || steps != spokes[static_cast<std::size_t>(i)] ||
        gaps > 1) {
      return damaged(
          fmt::format("vertex {} has {} half-edges and a turn around it meets {} of them and {} "
                      "gaps: several fans touch there. Give each its own copy.",
                      i, spokes[static_cast<std::size_t>(i)], steps, gaps));
    }
    if (onBorder[static_cast<std::size_t>(i)] && !mesh.is_boundary(start)) {
      return damaged(
          fmt::format("vertex {} lies on the border, but its half-edge {} does not. Call "
                      "adjust_outgoing_halfedge() for it.",
                      i, start.idx()));
    }
  }
  return {};
}

// Copies of a vertex agree, the flat numbers are dense, and no edge of the flat form is two edges
// here.
Check checkWelding(const NavMesh& navMesh) {
  const Mesh& mesh = navMesh.mesh;
  const std::vector<std::uint32_t>& flat = navMesh.flatVertex;
  if (flat.size() != mesh.n_vertices()) {
    return damaged(
        fmt::format("{} vertices of the flat form are named, the half-edge mesh has {}. Make it "
                    "again with makeNavMesh().",
                    flat.size(), mesh.n_vertices()));
  }
  std::vector<std::uint32_t> firstCopy(flat.size(), kNone);
  for (std::uint32_t v = 0; v < flat.size(); ++v) {
    if (flat[v] >= flat.size()) {
      return damaged(
          fmt::format("vertex {} names vertex {} of the flat form, there are at most {}. Make "
                      "it again with makeNavMesh().",
                      v, flat[v], flat.size()));
    }
    std::uint32_t& first = firstCopy[flat[v]];
    if (first == kNone) first = v;
    const glm::vec3 here = toVec(mesh.point(Mesh::VertexHandle(static_cast<int>(v))));
    const glm::vec3 there = toVec(mesh.point(Mesh::VertexHandle(static_cast<int>(first))));
    if (here != there) {
      return damaged(
          fmt::format("vertices {} and {} are copies of one, but lie {} m apart. Move both.", first,
                      v, glm::distance(here, there)));
    }
  }
  const auto gap = std::find(firstCopy.begin(), firstCopy.end(), kNone);
  if (std::any_of(gap, firstCopy.end(), [](std::uint32_t v) { return v != kNone; })) {
    return damaged(
        fmt::format("no vertex names vertex {} of the flat form, though later ones are named. "
                    "Make it again with makeNavMesh().",
                    gap - firstCopy.begin()));
  }
  std::vector<std::pair<std::uint32_t, std::uint32_t>> edges;
  edges.reserve(mesh.n_edges());
  for (int i = 0; i < static_cast<int>(mesh.n_edges()); ++i) {
    const Mesh::HalfedgeHandle h = mesh.halfedge_handle(Mesh::EdgeHandle(i), 0);
    const auto end = [&](Mesh::VertexHandle v) { return flat[static_cast<std::size_t>(v.idx())]; };
    edges.push_back(std::minmax({end(mesh.from_vertex_handle(h)), end(mesh.to_vertex_handle(h))}));
  }
  std::sort(edges.begin(), edges.end());
  const auto doubled = std::adjacent_find(edges.begin(), edges.end());
  if (doubled != edges.end()) {
    return damaged(
        fmt::format("the edge between vertices {} and {} of the flat form is two edges of the "
                    "half-edge mesh. Make it again with makeNavMesh().",
                    doubled->first, doubled->second));
  }
  return {};
}

}  // namespace

tl::expected<NavMesh, Error> makeNavMesh(const PolygonMesh& polygons,
                                         const BuildSettings& settings) {
  if (Check sound = validate(polygons); !sound) return tl::unexpected(sound.error());
  constexpr std::size_t kCornersMost = 1u << 30;  // OpenMesh numbers half-edges with int
  if (polygons.ring.size() > kCornersMost) {
    return tl::unexpected(
        Error{ErrorCode::kTooLarge,
              fmt::format("the polygons have {} corners, a navmesh can have {}. Build it "
                          "with larger cells.",
                          polygons.ring.size(), kCornersMost)});
  }
  const Corners corners(polygons);
  const auto opposite = joinEdges(polygons, corners);
  if (!opposite) return tl::unexpected(opposite.error());
  FanVertices vertices = splitFans(polygons, corners, *opposite);
  NavMesh result{settings,
                 linkHalfEdges(polygons, corners, *opposite, vertices),
                 std::move(vertices.flatVertex),
                 polygons.borderPortals,
                 polygons.heightStart,
                 polygons.heightTriangles};
  return result;
}

PolygonMesh flatten(const NavMesh& navMesh) {
  const Mesh& mesh = navMesh.mesh;
  PolygonMesh flat;
  for (std::uint32_t v = 0; v < navMesh.flatVertex.size(); ++v) {
    const std::uint32_t place = navMesh.flatVertex[v];
    if (place >= flat.vertices.size()) flat.vertices.resize(place + 1);
    flat.vertices[place] = toVec(mesh.point(Mesh::VertexHandle(static_cast<int>(v))));
  }
  for (int i = 0; i < static_cast<int>(mesh.n_faces()); ++i) {
    const Mesh::HalfedgeHandle start = mesh.halfedge_handle(Mesh::FaceHandle(i));
    Mesh::HalfedgeHandle h = start;
    do {
      const auto vertex = static_cast<std::size_t>(mesh.to_vertex_handle(h).idx());
      flat.ring.push_back(navMesh.flatVertex[vertex]);
      h = mesh.next_halfedge_handle(h);
    } while (h != start);
    flat.ringStart.push_back(static_cast<std::uint32_t>(flat.ring.size()));
  }
  flat.borderPortals = navMesh.borderPortals;
  flat.heightStart = navMesh.heightStart;
  flat.heightTriangles = navMesh.heightTriangles;
  return flat;
}

tl::expected<void, Error> validate(const NavMesh& navMesh) {
  if (Check settings = validate(navMesh.settings); !settings) return settings;
  if (Check whole = checkNothingDeleted(navMesh.mesh); !whole) return whole;
  if (Check handles = checkHandles(navMesh.mesh); !handles) return handles;
  if (Check links = checkLinks(navMesh.mesh); !links) return links;
  if (Check cycles = checkCycles(navMesh.mesh); !cycles) return cycles;
  if (Check welding = checkWelding(navMesh); !welding) return welding;
  const PolygonMesh flat = flatten(navMesh);  // its links are sound by now, so this ends
  if (Check polygons = validate(flat); !polygons) return polygons;
  return checkBorderPortals(flat, navMesh.settings.climb);
}

}  // namespace forewalk::navmesh
