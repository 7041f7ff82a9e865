// The priority queue of graph searches: smallest key first, ties by polygon.
//
// A binary heap of single 64-bit numbers, key bits above polygon, so that one integer comparison
// orders both. Popping works bottom-up (the hole sinks to a leaf without a branch to mispredict,
// then the last entry rises): random starts make branch mispredictions the limit of such searches.
#pragma once

#include <cstdint>
#include <cstring>
#include <vector>

#include "navmesh/polygon_mesh.h"

namespace forewalk::navmesh {

/// Keys are finite and >= 0. Improved keys are pushed again; the caller skips entries that are
/// stale.
class KeyQueue {
 public:
  /// A key and its polygon in one comparable number.
  using Entry = std::uint64_t;

  // The bits of floats that are not negative are ordered as the floats are.
  static Entry entryOf(float key, PolygonId polygon) {
    std::uint32_t bits;
    std::memcpy(&bits, &key, sizeof bits);
    return (Entry{bits} << 32) | index(polygon);
  }
  static PolygonId polygonOf(Entry entry) { return PolygonId{static_cast<std::uint32_t>(entry)}; }
  static float keyOf(Entry entry) {
    const std::uint32_t bits = static_cast<std::uint32_t>(entry >> 32);
    float key;
    std::memcpy(&key, &bits, sizeof key);
    return key;
  }

  void reserve(std::size_t entries) { heap_.resize(entries); }
  void clear() { size_ = 0; }
  bool empty() const { return size_ == 0; }
  std::size_t size() const { return size_; }
  std::size_t capacity() const { return heap_.size(); }

  /// Entry i in no particular order, for walking over what is left. i < size().
  Entry at(std::size_t i) const { return heap_[i]; }

  /// The smallest. Not on an empty queue.
  Entry top() const { return heap_[0]; }

  /// Not on a full queue (size() == capacity()).
  void push(Entry entry) { rise(size_++, entry); }

  /// Not on an empty queue.
  void pop() {
    const Entry last = heap_[--size_];
    if (size_ > 0) rise(sink(), last);
  }

  /// The same as pop() and push(entry), for the price of one: the hole is filled with what comes
  /// in.
  void replaceTop(Entry entry) { rise(sink(), entry); }

 private:
  /// Moves the hole at the top to a leaf, always along the smaller child. Returns where it ends.
  std::size_t sink() {
    Entry* heap = heap_.data();
    const std::size_t count = size_;
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
    return hole;
  }

  void rise(std::size_t hole, Entry entry) {
    Entry* heap = heap_.data();
    while (hole > 0) {
      const std::size_t above = (hole - 1) / 2;
      if (heap[above] < entry) break;
      heap[hole] = heap[above];
      hole = above;
    }
    heap[hole] = entry;
  }

  std::vector<Entry> heap_;  // sized once; the first size_ are in use
  std::size_t size_ = 0;
};

}  // namespace forewalk::navmesh
