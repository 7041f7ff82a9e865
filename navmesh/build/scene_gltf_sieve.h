// What a glTF file passes before tinygltf reads it.
//
// tinygltf neither checks that accessors lie in their buffers nor which extensions a file requires,
// cuts long integers short, and opens whatever files a URI names. So the JSON passes a sieve first:
// it refuses what we do not read, by name, and hands on only what a scene needs (nodes, triangles,
// positions, indices and the bytes they lie in). Images, materials, skins and animations never
// reach tinygltf.
#pragma once

#include <cstddef>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <tl/expected.hpp>
#include <vector>

#include "navmesh/error.h"

namespace forewalk::navmesh {

/// What tinygltf is given.
struct PlainGltf {
  nlohmann::json json = nlohmann::json::object();
  std::string_view bin;  ///< of the .glb, in the caller's bytes
  /// Buffer files, already read. In the JSON, `outsideUri(i)` stands for the i-th.
  std::vector<std::vector<std::byte>> outside;
};

std::string outsideUri(std::size_t i);

/// Copies what a scene needs of a file's JSON. Every index is in range, every number of its kind;
/// that accessors lie in their buffers is still to be checked.
///
/// Buffer files are looked for in `folder`; without one they are refused. Fails (kDataDamaged,
/// kFormatUnsupported, or what reading a buffer gave) with the element and the value.
[[nodiscard]] tl::expected<PlainGltf, Error> sieveGltf(
    const nlohmann::json& file, std::string_view bin, const std::string& name,
    const std::optional<std::filesystem::path>& folder);

}  // namespace forewalk::navmesh
