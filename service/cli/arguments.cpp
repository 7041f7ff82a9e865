#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstdlib>

#include "service/cli/verb.h"

namespace forewalk::cli {
namespace {

// The number that is all of `text`; not a number where it is none.
double numberOf(const std::string& text) {
  char* end = nullptr;
  const double value = std::strtod(text.c_str(), &end);
  return !text.empty() && end == text.c_str() + text.size() ? value : std::nan("");
}

std::vector<std::string> split(const std::string& text, char separator) {
  std::vector<std::string> parts{""};
  for (const char c : text) {
    if (c == separator) {
      parts.emplace_back();
    } else {
      parts.back() += c;
    }
  }
  return parts;
}

}  // namespace

std::string wholeNumber(const std::string& text) {
  const bool digits = !text.empty() && std::all_of(text.begin(), text.end(), [](unsigned char c) {
    return std::isdigit(c) != 0;
  });
  if (!digits) return fmt::format("\"{}\" is no whole number, 0 or more", text);
  std::uint64_t value = 0;
  const auto read = std::from_chars(text.data(), text.data() + text.size(), value);
  return read.ec == std::errc() ? "" : fmt::format("{} is more than 64 bits hold", text);
}

std::string fileName(const std::string& text) { return text.empty() ? "the name is empty" : ""; }

void refuseBothToStdout(const std::string& option, const std::filesystem::path& one,
                        const std::string& other, const std::filesystem::path& two) {
  if (one != "-" || two != "-") return;
  throw CLI::ValidationError(
      option, fmt::format("this and {} are both stdout; give one of them a file", other));
}

glm::vec3 parsePosition(const std::string& option, const std::string& text) {
  const auto parts = split(text, ',');
  glm::vec3 position{0.0f};
  for (std::size_t i = 0; i < 3; ++i) {
    position[static_cast<int>(i)] =
        parts.size() == 3 ? static_cast<float>(numberOf(parts[i])) : std::nanf("");
    if (!std::isfinite(position[static_cast<int>(i)])) {
      throw CLI::ValidationError(
          option,
          fmt::format("\"{}\" is no position; give x,y,z in metres, for example 3.5,0,-2", text));
    }
  }
  return position;
}

std::vector<float> parseSteps(const std::string& option, const std::string& text) {
  const auto refuse = [&](std::string_view reason) {
    throw CLI::ValidationError(
        option, fmt::format("\"{}\" {}; give from:to:step or a,b,c in metres, for example 5:40:5",
                            text, reason));
  };
  constexpr std::size_t kMost = 1000;
  std::vector<float> steps;
  if (text.find(':') != std::string::npos) {
    const auto parts = split(text, ':');
    if (parts.size() != 3) refuse("is no range");
    const double from = numberOf(parts[0]), to = numberOf(parts[1]), step = numberOf(parts[2]);
    if (!(from > 0 && to >= from && step > 0) || !std::isfinite(to)) refuse("is no range");
    if ((to - from) / step >= static_cast<double>(kMost)) refuse("has more than 1000 steps");
    for (int i = 0; from + i * step <= to * (1 + 1e-9); ++i) {
      steps.push_back(static_cast<float>(from + i * step));
    }
    return steps;
  }
  for (const std::string& part : split(text, ',')) {
    const double value = numberOf(part);
    if (!(value > 0) || !std::isfinite(value)) refuse("holds something that is no number above 0");
    if (steps.size() == kMost) refuse("has more than 1000 numbers");
    steps.push_back(static_cast<float>(value));
  }
  return steps;
}

}  // namespace forewalk::cli
