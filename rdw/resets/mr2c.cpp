// Modified reset to centre. Thomas and Suma Rosenberg, "A General Reactive Algorithm for Redirected
// Walking Using Artificial Potential Functions", IEEE VR 2019: as R2C, but where a wall or an
// obstacle lies between the user and the centre they face along its side.
//
// Of the side's two ends the nearer to the centre. What is in the way is what the line to the
// centre meets first, not what is nearest (in the peers a user can stand before one wall while the
// reset looks at another, for ever).
#include "rdw/free_way.h"
#include "rdw/potential_field.h"
#include "rdw/resets/resets.h"

namespace forewalk::rdw {
namespace {

/// The edge on which `point` lies, by its two corners.
struct Side {
  glm::dvec2 a, b;
};

Side sideAt(const TrackedSpace& space, glm::dvec2 point) {
  Side side{};
  double nearest = INFINITY;
  for (std::size_t r = 0; r < space.ringCount(); ++r) {
    const auto ring = space.ring(r);
    for (std::size_t i = 0, j = ring.size() - 1; i < ring.size(); j = i++) {
      const double distance = glm::distance(nearestOnEdge(ring[j], ring[i], point), point);
      if (distance < nearest) {
        nearest = distance;
        side = {ring[j], ring[i]};
      }
    }
  }
  return side;
}

class MR2C final : public ResetPolicy {
 public:
  ResetPlan plan(const SteerInput& input) override {
    const glm::dvec2 position = input.physical.position;
    const glm::dvec2 centre = input.space.centre();
    const double distance = glm::distance(centre, position);
    if (distance < 1e-6) return {};
    glm::dvec2 faced = (centre - position) / distance;
    const double free = input.space.distanceAlong(position, faced);
    if (free < distance) {
      const Side side = sideAt(input.space, position + free * faced);
      const glm::dvec2 end =
          glm::distance(side.a, centre) <= glm::distance(side.b, centre) ? side.a : side.b;
      const glm::dvec2 along = glm::normalize(side.b - side.a);
      faced = end == side.b ? along : -along;
    }
    return turnTo(aheadOf(input), faced);
  }
  std::string_view name() const override { return "mr2c"; }
};

}  // namespace

std::unique_ptr<ResetPolicy> makeMR2C() { return std::make_unique<MR2C>(); }

}  // namespace forewalk::rdw
