// The rooms that the field compares controllers in: one shape, any area.
#pragma once

#include <span>
#include <string_view>
#include <tl/expected.hpp>

#include "rdw/tracked_space.h"

namespace forewalk::rdw {

/// square, trapezoid (1 : 2 sides, as high as the longer's three quarters), triangle (equal sides),
/// cross (five squares), L (three), T (four).
std::span<const std::string_view> roomShapeNames();

/// The shape with `area` m^2 of floor and its centroid at the origin. Fails (kSettingOutOfRange)
/// for an unknown name, naming the known ones, and for an area outside [1, 1e6] m^2.
[[nodiscard]] tl::expected<TrackedSpace, Error> roomShape(std::string_view name, double area);

}  // namespace forewalk::rdw
