#include "rdw/reset_ahead.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "rdw/foresight.h"

namespace forewalk::rdw {

ResetAhead::ResetAhead(const TrackedSpace& space, const GainLimits& limits, bool translation)
    : limits_(limits), building_(buildingValue()), plane_(openPlaneValue()) {
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
  const WaySearch search(input.space, limits_, ahead.known ? buildingRoom_ : planeRoom_,
                         ahead.known ? building_ : plane_, settings);
  const double translation =
      building_.translation ? static_cast<double>(limits_.translationMax) : 1.0;
  const double curvature = static_cast<double>(limits_.curvatureMax);
  const std::array<Choice, 3> choices{
      {{translation, 1.0, 0.0}, {translation, 1.0, -curvature}, {translation, 1.0, curvature}}};

  const glm::dvec2 inward = input.space.centre() - input.position;
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

namespace {

constexpr double kStoppingSeconds = 0.43;  // of walking on at the present speed, once told to stop

class AheadReset final : public ResetPolicy {
 public:
  void prepare(const TrackedSpace& space, const GainLimits& limits) override {
    ahead_.emplace(space, limits);
  }

  ResetPlan plan(const SteerInput& input) override {
    const glm::dvec2 ahead = aheadOf(input);
    if (!ahead_) return turnTo(ahead, -ahead);
    const double stop =
        std::min(kStoppingSeconds * (input.motion.walking ? input.motion.speed : 0.0),
                 input.space.distanceAlong(input.physical.position, ahead));
    const double heading = ahead_->heading({input.space, input.physical.position + stop * ahead,
                                            input.redirection.directionToVirtual(ahead),
                                            input.graph, input.likelihoods});
    return turnTo(ahead, directionOf(heading));
  }

  std::string_view name() const override { return "ahead"; }
  bool wantsPrediction() const override { return true; }
  bool wantsLikelihoods() const override { return true; }

 private:
  std::optional<ResetAhead> ahead_;
};

}  // namespace

std::unique_ptr<ResetPolicy> makeResetAhead() { return std::make_unique<AheadReset>(); }

}  // namespace forewalk::rdw
