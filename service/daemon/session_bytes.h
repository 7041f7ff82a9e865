// A session's state as bytes: what recordings begin with, and tokens sign.
//
// 176 bytes, little-endian: version, navmesh, session, the map (yaw, offset, height), the last head
// pose, the motion's low-pass, the place on the navmesh, and the reset under way with its plan.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <tl/expected.hpp>

#include "navmesh/build/navmesh.h"
#include "navmesh/error.h"
#include "rdw/session.h"

namespace forewalk::daemon {

/// FNV-1a of a navmesh's .fwmesh: says whether two daemons walk the same ground. Not against
/// somebody who wants two to look alike.
using NavMeshHash = std::array<std::uint8_t, 8>;
NavMeshHash hashOf(std::span<const std::byte> fwmesh);
NavMeshHash hashOf(const navmesh::NavMesh& navMesh);
std::string textOf(const NavMeshHash& hash);  ///< 16 hexadecimal digits

/// Whose state it is, beside the state.
struct TokenState {
  std::uint64_t sessionId = 0;
  rdw::SessionState state;
};

inline constexpr std::size_t kStateBytes = 176;

std::string stateBytes(const TokenState& state, const NavMeshHash& navMesh);

/// The same in the place of `bytes`, which keeps its memory.
void putStateBytes(const TokenState& state, const NavMeshHash& navMesh, std::string& bytes);

/// Fails (kDataDamaged) for another length and (kFormatUnsupported) for another version or navmesh.
[[nodiscard]] tl::expected<TokenState, Error> stateFromBytes(std::string_view bytes,
                                                             const NavMeshHash& navMesh);

}  // namespace forewalk::daemon
