// 32-bit numbers as scene files store them, whatever the machine's own order.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace forewalk::navmesh {

/// The four bytes from `at` on, which must be there.
inline std::uint32_t loadLittle(std::string_view bytes, std::size_t at) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    value |= std::uint32_t{static_cast<unsigned char>(bytes[at + i])} << (8 * i);
  }
  return value;
}

inline void appendLittle(std::string& bytes, std::uint32_t value) {
  for (int i = 0; i < 4; ++i) bytes += static_cast<char>(value >> (8 * i) & 0xffu);
}

}  // namespace forewalk::navmesh
