#include "navmesh/build/tile_builder.h"

#include <DetourAlloc.h>
#include <DetourNavMesh.h>
#include <DetourNavMeshBuilder.h>
#include <Recast.h>
#include <RecastAlloc.h>
#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <string>

#include "navmesh/build/carve.h"
#include "navmesh/build/recast_limits.h"

namespace forewalk::navmesh {
namespace {

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

// ---- Counting what a step left.

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

/// Walkable spans above each other, at most.
int mostStoreys(const rcHeightfield& field) {
  int most = 0;
  for (int i = 0; i < field.width * field.height; ++i) {
    int storeys = 0;
    for (const rcSpan* span = field.spans[i]; span; span = span->next) {
      storeys += span->area != RC_NULL_AREA;
    }
    most = std::max(most, storeys);
  }
  return most;
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

}  // namespace

/// One tile on its way through the steps. A step returns false where it left nothing to walk on or
/// stopped; then `result_` has what there is to say.
class TileBuild {
 public:
  TileBuild(const TileBuilder& builder, std::size_t tile)
      : scene_(builder.scene_),
        settings_(builder.settings_),
        grid_(builder.grid_),
        voxels_(builder.voxels_),
        gridScene_(builder.gridScene_),
        tile_(tile),
        tileX_(static_cast<std::int64_t>(tile) % grid_.tilesX),
        tileZ_(static_cast<std::int64_t>(tile) / grid_.tilesX) {}

  TileResult run(std::span<const GridObstacle* const> carved) {
    if (hasWalkableTriangle() && findStandableVoxels() && joinOpenSpace() &&
        carveAndErode(carved) && partition() && makePolygons() && sampleHeights()) {
      pack();
    }
    return std::move(result_);
  }

  std::size_t spansWithClimb(int climb) {
    const HeightfieldPtr field = rasterized(climb);
    if (!field) return 0;
    rcFilterLowHangingWalkableObstacles(&context_, climb, *field);
    rcFilterWalkableLowHeightSpans(&context_, voxels_.height, *field);
    rcFilterLedgeSpans(&context_, voxels_.height, climb, *field);
    return walkableSpans(*field);
  }

 private:
  // ---- Where the tile is.

  std::int64_t columns() const { return grid_.tileCells ? grid_.tileCells : grid_.columns; }
  std::int64_t rows() const { return grid_.tileCells ? grid_.tileCells : grid_.rows; }

  /// World position of the tile's least corner. One voxel below the grid's origin: the top of the
  /// span under ground at height h then reads as h rounded to cellHeight, neither lifted nor sunk
  /// on average.
  glm::vec3 corner() const {
    const auto offset = [&](std::int64_t tile) {
      return static_cast<double>(tile * grid_.tileCells) * grid_.cell;
    };
    return glm::vec3(grid_.origin +
                     glm::dvec3(offset(tileX_), -0.5 * grid_.cellHeight, offset(tileZ_)));
  }

  CarvedField carvedField() const {
    return {tileX_ * grid_.tileCells - voxels_.border,
            tileZ_ * grid_.tileCells - voxels_.border,
            grid_.origin.y - 0.5 * grid_.cellHeight,
            grid_.cellHeight,
            settings_.height,
            settings_.climb};
  }

  bool hasWalkableTriangle() const {
    const auto first = gridScene_.bucket.begin();
    return std::any_of(
        first + static_cast<std::ptrdiff_t>(gridScene_.bucketStart[tile_]),
        first + static_cast<std::ptrdiff_t>(gridScene_.bucketStart[tile_ + 1]),
        [&](std::uint32_t triangle) { return gridScene_.walkable[triangle] != RC_NULL_AREA; });
  }

  // ---- What to say where it stops.

  std::string place() const {
    if (grid_.tileCells == 0) return scene_.name;
    return fmt::format("{}: tile ({}, {})", scene_.name, tileX_, tileZ_);
  }

  std::string smallerTile() const {
    if (grid_.tileCells == 0) {
      return fmt::format("Set tile, for example to {:g} m, or raise cell ({:g} m).",
                         256.0 * grid_.cell, settings_.cell);
    }
    return fmt::format("Lower tile ({:g} m) or raise cell ({:g} m).", settings_.tile,
                       settings_.cell);
  }

  bool tooLarge(const std::string& what) {
    result_.error = Error{ErrorCode::kTooLarge, fmt::format("{}: {}", place(), what)};
    return false;
  }

  bool stopped(const char* step) {
    return tooLarge(fmt::format("{} stopped ({}). {}", step,
                                context_.lastError().empty() ? "no memory" : context_.lastError(),
                                smallerTile()));
  }

  // ---- The steps.

  /// The tile's voxels, or null without memory. Rasterized in units of voxels, then labelled in
  /// metres.
  HeightfieldPtr rasterized(int climb) {
    const int border = voxels_.border;
    const int width = static_cast<int>(columns()) + 2 * border;
    const int depth = static_cast<int>(rows()) + 2 * border;
    const float low[3] = {static_cast<float>(-border), 0.0f, static_cast<float>(-border)};
    const float high[3] = {static_cast<float>(width - border), static_cast<float>(grid_.layers),
                           static_cast<float>(depth - border)};
    HeightfieldPtr field(rcAllocHeightfield());
    if (!field || !rcCreateHeightfield(&context_, *field, width, depth, low, high, 1.0f, 1.0f)) {
      return nullptr;
    }

    const std::size_t begin = gridScene_.bucketStart[tile_],
                      end = gridScene_.bucketStart[tile_ + 1];
    std::vector<float> corners;
    std::vector<unsigned char> areas;
    corners.reserve(9 * (end - begin));
    areas.reserve(end - begin);
    const std::int64_t shiftX = tileX_ * grid_.tileCells * kSubdivision;
    const std::int64_t shiftZ = tileZ_ * grid_.tileCells * kSubdivision;
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
    if (!rcRasterizeTriangles(&context_, corners.data(), areas.data(),
                              static_cast<int>(areas.size()), *field, climb)) {
      return nullptr;
    }

    const glm::vec3 least = corner();
    field->cs = settings_.cell;
    field->ch = settings_.cellHeight;
    const double pad = border * grid_.cell;
    field->bmin[0] = static_cast<float>(least.x - pad);
    field->bmin[1] = least.y;
    field->bmin[2] = static_cast<float>(least.z - pad);
    field->bmax[0] = static_cast<float>(least.x - pad + width * grid_.cell);
    field->bmax[1] = static_cast<float>(least.y + grid_.layers * grid_.cellHeight);
    field->bmax[2] = static_cast<float>(least.z - pad + depth * grid_.cell);
    return field;
  }

  /// Voxels, and which of them somebody can stand on. The two filters commute; in this order a low
  /// ceiling is blamed on the walker's height.
  bool findStandableVoxels() {
    solid_ = rasterized(voxels_.climb);
    if (!solid_) return stopped("rasterizing");
    rcFilterLowHangingWalkableObstacles(&context_, voxels_.climb, *solid_);
    result_.left[kSlope] = walkableSpans(*solid_);
    result_.headroom = highestHeadroom(*solid_);
    rcFilterWalkableLowHeightSpans(&context_, voxels_.height, *solid_);
    result_.left[kHeight] = walkableSpans(*solid_);
    rcFilterLedgeSpans(&context_, voxels_.height, voxels_.climb, *solid_);
    result_.left[kClimb] = walkableSpans(*solid_);
    if (result_.left[kClimb] == 0) return false;
    if (result_.left[kClimb] > kSpansMax) {
      return tooLarge(fmt::format("{} walkable cells, the limit is {}. {}", result_.left[kClimb],
                                  kSpansMax, smallerTile()));
    }
    if (const int storeys = mostStoreys(*solid_); storeys > kSpansPerColumnMax) {
      return tooLarge(
          fmt::format("{} walkable floors above each other, the limit is {}. Cut the "
                      "scene by height.",
                      storeys, kSpansPerColumnMax));
    }
    return true;
  }

  bool joinOpenSpace() {
    open_.reset(rcAllocCompactHeightfield());
    const bool joined =
        open_ &&
        rcBuildCompactHeightfield(&context_, voxels_.height, voxels_.climb, *solid_, *open_) &&
        context_.lastError().empty();
    solid_.reset();
    return joined || stopped("joining cells");
  }

  /// Takes the obstacles' ground, then what is nearer than the walker's radius to anything.
  bool carveAndErode(std::span<const GridObstacle* const> carved) {
    for (const GridObstacle* obstacle : carved) carve(*obstacle, carvedField(), *open_);
    const std::vector<unsigned char> before(open_->areas, open_->areas + open_->spanCount);
    if (!rcErodeWalkableArea(&context_, voxels_.radius, *open_)) return stopped("eroding");
    result_.left[kRadius] = walkableCells(*open_);
    if (result_.left[kRadius] > 0) return true;
    std::copy(before.begin(), before.end(), open_->areas);
    if (!rcBuildDistanceField(&context_, *open_)) return stopped("measuring distances");
    result_.room = open_->maxDistance / 2;
    return false;
  }

  /// Cuts the open space into regions.
  bool partition() {
    if (!buildRegions(*open_)) return stopped("partitioning");
    result_.left[kRegion] = cellsInRegions(*open_);
    if (result_.left[kRegion] == 0) result_.island = largestIsland(*open_);
    return result_.left[kRegion] > 0;
  }

  bool buildRegions(rcCompactHeightfield& field) {
    switch (settings_.partition) {
      case Partition::kWatershed:
        return rcBuildDistanceField(&context_, field) &&
               rcBuildRegions(&context_, field, voxels_.border, voxels_.regionMin,
                              voxels_.regionMerge);
      case Partition::kMonotone:
        return rcBuildRegionsMonotone(&context_, field, voxels_.border, voxels_.regionMin,
                                      voxels_.regionMerge);
      case Partition::kLayers:
        return rcBuildLayerRegions(&context_, field, voxels_.border, voxels_.regionMin);
    }
    return false;
  }

  bool makePolygons() {
    const ContoursPtr contours(rcAllocContourSet());
    if (!contours ||
        !rcBuildContours(&context_, *open_, voxels_.edgeError, voxels_.edgeMax, *contours)) {
      return stopped("tracing contours");
    }
    polygons_.reset(rcAllocPolyMesh());
    if (!polygons_ || !rcBuildPolyMesh(&context_, *contours, static_cast<int>(settings_.cornersMax),
                                       *polygons_)) {
      return stopped("making polygons");
    }
    result_.left[kContour] = static_cast<std::size_t>(polygons_->npolys);
    if (polygons_->npolys == 0) return false;
    if (polygons_->nverts > kIndexMax || polygons_->npolys > kIndexMax) {
      return tooLarge(fmt::format("{} polygons with {} corners, the limit is {} of each. {}",
                                  polygons_->npolys, polygons_->nverts, kIndexMax, smallerTile()));
    }
    // Recast adds up the tile's corner in floats, each tile with its own rounding; ours is exact.
    const glm::vec3 least = corner();
    for (int k = 0; k < 3; ++k) polygons_->bmin[k] = least[k];
    polygons_->bmax[0] = static_cast<float>(least.x + static_cast<double>(columns()) * grid_.cell);
    polygons_->bmax[1] = static_cast<float>(least.y + (grid_.layers + 1) * grid_.cellHeight);
    polygons_->bmax[2] = static_cast<float>(least.z + static_cast<double>(rows()) * grid_.cell);
    return true;
  }

  bool sampleHeights() {
    // Samples this far apart are none. Recast's own 0 for that never returns in Debian's version.
    constexpr float kCornersOnly = 1e6f;
    const float sample = settings_.detailSample > 0.0f ? settings_.detailSample : kCornersOnly;
    heights_.reset(rcAllocPolyMeshDetail());
    if (!heights_ || !rcBuildPolyMeshDetail(&context_, *polygons_, *open_, sample,
                                            settings_.detailError, *heights_)) {
      return stopped("sampling heights");
    }
    // Recast lifts the samples by a voxel above the corners, which Detour takes from the
    // polygons_->
    for (int i = 0; i < heights_->nverts; ++i) heights_->verts[3 * i + 1] -= settings_.cellHeight;
    open_.reset();
    return true;
  }

  void pack() {
    std::fill(polygons_->areas, polygons_->areas + polygons_->npolys,
              static_cast<unsigned char>(0));
    std::fill(polygons_->flags, polygons_->flags + polygons_->npolys,
              static_cast<unsigned short>(1));

    dtNavMeshCreateParams params{};
    params.verts = polygons_->verts;
    params.vertCount = polygons_->nverts;
    params.polys = polygons_->polys;
    params.polyFlags = polygons_->flags;
    params.polyAreas = polygons_->areas;
    params.polyCount = polygons_->npolys;
    params.nvp = polygons_->nvp;
    params.detailMeshes = heights_->meshes;
    params.detailVerts = heights_->verts;
    params.detailVertsCount = heights_->nverts;
    params.detailTris = heights_->tris;
    params.detailTriCount = heights_->ntris;
    params.walkableHeight = settings_.height;
    params.walkableRadius = settings_.radius;
    params.walkableClimb = settings_.climb;
    params.tileX = static_cast<int>(tileX_);
    params.tileY = static_cast<int>(tileZ_);
    rcVcopy(params.bmin, polygons_->bmin);
    rcVcopy(params.bmax, polygons_->bmax);
    params.cs = settings_.cell;
    params.ch = settings_.cellHeight;
    params.buildBvTree = true;
    unsigned char* data = nullptr;
    int size = 0;
    if (!dtCreateNavMeshData(&params, &data, &size)) {
      stopped("packing the tile");
      return;
    }
    const DetourBytes owned(data);
    const auto* bytes = reinterpret_cast<const std::byte*>(data);
    result_.bytes.assign(bytes, bytes + size);
  }

  const Scene& scene_;
  const BuildSettings& settings_;
  const Grid& grid_;
  const Voxels& voxels_;
  const GridScene& gridScene_;
  const std::size_t tile_;
  const std::int64_t tileX_, tileZ_;
  QuietContext context_;
  HeightfieldPtr solid_;
  CompactPtr open_;
  PolyMeshPtr polygons_;
  DetailPtr heights_;
  TileResult result_;
};

TileBuilder::TileBuilder(const Scene& scene, const BuildSettings& settings, const Grid& grid)
    : scene_(scene),
      settings_(settings),
      grid_(grid),
      voxels_(toVoxels(settings)),
      gridScene_(onGrid(scene, grid, settings, voxels_.border)) {}

TileResult TileBuilder::build(std::size_t tile, std::span<const GridObstacle* const> carved) const {
  return TileBuild(*this, tile).run(carved);
}

std::size_t TileBuilder::spansWithClimb(std::size_t tile, int climb) const {
  return TileBuild(*this, tile).spansWithClimb(climb);
}

}  // namespace forewalk::navmesh
