#include "service/capi/status.h"

#include <cstdint>
#include <string_view>

#include "service/capi/log.h"

namespace forewalk::capi {

namespace {

// A plain pointer in the thread's static block: reading and setting it never allocates, not even in
// a thread that touches it for the first time. The text it may point to is another matter.
#if defined(__ELF__)
__attribute__((tls_model("initial-exec")))
#endif
thread_local const char* latest = "";

std::string& ownText() {
  thread_local std::string text;
  return text;
}

// Length of the well-formed UTF-8 sequence at the start of `text`, 0 where there is none.
std::size_t sequenceLength(std::string_view text) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const unsigned char first = byte(0);
  if (first < 0x80) return 1;
  const std::size_t length = first >= 0xf0 ? 4 : first >= 0xe0 ? 3 : 2;
  if (first < 0xc2 || first > 0xf4 || text.size() < length) return 0;
  for (std::size_t i = 1; i < length; ++i) {
    if ((byte(i) & 0xc0) != 0x80) return 0;
  }
  // Overlong forms, surrogates, and what lies beyond U+10FFFF.
  const unsigned char second = byte(1);
  if ((first == 0xe0 && second < 0xa0) || (first == 0xed && second > 0x9f) ||
      (first == 0xf0 && second < 0x90) || (first == 0xf4 && second > 0x8f)) {
    return 0;
  }
  return length;
}

std::string validUtf8(std::string_view text) {
  std::string valid;
  valid.reserve(text.size());
  while (!text.empty()) {
    const std::size_t length = sequenceLength(text);
    if (length == 0) {
      valid += '?';
    } else {
      valid += text.substr(0, length);
    }
    text.remove_prefix(length == 0 ? 1 : length);
  }
  return valid;
}

}  // namespace

forewalk_status fail(forewalk_status status, const std::string& message) noexcept {
  try {
    std::string& text = ownText();
    text = validUtf8(message);
    latest = text.c_str();
  } catch (...) {
    latest = "out of memory while an error was being described.";
  }
  tell(FOREWALK_LOG_ERROR, latest);
  return status;
}

forewalk_status fail(const Error& error) noexcept {
  return fail(static_cast<forewalk_status>(error.code), error.message);
}

forewalk_status failLiteral(forewalk_status status, const char* message) noexcept {
  latest = message;
  tell(FOREWALK_LOG_ERROR, latest);
  return status;
}

forewalk_status unknownConstant(const char* type, const char* field, std::int32_t value, int last) {
  return fail(FOREWALK_ERROR_ARGUMENT,
              std::string(type) + ": " + field + " " + std::to_string(value) +
                  " is no constant of this version (0 to " + std::to_string(last) + ").");
}

// The header repeats the numbers of ErrorCode.
static_assert(FOREWALK_ERROR_FILE_UNREADABLE == static_cast<int>(ErrorCode::kFileUnreadable));
static_assert(FOREWALK_ERROR_FORMAT_UNKNOWN == static_cast<int>(ErrorCode::kFormatUnknown));
static_assert(FOREWALK_ERROR_FORMAT_UNSUPPORTED == static_cast<int>(ErrorCode::kFormatUnsupported));
static_assert(FOREWALK_ERROR_DATA_DAMAGED == static_cast<int>(ErrorCode::kDataDamaged));
static_assert(FOREWALK_ERROR_SCENE_EMPTY == static_cast<int>(ErrorCode::kSceneEmpty));
static_assert(FOREWALK_ERROR_SETTING_OUT_OF_RANGE ==
              static_cast<int>(ErrorCode::kSettingOutOfRange));
static_assert(FOREWALK_ERROR_NOTHING_WALKABLE == static_cast<int>(ErrorCode::kNothingWalkable));
static_assert(FOREWALK_ERROR_TOO_LARGE == static_cast<int>(ErrorCode::kTooLarge));
static_assert(FOREWALK_ERROR_POSITION_OFF_NAVMESH ==
              static_cast<int>(ErrorCode::kPositionOffNavMesh));
static_assert(FOREWALK_ERROR_FILE_UNWRITABLE == static_cast<int>(ErrorCode::kFileUnwritable));

}  // namespace forewalk::capi

extern "C" {

uint32_t forewalk_version(void) {
  return FOREWALK_VERSION_MAJOR << 16 | FOREWALK_VERSION_MINOR << 8 | FOREWALK_VERSION_PATCH;
}

const char* forewalk_last_error(void) { return forewalk::capi::latest; }

}  // extern "C"
