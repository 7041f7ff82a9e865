// Where several users begin who share a room.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "rdw/simulation.h"

namespace forewalk::rdw {
namespace {

constexpr int kSteps = 48;         // of the grid, along the longer side of the room
constexpr int kRounds = 12;        // in which everybody finds a better place; it settles sooner
constexpr double kToWall = 0.25;   // metres
constexpr double kToOthers = 1.0;  // metres

/// Places inside the room, and how far the walls are.
struct Place {
  glm::dvec2 at;
  double toWall;
};

std::vector<Place> gridOf(const TrackedSpace& space) {
  std::vector<Place> grid{{space.centre(), space.clearance()}};
  const glm::dvec2 size = space.upperBound() - space.lowerBound();
  const double step = std::max(size.x, size.y) / kSteps;
  for (double y = 0.5 * step; y < size.y; y += step) {
    for (double x = 0.5 * step; x < size.x; x += step) {
      const glm::dvec2 at = space.lowerBound() + glm::dvec2(x, y);
      const double toWall = space.signedDistance(at);
      if (toWall > 0.0) grid.push_back({at, toWall});
    }
  }
  return grid;
}

}  // namespace

tl::expected<std::vector<PlanarPose>, Error> placesInRoom(const TrackedSpace& space,
                                                          std::size_t users) {
  if (users == 1) return std::vector<PlanarPose>{{space.centre(), 0.0}};
  const std::vector<Place> grid = gridOf(space);
  // Discs as large as fit, one after the other and then each anew among the others: half the way to
  // another is worth as much as the way to a wall.
  std::vector<std::size_t> chosen;
  const auto room = [&](std::size_t place, std::size_t without) {
    double radius = grid[place].toWall;
    for (std::size_t i = 0; i < chosen.size(); ++i) {
      if (i == without) continue;
      radius = std::min(radius, 0.5 * glm::distance(grid[place].at, grid[chosen[i]].at));
    }
    return radius;
  };
  const auto best = [&](std::size_t without) {
    std::size_t found = 0;
    double most = -1.0;
    for (std::size_t place = 0; place < grid.size(); ++place) {
      const double here = room(place, without);
      if (here > most) {
        most = here;
        found = place;
      }
    }
    return found;
  };
  for (std::size_t i = 0; i < users; ++i) chosen.push_back(best(i));
  for (int round = 0; round < kRounds; ++round) {
    for (std::size_t i = 0; i < users; ++i) chosen[i] = best(i);
  }

  double toOthers = std::numeric_limits<double>::infinity(), toWall = toOthers;
  std::vector<PlanarPose> places;
  for (std::size_t i = 0; i < users; ++i) {
    const Place& place = grid[chosen[i]];
    toWall = std::min(toWall, place.toWall);
    for (std::size_t j = 0; j < i; ++j) {
      toOthers = std::min(toOthers, glm::distance(place.at, grid[chosen[j]].at));
    }
    const glm::dvec2 toCentre = space.centre() - place.at;
    places.push_back({place.at, glm::length(toCentre) > 1e-9 ? headingOf(toCentre) : 0.0});
  }
  if (toOthers < kToOthers || toWall < kToWall) {
    return tl::unexpected(
        Error{ErrorCode::kSettingOutOfRange,
              fmt::format("the room of {:.1f} m^2 has no place for {} users: two of them would "
                          "stand {:.2f} m apart ({:.2f} m are needed), one {:.2f} m from a wall "
                          "({:.2f} m); take fewer, or a larger room.",
                          space.area(), users, toOthers, kToOthers, toWall, kToWall)});
  }
  return places;
}

std::uint64_t seedOfUser(std::uint64_t seed, std::size_t user) {
  if (user == 0) return seed;
  // SplitMix64 (Steele, Lea and Flood 2014): neighbours' streams have nothing in common.
  std::uint64_t z = seed + user * 0x9e3779b97f4a7c15u;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
  return z ^ (z >> 31);
}

}  // namespace forewalk::rdw
