#include "service/capi/build_settings.h"

#include <span>
#include <string>
#include <utility>
#include <vector>

#include "service/capi/axes.h"
#include "service/capi/status.h"

namespace forewalk::capi {

namespace {

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
  if (const auto status = readSettings(given, "forewalk_build_settings", settings)) return status;
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

forewalk_status sceneFrom(const TriangleArrays& arrays, forewalk_axes axes,
                          const Preparation& preparation, navmesh::Scene& scene) {
  if ((arrays.vertices == nullptr && arrays.vertexCount > 0) ||
      (arrays.indices == nullptr && arrays.indexCount > 0)) {
    return failLiteral(
        FOREWALK_ERROR_ARGUMENT,
        "triangles in memory: vertices or indices is null while its count is not 0.");
  }
  if (axes < FOREWALK_AXES_OPENXR || axes > FOREWALK_AXES_UNREAL) {
    return fail(FOREWALK_ERROR_ARGUMENT,
                "triangles in memory: axes " + std::to_string(axes) +
                    " is none of FOREWALK_AXES_OPENXR, _UNITY, _UNREAL (0 to 2).");
  }
  constexpr std::size_t kMost = 0xffffffffu;
  if (arrays.vertexCount > kMost || arrays.indexCount > 3 * kMost) {
    return fail(FOREWALK_ERROR_TOO_LARGE,
                "triangles in memory: " + std::to_string(arrays.vertexCount) + " vertices and " +
                    std::to_string(arrays.indexCount) +
                    " indices; at most 4294967295 vertices and as many triangles can be read.");
  }
  navmesh::ImportSettings import = preparation.import;
  if (axes != FOREWALK_AXES_OPENXR) import.up = navmesh::UpAxis::kY;
  const Triangles triangles = trianglesFrom(axes, {arrays.vertices, 3 * arrays.vertexCount},
                                            {arrays.indices, arrays.indexCount});
  auto made =
      navmesh::makeScene("triangles in memory", triangles.vertices, triangles.indices, import);
  if (!made) return fail(made.error());
  scene = std::move(*made);
  return FOREWALK_OK;
}

}  // namespace forewalk::capi
