// Follows a piece of the front, the points at one distance from the user, to the walls it ends on.
//
// Where one root is nearest, the front is a circle about it. So the front of a moment is the
// outline of the discs that all views (views.h) have filled by then, and it is followed arc by arc:
// to where the circle leaves the polygon, to the ray that bounds its view, or into the disc of
// another.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "prediction/cell_mesh.h"
#include "prediction/views.h"

namespace forewalk::prediction {

enum class Direction : std::uint8_t {
  kLeftwards,  ///< counter-clockwise about the root, to the left of somebody who walks outward
  kRightwards
};

/// A piece of the front about one root in one polygon. Metres.
struct FrontPiece {
  PolygonId polygon;
  const View* view;
  glm::dvec2 from, to;
  double length;  ///< along the circle
};

/// How following a front ended.
struct FrontEnd {
  enum class How : std::uint8_t {
    kWall,    ///< on a wall
    kClosed,  ///< where it began: it has no end
    kLost,    ///< nowhere: what lies there was not reached, or rounding hid how it goes on
  };
  How how;
  std::uint32_t wall;  ///< (cell_mesh.h), and
  double along;        ///< where on it, metres from its beginning
};

class FrontTrace {
 public:
  /// Both must outlive this; `views` are read when following.
  FrontTrace(const CellMesh& mesh, const Views& views) : mesh_(&mesh), views_(&views) {}

  /// Follows the front at `level` metres from `at`, a point of it in `polygon` to which `view` is
  /// nearest. Where `pieces` is not null, what was passed is appended to it. O(views and corners of
  /// the polygons passed).
  FrontEnd follow(PolygonId polygon, const View& view, glm::dvec2 at, double level,
                  Direction direction, std::vector<FrontPiece>* pieces = nullptr) const;

 private:
  const CellMesh* mesh_;
  const Views* views_;
};

/// The point of a piece that was followed rightwards at `share` of its length, 0 to 1.
glm::dvec2 pointOn(const FrontPiece& piece, double share);

}  // namespace forewalk::prediction
