// Whether border portals lie where they say: on edges of both their polygons.
#pragma once

#include <tl/expected.hpp>

#include "navmesh/error.h"
#include "navmesh/polygon_mesh.h"

namespace forewalk::navmesh {

/// Checks that the border portals of `flat`, which is valid otherwise, are in order, that their
/// ends lie on both edges within 1 cm on the plan and `climb` (metres) in height, and that left and
/// right are as a walker has them. Returns the first that is not (kDataDamaged). O(portals).
[[nodiscard]] tl::expected<void, Error> checkBorderPortals(const PolygonMesh& flat, float climb);

}  // namespace forewalk::navmesh
