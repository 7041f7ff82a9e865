// What a fuzz target defines for what runs it (driver.cpp, or libFuzzer with write_seeds.cpp), and
// the words in which targets state their promises.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <initializer_list>
#include <string_view>
#include <vector>

/// Feeds one input to the door under test. Aborts when a promise is broken; a refusal is no
/// failure.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

/// Sound inputs from which mutation starts.
std::vector<std::vector<std::uint8_t>> seedCorpus();

namespace forewalk::testing {

/// Aborts, as a sanitizer would, where a promise is broken, and says which.
inline void require(bool promise, const char* what) {
  if (promise) return;
  std::fprintf(stderr, "broken promise: %s\n", what);
  std::abort();
}

/// What every refusal promises: one short line that starts with `where` and can be printed,
/// whatever the input held.
inline void requireSentence(std::string_view message, std::string_view where) {
  require(message.substr(0, where.size()) == where && message.size() < 600,
          "a message says where, and is short");
  for (const char c : message) require(c >= ' ' && c <= '~', "a message is printable");
}

/// A seed corpus of texts.
inline std::vector<std::vector<std::uint8_t>> seedsOf(
    std::initializer_list<std::string_view> texts) {
  std::vector<std::vector<std::uint8_t>> seeds;
  for (const std::string_view text : texts) seeds.emplace_back(text.begin(), text.end());
  return seeds;
}

}  // namespace forewalk::testing
