#include "navmesh/build/scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <fstream>
#include <limits>
#include <system_error>

#include "navmesh/build/scene_readers.h"

namespace forewalk::navmesh {
namespace {

tl::expected<void, Error> checkSettings(const ImportSettings& settings, const std::string& name) {
  if (!std::isfinite(settings.metresPerUnit) || settings.metresPerUnit <= 0.0f) {
    return refuse(ErrorCode::kSettingOutOfRange,
                  fmt::format("{}: metresPerUnit is {}, it must be finite and above 0. Use 1 for "
                              "metres, 0.01 for centimetres.",
                              name, settings.metresPerUnit));
  }
  return {};
}

/// From file units and axes to ours, in place; then the last checks, which hold for every format.
tl::expected<Scene, Error> finish(Scene scene, const ImportSettings& settings) {
  for (std::size_t i = 0; i < scene.vertices.size(); ++i) {
    const glm::vec3 read = scene.vertices[i];
    const glm::vec3 up = settings.up == UpAxis::kZ ? glm::vec3(read.x, read.z, -read.y) : read;
    const glm::vec3 metres = up * settings.metresPerUnit;
    if (!std::isfinite(metres.x) || !std::isfinite(metres.y) || !std::isfinite(metres.z)) {
      return refuse(
          ErrorCode::kDataDamaged,
          fmt::format("{}: vertex {} at ({}, {}, {}) is not finite at {} m per unit. Export "
                      "it again or remove the vertex.",
                      scene.name, i, read.x, read.y, read.z, settings.metresPerUnit));
    }
    scene.vertices[i] = metres;
  }
  if (auto sound = validate(scene); !sound) return tl::unexpected(sound.error());
  return scene;
}

tl::expected<Scene, Error> importBytes(std::span<const std::byte> bytes, SceneFormat format,
                                       const std::string& name, const ImportSettings& settings,
                                       const std::optional<std::filesystem::path>& folder) {
  if (auto sound = checkSettings(settings, name); !sound) return tl::unexpected(sound.error());
  if (bytes.empty()) {
    return refuse(ErrorCode::kSceneEmpty, fmt::format("{}: 0 bytes. Export it again.", name));
  }
  const bool gltf = format == SceneFormat::kGltf || format == SceneFormat::kGlb;
  auto scene = gltf ? readGltf(bytes, format, name, folder) : readMeshFile(bytes, format, name);
  if (!scene) return scene;
  return finish(std::move(*scene), settings);
}

}  // namespace

tl::expected<void, Error> validate(const Scene& scene) {
  for (std::size_t i = 0; i < scene.vertices.size(); ++i) {
    const glm::vec3& vertex = scene.vertices[i];
    if (!std::isfinite(vertex.x) || !std::isfinite(vertex.y) || !std::isfinite(vertex.z)) {
      return damaged(fmt::format("{}: vertex {} is ({}, {}, {}), not a place. Remove it.",
                                 scene.name, i, vertex.x, vertex.y, vertex.z));
    }
  }
  for (std::size_t i = 0; i < scene.triangles.size(); ++i) {
    const glm::uvec3 corners = scene.triangles[i];
    const std::uint32_t highest = std::max({corners.x, corners.y, corners.z});
    if (highest >= scene.vertices.size()) {
      return refuse(ErrorCode::kDataDamaged,
                    fmt::format("{}: triangle {} names vertex {} (from 0), there are {}. Export it "
                                "again or remove the triangle.",
                                scene.name, i, highest, scene.vertices.size()));
    }
  }
  if (scene.triangles.empty()) {
    return refuse(ErrorCode::kSceneEmpty,
                  fmt::format("{}: no triangle among its {} vertices. Export the meshes as faces, "
                              "not as points or lines.",
                              scene.name, scene.vertices.size()));
  }
  return {};
}

tl::expected<std::vector<std::byte>, Error> readBytes(const std::filesystem::path& file) {
  const std::string name = file.string();
  std::error_code failure;
  const bool regular = std::filesystem::is_regular_file(file, failure);
  if (failure || !regular) {
    return refuse(ErrorCode::kFileUnreadable,
                  fmt::format("{}: {}. Check the path.", name,
                              failure ? failure.message() : "not a regular file"));
  }
  const std::uintmax_t size = std::filesystem::file_size(file, failure);
  if (failure) {
    return refuse(ErrorCode::kFileUnreadable,
                  fmt::format("{}: {}. Check the path.", name, failure.message()));
  }
  if (size > kFileBytesMost) {
    return refuse(ErrorCode::kTooLarge,
                  fmt::format("{}: {} bytes, at most {} are read. Split the scene or leave out "
                              "what nobody walks on.",
                              name, size, kFileBytesMost));
  }
  std::ifstream in(file, std::ios::binary);
  if (!in) {
    return refuse(ErrorCode::kFileUnreadable,
                  fmt::format("{}: {}. Check its permissions.", name, std::strerror(errno)));
  }
  std::vector<std::byte> bytes(static_cast<std::size_t>(size));
  in.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(size));
  if (static_cast<std::uintmax_t>(in.gcount()) != size) {
    return refuse(ErrorCode::kFileUnreadable,
                  fmt::format("{}: reading stopped after {} of {} bytes. Try again.", name,
                              in.gcount(), size));
  }
  return bytes;
}

tl::expected<SceneFormat, Error> sceneFormatOf(const std::filesystem::path& file) {
  std::string ending = file.extension().string();
  // Not std::tolower: it follows the locale.
  for (char& c : ending) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  if (ending == ".obj") return SceneFormat::kObj;
  if (ending == ".off") return SceneFormat::kOff;
  if (ending == ".ply") return SceneFormat::kPly;
  if (ending == ".stl") return SceneFormat::kStl;
  if (ending == ".gltf") return SceneFormat::kGltf;
  if (ending == ".glb") return SceneFormat::kGlb;
  return refuse(ErrorCode::kFormatUnknown,
                fmt::format("{}: the ending {} names no scene format. Use .obj, .off, .ply, .stl, "
                            ".gltf or .glb.",
                            file.string(), inQuotes(file.extension().string())));
}

tl::expected<Scene, Error> importScene(const std::filesystem::path& file,
                                       const ImportSettings& settings) {
  const auto format = sceneFormatOf(file);
  if (!format) return tl::unexpected(format.error());
  const auto bytes = readBytes(file);
  if (!bytes) return tl::unexpected(bytes.error());
  return importBytes(*bytes, *format, file.string(), settings, file.parent_path());
}

tl::expected<Scene, Error> importScene(std::span<const std::byte> bytes, SceneFormat format,
                                       const std::string& name, const ImportSettings& settings) {
  return importBytes(bytes, format, name, settings, std::nullopt);
}

tl::expected<Scene, Error> makeScene(std::string name, std::span<const glm::vec3> vertices,
                                     std::span<const std::uint32_t> triangleIndices,
                                     const ImportSettings& settings) {
  if (auto sound = checkSettings(settings, name); !sound) return tl::unexpected(sound.error());
  if (triangleIndices.size() % 3 != 0) {
    return refuse(ErrorCode::kDataDamaged,
                  fmt::format("{}: {} triangle indices, that is no multiple of 3. Pass whole "
                              "triangles.",
                              name, triangleIndices.size()));
  }
  if (vertices.size() > std::numeric_limits<std::uint32_t>::max()) {
    return refuse(ErrorCode::kTooLarge,
                  fmt::format("{}: {} vertices, 32-bit indices reach {}. Split the scene.", name,
                              vertices.size(), std::numeric_limits<std::uint32_t>::max()));
  }
  Scene scene;
  scene.name = std::move(name);
  scene.vertices.assign(vertices.begin(), vertices.end());
  scene.triangles.reserve(triangleIndices.size() / 3);
  for (std::size_t i = 0; i < triangleIndices.size(); i += 3) {
    scene.triangles.emplace_back(triangleIndices[i], triangleIndices[i + 1],
                                 triangleIndices[i + 2]);
  }
  return finish(std::move(scene), settings);
}

}  // namespace forewalk::navmesh
