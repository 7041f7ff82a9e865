#include "rdw/reset_ahead.h"

#include <array>
#include <cmath>

#include "rdw/foresight.h"

namespace forewalk::rdw {

ResetAhead::ResetAhead(const TrackedSpace& space, const GainLimits& limits, bool translation)
    : space_(&space), limits_(limits), building_(buildingValue()), plane_(openPlaneValue()) {
  building_.translation = translation;
  plane_.translation = translation;
  buildingRoom_ = RoomValue(space, limits, SteerRule::kCentre, building_);
  planeRoom_ = RoomValue(space, limits, SteerRule::kCentre, plane_);
}

double ResetAhead::heading(const ResetAheadInput& input) const {
  const ForesightSettings defaults;
  const WaysAhead ahead = waysAhead(input.graph, input.likelihoods, input.virtualDirection,
                                    input.virtualDirection, defaults.ways);
  WaySearchSettings settings = defaults.search;
  settings.nodes = 1;  // the narrowest beam: there are many headings to ask about
  const WaySearch search(*space_, limits_, ahead.known ? buildingRoom_ : planeRoom_,
                         ahead.known ? building_ : plane_, settings);
  const double translation =
      building_.translation ? static_cast<double>(limits_.translationMax) : 1.0;
  const double curvature = static_cast<double>(limits_.curvatureMax);
  const std::array<Choice, 3> choices{
      {{translation, 1.0, 0.0}, {translation, 1.0, -curvature}, {translation, 1.0, curvature}}};

  const glm::dvec2 inward = space_->centre() - input.position;
  const double centre = glm::length(inward) > 1e-9 ? headingOf(inward) : 0.0;
  double best = centre;
  double least = INFINITY;
  for (int h = 0; h < kHeadings; ++h) {
    // 0, left, right, further left, ...
    const int step = (h + 1) / 2 * (h % 2 == 1 ? 1 : -1);
    const double heading = centre + step * (2.0 * kPi / kHeadings);
    std::array<double, 3> costs;
    search.costs({input.position, heading}, ahead, false, choices, costs);
    for (const double cost : costs) {
      if (cost < least - 1e-9) {
        least = cost;
        best = heading;
      }
    }
  }
  return wrapAngle(best);
}

}  // namespace forewalk::rdw
