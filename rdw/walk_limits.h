// What no recording of a walk holds, whichever file it comes from. For rdw alone: not installed.
#pragma once

#include <optional>
#include <string>

#include "rdw/walk_file.h"

namespace forewalk::rdw {

inline constexpr double kFarthestSample = 1e5;   // metres; beyond, single precision loses the cm
inline constexpr double kLongestWalk = 86400.0;  // seconds; a day, whatever the clock started from

/// "moves 3 m in 0.1 s, faster than 12 m/s; cut the recording there." where nobody could have gone
/// from one sample to the next.
std::optional<std::string> tooFast(const WalkSample& before, const WalkSample& sample);

}  // namespace forewalk::rdw
