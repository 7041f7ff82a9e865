// Scene geometry: triangles as authored, in virtual space, and the files they come from.
//
// OBJ, OFF, PLY and STL are read by OpenMesh, glTF 2.0 by tinygltf; what those readers let pass
// (NaN, wild indices, files that end early, required extensions) is checked here.
#pragma once

#include <cstddef>
#include <filesystem>
#include <glm/glm.hpp>
#include <span>
#include <string>
#include <tl/expected.hpp>
#include <vector>

#include "navmesh/error.h"

namespace forewalk::navmesh {

/// Triangles in world axes (right-handed, +Y up), metres. Counter-clockwise seen from outside.
struct Scene {
  std::string name;  ///< where it came from, for messages
  std::vector<glm::vec3> vertices;
  std::vector<glm::uvec3> triangles;  ///< indices into `vertices`
};

enum class UpAxis { kY, kZ };

enum class SceneFormat { kObj, kOff, kPly, kStl, kGltf, kGlb };

struct ImportSettings {
  float metresPerUnit = 1.0f;  ///< > 0; what one unit of the file is
  UpAxis up = UpAxis::kY;      ///< kZ: the file's (x, y, z) becomes (x, z, -y)

  bool operator==(const ImportSettings&) const = default;
};

/// Reads a scene; the format follows from the file's ending (.obj .off .ply .stl .gltf .glb, any
/// case).
///
/// Fails when the file cannot be read, the ending is none of these, a glTF requires an extension we
/// do not read (named), a coordinate is NaN or infinite, an index is out of range, the file ends
/// early, or there is no triangle. Messages carry file, line or element, and value. Files over 4
/// GiB and faces of more than 4096 corners are kTooLarge. Costs O(size). Several threads may import
/// at once.
///
/// A scene is a soup: every face is kept, however many share an edge. Faces of more than three
/// corners become triangles, concave ones by cutting ears; STL's equal corners become one vertex,
/// and OBJ and STL faces that come down to a line are left out. Colours, normals, textures, points
/// and lines are ignored. Of glTF the default scene is read, else the first, else all roots; nodes
/// that mirror keep their outside outside; skins and morph targets are ignored; sparse accessors
/// and quantized positions are refused by name, as is every required extension that is not only
/// about looks. Its buffers are read from the file's own folder and nowhere else.
[[nodiscard]] tl::expected<Scene, Error> importScene(const std::filesystem::path& file,
                                                     const ImportSettings& settings = {});

/// The same from bytes in memory; `name` stands for the file in messages. A .gltf that names
/// outside buffers needs the file form above (kFormatUnsupported here).
[[nodiscard]] tl::expected<Scene, Error> importScene(std::span<const std::byte> bytes,
                                                     SceneFormat format, const std::string& name,
                                                     const ImportSettings& settings = {});

/// Whether a scene that somebody filled in themselves could have come from a file: it has
/// triangles, every vertex is finite, and triangles name vertices that are there. O(size).
[[nodiscard]] tl::expected<void, Error> validate(const Scene& scene);

/// The format that a file's ending names, or kFormatUnknown.
[[nodiscard]] tl::expected<SceneFormat, Error> sceneFormatOf(const std::filesystem::path& file);

/// Makes a scene of arrays an engine has in memory, with the same checks and settings.
[[nodiscard]] tl::expected<Scene, Error> makeScene(std::string name,
                                                   std::span<const glm::vec3> vertices,
                                                   std::span<const std::uint32_t> triangleIndices,
                                                   const ImportSettings& settings = {});

}  // namespace forewalk::navmesh
