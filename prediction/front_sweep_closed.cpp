// Fronts that no wall ends: all around the user, about where a link leads, and those that run
// inward around what is left of the floor.
#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include "navmesh/plan.h"
#include "prediction/front_sweep.h"

namespace forewalk::prediction {

using glm::dvec2;
using navmesh::cross;
using navmesh::kNoPolygon;

namespace {

/// One of the two places that are equally far by three roots (the problem of Apollonius), and how
/// far; false where there is none.
bool equallyFarFrom(const View* const (&views)[3], double root, dvec2& place, double& level) {
  // The differences of |place - root|^2 = (level - distance)^2 are linear: place = base + level *
  // slope.
  const dvec2 origin = views[0]->root;
  const double first = views[0]->distance;
  const dvec2 a = views[1]->root - origin;
  const dvec2 b = views[2]->root - origin;
  const double leadA = views[1]->distance - first;
  const double leadB = views[2]->distance - first;
  const double area = cross(a, b);
  if (std::abs(area) < 1e-9) return false;
  const double squareA = 0.5 * (glm::dot(a, a) - leadA * leadA);
  const double squareB = 0.5 * (glm::dot(b, b) - leadB * leadB);
  const auto solve = [&](double x, double y) {
    return dvec2(x * b.y - y * a.y, y * a.x - x * b.x) / area;
  };
  const dvec2 base = solve(squareA, squareB);  // with the level counted from the first root
  const dvec2 slope = solve(leadA, leadB);
  const double p = glm::dot(slope, slope) - 1.0;
  const double q = glm::dot(base, slope);
  const double r = glm::dot(base, base);
  const double discriminant = q * q - p * r;
  if (discriminant < 0.0 || std::abs(p) < 1e-12) return false;
  const double radius = (-q + root * std::sqrt(discriminant)) / p;
  if (radius <= 0.0 || radius < leadA || radius < leadB) return false;
  place = origin + base + radius * slope;
  level = first + radius;
  return true;
}

/// The area that a closed front runs around, followed leftwards; negative where that is still to be
/// reached. Square metres.
double areaWithin(std::span<const FrontPiece> loop) {
  double twice = 0.0;
  for (const FrontPiece& piece : loop) {
    const dvec2 root = piece.view->root;
    twice += cross(root, piece.to - piece.from) + glm::distance(root, piece.from) * piece.length;
  }
  return 0.5 * twice;
}

/// Whether three roots that see a place lie all around it.
bool isPeak(const View* const (&views)[3], dvec2 place) {
  const dvec2 a = views[0]->root - place;
  const dvec2 b = views[1]->root - place;
  const dvec2 c = views[2]->root - place;
  const double ab = cross(a, b);
  const double bc = cross(b, c);
  const double ca = cross(c, a);
  return ((ab > 0.0 && bc > 0.0 && ca > 0.0) || (ab < 0.0 && bc < 0.0 && ca < 0.0)) &&
         views[0]->sees(place) && views[1]->sees(place) && views[2]->sees(place);
}

}  // namespace

// --- Which of them it is ---

/// The seed, by number, that the shortest path to a corner of the field sets out from at last.
std::uint32_t FrontSweep::seedOf(std::uint32_t corner) const {
  while (corner != 0 && field_->passageTo(corner) == nullptr) {
    corner = field_->corners()[corner].previous;
  }
  std::uint32_t seed = 0;
  while (seed + 1 < seeds_.size() && seeds_[seed].corner != corner) ++seed;
  return seed;
}

bool FrontSweep::isSeedArc(std::uint32_t arc) const {
  return std::any_of(seeds_.begin(), seeds_.end(),
                     [arc](const Seed& seed) { return seed.arc == arc; });
}

/// What was all around some corners is all around them as another arc, or, kNone, no more.
void FrontSweep::reseed(std::uint32_t arc, std::uint32_t now) {
  for (Seed& seed : seeds_) {
    if (seed.arc != arc) continue;
    seed.arc = now;
    seed.opened = seed.opened || now == kNone;
  }
}

/// Whether a closed front runs inward.
bool FrontSweep::hasPockets() const {
  return std::any_of(alive_.begin(), alive_.end(), [this](std::uint32_t arc) {
    return endsOf_[arc].left == kNone && !isSeedArc(arc);
  });
}

/// The arc of the closed front that passes at a spot, or kNone.
std::uint32_t FrontSweep::closedArc(const Spot& spot) {
  const std::uint32_t own = seeds_[seedOf(spot.view->corner)].arc;
  // Before it has touched a wall, nothing but its own seed is behind a front.
  const auto fits = [&](std::uint32_t arc) {
    const auto isFresh = [arc](const Seed& seed) { return seed.arc == arc && !seed.opened; };
    return endsOf_[arc].left == kNone &&
           (arc == own || std::none_of(seeds_.begin(), seeds_.end(), isFresh));
  };
  std::uint32_t found = kNone;
  bool outward = false, followed = false;
  for (const std::uint32_t arc : alive_) {
    if (!fits(arc)) continue;
    if (found == kNone) {
      found = arc;
      continue;
    }
    if (!followed) {
      pieces_.clear();
      trace_.follow(spot.polygon, *spot.view, spot.at, spot.level, Direction::kLeftwards, &pieces_);
      outward = areaWithin(pieces_) > 0.0;
      followed = true;
    }
    if (outward ? arc == own : !isSeedArc(arc) && isSeedArc(found)) found = arc;
  }
  return found;
}

// --- Links ---

/// The front comes to the entry of a link: there it goes on, and a way through the link begins.
void FrontSweep::enterLink(std::uint32_t passage) {
  const LinkPassage& link = field_->passages()[passage];
  const navmesh::LinkWay& way = field_->links()->ways[link.way];
  const float distance = field_->corners()[link.entry].distance;
  // Several links may lead from one place, and the user may stand there.
  std::uint32_t& event = entered_[passage];
  if (events_.front().plan == way.entry && distance == 0.0f) event = 0;
  for (std::uint32_t other = 0; other < entered_.size() && event == kNone; ++other) {
    if (entered_[other] == kNone) continue;
    const FrontEvent& at = events_[entered_[other]];
    const bool same = at.plan == way.entry && at.polygon == way.from && at.distance == distance;
    if (same) event = entered_[other];
  }
  if (event == kNone) {
    const View* view = nearestOf(views_.of(way.from), dvec2(way.entry)).view;
    const Spot spot = spotBefore(dvec2(way.entry), distance, way.from, view);
    const std::uint32_t arc = arcAt(spot, Direction::kLeftwards);
    event = addEvent(dvec2(way.entry), way.from, distance);
    if (arc != kNone) {
      const Ends ends = endsOf_[arc];
      endArc(arc, field_->corners()[link.entry].previous);
      reseed(arc, static_cast<std::uint32_t>(arcs_.size()));
      addArc(event, ends);
    }
  }
  if (link.exit == kNone) cutLink(passage);
}

/// The way through a link comes out of it.
void FrontSweep::leaveLink(std::uint32_t passage) {
  seeds_.push_back(
      {field_->passages()[passage].exit, static_cast<std::uint32_t>(arcs_.size()), false});
  addArc(entered_[passage], {kNone, kNone});
}

/// The horizon falls into a link that was entered: the way ends there.
void FrontSweep::cutLink(std::uint32_t passage) {
  const LinkPassage& link = field_->passages()[passage];
  const navmesh::LinkWay& way = field_->links()->ways[link.way];
  const float walked = horizon_ - field_->corners()[link.entry].distance;
  const float share = way.length > 0.0f ? std::clamp(walked / way.length, 0.0f, 1.0f) : 0.0f;
  const glm::vec2 place = way.entry + share * (way.exit - way.entry);
  arcs_.push_back(
      {entered_[passage], kNone, link.entry, static_cast<std::uint32_t>(fronts_.size())});
  endsOf_.push_back({kNone, kNone});
  fronts_.push_back({place, place, place, way.from, 0.0f, passage});
}

// --- At the horizon, and inward ---

/// A place of a front at the horizon that no wall ends, that of the arc: on a portal, or anywhere
/// in a polygon that it does not leave.
bool FrontSweep::startInTheOpen(std::uint32_t arc, Spot& spot) {
  const double level = static_cast<double>(horizon_);
  const auto isClosed = [&](PolygonId polygon, const View& view, dvec2 place) {
    if (!view.sees(place) || nearestOf(views_.of(polygon), place).distance < level - 1e-6) {
      return false;
    }
    spot = {polygon, &view, place, level};
    return trace_.follow(polygon, view, place, level, Direction::kRightwards).how ==
               FrontEnd::How::kClosed &&
           closedArc(spot) == arc;
  };
  for (const PolygonId polygon : field_->polygons()) {
    for (const View& view : views_.of(polygon)) {
      const double radius = level - view.distance;
      if (radius <= 0.0) continue;
      const dvec2 beside = view.root + dvec2(radius, 0.0);
      if (navmesh::contains(*graph_, polygon, glm::vec2(beside)) &&
          isClosed(polygon, view, beside)) {
        return true;
      }
      for (const CellMesh::Corner& corner : mesh_->cornersOf(polygon)) {
        const CellMesh::Line& line = mesh_->lines[corner.edge];
        const dvec2 ray = view.root - line.from;
        const double aside = cross(ray, line.along);
        const double half = radius * radius - aside * aside;
        if (half <= 0.0) continue;
        for (const double side : {-1.0, 1.0}) {
          const double along = glm::dot(ray, line.along) + side * std::sqrt(half);
          if (along < 0.0 || along > line.length) continue;
          const dvec2 place = line.from + along * line.along;
          // Where the front, followed rightwards, comes into the polygon.
          if (glm::dot(corner.along, view.root - place) <= 0.0) continue;
          if (isClosed(polygon, view, place)) return true;
        }
      }
    }
  }
  return false;
}

/// A closed front runs inward until nothing is left: to a place equally far by three roots around
/// it, the next that lies beyond the arc's beginning.
void FrontSweep::shrink(std::uint32_t arc) {
  const FrontEvent& begin = events_[arcs_[arc].from];
  double nearest = std::numeric_limits<double>::infinity();
  dvec2 place{0.0};
  double value = 0.0;
  PolygonId polygon = kNoPolygon;
  std::uint32_t corner = 0;
  for (const PolygonId reached : field_->polygons()) {
    const std::span<const View> views = views_.of(reached);
    for (std::size_t i = 0; i < views.size(); ++i) {
      for (std::size_t j = i + 1; j < views.size(); ++j) {
        for (std::size_t k = j + 1; k < views.size(); ++k) {
          const View* const three[3] = {&views[i], &views[j], &views[k]};
          for (const double root : {-1.0, 1.0}) {
            dvec2 point;
            double level;
            if (!equallyFarFrom(three, root, point, level)) continue;
            const double apart = glm::distance(point, dvec2(begin.plan));
            if (apart >= nearest || level < static_cast<double>(begin.distance) ||
                level > static_cast<double>(horizon_) ||
                !navmesh::contains(*graph_, reached, glm::vec2(point)) || !isPeak(three, point) ||
                nearestOf(views, point).distance < level - 1e-6) {
              continue;
            }
            nearest = apart;
            place = point;
            value = level;
            polygon = reached;
            corner = views[i].corner;
          }
        }
      }
    }
  }
  if (polygon == kNoPolygon) {
    ++doubts_;
    return;
  }
  addEvent(place, polygon, static_cast<float>(value));
  arcs_[arc].to = static_cast<std::uint32_t>(events_.size() - 1);
  arcs_[arc].corner = corner;
}

}  // namespace forewalk::prediction
