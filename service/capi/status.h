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
inline constexpr std::size_t kFirstSize<forewalk_frame_out> = offsetof(forewalk_frame_out,
                                                                       steer_seconds) +
                                                              sizeof(float);
template <>
inline constexpr std::size_t kFirstSize<forewalk_graph_view> = offsetof(forewalk_graph_view,
                                                                        complete_to) +
                                                               sizeof(float);

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

}  // namespace forewalk::capi
