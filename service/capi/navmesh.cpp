#include <cmath>
#include <filesystem>
#include <string_view>
#include <utility>

#include "navmesh/build/build.h"
#include "navmesh/build/fwmesh.h"
#include "service/capi/build_settings.h"
#include "service/capi/log.h"
#include "service/capi/navmesh_handle.h"
#include "service/capi/status.h"
#include "service/files.h"
#include "service/parallel.h"

namespace forewalk::capi {

namespace {

navmesh::BuildRun onAllCores() { return {service::onThreads(0), {}}; }

forewalk_status handOut(const tl::expected<navmesh::NavMesh, Error>& navMesh, const char* scene,
                        forewalk_navmesh** handle) {
  if (!navMesh) return fail(navMesh.error());
  auto world = service::makeWorld(*navMesh);
  if (!world) return fail(world.error());
  auto made = std::make_unique<forewalk_navmesh>();
  made->world = std::move(*world);
  made->fwmesh = navmesh::saveFwmesh(*navMesh);
  made->scene = scene;
  tell(FOREWALK_LOG_INFO, "navmesh: {} polygons.", made->world->graph.polygonCount());
  *handle = made.release();
  return FOREWALK_OK;
}

}  // namespace

}  // namespace forewalk::capi

using namespace forewalk;
using namespace forewalk::capi;

extern "C" {

void forewalk_build_settings_init(forewalk_build_settings* settings) {
  if (settings != nullptr) *settings = defaultBuildSettings();
}

forewalk_status forewalk_navmesh_from_file(const char* path,
                                           const forewalk_build_settings* settings,
                                           forewalk_navmesh** navmesh) {
  if (navmesh != nullptr) *navmesh = nullptr;
  if (path == nullptr || navmesh == nullptr) {
    return failLiteral(FOREWALK_ERROR_ARGUMENT,
                       "forewalk_navmesh_from_file: path or navmesh is null.");
  }
  return guarded([&]() -> forewalk_status {
    Preparation preparation;
    if (const forewalk_status status = read(settings, preparation)) return status;
    const std::u8string name(path, path + std::strlen(path));
    return handOut(service::loadNavMesh(std::filesystem::path(name), preparation.import,
                                        preparation.build, onAllCores()),
                   path, navmesh);
  });
}

forewalk_status forewalk_navmesh_from_triangles(const float* vertices, size_t vertex_count,
                                                const uint32_t* indices, size_t index_count,
                                                forewalk_axes axes,
                                                const forewalk_build_settings* settings,
                                                forewalk_navmesh** navmesh) {
  if (navmesh != nullptr) *navmesh = nullptr;
  if (navmesh == nullptr) {
    return failLiteral(FOREWALK_ERROR_ARGUMENT,
                       "forewalk_navmesh_from_triangles: navmesh is null.");
  }
  return guarded([&]() -> forewalk_status {
    Preparation preparation;
    if (const forewalk_status status = read(settings, preparation)) return status;
    navmesh::Scene scene;
    if (const auto status =
            sceneFrom({vertices, vertex_count, indices, index_count}, axes, preparation, scene)) {
      return status;
    }
    return handOut(navmesh::buildNavMesh(scene, preparation.build, onAllCores()),
                   "triangles in memory", navmesh);
  });
}

forewalk_status forewalk_navmesh_from_fwmesh(const void* bytes, size_t byte_count,
                                             forewalk_navmesh** navmesh) {
  if (navmesh != nullptr) *navmesh = nullptr;
  if (navmesh == nullptr || (bytes == nullptr && byte_count > 0)) {
    return failLiteral(FOREWALK_ERROR_ARGUMENT,
                       "forewalk_navmesh_from_fwmesh: bytes or navmesh is null.");
  }
  return guarded([&]() -> forewalk_status {
    const std::span<const std::byte> span(static_cast<const std::byte*>(bytes), byte_count);
    return handOut(navmesh::loadFwmesh(span, "fwmesh in memory"), "fwmesh in memory", navmesh);
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

void forewalk_navmesh_retain(forewalk_navmesh* navmesh) {
  if (navmesh != nullptr) navmesh->owners.fetch_add(1, std::memory_order_relaxed);
}

void forewalk_navmesh_release(forewalk_navmesh* navmesh) {
  if (navmesh == nullptr) return;
  if (navmesh->owners.fetch_sub(1, std::memory_order_acq_rel) == 1) delete navmesh;
}

}  // extern "C"
