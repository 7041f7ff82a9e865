// The container of a .glb: a chunk of JSON, and one of the bytes its buffer 0 stands for.
#pragma once

#include <string>
#include <string_view>
#include <tl/expected.hpp>

#include "navmesh/error.h"

namespace forewalk::navmesh {

/// Views into the file's bytes.
struct GlbChunks {
  std::string_view json;
  std::string_view bin;  ///< empty where there is none
};

/// Fails when the file is no .glb (kFormatUnknown), of another version than 2 (kFormatUnsupported),
/// or ends early or begins with another chunk than JSON (kDataDamaged).
[[nodiscard]] tl::expected<GlbChunks, Error> splitGlb(std::string_view bytes,
                                                      const std::string& name);

/// A .glb of these. Fails (kTooLarge) where it would have 4 GiB or more, which its header cannot
/// say.
[[nodiscard]] tl::expected<std::string, Error> joinGlb(std::string json, std::string_view bin,
                                                       const std::string& name);

}  // namespace forewalk::navmesh
