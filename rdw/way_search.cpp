#include "rdw/way_search.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace forewalk::rdw {

namespace {

constexpr double kSmallestBend = 0.17;  // radians; smaller bends are walked, not turned
constexpr double kLongestStep = 1.0;    // metres between looks at the border
constexpr double kUnlikely = 0.02;      // weight of ways that are not worth a thought
constexpr int kCurvatures = 3;

/// How far a ratio is from 1, of the way that the limits leave; [0, 1].
double shareUsed(double gain, float low, float high) {
  const double room = gain > 1.0 ? static_cast<double>(high) - 1.0 : 1.0 - static_cast<double>(low);
  return room > 1e-9 ? std::min(1.0, std::abs(gain - 1.0) / room) : 0.0;
}

}  // namespace

double rotationChoice(int choice, const GainLimits& limits) {
  const double low = static_cast<double>(limits.rotationMin);
  const double high = static_cast<double>(limits.rotationMax);
  return choice < 2 ? low + 0.5 * choice * (1.0 - low) : 1.0 + 0.5 * (choice - 2) * (high - 1.0);
}

struct WaySearch::Walker {
  glm::dvec2 position;
  double heading;
  int first;              // which first choice this one descends from
  double walked = 0.0;    // virtual metres from now
  double faithful = 1.0;  // how likely the user still follows the way that is thought of
  double cost = 0.0;      // up to here, and of having left the way before
  double value = 0.0;     // cost, and what the pose promises
};

/// The best walkers of each first choice, best first.
struct WaySearch::Beam {
  std::array<std::array<Walker, kWidest>, kMostChoices> walkers;
  std::array<int, kMostChoices> counts{};

  void offer(const Walker& walker, int width) {
    auto& row = walkers[static_cast<std::size_t>(walker.first)];
    int& count = counts[static_cast<std::size_t>(walker.first)];
    if (count == width && walker.value >= row[static_cast<std::size_t>(count - 1)].value) return;
    int at = count < width ? count++ : count - 1;
    for (; at > 0 && walker.value < row[static_cast<std::size_t>(at - 1)].value; --at) {
      row[static_cast<std::size_t>(at)] = row[static_cast<std::size_t>(at - 1)];
    }
    row[static_cast<std::size_t>(at)] = walker;
  }
};

/// Walks straight in virtual space, curved in the room; a reset turns the body and costs.
void WaySearch::walkPiece(double length, const Choice& choice, Walker& walker, int& nodes) const {
  const double felt =
      settings_.feltMetre *
      (std::abs(choice.curvature) / std::max(1e-9, static_cast<double>(limits_.curvatureMax)) +
       shareUsed(choice.translation, limits_.translationMin, limits_.translationMax));
  for (double left = length; left > 1e-6;) {
    const ThoughtStep step = stepInThought(space_, walker.position, walker.heading,
                                           std::min(left / choice.translation, kLongestStep),
                                           choice.curvature, roomSettings_);
    ++nodes;
    const double walked = step.walked * choice.translation;
    walker.position = step.position;
    walker.heading = step.reset && roomSettings_.reset == ThoughtReset::kAnyWay
                         ? room_.bestHeading(step.position)
                         : step.heading;
    walker.walked += walked;
    left -= walked;
    const double now = walker.faithful * std::exp(-walker.walked / roomSettings_.foresight);
    const double near =
        std::clamp(1.0 - room_.borderDistance(step.position) / settings_.borderReach, 0.0, 1.0);
    walker.cost += now * ((step.reset ? 1.0 : 0.0) + walked * (felt + settings_.border * near));
  }
  const double onward = std::exp(-walker.walked / roomSettings_.foresight) *
                        room_.at(walker.position, walker.heading);
  walker.value = walker.cost + walker.faithful * onward;
  const double strays = -std::expm1(-length / settings_.faith);
  walker.cost += walker.faithful * strays * onward;
  walker.faithful *= 1.0 - strays;
}

/// Without first choices everything is free, and there is one cost.
int WaySearch::walk(const ThoughtPose& from, const LikelyWay& way, bool turning, double translation,
                    std::span<const Choice> first, int width, std::span<double> costs) const {
  int nodes = 0;
  Beam beam;
  for (std::size_t c = 0; c < costs.size(); ++c) {
    beam.walkers[c][0] = Walker{from.position, from.heading, static_cast<int>(c)};
    beam.counts[c] = 1;
  }
  for (int p = 0; p < way.count; ++p) {
    const LikelyWay::Piece& piece = way.pieces[static_cast<std::size_t>(p)];
    Beam next;
    for (std::size_t f = 0; f < costs.size(); ++f) {
      for (int i = 0; i < beam.counts[f]; ++i) {
        const Walker& walker = beam.walkers[f][static_cast<std::size_t>(i)];
        const bool corner = std::abs(piece.turn) > kSmallestBend;
        const bool fixedTurn = p == 0 && turning && !first.empty();
        for (int r = 0; r < (corner && !fixedTurn ? kRotationChoices : 1); ++r) {
          const double rotation = fixedTurn ? first[f].rotation
                                  : corner  ? rotationChoice(r, limits_)
                                            : 1.0;
          Walker turned = walker;
          turned.heading += piece.turn / rotation;
          turned.cost += walker.faithful * settings_.feltRadian * std::abs(piece.turn) *
                         shareUsed(rotation, limits_.rotationMin, limits_.rotationMax);
          const bool fixedWalk = p == 0 && !turning && !first.empty();
          for (int c = 0; c < (fixedWalk ? 1 : kCurvatures); ++c) {
            const Choice choice =
                fixedWalk
                    ? first[f]
                    : Choice{translation, 1.0, (c - 1) * static_cast<double>(limits_.curvatureMax)};
            Walker walked = turned;
            walkPiece(piece.length, choice, walked, nodes);
            next.offer(walked, width);
          }
        }
      }
    }
    beam = next;
  }
  for (std::size_t f = 0; f < costs.size(); ++f) {
    costs[f] = std::min(costs[f], beam.walkers[f][0].value);
  }
  return nodes;
}

int WaySearch::costs(const ThoughtPose& from, const WaysAhead& ahead, bool turning,
                     std::span<const Choice> first, std::span<double> costs) const {
  assert(first.size() <= kMostChoices && costs.size() == first.size());
  std::array<std::array<double, kMostChoices>, WaysAhead::kMost> least;
  for (auto& row : least) row.fill(INFINITY);
  int nodes = 0;
  int pass = 0;  // nodes of the last pass
  const double translation = first.empty() ? 1.0 : first[0].translation;
  for (int width = 1; width <= kWidest; width *= 2) {
    // The next pass takes about twice the last one; one that would not be finished is not begun.
    if (width > 1 && nodes + 2 * pass > settings_.nodes) break;
    pass = 0;
    for (int w = 0; w < ahead.count; ++w) {
      const LikelyWay& way = ahead.ways[static_cast<std::size_t>(w)];
      if (way.weight < kUnlikely) continue;
      pass += walk(from, way, turning, translation, first, width,
                   std::span(least[static_cast<std::size_t>(w)]).first(first.size()));
    }
    nodes += pass;
  }
  std::fill(costs.begin(), costs.end(), 0.0);
  for (int w = 0; w < ahead.count; ++w) {
    const LikelyWay& way = ahead.ways[static_cast<std::size_t>(w)];
    if (way.weight < kUnlikely) continue;
    for (std::size_t f = 0; f < first.size(); ++f) {
      costs[f] += way.weight * least[static_cast<std::size_t>(w)][f];
    }
  }
  return nodes;
}

double WaySearch::cost(const ThoughtPose& from, const WaysAhead& ahead, double translation,
                       int width) const {
  double cost = 0.0;
  for (int w = 0; w < ahead.count; ++w) {
    const LikelyWay& way = ahead.ways[static_cast<std::size_t>(w)];
    if (way.weight < kUnlikely) continue;
    double least = INFINITY;
    walk(from, way, false, translation, {}, width, {&least, 1});
    cost += way.weight * least;
  }
  return cost;
}

}  // namespace forewalk::rdw
