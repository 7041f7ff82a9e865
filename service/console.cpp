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

void ProgressBar::update(std::size_t done, std::size_t total, std::string_view words) {
  if (!visible_ || total == 0) return;
  constexpr std::size_t kWidth = 30;
  const std::size_t full = kWidth * std::min(done, total) / total;
  std::string bar = fmt::format("{} [{:#<{}}{:.<{}}] {}/{}{}{}", label_, "", full, "",
                                kWidth - full, done, total, words.empty() ? "" : ", ", words);
  if (bar == drawn_) return;
  const int shrunk = static_cast<int>(drawn_.size()) - static_cast<int>(bar.size());
  std::fprintf(stderr, "\r%s%*s", bar.c_str(), std::max(0, shrunk), "");
  std::fflush(stderr);
  drawn_ = std::move(bar);
}

}  // namespace forewalk::service
