#include "navmesh/build/obstacle.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <string>

#include "navmesh/plan.h"

namespace forewalk::navmesh {
namespace {

constexpr float kPlaceMax = 1e6f;  // metres; beyond, floats are coarser than a step
constexpr float kSizeMax = 1e3f;   // metres
constexpr std::size_t kCornersMax = 64;
constexpr double kTolerance = 1e-3;  // metres

using Check = tl::expected<void, Error>;

Check outOfRange(std::string message) {
  return tl::unexpected(Error{ErrorCode::kSettingOutOfRange, std::move(message)});
}

Check checkPlace(const char* what, float value) {
  if (!std::isfinite(value)) {
    return tl::unexpected(
        Error{ErrorCode::kDataDamaged,
              fmt::format("obstacle: {} is {}, not a number. Give metres.", what, value)});
  }
  if (std::abs(value) > kPlaceMax) {
    return outOfRange(
        fmt::format("obstacle: {} is {:g} m, it must be within {:g} m of 0. Check "
                    "its unit.",
                    what, value, kPlaceMax));
  }
  return {};
}

Check checkSize(const char* what, float value) {
  if (Check place = checkPlace(what, value); !place) return place;
  if (value > 0.0f && value <= kSizeMax) return {};
  return outOfRange(
      fmt::format("obstacle: {} is {:g} m, it must be above 0 and at most {:g} m. Make it {}.",
                  what, value, kSizeMax, value > 0.0f ? "several obstacles" : "larger"));
}

Check firstFailure(std::initializer_list<Check> checks) {
  for (const Check& check : checks) {
    if (!check) return check;
  }
  return {};
}

Check check(const BoxObstacle& box) {
  if (!std::isfinite(box.heading)) {
    return tl::unexpected(
        Error{ErrorCode::kDataDamaged,
              fmt::format("obstacle: heading is {}, not a number. Give radians.", box.heading)});
  }
  return firstFailure(
      {checkPlace("centre.x", box.centre.x), checkPlace("centre.y", box.centre.y),
       checkPlace("centre.z", box.centre.z), checkSize("halfSize.x", box.halfSize.x),
       checkSize("halfSize.y", box.halfSize.y), checkSize("halfSize.z", box.halfSize.z)});
}

Check check(const CylinderObstacle& cylinder) {
  return firstFailure({checkPlace("foot.x", cylinder.foot.x), checkPlace("foot.y", cylinder.foot.y),
                       checkPlace("foot.z", cylinder.foot.z), checkSize("radius", cylinder.radius),
                       checkSize("height", cylinder.height)});
}

Check checkOutline(const std::vector<glm::vec2>& corners) {
  double twiceArea = 0.0;
  for (std::size_t i = 0; i + 1 < corners.size(); ++i) {
    twiceArea += exactTurn(corners[0], corners[i], corners[i + 1]);
  }
  if (!(twiceArea > 0.0)) {
    return outOfRange(
        fmt::format("obstacle: its outline has {:g} m^2 counter-clockwise seen from "
                    "above. Reverse or spread its corners.",
                    0.5 * twiceArea));
  }
  // Every corner left of every edge: a ring that winds twice (a star) fails it too.
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const glm::vec2 from = corners[i], to = corners[(i + 1) % corners.size()];
    const double length = glm::distance(glm::dvec2(from), glm::dvec2(to));
    for (std::size_t k = 0; k < corners.size(); ++k) {
      const double beside = exactTurn(from, to, corners[k]);
      if (beside >= -kTolerance * length) continue;
      return outOfRange(
          fmt::format("obstacle: its outline is not convex: corner {} lies {:.3f} m outside the "
                      "edge from corner {}. Split it into convex obstacles.",
                      k, -beside / length, i));
    }
  }
  return {};
}

Check check(const PrismObstacle& prism) {
  if (prism.corners.size() < 3 || prism.corners.size() > kCornersMax) {
    return outOfRange(fmt::format("obstacle: its outline has {} corners, it must have 3 to {}. {}",
                                  prism.corners.size(), kCornersMax,
                                  prism.corners.size() < 3 ? "Add some." : "Simplify it."));
  }
  glm::vec2 low = prism.corners[0], high = low;
  for (const glm::vec2 corner : prism.corners) {
    if (Check ok = checkPlace("a corner's x", corner.x); !ok) return ok;
    if (Check ok = checkPlace("a corner's plan y", corner.y); !ok) return ok;
    low = glm::min(low, corner);
    high = glm::max(high, corner);
  }
  if (Check ok = firstFailure({checkPlace("bottom", prism.bottom), checkPlace("top", prism.top)});
      !ok) {
    return ok;
  }
  if (Check ok = checkSize("top - bottom", prism.top - prism.bottom); !ok) return ok;
  if (Check ok = checkSize("its outline's width", std::max(high.x - low.x, high.y - low.y)); !ok) {
    return ok;
  }
  return checkOutline(prism.corners);
}

ObstacleOutline outline(const BoxObstacle& box) {
  ObstacleOutline result;
  const glm::dvec2 centre(toPlan(box.centre));
  const double heading = box.heading;
  const glm::dvec2 along(std::cos(heading), std::sin(heading));
  const glm::dvec2 across(-along.y, along.x);
  const glm::dvec2 side = static_cast<double>(box.halfSize.x) * along;
  const glm::dvec2 depth = static_cast<double>(box.halfSize.z) * across;
  result.corners = {centre - side - depth, centre + side - depth, centre + side + depth,
                    centre - side + depth};
  result.bottom = static_cast<double>(box.centre.y) - box.halfSize.y;
  result.top = static_cast<double>(box.centre.y) + box.halfSize.y;
  return result;
}

ObstacleOutline outline(const PrismObstacle& prism) {
  ObstacleOutline result;
  std::transform(prism.corners.begin(), prism.corners.end(), std::back_inserter(result.corners),
                 [](glm::vec2 corner) { return glm::dvec2(corner); });
  result.bottom = prism.bottom;
  result.top = prism.top;
  return result;
}

ObstacleOutline outline(const CylinderObstacle& cylinder) {
  ObstacleOutline result;
  result.centre = glm::dvec2(toPlan(cylinder.foot));
  result.radius = cylinder.radius;
  result.bottom = cylinder.foot.y;
  result.top = static_cast<double>(cylinder.foot.y) + cylinder.height;
  return result;
}

}  // namespace

Check validate(const Obstacle& obstacle) {
  return std::visit([](const auto& shape) { return check(shape); }, obstacle);
}

ObstacleOutline outlineOf(const Obstacle& obstacle) {
  return std::visit([](const auto& shape) { return outline(shape); }, obstacle);
}

}  // namespace forewalk::navmesh
