// Triangulates motion clips; at load, and apart from the agents themselves because it needs CGAL,
// which runs neither in a browser nor within a frame.
//
// Delaunay in the plane of linear (m/s) and angular (rad/s) velocity, with exact predicates.
#pragma once

#include <tl/expected.hpp>
#include <vector>

#include "agents/locomotion.h"
#include "navmesh/error.h"

namespace forewalk::agents {

/// A database of any clips: triangles, or a chain where they lie on one line. Of clips with equal
/// motions the first is played. Fails as LocomotionDatabase::make does. O(n log n).
[[nodiscard]] tl::expected<LocomotionDatabase, Error> triangulateClips(
    std::vector<MotionClip> clips);

}  // namespace forewalk::agents
