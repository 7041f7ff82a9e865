#include "prediction/front_sweep.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "navmesh/plan.h"

namespace forewalk::prediction {

using glm::dvec2;
using navmesh::cross;
using navmesh::KeyQueue;
using navmesh::kNoPolygon;
using navmesh::NavGraph;

namespace {

/// A piece of the front that is about to end is shorter than this then, metres; one that is about
/// to close around a pillar, and the place that it set out from, is longer.
constexpr double kLastPiece = 0.25;

/// Whether a highest place within a wall is one of all that is about it: where the fronts of the
/// two roots would meet in the open, that is off the wall, and between does not lead farther away.
bool isPeak(const WallProfile::Sample& high, const CellMesh::Line& wall) {
  constexpr double kBeside = 2e-3;  // metres; nearer than that it may be the meeting itself
  if (high.before == nullptr) return false;
  const dvec2 between = high.after->root - high.before->root;
  const double gap = glm::length(between);
  const double half = 0.5 * (gap + high.after->distance - high.before->distance);
  const dvec2 place = high.before->root + half / gap * between;
  return cross(wall.along, place - wall.from) > kBeside;
}

/// The point with the largest x of a piece that was followed rightwards.
dvec2 rightmostOf(const FrontPiece& piece) {
  const dvec2 root = piece.view->root;
  const dvec2 start = piece.from - root;
  const double radius = glm::length(start);
  const auto turnTo = [&](dvec2 ray) {  // rises from 0 to 4 on the way around
    const double cosine = glm::dot(start, ray) / (radius * radius);
    return cross(start, ray) <= 0.0 ? 1.0 - cosine : 3.0 + cosine;
  };
  const dvec2 outmost(radius, 0.0);
  const bool whole = piece.from == piece.to;
  if (whole || turnTo(outmost) <= turnTo(piece.to - root)) return root + outmost;
  return piece.from.x > piece.to.x ? piece.from : piece.to;
}

}  // namespace

FrontSweep::FrontSweep(const NavGraph& graph, const PortalEnds& ends, const CellMesh& cells,
                       std::uint32_t windows)
    : graph_(&graph),
      ends_(&ends),
      mesh_(&cells),
      views_(graph.polygonCount(), windows),
      walls_(cells, ends.count()),
      trace_(cells, views_) {
  const std::size_t walls = 64 + std::min<std::size_t>(cells.walls.size(), 4096);
  order_.reserve(walls);
  arcOf_.reserve(walls);
  endsOf_.reserve(walls);
  alive_.reserve(walls);
  events_.reserve(walls);
  arcs_.reserve(walls);
  fronts_.reserve(walls);
  meetings_.reserve(64);
  seeds_.reserve(64);
  entered_.reserve(64);
  pieces_.reserve(256);
  roots_.reserve(walls, walls);
  wallAt_.assign(ends.count(), kNone);
  std::vector<bool> several(ends.count());
  for (std::uint32_t wall = 0; wall < cells.walls.size(); ++wall) {
    const std::uint32_t vertex = cells.edges[cells.walls[wall].edge].from;
    if (vertex >= ends.count() || several[vertex]) continue;
    several[vertex] = wallAt_[vertex] != kNone;
    wallAt_[vertex] = several[vertex] ? kNone : wall;
  }
}

void FrontSweep::run(const DistanceField& field, const navmesh::Location& source, float horizon) {
  field_ = &field;
  horizon_ = horizon;
  doubts_ = 0;
  views_.gather(field);
  walls_.measure(field, views_, horizon);
  meetings_.clear();
  for (const PolygonId polygon : field.polygons()) {
    if (views_.of(polygon).size() > 1) findMeetings(polygon);
  }
  events_.clear();
  arcs_.clear();
  fronts_.clear();
  endsOf_.clear();
  alive_.clear();
  arcOf_.assign(walls_.stretches().size(), kNone);
  seeds_.clear();
  entered_.assign(field.passages().size(), kNone);
  addArc(addEvent(dvec2(source.plan), source.polygon, 0.0f), {kNone, kNone});
  seeds_.push_back({0, 0, false});
  listEvents();
  // What comes out of links is closed, and roots about it are in no row.
  ordered_ = field.passages().empty();
  if (ordered_) roots_.start(field.corners().size(), walls_.stretches().size());
  admitted_ = 1;
  const std::size_t links = 2 * field.passages().size();
  const std::size_t extremes = walls_.extremes().size();
  for (const Key key : order_) {
    std::uint32_t number = index(KeyQueue::polygonOf(key));
    if (number < links) {
      number % 2 == 0 ? enterLink(number / 2) : leaveLink(number / 2);
      continue;
    }
    number -= static_cast<std::uint32_t>(links);
    if (ordered_) admitRoots(KeyQueue::keyOf(key));
    if (number >= extremes) {
      meet(meetings_[number - extremes]);
    } else if (const WallProfile::Extreme& extreme = walls_.extremes()[number]; extreme.low) {
      touch(extreme);
    } else {
      close(extreme);
    }
  }
  endAtHorizon();
}

/// Where two fronts meet first inside a polygon: between two roots that see each other's way, at
/// the same distance by both.
void FrontSweep::findMeetings(PolygonId polygon) {
  const std::span<const View> views = views_.of(polygon);
  // Whether a view looks that way, or is within a micrometre of it.
  const auto looks = [](const View& view, dvec2 way) {
    constexpr double kSlack = 1e-6;
    const double left = way.x * view.left.y - way.y * view.left.x;
    const double right = view.right.x * way.y - view.right.y * way.x;
    return view.whole || std::min(left, right) > -kSlack;
  };
  for (std::size_t i = 0; i < views.size(); ++i) {
    for (std::size_t j = i + 1; j < views.size(); ++j) {
      const dvec2 between = views[j].root - views[i].root;
      const double squared = glm::dot(between, between);
      const double lead = views[j].distance - views[i].distance;
      // One comes by way of the other, or they look elsewhere.
      if (squared <= lead * lead + 1e-6 || !looks(views[i], between) ||
          !looks(views[j], -between)) {
        continue;
      }
      const double gap = std::sqrt(squared);
      const double half = 0.5 * (gap + lead);
      const double value = views[i].distance + half;
      if (value > static_cast<double>(horizon_)) continue;
      const dvec2 place = views[i].root + half / gap * between;
      if (!views[i].sees(place) || !views[j].sees(place) ||
          !navmesh::contains(*graph_, polygon, glm::vec2(place)) ||
          nearestOf(views, place).distance < value - 1e-6) {
        continue;
      }
      // On a wall it is the highest place of the wall. On a portal the other polygon finds it too.
      constexpr double kBeside = 1e-3;
      bool known = false;
      for (const CellMesh::Corner& corner : mesh_->cornersOf(polygon)) {
        const CellMesh::Line& line = mesh_->lines[corner.edge];
        const dvec2 ray = place - line.from;
        const bool wall = mesh_->wallOfEdge[corner.edge] != kNone;
        known = known || (wall && std::abs(cross(ray, line.along)) < kBeside);
      }
      for (const Meeting& meeting : meetings_) {
        const dvec2 apart = meeting.place - place;
        known = known || glm::dot(apart, apart) < kBeside * kBeside;
      }
      if (known) continue;
      meetings_.push_back({place, static_cast<float>(value), polygon, {&views[i], &views[j]}});
    }
  }
}

void FrontSweep::listEvents() {
  order_.clear();
  std::uint32_t number = 0;
  // Links first: a wall may stand right where one leads.
  for (const LinkPassage& passage : field_->passages()) {
    const std::span<const Corner> corners = field_->corners();
    order_.push_back(KeyQueue::entryOf(corners[passage.entry].distance, PolygonId{number}));
    if (passage.exit != kNone) {
      order_.push_back(KeyQueue::entryOf(corners[passage.exit].distance, PolygonId{number + 1}));
    }
    number += 2;
  }
  for (const WallProfile::Extreme& extreme : walls_.extremes()) {
    order_.push_back(
        KeyQueue::entryOf(walls_.samples()[extreme.sample].value, PolygonId{number++}));
  }
  for (const Meeting& meeting : meetings_) {
    order_.push_back(KeyQueue::entryOf(meeting.value, PolygonId{number++}));
  }
  std::sort(order_.begin(), order_.end());
}

// --- What happens ---

std::uint32_t FrontSweep::addEvent(dvec2 place, PolygonId polygon, float distance) {
  events_.push_back({glm::vec2(place), polygon, distance});
  return static_cast<std::uint32_t>(events_.size() - 1);
}

void FrontSweep::addArc(std::uint32_t from, Ends ends) {
  const std::uint32_t arc = static_cast<std::uint32_t>(arcs_.size());
  arcs_.push_back({from, kNone, 0, kNone});
  endsOf_.push_back(ends);
  alive_.push_back(arc);
  for (const std::uint32_t stretch : {ends.left, ends.right}) {
    if (stretch != kNone) arcOf_[stretch] = arc;
  }
}

/// The arc ends in the event that was added last.
void FrontSweep::endArc(std::uint32_t arc, std::uint32_t corner) {
  arcs_[arc].to = static_cast<std::uint32_t>(events_.size() - 1);
  arcs_[arc].corner = corner;
  *std::find(alive_.begin(), alive_.end(), arc) = alive_.back();
  alive_.pop_back();
}

/// The front touches a wall, where the distance along it is lowest, and splits.
void FrontSweep::touch(const WallProfile::Extreme& low) {
  const WallProfile::Sample& sample = walls_.samples()[low.sample];
  const std::uint32_t against = low.stretch;
  const std::uint32_t along = low.stretch + 1;
  const Spot spot = spotAt(sample, false);
  dvec2 direction(0.0);
  const std::uint32_t sector = sectorTouching(sample, spot, direction);
  std::uint32_t arc = arcOfSector(sector);
  if (arc == kNone) {
    // To the side that is less deep it is not far to a wall.
    const bool right = walls_.stretches()[against].top < walls_.stretches()[along].top;
    arc = arcAt(spot, right ? Direction::kRightwards : Direction::kLeftwards);
  }
  ordered_ =
      ordered_ && arc != kNone && sector != kNone && roots_.leftEndOf(sector) == endsOf_[arc].left;
  if (ordered_) roots_.split(sector, direction, against, along);
  if (arc == kNone) {
    addArc(0, {against, along});
    return;
  }
  const Ends ends = endsOf_[arc];
  if (ends.left == kNone) {
    // A closed front opens: the same piece, in another shape.
    reseed(arc, kNone);
    endsOf_[arc] = {against, along};
    arcOf_[against] = arcOf_[along] = arc;
    return;
  }
  const std::uint32_t event = addEvent(walls_.placeOf(sample), spot.polygon, sample.value);
  endArc(arc, spot.view != nullptr ? spot.view->corner : 0);
  addArc(event, {against, ends.right});
  addArc(event, {ends.left, along});
}

/// Whether two walls meet at a place on the border, with less than half a turn between them: a
/// front that comes there has nowhere to go.
bool FrontSweep::isHollow(const WallProfile::Sample& sample) const {
  if (sample.before != nullptr) return false;
  const CellMesh::Wall& wall = mesh_->walls[sample.wall];
  const dvec2 arriving = mesh_->lines[mesh_->walls[wall.previous].edge].along;
  return cross(arriving, mesh_->lines[wall.edge].along) > 1e-3;
}

/// Whether an arc whose two ends run into each other, at a spot just before, goes all around what
/// was reached, a pillar's back last: it goes on, closed. Else nothing of it is left.
bool FrontSweep::closesAround(const Spot& spot) {
  if (spot.view == nullptr) return false;
  pieces_.clear();
  trace_.follow(spot.polygon, *spot.view, spot.at, spot.level, Direction::kLeftwards, &pieces_);
  double length = 0.0;
  for (const FrontPiece& piece : pieces_) length += piece.length;
  return length > kLastPiece && glm::distance(pieces_.back().to, spot.at) < 0.1 * kLastPiece;
}

/// Two ends of the front run into each other, where the distance along a wall is highest.
void FrontSweep::close(const WallProfile::Extreme& high) {
  const WallProfile::Sample& sample = walls_.samples()[high.sample];
  if (sample.previous == kNone || sample.stretch == kNone) return;
  const std::uint32_t along = walls_.samples()[sample.previous].stretch;
  if (along == kNone) return;
  const std::uint32_t first = arcOf_[along];            // its right end comes along the border
  const std::uint32_t second = arcOf_[sample.stretch];  // its left end comes against it
  arcOf_[along] = arcOf_[sample.stretch] = kNone;
  if (first == kNone || second == kNone) return;
  ordered_ = ordered_ && roots_.join(along, sample.stretch);
  const std::uint32_t edge = mesh_->walls[sample.wall].edge;
  const Spot before = spotAt(sample, false);
  if (first == second && !isHollow(sample) && !isPeak(sample, mesh_->lines[edge]) &&
      closesAround(before)) {
    endsOf_[first] = {kNone, kNone};
    seeds_[seedOf(before.view->corner)].arc = first;
    return;
  }
  const std::uint32_t event = addEvent(walls_.placeOf(sample), before.polygon, sample.value);
  const auto cornerOf = [](const Spot& spot) {
    return spot.view != nullptr ? spot.view->corner : 0;
  };
  endArc(first, cornerOf(before));
  if (first == second) return;
  const Ends ends{endsOf_[first].left, endsOf_[second].right};
  endArc(second, cornerOf(spotAt(sample, true)));
  addArc(event, ends);
}

/// Two fronts meet in the open, or one meets itself: left of the place they go on as one piece, and
/// right of it as another.
void FrontSweep::meet(const Meeting& meeting) {
  std::uint32_t arcs[2], sectors[2];
  dvec2 rays[2];
  for (int side = 0; side < 2; ++side) {
    const View& view = *meeting.sides[side];
    rays[side] = meeting.place - view.root;
    sectors[side] = ordered_ ? roots_.sectorOf(view.corner, rays[side]) : kNone;
    arcs[side] = arcOfSector(sectors[side]);
    if (arcs[side] != kNone) continue;
    arcs[side] = arcAt(spotBefore(meeting.place, meeting.value, meeting.polygon, &view),
                       Direction::kLeftwards);
    ordered_ = ordered_ && arcs[side] != kNone && sectors[side] != kNone &&
               roots_.leftEndOf(sectors[side]) == endsOf_[arcs[side]].left;
  }
  const auto [a, b] = arcs;
  ordered_ = ordered_ && sectors[0] != sectors[1];
  if (ordered_) roots_.meet(sectors[0], rays[0], sectors[1], rays[1]);
  if (a == kNone || b == kNone) return;
  const std::uint32_t event = addEvent(meeting.place, meeting.polygon, meeting.value);
  const Ends endsA = endsOf_[a];
  const Ends endsB = endsOf_[b];
  endArc(a, meeting.sides[0]->corner);
  const std::uint32_t next = static_cast<std::uint32_t>(arcs_.size());
  if (a == b) {
    if (endsA.left == kNone) reseed(a, next);
    addArc(event, endsA);
    addArc(event, {kNone, kNone});
    return;
  }
  endArc(b, meeting.sides[1]->corner);
  if (endsA.left == kNone || endsB.left == kNone) {
    const bool closed = endsA.left == endsB.left;
    for (const std::uint32_t arc : {a, b}) reseed(arc, closed ? next : kNone);
    addArc(event, endsA.left == kNone ? endsB : endsA);
    return;
  }
  addArc(event, {endsA.left, endsB.right});
  addArc(event, {endsB.left, endsA.right});
}

// --- On walls ---

/// The place of a stretch that is `level` metres away.
bool FrontSweep::spotOnWall(std::uint32_t stretch, float level, Spot& spot) const {
  const WallProfile::Reach reach = walls_.reachOf(stretch, level);
  const std::uint32_t edge = mesh_->walls[reach.wall].edge;
  const CellMesh::Line& line = mesh_->lines[edge];
  spot.polygon = mesh_->edges[edge].left;
  spot.level = static_cast<double>(level);
  spot.at = line.from + 0.5 * (reach.from + reach.to) * line.along;  // if it is not found
  spot.view = nullptr;
  double nearest = 1e-5;
  const std::span<const View> views = views_.of(spot.polygon);
  for (const View& view : views) {
    const double radius = spot.level - view.distance;
    if (radius <= 0.0) continue;
    const dvec2 ray = view.root - line.from;
    const double aside = cross(ray, line.along);
    const double half = radius * radius - aside * aside;
    if (half < 0.0) continue;
    const double foot = glm::dot(ray, line.along);
    const double along = stretch % 2 == 1 ? foot + std::sqrt(half) : foot - std::sqrt(half);
    if (along < reach.from - 1e-6 || along > reach.to + 1e-6) continue;
    const dvec2 place = line.from + along * line.along;
    if (!view.sees(place)) continue;
    // Of several circles that pass here the right one has nobody nearer.
    const double off = views.size() == 1 ? 0.0 : spot.level - nearestOf(views, place).distance;
    if (off >= nearest) continue;
    nearest = off;
    spot.view = &view;
    spot.at = place;
    if (off < 1e-9) break;
  }
  return spot.view != nullptr;
}

float FrontSweep::widthOf(std::uint32_t arc) const {
  const Ends ends = endsOf_[arc];
  if (ends.left == kNone) return 0.0f;
  const std::uint32_t to = arcs_[arc].to;
  const float end = to == kNone ? horizon_ : events_[to].distance;
  const float level = 0.5f * (events_[arcs_[arc].from].distance + end);
  return static_cast<float>(
      glm::distance(walls_.placeNear(ends.left, level), walls_.placeNear(ends.right, level)));
}

// --- The horizon ---

/// An arc reaches the horizon: its front from the spot on.
void FrontSweep::addFront(std::uint32_t arc, const Spot& spot) {
  pieces_.clear();
  const FrontEnd end = trace_.follow(spot.polygon, *spot.view, spot.at, spot.level,
                                     Direction::kRightwards, &pieces_);
  double length = 0.0;
  for (const FrontPiece& piece : pieces_) length += piece.length;
  HorizonFront front{glm::vec2(spot.at), glm::vec2(spot.at), glm::vec2(spot.at), spot.polygon,
                     static_cast<float>(length)};
  arcs_[arc].corner = spot.view->corner;
  if (end.how == FrontEnd::How::kClosed) {
    // No place on it is its middle: the one with the largest x, wherever it was found.
    for (const FrontPiece& piece : pieces_) {
      for (const dvec2 place : {piece.from, rightmostOf(piece)}) {
        if (!(glm::vec2(place).x > front.crossing.x)) continue;
        front.from = front.to = front.crossing = glm::vec2(place);
        front.polygon = piece.polygon;
        arcs_[arc].corner = piece.view->corner;
      }
    }
  } else if (!pieces_.empty()) {
    front.to = glm::vec2(pieces_.back().to);
    double before = 0.0;
    for (const FrontPiece& piece : pieces_) {
      if (before + piece.length < 0.5 * length && &piece != &pieces_.back()) {
        before += piece.length;
        continue;
      }
      const double share = piece.length > 0.0 ? (0.5 * length - before) / piece.length : 0.0;
      front.crossing = glm::vec2(pointOn(piece, std::clamp(share, 0.0, 1.0)));
      front.polygon = piece.polygon;
      arcs_[arc].corner = piece.view->corner;
      break;
    }
  }
  arcs_[arc].front = static_cast<std::uint32_t>(fronts_.size());
  fronts_.push_back(front);
}

void FrontSweep::endAtHorizon() {
  std::sort(alive_.begin(), alive_.end());
  for (const std::uint32_t arc : alive_) {
    Spot spot;
    const bool closed = endsOf_[arc].left == kNone;
    if (closed ? startInTheOpen(arc, spot) : spotOnWall(endsOf_[arc].left, horizon_, spot)) {
      addFront(arc, spot);
    } else if (closed) {
      shrink(arc);
    } else {
      ++doubts_;
    }
  }
}

}  // namespace forewalk::prediction
