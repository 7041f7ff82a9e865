#include "prediction/front_trace.h"
#include "navmesh/plan.h"

#include <algorithm>
#include <cmath>

namespace forewalk::prediction {

using navmesh::cross;

using glm::dvec2;

namespace {

constexpr int kMostPieces = 4096;  // far beyond any front: where rounding leads in circles

dvec2 turnedLeft(dvec2 a) { return {-a.y, a.x}; }

constexpr double kTurn = 2 * 3.14159265358979323846;  // radians

/// The angle whose sine has the square `q` <= 0.1, over that sine. By its series: the same
/// everywhere, which the library's is not.
double arcOverSine(double q) {
  return 1 + q * (1.0 / 6 +
                  q * (3.0 / 40 + q * (15.0 / 336 + q * (105.0 / 3456 + q * (945.0 / 42240)))));
}

/// The length of an arc of up to half a turn over a chord whose square is `squared`, metres.
double arcOver(double squared, double radius) {
  double q = squared / (4 * radius * radius);  // squared sine of half the angle
  if (q <= 0.1) return std::sqrt(squared) * arcOverSine(q);
  double doublings = 2.0;
  for (q = std::min(q, 1.0); q > 0.1; q = 0.5 * (1.0 - std::sqrt(1.0 - q))) doublings *= 2.0;
  return 0.5 * doublings * 2 * radius * std::sqrt(q) * arcOverSine(q);
}

/// A circle that is followed from a place on it.
struct Arc {
  dvec2 root, start;  // start: from the root
  double radius, turn;

  /// How far on a point of the circle lies: rises from 0 to 4 as the angle does from 0 to a full
  /// turn.
  double progress(dvec2 point) const {
    const dvec2 ray = point - root;
    const double cosine = glm::dot(start, ray) / (radius * radius);
    return turn * cross(start, ray) >= 0.0 ? 1.0 - cosine : 3.0 + cosine;
  }

  double lengthTo(dvec2 point) const {
    const dvec2 chord = point - root - start;
    const double squared = glm::dot(chord, chord);
    const double shorter = arcOver(squared, radius);
    const bool over = turn * cross(start, point - root) < 0.0 && squared > 1e-12;
    return over ? kTurn * radius - shorter : shorter;
  }
};

/// Whether `point` of the front lies on the circle of a view, seen, and the front goes on there.
bool goesOnBy(const View& view, dvec2 point, double level, double turn) {
  constexpr double kOff = 1e-6;  // metres
  const double radius = level - view.distance;
  if (radius <= 0.0) return false;
  const dvec2 ray = point - view.root;
  if (std::abs(glm::dot(ray, ray) - radius * radius) > 2 * radius * kOff + kOff * kOff)
    return false;
  if (view.whole) return true;
  const dvec2 bound = turn > 0.0 ? view.left : view.right;
  const double side = turn * cross(ray, bound);
  return side > 0.0 && side * side > kOff * kOff * glm::dot(bound, bound) && view.sees(point);
}

/// The view by which the front goes on at a point, best the same root as before.
const View* viewOnward(std::span<const View> views, dvec2 point, double level, double turn,
                       std::uint32_t corner) {
  for (const View& view : views) {
    if (view.corner == corner && goesOnBy(view, point, level, turn)) return &view;
  }
  for (const View& view : views) {
    if (view.corner != corner && goesOnBy(view, point, level, turn)) return &view;
  }
  // Rounding left a gap between two views: by whoever is nearest, if it is on the front at all.
  const Nearest nearest = nearestOf(views, point);
  return std::abs(nearest.distance - level) < 1e-3 ? nearest.view : nullptr;
}

/// Where a circle stops.
struct Stop {
  dvec2 place{0.0};
  const CellMesh::Corner* edge = nullptr;  // it leaves the polygon over this edge, or
  const View* view = nullptr;              // it enters the disc of this view; or neither: nowhere
  double along = 0.0;                      // on the edge

  bool found() const { return edge != nullptr || view != nullptr; }
};

/// Out of the polygon: over an edge that goes from outside the circle to inside, as the turn has
/// it, or that it cuts twice.
void stopAtEdges(const Arc& arc, std::span<const CellMesh::Corner> corners, Stop& stop) {
  const double squared = arc.radius * arc.radius;
  const auto outside = [&](const CellMesh::Corner& corner) {
    const dvec2 ray = corner.from - arc.root;
    return glm::dot(ray, ray) > squared;
  };
  const bool firstOutside = outside(corners.front());
  bool here = firstOutside;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const CellMesh::Corner& corner = corners[i];
    const bool next = i + 1 < corners.size() ? outside(corners[i + 1]) : firstOutside;
    const bool tail = arc.turn > 0.0 ? here : next;
    const bool head = arc.turn > 0.0 ? next : here;
    here = next;
    if (!tail) continue;
    const dvec2 ray = arc.root - corner.from;
    const double foot = glm::dot(ray, corner.along);
    if (head && !(foot > 0.0 && foot < corner.length)) continue;
    const double aside = cross(ray, corner.along);
    const double half = squared - aside * aside;
    if (half <= 0.0) continue;
    const double along = foot - arc.turn * std::sqrt(half);
    const dvec2 place = corner.from + along * corner.along;
    if (stop.edge != nullptr && arc.progress(place) >= arc.progress(stop.place)) continue;
    stop.place = place;
    stop.edge = &corner;
    stop.along = along;
  }
}

/// Into the disc of another view of the polygon, if that comes first.
void stopAtDiscs(const Arc& arc, double level, const View& own, std::span<const View> views,
                 Stop& stop) {
  double first = -1.0;  // progress, once it must be known
  for (const View& view : views) {
    const double radius = level - view.distance;
    if (&view == &own || radius <= 0.0) continue;
    const dvec2 between = view.root - arc.root;
    const double gap = glm::dot(between, between);
    const double sum = arc.radius + radius;
    const double difference = arc.radius - radius;
    const double touching = 1e-9 * (1.0 + gap);
    if (gap >= sum * sum || gap < difference * difference - touching) continue;
    dvec2 place;
    if (gap <= difference * difference + touching) {
      // One inside the other, and they touch: behind a corner, on the ray from the root before it.
      if (radius <= arc.radius || gap <= touching) continue;
      place = arc.root - arc.radius / std::sqrt(gap) * between;
      if (!goesOnBy(view, place, level, arc.turn)) continue;
    } else {
      const double apart = std::sqrt(gap);
      const double along = (gap + arc.radius * arc.radius - radius * radius) / (2 * apart);
      const double aside = std::sqrt(std::max(0.0, arc.radius * arc.radius - along * along));
      const dvec2 unit = between / apart;
      place = arc.root + along * unit - arc.turn * aside * turnedLeft(unit);
      if (!view.sees(place)) continue;
    }
    const double progress = arc.progress(place);
    if (first < 0.0) first = stop.found() ? arc.progress(stop.place) : 4.0;
    if (progress >= first || progress > 3.999999) continue;
    first = progress;
    stop = {place, nullptr, &view, 0.0};
  }
}

/// Whether a stop lies beyond the rays that bound a view.
bool isBeyond(const View& view, dvec2 place) {
  const dvec2 ray = place - view.root;
  return cross(ray, view.left) < 0.0 || cross(view.right, ray) < 0.0;
}

}  // namespace

FrontEnd FrontTrace::follow(PolygonId polygon, const View& startView, dvec2 at, double level,
                            Direction direction, std::vector<FrontPiece>* pieces) const {
  const double turn = direction == Direction::kLeftwards ? 1.0 : -1.0;
  const View* view = &startView;
  const dvec2 begin = at;
  const PolygonId beginPolygon = polygon;
  FrontEnd end{FrontEnd::How::kLost, kNone, 0.0};
  for (int count = 0; count < kMostPieces; ++count) {
    const Arc arc{view->root, at - view->root, level - view->distance, turn};
    const std::span<const View> views = views_->of(polygon);
    Stop stop;
    stopAtEdges(arc, mesh_->cornersOf(polygon), stop);
    if (views.size() > 1) stopAtDiscs(arc, level, *view, views, stop);
    const bool byRay = !view->whole && (!stop.found() || isBeyond(*view, stop.place));
    if (byRay) {
      const dvec2 bound = turn > 0.0 ? view->left : view->right;
      stop.place = view->root + arc.radius / glm::length(bound) * bound;
    }

    // Around to where it began? Or a whole circle that nothing stops?
    const bool whole = !byRay && !stop.found();
    if (whole || (count > 0 && view == &startView && polygon == beginPolygon &&
                  arc.progress(begin) <= arc.progress(stop.place))) {
      const double length = whole ? kTurn * arc.radius : arc.lengthTo(begin);
      if (pieces != nullptr) pieces->push_back({polygon, view, at, begin, length});
      end.how = FrontEnd::How::kClosed;
      return end;
    }

    if (pieces != nullptr) {
      pieces->push_back({polygon, view, at, stop.place, arc.lengthTo(stop.place)});
    }
    at = stop.place;
    if (byRay) {
      const View* before = view;
      view = viewOnward(views, at, level, turn, view->corner);
      if (view == nullptr || view == before) return end;
    } else if (stop.view != nullptr) {
      view = stop.view;
    } else if (stop.edge->wall != kNone) {
      end.how = FrontEnd::How::kWall;
      end.wall = stop.edge->wall;
      end.along = stop.along;
      return end;
    } else {
      polygon = stop.edge->beyond;
      view = viewOnward(views_->of(polygon), at, level, turn, view->corner);
      if (view == nullptr) return end;
    }
  }
  return end;
}

dvec2 pointOn(const FrontPiece& piece, double share) {
  // By halves, which needs no angles; what is left is straight enough.
  const dvec2 root = piece.view->root;
  const double radius = glm::length(piece.from - root);
  dvec2 from = piece.from - root;
  dvec2 to = piece.to - root;
  double turn = radius > 0.0 ? piece.length / radius : 0.0;  // radians, left of it
  for (int i = 0; i < 12 && radius > 0.0 && share > 0.0; ++i) {
    dvec2 middle = from + to;
    const double length = glm::length(middle);
    if (length > 1e-6 * radius) {
      middle *= (turn > 0.5 * kTurn ? -radius : radius) / length;
    } else if (turn > 0.25 * kTurn) {
      middle = -turnedLeft(from);  // half a turn, rightwards
    } else {
      break;
    }
    turn *= 0.5;
    if (share < 0.5) {
      to = middle;
      share *= 2;
    } else {
      from = middle;
      share = 2 * share - 1;
    }
  }
  return root + glm::mix(from, to, share);
}

}  // namespace forewalk::prediction
