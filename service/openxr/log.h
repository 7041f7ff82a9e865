// The layer's lines, one per event, in a process that is not ours: no library, no thread, no poses.
#pragma once

#include <string_view>

namespace forewalk::openxr {

/// Where lines go from now on, as FOREWALK_OPENXR_LOG says: unset or empty, to stderr; `off`,
/// nowhere; else they are appended to the file of that name, or go to stderr where it cannot be
/// opened.
void openLog();

/// Writes "forewalk: " and one line, at once. Any thread. Never fails.
void say(std::string_view line) noexcept;

}  // namespace forewalk::openxr
