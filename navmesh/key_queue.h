// The priority queue of graph searches: smallest key first, ties by polygon.
//
// A binary heap of single 64-bit numbers, key bits above polygon, so that one integer comparison orders
// both. Popping works bottom-up (the hole sinks to a leaf without a branch to mispredict, then the last
// entry rises): random starts make branch mispredictions the limit of such searches.
#pragma once

#include <cstdint>
#include <cstring>
#include <vector>

#include "navmesh/polygon_mesh.h"

namespace forewalk::navmesh {

/// Keys are finite and >= 0. Improved keys are pushed again; the caller skips entries that are stale.
class KeyQueue {
 public:
  struct Entry {
    float key;
    PolygonId polygon;
  };

  void reserve(std::size_t entries) { heap_.reserve(entries); }
  void clear() { heap_.clear(); }
  bool empty() const { return heap_.empty(); }
  /// Another push would allocate.
  bool full() const { return heap_.size() == heap_.capacity(); }

  /// Entry i in no particular order, for walking over what is left. i < size().
  Entry at(std::size_t i) const { return unpacked(heap_[i]); }
  std::size_t size() const { return heap_.size(); }

  void push(float key, PolygonId polygon) {
    const std::uint64_t entry = packed(key, polygon);
    heap_.push_back(entry);
    rise(heap_.size() - 1, entry);
  }

  /// Not on an empty queue.
  Entry pop() {
    std::uint64_t* heap = heap_.data();
    const std::uint64_t top = heap[0];
    const std::uint64_t last = heap_.back();
    heap_.pop_back();
    const std::size_t count = heap_.size();
    if (count == 0) return unpacked(top);
    std::size_t hole = 0;
    std::size_t child = 1;
    while (child + 1 < count) {
      child += static_cast<std::size_t>(heap[child + 1] < heap[child]);
      heap[hole] = heap[child];
      hole = child;
      child = 2 * hole + 1;
    }
    if (child < count) {
      heap[hole] = heap[child];
      hole = child;
    }
    rise(hole, last);
    return unpacked(top);
  }

 private:
  // The bits of floats that are not negative are ordered as the floats are.
  static std::uint64_t packed(float key, PolygonId polygon) {
    std::uint32_t bits;
    std::memcpy(&bits, &key, sizeof bits);
    return (std::uint64_t{bits} << 32) | index(polygon);
  }

  static Entry unpacked(std::uint64_t entry) {
    const std::uint32_t bits = static_cast<std::uint32_t>(entry >> 32);
    float key;
    std::memcpy(&key, &bits, sizeof key);
    return {key, PolygonId{static_cast<std::uint32_t>(entry)}};
  }

  void rise(std::size_t hole, std::uint64_t entry) {
    std::uint64_t* heap = heap_.data();
    while (hole > 0) {
      const std::size_t above = (hole - 1) / 2;
      if (heap[above] < entry) break;
      heap[hole] = heap[above];
      hole = above;
    }
    heap[hole] = entry;
  }

  std::vector<std::uint64_t> heap_;
};

}  // namespace forewalk::navmesh
