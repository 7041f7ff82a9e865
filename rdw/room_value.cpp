#include "rdw/room_value.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace forewalk::rdw {

namespace {

constexpr double kSmallestCell = 0.25;  // metres

/// What the target rule has against walking along `heading`: the bearing of its target, [0, 1].
double offTarget(const TrackedSpace& space, SteerRule rule, glm::dvec2 position,
                 glm::dvec2 heading) {
  const glm::dvec2 target =
      rule == SteerRule::kCentre ? space.centre() : orbitTarget(position, heading, space);
  return std::abs(angleBetween(heading, target - position)) / kPi;
}

/// A choice of curvature at a node of the grid, and where it leads.
struct Move {
  glm::dvec2 position;
  double heading;
  float cost;
  float discount;
  bool reset;
};

}  // namespace

ThoughtStep stepInThought(const TrackedSpace& space, glm::dvec2 position, double heading,
                          double length, double curvature, const RoomValueSettings& settings) {
  const double bend = curvature * length;
  const double halfBend = 0.5 * bend;
  // A chord is shorter than its arc.
  const double shortened = std::abs(halfBend) > 1e-3 ? std::sin(halfBend) / halfBend : 1.0;
  const glm::dvec2 chord = directionOf(heading + halfBend);
  const double free = space.distanceAlong(position, chord) - settings.stopsBefore;
  if (free >= length * shortened + settings.stopping) {
    return {position + length * shortened * chord, heading + bend, length, false};
  }
  const double walked = std::clamp(free, 0.0, length + settings.stopping);
  return {position + walked * chord, heading + curvature * walked + kPi, std::max(walked, 0.1),
          true};
}

RoomValue::RoomValue(const TrackedSpace& space, const GainLimits& limits, SteerRule rule,
                     const RoomValueSettings& settings)
    : origin_(space.lowerBound()), headings_(settings.headings) {
  const glm::dvec2 size = space.upperBound() - space.lowerBound();
  cell_ = std::max({kSmallestCell, std::sqrt(size.x * size.y / settings.places),
                    std::max(size.x, size.y) / settings.places});
  width_ = static_cast<int>(std::ceil(size.x / cell_)) + 1;
  depth_ = static_cast<int>(std::ceil(size.y / cell_)) + 1;
  const double step = 2.0 * cell_;
  const double unit = 2.0 * kPi / headings_;

  constexpr std::size_t kCurvatures = 3;
  std::vector<Move> moves;
  moves.reserve(node(0, depth_) * kCurvatures);
  for (int y = 0; y < depth_; ++y) {
    for (int x = 0; x < width_; ++x) {
      glm::dvec2 place = origin_ + cell_ * glm::dvec2(x, y);
      // Nobody walks on from nearer to the border than a reset leaves them.
      if (space.signedDistance(place) < settings.stopsBefore) {
        const TrackedSpace::BorderPoint border = space.nearestBorder(place);
        place = border.position + settings.stopsBefore * border.inward;
      }
      for (int h = 0; h < headings_; ++h) {
        const double heading = h * unit;
        const double off = offTarget(space, rule, place, directionOf(heading));
        for (int side = -1; side <= 1; ++side) {
          const ThoughtStep next =
              stepInThought(space, place, heading, step,
                            side * static_cast<double>(limits.curvatureMax), settings);
          // Somebody hemmed in is reset over and over, but not for nothing.
          const double walked = std::max(next.walked, 0.3 * step);
          moves.push_back(
              {next.position, next.heading,
               static_cast<float>((next.reset ? 1.0 : 0.0) + settings.rule * next.walked * off),
               static_cast<float>(std::exp(-walked / settings.foresight)), next.reset});
        }
      }
    }
  }

  const double corner = -std::expm1(-step / settings.straight);
  values_.assign(moves.size() / kCurvatures, 0.0f);
  std::vector<float> onward(values_.size());
  for (int sweep = 0; sweep < settings.sweeps; ++sweep) {
    foreseeCorners(limits, corner, settings.turnBack, onward);
    for (std::size_t i = 0; i < values_.size(); ++i) {
      float least = INFINITY;
      for (std::size_t c = 0; c < kCurvatures; ++c) {
        const Move& move = moves[i * kCurvatures + c];
        const double after = sample(move.reset ? values_ : onward, move.position, move.heading);
        least = std::min(least, move.cost + move.discount * static_cast<float>(after));
      }
      values_[i] = least;
    }
  }
}

/// The value of each pose before it is known whether there is a corner: where there is one,
/// rotation gain chooses among the headings within its reach.
void RoomValue::foreseeCorners(const GainLimits& limits, double corner, double turnBack,
                               std::vector<float>& onward) const {
  const auto reached = [&](double share, float gain) {
    const double headings = share * headings_ / static_cast<double>(gain);
    return static_cast<int>(std::lround(std::min(headings, 2.0 * headings_)));
  };
  struct Reach {
    int from, to;  // headings onward, a left turn
    double odds;
  };
  const std::array<Reach, 2> turns{
      {{reached(0.25, limits.rotationMax), reached(0.25, limits.rotationMin),
        0.5 * (1.0 - turnBack)},
       {reached(0.5, limits.rotationMax), reached(0.5, limits.rotationMin), 0.5 * turnBack}}};
  for (std::size_t base = 0; base < values_.size(); base += static_cast<std::size_t>(headings_)) {
    for (int h = 0; h < headings_; ++h) {
      double mean = 0.0;
      for (const Reach& turn : turns) {
        for (const int side : {-1, 1}) {
          float least = INFINITY;
          const int to = std::min(turn.to, turn.from + headings_ - 1);  // once round is all
          for (int k = turn.from; k <= to; ++k) {
            const int heading = ((h + side * k) % headings_ + headings_) % headings_;
            least = std::min(least, values_[base + static_cast<std::size_t>(heading)]);
          }
          mean += turn.odds * static_cast<double>(least);
        }
      }
      const std::size_t i = base + static_cast<std::size_t>(h);
      onward[i] =
          static_cast<float>((1.0 - corner) * static_cast<double>(values_[i]) + corner * mean);
    }
  }
}

double RoomValue::sample(const std::vector<float>& field, glm::dvec2 position,
                         double heading) const {
  const double x = std::clamp((position.x - origin_.x) / cell_, 0.0, width_ - 1.001);
  const double y = std::clamp((position.y - origin_.y) / cell_, 0.0, depth_ - 1.001);
  double turn = heading * headings_ / (2.0 * kPi);
  turn -= headings_ * std::floor(turn / headings_);
  const int column = static_cast<int>(x);
  const int row = static_cast<int>(y);
  const int below = std::min(static_cast<int>(turn), headings_ - 1);
  const auto a = static_cast<std::size_t>(below);
  const auto b = static_cast<std::size_t>(below + 1 == headings_ ? 0 : below + 1);
  const double t = turn - below;
  const auto along = [&](std::size_t first) {
    return (1.0 - t) * static_cast<double>(field[first + a]) +
           t * static_cast<double>(field[first + b]);
  };
  const double u = x - column;
  const double v = y - row;
  return (1.0 - v) * ((1.0 - u) * along(node(column, row)) + u * along(node(column + 1, row))) +
         v * ((1.0 - u) * along(node(column, row + 1)) + u * along(node(column + 1, row + 1)));
}

}  // namespace forewalk::rdw
