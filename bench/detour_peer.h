// Detour on the same polygons: the peer that prediction is measured against.
//
// A peer for speed, not a reference for truth: see tests/support for that.
#pragma once

#include <DetourNavMesh.h>
#include <DetourNavMeshQuery.h>

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "navmesh/build/detour_tiles.h"
#include "navmesh/locate.h"

namespace forewalk::bench {

/// dtNavMesh over the tiles, and for each PolygonId its dtPolyRef (same order, see detour_tiles.h).
class DetourPeer {
 public:
  /// The polygon ids are those of polygonsFromTiles(tiles). Aborts with a message where Detour
  /// refuses.
  explicit DetourPeer(std::span<const navmesh::DetourTile> tiles);

  struct Visit {
    std::uint32_t polygon;
    std::uint32_t parent;  ///< polygon, or 0xffffffff
    float cost;
  };

  /// findPolysAroundCircle. The result lives until the next call.
  std::span<const Visit> circle(const navmesh::Location& start, float radius);

  /// The same without translating references: what is timed.
  int circleOnly(const navmesh::Location& start, float radius);

  /// The task: circle, then for each leaf of the part of its tree that costs at most `radius`,
  /// getPathFromDijkstraSearch and findStraightPath to the leaf's centroid. Returns the number of
  /// leaves.
  int ways(const navmesh::Location& start, float radius);

  double metresOfWays() const {
    return metres_;
  }  ///< of the last ways(), a proof that work was done

 private:
  struct FreeMesh {
    void operator()(dtNavMesh* mesh) const { dtFreeNavMesh(mesh); }
  };
  struct FreeQuery {
    void operator()(dtNavMeshQuery* query) const { dtFreeNavMeshQuery(query); }
  };

  std::unique_ptr<dtNavMesh, FreeMesh> mesh_;
  std::unique_ptr<dtNavMeshQuery, FreeQuery> query_;
  dtQueryFilter filter_;
  std::vector<dtPolyRef> refOf_;            // per PolygonId
  std::vector<std::uint32_t> firstOfTile_;  // per Detour tile index: its first PolygonId
  std::vector<float> centre_;               // per PolygonId: x, y, z
  std::vector<dtPolyRef> result_, parents_, path_, straightRefs_;
  std::vector<float> cost_, straight_;
  std::vector<unsigned char> straightFlags_;
  std::vector<unsigned char> hasChild_;  // per PolygonId, cleared after use
  std::vector<Visit> visits_;
  double metres_ = 0.0;

  std::uint32_t polygonOf(dtPolyRef ref) const;
};

}  // namespace forewalk::bench
