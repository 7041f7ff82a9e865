#include "agents/recording.h"

#include <algorithm>
#include <cstring>

namespace forewalk::agents {

void Recording::reserve(std::size_t frames, std::size_t entries) {
  start_.reserve(frames + 1);
  id_.reserve(entries);
  position_.reserve(entries);
  velocity_.reserve(entries);
  heading_.reserve(entries);
  height_.reserve(entries);
}

void Recording::add(const AgentsView& agents) {
  const std::uint32_t n = agents.size();
  order_.resize(n);
  for (std::uint32_t i = 0; i < n; ++i) order_[i] = i;
  const auto before = [&](std::uint32_t a, std::uint32_t b) {
    return number(agents.id[a]) < number(agents.id[b]);
  };
  if (!std::is_sorted(order_.begin(), order_.end(), before)) {
    std::sort(order_.begin(), order_.end(), before);
  }
  const auto mix = [&](float value) {
    std::uint32_t bits = 0;
    std::memcpy(&bits, &value, sizeof(bits));
    hash_ = (hash_ ^ bits) * 0x100000001b3ull;
  };
  for (const std::uint32_t i : order_) {
    id_.push_back(agents.id[i]);
    position_.push_back(agents.position[i]);
    velocity_.push_back(agents.velocity[i]);
    heading_.push_back(agents.heading[i]);
    height_.push_back(agents.height[i]);
    hash_ = (hash_ ^ number(agents.id[i])) * 0x100000001b3ull;
    mix(agents.position[i].x);
    mix(agents.position[i].y);
    mix(agents.velocity[i].x);
    mix(agents.velocity[i].y);
    mix(agents.heading[i]);
    mix(agents.height[i]);
  }
  start_.push_back(id_.size());
}

Recording::Frame Recording::frame(std::size_t k) const {
  const std::size_t begin = start_[k], size = start_[k + 1] - begin;
  return {std::span(id_).subspan(begin, size), std::span(position_).subspan(begin, size),
          std::span(velocity_).subspan(begin, size), std::span(heading_).subspan(begin, size),
          std::span(height_).subspan(begin, size)};
}

}  // namespace forewalk::agents
