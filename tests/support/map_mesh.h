// Navmeshes drawn with characters, for scenes whose ways are known by looking at them.
#pragma once

#include <span>
#include <string_view>
#include <vector>

#include "navmesh/nav_graph.h"
#include "navmesh/polygon_mesh.h"

namespace forewalk::testing {

/// How the same floor is cut into polygons.
enum class Cutting {
  kSquares,    ///< a square a character
  kTriangles,  ///< each square in two triangles, diagonals in turns
  kFine,       ///< four squares a character
  kUneven,     ///< squares whose inner corners are moved a little
};
inline constexpr Cutting kCuttings[] = {Cutting::kSquares, Cutting::kTriangles, Cutting::kFine,
                                        Cutting::kUneven};

/// Every character but a space is a walkable square of side `cell` metres. The first row is the
/// farthest: the lower left corner of the map is the plan's origin. Rows may be of any length.
navmesh::PolygonMesh mapMesh(std::span<const std::string_view> rows, float cell, Cutting cutting);

/// The middle of the first character `mark`, on the plan.
glm::vec2 markIn(std::span<const std::string_view> rows, float cell, char mark);

}  // namespace forewalk::testing
