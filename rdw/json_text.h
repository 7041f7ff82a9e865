// JSON text to values, with a line number where it is malformed.
#pragma once

#include <nlohmann/json.hpp>
#include <string_view>
#include <tl/expected.hpp>

#include "navmesh/error.h"

namespace forewalk::rdw {

/// Parses `text`; `name` stands for it in messages. Throws nothing.
///
/// Fails (kDataDamaged) where the text is not JSON, naming line and byte, or nests more than 32
/// deep (whoever walks the value may then recurse). Costs O(size).
[[nodiscard]] tl::expected<nlohmann::json, Error> parseJson(std::string_view text,
                                                            std::string_view name);

}  // namespace forewalk::rdw
