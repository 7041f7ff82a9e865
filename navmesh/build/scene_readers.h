// What the scene readers share: not installed, for the scene_*.cpp files alone.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <tl/expected.hpp>

#include "navmesh/build/scene.h"
#include "navmesh/file_text.h"

namespace forewalk::navmesh {

/// OBJ, OFF, PLY and STL in file units and file axes; every index in range, degenerate faces left
/// out.
[[nodiscard]] tl::expected<Scene, Error> readMeshFile(std::span<const std::byte> bytes,
                                                      SceneFormat format, const std::string& name);

/// glTF and GLB in file units and file axes. Outside buffers are looked for in `folder`; without
/// one they are refused.
[[nodiscard]] tl::expected<Scene, Error> readGltf(
    std::span<const std::byte> bytes, SceneFormat format, const std::string& name,
    const std::optional<std::filesystem::path>& folder);

/// The bytes of a file of at most `kFileBytesMost`, or why they could not be had.
[[nodiscard]] tl::expected<std::vector<std::byte>, Error> readBytes(
    const std::filesystem::path& file);

/// Larger files are refused: a scene of this size has more triangles than 32-bit indices reach.
inline constexpr std::uintmax_t kFileBytesMost = std::uintmax_t{4} << 30;

inline tl::unexpected<Error> refuse(ErrorCode code, std::string message) {
  return tl::unexpected<Error>(Error{code, std::move(message)});
}

inline tl::unexpected<Error> damaged(std::string message) {
  return refuse(ErrorCode::kDataDamaged, std::move(message));
}

}  // namespace forewalk::navmesh
