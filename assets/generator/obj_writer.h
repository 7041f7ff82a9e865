// Collects a scene as Wavefront OBJ text: named groups of quads, fixed decimals, same bytes every
// time.
//
// All lengths are integer millimetres, so that no rounding depends on a compiler. World axes: +Y
// up.
#pragma once

#include <string>

namespace forewalk::assets {

/// A rectangle on the floor, mm. x0 < x1, z0 < z1; z grows towards the viewer of a plan drawing.
struct Rect {
  int x0, z0, x1, z1;
};

struct Point {
  int x, y, z;
};

class ObjWriter {
 public:
  /// `title` and `origin` become comments at the top.
  ObjWriter(const std::string& title, const std::string& origin);

  /// Everything that follows belongs to this group.
  void group(const std::string& name);

  /// Corners counter-clockwise seen from the side the quad faces.
  void quad(Point a, Point b, Point c, Point d);

  /// A floor that faces up.
  void floor(Rect area, int y);

  /// A closed box from `y0` to `y1`, faces outwards.
  void box(Rect area, int y0, int y1);

  /// A box with a hipped lid on it whose ridge runs along the longer side. Lids steeper than 45
  /// degrees keep the top of large things from being ground that a walker could stand on.
  void lidded(Rect area, int y0, int y1, int ridge);

  const std::string& text() const { return text_; }

 private:
  int vertex(Point p);  ///< its number in the file
  void face(int a, int b, int c, int d);

  std::string text_;
  int vertices_ = 0;
};

}  // namespace forewalk::assets
