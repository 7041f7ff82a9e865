// `.fwmesh`: a built navmesh in a file.
//
// Versioned, checksummed, little-endian whatever the machine. A damaged file is refused and never
// read past its end. The same navmesh gives the same bytes.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <tl/expected.hpp>
#include <vector>

#include "navmesh/build/navmesh.h"

namespace forewalk::navmesh {

/// The file's bytes. Layout in navmesh/build/README.md. `navMesh` must be valid. O(size).
std::vector<std::byte> saveFwmesh(const NavMesh& navMesh);

/// Fails when the bytes are no .fwmesh (kFormatUnknown), of a newer version (kFormatUnsupported),
/// or end early, differ from their checksum or break a promise of NavMesh (kDataDamaged, with the
/// byte or the polygon). `name` stands for the file in messages. What it returns has passed
/// validate().
///
/// O(n log n) of the size; allocates in proportion to the bytes given, whatever counts they claim.
[[nodiscard]] tl::expected<NavMesh, Error> loadFwmesh(std::span<const std::byte> bytes,
                                                      const std::string& name);

}  // namespace forewalk::navmesh
