// Dynamic artificial potential fields. Dong, Fu, Zhang, Wu and Liu, "Dynamic Artificial Potential
// Fields for Multi-User Redirected Walking", IEEE VR 2020.
//
// The border pushes as Messinger's (border_force.h). Every other user pushes by k * d / |d|^2.5
// from where they are, and by a quarter of that from where they will be a metre further on. Open
// area pulls: of places on a grid, half a metre to two apart, the one with the most room (borders,
// and others as they stand) by 1 / (1 + distance) of the mean push, so that it decides where pushes
// cancel out. Theirs pulls by a fixed target in the middle of the largest empty area; the mean push
// is our unit, so that the size of the room does not matter.
#include <algorithm>
#include <cmath>
#include <vector>

#include "rdw/controllers/border_force.h"
#include "rdw/controllers/controllers.h"
#include "rdw/controllers/follow.h"

namespace forewalk::rdw {
namespace {

constexpr double kAhead = 1.0;  // metres
constexpr double kFutureWeight = 0.25;
constexpr double kUserExponent = 1.5;
constexpr int kMostPlaces = 20;  // along the longer side

class DynamicApf final : public Controller {
 public:
  void prepare(const TrackedSpace& space, const GainLimits&) override {
    border_.prepare(space);
    places_.clear();
    places_.push_back({space.centre(), space.clearance()});
    // Along the longest edge, so that the room may be turned.
    glm::dvec2 along(1.0, 0.0);
    double longest = 0.0, furthest = 0.0;
    const std::span<const glm::dvec2> ring = space.ring(0);
    for (std::size_t i = 0, j = ring.size() - 1; i < ring.size(); j = i++) {
      furthest = std::max(furthest, glm::distance(ring[i], space.centre()));
      const double length = glm::distance(ring[i], ring[j]);
      if (length <= longest + 1e-6) continue;
      longest = length;
      along = (ring[i] - ring[j]) / length;
    }
    const glm::dvec2 across(-along.y, along.x);
    const double step = std::max(0.5, 2.0 * furthest / kMostPlaces);
    const int most = static_cast<int>(furthest / step);
    for (double x = -most; x <= most; ++x) {
      for (double y = -most; y <= most; ++y) {
        const glm::dvec2 place = space.centre() + step * (x * along + y * across);
        const double room = space.signedDistance(place);
        if (room > 0.25) places_.push_back({place, room});
      }
    }
  }

  Gains steer(const SteerInput& input) override {
    const glm::dvec2 position = input.physical.position;
    const glm::dvec2 facing = directionOf(input.physical.heading);
    const glm::dvec2 border = border_.at(position, input.space);
    glm::dvec2 force = border;
    for (const OtherUser& other : input.others) {
      const double weight = mutualSight(position, facing, other);
      force += weight * push(position - other.position);
      const double speed = glm::length(other.velocity);
      if (speed > 0.1) {
        const glm::dvec2 future = other.position + kAhead / speed * other.velocity;
        force += kFutureWeight * push(position - future);
      }
    }
    const glm::dvec2 to = mostOpen(input.others) - position;
    const double distance = glm::length(to);
    if (distance > 1e-6) force += glm::length(border) / (1.0 + distance) * to / distance;
    return follow_.toward(force, input);
  }
  void restart() override { follow_.restart(); }
  std::string_view name() const override { return "dynamic-apf"; }
  bool wantsPrediction() const override { return false; }

 private:
  struct Place {
    glm::dvec2 position;
    double room;
  };

  static glm::dvec2 push(glm::dvec2 d) {
    return d / std::pow(std::max(glm::length(d), 0.01), kUserExponent + 1.0);
  }

  glm::dvec2 mostOpen(std::span<const OtherUser> others) const {
    const Place* best = &places_.front();
    double most = -1.0;
    for (const Place& place : places_) {
      double room = place.room;
      for (const OtherUser& other : others)
        room = std::min(room, glm::distance(place.position, other.position) - other.radius);
      if (room > most + 1e-3) {
        most = room;
        best = &place;
      }
    }
    return best->position;
  }

  BorderForce border_;
  std::vector<Place> places_;
  Follow follow_;
};

}  // namespace

std::unique_ptr<Controller> makeDynamicApf() { return std::make_unique<DynamicApf>(); }

}  // namespace forewalk::rdw
