// Timing in turns on a shared, noisy machine: medians, and every contestant within the same
// minutes.
#pragma once

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <functional>
#include <string>
#include <vector>

namespace forewalk::bench {

inline double medianOf(std::vector<double> values) {
  if (values.empty()) return 0.0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// `q` in [0, 1].
inline double quantileOf(std::vector<double> values, double q) {
  if (values.empty()) return 0.0;
  const auto at = values.begin() +
                  static_cast<std::ptrdiff_t>(q * static_cast<double>(values.size() - 1) + 0.5);
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

/// Something timed on each of many inputs.
struct Contestant {
  std::string name;
  std::function<void(std::size_t input)> run;
  std::vector<double> passMedians;  ///< microseconds, one a pass: the median over the inputs
  double median() const { return medianOf(passMedians); }
};

/// Runs every contestant on every input, `passes` times. Contestants take turns in chunks of
/// inputs, so that none finds its caches warmed by itself on the same input, and all share the
/// machine's moods; the order turns with every chunk. `before` runs untimed before each timed call
/// (cache flushing).
inline void timeInTurns(std::vector<Contestant*> contestants, std::size_t inputs, int passes,
                        const std::function<void()>& before = {}) {
  constexpr std::size_t kChunk = 64;
  using Clock = std::chrono::steady_clock;
  std::vector<std::vector<double>> times(contestants.size());
  for (int pass = -1; pass < passes; ++pass) {  // pass -1 warms up
    for (auto& list : times) list.clear();
    std::size_t turn = 0;
    for (std::size_t begin = 0; begin < inputs; begin += kChunk, ++turn) {
      const std::size_t end = std::min(inputs, begin + kChunk);
      for (std::size_t k = 0; k < contestants.size(); ++k) {
        const std::size_t who = (k + turn) % contestants.size();
        for (std::size_t input = begin; input < end; ++input) {
          if (before) before();
          const auto start = Clock::now();
          contestants[who]->run(input);
          const auto stop = Clock::now();
          times[who].push_back(std::chrono::duration<double, std::micro>(stop - start).count());
        }
      }
    }
    if (pass < 0) continue;
    for (std::size_t who = 0; who < contestants.size(); ++who) {
      contestants[who]->passMedians.push_back(medianOf(times[who]));
    }
  }
}

}  // namespace forewalk::bench
