#include "rdw/clairvoyant.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "rdw/foresight.h"
#include "rdw/room_value.h"
#include "rdw/way_search.h"

namespace forewalk::rdw {

namespace {

constexpr double kSmallestTurn = 1e-3;  // radians; smaller ones are not worth a choice
constexpr int kBehind = 2;              // resets; states so many behind the best are given up

struct State {
  glm::dvec2 position;
  double heading;  // physical, radians
  int resets;
  double score;  // resets, and those to expect
  std::uint64_t cell;
  std::uint32_t parent;
  bool reset;  // since the parent
};

/// Where a state came from, to tell the story afterwards.
struct Trail {
  std::uint32_t parent;
  bool reset;
};

class Search {
 public:
  Search(const TrackedSpace& space, const GainLimits& limits, const ClairvoyantSettings& settings)
      : space_(space), limits_(limits), settings_(settings) {
    RoomValueSettings value = openPlaneValue();
    value.translation = settings.translation;
    room_ = RoomValue(space, limits, SteerRule::kCentre, value);
  }

  ClairvoyantWalk walk(std::span<const glm::dvec2> path, double facing, const PlanarPose& start) {
    states_ = {{start.position, start.heading, 0, 0.0, 0, 0, false}};
    ClairvoyantWalk found;
    std::vector<double> ends;  // metres walked at the end of each piece
    double heading = facing;
    for (std::size_t i = 1; i < path.size(); ++i) {
      const glm::dvec2 leg = path[i] - path[i - 1];
      const double length = glm::length(leg);
      if (length < 1e-6) continue;
      const double turn = wrapAngle(headingOf(leg) - heading);
      heading = headingOf(leg);
      const int pieces = static_cast<int>(std::ceil(length / settings_.step));
      for (int p = 0; p < pieces; ++p) {
        advance(p == 0 ? turn : 0.0, length / pieces);
        found.metres += length / pieces;
        ends.push_back(found.metres);
      }
    }
    tell(ends, found);
    return found;
  }

 private:
  void advance(double turn, double length) {
    next_.clear();
    const bool turns = std::abs(turn) > kSmallestTurn;
    for (std::uint32_t i = 0; i < states_.size(); ++i) {
      for (int r = 0; r < (turns ? kRotationChoices : 1); ++r) {
        State from = states_[i];
        from.parent = i;
        from.reset = false;
        from.heading += turns ? turn / rotationChoice(r, limits_) : turn;
        walkOn(from, length);
      }
    }
    // Hemmed in on all sides they are turned for nothing, but go on.
    if (next_.empty()) {
      for (std::uint32_t i = 0; i < states_.size(); ++i) {
        State stays = states_[i];
        stays.parent = i;
        stays.reset = true;
        ++stays.resets;
        offer(stays);
      }
    }
    keepBest();
  }

  void walkOn(const State& from, double length) {
    bool blocked = false;
    for (const double translation : {static_cast<double>(limits_.translationMax), 1.0}) {
      if (!settings_.translation && translation != 1.0) continue;
      for (int side = -1; side <= 1; ++side) {
        State to = from;
        if (step(to, length / translation, side * static_cast<double>(limits_.curvatureMax))) {
          offer(to);
        } else {
          blocked = true;
        }
      }
    }
    if (!blocked) return;
    const double shortest =
        length / (settings_.translation ? static_cast<double>(limits_.translationMax) : 1.0);
    for (int h = 0; h < settings_.headings; ++h) {
      State to = from;
      to.heading = h * (2.0 * kPi / settings_.headings);
      to.reset = true;
      ++to.resets;
      if (step(to, shortest, 0.0)) offer(to);
    }
  }

  /// False, and nothing changes, where the floor ends too soon.
  bool step(State& state, double length, double curvature) const {
    const double bend = curvature * length;
    const double half = 0.5 * bend;
    const double chordLength = length * (std::abs(half) > 1e-6 ? std::sin(half) / half : 1.0);
    const glm::dvec2 chord = directionOf(state.heading + half);
    if (space_.distanceAlong(state.position, chord) < chordLength + settings_.clearance) {
      return false;
    }
    state.position += chordLength * chord;
    state.heading += bend;
    return true;
  }

  void offer(State state) {
    state.heading = wrapAngle(state.heading);
    state.score = state.resets + room_.at(state.position, state.heading);
    const glm::dvec2 place = (state.position - space_.lowerBound()) / settings_.cell;
    const auto heading = static_cast<std::uint64_t>((state.heading + kPi) / (2.0 * kPi) *
                                                    settings_.headings * 0.999999);
    state.cell = (static_cast<std::uint64_t>(std::max(0.0, place.x)) << 40) |
                 (static_cast<std::uint64_t>(std::max(0.0, place.y)) << 16) | heading;
    next_.push_back(state);
  }

  void keepBest() {
    int least = next_.front().resets;
    for (const State& state : next_) least = std::min(least, state.resets);
    std::erase_if(next_, [&](const State& state) { return state.resets >= least + kBehind; });
    // Equal in all that is compared: the one found first.
    std::stable_sort(next_.begin(), next_.end(), [](const State& a, const State& b) {
      return a.cell != b.cell ? a.cell < b.cell : a.score < b.score;
    });
    next_.erase(std::unique(next_.begin(), next_.end(),
                            [](const State& a, const State& b) { return a.cell == b.cell; }),
                next_.end());
    const auto width = static_cast<std::size_t>(settings_.width);
    if (next_.size() > width) {
      std::nth_element(next_.begin(), next_.begin() + static_cast<std::ptrdiff_t>(width),
                       next_.end(), [](const State& a, const State& b) {
                         return a.score != b.score ? a.score < b.score : a.cell < b.cell;
                       });
      next_.resize(width);
    }
    trails_.emplace_back();
    trails_.back().reserve(next_.size());
    for (const State& state : next_) trails_.back().push_back({state.parent, state.reset});
    std::swap(states_, next_);
  }

  void tell(const std::vector<double>& ends, ClairvoyantWalk& found) const {
    std::size_t at = 0;
    for (std::size_t i = 1; i < states_.size(); ++i) {
      if (states_[i].resets < states_[at].resets) at = i;
    }
    for (std::size_t piece = trails_.size(); piece-- > 0;) {
      const Trail& trail = trails_[piece][at];
      if (trail.reset) found.resets.push_back(piece == 0 ? 0.0 : ends[piece - 1]);
      at = trail.parent;
    }
    std::reverse(found.resets.begin(), found.resets.end());
  }

  const TrackedSpace& space_;
  const GainLimits& limits_;
  const ClairvoyantSettings& settings_;
  RoomValue room_;
  std::vector<State> states_, next_;
  std::vector<std::vector<Trail>> trails_;  // piece after piece, per state kept
};

}  // namespace

ClairvoyantWalk clairvoyant(std::span<const glm::dvec2> path, double facing,
                            const PlanarPose& start, const TrackedSpace& space,
                            const GainLimits& limits, const ClairvoyantSettings& settings) {
  return Search(space, limits, settings).walk(path, facing, start);
}

}  // namespace forewalk::rdw
