// What a client of the daemon may take: each limit with its default, and the name that its error
// has.
//
// A client that goes past one is told so ({"format": "forewalk.error/1", "code": "limit.…"}, or an
// HTTP answer that says it) and let go; nobody else notices.
#pragma once

#include <cstddef>

namespace forewalk::daemon {

struct Limits {
  std::size_t messageBytes = 65536;  ///< `limit.message_bytes`: of one WebSocket message
  double messagesPerSecond = 250.0;  ///< `limit.messages_per_second`: a second's worth at once,
                                     ///< then so many
  unsigned sessions = 256;           ///< `limit.sessions`: at one time
  unsigned spareConnections = 64;    ///< `limit.connections`: at one time, beyond the sessions
  double idleSeconds = 30.0;         ///< `limit.idle_seconds`: without a frame
  double handshakeSeconds = 5.0;     ///< `limit.handshake_seconds`: from connecting to the whole
                                     ///< request, and from there to the whole hello
  double sendSeconds = 5.0;          ///< `limit.send_seconds`: for a client to take an answer
  double drainSeconds = 5.0;         ///< after SIGTERM: for sessions to close
};

inline constexpr std::size_t kRequestBytes = 8192;  ///< of an HTTP request, headers and all

}  // namespace forewalk::daemon
