// How work that comes in independent pieces is handed to threads that somebody else owns.
#pragma once

#include <cstddef>
#include <functional>

namespace forewalk::navmesh {

/// Calls `work(i)` once for each i in [0, count), in any order, on any threads, and returns when
/// all are done. `service` brings one that uses all cores; where none is given, the pieces run in
/// turn.
using ForEach =
    std::function<void(std::size_t count, const std::function<void(std::size_t)>& work)>;

}  // namespace forewalk::navmesh
