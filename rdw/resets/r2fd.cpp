// Reset to future direction. Williams, Bera and Manocha, "ARC: Alignment-based Redirection
// Controller for Redirected Walking in Complex Environments", TVCG 2021.
//
// Of 20 physical directions those that lead away from the nearest border: the one whose free way is
// at least the virtual one ahead, with the least excess; where there is none, the least shortfall.
// The virtual turn is 360 degrees, so "ahead" is where the user was going. Where no navmesh is
// known the virtual way has no end, and the freest direction wins.
#include <cmath>

#include "navmesh/sight.h"
#include "rdw/free_way.h"
#include "rdw/resets/resets.h"

namespace forewalk::rdw {
namespace {

constexpr int kDirections = 20;
constexpr double kFarthest = 100.0;  // metres looked ahead

class R2FD final : public ResetPolicy {
 public:
  ResetPlan plan(const SteerInput& input) override {
    const glm::dvec2 position = input.physical.position;
    const glm::dvec2 ahead = aheadOf(input);
    const double wanted =
        input.world == nullptr
            ? kFarthest
            : navmesh::sightAlong(input.world->graph, input.place,
                                  input.redirection.directionToVirtual(ahead), kFarthest);
    const glm::dvec2 away = input.space.nearestBorder(position).inward;
    glm::dvec2 best = -ahead;
    double bestExcess = INFINITY;
    double bestShortfall = INFINITY;
    for (int i = 0; i < kDirections; ++i) {
      const glm::dvec2 direction = rotated(away, 2.0 * kPi * i / kDirections);
      if (glm::dot(direction, away) <= 1e-9) continue;
      const double excess = freeAlong(input.space, input.others, position, direction) - wanted;
      if (excess >= 0.0 ? excess < bestExcess : std::isinf(bestExcess) && -excess < bestShortfall) {
        (excess >= 0.0 ? bestExcess : bestShortfall) = std::abs(excess);
        best = direction;
      }
    }
    return turnTo(ahead, best);
  }
  std::string_view name() const override { return "r2fd"; }
};

}  // namespace

std::unique_ptr<ResetPolicy> makeR2FD() { return std::make_unique<R2FD>(); }

}  // namespace forewalk::rdw
