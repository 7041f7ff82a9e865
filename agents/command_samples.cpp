#include "agents/command_samples.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace forewalk::agents {
namespace {

struct Range {
  float low, high;
  bool empty() const { return !(low <= high); }
};

/// What can be had of `available` within `reach` of `present`, which is first moved into it.
Range within(Range available, float present, float reach) {
  const float from = std::clamp(present, available.low, available.high);
  return {std::max(available.low, from - reach), std::min(available.high, from + reach)};
}

/// The sample `which` of `count`, evenly over a range.
float evenly(Range range, std::uint32_t which, std::uint32_t count) {
  if (count < 2) return 0.5f * (range.low + range.high);
  if (which + 1 == count) return range.high;
  return range.low +
         (range.high - range.low) * (static_cast<float>(which) / static_cast<float>(count - 1));
}

/// The one of `count` even samples that is nearest to `value`.
std::uint32_t nearestOf(Range range, float value, std::uint32_t count) {
  if (count < 2 || !(range.high > range.low)) return 0;
  const float share = (value - range.low) / (range.high - range.low);
  return static_cast<std::uint32_t>(
      std::lround(std::clamp(share, 0.0f, 1.0f) * static_cast<float>(count - 1)));
}

/// u from -1 to 1 becomes -1 to 1, denser about 0.
float spread(float u, float spacing) {
  return std::abs(spacing) < 1e-3f ? u : std::sinh(spacing * u) / std::sinh(spacing);
}

/// Narrows shares of the chain to those whose component lies in `range`.
void narrow(float begin, float end, Range range, Range& shares) {
  if (begin == end) {
    if (begin < range.low - kClipTolerance || begin > range.high + kClipTolerance) {
      shares = {1.0f, 0.0f};
    }
    return;
  }
  const float a = (range.low - begin) / (end - begin), b = (range.high - begin) / (end - begin);
  shares.low = std::max(shares.low, std::min(a, b));
  shares.high = std::min(shares.high, std::max(a, b));
}

void sampleChain(const LocomotionDatabase& clips, const CommandSampling& sampling, Range linear,
                 Range angular, std::vector<Command>& commands) {
  const Command begin = clips.alongChain(0.0f), end = clips.alongChain(1.0f);
  Range shares{0.0f, 1.0f};
  narrow(begin.linear, end.linear, linear, shares);
  narrow(begin.angular, end.angular, angular, shares);
  if (shares.empty()) return;
  std::uint32_t comfort = sampling.linearSamples;
  float comfortShare = 0.0f;
  if (sampling.comfortSpeed > 0.0f && begin.linear != end.linear) {
    comfortShare = (sampling.comfortSpeed - begin.linear) / (end.linear - begin.linear);
    if (comfortShare >= shares.low && comfortShare <= shares.high) {
      comfort = nearestOf(shares, comfortShare, sampling.linearSamples);
    }
  }
  for (std::uint32_t i = 0; i < sampling.linearSamples; ++i) {
    const Command command =
        clips.alongChain(i == comfort ? comfortShare : evenly(shares, i, sampling.linearSamples));
    if (commands.empty() || commands.back() != command) commands.push_back(command);
  }
}

}  // namespace

void sampleCommands(const LocomotionDatabase& clips, const CommandSampling& sampling,
                    std::vector<Command>& commands) {
  commands.clear();
  Range speeds{clips.lowest().linear, std::min(clips.highest().linear, sampling.fastest)};
  speeds.high =
      std::max(speeds.low, speeds.high);  // who is slower than all clips plays them slower
  const Range turns{clips.lowest().angular, clips.highest().angular};
  const Range linear = within(speeds, sampling.present.linear, sampling.reach.linear);
  const Range angular = within(turns, sampling.present.angular, sampling.reach.angular);
  if (!clips.chain().empty()) {
    sampleChain(clips, sampling, linear, angular, commands);
    return;
  }
  std::uint32_t comfort = sampling.linearSamples;
  if (sampling.comfortSpeed > 0.0f && sampling.comfortSpeed >= linear.low &&
      sampling.comfortSpeed <= linear.high) {
    comfort = nearestOf(linear, sampling.comfortSpeed, sampling.linearSamples);
  }
  std::array<float, kMostSamples> us, shares;
  const std::uint32_t turnsSampled = std::clamp(sampling.angularSamples, 1u, kMostSamples);
  const std::int64_t last = static_cast<std::int64_t>(turnsSampled) - 1;
  for (std::int64_t j = 0; j <= last; ++j) {
    // The same numbers for both sides, but for the sign.
    const float even =
        last == 0 ? 0.0f : static_cast<float>(2 * j - last) / static_cast<float>(last);
    const std::size_t at = static_cast<std::size_t>(j);
    us[at] = std::clamp((sampling.side < 0.0f ? even : -even) + sampling.sideOffset, -1.0f, 1.0f);
    shares[at] = spread(us[at], sampling.spacing);
  }
  for (std::uint32_t i = 0; i < sampling.linearSamples; ++i) {
    const float speed =
        i == comfort ? sampling.comfortSpeed : evenly(linear, i, sampling.linearSamples);
    const auto [low, high] = clips.angularAt(speed);
    const Range turnsHere = sampling.fitted
                                ? Range{std::max(angular.low, low), std::min(angular.high, high)}
                                : angular;
    if (turnsHere.empty()) continue;
    // Straight ahead where that can be reached, and as nearly so as it can where not.
    const float middle = std::clamp(0.0f, turnsHere.low, turnsHere.high);
    const std::size_t row = commands.size();
    for (std::uint32_t j = 0; j < turnsSampled; ++j) {
      const float turn = us[j] > 0.0f ? middle + (turnsHere.high - middle) * shares[j]
                                      : middle + (middle - turnsHere.low) * shares[j];
      if (turn < low - kClipTolerance || turn > high + kClipTolerance) continue;
      const Command command{speed, turn};
      if (commands.size() > row && commands.back() == command) continue;
      if (row > 0 && commands[row - 1].linear == speed) continue;  // the row before had them
      commands.push_back(command);
    }
  }
}

}  // namespace forewalk::agents
