// Cuts a face of more than three corners into triangles.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

namespace forewalk::navmesh {

/// Appends `ring` as triangles of the same winding: a fan where it is convex, by cutting ears where
/// it is not. A ring that crosses itself has no right answer; it becomes a fan of what is left.
///
/// Three corners or more, indices into `vertices`. Costs O(corners^2) where the ring is not convex.
void triangulate(std::span<const std::uint32_t> ring, const std::vector<glm::vec3>& vertices,
                 std::vector<glm::uvec3>& triangles);

}  // namespace forewalk::navmesh
