// What a scene is and how it is built, out of a C caller's numbers.
#pragma once

#include "navmesh/build/build.h"
#include "navmesh/build/scene.h"
#include "service/capi/forewalk.h"

namespace forewalk::capi {

struct Preparation {
  navmesh::ImportSettings import;
  navmesh::BuildSettings build;
};

forewalk_build_settings defaultBuildSettings();

/// FOREWALK_OK, or the refusal. `given` may be null: defaults.
forewalk_status read(const forewalk_build_settings* given, Preparation& preparation);

/// Triangles as an engine has them in memory.
struct TriangleArrays {
  const float* vertices;  ///< x, y, z of each
  std::size_t vertexCount;
  const std::uint32_t* indices;
  std::size_t indexCount;
};

/// Makes a scene of them, in our axes, metres and winding. FOREWALK_OK, or the refusal.
forewalk_status sceneFrom(const TriangleArrays& arrays, forewalk_axes axes,
                          const Preparation& preparation, navmesh::Scene& scene);

}  // namespace forewalk::capi
