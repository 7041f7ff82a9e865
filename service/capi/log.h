// What the log function of the process is told.
#pragma once

#include <fmt/format.h>

#include <array>
#include <utility>

#include "service/capi/forewalk.h"

namespace forewalk::capi {

/// Whether somebody wants to be told. A load.
bool logs(forewalk_log_level level) noexcept;

/// Tells it. `message` ends with a zero.
void tell(forewalk_log_level level, const char* message) noexcept;

/// Formats and tells, where somebody wants it. Allocates nothing: a longer message is cut off.
template <typename... Values>
void tell(forewalk_log_level level, fmt::format_string<Values...> text, Values&&... values) {
  if (!logs(level)) return;
  std::array<char, 512> message;
  const auto end =
      fmt::format_to_n(message.data(), message.size() - 1, text, std::forward<Values>(values)...)
          .out;
  *end = '\0';
  tell(level, message.data());
}

}  // namespace forewalk::capi
