#include "navmesh/build/voxel_grid.h"

#include <Recast.h>
#include <fmt/format.h>

#include <limits>

#include "navmesh/build/recast_limits.h"

namespace forewalk::navmesh {
namespace {

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

}  // namespace

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

double upwardCosine(const Scene& scene, const glm::uvec3& triangle) {
  const glm::dvec3 a(scene.vertices[triangle.x]), b(scene.vertices[triangle.y]),
      c(scene.vertices[triangle.z]);
  const glm::dvec3 normal = glm::cross(b - a, c - a);
  const double length = glm::length(normal);
  return length > 0.0 ? normal.y / length : -1.0;
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

}  // namespace forewalk::navmesh
