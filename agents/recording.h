// What a crowd did, tick by tick, to be looked at, measured and compared later.
//
// A step is a function of the state and the calls before it, so the same calls make the same
// recording to the last bit: `hash` compares two without keeping them.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "agents/agents_view.h"

namespace forewalk::agents {

class Recording {
 public:
  /// One tick. Lives as long as the recording is not added to.
  struct Frame {
    std::span<const AgentId> id;
    std::span<const glm::vec2> position;
    std::span<const glm::vec2> velocity;
    std::span<const float> heading;
    std::span<const float> height;
  };

  /// Room for so many entries (ticks times agents), so that adding them allocates nothing.
  void reserve(std::size_t frames, std::size_t entries);

  /// Appends the state as the next frame, agents in the order of their ids. Hand it to
  /// Crowd::onStep. O(agents), and sorting where agents were removed before.
  void add(const AgentsView& agents);

  std::size_t frames() const { return start_.size() - 1; }
  Frame frame(std::size_t k) const;

  /// Changes with every bit recorded.
  std::uint64_t hash() const { return hash_; }

  bool operator==(const Recording&) const = default;

 private:
  std::vector<std::size_t> start_{0};
  std::vector<AgentId> id_;
  std::vector<glm::vec2> position_, velocity_;
  std::vector<float> heading_, height_;
  std::vector<std::uint32_t> order_;
  std::uint64_t hash_ = 0xcbf29ce484222325ull;
};

}  // namespace forewalk::agents
