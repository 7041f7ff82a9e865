#include "service/parallel.h"

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <system_error>
#include <thread>
#include <vector>

namespace forewalk::service {
namespace {

void forEach(unsigned threads, std::size_t count, const std::function<void(std::size_t)>& work) {
  std::atomic<std::size_t> next{0};
  std::mutex failureMutex;
  std::exception_ptr failure;
  std::size_t failed = count;
  const auto run = [&] {
    for (std::size_t i = next.fetch_add(1); i < count; i = next.fetch_add(1)) {
      try {
        work(i);
      } catch (...) {
        next.store(count);
        const std::lock_guard lock(failureMutex);
        if (i < failed) {
          failed = i;
          failure = std::current_exception();
        }
      }
    }
  };
  const std::size_t helpers = std::min<std::size_t>(threads, count);
  std::vector<std::thread> pool;
  pool.reserve(helpers);
  for (std::size_t t = 1; t < helpers; ++t) {
    try {
      pool.emplace_back(run);
    } catch (const std::system_error&) {
      break;  // no more threads to be had: those there are do the work
    }
  }
  run();
  for (std::thread& thread : pool) thread.join();
  if (failure) std::rethrow_exception(failure);
}

}  // namespace

unsigned coreCount() { return std::max(1u, std::thread::hardware_concurrency()); }

navmesh::ForEach onThreads(unsigned threads) {
  const unsigned used = threads == 0 ? coreCount() : threads;
  return [used](std::size_t count, const std::function<void(std::size_t)>& work) {
    forEach(used, count, work);
  };
}

}  // namespace forewalk::service
