// A networked crowd (agents/network.h) in processes of their own, over TCP.
//
// The server listens, and tells each client that comes who it is. Then both go in step: the server
// sends the snapshots that have arrived by this tick, and `tick`; the client answers with its
// command. Delays and losses are the session's own links, on the server's side, so that a run over
// processes is the run in one process to the last bit. Messages: crowd_wire.h.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <tl/expected.hpp>

#include "agents/network.h"
#include "navmesh/error.h"

namespace forewalk::service {

struct NetworkHost {
  std::string address = "127.0.0.1";  ///< to listen at, IPv4
  std::uint16_t port = 0;             ///< 0: any
  double patience = 20.0;             ///< for a client to come or to answer, seconds
  /// Called once it listens, with the port: to start the clients, or to say where it is. What it
  /// fails with ends the run.
  std::function<tl::expected<void, Error>(std::uint16_t port)> listening;
};

/// Serves a whole run to settings.clients clients. Fails as NetworkSession::make does, and when it
/// cannot listen, or a client does not come, leaves, is silent for too long or sends something else
/// than its command (kDataDamaged, naming the client and the tick).
[[nodiscard]] tl::expected<agents::NetworkMetrics, Error> serveNetwork(
    const agents::CrowdScene& scene, const agents::NetworkSettings& settings, double seconds,
    const NetworkHost& host = {});

/// Walks as a client of the server at address:port until that says bye. Fails when there is none,
/// or it leaves or sends something else (kDataDamaged).
[[nodiscard]] tl::expected<void, Error> joinNetwork(const std::string& address, std::uint16_t port,
                                                    double patience = 20.0);

/// The same run with its clients as `clients` processes of `program`, which is started as `program
/// network --join 127.0.0.1:PORT`. None is left behind.
[[nodiscard]] tl::expected<agents::NetworkMetrics, Error> runNetworkInProcesses(
    const agents::CrowdScene& scene, const agents::NetworkSettings& settings, double seconds,
    const std::filesystem::path& program, double patience = 20.0);

}  // namespace forewalk::service
