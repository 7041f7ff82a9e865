// All cores for work that comes in independent pieces: tiles of a navmesh, seeds of a simulation.
#pragma once

#include "navmesh/build/build.h"

namespace forewalk::service {

/// How many threads there are to use: the machine's, at least 1.
unsigned coreCount();

/// A ForEach that runs its pieces on `threads` threads (0: all cores), the caller's among them, and
/// never on more threads than pieces. Pieces are handed out in ascending order as threads come
/// free. Where a piece throws, no new pieces begin, and when all threads are done the caller gets
/// the exception of the smallest such piece; no thread is left behind. Costs one thread start per
/// thread.
navmesh::ForEach onThreads(unsigned threads);

}  // namespace forewalk::service
