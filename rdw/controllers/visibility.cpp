// Visibility polygons. Williams, Bera and Manocha, "Redirected Walking in Static and Dynamic Scenes
// Using Visibility Polygons", TVCG 2021.
//
// What is seen of the floor, in the room and in the virtual world, is cut into triangles, each the
// user and a piece of what ends the view. Of the virtual ones the one whose bisector is nearest the
// heading; of the physical ones within 90 degrees of the heading the one of the most similar area:
// to its bisector the user is turned, at full gain. Translation is the ratio of the mean lengths of
// the two. We depart in that nothing is seen beyond 30 m, and that pieces in one line count as one
// (a navmesh cuts its walls where its polygons end).
#include <algorithm>
#include <cmath>
#include <vector>

#include "navmesh/sight.h"
#include "rdw/controllers/controllers.h"
#include "rdw/controllers/follow.h"

namespace forewalk::rdw {
namespace {

constexpr double kFarthest = 30.0;  // metres
constexpr double kThinnest = 1e-3;  // radians; thinner slices are rounding
constexpr std::size_t kMostSlices = 512;
constexpr double kQuarter = 0.5 * kPi + 1e-9;

double crossed(glm::dvec2 a, glm::dvec2 b) { return a.x * b.y - a.y * b.x; }

/// A triangle of the user and a piece of wall, relative to the user.
struct Slice {
  glm::dvec2 right, left;

  double area() const { return 0.5 * crossed(right, left); }
  double meanLength() const { return 0.5 * (glm::length(right) + glm::length(left)); }
  glm::dvec2 bisector() const { return glm::normalize(right) + glm::normalize(left); }
};

glm::dvec2 shortened(glm::dvec2 v) {
  const double length = glm::length(v);
  return length > kFarthest ? v * (kFarthest / length) : v;
}

class VisibilityPolygons final : public Controller {
 public:
  void prepare(const TrackedSpace& space, const GainLimits&) override {
    std::size_t corners = 0;
    for (std::size_t r = 0; r < space.ringCount(); ++r) corners += space.ring(r).size();
    angles_.reserve(corners);
    pieces_.reserve(kMostSlices);
    scratch_.open.reserve(kMostSlices);
    slices_.reserve(kMostSlices);
  }

  Gains steer(const SteerInput& input) override {
    const glm::dvec2 heading = directionOf(input.virtualPose.heading);
    Slice seen{rotated(heading, -0.5) * kFarthest, rotated(heading, 0.5) * kFarthest};
    virtualSlices(input);
    double nearest = INFINITY;
    for (const Slice& slice : slices_) {
      const double off = std::abs(angleBetween(heading, slice.bisector()));
      if (off >= nearest) continue;
      nearest = off;
      seen = slice;
    }
    const glm::dvec2 ahead = directionOf(input.physical.heading);
    physicalSlices(input.space, input.physical.position);
    const Slice* best = nullptr;
    double least = INFINITY;
    for (const Slice& slice : slices_) {
      if (std::abs(angleBetween(ahead, slice.bisector())) > kQuarter) continue;
      const double off = std::abs(slice.area() - seen.area());
      if (off >= least - 1e-9) continue;
      least = off;
      best = &slice;
    }
    if (best == nullptr) return {};
    Gains gains = follow_.toward(best->bisector(), input);
    gains.translation = static_cast<float>(seen.meanLength() / best->meanLength());
    return clamped(gains, input.limits);
  }

  void restart() override { follow_.restart(); }
  std::string_view name() const override { return "visibility"; }
  bool wantsPrediction() const override { return false; }

 private:
  void add(glm::dvec2 right, glm::dvec2 left) {
    right = shortened(right);
    left = shortened(left);
    if (slices_.size() < kMostSlices && crossed(right, left) > 0.0 &&
        angleBetween(right, left) > kThinnest)
      slices_.push_back({right, left});
  }

  // Pieces in the order round the user; those that go on in one line become one.
  void virtualSlices(const SteerInput& input) {
    slices_.clear();
    if (input.world == nullptr) return;
    navmesh::visibleSlices(input.world->graph, input.place, kFarthest, kMostSlices, scratch_,
                           pieces_);
    const glm::dvec2 origin(input.place.plan);
    std::sort(pieces_.begin(), pieces_.end(),
              [&](const navmesh::SightSlice& a, const navmesh::SightSlice& b) {
                return headingOf(a.right - origin) < headingOf(b.right - origin);
              });
    for (std::size_t i = 0; i < pieces_.size();) {
      const glm::dvec2 right = pieces_[i].right - origin;
      glm::dvec2 left = pieces_[i].left - origin;
      for (++i; i < pieces_.size(); ++i) {
        const glm::dvec2 next = pieces_[i].right - origin;
        const glm::dvec2 end = pieces_[i].left - origin;
        if (glm::distance(next, left) > 1e-3 ||
            std::abs(angleBetween(left - right, end - next)) > 1e-2 || crossed(right, end) <= 0.0)
          break;
        left = end;
      }
      add(right, left);
    }
  }

  // Between two neighbouring directions to corners one edge is in view: the one that the ray
  // between them meets.
  void physicalSlices(const TrackedSpace& space, glm::dvec2 position) {
    slices_.clear();
    angles_.clear();
    for (std::size_t r = 0; r < space.ringCount(); ++r) {
      for (const glm::dvec2 corner : space.ring(r)) {
        if (corner != position) angles_.push_back(headingOf(corner - position));
      }
    }
    std::sort(angles_.begin(), angles_.end());
    Edge last{};
    for (std::size_t i = 0; i < angles_.size(); ++i) {
      const double from = angles_[i];
      const double to = i + 1 < angles_.size() ? angles_[i + 1] : angles_[0] + 2.0 * kPi;
      if (to - from < kThinnest) continue;
      const Edge edge = edgeAlong(space, position, directionOf(0.5 * (from + to)));
      if (edge.a == edge.b) continue;
      const glm::dvec2 right = onRay(directionOf(from), edge, position);
      const glm::dvec2 left = onRay(directionOf(to), edge, position);
      if (!slices_.empty() && edge.a == last.a && edge.b == last.b &&
          crossed(slices_.back().right, left) > 0.0) {
        slices_.back().left = shortened(left);  // a corner that is out of view
      } else {
        add(right, left);
      }
      last = edge;
    }
  }

  struct Edge {
    glm::dvec2 a{0.0}, b{0.0};
  };

  static glm::dvec2 onRay(glm::dvec2 direction, const Edge& edge, glm::dvec2 origin) {
    const glm::dvec2 ab = edge.b - edge.a;
    const double across = crossed(direction, ab);
    return std::abs(across) < 1e-12 ? edge.a - origin
                                    : direction * (crossed(edge.a - origin, ab) / across);
  }

  static Edge edgeAlong(const TrackedSpace& space, glm::dvec2 origin, glm::dvec2 direction) {
    Edge found{};
    double nearest = INFINITY;
    for (std::size_t r = 0; r < space.ringCount(); ++r) {
      const std::span<const glm::dvec2> ring = space.ring(r);
      for (std::size_t i = 0, j = ring.size() - 1; i < ring.size(); j = i++) {
        const glm::dvec2 ab = ring[i] - ring[j];
        const double out = crossed(direction, ab);
        if (out <= 0.0) continue;
        const double along = crossed(ring[j] - origin, ab) / out;
        const double share = crossed(ring[j] - origin, direction) / out;
        if (along < 0.0 || share < 0.0 || share > 1.0 || along >= nearest) continue;
        nearest = along;
        found = {ring[j], ring[i]};
      }
    }
    return found;
  }

  std::vector<double> angles_;
  std::vector<navmesh::SightSlice> pieces_;
  navmesh::SightScratch scratch_;
  std::vector<Slice> slices_;
  Follow follow_;
};

}  // namespace

std::unique_ptr<Controller> makeVisibilityPolygons() {
  return std::make_unique<VisibilityPolygons>();
}

}  // namespace forewalk::rdw
