#include "obj_writer.h"

#include <fmt/format.h>

#include <iterator>

namespace forewalk::assets {
namespace {

/// Metres with three decimals from mm; "-0.000" cannot occur.
std::string metres(int mm) {
  const int magnitude = mm < 0 ? -mm : mm;
  return fmt::format("{}{}.{:03}", mm < 0 ? "-" : "", magnitude / 1000, magnitude % 1000);
}

}  // namespace

ObjWriter::ObjWriter(const std::string& title, const std::string& origin) {
  text_ = fmt::format("# {}\n# {}\n# Metres, right-handed, +Y up.\n", title, origin);
}

void ObjWriter::group(const std::string& name) {
  fmt::format_to(std::back_inserter(text_), "g {}\n", name);
}

int ObjWriter::vertex(Point p) {
  fmt::format_to(std::back_inserter(text_), "v {} {} {}\n", metres(p.x), metres(p.y), metres(p.z));
  return ++vertices_;
}

void ObjWriter::face(int a, int b, int c, int d) {
  fmt::format_to(std::back_inserter(text_), "f {} {} {} {}\n", a, b, c, d);
}

void ObjWriter::quad(Point a, Point b, Point c, Point d) {
  const int first = vertex(a);
  vertex(b);
  vertex(c);
  vertex(d);
  face(first, first + 1, first + 2, first + 3);
}

void ObjWriter::floor(Rect r, int y) {
  quad({r.x0, y, r.z0}, {r.x0, y, r.z1}, {r.x1, y, r.z1}, {r.x1, y, r.z0});
}

void ObjWriter::box(Rect r, int y0, int y1) {
  const int first = vertices_ + 1;
  for (const int y : {y0, y1}) {
    vertex({r.x0, y, r.z0});
    vertex({r.x0, y, r.z1});
    vertex({r.x1, y, r.z1});
    vertex({r.x1, y, r.z0});
  }
  // Bottom, top, then the four sides; vertex 0-3 below, 4-7 above, in the order of a floor.
  const int faces[6][4] = {{0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 5, 4},
                           {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}};
  for (const auto& f : faces) face(first + f[0], first + f[1], first + f[2], first + f[3]);
}

void ObjWriter::lidded(Rect r, int y0, int y1, int ridge) {
  box(r, y0, y1);
  const bool alongX = r.x1 - r.x0 >= r.z1 - r.z0;
  const int half = (alongX ? r.z1 - r.z0 : r.x1 - r.x0) / 2;
  const Point nw{r.x0, y1, r.z0}, sw{r.x0, y1, r.z1}, se{r.x1, y1, r.z1}, ne{r.x1, y1, r.z0};
  const int inset = half - 1;  // one millimetre of ridge is left on a square, so quads stay quads
  if (alongX) {
    const Point west{r.x0 + inset, ridge, r.z0 + half}, east{r.x1 - inset, ridge, r.z0 + half};
    quad(sw, se, east, west);
    quad(ne, nw, west, east);
    quad(nw, sw, {west.x, ridge, west.z + 1}, {west.x, ridge, west.z - 1});
    quad(se, ne, {east.x, ridge, east.z - 1}, {east.x, ridge, east.z + 1});
  } else {
    const Point north{r.x0 + half, ridge, r.z0 + inset}, south{r.x0 + half, ridge, r.z1 - inset};
    quad(nw, sw, south, north);
    quad(se, ne, north, south);
    quad(sw, se, {south.x + 1, ridge, south.z}, {south.x - 1, ridge, south.z});
    quad(ne, nw, {north.x - 1, ridge, north.z}, {north.x + 1, ridge, north.z});
  }
}

}  // namespace forewalk::assets
