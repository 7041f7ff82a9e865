#include "navmesh/build/detour_tiles.h"

#include <DetourNavMesh.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <tuple>
#include <unordered_map>
#include <utility>

#include "navmesh/build/tile_borders.h"
#include "navmesh/build/tile_polygons.h"
#include "navmesh/build/tile_view.h"

namespace forewalk::navmesh {
namespace {

constexpr float kCoordinateMax = 1e6f;      // metres; beyond, floats are coarser than a step
constexpr float kFlat = 1e-3f;              // metres; heights closer than that are one height
constexpr std::size_t kMeetingsMax = 4096;  // pairs looked at per border edge, see joinBorders

tl::unexpected<Error> failed(ErrorCode code, std::string message) {
  return tl::unexpected(Error{code, std::move(message)});
}

bool isPlace(float value) { return std::abs(value) <= kCoordinateMax; }  // false for NaN

/// Welds points that lie within kWeld of each other: each goes to the earliest that stays.
class Welder {
 public:
  /// The index of the point that stands for `point`: an earlier one, or its own, `points.size() -
  /// 1` after the call.
  std::uint32_t add(glm::vec3 point, std::vector<glm::vec3>& points) {
    const auto own = static_cast<std::uint32_t>(points.size());
    points.push_back(point);
    next_.push_back(kNone);
    const glm::dvec3 low = glm::floor((glm::dvec3(point) - double{kWeld}) / kBox);
    const glm::dvec3 high = glm::floor((glm::dvec3(point) + double{kWeld}) / kBox);
    std::uint32_t found = kNone;
    for (double x = low.x; x <= high.x; ++x) {
      for (double y = low.y; y <= high.y; ++y) {
        for (double z = low.z; z <= high.z; ++z) {
          const auto first = first_.find(keyOf({x, y, z}));
          if (first == first_.end()) continue;
          for (std::uint32_t i = first->second; i != kNone; i = next_[i]) {
            if (i < found && isWelded(points[i], point)) found = i;
          }
        }
      }
    }
    if (found != kNone) return found;
    const auto [entry, isNew] =
        first_.try_emplace(keyOf(glm::floor(glm::dvec3(point) / kBox)), own);
    if (!isNew) next_[own] = std::exchange(entry->second, own);
    return own;
  }

 private:
  static constexpr std::uint32_t kNone = 0xffffffffu;
  static constexpr double kBox = 4.0 * kWeld;

  // Boxes that share a key by accident only cost a comparison.
  static std::uint64_t keyOf(glm::dvec3 box) {
    std::uint64_t key = 0;
    for (int k = 0; k < 3; ++k) {
      key = (key ^ static_cast<std::uint64_t>(static_cast<std::int64_t>(box[k]))) *
            0x9e3779b97f4a7c15u;
      key ^= key >> 29;
    }
    return key;
  }

  std::unordered_map<std::uint64_t, std::uint32_t>
      first_;                        // box to the last point that stays there
  std::vector<std::uint32_t> next_;  // per point: the one before it in its box
};

/// Collects the polygons of tile after tile.
class Collector {
 public:
  explicit Collector(float climb) : climb_(climb) {}

  /// `places`: see polygonsOfTile.
  tl::expected<void, Error> add(const TileView& tile, const std::string& where,
                                std::span<const glm::vec3> places = {});
  tl::expected<PolygonMesh, Error> finish(const std::string& name) &&;
  TilePolygons finishAlone() &&;

 private:
  tl::expected<void, Error> addVertices(const TileView& tile,
                                        const std::vector<std::size_t>& grounds,
                                        const std::string& where,
                                        std::span<const glm::vec3> places);
  void addRing(const dtPoly& polygon);
  tl::expected<void, Error> addHeights(const TileView& tile, std::size_t i, const dtPoly& polygon,
                                       std::size_t& triangles, const std::string& where);
  void addBorderEdges(const dtPoly& polygon);
  tl::expected<void, Error> joinBorders(const std::string& name);
  void joinEdges(const BorderEdge& one, const BorderEdge& other);
  void dropUnusedVertices();
  void finishHeights();

  float climb_;
  PolygonMesh mesh_;
  Welder welder_;
  std::uint32_t tile_ = 0;
  std::vector<std::uint32_t> own_,
      welded_;  // per vertex of the present tile: index in mesh_.vertices
  std::vector<BorderEdge> borderEdges_;
};

tl::expected<void, Error> Collector::add(const TileView& tile, const std::string& where,
                                         std::span<const glm::vec3> places) {
  const auto polygonCount = static_cast<std::size_t>(tile.header().polyCount);
  std::vector<std::size_t> grounds;
  for (std::size_t i = 0; i < polygonCount; ++i) {
    const dtPoly polygon = tile.polygon(i);
    if (polygon.getType() != DT_POLYTYPE_GROUND) continue;
    if (polygon.vertCount < 3 || polygon.vertCount > DT_VERTS_PER_POLYGON) {
      return failed(
          ErrorCode::kDataDamaged,
          fmt::format(
              "{}, byte {}: polygon {} has {} corners, it must have 3 to {}. Save it again.", where,
              tile.offsetOfPolygon(i), i, polygon.vertCount, DT_VERTS_PER_POLYGON));
    }
    for (int k = 0; k < polygon.vertCount; ++k) {
      if (polygon.verts[k] >= tile.header().vertCount) {
        return failed(
            ErrorCode::kDataDamaged,
            fmt::format("{}, byte {}: polygon {} names vertex {}, the tile has {}. Save it "
                        "again.",
                        where, tile.offsetOfPolygon(i), i, polygon.verts[k],
                        tile.header().vertCount));
      }
    }
    grounds.push_back(i);
  }
  if (auto added = addVertices(tile, grounds, where, places); !added) return added;
  std::size_t triangles = 0;
  for (const std::size_t i : grounds) {
    const dtPoly polygon = tile.polygon(i);
    addRing(polygon);
    addBorderEdges(polygon);
    if (auto added = addHeights(tile, i, polygon, triangles, where); !added) return added;
  }
  ++tile_;
  return {};
}

tl::expected<void, Error> Collector::addVertices(const TileView& tile,
                                                 const std::vector<std::size_t>& grounds,
                                                 const std::string& where,
                                                 std::span<const glm::vec3> places) {
  const auto vertexCount = static_cast<std::size_t>(tile.header().vertCount);
  std::vector<bool> named(vertexCount, false);
  for (const std::size_t i : grounds) {
    const dtPoly polygon = tile.polygon(i);
    for (int k = 0; k < polygon.vertCount; ++k) named[polygon.verts[k]] = true;
  }
  own_.assign(vertexCount, 0);
  welded_.assign(vertexCount, 0);
  std::size_t next = 0;  // of places
  for (std::size_t i = 0; i < vertexCount; ++i) {
    if (!named[i]) continue;
    const glm::vec3 vertex = places.empty() ? tile.vertex(i) : places[next++];
    if (!isPlace(vertex.x) || !isPlace(vertex.y) || !isPlace(vertex.z)) {
      return failed(
          ErrorCode::kDataDamaged,
          fmt::format("{}, byte {}: vertex {} is at ({}, {}, {}) m, coordinates must be within "
                      "{:g} m. Save it again.",
                      where, tile.offsetOfVertex(i), i, vertex.x, vertex.y, vertex.z,
                      kCoordinateMax));
    }
    own_[i] = static_cast<std::uint32_t>(mesh_.vertices.size());
    welded_[i] = welder_.add(vertex, mesh_.vertices);
  }
  return {};
}

void Collector::addRing(const dtPoly& polygon) {
  // Recast's corners run counter-clockwise on our plan already.
  const std::size_t begin = mesh_.ring.size();
  for (int k = 0; k < polygon.vertCount; ++k) {
    const std::uint32_t vertex = welded_[polygon.verts[k]];
    const bool taken = std::find(mesh_.ring.begin() + static_cast<std::ptrdiff_t>(begin),
                                 mesh_.ring.end(), vertex) != mesh_.ring.end();
    // A navmesh in other units than metres may be finer than the weld; corners stay apart.
    mesh_.ring.push_back(taken ? own_[polygon.verts[k]] : vertex);
  }
  mesh_.ringStart.push_back(static_cast<std::uint32_t>(mesh_.ring.size()));
}

tl::expected<void, Error> Collector::addHeights(const TileView& tile, std::size_t i,
                                                const dtPoly& polygon, std::size_t& triangles,
                                                const std::string& where) {
  const dtMeshHeader& header = tile.header();
  if (i < static_cast<std::size_t>(header.detailMeshCount)) {
    const dtPolyDetail detail = tile.detail(i);
    const auto damaged = [&](const char* what, std::size_t first, std::size_t count, int limit) {
      return failed(
          ErrorCode::kDataDamaged,
          fmt::format("{}, byte {}: polygon {} has detail {} {} to {}, the tile has {}. Save it "
                      "again.",
                      where, tile.offsetOfDetail(i), i, what, first, first + count, limit));
    };
    const std::size_t vertexBase = detail.vertBase, triangleBase = detail.triBase;
    // No two polygons share detail triangles, so all together are no more than there are.
    triangles += detail.triCount;
    if (triangleBase + detail.triCount > static_cast<std::size_t>(header.detailTriCount) ||
        triangles > static_cast<std::size_t>(header.detailTriCount)) {
      return damaged("triangles", triangleBase, detail.triCount, header.detailTriCount);
    }
    if (vertexBase + detail.vertCount > static_cast<std::size_t>(header.detailVertCount)) {
      return damaged("vertices", vertexBase, detail.vertCount, header.detailVertCount);
    }
    const std::size_t first = mesh_.heightTriangles.size();
    float lowest = std::numeric_limits<float>::max(), highest = -lowest;
    for (std::size_t t = triangleBase; t < triangleBase + detail.triCount; ++t) {
      const auto corners = tile.detailTriangle(t);
      std::array<glm::vec3, 3> points;
      for (std::size_t k = 0; k < 3; ++k) {
        const std::size_t corner = corners[k];
        if (corner < polygon.vertCount) {
          points[k] = mesh_.vertices[welded_[polygon.verts[corner]]];
        } else if (corner - polygon.vertCount < detail.vertCount) {
          const std::size_t vertex = vertexBase + corner - polygon.vertCount;
          points[k] = tile.detailVertex(vertex);
          if (!isPlace(points[k].x) || !isPlace(points[k].y) || !isPlace(points[k].z)) {
            return failed(
                ErrorCode::kDataDamaged,
                fmt::format(
                    "{}, byte {}: detail vertex {} is at ({}, {}, {}) m, coordinates must be "
                    "within {:g} m. Save it again.",
                    where, tile.offsetOfDetailVertex(vertex), vertex, points[k].x, points[k].y,
                    points[k].z, kCoordinateMax));
          }
        } else {
          return failed(
              ErrorCode::kDataDamaged,
              fmt::format("{}, byte {}: detail triangle {} names corner {}, polygon {} has {}. "
                          "Save it again.",
                          where, tile.offsetOfDetailTriangle(t), t, corner, i,
                          polygon.vertCount + detail.vertCount));
        }
        lowest = std::min(lowest, points[k].y);
        highest = std::max(highest, points[k].y);
      }
      mesh_.heightTriangles.push_back({points[0], points[1], points[2]});
    }
    if (highest - lowest <= kFlat) mesh_.heightTriangles.resize(first);  // the corners say it all
  }
  mesh_.heightStart.push_back(static_cast<std::uint32_t>(mesh_.heightTriangles.size()));
  return {};
}

void Collector::addBorderEdges(const dtPoly& polygon) {
  const std::uint32_t p = mesh_.polygonCount() - 1;
  const std::uint32_t* ring = mesh_.ring.data() + mesh_.ringStart[p];
  const std::uint32_t corners = polygon.vertCount;
  for (std::uint32_t edge = 0; edge < corners; ++edge) {
    if ((polygon.neis[edge] & DT_EXT_LINK) == 0) continue;
    const std::uint32_t fromVertex = ring[edge], toVertex = ring[(edge + 1) % corners];
    const glm::vec3 from = mesh_.vertices[fromVertex], to = mesh_.vertices[toVertex];
    // Tile borders run along the axes; a flag on another edge means nothing to us.
    std::optional<BorderEdge> border = borderEdge(p, edge, from, to);
    if (!border) continue;
    border->tile = tile_;
    const bool forward = border->atLow == from;
    border->lowVertex = forward ? fromVertex : toVertex;
    border->highVertex = forward ? toVertex : fromVertex;
    borderEdges_.push_back(*border);
  }
}

/// Sweeps along each border line and joins the edges from its two sides where they overlap.
tl::expected<void, Error> Collector::joinBorders(const std::string& name) {
  std::vector<BorderEdge>& edges = borderEdges_;
  std::sort(edges.begin(), edges.end(), [](const BorderEdge& a, const BorderEdge& b) {
    return std::tie(a.axis, a.line, a.polygon, a.edge) <
           std::tie(b.axis, b.line, b.polygon, b.edge);
  });
  // Sound tiles meet a handful of others per edge and storey. Damaged ones could meet all.
  std::size_t meetings = 0;
  std::vector<const BorderEdge*> line;
  std::vector<const BorderEdge*> open[2];
  for (std::size_t begin = 0, end = 0; begin < edges.size(); begin = end) {
    line.clear();
    do {
      line.push_back(&edges[end++]);
    } while (end < edges.size() && edges[end].axis == edges[begin].axis &&
             edges[end].line - edges[end - 1].line <= kWeld);
    std::sort(line.begin(), line.end(), [](const BorderEdge* a, const BorderEdge* b) {
      return std::tie(a->low, a->polygon, a->edge) < std::tie(b->low, b->polygon, b->edge);
    });
    open[0].clear();
    open[1].clear();
    for (const BorderEdge* edge : line) {
      std::vector<const BorderEdge*>& others = open[edge->positive ? 0 : 1];
      std::erase_if(others, [&](const BorderEdge* other) { return other->high <= edge->low; });
      meetings += others.size();
      if (meetings > kMeetingsMax * edges.size()) {
        return failed(
            ErrorCode::kTooLarge,
            fmt::format("{}: its {} border edges overlap more than {} times each, so the tiles "
                        "lie on top of each other. Save it again.",
                        name, edges.size(), kMeetingsMax));
      }
      for (const BorderEdge* other : others) joinEdges(*edge, *other);
      open[edge->positive ? 1 : 0].push_back(edge);
    }
  }
  std::sort(mesh_.borderPortals.begin(), mesh_.borderPortals.end(),
            [](const BorderPortal& a, const BorderPortal& b) {
              return std::tie(a.from, a.fromEdge, a.to, a.toEdge) <
                     std::tie(b.from, b.fromEdge, b.to, b.toEdge);
            });
  return {};
}

void Collector::joinEdges(const BorderEdge& one, const BorderEdge& other) {
  const BorderEdge& from = one.polygon < other.polygon ? one : other;
  const BorderEdge& to = one.polygon < other.polygon ? other : one;
  if (from.tile == to.tile) return;
  if (from.lowVertex == to.lowVertex && from.highVertex == to.highVertex) return;  // a shared edge
  if (const auto portal = portalBetween(from, to, climb_)) mesh_.borderPortals.push_back(*portal);
}

void Collector::dropUnusedVertices() {
  std::vector<std::uint32_t> renumbered(mesh_.vertices.size(), 0);
  for (const std::uint32_t vertex : mesh_.ring) renumbered[vertex] = 1;
  std::uint32_t kept = 0;
  for (std::size_t i = 0; i < renumbered.size(); ++i) {
    if (renumbered[i] == 0) continue;
    mesh_.vertices[kept] = mesh_.vertices[i];
    renumbered[i] = kept++;
  }
  mesh_.vertices.resize(kept);
  for (std::uint32_t& vertex : mesh_.ring) vertex = renumbered[vertex];
}

tl::expected<PolygonMesh, Error> Collector::finish(const std::string& name) && {
  if (mesh_.polygonCount() == 0) {
    return failed(ErrorCode::kSceneEmpty, fmt::format("{}: no polygon in its tiles.", name));
  }
  if (auto joined = joinBorders(name); !joined) return tl::unexpected(joined.error());
  dropUnusedVertices();
  finishHeights();
  return std::move(mesh_);
}

TilePolygons Collector::finishAlone() && {
  const std::size_t vertices = mesh_.vertices.size();
  dropUnusedVertices();
  finishHeights();
  TilePolygons tile;
  tile.welded = mesh_.vertices.size() < vertices;
  tile.mesh = std::move(mesh_);
  tile.borderEdges = std::move(borderEdges_);
  return tile;
}

void Collector::finishHeights() {
  if (mesh_.heightTriangles.empty()) {
    mesh_.heightStart.clear();
  } else {
    mesh_.heightStart.insert(mesh_.heightStart.begin(), 0u);
  }
}

}  // namespace

tl::expected<PolygonMesh, Error> polygonsFromTiles(std::span<const DetourTile> tiles, float climb,
                                                   const std::string& name) {
  Collector collector(climb);
  for (std::size_t i = 0; i < tiles.size(); ++i) {
    const std::string where = fmt::format("{}: tile {}", name, i);
    const auto tile = TileView::open(tiles[i], where);
    if (!tile) return tl::unexpected(tile.error());
    if (auto added = collector.add(*tile, where); !added) return tl::unexpected(added.error());
  }
  return std::move(collector).finish(name);
}

tl::expected<TilePolygons, Error> polygonsOfTile(const DetourTile& bytes,
                                                 std::span<const glm::vec3> places,
                                                 const std::string& where) {
  const auto tile = TileView::open(bytes, where);
  if (!tile) return tl::unexpected(tile.error());
  Collector collector(tile->header().walkableClimb);
  if (auto added = collector.add(*tile, where, places); !added) {
    return tl::unexpected(added.error());
  }
  TilePolygons polygons = std::move(collector).finishAlone();
  const float* low = tile->header().bmin;
  const float* high = tile->header().bmax;
  polygons.low = {low[0], low[1], low[2]};
  polygons.high = {high[0], high[1], high[2]};
  return polygons;
}

}  // namespace forewalk::navmesh
