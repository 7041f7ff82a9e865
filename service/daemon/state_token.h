// A session's state as a signed token: what a client hands to the next daemon to go on where it
// was.
//
//   176 bytes of state (session_bytes.h) | the first 16 of HMAC-SHA256 over them
//
// (RFC 2104, section 5, allows half of it; nobody can try tokens but against a daemon.)
//
// Any daemon with the same key and the same navmesh takes it. It is not encrypted: it holds the
// client's own poses. Nobody without the key can make or change one, so its numbers are trusted as
// far as their maker; what they lead to is checked again (rdw::Session::resume).
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <tl/expected.hpp>

#include "navmesh/error.h"
#include "service/daemon/session_bytes.h"

namespace forewalk::daemon {

inline constexpr std::size_t kTokenBytes = kStateBytes + 16;  ///< 256 letters in base64url
static_assert((kTokenBytes * 4 + 2) / 3 <= 256);

inline constexpr std::size_t kLeastKeyBytes = 32;

/// Signs and checks. One thread at a time: each has its own, of the same key.
class TokenSigner {
 public:
  /// `key` has at least kLeastKeyBytes.
  TokenSigner(std::string_view key, const NavMeshHash& navMesh);
  TokenSigner(TokenSigner&&) noexcept;
  ~TokenSigner();

  /// Replaces `token` by the raw bytes of a token. Some 2 microseconds; allocates nothing once
  /// `token` has the room.
  void sign(const TokenState& state, std::string& token);

  /// The state in the raw bytes of a token. Fails (kDataDamaged) for one of the wrong length or
  /// version or that this key did not sign, compared in constant time, and (kFormatUnsupported) for
  /// another navmesh.
  [[nodiscard]] tl::expected<TokenState, Error> open(std::string_view token);

 private:
  struct Mac;
  std::unique_ptr<Mac> mac_;
  NavMeshHash navMesh_;
};

/// `count` bytes that nobody can guess.
std::string randomBytes(std::size_t count);

/// Whether two texts are equal, in a time that says nothing of where they differ, nor of how long
/// the secret is.
bool equalInConstantTime(std::string_view given, std::string_view secret);

}  // namespace forewalk::daemon
