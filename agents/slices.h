// Cutting a crowd into slices for the caller's threads.
#pragma once

#include <cstddef>
#include <cstdint>

#include "navmesh/for_each.h"

namespace forewalk::agents {

/// At most so many slices, whatever the number of threads: each has its own scratch.
inline constexpr std::size_t kSlices = 16;

/// Fewer agents than this are not worth a slice of their own.
inline constexpr std::uint32_t kSliceMin = 32;

/// Calls work(slice, begin, end) for at most kSlices slices that together are [0, n). Allocates
/// nothing: the function handed on refers to this frame.
template <typename Work>
void forSlices(std::uint32_t n, const navmesh::ForEach& forEach, const Work& work) {
  const std::size_t wanted = (static_cast<std::size_t>(n) + kSliceMin - 1) / kSliceMin;
  const std::size_t slices = wanted < kSlices ? wanted : kSlices;
  struct Cut {
    std::uint32_t n;
    std::size_t slices;
    const Work& work;
    void operator()(std::size_t slice) const {
      const auto at = [&](std::size_t s) { return static_cast<std::uint32_t>(n * s / slices); };
      work(slice, at(slice), at(slice + 1));
    }
  };
  const Cut cut{n, slices, work};
  if (forEach && slices > 1) {
    forEach(slices, [&cut](std::size_t slice) { cut(slice); });
  } else {
    for (std::size_t slice = 0; slice < slices; ++slice) cut(slice);
  }
}

}  // namespace forewalk::agents
