// A tracked space from JSON that is part of a larger file. For rdw alone: not installed.
#pragma once

#include <nlohmann/json.hpp>
#include <tl/expected.hpp>

#include "rdw/tracked_space.h"

namespace forewalk::rdw {

/// The space that `json` describes, an object as in TrackedSpace::fromJson, whose "format" may be
/// missing. Fails as there.
[[nodiscard]] tl::expected<TrackedSpace, Error> spaceFromJson(const nlohmann::json& json);

}  // namespace forewalk::rdw
