// Navmeshes that have been built: what frames walk on.
#include <cstring>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "navmesh/build/fwmesh_flat.h"
#include "service/capi/log.h"
#include "service/capi/navmesh_handle.h"
#include "service/capi/status.h"

namespace forewalk::capi {

forewalk_status handOut(const navmesh::PolygonMesh& polygons, std::vector<std::byte> fwmesh,
                        const char* scene, forewalk_navmesh** handle) {
  auto graph = navmesh::makeNavGraph(polygons);
  if (!graph) return fail(graph.error());
  auto made = std::make_unique<forewalk_navmesh>();
  made->world = std::make_shared<const navmesh::World>(navmesh::makeWorld(std::move(*graph)));
  made->hash = 14695981039346656037u;
  for (const std::byte byte : fwmesh) {
    made->hash = (made->hash ^ std::to_integer<std::uint64_t>(byte)) * 0x100000001b3u;
  }
  made->fwmesh = std::move(fwmesh);
  made->scene = scene;
  tell(FOREWALK_LOG_INFO, "navmesh: {} polygons.", made->world->graph.polygonCount());
  *handle = made.release();
  return FOREWALK_OK;
}

}  // namespace forewalk::capi

using namespace forewalk;
using namespace forewalk::capi;

extern "C" {

forewalk_status forewalk_navmesh_from_fwmesh(const void* bytes, size_t byte_count,
                                             forewalk_navmesh** navmesh) {
  if (navmesh != nullptr) *navmesh = nullptr;
  if (navmesh == nullptr || (bytes == nullptr && byte_count > 0)) {
    return failLiteral(FOREWALK_ERROR_ARGUMENT,
                       "forewalk_navmesh_from_fwmesh: bytes or navmesh is null.");
  }
  return guarded([&]() -> forewalk_status {
    const std::span<const std::byte> span(static_cast<const std::byte*>(bytes), byte_count);
    const auto flat = navmesh::loadFlatFwmesh(span, "fwmesh in memory");
    if (!flat) return fail(flat.error());
    return handOut(flat->polygons, {span.begin(), span.end()}, "fwmesh in memory", navmesh);
  });
}

forewalk_status forewalk_navmesh_save(const forewalk_navmesh* navmesh, void* buffer,
                                      size_t* byte_count) {
  if (navmesh == nullptr || byte_count == nullptr) {
    return failLiteral(FOREWALK_ERROR_ARGUMENT,
                       "forewalk_navmesh_save: navmesh or byte_count is null.");
  }
  const std::size_t room = *byte_count;
  *byte_count = navmesh->fwmesh.size();
  if (buffer == nullptr) return FOREWALK_OK;
  if (room < navmesh->fwmesh.size()) {
    return guarded([&] {
      return fail(FOREWALK_ERROR_ARGUMENT,
                  "forewalk_navmesh_save: the buffer has " + std::to_string(room) + " bytes, " +
                      std::to_string(navmesh->fwmesh.size()) + " are needed.");
    });
  }
  std::memcpy(buffer, navmesh->fwmesh.data(), navmesh->fwmesh.size());
  return FOREWALK_OK;
}

uint32_t forewalk_navmesh_polygon_count(const forewalk_navmesh* navmesh) {
  return navmesh == nullptr ? 0 : navmesh->world->graph.polygonCount();
}

forewalk_status forewalk_navmesh_polygons(const forewalk_navmesh* navmesh, forewalk_axes axes,
                                          forewalk_navmesh_view* view) {
  if (navmesh == nullptr || view == nullptr) {
    return failLiteral(FOREWALK_ERROR_ARGUMENT,
                       "forewalk_navmesh_polygons: navmesh or view is null.");
  }
  if (!isKnownSize<forewalk_navmesh_view>(view->struct_size)) {
    return failLiteral(FOREWALK_ERROR_ARGUMENT,
                       "forewalk_navmesh_polygons: no version has had the view's struct_size. Set "
                       "it to sizeof(forewalk_navmesh_view).");
  }
  return guarded([&]() -> forewalk_status {
    if (axes < FOREWALK_AXES_OPENXR || axes > FOREWALK_AXES_UNREAL) {
      return unknownConstant("forewalk_navmesh_polygons", "axes", axes, FOREWALK_AXES_UNREAL);
    }
    copyKnown(navmesh->polygonsIn(axes).view(), *view);
    return FOREWALK_OK;
  });
}

void forewalk_navmesh_retain(forewalk_navmesh* navmesh) {
  if (navmesh != nullptr) navmesh->owners.fetch_add(1, std::memory_order_relaxed);
}

void forewalk_navmesh_release(forewalk_navmesh* navmesh) {
  if (navmesh == nullptr) return;
  if (navmesh->owners.fetch_sub(1, std::memory_order_acq_rel) == 1) delete navmesh;
}

}  // extern "C"
