// Processor time of the calling thread: what a frame costs, whatever else the machine does.
#pragma once

#include <ctime>

namespace forewalk::bench {

/// Microseconds of processor time that this thread has used; one call takes some 0.3 us.
inline double threadMicroseconds() {
  std::timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return 1e6 * static_cast<double>(now.tv_sec) + 1e-3 * static_cast<double>(now.tv_nsec);
}

}  // namespace forewalk::bench
