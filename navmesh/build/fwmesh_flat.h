// `.fwmesh` without half-edges: all that frames need, and all that a file holds.
//
// Apart from fwmesh.h, so that what only walks needs no mesh library.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <tl/expected.hpp>
#include <vector>

#include "navmesh/build/settings.h"
#include "navmesh/error.h"
#include "navmesh/polygon_mesh.h"

namespace forewalk::navmesh {

struct FlatNavMesh {
  BuildSettings settings;  ///< what it was built with
  PolygonMesh polygons;
};

/// The file's bytes. Layout in navmesh/build/README.md. Both must be valid. O(size).
std::vector<std::byte> saveFlatFwmesh(const BuildSettings& settings, const PolygonMesh& polygons);

/// Fails as loadFwmesh (fwmesh.h) does. Whether edges join no more than two polygons makeNavGraph
/// finds out. O(size); allocates in proportion to the bytes given, whatever counts they claim.
[[nodiscard]] tl::expected<FlatNavMesh, Error> loadFlatFwmesh(std::span<const std::byte> bytes,
                                                              const std::string& name);

}  // namespace forewalk::navmesh
