#include "service/walk_legs.h"

#include <algorithm>
#include <limits>
#include <tuple>

namespace forewalk::service {
namespace {

constexpr double kNoWay = std::numeric_limits<double>::infinity();
constexpr double kSpeedRate = 2.0;   // 1/s
constexpr double kStanding = 0.3;    // m/s
constexpr double kUsualSpeed = 1.3;  // m/s

struct Rest {
  std::size_t walk;
  glm::dvec2 place;
};

std::vector<Rest> findRests(std::span<const rdw::Walk> walks, const LegRule& rule) {
  std::vector<Rest> rests;
  for (std::size_t w = 0; w < walks.size(); ++w) {
    const std::vector<rdw::WalkSample>& samples = walks[w].samples;
    for (std::size_t begin = 0; begin < samples.size();) {
      std::size_t end = begin + 1;
      glm::dvec2 sum = samples[begin].plan;
      while (end < samples.size() &&
             glm::distance(samples[end].plan, samples[begin].plan) <= rule.restRadius) {
        sum += samples[end++].plan;
      }
      if (samples[end - 1].seconds - samples[begin].seconds < rule.restSeconds) {
        ++begin;
        continue;
      }
      rests.push_back({w, sum / static_cast<double>(end - begin)});
      begin = end;
    }
  }
  return rests;
}

/// How many rest within a radius of a place, and how near: what makes a region.
struct Resting {
  std::size_t walkers = 0, rests = 0;
  double metres = 0.0;  // sum of their distances

  bool operator>(const Resting& other) const {
    return std::tie(walkers, rests, other.metres) > std::tie(other.walkers, other.rests, metres);
  }
};

// Rests of a walker are next to each other, so different walkers are changes of `walk`.
Resting restingAbout(const std::vector<Rest>& rests, glm::dvec2 place, double radius) {
  Resting resting;
  std::size_t last = std::numeric_limits<std::size_t>::max();
  for (const Rest& rest : rests) {
    const double distance = glm::distance(rest.place, place);
    if (distance > radius) continue;
    ++resting.rests;
    resting.metres += distance;
    resting.walkers += rest.walk != last ? 1 : 0;
    last = rest.walk;
  }
  return resting;
}

std::vector<glm::dvec2> findRegions(const std::vector<Rest>& rests, const LegRule& rule) {
  std::vector<glm::dvec2> regions;
  while (true) {
    Resting most;
    glm::dvec2 place{0.0};
    for (const Rest& rest : rests) {
      const bool taken = std::any_of(regions.begin(), regions.end(), [&](glm::dvec2 region) {
        return glm::distance(region, rest.place) < 2.0 * rule.regionRadius;
      });
      if (taken) continue;
      const Resting here = restingAbout(rests, rest.place, rule.regionRadius);
      if (here > most) {
        most = here;
        place = rest.place;
      }
    }
    if (most.walkers < rule.restingWalkers || most.walkers == 0) return regions;
    regions.push_back(place);
  }
}

/// The samples of a walk in one region, a stay each.
struct Stay {
  std::size_t first, last;
};

/// All legs there are, and which of them are still free to take.
class Legs {
 public:
  Legs(std::span<const rdw::Walk> walks, const std::vector<glm::dvec2>& regions,
       const LegRule& rule, const ShortestWay& shortestWay)
      : walks_(walks), rule_(rule), shortestWay_(shortestWay), regions_(regions.size()) {
    for (const rdw::Walk& walk : walks) {
      lengths_.emplace_back(1, 0.0);
      for (std::size_t i = 1; i < walk.samples.size(); ++i) {
        lengths_.back().push_back(lengths_.back().back() +
                                  glm::distance(walk.samples[i].plan, walk.samples[i - 1].plan));
      }
      stays_.emplace_back();
      for (const glm::dvec2 region : regions) stays_.back().push_back(staysIn(walk, region));
    }
    taken_.resize(walks.size());
    for (std::size_t from = 0; from < regions_; ++from) {
      for (std::size_t to = 0; to < regions_; ++to) {
        std::vector<WalkLeg> between;
        for (std::size_t w = 0; w < walks.size() && from != to; ++w) collect(w, from, to, between);
        between_.push_back(std::move(between));
      }
    }
  }

  /// The free legs between two regions, the shortest of each walker.
  std::vector<WalkLeg> free(std::size_t from, std::size_t to) const {
    std::vector<WalkLeg> best;
    for (const WalkLeg& leg : between_[from * regions_ + to]) {
      const std::vector<WalkLeg>& taken = taken_[leg.walk];
      if (std::any_of(taken.begin(), taken.end(), [&](const WalkLeg& other) {
            return leg.first < other.last && other.first < leg.last;
          })) {
        continue;
      }
      if (best.empty() || best.back().walk != leg.walk) {
        best.push_back(leg);
      } else if (leg.metres < best.back().metres) {
        best.back() = leg;
      }
    }
    return best;
  }

  void take(const std::vector<WalkLeg>& legs) {
    for (const WalkLeg& leg : legs) taken_[leg.walk].push_back(leg);
  }

 private:
  std::vector<Stay> staysIn(const rdw::Walk& walk, glm::dvec2 region) const {
    std::vector<Stay> stays;
    bool inside = false;
    for (std::size_t i = 0; i < walk.samples.size(); ++i) {
      const bool here = glm::distance(walk.samples[i].plan, region) <= rule_.regionRadius;
      if (here && !inside) stays.push_back({i, i});
      if (here) stays.back().last = i;
      inside = here;
    }
    return stays;
  }

  // Each stay in `from` that the walker leaves for `to` without coming back before.
  void collect(std::size_t w, std::size_t from, std::size_t to, std::vector<WalkLeg>& legs) const {
    const std::vector<Stay>& departures = stays_[w][from];
    const std::vector<Stay>& arrivals = stays_[w][to];
    for (std::size_t k = 0; k < departures.size(); ++k) {
      const std::size_t first = departures[k].last;
      const auto arrival = std::find_if(arrivals.begin(), arrivals.end(),
                                        [&](const Stay& stay) { return stay.first > first; });
      if (arrival == arrivals.end()) return;
      const std::size_t last = arrival->first;
      if (k + 1 < departures.size() && departures[k + 1].first < last) continue;
      const double metres = lengths_[w][last] - lengths_[w][first];
      if (metres < rule_.shortest) continue;
      const glm::dvec2 begin = walks_[w].samples[first].plan, end = walks_[w].samples[last].plan;
      const double shortest = shortestWay_(begin, end);
      if (!(metres <= rule_.detour * shortest && shortest < kNoWay)) continue;
      legs.push_back({w, first, last, metres, shortest});
    }
  }

  std::span<const rdw::Walk> walks_;
  const LegRule& rule_;
  const ShortestWay& shortestWay_;
  std::size_t regions_;
  std::vector<std::vector<double>> lengths_;           // per walk and sample: metres up to there
  std::vector<std::vector<std::vector<Stay>>> stays_;  // per walk and region
  std::vector<std::vector<WalkLeg>> between_;          // per pair of regions, ascending by walk
  std::vector<std::vector<WalkLeg>> taken_;            // per walk
};

}  // namespace

WalkLegs cutLegs(std::span<const rdw::Walk> walks, const LegRule& rule,
                 const ShortestWay& shortestWay) {
  const std::vector<Rest> rests = findRests(walks, rule);
  WalkLegs result{findRegions(rests, rule), rests.size(), {}};
  Legs legs(walks, result.regions, rule, shortestWay);
  while (true) {
    LegSet best{0, 0, {}};
    double bestMean = kNoWay;
    for (std::size_t from = 0; from < result.regions.size(); ++from) {
      for (std::size_t to = 0; to < result.regions.size(); ++to) {
        std::vector<WalkLeg> free = legs.free(from, to);
        if (free.size() < rule.walkers || free.size() < best.legs.size()) continue;
        double mean = 0.0;
        for (const WalkLeg& leg : free) mean += leg.metres / static_cast<double>(free.size());
        if (free.size() == best.legs.size() && mean >= bestMean) continue;
        best = {from, to, std::move(free)};
        bestMean = mean;
      }
    }
    if (best.legs.empty()) break;
    legs.take(best.legs);
    result.sets.push_back(std::move(best));
  }
  std::sort(result.sets.begin(), result.sets.end(), [](const LegSet& a, const LegSet& b) {
    return std::tie(a.from, a.to) < std::tie(b.from, b.to);
  });
  return result;
}

double comfortSpeed(const rdw::Walk& walk) {
  const std::vector<rdw::WalkFrame> frames = rdw::resample(walk, kSpeedRate);
  std::vector<double> speeds;
  for (std::size_t i = 1; i < frames.size(); ++i) {
    const double speed = glm::distance(frames[i].plan, frames[i - 1].plan) * kSpeedRate;
    if (speed > kStanding) speeds.push_back(speed);
  }
  if (speeds.empty()) return kUsualSpeed;
  const auto middle = speeds.begin() + static_cast<std::ptrdiff_t>(speeds.size() / 2);
  std::nth_element(speeds.begin(), middle, speeds.end());
  return *middle;
}

}  // namespace forewalk::service
