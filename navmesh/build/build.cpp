#include "navmesh/build/build.h"

#include <DetourAlloc.h>
#include <DetourNavMesh.h>
#include <DetourNavMeshBuilder.h>
#include <Recast.h>
#include <RecastAlloc.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <memory>
#include <mutex>
#include <numbers>
#include <optional>
#include <string>

namespace forewalk::navmesh {
namespace {

// Recast's own limits: bit widths and index types in Recast.h and its sources.
constexpr int kRadiusCellsMax = 127;   // rcErodeWalkableArea compares twice this in a byte
constexpr int kHeightVoxelsMax = 255;  // rcCompactSpan::h has 8 bits
constexpr int kHeightVoxelsMin = 3;    // rcConfig::walkableHeight
constexpr int kSpanTopMax = RC_SPAN_MAX_HEIGHT;            // rcSpan::smax has 13 bits
constexpr std::int64_t kCellsPerSideMax = 65535;           // rcPolyMesh::verts are unsigned short
constexpr std::int64_t kCellsMax = std::int64_t{1} << 26;  // of a heightfield: 8 bytes each
constexpr int kSpansMax = (1 << 24) - 1;                   // rcCompactCell::index has 24 bits
constexpr int kSpansPerColumnMax = 255;                    // rcCompactCell::count has 8 bits
constexpr int kIndexMax = 0xfffe;                          // of vertices and of polygons in a tile
constexpr int kTileCellsMin = 16;                          // below that a tile is nearly all border
constexpr std::int64_t kTilesMax = std::int64_t{1} << 20;
constexpr std::int64_t kWorldCellsMax = std::int64_t{1} << 22;  // keeps grid coordinates in 32 bits

// Scene coordinates are rounded to this fraction of a voxel, as integers. A tile subtracts its own
// corner from them without error, so a wall on a cell line falls to the same side in all tiles.
constexpr int kSubdivision = 256;

template <auto Free>
struct Freed {
  template <typename T>
  void operator()(T* object) const {
    Free(object);
  }
};
using HeightfieldPtr = std::unique_ptr<rcHeightfield, Freed<rcFreeHeightField>>;
using CompactPtr = std::unique_ptr<rcCompactHeightfield, Freed<rcFreeCompactHeightfield>>;
using ContoursPtr = std::unique_ptr<rcContourSet, Freed<rcFreeContourSet>>;
using PolyMeshPtr = std::unique_ptr<rcPolyMesh, Freed<rcFreePolyMesh>>;
using DetailPtr = std::unique_ptr<rcPolyMeshDetail, Freed<rcFreePolyMeshDetail>>;
using DetourBytes = std::unique_ptr<unsigned char, Freed<dtFree>>;

/// Prints nothing; keeps Recast's last error for our own message.
class QuietContext : public rcContext {
 public:
  QuietContext() : rcContext(true) { enableTimer(false); }
  const std::string& lastError() const { return lastError_; }

 private:
  void doLog(const rcLogCategory category, const char* message, const int length) override {
    if (category == RC_LOG_ERROR) lastError_.assign(message, static_cast<std::size_t>(length));
  }
  std::string lastError_;
};

/// The build steps that can lose walkable cells, in the order they run, and the setting behind
/// each.
enum Step : std::size_t { kSlope, kHeight, kClimb, kRadius, kRegion, kContour, kSteps };

/// The settings in voxels, as Recast takes them.
struct Voxels {
  int radius, height, climb;
  int regionMin, regionMerge;
  int edgeMax;
  float edgeError;
  int border;  // extra cells around a tile, so that it sees what its neighbours see
};

/// The one grid that all tiles are cut from. Voxel (0, 0, 0) has its least corner at `origin`.
struct Grid {
  glm::dvec3 origin;
  double cell, cellHeight;
  std::int64_t columns, rows;  // along x and z
  int layers;                  // along y
  std::int64_t tileCells;      // 0: solo
  std::int64_t tilesX, tilesZ;
};

/// A scene on the grid: what rasterizing a tile needs, found once for all tiles.
struct GridScene {
  std::vector<glm::ivec3> vertices;      // 1/kSubdivision voxels from the grid's origin
  std::vector<unsigned char> walkable;   // per triangle: Recast area id
  std::vector<std::size_t> bucketStart;  // tiles + 1 offsets into `bucket`
  std::vector<std::uint32_t> bucket;     // triangles that touch each tile's bounds, border included
};

struct TileCoordinate {
  std::int64_t x, z;
};

struct TileResult {
  DetourTile bytes;                        // empty: nothing walkable here
  std::array<std::size_t, kSteps> left{};  // walkable cells (kContour: polygons) after each step
  // Measured where a step left nothing.
  int headroom = 0;        // kHeight: highest clear space above walkable ground, voxels
  int room = 0;            // kRadius: largest radius that fits somewhere, cells
  std::size_t island = 0;  // kRegion: largest connected area, cells
  std::optional<Error> error;
};

Error settingError(std::string message) {
  return Error{ErrorCode::kSettingOutOfRange, std::move(message)};
}

double degrees(double radians) { return radians * 180.0 / std::numbers::pi; }

// Quotients of floats that mean whole numbers (0.3 / 0.1) miss them by 1e-7; a voxel more or less
// must not depend on that.
constexpr double kQuotientSlack = 1e-4;
int ceilOf(double quotient) { return static_cast<int>(std::ceil(quotient - kQuotientSlack)); }
int floorOf(double quotient) {
  return static_cast<int>(std::min(std::floor(quotient + kQuotientSlack), 1e9));
}

Voxels toVoxels(const BuildSettings& settings) {
  const double cell = settings.cell;
  Voxels voxels;
  voxels.radius = ceilOf(settings.radius / cell);
  voxels.height = ceilOf(static_cast<double>(settings.height) / settings.cellHeight);
  voxels.climb = floorOf(static_cast<double>(settings.climb) / settings.cellHeight);
  voxels.regionMin = floorOf(settings.regionMin / (cell * cell));
  voxels.regionMerge = floorOf(settings.regionMerge / (cell * cell));
  voxels.edgeMax = floorOf(settings.edgeMax / cell);
  voxels.edgeError = static_cast<float>(settings.edgeError / cell);
  voxels.border = settings.tile > 0.0f ? voxels.radius + 3 : 0;
  return voxels;
}

tl::expected<Grid, Error> makeGrid(const Scene& scene, const BuildSettings& settings) {
  glm::dvec3 low(scene.vertices[scene.triangles[0].x]);
  glm::dvec3 high = low;
  for (const glm::uvec3& triangle : scene.triangles) {
    for (int k = 0; k < 3; ++k) {
      const glm::dvec3 vertex(scene.vertices[triangle[k]]);
      low = glm::min(low, vertex);
      high = glm::max(high, vertex);
    }
  }
  Grid grid;
  grid.cell = settings.cell;
  grid.cellHeight = settings.cellHeight;
  // Authored coordinates are mostly round numbers. Half a voxel off, they fall inside voxels
  // instead of on the lines between them, where rounding would decide.
  grid.origin = low - 0.5 * glm::dvec3(grid.cell, grid.cellHeight, grid.cell);
  const glm::dvec3 size = high - grid.origin;

  const double layers = std::floor(size.y / grid.cellHeight) + 2.0;
  if (layers > kSpanTopMax) {
    return tl::unexpected(Error{
        ErrorCode::kTooLarge,
        fmt::format("{}: {:.1f} m high, but with cellHeight {:g} m Recast holds {:.1f} m. Raise "
                    "cellHeight to {:.3f} m.",
                    scene.name, high.y - low.y, settings.cellHeight, kSpanTopMax * grid.cellHeight,
                    1.01 * (high.y - low.y) / (kSpanTopMax - 2))});
  }
  const double across = std::max(size.x, size.z) / grid.cell;
  if (across > static_cast<double>(kWorldCellsMax)) {
    return tl::unexpected(Error{
        ErrorCode::kTooLarge,
        fmt::format("{}: {:.0f} m across is {:.0f} cells of {:g} m, the limit is {}. Raise cell "
                    "to {:.3f} m or cut the scene.",
                    scene.name, across * grid.cell, across, settings.cell, kWorldCellsMax,
                    1.01 * across * grid.cell / static_cast<double>(kWorldCellsMax))});
  }
  grid.layers = static_cast<int>(layers);
  grid.columns = static_cast<std::int64_t>(std::floor(size.x / grid.cell)) + 1;
  grid.rows = static_cast<std::int64_t>(std::floor(size.z / grid.cell)) + 1;

  if (settings.tile > 0.0f) {
    grid.tileCells = std::max(kTileCellsMin, floorOf(settings.tile / grid.cell + 0.5));
    grid.tilesX = (grid.columns + grid.tileCells - 1) / grid.tileCells;
    grid.tilesZ = (grid.rows + grid.tileCells - 1) / grid.tileCells;
    if (grid.tilesX * grid.tilesZ > kTilesMax) {
      return tl::unexpected(
          Error{ErrorCode::kTooLarge,
                fmt::format("{}: {} x {} tiles of {:g} m, the limit is {}. Raise tile or cell.",
                            scene.name, grid.tilesX, grid.tilesZ, settings.tile, kTilesMax)});
    }
  } else {
    grid.tileCells = 0;
    grid.tilesX = grid.tilesZ = 1;
    if (std::max(grid.columns, grid.rows) > kCellsPerSideMax ||
        grid.columns * grid.rows > kCellsMax) {
      return tl::unexpected(Error{
          ErrorCode::kTooLarge,
          fmt::format("{}: {} x {} cells of {:g} m in one piece, the limits are {} a side and {} "
                      "in all. Set tile, for example to {:g} m, or raise cell.",
                      scene.name, grid.columns, grid.rows, settings.cell, kCellsPerSideMax,
                      kCellsMax, 256.0 * settings.cell)});
    }
  }
  return grid;
}

/// Whether somebody can stand on it, and how steep it is. Recast's own test leaves out ground that
/// is exactly as steep as allowed, which with slope 0 is all of it.
double upwardCosine(const Scene& scene, const glm::uvec3& triangle) {
  const glm::dvec3 a(scene.vertices[triangle.x]), b(scene.vertices[triangle.y]),
      c(scene.vertices[triangle.z]);
  const glm::dvec3 normal = glm::cross(b - a, c - a);
  const double length = glm::length(normal);
  return length > 0.0 ? normal.y / length : -1.0;
}

/// Tiles (border included) that a triangle's bounds touch, as half-open ranges.
struct TileRange {
  std::int64_t x0, x1, z0, z1;
};

TileRange tilesTouched(const GridScene& scene, const Grid& grid, int border,
                       const glm::uvec3& triangle) {
  if (grid.tileCells == 0) return {0, 1, 0, 1};
  const auto range = [&](int axis, std::int64_t tiles, std::int64_t& first, std::int64_t& last) {
    const int a = scene.vertices[triangle.x][axis], b = scene.vertices[triangle.y][axis],
              c = scene.vertices[triangle.z][axis];
    const std::int64_t low = std::min({a, b, c}) / kSubdivision - border - 1;
    const std::int64_t high = std::max({a, b, c}) / kSubdivision + border + 1;
    first = std::max<std::int64_t>(0, low / grid.tileCells);
    last = std::min(tiles, high / grid.tileCells + 1);
  };
  TileRange touched;
  range(0, grid.tilesX, touched.x0, touched.x1);
  range(2, grid.tilesZ, touched.z0, touched.z1);
  return touched;
}

GridScene onGrid(const Scene& scene, const Grid& grid, const BuildSettings& settings, int border) {
  GridScene result;
  result.vertices.reserve(scene.vertices.size());
  const glm::dvec3 scale =
      static_cast<double>(kSubdivision) / glm::dvec3(grid.cell, grid.cellHeight, grid.cell);
  const glm::dvec3 limit(static_cast<double>(std::numeric_limits<std::int32_t>::max() / 2));
  for (const glm::vec3& vertex : scene.vertices) {
    // Vertices that no triangle names may lie anywhere.
    const glm::dvec3 scaled = (glm::dvec3(vertex) - grid.origin) * scale;
    result.vertices.emplace_back(glm::round(glm::clamp(scaled, -limit, limit)));
  }

  const double leastCosine = std::cos(static_cast<double>(settings.slope)) - 1e-6;
  result.walkable.reserve(scene.triangles.size());
  for (const glm::uvec3& triangle : scene.triangles) {
    result.walkable.push_back(upwardCosine(scene, triangle) >= leastCosine ? RC_WALKABLE_AREA
                                                                           : RC_NULL_AREA);
  }

  // Buckets by counting: sizes, then offsets, then triangles in ascending order.
  const auto eachTile = [&](const glm::uvec3& triangle, auto&& visit) {
    const TileRange touched = tilesTouched(result, grid, border, triangle);
    for (std::int64_t z = touched.z0; z < touched.z1; ++z) {
      for (std::int64_t x = touched.x0; x < touched.x1; ++x) {
        visit(static_cast<std::size_t>(z * grid.tilesX + x));
      }
    }
  };
  result.bucketStart.assign(static_cast<std::size_t>(grid.tilesX * grid.tilesZ) + 1, 0);
  for (const glm::uvec3& triangle : scene.triangles) {
    eachTile(triangle, [&](std::size_t tile) { ++result.bucketStart[tile + 1]; });
  }
  for (std::size_t i = 1; i < result.bucketStart.size(); ++i) {
    result.bucketStart[i] += result.bucketStart[i - 1];
  }
  result.bucket.resize(result.bucketStart.back());
  std::vector<std::size_t> next = result.bucketStart;
  for (std::size_t i = 0; i < scene.triangles.size(); ++i) {
    eachTile(scene.triangles[i], [&](std::size_t tile) {
      result.bucket[next[tile]++] = static_cast<std::uint32_t>(i);
    });
  }
  return result;
}

std::size_t walkableSpans(const rcHeightfield& field) {
  std::size_t count = 0;
  for (int i = 0; i < field.width * field.height; ++i) {
    for (const rcSpan* span = field.spans[i]; span; span = span->next) {
      count += span->area != RC_NULL_AREA;
    }
  }
  return count;
}

/// Highest clear space above any walkable span, voxels.
int highestHeadroom(const rcHeightfield& field) {
  int highest = 0;
  for (int i = 0; i < field.width * field.height; ++i) {
    for (const rcSpan* span = field.spans[i]; span; span = span->next) {
      if (span->area == RC_NULL_AREA) continue;
      const int ceiling = span->next ? static_cast<int>(span->next->smin) : kSpanTopMax;
      highest = std::max(highest, ceiling - static_cast<int>(span->smax));
    }
  }
  return highest;
}

std::size_t walkableCells(const rcCompactHeightfield& field) {
  return static_cast<std::size_t>(
      std::count_if(field.areas, field.areas + field.spanCount,
                    [](unsigned char area) { return area != RC_NULL_AREA; }));
}

std::size_t cellsInRegions(const rcCompactHeightfield& field) {
  return static_cast<std::size_t>(std::count_if(
      field.spans, field.spans + field.spanCount,
      [](const rcCompactSpan& span) { return span.reg != 0 && (span.reg & RC_BORDER_REG) == 0; }));
}

/// Cells of the largest connected walkable area.
std::size_t largestIsland(const rcCompactHeightfield& field) {
  std::vector<char> seen(static_cast<std::size_t>(field.spanCount), 0);
  struct Place {
    int x, z, span;
  };
  std::vector<Place> open;
  std::size_t largest = 0;
  for (int z = 0; z < field.height; ++z) {
    for (int x = 0; x < field.width; ++x) {
      const rcCompactCell& column = field.cells[x + z * field.width];
      const int first = static_cast<int>(column.index);
      for (int s = first; s < first + static_cast<int>(column.count); ++s) {
        const auto i = static_cast<std::size_t>(s);
        if (field.areas[i] == RC_NULL_AREA || seen[i]) continue;
        std::size_t size = 0;
        seen[i] = 1;
        open.push_back({x, z, s});
        while (!open.empty()) {
          const Place place = open.back();
          open.pop_back();
          ++size;
          for (int direction = 0; direction < 4; ++direction) {
            const int connection = rcGetCon(field.spans[place.span], direction);
            if (connection == RC_NOT_CONNECTED) continue;
            const int nx = place.x + rcGetDirOffsetX(direction);
            const int nz = place.z + rcGetDirOffsetY(direction);
            const int next =
                static_cast<int>(field.cells[nx + nz * field.width].index) + connection;
            const auto n = static_cast<std::size_t>(next);
            if (field.areas[n] == RC_NULL_AREA || seen[n]) continue;
            seen[n] = 1;
            open.push_back({nx, nz, next});
          }
        }
        largest = std::max(largest, size);
      }
    }
  }
  return largest;
}

/// Builds one tile after the other; immutable, so threads share it.
class TileBuilder {
 public:
  TileBuilder(const Scene& scene, const BuildSettings& settings, const Grid& grid)
      : scene_(scene),
        settings_(settings),
        grid_(grid),
        voxels_(toVoxels(settings)),
        gridScene_(onGrid(scene, grid, settings, voxels_.border)) {}

  std::size_t tileCount() const { return static_cast<std::size_t>(grid_.tilesX * grid_.tilesZ); }

  TileResult build(std::size_t tile) const;

  /// Walkable spans of a tile that survive the height and ledge filters with another climb, voxels.
  std::size_t spansWithClimb(std::size_t tile, int climb) const;

  int climbVoxels() const { return voxels_.climb; }

 private:
  TileCoordinate coordinate(std::size_t tile) const {
    const auto i = static_cast<std::int64_t>(tile);
    return {i % grid_.tilesX, i / grid_.tilesX};
  }

  HeightfieldPtr rasterize(QuietContext& context, std::size_t tile, int climb) const;
  bool buildRegions(QuietContext& context, rcCompactHeightfield& field) const;
  Error recastError(std::size_t tile, const char* step, const QuietContext& context) const;
  std::string place(std::size_t tile) const;
  std::string smallerTile() const;
  bool walkableTriangleIn(std::size_t tile) const;
  glm::vec3 tileCorner(TileCoordinate at) const;

  const Scene& scene_;
  const BuildSettings& settings_;
  const Grid& grid_;
  Voxels voxels_;
  GridScene gridScene_;
};

std::string TileBuilder::place(std::size_t tile) const {
  if (grid_.tileCells == 0) return scene_.name;
  const TileCoordinate at = coordinate(tile);
  return fmt::format("{}: tile ({}, {})", scene_.name, at.x, at.z);
}

std::string TileBuilder::smallerTile() const {
  if (grid_.tileCells == 0) {
    return fmt::format("Set tile, for example to {:g} m, or raise cell ({:g} m).",
                       256.0 * grid_.cell, settings_.cell);
  }
  return fmt::format("Lower tile ({:g} m) or raise cell ({:g} m).", settings_.tile, settings_.cell);
}

Error TileBuilder::recastError(std::size_t tile, const char* step,
                               const QuietContext& context) const {
  return Error{
      ErrorCode::kTooLarge,
      fmt::format("{}: {} stopped ({}). {}", place(tile), step,
                  context.lastError().empty() ? "no memory" : context.lastError(), smallerTile())};
}

/// World position of the tile's least corner. One voxel below the grid's origin: the top of the
/// span under ground at height h then reads as h rounded to cellHeight, neither lifted nor sunk on
/// average.
glm::vec3 TileBuilder::tileCorner(TileCoordinate at) const {
  const auto offset = [&](std::int64_t tile) {
    return static_cast<double>(tile * grid_.tileCells) * grid_.cell;
  };
  return glm::vec3(grid_.origin + glm::dvec3(offset(at.x), -0.5 * grid_.cellHeight, offset(at.z)));
}

bool TileBuilder::walkableTriangleIn(std::size_t tile) const {
  for (std::size_t i = gridScene_.bucketStart[tile]; i < gridScene_.bucketStart[tile + 1]; ++i) {
    if (gridScene_.walkable[gridScene_.bucket[i]] != RC_NULL_AREA) return true;
  }
  return false;
}

/// The tile's voxels, or null without memory. Rasterized in units of voxels, then labelled in
/// metres.
HeightfieldPtr TileBuilder::rasterize(QuietContext& context, std::size_t tile, int climb) const {
  const TileCoordinate at = coordinate(tile);
  const int border = voxels_.border;
  const int width =
      static_cast<int>(grid_.tileCells ? grid_.tileCells : grid_.columns) + 2 * border;
  const int depth = static_cast<int>(grid_.tileCells ? grid_.tileCells : grid_.rows) + 2 * border;
  const float low[3] = {static_cast<float>(-border), 0.0f, static_cast<float>(-border)};
  const float high[3] = {static_cast<float>(width - border), static_cast<float>(grid_.layers),
                         static_cast<float>(depth - border)};
  HeightfieldPtr field(rcAllocHeightfield());
  if (!field || !rcCreateHeightfield(&context, *field, width, depth, low, high, 1.0f, 1.0f)) {
    return nullptr;
  }

  const std::size_t begin = gridScene_.bucketStart[tile], end = gridScene_.bucketStart[tile + 1];
  std::vector<float> corners;
  std::vector<unsigned char> areas;
  corners.reserve(9 * (end - begin));
  areas.reserve(end - begin);
  const std::int64_t shiftX = at.x * grid_.tileCells * kSubdivision;
  const std::int64_t shiftZ = at.z * grid_.tileCells * kSubdivision;
  constexpr float kUnit = 1.0f / kSubdivision;
  for (std::size_t i = begin; i < end; ++i) {
    const std::uint32_t triangle = gridScene_.bucket[i];
    for (int k = 0; k < 3; ++k) {
      const glm::ivec3& vertex = gridScene_.vertices[scene_.triangles[triangle][k]];
      corners.push_back(static_cast<float>(vertex.x - shiftX) * kUnit);
      corners.push_back(static_cast<float>(vertex.y) * kUnit);
      corners.push_back(static_cast<float>(vertex.z - shiftZ) * kUnit);
    }
    areas.push_back(gridScene_.walkable[triangle]);
  }
  if (!rcRasterizeTriangles(&context, corners.data(), areas.data(), static_cast<int>(areas.size()),
                            *field, climb)) {
    return nullptr;
  }

  const glm::vec3 corner = tileCorner(at);
  field->cs = settings_.cell;
  field->ch = settings_.cellHeight;
  const double pad = border * grid_.cell;
  field->bmin[0] = static_cast<float>(corner.x - pad);
  field->bmin[1] = corner.y;
  field->bmin[2] = static_cast<float>(corner.z - pad);
  field->bmax[0] = static_cast<float>(corner.x - pad + width * grid_.cell);
  field->bmax[1] = static_cast<float>(corner.y + grid_.layers * grid_.cellHeight);
  field->bmax[2] = static_cast<float>(corner.z - pad + depth * grid_.cell);
  return field;
}

std::size_t TileBuilder::spansWithClimb(std::size_t tile, int climb) const {
  QuietContext context;
  const HeightfieldPtr field = rasterize(context, tile, climb);
  if (!field) return 0;
  rcFilterLowHangingWalkableObstacles(&context, climb, *field);
  rcFilterWalkableLowHeightSpans(&context, voxels_.height, *field);
  rcFilterLedgeSpans(&context, voxels_.height, climb, *field);
  return walkableSpans(*field);
}

bool TileBuilder::buildRegions(QuietContext& context, rcCompactHeightfield& field) const {
  switch (settings_.partition) {
    case Partition::kWatershed:
      return rcBuildDistanceField(&context, field) &&
             rcBuildRegions(&context, field, voxels_.border, voxels_.regionMin,
                            voxels_.regionMerge);
    case Partition::kMonotone:
      return rcBuildRegionsMonotone(&context, field, voxels_.border, voxels_.regionMin,
                                    voxels_.regionMerge);
    case Partition::kLayers:
      return rcBuildLayerRegions(&context, field, voxels_.border, voxels_.regionMin);
  }
  return false;
}

TileResult TileBuilder::build(std::size_t tile) const {
  TileResult result;
  if (!walkableTriangleIn(tile)) return result;
  QuietContext context;
  const auto stopped = [&](const char* step) {
    result.error = recastError(tile, step, context);
    return std::move(result);
  };

  // Voxels, and which of them somebody can stand on. The two filters commute; in this order a low
  // ceiling is blamed on the walker's height.
  HeightfieldPtr solid = rasterize(context, tile, voxels_.climb);
  if (!solid) return stopped("rasterizing");
  rcFilterLowHangingWalkableObstacles(&context, voxels_.climb, *solid);
  result.left[kSlope] = walkableSpans(*solid);
  result.headroom = highestHeadroom(*solid);
  rcFilterWalkableLowHeightSpans(&context, voxels_.height, *solid);
  result.left[kHeight] = walkableSpans(*solid);
  rcFilterLedgeSpans(&context, voxels_.height, voxels_.climb, *solid);
  result.left[kClimb] = walkableSpans(*solid);
  if (result.left[kClimb] == 0) return result;
  if (result.left[kClimb] > kSpansMax) {
    result.error = Error{ErrorCode::kTooLarge,
                         fmt::format("{}: {} walkable cells, the limit is {}. {}", place(tile),
                                     result.left[kClimb], kSpansMax, smallerTile())};
    return result;
  }
  for (int i = 0; i < solid->width * solid->height; ++i) {
    int storeys = 0;
    for (const rcSpan* span = solid->spans[i]; span; span = span->next) {
      storeys += span->area != RC_NULL_AREA;
    }
    if (storeys > kSpansPerColumnMax) {
      result.error =
          Error{ErrorCode::kTooLarge,
                fmt::format("{}: {} walkable floors above each other, the limit is {}. Cut "
                            "the scene by height.",
                            place(tile), storeys, kSpansPerColumnMax)};
      return result;
    }
  }

  // The open space, shrunk by the walker's radius.
  CompactPtr open(rcAllocCompactHeightfield());
  if (!open || !rcBuildCompactHeightfield(&context, voxels_.height, voxels_.climb, *solid, *open) ||
      !context.lastError().empty()) {
    return stopped("joining cells");
  }
  solid.reset();
  const std::vector<unsigned char> beforeErosion(open->areas, open->areas + open->spanCount);
  if (!rcErodeWalkableArea(&context, voxels_.radius, *open)) return stopped("eroding");
  result.left[kRadius] = walkableCells(*open);
  if (result.left[kRadius] == 0) {
    std::copy(beforeErosion.begin(), beforeErosion.end(), open->areas);
    if (!rcBuildDistanceField(&context, *open)) return stopped("measuring distances");
    result.room = open->maxDistance / 2;
    return result;
  }

  // Regions, their outlines, and convex polygons in these.
  if (!buildRegions(context, *open)) return stopped("partitioning");
  result.left[kRegion] = cellsInRegions(*open);
  if (result.left[kRegion] == 0) {
    result.island = largestIsland(*open);
    return result;
  }
  ContoursPtr contours(rcAllocContourSet());
  if (!contours ||
      !rcBuildContours(&context, *open, voxels_.edgeError, voxels_.edgeMax, *contours)) {
    return stopped("tracing contours");
  }
  PolyMeshPtr polygons(rcAllocPolyMesh());
  if (!polygons ||
      !rcBuildPolyMesh(&context, *contours, static_cast<int>(settings_.cornersMax), *polygons)) {
    return stopped("making polygons");
  }
  contours.reset();
  result.left[kContour] = static_cast<std::size_t>(polygons->npolys);
  if (polygons->npolys == 0) return result;
  if (polygons->nverts > kIndexMax || polygons->npolys > kIndexMax) {
    result.error = Error{
        ErrorCode::kTooLarge,
        fmt::format("{}: {} polygons with {} corners, the limit is {} of each. {}", place(tile),
                    polygons->npolys, polygons->nverts, kIndexMax, smallerTile())};
    return result;
  }

  // Recast adds up the tile's corner in floats, each tile with its own rounding; ours is exact.
  const TileCoordinate at = coordinate(tile);
  const glm::vec3 corner = tileCorner(at);
  for (int k = 0; k < 3; ++k) polygons->bmin[k] = corner[k];
  const double width = static_cast<double>(grid_.tileCells ? grid_.tileCells : grid_.columns);
  const double depth = static_cast<double>(grid_.tileCells ? grid_.tileCells : grid_.rows);
  polygons->bmax[0] = static_cast<float>(corner.x + width * grid_.cell);
  polygons->bmax[1] = static_cast<float>(corner.y + (grid_.layers + 1) * grid_.cellHeight);
  polygons->bmax[2] = static_cast<float>(corner.z + depth * grid_.cell);

  // Samples this far apart are none. Recast's own 0 for that never returns in Debian's version.
  constexpr float kCornersOnly = 1e6f;
  const float sample = settings_.detailSample > 0.0f ? settings_.detailSample : kCornersOnly;
  DetailPtr detail(rcAllocPolyMeshDetail());
  if (!detail ||
      !rcBuildPolyMeshDetail(&context, *polygons, *open, sample, settings_.detailError, *detail)) {
    return stopped("sampling heights");
  }
  open.reset();
  // Recast lifts the samples by a voxel above the corners, which Detour takes from the polygons.
  for (int i = 0; i < detail->nverts; ++i) detail->verts[3 * i + 1] -= settings_.cellHeight;
  std::fill(polygons->areas, polygons->areas + polygons->npolys, static_cast<unsigned char>(0));
  std::fill(polygons->flags, polygons->flags + polygons->npolys, static_cast<unsigned short>(1));

  dtNavMeshCreateParams params{};
  params.verts = polygons->verts;
  params.vertCount = polygons->nverts;
  params.polys = polygons->polys;
  params.polyFlags = polygons->flags;
  params.polyAreas = polygons->areas;
  params.polyCount = polygons->npolys;
  params.nvp = polygons->nvp;
  params.detailMeshes = detail->meshes;
  params.detailVerts = detail->verts;
  params.detailVertsCount = detail->nverts;
  params.detailTris = detail->tris;
  params.detailTriCount = detail->ntris;
  params.walkableHeight = settings_.height;
  params.walkableRadius = settings_.radius;
  params.walkableClimb = settings_.climb;
  params.tileX = static_cast<int>(at.x);
  params.tileY = static_cast<int>(at.z);
  rcVcopy(params.bmin, polygons->bmin);
  rcVcopy(params.bmax, polygons->bmax);
  params.cs = settings_.cell;
  params.ch = settings_.cellHeight;
  params.buildBvTree = true;
  unsigned char* data = nullptr;
  int size = 0;
  if (!dtCreateNavMeshData(&params, &data, &size)) return stopped("packing the tile");
  const DetourBytes owned(data);
  const auto* bytes = reinterpret_cast<const std::byte*>(data);
  result.bytes.assign(bytes, bytes + size);
  return result;
}

/// Which setting closed the scene, with the value that would open it.
Error nothingWalkable(const Scene& scene, const BuildSettings& settings, const TileBuilder& builder,
                      const std::vector<TileResult>& tiles) {
  std::array<std::size_t, kSteps> left{};
  int headroom = 0, room = 0;
  std::size_t island = 0;
  for (const TileResult& tile : tiles) {
    for (std::size_t step = 0; step < kSteps; ++step) left[step] += tile.left[step];
    headroom = std::max(headroom, tile.headroom);
    room = std::max(room, tile.room);
    island = std::max(island, tile.island);
  }
  const auto closed = [&](std::string message) {
    return Error{ErrorCode::kNothingWalkable, fmt::format("{}: {}", scene.name, message)};
  };
  const std::size_t step =
      static_cast<std::size_t>(std::find(left.begin(), left.end(), std::size_t{0}) - left.begin());

  if (step == kSlope) {
    double flattest = -1.0;
    for (const glm::uvec3& triangle : scene.triangles) {
      flattest = std::max(flattest, upwardCosine(scene, triangle));
    }
    if (flattest <= 0.0) {
      return closed(fmt::format(
          "none of {} triangles faces up. Turn their winding around, or check the up axis.",
          scene.triangles.size()));
    }
    return closed(
        fmt::format("slope {:.1f} degrees closes all {} triangles: the flattest that faces up has "
                    "{:.1f} degrees.",
                    degrees(settings.slope), scene.triangles.size(),
                    degrees(std::acos(std::min(flattest, 1.0)))));
  }
  if (step == kHeight) {
    return closed(fmt::format(
        "height {:.2f} m closes all walkable ground: the highest space above it is {:.2f} m.",
        settings.height, headroom * settings.cellHeight));
  }
  if (step == kClimb) {
    // The ledge filter keeps its own counsel, so ask it again with other values, in the tile with
    // the most ground.
    const std::size_t tile =
        static_cast<std::size_t>(std::max_element(tiles.begin(), tiles.end(),
                                                  [](const TileResult& a, const TileResult& b) {
                                                    return a.left[kHeight] < b.left[kHeight];
                                                  }) -
                                 tiles.begin());
    int closes = builder.climbVoxels();
    int opens = ceilOf(static_cast<double>(settings.height) / settings.cellHeight) - 1;
    if (opens > closes && builder.spansWithClimb(tile, opens) > 0) {
      while (opens - closes > 1) {
        const int middle = closes + (opens - closes) / 2;
        (builder.spansWithClimb(tile, middle) > 0 ? opens : closes) = middle;
      }
      return closed(
          fmt::format("climb {:.2f} m closes all walkable ground, because it rises or falls more "
                      "from cell to cell: "
                      "{:.2f} m would open it, or a smaller cell ({:g} m).",
                      settings.climb, opens * settings.cellHeight, settings.cell));
    }
    return closed(fmt::format(
        "cell {:g} m closes all walkable ground: no place is wider than two cells between "
        "ledges. Try half of it.",
        settings.cell));
  }
  if (step == kRadius) {
    return closed(fmt::format(
        "radius {:.2f} m closes all walkable ground: at the widest place {:.2f} m fits.",
        settings.radius, room * settings.cell));
  }
  if (step == kRegion) {
    return closed(fmt::format(
        "regionMin {:.2f} m^2 drops all walkable ground: the largest connected piece has {:.2f} "
        "m^2.",
        settings.regionMin,
        static_cast<double>(island) * static_cast<double>(settings.cell) * settings.cell));
  }
  return closed(fmt::format(
      "edgeError {:.2f} m closes all walkable ground: every outline collapses. Try {:.2f} m.",
      settings.edgeError, 1.3 * settings.cell));
}

tl::expected<void, Error> checkScene(const Scene& scene) {
  if (scene.triangles.empty()) {
    return tl::unexpected(
        Error{ErrorCode::kSceneEmpty,
              fmt::format("{}: no triangle in it, so nothing to walk on.", scene.name)});
  }
  for (std::size_t i = 0; i < scene.vertices.size(); ++i) {
    const glm::vec3& vertex = scene.vertices[i];
    if (!std::isfinite(vertex.x) || !std::isfinite(vertex.y) || !std::isfinite(vertex.z)) {
      return tl::unexpected(
          Error{ErrorCode::kDataDamaged, fmt::format("{}: vertex {} is ({}, {}, {}), not a place.",
                                                     scene.name, i, vertex.x, vertex.y, vertex.z)});
    }
  }
  for (std::size_t i = 0; i < scene.triangles.size(); ++i) {
    for (int k = 0; k < 3; ++k) {
      if (scene.triangles[i][k] >= scene.vertices.size()) {
        return tl::unexpected(
            Error{ErrorCode::kDataDamaged,
                  fmt::format("{}: triangle {} names vertex {}, the scene has {}.", scene.name, i,
                              scene.triangles[i][k], scene.vertices.size())});
      }
    }
  }
  return {};
}

}  // namespace

tl::expected<void, Error> checkSettings(const BuildSettings& s) {
  struct Range {
    const char* name;
    float value;
    const char* unit;
    bool inside;
    const char* range;
  };
  // NaN fails every comparison, so it is inside no range; infinity is excluded by the upper bound.
  constexpr float kHuge = 1e9f;
  const Range ranges[] = {
      {"cell", s.cell, " m", s.cell > 0.0f && s.cell < kHuge, "more than 0 m"},
      {"cellHeight", s.cellHeight, " m", s.cellHeight > 0.0f && s.cellHeight < kHuge,
       "more than 0 m"},
      {"radius", s.radius, " m", s.radius >= 0.0f && s.radius < kHuge, "0 m or more"},
      {"height", s.height, " m", s.height > 0.0f && s.height < kHuge, "more than 0 m"},
      {"climb", s.climb, " m", s.climb >= 0.0f && s.climb < s.height,
       "0 m or more, and less than height"},
      {"slope", s.slope, " rad", s.slope >= 0.0f && s.slope < std::numbers::pi_v<float> / 2.0f,
       "0 or more, and less than pi/2 (90 degrees)"},
      {"regionMin", s.regionMin, " m^2", s.regionMin >= 0.0f && s.regionMin < kHuge,
       "0 m^2 or more"},
      {"regionMerge", s.regionMerge, " m^2", s.regionMerge >= 0.0f && s.regionMerge < kHuge,
       "0 m^2 or more"},
      {"edgeMax", s.edgeMax, " m", s.edgeMax >= 0.0f && s.edgeMax < kHuge,
       "0 m (no limit) or more"},
      {"edgeError", s.edgeError, " m", s.edgeError >= 0.0f && s.edgeError < kHuge, "0 m or more"},
      {"detailSample", s.detailSample, " m",
       s.detailSample == 0.0f || (s.detailSample >= 0.9f * s.cell && s.detailSample < kHuge),
       "0 m (corners only), or at least 0.9 cells"},
      {"detailError", s.detailError, " m", s.detailError >= 0.0f && s.detailError < kHuge,
       "0 m or more"},
      {"cornersMax", static_cast<float>(s.cornersMax), "", s.cornersMax >= 3 && s.cornersMax <= 6,
       "3 to 6"},
      {"partition", static_cast<float>(s.partition), "", s.partition <= Partition::kLayers,
       "watershed, monotone or layers"},
      {"tile", s.tile, " m", s.tile >= 0.0f && s.tile < kHuge, "0 m (one piece) or more"},
  };
  for (const Range& range : ranges) {
    if (!range.inside) {
      return tl::unexpected(settingError(fmt::format("{} is {:g}{}, it must be {}.", range.name,
                                                     range.value, range.unit, range.range)));
    }
  }

  // In proportion: Recast keeps these in a few bits each.
  const double cell = s.cell, cellHeight = s.cellHeight;
  if (s.radius / cell > kRadiusCellsMax) {
    return tl::unexpected(settingError(fmt::format(
        "cell is {:g} m, with radius {:g} m it must be at least {:.4f} m (radius / {}).", s.cell,
        s.radius, s.radius / static_cast<double>(kRadiusCellsMax), kRadiusCellsMax)));
  }
  if (s.height / cellHeight > kHeightVoxelsMax ||
      s.height / cellHeight < kHeightVoxelsMin - 1 + kQuotientSlack) {
    return tl::unexpected(settingError(fmt::format(
        "cellHeight is {:g} m, with height {:g} m it must be {:.4f} to {:.4f} m (height / {} to "
        "height / "
        "{}).",
        s.cellHeight, s.height, s.height / static_cast<double>(kHeightVoxelsMax),
        s.height / static_cast<double>(kHeightVoxelsMin), kHeightVoxelsMax, kHeightVoxelsMin)));
  }
  const double tileCells = s.tile / cell;
  const double tileCellsMax =
      std::sqrt(static_cast<double>(kCellsMax)) - 2.0 * (kRadiusCellsMax + 3);
  if (s.tile > 0.0f && (tileCells < kTileCellsMin - kQuotientSlack || tileCells > tileCellsMax)) {
    return tl::unexpected(settingError(fmt::format(
        "tile is {:g} m, with cell {:g} m it must be 0 m (one piece) or {:g} to {:g} m ({} to "
        "{:.0f} cells).",
        s.tile, s.cell, kTileCellsMin * cell, std::floor(tileCellsMax) * cell, kTileCellsMin,
        std::floor(tileCellsMax))));
  }
  return {};
}

tl::expected<std::vector<DetourTile>, Error> buildTiles(const Scene& scene,
                                                        const BuildSettings& settings,
                                                        const BuildRun& run) {
  if (auto checked = checkSettings(settings); !checked) return tl::unexpected(checked.error());
  if (auto checked = checkScene(scene); !checked) return tl::unexpected(checked.error());
  const auto grid = makeGrid(scene, settings);
  if (!grid) return tl::unexpected(grid.error());
  const TileBuilder builder(scene, settings, *grid);

  std::vector<TileResult> results(builder.tileCount());
  std::mutex progressMutex;
  std::size_t done = 0;
  const std::function<void(std::size_t)> work = [&](std::size_t tile) {
    results[tile] = builder.build(tile);
    if (!run.progress) return;
    const std::lock_guard lock(progressMutex);
    run.progress(++done, results.size());
  };
  if (run.forEach) {
    run.forEach(results.size(), work);
  } else {
    for (std::size_t tile = 0; tile < results.size(); ++tile) work(tile);
  }

  std::vector<DetourTile> tiles;
  for (TileResult& result : results) {
    if (result.error) return tl::unexpected(*result.error);
    if (!result.bytes.empty()) tiles.push_back(std::move(result.bytes));
  }
  if (tiles.empty()) return tl::unexpected(nothingWalkable(scene, settings, builder, results));
  return tiles;
}

tl::expected<NavMesh, Error> buildNavMesh(const Scene& scene, const BuildSettings& settings,
                                          const BuildRun& run) {
  const auto tiles = buildTiles(scene, settings, run);
  if (!tiles) return tl::unexpected(tiles.error());
  const auto polygons = polygonsFromTiles(*tiles, settings.climb, scene.name);
  if (!polygons) return tl::unexpected(polygons.error());
  return makeNavMesh(*polygons, settings);
}

}  // namespace forewalk::navmesh
