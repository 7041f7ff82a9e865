#include "rdw/tracked_space.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <queue>
#include <string>

#include "navmesh/plan.h"
#include "rdw/pose.h"

namespace forewalk::rdw {

using navmesh::cross;

namespace {

using Ring = std::vector<glm::dvec2>;

constexpr double kFurthestCorner = 10000.0;  // metres
constexpr double kSmallestArea = 0.01;       // m^2
constexpr double kOnBorder = 1e-9;           // metres
constexpr double kPolePrecision = 1e-3;      // metres

double dot(glm::dvec2 a, glm::dvec2 b) { return a.x * b.x + a.y * b.y; }
double lengthOf(glm::dvec2 v) { return std::sqrt(dot(v, v)); }

tl::unexpected<Error> refused(ErrorCode code, std::string message) {
  return tl::unexpected(Error{code, std::move(message)});
}

std::string nameOf(std::size_t ring) {
  return ring == 0 ? std::string("its border") : fmt::format("hole {}", ring - 1);
}

double signedArea(std::span<const glm::dvec2> ring) {
  double twice = 0.0;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    twice += cross(ring[i] - ring[0], ring[(i + 1) % ring.size()] - ring[0]);
  }
  return 0.5 * twice;
}

bool insideRing(std::span<const glm::dvec2> ring, glm::dvec2 p) {
  bool inside = false;
  for (std::size_t i = 0, j = ring.size() - 1; i < ring.size(); j = i++) {
    const glm::dvec2 a = ring[i];
    const glm::dvec2 b = ring[j];
    if ((a.y > p.y) != (b.y > p.y) && p.x < (b.x - a.x) * (p.y - a.y) / (b.y - a.y) + a.x)
      inside = !inside;
  }
  return inside;
}

glm::dvec2 nearestOnSegment(glm::dvec2 a, glm::dvec2 b, glm::dvec2 p) {
  const glm::dvec2 ab = b - a;
  const double length2 = dot(ab, ab);
  const double t = length2 > 0.0 ? std::clamp(dot(p - a, ab) / length2, 0.0, 1.0) : 0.0;
  return a + t * ab;
}

int sideOf(glm::dvec2 a, glm::dvec2 b, glm::dvec2 c) {
  const double twice = cross(b - a, c - a);
  return twice > 0.0 ? 1 : twice < 0.0 ? -1 : 0;
}

bool within(glm::dvec2 a, glm::dvec2 b, glm::dvec2 c) {  // c collinear with a, b
  return std::min(a.x, b.x) <= c.x && c.x <= std::max(a.x, b.x) && std::min(a.y, b.y) <= c.y &&
         c.y <= std::max(a.y, b.y);
}

/// Whether closed segments meet, touching included.
bool meet(glm::dvec2 a, glm::dvec2 b, glm::dvec2 c, glm::dvec2 d) {
  const int c1 = sideOf(a, b, c);
  const int d1 = sideOf(a, b, d);
  const int a1 = sideOf(c, d, a);
  const int b1 = sideOf(c, d, b);
  if (c1 != d1 && a1 != b1) return true;
  return (c1 == 0 && within(a, b, c)) || (d1 == 0 && within(a, b, d)) ||
         (a1 == 0 && within(c, d, a)) || (b1 == 0 && within(c, d, b));
}

tl::expected<Ring, Error> soundRing(std::span<const glm::dvec2> given, std::size_t number) {
  Ring ring;
  ring.reserve(given.size());
  for (std::size_t i = 0; i < given.size(); ++i) {
    const glm::dvec2 p = given[i];
    if (!(std::abs(p.x) <= kFurthestCorner && std::abs(p.y) <= kFurthestCorner)) {
      return refused(
          ErrorCode::kDataDamaged,
          fmt::format(
              "tracked space: {}, corner {} is ({}, {}) on the plan: give finite metres within "
              "10 km of the origin.",
              nameOf(number), i, p.x, p.y));
    }
    if (ring.empty() || ring.back() != p) ring.push_back(p);
  }
  while (ring.size() > 1 && ring.front() == ring.back()) ring.pop_back();
  if (ring.size() < 3) {
    return refused(ErrorCode::kDataDamaged,
                   fmt::format("tracked space: {} has {} distinct corners, 3 are needed.",
                               nameOf(number), ring.size()));
  }
  const double area = signedArea(ring);
  if (std::abs(area) < kSmallestArea) {
    return refused(
        ErrorCode::kDataDamaged,
        fmt::format(
            "tracked space: {} encloses {} m^2, at least {} m^2 are needed. Are the corners in "
            "metres, and in order along the border?",
            nameOf(number), std::abs(area), kSmallestArea));
  }
  const bool border = number == 0;
  if ((area > 0.0) != border) std::reverse(ring.begin(), ring.end());
  return ring;
}

tl::expected<void, Error> checkCrossings(const std::vector<Ring>& rings) {
  for (std::size_t r = 0; r < rings.size(); ++r) {
    for (std::size_t s = r; s < rings.size(); ++s) {
      const Ring& a = rings[r];
      const Ring& b = rings[s];
      for (std::size_t i = 0; i < a.size(); ++i) {
        const glm::dvec2 a0 = a[i];
        const glm::dvec2 a1 = a[(i + 1) % a.size()];
        for (std::size_t j = r == s ? i + 1 : 0; j < b.size(); ++j) {
          const glm::dvec2 b0 = b[j];
          const glm::dvec2 b1 = b[(j + 1) % b.size()];
          bool bad;
          if (r == s && (j == i + 1 || (i == 0 && j == a.size() - 1))) {
            // Neighbours share a corner; they must not fold back onto each other.
            const glm::dvec2 in = j == i + 1 ? a1 - a0 : b1 - b0;
            const glm::dvec2 out = j == i + 1 ? b1 - b0 : a1 - a0;
            bad = cross(in, out) == 0.0 && dot(in, out) < 0.0;
          } else {
            bad = meet(a0, a1, b0, b1);
          }
          if (bad) {
            return refused(
                ErrorCode::kDataDamaged,
                fmt::format("tracked space: {} from ({}, {}) to ({}, {}) meets {} from ({}, {}) to "
                            "({}, {}): "
                            "edges must neither cross nor touch.",
                            nameOf(r), a0.x, a0.y, a1.x, a1.y, nameOf(s), b0.x, b0.y, b1.x, b1.y));
          }
        }
      }
    }
  }
  for (std::size_t r = 1; r < rings.size(); ++r) {
    // Nothing crosses, so one corner speaks for its whole ring.
    if (!insideRing(rings[0], rings[r][0])) {
      return refused(ErrorCode::kDataDamaged,
                     fmt::format("tracked space: {} lies outside the border, at ({}, {}).",
                                 nameOf(r), rings[r][0].x, rings[r][0].y));
    }
    for (std::size_t s = 1; s < rings.size(); ++s) {
      if (s != r && insideRing(rings[s], rings[r][0])) {
        return refused(ErrorCode::kDataDamaged,
                       fmt::format("tracked space: {} lies inside {}, at ({}, {}). Leave it out.",
                                   nameOf(r), nameOf(s), rings[r][0].x, rings[r][0].y));
      }
    }
  }
  return {};
}

glm::dvec2 centroidOf(std::span<const glm::dvec2> ring) {
  glm::dvec2 sum(0.0);
  double twice = 0.0;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const glm::dvec2 a = ring[i] - ring[0];
    const glm::dvec2 b = ring[(i + 1) % ring.size()] - ring[0];
    twice += cross(a, b);
    sum += cross(a, b) * (a + b);
  }
  return ring[0] + sum / (3.0 * twice);
}

}  // namespace

TrackedSpace::TrackedSpace() { *this = *rectangle(6.0, 6.0); }

tl::expected<TrackedSpace, Error> TrackedSpace::rectangle(double width, double depth) {
  if (!(width >= 0.1 && width <= kFurthestCorner && depth >= 0.1 && depth <= kFurthestCorner)) {
    return refused(
        ErrorCode::kSettingOutOfRange,
        fmt::format(
            "tracked space: a rectangle of {} m x {} m cannot work: give sides of 0.1 m to 10 km.",
            width, depth));
  }
  const double x = 0.5 * width;
  const double y = 0.5 * depth;
  return polygon(Ring{{-x, -y}, {x, -y}, {x, y}, {-x, y}});
}

tl::expected<TrackedSpace, Error> TrackedSpace::circle(double radius) {
  if (!(radius >= 0.1 && radius <= kFurthestCorner)) {
    return refused(
        ErrorCode::kSettingOutOfRange,
        fmt::format("tracked space: a circle of radius {} m cannot work: give 0.1 m to 10 km.",
                    radius));
  }
  Ring ring;
  for (int i = 0; i < kCircleCorners; ++i)
    ring.push_back(radius * directionOf(2.0 * kPi * i / kCircleCorners));
  return polygon(ring);
}

tl::expected<TrackedSpace, Error> TrackedSpace::polygon(
    std::span<const glm::dvec2> border, std::span<const std::vector<glm::dvec2>> holes) {
  std::size_t corners = border.size();
  for (const Ring& hole : holes) corners += hole.size();
  if (corners > kMostCorners) {
    return refused(ErrorCode::kTooLarge,
                   fmt::format("tracked space: {} corners, {} are the limit. Simplify its border.",
                               corners, kMostCorners));
  }
  std::vector<Ring> rings;
  for (std::size_t r = 0; r <= holes.size(); ++r) {
    auto ring = soundRing(r == 0 ? border : std::span<const glm::dvec2>(holes[r - 1]), r);
    if (!ring) return tl::unexpected(ring.error());
    rings.push_back(std::move(*ring));
  }
  if (auto ok = checkCrossings(rings); !ok) return tl::unexpected(ok.error());

  TrackedSpace space{Unchecked{}};
  space.ringStart_.push_back(0);
  for (const Ring& ring : rings) {
    space.corners_.insert(space.corners_.end(), ring.begin(), ring.end());
    space.ringStart_.push_back(space.corners_.size());
  }
  space.measure();
  if (space.area_ < kSmallestArea) {
    return refused(
        ErrorCode::kDataDamaged,
        fmt::format("tracked space: its holes leave {} m^2 of {} m^2, at least {} m^2 are needed.",
                    space.area_, signedArea(rings[0]), kSmallestArea));
  }
  return space;
}

void TrackedSpace::measure() {
  lower_ = upper_ = corners_.front();
  for (const glm::dvec2 corner : ring(0)) {
    lower_ = glm::min(lower_, corner);
    upper_ = glm::max(upper_, corner);
  }
  shorterSide_ = INFINITY;
  const std::span<const glm::dvec2> border = ring(0);
  for (std::size_t i = 0, j = border.size() - 1; i < border.size(); j = i++) {
    const glm::dvec2 edge = border[i] - border[j];
    const glm::dvec2 normal = glm::dvec2(-edge.y, edge.x) / lengthOf(edge);
    double least = INFINITY, most = -INFINITY;
    for (const glm::dvec2 corner : border) {
      least = std::min(least, dot(corner, normal));
      most = std::max(most, dot(corner, normal));
    }
    shorterSide_ = std::min(shorterSide_, most - least);
  }
  area_ = 0.0;
  for (std::size_t r = 0; r < ringCount(); ++r) area_ += signedArea(ring(r));

  // Polylabel: cut squares into four, the most promising first, until none can be better by a
  // millimetre.
  struct Cell {
    glm::dvec2 middle;
    double half;
    double distance;
    double best() const { return distance + half * 1.4142135623730951; }
  };
  const auto less = [](const Cell& a, const Cell& b) {
    if (a.best() != b.best()) return a.best() < b.best();
    if (a.middle.x != b.middle.x) return a.middle.x > b.middle.x;
    return a.middle.y > b.middle.y;
  };
  std::priority_queue<Cell, std::vector<Cell>, decltype(less)> cells(less);
  const auto push = [&](glm::dvec2 middle, double half) {
    cells.push({middle, half, signedDistance(middle)});
  };

  centre_ = centroidOf(ring(0));
  clearance_ = signedDistance(centre_);
  const glm::dvec2 extent = upper_ - lower_;
  // A sliver is covered by at most 64 squares; their size only decides where the search begins.
  const double size = std::max(std::min(extent.x, extent.y), std::max(extent.x, extent.y) / 64.0);
  for (double x = lower_.x; x < upper_.x; x += size) {
    for (double y = lower_.y; y < upper_.y; y += size)
      push({x + 0.5 * size, y + 0.5 * size}, 0.5 * size);
  }
  while (!cells.empty()) {
    const Cell cell = cells.top();
    cells.pop();
    // Better by a whisker is rounding: the centroid, or the first found, stays.
    if (cell.distance > clearance_ + 1e-6) {
      centre_ = cell.middle;
      clearance_ = cell.distance;
    }
    if (cell.best() - clearance_ <= kPolePrecision) break;  // and so are all that are left
    const double half = 0.5 * cell.half;
    for (const glm::dvec2 corner :
         {glm::dvec2(-1, -1), glm::dvec2(1, -1), glm::dvec2(-1, 1), glm::dvec2(1, 1)}) {
      push(cell.middle + half * corner, half);
    }
  }
}

bool TrackedSpace::contains(glm::dvec2 point) const { return signedDistance(point) >= -kOnBorder; }

double TrackedSpace::signedDistance(glm::dvec2 point) const {
  bool inside = false;
  double nearest2 = INFINITY;
  for (std::size_t r = 0; r < ringCount(); ++r) {
    const std::span<const glm::dvec2> corners = ring(r);
    for (std::size_t i = 0, j = corners.size() - 1; i < corners.size(); j = i++) {
      const glm::dvec2 off = nearestOnSegment(corners[j], corners[i], point) - point;
      nearest2 = std::min(nearest2, dot(off, off));
    }
    // Even-odd over all rings: inside the border and in no hole.
    if (insideRing(corners, point)) inside = !inside;
  }
  const double distance = std::sqrt(nearest2);
  return inside ? distance : -distance;
}

TrackedSpace::BorderPoint TrackedSpace::nearestBorder(glm::dvec2 point) const {
  glm::dvec2 nearest(0.0);
  glm::dvec2 edge(1.0, 0.0);
  double nearest2 = INFINITY;
  bool inside = false;
  for (std::size_t r = 0; r < ringCount(); ++r) {
    const std::span<const glm::dvec2> corners = ring(r);
    for (std::size_t i = 0; i < corners.size(); ++i) {
      const glm::dvec2 a = corners[i];
      const glm::dvec2 b = corners[(i + 1) % corners.size()];
      const glm::dvec2 on = nearestOnSegment(a, b, point);
      const double distance2 = dot(on - point, on - point);
      if (distance2 < nearest2) {
        nearest2 = distance2;
        nearest = on;
        edge = b - a;
      }
    }
    if (insideRing(corners, point)) inside = !inside;
  }
  const double distance = std::sqrt(nearest2);
  const glm::dvec2 normal = glm::dvec2(-edge.y, edge.x) / lengthOf(edge);
  const glm::dvec2 off = (point - nearest) / distance;
  return {nearest, distance < kOnBorder ? normal : inside ? off : -off, distance};
}

double TrackedSpace::distanceAlong(glm::dvec2 point, glm::dvec2 direction) const {
  if (!contains(point)) return 0.0;
  double nearest = INFINITY;
  for (std::size_t r = 0; r < ringCount(); ++r) {
    const std::span<const glm::dvec2> corners = ring(r);
    for (std::size_t i = 0; i < corners.size(); ++i) {
      const glm::dvec2 a = corners[i];
      const glm::dvec2 ab = corners[(i + 1) % corners.size()] - a;
      // The floor lies left of every edge, so only a way that crosses to the right leaves it.
      const double crossing = cross(ab, direction);
      if (crossing >= 0.0) continue;
      const double along = cross(a - point, ab) / -crossing;         // metres from `point`
      const double share = cross(a - point, direction) / -crossing;  // of the edge
      if (along < -kOnBorder || share < -1e-12 || share > 1.0 + 1e-12) continue;
      nearest = std::min(nearest, std::max(along, 0.0));
    }
  }
  return std::isfinite(nearest) ? nearest : 0.0;
}

}  // namespace forewalk::rdw
