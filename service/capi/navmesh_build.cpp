// Navmeshes out of scenes: what needs Recast, files and threads.
#include <cstring>
#include <filesystem>
#include <utility>

#include "navmesh/build/build.h"
#include "navmesh/build/fwmesh_flat.h"
#include "service/capi/build_settings.h"
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
  const navmesh::PolygonMesh polygons = navmesh::flatten(*navMesh);
  return capi::handOut(polygons, navmesh::saveFlatFwmesh(navMesh->settings, polygons), scene,
                       handle);
}

}  // namespace

}  // namespace forewalk::capi

using namespace forewalk;
using namespace forewalk::capi;

extern "C" {

void forewalk_build_settings_init(forewalk_build_settings* settings, uint32_t struct_size) {
  initKnown(defaultBuildSettings(), settings, struct_size);
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

}  // extern "C"
