// The border itself: failures become numbers and a sentence per thread, and no exception crosses.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <exception>
#include <new>
#include <string>

#include "navmesh/error.h"
#include "service/capi/forewalk.h"

namespace forewalk::capi {

/// Remembers the thread's sentence and gives back the status. The message is copied, and made valid
/// UTF-8 where a file name or a file's content in it is not.
forewalk_status fail(forewalk_status status, const std::string& message) noexcept;
forewalk_status fail(const Error& error) noexcept;

/// The same for a string literal: allocates and locks nothing, so a frame may use it.
forewalk_status failLiteral(forewalk_status status, const char* message) noexcept;

/// The refusal of `value` in a field whose constants are 0 to `last`.
forewalk_status unknownConstant(const char* type, const char* field, std::int32_t value, int last);

/// Runs `body`, which returns a status. What it throws becomes FOREWALK_ERROR_OUT_OF_MEMORY or
/// FOREWALK_ERROR_INTERNAL.
template <typename Body>
forewalk_status guarded(Body&& body) noexcept {
  try {
    return body();
  } catch (const std::bad_alloc&) {
    return failLiteral(
        FOREWALK_ERROR_OUT_OF_MEMORY,
        "out of memory: a smaller scene, a larger cell or a lower polygon_limit needs "
        "less.");
  } catch (const std::exception& exception) {
    try {
      return fail(FOREWALK_ERROR_INTERNAL,
                  std::string("a defect of forewalk, please report it: ") + exception.what());
    } catch (...) {
      return failLiteral(FOREWALK_ERROR_INTERNAL, "a defect of forewalk, please report it.");
    }
  } catch (...) {
    return failLiteral(FOREWALK_ERROR_INTERNAL, "a defect of forewalk, please report it.");
  }
}

/// Where the last field ends that the first version of a struct had. Never changes when fields are
/// added.
template <typename Struct>
inline constexpr std::size_t kFirstSize = 0;
template <>
inline constexpr std::size_t kFirstSize<forewalk_build_settings> = offsetof(forewalk_build_settings,
                                                                            partition) +
                                                                   sizeof(forewalk_partition);
template <>
inline constexpr std::size_t kFirstSize<forewalk_session_settings> =
    offsetof(forewalk_session_settings, reserved) + sizeof(std::uint32_t);
template <>
inline constexpr std::size_t kFirstSize<forewalk_space_settings> = offsetof(forewalk_space_settings,
                                                                            user_limit) +
                                                                   sizeof(std::uint32_t);
template <>
inline constexpr std::size_t kFirstSize<forewalk_world_settings> = offsetof(forewalk_world_settings,
                                                                            door_count) +
                                                                   sizeof(std::size_t);
template <>
inline constexpr std::size_t kFirstSize<forewalk_frame_out> = offsetof(forewalk_frame_out,
                                                                       steer_seconds) +
                                                              sizeof(float);
template <>
inline constexpr std::size_t kFirstSize<forewalk_graph_view> = offsetof(forewalk_graph_view,
                                                                        complete_to) +
                                                               sizeof(float);
template <>
inline constexpr std::size_t kFirstSize<forewalk_navmesh_view> = offsetof(forewalk_navmesh_view,
                                                                          triangles) +
                                                                 sizeof(const forewalk_vec3*);

/// Whether some version of the struct can have this size. What is far larger than a struct of ours
/// was never set.
template <typename Struct>
bool isKnownSize(std::uint32_t size) {
  static_assert(kFirstSize<Struct> > 0 && kFirstSize<Struct> <= sizeof(Struct));
  constexpr std::size_t kLargest = 4096;
  return size >= kFirstSize<Struct> && size <= kLargest;
}

/// Copies the fields that both sides know; `to` keeps its own struct_size.
template <typename Struct>
void copyKnown(const Struct& from, Struct& to) {
  const std::uint32_t fromSize = from.struct_size, toSize = to.struct_size;
  std::size_t size = sizeof(Struct);
  if (fromSize < size) size = fromSize;
  if (toSize < size) size = toSize;
  std::memcpy(static_cast<void*>(&to), static_cast<const void*>(&from), size);
  to.struct_size = toSize;
}

/// Fills a caller's struct of `size` bytes with `defaults`; fields that this library does not know
/// become zero. Null: nothing. A size that no version has had: a struct_size that every call
/// refuses, where there is room for it.
template <typename Struct>
void initKnown(const Struct& defaults, Struct* settings, std::uint32_t size) {
  if (settings == nullptr || size < sizeof settings->struct_size) return;
  if (!isKnownSize<Struct>(size)) {
    settings->struct_size = 0;
    return;
  }
  std::memset(static_cast<void*>(settings), 0, size);
  settings->struct_size = size;
  copyKnown(defaults, *settings);
}

/// Puts what is given over the defaults in `known`; null: nothing. FOREWALK_OK, or the refusal of
/// its struct_size; `type` names the struct in it.
template <typename Struct>
forewalk_status readSettings(const Struct* given, const char* type, Struct& known) {
  if (given == nullptr) return FOREWALK_OK;
  if (!isKnownSize<Struct>(given->struct_size)) {
    return fail(FOREWALK_ERROR_ARGUMENT,
                std::string(type) + ": no version has had a struct_size of " +
                    std::to_string(given->struct_size) + " bytes. Call " + type + "_init first.");
  }
  copyKnown(*given, known);
  return FOREWALK_OK;
}

}  // namespace forewalk::capi
