#include "navmesh/build/detour_tiles.h"

#include <DetourNavMesh.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <optional>
#include <tuple>
#include <unordered_map>
#include <utility>

#include "navmesh/plan.h"

namespace forewalk::navmesh {
namespace {

constexpr float kWeld = 1e-3f;              // metres
constexpr float kCoordinateMax = 1e6f;      // metres; beyond, floats are coarser than a step
constexpr float kFlat = 1e-3f;              // metres; heights closer than that are one height
constexpr std::size_t kMeetingsMax = 4096;  // pairs looked at per border edge, see joinBorders

static_assert(sizeof(dtPolyRef) == 4, "tiles have 32-bit references");
static_assert(sizeof(dtMeshHeader) == 100 && sizeof(dtPoly) == 32 && sizeof(dtLink) == 12 &&
                  sizeof(dtPolyDetail) == 12 && sizeof(dtBVNode) == 16 &&
                  sizeof(dtOffMeshConnection) == 36,
              "the layout of NAVMESH_VERSION 7");

tl::unexpected<Error> failed(ErrorCode code, std::string message) {
  return tl::unexpected(Error{code, std::move(message)});
}

template <typename T>
T readAt(std::span<const std::byte> bytes, std::size_t offset) {
  T value;
  std::memcpy(&value, bytes.data() + offset, sizeof(T));
  return value;
}

bool isPlace(float value) { return std::abs(value) <= kCoordinateMax; }  // false for NaN

/// A tile whose arrays have been found to lie inside its bytes. Views them.
class TileView {
 public:
  static tl::expected<TileView, Error> open(std::span<const std::byte> bytes,
                                            const std::string& where);

  const dtMeshHeader& header() const { return header_; }

  glm::vec3 vertex(std::size_t i) const { return point(verts_, i); }
  glm::vec3 detailVertex(std::size_t i) const { return point(detailVerts_, i); }
  dtPoly polygon(std::size_t i) const {
    return readAt<dtPoly>(bytes_, polys_ + i * sizeof(dtPoly));
  }
  dtPolyDetail detail(std::size_t i) const {
    return readAt<dtPolyDetail>(bytes_, details_ + i * sizeof(dtPolyDetail));
  }
  std::array<unsigned char, 4> detailTriangle(std::size_t i) const {
    return readAt<std::array<unsigned char, 4>>(bytes_, detailTris_ + 4 * i);
  }
  std::size_t offsetOfVertex(std::size_t i) const { return verts_ + 12 * i; }
  std::size_t offsetOfDetailVertex(std::size_t i) const { return detailVerts_ + 12 * i; }
  std::size_t offsetOfPolygon(std::size_t i) const { return polys_ + i * sizeof(dtPoly); }
  std::size_t offsetOfDetail(std::size_t i) const { return details_ + i * sizeof(dtPolyDetail); }
  std::size_t offsetOfDetailTriangle(std::size_t i) const { return detailTris_ + 4 * i; }

 private:
  glm::vec3 point(std::size_t array, std::size_t i) const {
    const auto p = readAt<std::array<float, 3>>(bytes_, array + 12 * i);
    return {p[0], p[1], p[2]};
  }

  std::span<const std::byte> bytes_;
  dtMeshHeader header_;
  std::size_t verts_ = 0, polys_ = 0, details_ = 0, detailVerts_ = 0, detailTris_ = 0;
};

tl::expected<TileView, Error> TileView::open(std::span<const std::byte> bytes,
                                             const std::string& where) {
  if (bytes.size() < sizeof(dtMeshHeader)) {
    return failed(ErrorCode::kDataDamaged,
                  fmt::format("{} ends after {} bytes, its header alone has {}. Save it again.",
                              where, bytes.size(), sizeof(dtMeshHeader)));
  }
  TileView tile;
  tile.bytes_ = bytes;
  tile.header_ = readAt<dtMeshHeader>(bytes, 0);
  const dtMeshHeader& header = tile.header_;
  if (header.magic != DT_NAVMESH_MAGIC) {
    return failed(ErrorCode::kDataDamaged,
                  fmt::format("{} begins with {:08x}, a Detour tile begins with {:08x} (DNAV).",
                              where, static_cast<unsigned>(header.magic), DT_NAVMESH_MAGIC));
  }
  if (header.version != DT_NAVMESH_VERSION) {
    return failed(
        ErrorCode::kFormatUnsupported,
        fmt::format("{} is of Detour navmesh version {}, we read {}. Save it with Recast 1.5 or "
                    "1.6.",
                    where, header.version, DT_NAVMESH_VERSION));
  }

  // The arrays in the order of dtNavMesh::addTile. All element sizes are multiples of 4, so
  // dtAlign4 adds nothing between them.
  struct Part {
    const char* name;
    int count;
    std::size_t size;
    std::size_t* offset;
  };
  std::size_t links = 0, nodes = 0, connections = 0;
  const Part parts[] = {
      {"vertices", header.vertCount, 12, &tile.verts_},
      {"polygons", header.polyCount, sizeof(dtPoly), &tile.polys_},
      {"links", header.maxLinkCount, sizeof(dtLink), &links},
      {"detail meshes", header.detailMeshCount, sizeof(dtPolyDetail), &tile.details_},
      {"detail vertices", header.detailVertCount, 12, &tile.detailVerts_},
      {"detail triangles", header.detailTriCount, 4, &tile.detailTris_},
      {"tree nodes", header.bvNodeCount, sizeof(dtBVNode), &nodes},
      {"off-mesh connections", header.offMeshConCount, sizeof(dtOffMeshConnection), &connections},
  };
  std::size_t end = sizeof(dtMeshHeader);
  for (const Part& part : parts) {
    *part.offset = end;
    if (part.count < 0 || static_cast<std::size_t>(part.count) > (bytes.size() - end) / part.size) {
      return failed(
          ErrorCode::kDataDamaged,
          fmt::format("{} claims {} {} from byte {} on, but has {} bytes in all. Save it again.",
                      where, part.count, part.name, end, bytes.size()));
    }
    end += static_cast<std::size_t>(part.count) * part.size;
  }
  return tile;
}

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
            if (i < found && glm::distance(glm::dvec3(points[i]), glm::dvec3(point)) <= kWeld)
              found = i;
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

/// A polygon edge on a tile's border, as an interval on a line along an axis of the plan.
struct BorderEdge {
  std::uint32_t polygon, edge, tile;
  int axis;                 // of the plan, along which the line runs
  bool positive;            // the polygon lies on the side of smaller coordinates across the line
  float line;               // coordinate across, metres
  float low, high;          // interval along the line, metres
  glm::vec3 atLow, atHigh;  // its ends, world space
  std::uint32_t lowVertex, highVertex;

  double heightAt(double along) const {
    const double t = std::clamp((along - low) / (static_cast<double>(high) - low), 0.0, 1.0);
    return atLow.y + t * (static_cast<double>(atHigh.y) - atLow.y);
  }
};

/// Collects the polygons of tile after tile.
class Collector {
 public:
  explicit Collector(float climb) : climb_(climb) {}

  tl::expected<void, Error> add(const TileView& tile, const std::string& where);
  tl::expected<PolygonMesh, Error> finish(const std::string& name) &&;

 private:
  tl::expected<void, Error> addVertices(const TileView& tile,
                                        const std::vector<std::size_t>& grounds,
                                        const std::string& where);
  void addRing(const dtPoly& polygon);
  tl::expected<void, Error> addHeights(const TileView& tile, std::size_t i, const dtPoly& polygon,
                                       std::size_t& triangles, const std::string& where);
  void addBorderEdges(const dtPoly& polygon);
  tl::expected<void, Error> joinBorders(const std::string& name);
  void joinEdges(const BorderEdge& one, const BorderEdge& other);
  void dropUnusedVertices();

  float climb_;
  PolygonMesh mesh_;
  Welder welder_;
  std::uint32_t tile_ = 0;
  std::vector<std::uint32_t> own_,
      welded_;  // per vertex of the present tile: index in mesh_.vertices
  std::vector<BorderEdge> borderEdges_;
};

tl::expected<void, Error> Collector::add(const TileView& tile, const std::string& where) {
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
  if (auto added = addVertices(tile, grounds, where); !added) return added;
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
                                                 const std::string& where) {
  const auto vertexCount = static_cast<std::size_t>(tile.header().vertCount);
  std::vector<bool> named(vertexCount, false);
  for (const std::size_t i : grounds) {
    const dtPoly polygon = tile.polygon(i);
    for (int k = 0; k < polygon.vertCount; ++k) named[polygon.verts[k]] = true;
  }
  own_.assign(vertexCount, 0);
  welded_.assign(vertexCount, 0);
  for (std::size_t i = 0; i < vertexCount; ++i) {
    if (!named[i]) continue;
    const glm::vec3 vertex = tile.vertex(i);
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
    const glm::vec2 a = toPlan(from), b = toPlan(to);
    const glm::vec2 run = b - a;
    const int along = std::abs(run.x) >= std::abs(run.y) ? 0 : 1, across = 1 - along;
    // Tile borders run along the axes; a flag on another edge means nothing to us.
    if (std::abs(run[across]) > kWeld || std::abs(run[along]) <= kWeld) continue;
    BorderEdge border;
    border.polygon = p;
    border.edge = edge;
    border.tile = tile_;
    border.axis = along;
    // Counter-clockwise: the polygon lies left of its edge.
    border.positive = along == 1 ? run.y > 0.0f : run.x < 0.0f;
    border.line = 0.5f * (a[across] + b[across]);
    const bool forward = run[along] > 0.0f;
    border.low = forward ? a[along] : b[along];
    border.high = forward ? b[along] : a[along];
    border.atLow = forward ? from : to;
    border.atHigh = forward ? to : from;
    border.lowVertex = forward ? fromVertex : toVertex;
    border.highVertex = forward ? toVertex : fromVertex;
    borderEdges_.push_back(border);
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
  if (from.tile == to.tile || std::abs(from.line - to.line) > kWeld) return;
  if (from.lowVertex == to.lowVertex && from.highVertex == to.highVertex) return;  // a shared edge
  double low = std::max(from.low, to.low), high = std::min(from.high, to.high);
  if (high - low <= kWeld) return;

  // Where the two edges are within a step of each other. Their difference in height is linear, so
  // that is an interval too.
  const double gapLow = from.heightAt(low) - to.heightAt(low);
  const double gapHigh = from.heightAt(high) - to.heightAt(high);
  const double slope = (gapHigh - gapLow) / (high - low);
  const double step = climb_;
  const double start = low;
  const auto cut = [&](double limit) { return start + (limit - gapLow) / slope; };
  if (std::max(gapLow, gapHigh) > step) {
    if (std::min(gapLow, gapHigh) > step) return;
    (gapLow > step ? low : high) = cut(step);
  }
  if (std::min(gapLow, gapHigh) < -step) {
    if (std::max(gapLow, gapHigh) < -step) return;
    (gapLow < -step ? low : high) = cut(-step);
  }
  if (high - low <= kWeld) return;

  // An end that is a corner of one of them gets exactly the corner's place, so that paths around it
  // do not bend twice.
  const auto end = [&](double along) {
    glm::vec2 plan;
    plan[from.axis] = static_cast<float>(along);
    plan[1 - from.axis] = from.line;
    for (const BorderEdge* edge : {&to, &from}) {
      if (along == edge->low) plan = toPlan(edge->atLow);
      if (along == edge->high) plan = toPlan(edge->atHigh);
    }
    return toSpace(plan, static_cast<float>(0.5 * (from.heightAt(along) + to.heightAt(along))));
  };
  // Walking out of a counter-clockwise polygon, left is where its edge leads to.
  const bool leftIsHigh = from.axis == 1 ? from.positive : !from.positive;
  mesh_.borderPortals.push_back({PolygonId{from.polygon}, PolygonId{to.polygon}, from.edge, to.edge,
                                 end(leftIsHigh ? high : low), end(leftIsHigh ? low : high)});
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
  if (mesh_.heightTriangles.empty()) {
    mesh_.heightStart.clear();
  } else {
    mesh_.heightStart.insert(mesh_.heightStart.begin(), 0u);
  }
  return std::move(mesh_);
}

/// The header that RecastDemo's Sample::saveAll writes before the tiles.
struct SetHeader {
  std::int32_t magic;
  std::int32_t version;
  std::int32_t tileCount;
  dtNavMeshParams params;
};
static_assert(sizeof(SetHeader) == 40);
constexpr std::int32_t kSetMagic = 'M' << 24 | 'S' << 16 | 'E' << 8 | 'T';
constexpr std::int32_t kCacheMagic = 'T' << 24 | 'S' << 16 | 'E' << 8 | 'T';
constexpr std::int32_t kSetVersion = 1;
constexpr std::size_t kTileHeaderSize = 8;       // tile reference, size of the data
constexpr std::size_t kWideTileHeaderSize = 16;  // with a 64-bit reference, and padded

constexpr std::int32_t reversed(std::int32_t value) {
  const auto v = static_cast<std::uint32_t>(value);
  return static_cast<std::int32_t>((v >> 24) | (v >> 8 & 0xff00u) | (v << 8 & 0xff0000u) |
                                   (v << 24));
}

bool hasTileAt(std::span<const std::byte> bytes, std::size_t offset) {
  return bytes.size() >= offset + sizeof(std::int32_t) &&
         readAt<std::int32_t>(bytes, offset) == DT_NAVMESH_MAGIC;
}

struct TileSet {
  dtNavMeshParams params;
  std::vector<DetourTile> tiles;
};

tl::expected<TileSet, Error> readMset(std::span<const std::byte> bytes, const std::string& name) {
  if (bytes.size() < sizeof(std::int32_t)) {
    return failed(ErrorCode::kFormatUnknown,
                  fmt::format("{}: {} bytes are no navmesh set.", name, bytes.size()));
  }
  const auto magic = readAt<std::int32_t>(bytes, 0);
  if (magic == reversed(kSetMagic)) {
    return failed(
        ErrorCode::kFormatUnsupported,
        fmt::format("{}: this MSET was written on a machine of the other byte order. Save it on "
                    "one like this.",
                    name));
  }
  if (magic == kCacheMagic) {
    return failed(
        ErrorCode::kFormatUnsupported,
        fmt::format("{}: this is a set of compressed tile cache layers (TSET), not of navmesh "
                    "tiles (MSET). Save it from Solo Mesh or Tile Mesh.",
                    name));
  }
  if (magic != kSetMagic) {
    return failed(ErrorCode::kFormatUnknown,
                  fmt::format("{}: begins with {:08x}, a navmesh set begins with {:08x} (MSET).",
                              name, static_cast<std::uint32_t>(magic), kSetMagic));
  }
  if (bytes.size() < sizeof(SetHeader)) {
    return failed(ErrorCode::kDataDamaged,
                  fmt::format("{}: ends after {} bytes, the header has {}. Save it again.", name,
                              bytes.size(), sizeof(SetHeader)));
  }
  const auto header = readAt<SetHeader>(bytes, 0);
  if (header.version != kSetVersion) {
    return failed(ErrorCode::kFormatUnsupported, fmt::format("{}: MSET version {}, we read {}.",
                                                             name, header.version, kSetVersion));
  }
  std::size_t offset = sizeof(SetHeader);
  if (header.tileCount < 1 ||
      static_cast<std::size_t>(header.tileCount) > (bytes.size() - offset) / kTileHeaderSize) {
    return failed(ErrorCode::kDataDamaged,
                  fmt::format("{}: claims {} tiles in {} bytes. Save it again.", name,
                              header.tileCount, bytes.size()));
  }
  if (!hasTileAt(bytes, offset + kTileHeaderSize) &&
      hasTileAt(bytes, offset + kWideTileHeaderSize)) {
    return failed(
        ErrorCode::kFormatUnsupported,
        fmt::format("{}: its tile references have 64 bits (DT_POLYREF64), we read those with 32. "
                    "Save it with a RecastDemo built without DT_POLYREF64.",
                    name));
  }

  TileSet set{header.params, {}};
  for (std::int32_t i = 0; i < header.tileCount; ++i) {
    if (bytes.size() - offset < kTileHeaderSize) {
      return failed(ErrorCode::kDataDamaged,
                    fmt::format("{}: ends at byte {}, before tile {} of {}. Save it again.", name,
                                bytes.size(), i, header.tileCount));
    }
    const auto size = readAt<std::int32_t>(bytes, offset + sizeof(std::uint32_t));
    offset += kTileHeaderSize;
    if (size < 1 || static_cast<std::size_t>(size) > bytes.size() - offset) {
      return failed(
          ErrorCode::kDataDamaged,
          fmt::format("{}: tile {} of {} claims {} bytes from byte {} on, the file has {}. Save "
                      "it again.",
                      name, i, header.tileCount, size, offset, bytes.size()));
    }
    const auto data = bytes.subspan(offset, static_cast<std::size_t>(size));
    set.tiles.emplace_back(data.begin(), data.end());
    offset += static_cast<std::size_t>(size);
  }
  if (offset != bytes.size()) {
    return failed(ErrorCode::kDataDamaged,
                  fmt::format("{}: {} bytes follow the last of {} tiles. Save it again.", name,
                              bytes.size() - offset, header.tileCount));
  }
  return set;
}

/// What the file tells of the settings it was built with.
tl::expected<BuildSettings, Error> settingsOf(const TileSet& set, const std::string& name) {
  auto tile = TileView::open(set.tiles.front(), name + ": tile 0");
  if (!tile) return tl::unexpected(tile.error());
  const dtMeshHeader& header = tile->header();
  constexpr float kWalkerMax = 1000.0f;  // metres
  const auto wrong = [&](const char* what, float value) {
    return failed(
        ErrorCode::kDataDamaged,
        fmt::format("{}: tile 0 is for a walker of {} {} m. Save it again.", name, what, value));
  };
  if (!(header.walkableRadius >= 0.0f && header.walkableRadius <= kWalkerMax)) {
    return wrong("radius", header.walkableRadius);
  }
  if (!(header.walkableHeight > 0.0f && header.walkableHeight <= kWalkerMax)) {
    return wrong("height", header.walkableHeight);
  }
  if (!(header.walkableClimb >= 0.0f && header.walkableClimb <= kWalkerMax)) {
    return wrong("climb", header.walkableClimb);
  }
  BuildSettings settings;
  settings.radius = header.walkableRadius;
  settings.height = header.walkableHeight;
  settings.climb = header.walkableClimb;
  const float cell = 1.0f / header.bvQuantFactor;
  if (cell >= 1e-4f && cell <= kWalkerMax) settings.cell = settings.cellHeight = cell;
  const float side = set.params.tileWidth;
  if (set.params.maxTiles > 1 && side > 0.0f && side <= kCoordinateMax) settings.tile = side;
  return settings;
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

tl::expected<NavMesh, Error> importMset(std::span<const std::byte> bytes, const std::string& name) {
  const auto set = readMset(bytes, name);
  if (!set) return tl::unexpected(set.error());
  const auto settings = settingsOf(*set, name);
  if (!settings) return tl::unexpected(settings.error());
  const auto polygons = polygonsFromTiles(set->tiles, settings->climb, name);
  if (!polygons) return tl::unexpected(polygons.error());
  auto navMesh = makeNavMesh(*polygons, *settings);
  if (!navMesh) {
    return failed(navMesh.error().code, fmt::format("{}: {}", name, navMesh.error().message));
  }
  return navMesh;
}

}  // namespace forewalk::navmesh
