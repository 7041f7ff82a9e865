// The messages of a networked crowd (agents/network.h) as bytes.
//
// A frame is a length and a payload; a payload is a kind and its fields. Numbers are little-endian,
// floats their IEEE bits, so what arrives is what was sent to the last bit:
//
//   u32 length of the payload, 1 to 4 MiB
//   u8  kind
//   welcome 1   u32 "fwn1", u32 client, f32 seconds, u8 flags (1 velocity bias, 2 dead reckoning),
//               u32 n, n members, u32 n, n walls
//   snapshot 2  u64 tick, u64 answered, u32 n, n states, u32 n, n ways
//   tick 3      nothing: no more snapshots have arrived, walk on
//   command 4   u64 number, u32 n, n motions
//   bye 5       nothing: the run is over
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <tl/expected.hpp>
#include <variant>
#include <vector>

#include "agents/network.h"
#include "navmesh/error.h"

namespace forewalk::service {

struct NetworkTick {
  bool operator==(const NetworkTick&) const = default;
};
struct NetworkBye {
  bool operator==(const NetworkBye&) const = default;
};

using NetworkMessage = std::variant<agents::NetworkWelcome, agents::NetworkSnapshot, NetworkTick,
                                    agents::NetworkCommand, NetworkBye>;

inline constexpr std::uint32_t kLongestMessage = 4u << 20;  ///< bytes of payload

/// Replaces `bytes` with the frame of `message`, length included.
void encode(const NetworkMessage& message, std::vector<std::byte>& bytes);

/// The message of a payload (without its length). Fails when it is of an unknown kind, ends early
/// or late, counts more than it holds, or a number is not finite (kDataDamaged), or a welcome
/// speaks another version (kFormatUnsupported). Costs and allocates no more than O(size).
[[nodiscard]] tl::expected<NetworkMessage, Error> decode(std::span<const std::byte> payload);

/// The length of the payload that follows these four bytes. Fails when it is 0 or beyond
/// kLongestMessage (kDataDamaged).
[[nodiscard]] tl::expected<std::uint32_t, Error> payloadLength(std::span<const std::byte, 4> bytes);

}  // namespace forewalk::service
