#include "navmesh/build/tile_view.h"

#include <fmt/format.h>

#include <utility>

namespace forewalk::navmesh {
namespace {

tl::unexpected<Error> failed(ErrorCode code, std::string message) {
  return tl::unexpected(Error{code, std::move(message)});
}

}  // namespace

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

}  // namespace forewalk::navmesh
