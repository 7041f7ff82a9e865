#include "prediction/wall_profile.h"
#include "navmesh/plan.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace forewalk::prediction {

using navmesh::cross;

using glm::dvec2;

namespace {

/// Extremes nearer than this to an end of their wall, or less high than this, are not told apart
/// from the end; metres.
constexpr double kApart = 1e-3;

constexpr float kBeyond = std::numeric_limits<float>::infinity();

}  // namespace

WallProfile::WallProfile(const CellMesh& mesh, std::uint32_t ends) : mesh_(&mesh), ends_(ends) {
  firstOf_.assign(mesh.walls.size(), kNone);
  // Room for what is usual; where more is seen, buffers grow.
  const std::size_t walls = std::min<std::size_t>(mesh.walls.size(), 4096);
  touched_.reserve(walls);
  samples_.reserve(64 + 2 * walls);
  stretches_.reserve(64 + walls);
  extremes_.reserve(64 + walls);
  sights_.reserve(256);
  feet_.reserve(64);
}

void WallProfile::reset() {
  for (const std::uint32_t wall : touched_) firstOf_[wall] = kNone;
  touched_.clear();
  samples_.clear();
  stretches_.clear();
  extremes_.clear();
}

void WallProfile::measure(const DistanceField& field, const Views& views, float horizon) {
  reset();
  field_ = &field;
  views_ = &views;
  horizon_ = horizon;
  for (const PolygonId polygon : field.polygons()) {
    const std::span<const CellMesh::Corner> corners = mesh_->cornersOf(polygon);
    std::uint32_t known = kNone;  // the end of the last wall, where the next may begin
    float value = 0.0f;
    for (std::size_t i = 0; i < corners.size(); ++i) {
      const CellMesh::Corner& corner = corners[i];
      if (corner.wall == kNone) continue;
      const float from = corner.vertex == known ? value : valueAt(corner.vertex, polygon);
      known = corners[i + 1 < corners.size() ? i + 1 : 0].vertex;
      value = valueAt(known, polygon);
      addWall(corner, polygon, from, value);
    }
  }
  link();
  findExtremes();
}

float WallProfile::valueAt(std::uint32_t vertex, PolygonId polygon) {
  // Of an end the field knows the distance already, if it is within the horizon.
  const float value =
      vertex < ends_
          ? field_->endDistance(vertex)
          : static_cast<float>(nearestOf(views_->of(polygon), dvec2(mesh_->plan[vertex])).distance);
  return value <= horizon_ ? value : kBeyond;
}

void WallProfile::addSample(std::uint32_t wall, double along, float value, const View* before,
                            const View* after) {
  samples_.push_back({wall, value, along, before, after, kNone, kNone, kNone, true});
}

/// Finds who sees a wall and may be nearest to some of it. False if distances rise or fall all
/// along it, whoever is nearest where: then nothing more need be known.
bool WallProfile::findSights(const CellMesh::Corner& line, std::span<const View> views, float from,
                             float to) {
  double first = line.length;
  double last = 0.0;
  for (const View& view : views) {
    const double foot = glm::dot(view.root - line.from, line.along);
    first = std::min(first, foot);
    last = std::max(last, foot);
  }
  if (first > line.length - kApart || last < kApart) return false;

  // By one of its ends, no place of the wall is farther than this.
  const double farthest =
      std::min(0.5 * (static_cast<double>(from) + static_cast<double>(to) + line.length),
               static_cast<double>(horizon_)) +
      kApart;
  sights_.clear();
  firstFoot_ = line.length;
  lastFoot_ = 0.0;
  for (const View& view : views) {
    const dvec2 ray = view.root - line.from;
    const double foot = glm::dot(ray, line.along);
    const double aside = cross(ray, line.along);
    const double beside = foot - std::clamp(foot, 0.0, line.length);
    const double spare = farthest - view.distance;
    if (spare < 0.0 || aside * aside + beside * beside > spare * spare) continue;
    firstFoot_ = std::min(firstFoot_, foot);
    lastFoot_ = std::max(lastFoot_, foot);
    sights_.push_back({foot, aside * aside, &view});
  }
  return firstFoot_ <= line.length - kApart && lastFoot_ >= kApart;
}

/// The length of the shortest way to a place of the wall whose sights are at hand.
double WallProfile::lookAt(const CellMesh::Corner& line, double place,
                           const Sight*& nearest) const {
  double best = std::numeric_limits<double>::infinity();
  const dvec2 point = line.from + place * line.along;
  for (const Sight& sight : sights_) {
    const double along = place - sight.foot;
    const double length = sight.view->distance + std::sqrt(sight.asideSquared + along * along);
    if (length < best && sight.view->sees(point)) {
      best = length;
      nearest = &sight;
    }
  }
  return best;
}

/// Where two sights of a wall are equally long: between `left`, where distances by the first rise,
/// and `right`, where those by the second fall; metres along it.
double WallProfile::equallyFar(const Sight& rising, const Sight& falling, double left,
                               double right) {
  double at = 0.5 * (left + right);
  for (int i = 0; i < 8; ++i) {
    const double a = at - rising.foot;
    const double b = at - falling.foot;
    const double lengthA = std::sqrt(rising.asideSquared + a * a);
    const double lengthB = std::sqrt(falling.asideSquared + b * b);
    const double excess = rising.view->distance + lengthA - falling.view->distance - lengthB;
    const double slope = a / lengthA - b / lengthB;  // Newton: it is positive all the way
    const double next = std::clamp(at - excess / slope, left, right);
    if (std::abs(next - at) < 1e-7) return next;
    at = next;
  }
  return at;
}

/// Where the distance is highest between two places of a wall, metres along it, if it rises at the
/// first and falls at the second; else 0. Also by whom it rises and falls there.
double WallProfile::highestBetween(const CellMesh::Corner& line, double low, double high,
                                   const Sight*& rising, const Sight*& falling) const {
  const double inward = std::min(kApart, 0.25 * (high - low));
  double left = low + inward;
  double right = high - inward;
  if (!(firstFoot_ < left && lastFoot_ > right)) return 0.0;
  rising = falling = nullptr;
  lookAt(line, left, rising);
  if (rising == nullptr || !(rising->foot < left)) return 0.0;
  lookAt(line, right, falling);
  if (falling == nullptr || !(falling->foot > right)) return 0.0;
  // Between the two a third may be nearer: then it takes the place of one of them.
  double at = left;
  for (std::size_t i = 0; i <= sights_.size(); ++i) {
    at = equallyFar(*rising, *falling, left, right);
    const Sight* nearest = nullptr;
    const double length = lookAt(line, at, nearest);
    const double along = at - rising->foot;
    const double there = rising->view->distance + std::sqrt(rising->asideSquared + along * along);
    if (nearest == nullptr || nearest == rising || nearest == falling || length > there - 1e-9) {
      break;
    }
    if (nearest->foot < at) {
      rising = nearest;
      left = at;
    } else {
      falling = nearest;
      right = at;
    }
  }
  const dvec2 point = line.from + at * line.along;
  if (rising->view->sees(point) && falling->view->sees(point)) return at;
  // A corner hides one of the two there, and its way around that corner is longer: by halves.
  left = low + inward;
  right = high - inward;
  for (int i = 0; i < 16 && right - left > 1e-4; ++i) {
    const double middle = 0.5 * (left + right);
    const Sight* nearest = nullptr;
    lookAt(line, middle, nearest);
    if (nearest != nullptr && nearest->foot < middle) {
      rising = nearest;
      left = middle;
    } else {
      if (nearest != nullptr) falling = nearest;
      right = middle;
    }
  }
  return 0.5 * (left + right);
}

/// Finds where the front touches the wall whose sights are at hand.
void WallProfile::findFeet(const CellMesh::Corner& line) {
  feet_.clear();
  for (const Sight& sight : sights_) {
    if (sight.foot < kApart || sight.foot > line.length - kApart) continue;
    const double there = sight.view->distance + std::sqrt(sight.asideSquared);
    if (there > static_cast<double>(horizon_)) continue;
    const dvec2 point = line.from + sight.foot * line.along;
    if (!sight.view->sees(point)) continue;
    const bool nearer = std::any_of(sights_.begin(), sights_.end(), [&](const Sight& other) {
      const double along = sight.foot - other.foot;
      const double spare = there - 1e-6 - other.view->distance;
      return spare > 0.0 && other.asideSquared + along * along < spare * spare &&
             other.view->sees(point);
    });
    if (nearer) continue;
    feet_.push_back({sight.foot, there, sight.view});
  }
  if (feet_.size() > 1) {
    std::sort(feet_.begin(), feet_.end(),
              [](const Foot& a, const Foot& b) { return a.along < b.along; });
  }
}

/// Adds the samples of a wall: its beginning, and where the distance along it is lowest or highest.
void WallProfile::addWall(const CellMesh::Corner& line, PolygonId polygon, float from, float to) {
  const std::uint32_t wall = line.wall;
  firstOf_[wall] = static_cast<std::uint32_t>(samples_.size());
  touched_.push_back(wall);
  addSample(wall, 0.0, from, nullptr, nullptr);
  if (!findSights(line, views_->of(polygon), from, to)) return;
  findFeet(line);
  const bool oneRoot = std::all_of(sights_.begin(), sights_.end(), [&](const Sight& sight) {
    return sight.view->root == sights_.front().view->root;
  });
  double before = 0.0;
  const auto addHighest = [&](double upTo) {
    if (oneRoot || !(upTo - before > 4 * kApart)) return;
    const Sight* rising = nullptr;
    const Sight* falling = nullptr;
    const double highest = highestBetween(line, before, upTo, rising, falling);
    if (highest == 0.0) return;
    const Sight* nearest = nullptr;
    const float value = static_cast<float>(lookAt(line, highest, nearest));
    addSample(wall, highest, value, rising->view, falling->view);
  };
  for (const Foot& foot : feet_) {
    if (foot.along - before < kApart) continue;  // two roots in one place
    addHighest(foot.along);
    addSample(wall, foot.along, static_cast<float>(foot.distance), foot.view, foot.view);
    before = foot.along;
  }
  addHighest(line.length);
}

/// Joins each sample to the next along the border. What was not reached lies beyond.
void WallProfile::link() {
  const std::uint32_t count = static_cast<std::uint32_t>(samples_.size());
  for (std::uint32_t s = 0; s < count; ++s) {
    Sample& sample = samples_[s];
    const bool inWall = s + 1 < count && samples_[s + 1].wall == sample.wall;
    const std::uint32_t next = inWall ? s + 1 : firstOf_[mesh_->walls[sample.wall].next];
    sample.next = next;
    if (next == kNone) continue;
    const float there = samples_[next].value;
    sample.rises = sample.value < there || (sample.value == there && s < next);
    samples_[next].previous = s;
  }
}

void WallProfile::findExtremes() {
  for (std::uint32_t s = 0; s < samples_.size(); ++s) {
    const Sample& sample = samples_[s];
    if (!(sample.value <= horizon_)) continue;
    const bool rose = sample.previous != kNone && samples_[sample.previous].rises;
    if (rose == sample.rises) continue;
    extremes_.push_back({s, sample.rises, static_cast<std::uint32_t>(stretches_.size())});
    if (sample.rises) layStretches(s);
  }
}

/// Names the two stretches that go up from a lowest place, as far as they lie within the horizon.
void WallProfile::layStretches(std::uint32_t low) {
  const std::uint32_t against = static_cast<std::uint32_t>(stretches_.size());
  Stretch falling{low, kBeyond};
  for (std::uint32_t s = samples_[low].previous; s != kNone; s = samples_[s].previous) {
    samples_[s].stretch = against;
    if (!(samples_[s].value <= horizon_)) break;
    const std::uint32_t previous = samples_[s].previous;
    if (previous != kNone && samples_[previous].rises) {
      falling.top = samples_[s].value;
      break;
    }
  }
  Stretch rising{low, kBeyond};
  for (std::uint32_t s = low; s != kNone && samples_[s].value <= horizon_; s = samples_[s].next) {
    if (!samples_[s].rises) {
      rising.top = samples_[s].value;
      break;
    }
    samples_[s].stretch = against + 1;
  }
  stretches_.push_back(falling);
  stretches_.push_back(rising);
}

/// The samples of a stretch between which it is `level` metres away.
WallProfile::Between WallProfile::around(std::uint32_t stretch, float level) const {
  const bool rising = stretch % 2 == 1;
  Between between{stretches_[stretch].low, kNone};
  for (;;) {
    const Sample& sample = samples_[between.below];
    between.above = rising ? sample.next : sample.previous;
    if (between.above == kNone || !(samples_[between.above].value <= level)) return between;
    if (samples_[between.above].value < sample.value || between.above == stretches_[stretch].low) {
      between.above = kNone;  // over the top
      return between;
    }
    between.below = between.above;
  }
}

WallProfile::Reach WallProfile::reachOf(std::uint32_t stretch, float level) const {
  const Between between = around(stretch, level);
  const std::uint32_t first = stretch % 2 == 1 ? between.below : between.above;
  if (first == kNone) {
    const Sample& below = samples_[between.below];
    return {below.wall, below.along, below.along};
  }
  const Sample& sample = samples_[first];
  const bool inWall = first + 1 < samples_.size() && samples_[first + 1].wall == sample.wall;
  return {sample.wall, sample.along,
          inWall ? samples_[first + 1].along : mesh_->lines[mesh_->walls[sample.wall].edge].length};
}

dvec2 WallProfile::placeNear(std::uint32_t stretch, float level) const {
  const Between between = around(stretch, level);
  const Sample& below = samples_[between.below];
  const dvec2 low = placeOf(below);
  if (between.above == kNone) return low;
  const Sample& above = samples_[between.above];
  const dvec2 high = placeOf(above);
  const double length = glm::distance(low, high);
  // From a foot on, distances are known exactly; else they rise evenly, or as fast as they can.
  double along = static_cast<double>(level - below.value);
  if (below.after != nullptr) {
    const double aside = static_cast<double>(below.value) - below.after->distance;
    const double radius = static_cast<double>(level) - below.after->distance;
    along = std::sqrt(std::max(0.0, radius * radius - aside * aside));
  } else if (above.value < kBeyond && above.value > below.value) {
    along *= length / static_cast<double>(above.value - below.value);
  }
  return length > along ? low + along / length * (high - low) : high;
}

std::uint32_t WallProfile::sampleBefore(std::uint32_t wall, double along) const {
  std::uint32_t s = firstOf_[wall];
  if (s == kNone) return kNone;
  while (s + 1 < samples_.size() && samples_[s + 1].wall == wall &&
         samples_[s + 1].along <= along) {
    ++s;
  }
  return s;
}

}  // namespace forewalk::prediction
