// What a forewalk_navmesh is.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "navmesh/world.h"
#include "rdw/session.h"
#include "service/capi/flat_polygons.h"
#include "service/capi/forewalk.h"

/// Only read after it is made, but for `owners` and what is made when first asked for. Sessions
/// hold the world, not this.
struct forewalk_navmesh {
  std::shared_ptr<const forewalk::navmesh::World> world;
  std::vector<std::byte>
      fwmesh;              ///< kept in place of the half-edge mesh, which is several times larger
  std::string scene;       ///< what it was made from, for recordings
  std::uint64_t hash = 0;  ///< FNV-1a of `fwmesh`, for recordings
  std::atomic<std::uint32_t> owners{1};

  /// What all sessions by fronts share. Any thread; the first one makes it.
  std::shared_ptr<const forewalk::prediction::FrontIndex> frontIndex() const {
    std::call_once(frontIndexMade_, [&] { frontIndex_ = forewalk::rdw::makeFrontIndex(*world); });
    return frontIndex_;
  }

  /// For drawing, in `axes`, which is one of the constants. Any thread; the first one makes it.
  const forewalk::capi::FlatPolygons& polygonsIn(forewalk_axes axes) const {
    std::call_once(polygonsMade_[axes],
                   [&] { polygons_[axes] = forewalk::capi::FlatPolygons(world->graph, axes); });
    return polygons_[axes];
  }

 private:
  mutable std::once_flag frontIndexMade_;
  mutable std::array<std::once_flag, 3> polygonsMade_;
  mutable std::array<forewalk::capi::FlatPolygons, 3> polygons_;
  mutable std::shared_ptr<const forewalk::prediction::FrontIndex> frontIndex_;
};

namespace forewalk::capi {

/// Fills a navmesh that was checked into *handle, the caller's. Fails as makeNavGraph does.
forewalk_status handOut(const navmesh::PolygonMesh& polygons, std::vector<std::byte> fwmesh,
                        const char* scene, forewalk_navmesh** handle);

}  // namespace forewalk::capi
