// Work in independent pieces, on threads.
#include "service/parallel.h"

#include <gtest/gtest.h>

#include <atomic>
#include <stdexcept>
#include <string>
#include <vector>

namespace forewalk::service {
namespace {

TEST(OnThreads, DoesNothingForNoPieces) {
  onThreads(4)(0, [](std::size_t) { FAIL(); });
}

TEST(OnThreads, DoesEveryPieceOnceWhateverTheThreads) {
  for (const unsigned threads : {0u, 1u, 2u, 7u, 100u}) {
    for (const std::size_t count : {std::size_t{1}, std::size_t{3}, std::size_t{1000}}) {
      std::vector<std::atomic<int>> done(count);
      onThreads(threads)(count, [&](std::size_t i) { done[i].fetch_add(1); });
      for (const auto& times : done) EXPECT_EQ(times.load(), 1);
    }
  }
}

TEST(OnThreads, HandsTheFirstExceptionToTheCallerAfterAllThreadsAreDone) {
  for (const unsigned threads : {1u, 4u}) {
    std::atomic<int> running{0};
    try {
      onThreads(threads)(100, [&](std::size_t i) {
        running.fetch_add(1);
        if (i >= 3) {
          running.fetch_sub(1);
          throw std::runtime_error("piece " + std::to_string(i));
        }
        running.fetch_sub(1);
      });
      FAIL() << "no exception";
    } catch (const std::runtime_error& error) {
      EXPECT_EQ(error.what(), std::string("piece 3")) << "pieces begin in order, so 3 always fails";
    }
    EXPECT_EQ(running.load(), 0);
  }
}

TEST(OnThreads, NestsWithoutWaitingForItself) {
  std::atomic<int> sum{0};
  onThreads(3)(4, [&](std::size_t) {
    onThreads(3)(5, [&](std::size_t i) { sum.fetch_add(static_cast<int>(i)); });
  });
  EXPECT_EQ(sum.load(), 4 * 10);
}

}  // namespace
}  // namespace forewalk::service
