// The example in a room's README, for the test that compiles it.
#pragma once

#include <fstream>
#include <sstream>
#include <string>

namespace forewalk::testing {

/// Empty where the file cannot be read.
inline std::string contentsOf(const std::string& file) {
  std::ifstream in(file);
  std::stringstream text;
  text << in.rdbuf();
  return text.str();
}

/// The first block of C++ in a page, without its fences; where there is none, a sentence that no
/// program holds.
inline std::string firstExampleIn(const std::string& page) {
  const std::string text = contentsOf(page);
  const std::string fence = "```cpp\n";
  const std::size_t begin = text.find(fence);
  if (begin == std::string::npos) return "no example in " + page;
  const std::size_t first = begin + fence.size();
  return text.substr(first, text.find("```", first) - first);
}

}  // namespace forewalk::testing
