#include "bench/detour_peer.h"

#include <DetourCommon.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>

namespace forewalk::bench {

namespace {

constexpr int kMaxNodes = 65535;
constexpr int kMaxCorners = 1024;

void require(bool done, const char* what) {
  if (done) return;
  std::fprintf(stderr, "Detour refused: %s\n", what);
  std::abort();
}

}  // namespace

DetourPeer::DetourPeer(std::span<const navmesh::DetourTile> tiles) : mesh_(dtAllocNavMesh()) {
  const auto headerOf = [](const navmesh::DetourTile& tile) {
    dtMeshHeader header;
    std::memcpy(&header, tile.data(), sizeof header);
    return header;
  };
  require(!tiles.empty(), "no tiles");
  dtNavMeshParams params{};
  const dtMeshHeader first = headerOf(tiles.front());
  int polygons = 1;
  for (const auto& tile : tiles) polygons = std::max(polygons, headerOf(tile).polyCount);
  // Where tile (0, 0) would lie: its border lines decide which tiles touch.
  params.tileWidth = first.bmax[0] - first.bmin[0];
  params.tileHeight = first.bmax[2] - first.bmin[2];
  params.orig[0] = first.bmin[0] - static_cast<float>(first.x) * params.tileWidth;
  params.orig[1] = first.bmin[1];
  params.orig[2] = first.bmin[2] - static_cast<float>(first.y) * params.tileHeight;
  params.maxTiles = static_cast<int>(tiles.size());
  params.maxPolys = polygons;
  require(dtStatusSucceed(mesh_->init(&params)), "dtNavMesh::init");
  firstOfTile_.resize(tiles.size());
  for (const auto& tile : tiles) {
    unsigned char* bytes =
        static_cast<unsigned char*>(dtAlloc(static_cast<int>(tile.size()), DT_ALLOC_PERM));
    std::memcpy(bytes, tile.data(), tile.size());
    dtTileRef ref = 0;
    require(dtStatusSucceed(
                mesh_->addTile(bytes, static_cast<int>(tile.size()), DT_TILE_FREE_DATA, 0, &ref)),
            "dtNavMesh::addTile");
    const dtMeshTile* added = mesh_->getTileByRef(ref);
    const dtPolyRef base = mesh_->getPolyRefBase(added);
    firstOfTile_[static_cast<std::size_t>(mesh_->decodePolyIdTile(base))] =
        static_cast<std::uint32_t>(refOf_.size());
    for (int i = 0; i < added->header->polyCount; ++i) {
      const dtPoly& poly = added->polys[i];
      if (poly.getType() != DT_POLYTYPE_GROUND) continue;
      refOf_.push_back(base | static_cast<dtPolyRef>(i));
      float centre[3];
      dtCalcPolyCenter(centre, poly.verts, poly.vertCount, added->verts);
      centre_.insert(centre_.end(), centre, centre + 3);
    }
  }
  query_.reset(dtAllocNavMeshQuery());
  require(dtStatusSucceed(query_->init(mesh_.get(), kMaxNodes)), "dtNavMeshQuery::init");
  result_.resize(kMaxNodes);
  parents_.resize(kMaxNodes);
  cost_.resize(kMaxNodes);
  path_.resize(kMaxNodes);
  straight_.resize(3 * kMaxCorners);
  straightFlags_.resize(kMaxCorners);
  straightRefs_.resize(kMaxCorners);
  hasChild_.resize(refOf_.size());
}

std::uint32_t DetourPeer::polygonOf(dtPolyRef ref) const {
  if (ref == 0) return 0xffffffffu;
  return firstOfTile_[mesh_->decodePolyIdTile(ref)] + mesh_->decodePolyIdPoly(ref);
}

int DetourPeer::circleOnly(const navmesh::Location& start, float radius) {
  const glm::vec3 at = start.position();
  int count = 0;
  query_->findPolysAroundCircle(refOf_[navmesh::index(start.polygon)], &at.x, radius, &filter_,
                                result_.data(), parents_.data(), cost_.data(), &count, kMaxNodes);
  return count;
}

std::span<const DetourPeer::Visit> DetourPeer::circle(const navmesh::Location& start,
                                                      float radius) {
  const int count = circleOnly(start, radius);
  visits_.clear();
  for (int i = 0; i < count; ++i) {
    const std::size_t k = static_cast<std::size_t>(i);
    visits_.push_back({polygonOf(result_[k]), polygonOf(parents_[k]), cost_[k]});
  }
  return visits_;
}

int DetourPeer::ways(const navmesh::Location& start, float radius) {
  const int count = circleOnly(start, radius);
  const glm::vec3 from = start.position();
  metres_ = 0.0;
  int leaves = 0;
  for (int i = 0; i < count; ++i) {
    const std::size_t k = static_cast<std::size_t>(i);
    if (cost_[k] <= radius && parents_[k] != 0) hasChild_[polygonOf(parents_[k])] = 1;
  }
  for (int i = 0; i < count; ++i) {
    const std::size_t k = static_cast<std::size_t>(i);
    const std::uint32_t polygon = polygonOf(result_[k]);
    if (cost_[k] > radius || hasChild_[polygon] != 0) continue;
    int steps = 0;
    query_->getPathFromDijkstraSearch(result_[k], path_.data(), &steps, kMaxNodes);
    int corners = 0;
    query_->findStraightPath(&from.x, &centre_[std::size_t{3} * polygon], path_.data(), steps,
                             straight_.data(), straightFlags_.data(), straightRefs_.data(),
                             &corners, kMaxCorners);
    for (int c = 1; c < corners; ++c) {
      metres_ += static_cast<double>(dtVdist(&straight_[static_cast<std::size_t>(3 * c - 3)],
                                             &straight_[static_cast<std::size_t>(3 * c)]));
    }
    ++leaves;
  }
  for (int i = 0; i < count; ++i) {
    const std::size_t k = static_cast<std::size_t>(i);
    if (parents_[k] != 0) hasChild_[polygonOf(parents_[k])] = 0;
  }
  return leaves;
}

}  // namespace forewalk::bench
