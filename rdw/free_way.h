// How far one can walk in a room that others share.
#pragma once

#include <glm/glm.hpp>
#include <span>

#include "rdw/other_user.h"
#include "rdw/tracked_space.h"

namespace forewalk::rdw {

/// Metres from `point` along unit vector `direction` to the border, an obstacle or the circle of
/// another user, as they stand now. Within somebody's circle: 0 toward them, else they are not in
/// the way. O(corners + others).
double freeAlong(const TrackedSpace& space, std::span<const OtherUser> others, glm::dvec2 point,
                 glm::dvec2 direction);

/// The part of it that the others leave: infinite where nobody is in the way.
double freeAmong(std::span<const OtherUser> others, glm::dvec2 point, glm::dvec2 direction);

/// Distance to the nearest border or circle, metres; below 0 outside, or within a circle.
double clearanceAt(const TrackedSpace& space, std::span<const OtherUser> others, glm::dvec2 point);

/// Of `count` directions, beginning with unit vector `first` and going round left, the one with the
/// most free way; of equals the earliest.
glm::dvec2 freestDirection(const TrackedSpace& space, std::span<const OtherUser> others,
                           glm::dvec2 point, glm::dvec2 first, int count);

}  // namespace forewalk::rdw
