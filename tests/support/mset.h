// Detour tiles as RecastDemo keeps them.
#pragma once

#include <DetourNavMesh.h>

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <vector>

#include "navmesh/build/detour_tiles.h"

namespace forewalk::testing {

/// The dtNavMesh parameters that hold these tiles. `tiles` must be sound and not empty.
inline dtNavMeshParams gridOf(const std::vector<navmesh::DetourTile>& tiles) {
  dtNavMeshParams params{};
  int polygons = 1;
  for (const navmesh::DetourTile& tile : tiles) {
    dtMeshHeader header;
    std::memcpy(&header, tile.data(), sizeof(header));
    params.tileWidth = header.bmax[0] - header.bmin[0];
    params.tileHeight = header.bmax[2] - header.bmin[2];
    params.orig[0] = header.bmin[0] - static_cast<float>(header.x) * params.tileWidth;
    params.orig[1] = header.bmin[1];
    params.orig[2] = header.bmin[2] - static_cast<float>(header.y) * params.tileHeight;
    polygons = std::max(polygons, header.polyCount);
  }
  const auto powerOfTwo = [](int least) {
    int power = 1;
    while (power < least) power *= 2;
    return power;
  };
  params.maxTiles = powerOfTwo(static_cast<int>(tiles.size()));
  params.maxPolys = powerOfTwo(polygons);
  return params;
}

/// The bytes that RecastDemo's Sample::saveAll writes.
inline std::vector<std::byte> msetOf(const std::vector<navmesh::DetourTile>& tiles) {
  std::vector<std::byte> bytes;
  const auto append = [&](const void* data, std::size_t size) {
    bytes.resize(bytes.size() + size);
    std::memcpy(bytes.data() + bytes.size() - size, data, size);
  };
  const int magic = 'M' << 24 | 'S' << 16 | 'E' << 8 | 'T', version = 1;
  const int count = static_cast<int>(tiles.size());
  const dtNavMeshParams params = gridOf(tiles);
  append(&magic, sizeof(magic));
  append(&version, sizeof(version));
  append(&count, sizeof(count));
  append(&params, sizeof(params));
  for (std::size_t i = 0; i < tiles.size(); ++i) {
    const auto reference = static_cast<dtTileRef>(i + 1);
    const int size = static_cast<int>(tiles[i].size());
    append(&reference, sizeof(reference));
    append(&size, sizeof(size));
    append(tiles[i].data(), tiles[i].size());
  }
  return bytes;
}

}  // namespace forewalk::testing
