// RecastDemo's files of tiles (`MSET`).
#include <DetourNavMesh.h>
#include <fmt/format.h>

#include <cmath>
#include <cstdint>
#include <utility>

#include "navmesh/build/detour_tiles.h"
#include "navmesh/build/tile_view.h"

namespace forewalk::navmesh {
namespace {

constexpr float kCoordinateMax = 1e6f;  // metres

tl::unexpected<Error> failed(ErrorCode code, std::string message) {
  return tl::unexpected(Error{code, std::move(message)});
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
