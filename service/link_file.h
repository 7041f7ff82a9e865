// Links (lifts, ladders, teleports) from files.
#pragma once

#include <filesystem>
#include <string_view>
#include <tl/expected.hpp>
#include <vector>

#include "navmesh/links.h"

namespace forewalk::service {

/// Reads JSON of schema `forewalk.links/1`:
///
///   { "format": "forewalk.links/1",
///     "links": [ {"id": 1, "entry": [x, y, z], "exit": [x, y, z], "length": 4.0,
///                 "both_ways": true, "open": true} ] }
///
/// World space, metres. "both_ways" and "open" may be left out (false, true), and "name" may stand
/// beside them for people to read. `name` stands for the file in messages.
///
/// Fails when the text is not JSON or its values are not of these kinds, when it has another field
/// or more than 100,000 links (kDataDamaged, kTooLarge), when it is of another format
/// (kFormatUnsupported), and as navmesh::validate(Link) does. Whether the ends lie on ground is
/// found where links are put on a graph.
[[nodiscard]] tl::expected<std::vector<navmesh::Link>, Error> parseLinks(std::string_view text,
                                                                         std::string_view name);

/// The same from a file.
[[nodiscard]] tl::expected<std::vector<navmesh::Link>, Error> readLinks(
    const std::filesystem::path& file);

}  // namespace forewalk::service
