// Files on disk: bytes in, bytes out, and whatever holds a scene or a navmesh.
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <string_view>
#include <tl/expected.hpp>
#include <vector>

#include "navmesh/build/build.h"
#include "navmesh/error.h"
#include "navmesh/world.h"

namespace forewalk::service {

/// All bytes of a file. Fails when it is missing, a directory, or cannot be read (kFileUnreadable,
/// with the system's reason).
[[nodiscard]] tl::expected<std::vector<std::byte>, Error> readFile(
    const std::filesystem::path& file);

/// Writes `text` to a file, making its folders, or to stdout where `file` is "-".
/// Fails when it cannot be written (kFileUnwritable, with the system's reason).
[[nodiscard]] tl::expected<void, Error> writeFile(const std::filesystem::path& file,
                                                  std::string_view text);
[[nodiscard]] tl::expected<void, Error> writeFile(const std::filesystem::path& file,
                                                  const std::vector<std::byte>& bytes);

/// Any bytes to the same number on every machine (FNV-1a): tells files apart that changed, not
/// forgeries.
std::uint64_t contentHash(std::string_view bytes);

/// Finds out before long work whether writeFile(file) can be expected to work: makes the folders,
/// and opens the file without changing it. "-" and "" (nothing to write) are fine. Fails as
/// writeFile.
[[nodiscard]] tl::expected<void, Error> checkWritable(const std::filesystem::path& file);

/// Finds out before long work whether a folder that exists has room for so many bytes. Fails
/// (kFileUnwritable) where it has not, saying how much there is.
[[nodiscard]] tl::expected<void, Error> checkSpace(const std::filesystem::path& folder,
                                                   std::uintmax_t bytes);

/// Whether the file's ending names a navmesh that is built already: .fwmesh, or RecastDemo's .bin.
bool isBuiltNavMesh(const std::filesystem::path& file);

/// The navmesh of a SCENE, wherever a command takes one: built from .obj .off .ply .stl .gltf .glb
/// with the settings, or read as it is from .fwmesh and from RecastDemo's MSET (.bin), where the
/// settings have no effect. Fails as importScene, buildNavMesh, loadFwmesh and importMset do.
[[nodiscard]] tl::expected<navmesh::NavMesh, Error> loadNavMesh(
    const std::filesystem::path& file, const navmesh::ImportSettings& import = {},
    const navmesh::BuildSettings& build = {}, const navmesh::BuildRun& run = {});

/// A navmesh made ready for frames. Fails as makeNavGraph does.
[[nodiscard]] tl::expected<std::shared_ptr<const navmesh::World>, Error> makeWorld(
    const navmesh::NavMesh& navMesh);

/// The place of `position` in the world, for a person who typed it. Fails off the navmesh
/// (kPositionOffNavMesh), naming the nearest walkable point and how far off it is; O(polygons)
/// then.
[[nodiscard]] tl::expected<navmesh::Location, Error> placeIn(const navmesh::World& world,
                                                             glm::vec3 position,
                                                             std::string_view sceneName);

}  // namespace forewalk::service
