// Why something could not be loaded. Every room uses this one; a frame never fails (DESIGN.md section 2).
#pragma once

#include <string>

namespace forewalk {

/// What kind of thing went wrong, for programs. `service/capi/forewalk.h` repeats the numbers.
enum class ErrorCode : int {
  kFileUnreadable = 1,      ///< no such file, no permission, or reading stopped half-way
  kFormatUnknown = 2,       ///< the file ending or the first bytes name no format we read
  kFormatUnsupported = 3,   ///< a known format, but a version, extension or feature we do not read
  kDataDamaged = 4,         ///< ends early, checksum differs, index out of range, NaN, malformed text
  kSceneEmpty = 5,          ///< nothing in it that could be walked on
  kSettingOutOfRange = 6,   ///< a setting whose value cannot work
  kNothingWalkable = 7,     ///< the scene is sound, but a setting closes all of it
  kTooLarge = 8,            ///< exceeds a limit; the message names it
  kPositionOffNavMesh = 9,  ///< no walkable polygon within the snapping distance
  kFileUnwritable = 10,     ///< the output could not be written
};

/// `message` is one sentence for people: where, what, with the number and its unit, what to try
/// (STYLE.md section 6). UTF-8, no line break.
struct Error {
  ErrorCode code;
  std::string message;
};

}  // namespace forewalk
