// Which piece of the front it is that something happens to.
#include <span>

#include "navmesh/plan.h"
#include "prediction/front_sweep.h"

namespace forewalk::prediction {

using glm::dvec2;

namespace {

/// How long before an event the front is followed, as distance; metres. Over it, rounding in what
/// was measured does not show.
constexpr double kBefore = 2e-5;

}  // namespace

/// The place a little toward the root of the view that comes to `place`.
FrontSweep::Spot FrontSweep::spotBefore(dvec2 place, float value, PolygonId polygon,
                                        const View* view) const {
  Spot spot{polygon, view, place, static_cast<double>(value)};
  if (view == nullptr) return spot;
  const dvec2 ray = place - view->root;
  const double radius = glm::length(ray);
  const double before = std::min(kBefore, 0.5 * radius);
  if (radius > 0.0) spot.at = view->root + (radius - before) / radius * ray;
  spot.level = view->distance + radius - before;
  return spot;
}

/// The same at a place on a wall, by the view that comes along the border, or goes on along it.
FrontSweep::Spot FrontSweep::spotAt(const WallProfile::Sample& sample, bool after) const {
  const dvec2 place = walls_.placeOf(sample);
  if (sample.before != nullptr) {
    return spotBefore(place, sample.value, walls_.polygonOf(sample),
                      after ? sample.after : sample.before);
  }
  const std::uint32_t vertex = mesh_->edges[mesh_->walls[sample.wall].edge].from;
  PolygonId polygon = walls_.polygonOf(sample);
  if (vertex < ends_->count() && field_->cornerBeforeEnd(vertex) != kNone) {
    polygon = field_->polygonBeforeEnd(vertex);
  }
  return spotBefore(place, sample.value, polygon, nearestOf(views_.of(polygon), place).view);
}

/// The arc that a followed front ends: its left end lies on a stretch that runs against the
/// border's direction, its right end on one along it. Near an extreme rounding may lead to the
/// stretch beside.
std::uint32_t FrontSweep::arcOn(const FrontEnd& end, bool left) const {
  if (end.how != FrontEnd::How::kWall) return kNone;
  const std::uint32_t sample = walls_.sampleBefore(end.wall, end.along);
  if (sample == kNone) return kNone;
  const WallProfile::Sample& found = walls_.samples()[sample];
  for (const std::uint32_t s : {sample, found.next, found.previous}) {
    if (s == kNone) continue;
    const std::uint32_t stretch = walls_.samples()[s].stretch;
    if (stretch == kNone || (stretch % 2 == 0) != left) continue;
    if (arcOf_[stretch] != kNone) return arcOf_[stretch];
  }
  return kNone;
}

/// The arc that passes at a spot, followed one way, or where that is not clear the other.
std::uint32_t FrontSweep::arcAt(const Spot& spot, Direction direction) {
  if (alive_.empty()) return kNone;
  if (alive_.size() == 1) return alive_.front();
  if (spot.view != nullptr) {
    // Right where a front sets out it is too small to be followed.
    if (seeds_.size() > 1) {
      const Seed& seed = seeds_[seedOf(spot.view->corner)];
      if (!seed.opened && seed.arc != kNone && !hasPockets()) return seed.arc;
    }
    for (int tries = 0; tries < 2; ++tries) {
      const FrontEnd end = trace_.follow(spot.polygon, *spot.view, spot.at, spot.level, direction);
      const std::uint32_t arc = end.how == FrontEnd::How::kClosed
                                    ? closedArc(spot)
                                    : arcOn(end, direction == Direction::kLeftwards);
      if (arc != kNone) return arc;
      direction =
          direction == Direction::kLeftwards ? Direction::kRightwards : Direction::kLeftwards;
    }
  }
  ++doubts_;
  return alive_.front();
}

/// The arc that is the piece of a sector; kNone where that is closed, or not known.
std::uint32_t FrontSweep::arcOfSector(std::uint32_t sector) const {
  if (sector == kNone) return kNone;
  const std::uint32_t left = roots_.leftEndOf(sector);
  return left == kNone ? kNone : arcOf_[left];
}

/// Takes in the roots nearer than `upTo` metres.
void FrontSweep::admitRoots(float upTo) {
  const std::span<const Corner> corners = field_->corners();
  for (; admitted_ < corners.size() && corners[admitted_].distance < upTo; ++admitted_) {
    admitRoot(admitted_);
  }
}

/// A corner becomes a root: at an end of the piece that comes along its wall, or, where the front
/// split there, of both. One that is in doubt is left out.
void FrontSweep::admitRoot(std::uint32_t corner) {
  const std::uint32_t end = field_->endOf(corner);
  const std::uint32_t wall = end == kNone ? kNone : wallAt_[end];
  const std::uint32_t number = wall == kNone ? kNone : walls_.sampleBefore(wall, 0.0);
  if (number == kNone) return;
  const WallProfile::Sample& sample = walls_.samples()[number];
  if (sample.stretch == kNone || sample.previous == kNone) return;
  const Corner& at = field_->corners()[corner];
  const glm::dvec2 arrival = dvec2(at.plan) - dvec2(field_->corners()[at.previous].plan);
  if (arrival == dvec2(0.0)) return;
  const bool rose = walls_.samples()[sample.previous].rises;
  if (rose == sample.rises) {
    roots_.add(corner, arrival, sample.stretch);
  } else if (sample.rises) {
    // Who turns right about it comes along the right end of the piece that passes it on the left.
    const std::uint32_t leftEnd = sample.stretch - 1;
    const std::uint32_t rightEnd = sample.stretch;
    const DistanceField::Bends bends = field_->bendsAt(end, arrival);
    if (bends.left && bends.right) {
      roots_.addBetween(corner, arrival, leftEnd, rightEnd);
    } else if (bends.left || bends.right) {
      roots_.add(corner, arrival, bends.left ? leftEnd : rightEnd);
    }
  }
}

/// The sector that touches a wall at its lowest place, and in which direction from its root; kNone
/// where that is not known.
std::uint32_t FrontSweep::sectorTouching(const WallProfile::Sample& sample, const Spot& spot,
                                         dvec2& direction) const {
  if (!ordered_ || spot.view == nullptr) return kNone;
  const CellMesh::Wall& wall = mesh_->walls[sample.wall];
  const auto into = [this](std::uint32_t edge) {
    const dvec2 along = mesh_->lines[edge].along;
    return dvec2(along.y, -along.x);
  };
  if (sample.before != nullptr) {
    direction = into(wall.edge);  // also of who stands at it
    return roots_.sectorOf(spot.view->corner, direction);
  }
  // At a corner: by the root before it, and not by the corner itself.
  const std::uint32_t vertex = mesh_->edges[wall.edge].from;
  const std::uint32_t root =
      vertex < ends_->count() ? field_->cornerBeforeEnd(vertex) : spot.view->corner;
  if (root == kNone) return kNone;
  direction = walls_.placeOf(sample) - dvec2(field_->corners()[root].plan);
  constexpr double kAtWall = 2e-3;  // metres
  if (glm::dot(direction, direction) < kAtWall * kAtWall) {
    direction = into(wall.edge) + into(mesh_->walls[wall.previous].edge);
  }
  return direction == dvec2(0.0) ? kNone : roots_.sectorOf(root, direction);
}

}  // namespace forewalk::prediction
