// What a navmesh is built for: the walker, and the resolution at which the scene is looked at.
#pragma once

#include <cstdint>
#include <tl/expected.hpp>

#include "navmesh/error.h"

namespace forewalk::navmesh {

/// How Recast cuts the walkable area into regions.
enum class Partition : std::uint8_t {
  kWatershed,  ///< best polygons, slowest
  kMonotone,   ///< fastest, long thin polygons
  kLayers,     ///< between; good with small tiles
};

/// Defaults are a walking person in a building. The walker's size is baked into the navmesh: its border
/// is where the walker's centre can be.
struct BuildSettings {
  float radius = 0.25f;    ///< walker, metres, >= 0
  float height = 1.8f;     ///< walker, metres, > 0
  float climb = 0.25f;     ///< highest step, metres, >= 0
  float slope = 0.785398163f;  ///< steepest ground, radians, [0, pi/2)
  float cell = 0.1f;       ///< voxel size on the ground, metres, > 0
  float cellHeight = 0.05f;    ///< voxel height, metres, > 0
  float regionMin = 0.5f;      ///< regions smaller than this, m^2, are dropped
  float regionMerge = 4.0f;    ///< regions smaller than this, m^2, are joined to a neighbour if they can
  float edgeMax = 12.0f;       ///< longest border edge, metres; 0: no limit
  float edgeError = 0.13f;     ///< how far a border may leave the voxels, metres
  float detailSample = 0.6f;   ///< spacing of height samples, metres; 0: corners only
  float detailError = 0.05f;   ///< how far the height may leave the voxels, metres
  std::uint32_t cornersMax = 6;  ///< of a polygon, 3 to 6 (Detour's limit)
  Partition partition = Partition::kWatershed;
  float tile = 0.0f;       ///< side of a tile, metres; 0: solo, one piece

  bool operator==(const BuildSettings&) const = default;
};

/// Whether a navmesh can have been built with these: every number finite and not negative, the slope
/// below pi/2. Names the first that is not (kDataDamaged). Whether they can build one is another matter
/// (checkSettings in build.h).
[[nodiscard]] tl::expected<void, Error> validate(const BuildSettings& settings);

}  // namespace forewalk::navmesh
