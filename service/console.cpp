#include "service/console.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <utility>

namespace forewalk::service {

void printError(std::string_view message) {
  std::string line = fmt::format("forewalk: {}", message);
  for (char& c : line) {
    if (c == '\n' || c == '\r') c = ' ';
  }
  line += '\n';
  std::fwrite(line.data(), 1, line.size(), stderr);
}

ProgressBar::ProgressBar(std::string label)
    : label_(std::move(label)), visible_(isatty(STDERR_FILENO) == 1) {}

ProgressBar::~ProgressBar() {
  if (!drawn_.empty()) {
    std::fprintf(stderr, "\r%*s\r", static_cast<int>(drawn_.size()), "");
    std::fflush(stderr);
  }
}

void ProgressBar::update(std::size_t done, std::size_t total) {
  if (!visible_ || total == 0) return;
  constexpr std::size_t kWidth = 30;
  const std::size_t full = kWidth * std::min(done, total) / total;
  std::string bar =
      fmt::format("{} [{:#<{}}{:.<{}}] {}/{}", label_, "", full, "", kWidth - full, done, total);
  if (bar == drawn_) return;
  std::fprintf(stderr, "\r%s", bar.c_str());
  std::fflush(stderr);
  drawn_ = std::move(bar);
}

}  // namespace forewalk::service
