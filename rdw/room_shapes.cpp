#include "rdw/room_shapes.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <array>
#include <cmath>
#include <vector>

namespace forewalk::rdw {

namespace {

using Corners = std::vector<glm::dvec2>;

constexpr std::array<std::string_view, 6> kNames{"square", "trapezoid", "triangle",
                                                 "cross",  "L",         "T"};

// Of any size; counter-clockwise.
Corners cornersOf(std::size_t shape) {
  switch (shape) {
    case 0:
      return {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    case 1:
      return {{0, 0}, {4, 0}, {3, 3}, {1, 3}};
    case 2:
      return {{0, 0}, {2, 0}, {1, std::sqrt(3.0)}};
    case 3:
      return {{1, 0}, {2, 0}, {2, 1}, {3, 1}, {3, 2}, {2, 2},
              {2, 3}, {1, 3}, {1, 2}, {0, 2}, {0, 1}, {1, 1}};
    case 4:
      return {{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}};
    default:
      return {{1, 0}, {2, 0}, {2, 1}, {3, 1}, {3, 2}, {0, 2}, {0, 1}, {1, 1}};
  }
}

}  // namespace

std::span<const std::string_view> roomShapeNames() { return kNames; }

tl::expected<TrackedSpace, Error> roomShape(std::string_view name, double area) {
  std::size_t shape = 0;
  while (shape < kNames.size() && kNames[shape] != name) ++shape;
  const auto refused = [](std::string message) {
    return tl::unexpected(Error{ErrorCode::kSettingOutOfRange, std::move(message)});
  };
  if (shape == kNames.size()) {
    return refused(fmt::format("tracked space: shape \"{}\" is not known, use one of {}.", name,
                               fmt::join(kNames, ", ")));
  }
  if (!(area >= 1.0 && area <= 1e6)) {
    return refused(fmt::format(
        "tracked space: an area of {} m^2 cannot work: give 1 to 1,000,000 m^2.", area));
  }
  Corners corners = cornersOf(shape);
  double twice = 0.0;
  glm::dvec2 sum(0.0);
  for (std::size_t i = 0, j = corners.size() - 1; i < corners.size(); j = i++) {
    const double cross = corners[j].x * corners[i].y - corners[j].y * corners[i].x;
    twice += cross;
    sum += cross * (corners[j] + corners[i]);
  }
  const glm::dvec2 centroid = sum / (3.0 * twice);
  const double scale = std::sqrt(area / (0.5 * twice));
  for (glm::dvec2& corner : corners) corner = scale * (corner - centroid);
  return TrackedSpace::polygon(corners);
}

}  // namespace forewalk::rdw
