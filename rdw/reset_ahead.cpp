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
  const auto waysUpTo = [&](double reach) {
    WaysAheadSettings ways = defaults.ways;
    ways.reach = std::min(reach, ways.reach);
    return waysAhead(input.graph, input.likelihoods, input.virtualDirection, input.virtualDirection,
                     ways);
  };
  const WaysAhead near = waysUpTo(kNearReach);
  const WaysAhead ahead = waysUpTo(defaults.ways.reach);
  const WaySearch search(input.space, limits_, ahead.known ? buildingRoom_ : planeRoom_,
                         ahead.known ? building_ : plane_, defaults.search);
  const double translation =
      building_.translation ? static_cast<double>(limits_.translationMax) : 1.0;

  // A narrow beam and a short look from every heading; a wider and a longer one from those that
  // came out best, and beside the best.
  struct Candidate {
    double heading = 0.0;
    double cost = INFINITY;
  };
  std::array<Candidate, kFinalists> best;
  const glm::dvec2 inward = input.space.centre() - input.position;
  const double centre = glm::length(inward) > 1e-9 ? headingOf(inward) : 0.0;
  for (int h = 0; h < kHeadings; ++h) {
    // 0, left, right, further left, ...
    const int step = (h + 1) / 2 * (h % 2 == 1 ? 1 : -1);
    const double heading = centre + step * (2.0 * kPi / kHeadings);
    Candidate next{heading, search.cost({input.position, heading}, near, translation, 1)};
    for (Candidate& each : best) {
      if (next.cost < each.cost - 1e-9) std::swap(next, each);
    }
  }
  Candidate least;
  const auto consider = [&](double heading) {
    const double cost = search.cost({input.position, heading}, ahead, translation, kFinalWidth);
    if (cost < least.cost - 1e-9) least = {heading, cost};
  };
  for (const Candidate& each : best) consider(each.heading);
  const double found = least.heading;
  for (const double side : {1.0, -1.0}) consider(found + side * (kPi / kHeadings));
  return wrapAngle(least.heading);
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
