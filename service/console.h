// What the command line says to a person on stderr: a progress bar, and one line where it fails.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace forewalk::service {

/// Prints "forewalk: message" as one line on stderr, whatever line breaks are in it.
void printError(std::string_view message);

/// A bar on stderr where that is a terminal, else silent. Erased when it ends, so that what a
/// program leaves behind does not depend on where it ran. One thread at a time.
class ProgressBar {
 public:
  explicit ProgressBar(std::string label);
  ~ProgressBar();
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  /// `done` of `total` pieces, and a few words after them. Draws only when the bar changes.
  void update(std::size_t done, std::size_t total, std::string_view words = "");

 private:
  std::string label_;
  std::string drawn_;
  bool visible_;
};

}  // namespace forewalk::service
