#include <cmath>
#include <filesystem>
#include <string_view>
#include <utility>

#include "navmesh/build/build.h"
#include "navmesh/build/fwmesh.h"
#include "service/capi/axes.h"
#include "service/capi/navmesh_handle.h"
#include "service/capi/status.h"
#include "service/files.h"
#include "service/parallel.h"

namespace forewalk::capi {

namespace {

struct Preparation {
  navmesh::ImportSettings import;
  navmesh::BuildSettings build;
};

forewalk_build_settings defaultBuildSettings() {
  const navmesh::BuildSettings build;
  forewalk_build_settings settings{};
  settings.struct_size = sizeof settings;
  settings.metres_per_unit = 1.0f;
  settings.radius = build.radius;
  settings.height = build.height;
  settings.climb = build.climb;
  settings.slope = build.slope;
  settings.cell = build.cell;
  settings.cell_height = build.cellHeight;
  settings.tile = build.tile;
  settings.partition = FOREWALK_PARTITION_WATERSHED;
  return settings;
}

// FOREWALK_OK, or the refusal.
forewalk_status read(const forewalk_build_settings* given, Preparation& preparation) {
  forewalk_build_settings settings = defaultBuildSettings();
  if (given != nullptr) {
    if (!isKnownSize<forewalk_build_settings>(given->struct_size)) {
      return fail(FOREWALK_ERROR_ARGUMENT,
                  "forewalk_build_settings: no version has had a struct_size of " +
                      std::to_string(given->struct_size) +
                      " bytes. Call forewalk_build_settings_init first.");
    }
    copyKnown(*given, settings);
  }
  navmesh::BuildSettings& build = preparation.build;
  switch (settings.partition) {
    case FOREWALK_PARTITION_WATERSHED:
      build.partition = navmesh::Partition::kWatershed;
      break;
    case FOREWALK_PARTITION_MONOTONE:
      build.partition = navmesh::Partition::kMonotone;
      break;
    case FOREWALK_PARTITION_LAYERS:
      build.partition = navmesh::Partition::kLayers;
      break;
    default:
      return fail(FOREWALK_ERROR_ARGUMENT,
                  "forewalk_build_settings: partition " + std::to_string(settings.partition) +
                      " is none of FOREWALK_PARTITION_WATERSHED, _MONOTONE, _LAYERS (0 to 2).");
  }
  preparation.import.metresPerUnit = settings.metres_per_unit;
  preparation.import.up = settings.z_up != 0 ? navmesh::UpAxis::kZ : navmesh::UpAxis::kY;
  build.radius = settings.radius;
  build.height = settings.height;
  build.climb = settings.climb;
  build.slope = settings.slope;
  build.cell = settings.cell;
  build.cellHeight = settings.cell_height;
  build.tile = settings.tile;
  return FOREWALK_OK;
}

navmesh::BuildRun onAllCores() { return {service::onThreads(0), {}}; }

forewalk_status handOut(const tl::expected<navmesh::NavMesh, Error>& navMesh,
                        forewalk_navmesh** handle) {
  if (!navMesh) return fail(navMesh.error());
  auto world = service::makeWorld(*navMesh);
  if (!world) return fail(world.error());
  auto made = std::make_unique<forewalk_navmesh>();
  made->world = std::move(*world);
  made->fwmesh = navmesh::saveFwmesh(*navMesh);
  *handle = made.release();
  return FOREWALK_OK;
}

// Vertices in our axes and metres, and triangles that are counter-clockwise seen from outside.
struct Triangles {
  std::vector<glm::vec3> vertices;
  std::vector<std::uint32_t> indices;
};

Triangles trianglesFrom(forewalk_axes axes, std::span<const float> coordinates,
                        std::span<const std::uint32_t> indices) {
  Triangles triangles;
  triangles.vertices.reserve(coordinates.size() / 3);
  for (std::size_t i = 0; i + 2 < coordinates.size(); i += 3) {
    triangles.vertices.push_back(
        positionFrom(axes, {coordinates[i], coordinates[i + 1], coordinates[i + 2]}));
  }
  triangles.indices.assign(indices.begin(), indices.end());
  // Unity's front faces are clockwise to the eye, Unreal's are not, although both are left-handed.
  if (axes == FOREWALK_AXES_UNITY) {
    for (std::size_t i = 0; i + 2 < triangles.indices.size(); i += 3) {
      std::swap(triangles.indices[i + 1], triangles.indices[i + 2]);
    }
  }
  return triangles;
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
                   navmesh);
  });
}

forewalk_status forewalk_navmesh_from_triangles(const float* vertices, size_t vertex_count,
                                                const uint32_t* indices, size_t index_count,
                                                forewalk_axes axes,
                                                const forewalk_build_settings* settings,
                                                forewalk_navmesh** navmesh) {
  if (navmesh != nullptr) *navmesh = nullptr;
  if (navmesh == nullptr || (vertices == nullptr && vertex_count > 0) ||
      (indices == nullptr && index_count > 0)) {
    return failLiteral(FOREWALK_ERROR_ARGUMENT,
                       "forewalk_navmesh_from_triangles: vertices, indices or navmesh is null.");
  }
  return guarded([&]() -> forewalk_status {
    if (axes < FOREWALK_AXES_OPENXR || axes > FOREWALK_AXES_UNREAL) {
      return fail(FOREWALK_ERROR_ARGUMENT,
                  "forewalk_navmesh_from_triangles: axes " + std::to_string(axes) +
                      " is none of FOREWALK_AXES_OPENXR, _UNITY, _UNREAL (0 to 2).");
    }
    constexpr std::size_t kMost = 0xffffffffu;
    if (vertex_count > kMost || index_count > 3 * kMost) {
      return fail(FOREWALK_ERROR_TOO_LARGE,
                  "forewalk_navmesh_from_triangles: " + std::to_string(vertex_count) +
                      " vertices and " + std::to_string(index_count) +
                      " indices; at most 4294967295 vertices and as many triangles can be read.");
    }
    Preparation preparation;
    if (const forewalk_status status = read(settings, preparation)) return status;
    if (axes != FOREWALK_AXES_OPENXR) preparation.import.up = navmesh::UpAxis::kY;
    Triangles triangles = trianglesFrom(axes, {vertices, 3 * vertex_count}, {indices, index_count});
    const auto scene = navmesh::makeScene("triangles in memory", triangles.vertices,
                                          triangles.indices, preparation.import);
    if (!scene) return fail(scene.error());
    triangles = {};
    return handOut(navmesh::buildNavMesh(*scene, preparation.build, onAllCores()), navmesh);
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
    return handOut(navmesh::loadFwmesh(span, "fwmesh in memory"), navmesh);
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
