// The bytes of one Detour tile, checked and viewed. Internal to the builders.
#pragma once

#include <DetourNavMesh.h>

#include <array>
#include <cstddef>
#include <cstring>
#include <glm/glm.hpp>
#include <span>
#include <string>
#include <tl/expected.hpp>

#include "navmesh/error.h"

namespace forewalk::navmesh {

static_assert(sizeof(dtPolyRef) == 4, "tiles have 32-bit references");
static_assert(sizeof(dtMeshHeader) == 100 && sizeof(dtPoly) == 32 && sizeof(dtLink) == 12 &&
                  sizeof(dtPolyDetail) == 12 && sizeof(dtBVNode) == 16 &&
                  sizeof(dtOffMeshConnection) == 36,
              "the layout of NAVMESH_VERSION 7");

/// What lies at `offset`, which is checked.
template <typename T>
T readAt(std::span<const std::byte> bytes, std::size_t offset) {
  T value;
  std::memcpy(&value, bytes.data() + offset, sizeof(T));
  return value;
}

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

}  // namespace forewalk::navmesh
