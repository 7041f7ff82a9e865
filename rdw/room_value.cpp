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
  const double cell = std::max({kSmallestCell, std::sqrt(size.x * size.y / settings.places),
                                std::max(size.x, size.y) / settings.places});
  // A hair less than a whole cell is none.
  width_ = std::max(1, static_cast<int>(std::ceil(size.x / cell - 1e-6))) + 1;
  depth_ = std::max(1, static_cast<int>(std::ceil(size.y / cell - 1e-6))) + 1;
  cell_ = size / glm::dvec2(width_ - 1, depth_ - 1);
  const double step = settings.step > 0.0 ? settings.step : 2.0 * cell;
  const double scale = settings.translation ? static_cast<double>(limits.translationMax) : 1.0;
  const double unit = 2.0 * kPi / headings_;

  constexpr std::size_t kCurvatures = 3;
  borders_.reserve(node(0, depth_) / static_cast<std::size_t>(headings_));
  std::vector<Move> moves;
  moves.reserve(node(0, depth_) * kCurvatures);
  for (int y = 0; y < depth_; ++y) {
    for (int x = 0; x < width_; ++x) {
      glm::dvec2 place = origin_ + cell_ * glm::dvec2(x, y);
      borders_.push_back(static_cast<float>(space.signedDistance(place)));
      // Nobody walks on from nearer to the border than a reset leaves them.
      if (static_cast<double>(borders_.back()) < settings.stopsBefore) {
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
          const double walked = scale * std::max(next.walked, 0.3 * step);
          moves.push_back(
              {next.position, next.heading,
               static_cast<float>((next.reset ? 1.0 : 0.0) + settings.rule * next.walked * off),
               static_cast<float>(std::exp(-walked / settings.foresight)), next.reset});
        }
      }
    }
  }

  const double corner = -std::expm1(-scale * step / settings.straight);
  values_.assign(moves.size() / kCurvatures, 0.0f);
  std::vector<float> onward(values_.size());
  for (int sweep = 0; sweep < settings.sweeps; ++sweep) {
    foreseeCorners(limits, corner, settings.corners, onward);
    const bool anyWay = settings.reset == ThoughtReset::kAnyWay;
    if (anyWay) rankHeadings();
    for (std::size_t i = 0; i < values_.size(); ++i) {
      float least = INFINITY;
      for (std::size_t c = 0; c < kCurvatures; ++c) {
        const Move& move = moves[i * kCurvatures + c];
        const double after = move.reset && anyWay ? sampleFlat(least_, move.position)
                                                  : sample(move.reset ? values_ : onward,
                                                           move.position, move.heading);
        least = std::min(least, move.cost + move.discount * static_cast<float>(after));
      }
      values_[i] = least;
    }
  }
  rankHeadings();
}

void RoomValue::rankHeadings() {
  const auto headings = static_cast<std::size_t>(headings_);
  least_.resize(values_.size() / headings);
  best_.resize(least_.size());
  for (std::size_t place = 0; place < least_.size(); ++place) {
    const auto first = values_.begin() + static_cast<std::ptrdiff_t>(place * headings);
    const auto best = std::min_element(first, first + headings_);
    least_[place] = *best;
    best_[place] = static_cast<std::uint16_t>(best - first);
  }
}

double RoomValue::bestHeading(glm::dvec2 position) const {
  const auto nearest = [](double at, int count) {
    return static_cast<std::size_t>(std::clamp(std::lround(at), 0L, count - 1L));
  };
  const std::size_t x = nearest((position.x - origin_.x) / cell_.x, width_);
  const std::size_t y = nearest((position.y - origin_.y) / cell_.y, depth_);
  return best_[y * static_cast<std::size_t>(width_) + x] * (2.0 * kPi / headings_);
}

double RoomValue::sampleFlat(const std::vector<float>& field, glm::dvec2 position) const {
  const double x = std::clamp((position.x - origin_.x) / cell_.x, 0.0, width_ - 1.0);
  const double y = std::clamp((position.y - origin_.y) / cell_.y, 0.0, depth_ - 1.0);
  const int column = std::min(static_cast<int>(x), width_ - 2);
  const int row = std::min(static_cast<int>(y), depth_ - 2);
  const auto at = static_cast<std::size_t>(row * width_ + column);
  const double u = x - column;
  const double v = y - row;
  const auto along = [&](std::size_t i) {
    return (1.0 - u) * static_cast<double>(field[i]) + u * static_cast<double>(field[i + 1]);
  };
  return (1.0 - v) * along(at) + v * along(at + static_cast<std::size_t>(width_));
}

/// The value of each pose before it is known whether there is a corner: where there is one,
/// rotation gain chooses among the headings within its reach.
void RoomValue::foreseeCorners(const GainLimits& limits, double corner,
                               std::span<const CornerOdds> corners,
                               std::vector<float>& onward) const {
  const auto reached = [&](double turn, float gain) {
    const double headings = turn / (2.0 * kPi) * headings_ / static_cast<double>(gain);
    return static_cast<int>(std::lround(std::min(headings, 2.0 * headings_)));
  };
  for (std::size_t base = 0; base < values_.size(); base += static_cast<std::size_t>(headings_)) {
    for (int h = 0; h < headings_; ++h) {
      double mean = 0.0;
      for (const CornerOdds& each : corners) {
        if (each.odds == 0.0) continue;
        const int from = reached(each.turn, limits.rotationMax);
        // Once round is all.
        const int to = std::min(reached(each.turn, limits.rotationMin), from + headings_ - 1);
        for (const int side : {-1, 1}) {
          float least = INFINITY;
          for (int k = from; k <= to; ++k) {
            const int heading = ((h + side * k) % headings_ + headings_) % headings_;
            least = std::min(least, values_[base + static_cast<std::size_t>(heading)]);
          }
          mean += 0.5 * each.odds * static_cast<double>(least);
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
  const double x = std::clamp((position.x - origin_.x) / cell_.x, 0.0, width_ - 1.0);
  const double y = std::clamp((position.y - origin_.y) / cell_.y, 0.0, depth_ - 1.0);
  double turn = heading * headings_ / (2.0 * kPi);
  turn -= headings_ * std::floor(turn / headings_);
  const int column = std::min(static_cast<int>(x), width_ - 2);
  const int row = std::min(static_cast<int>(y), depth_ - 2);
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
