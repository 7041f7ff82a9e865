// The daemon: sessions over WebSocket, many users in one navmesh.
//
//   acceptor --> a thread of the pool, the one with the fewest connections; there for good
//                  frames of a session in order, one at a time, with no lock
//            --> loading threads, of low priority: hellos become sessions
//            --> the recorder's thread
//
// Nobody polls: threads sleep until there is something to read, or a deadline. Messages are
// described in PROTOCOL.md, limits in limits.h.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <tl/expected.hpp>

#include "navmesh/error.h"
#include "navmesh/world.h"
#include "service/daemon/access.h"
#include "service/daemon/limits.h"
#include "service/daemon/pages.h"
#include "service/daemon/state_token.h"

namespace forewalk::daemon {

struct DaemonSettings {
  Access access;  ///< port 0: any free one
  Limits limits;
  unsigned threads = 0;              ///< that run sessions; 0: one for each core
  std::string stateKey;              ///< signs state tokens; empty: a random one
  Pages pages;                       ///< the inspector; empty: "/" says that there is none
  std::filesystem::path recordings;  ///< folder; empty: nothing is recorded
  std::string scene;                 ///< its name, for recordings
  std::string fwmesh;                ///< the navmesh, for pages that draw it; empty: not served
};

struct Shared;

class Daemon {
 public:
  /// Listens, and starts its threads. Fails as validate(Access) and Recorder::make do, for a state
  /// key of fewer than kLeastKeyBytes (kSettingOutOfRange), and where the address is taken or not
  /// this machine's (kSettingOutOfRange, with the system's reason).
  [[nodiscard]] static tl::expected<std::unique_ptr<Daemon>, Error> start(
      std::shared_ptr<const navmesh::World> world, const NavMeshHash& navMesh,
      DaemonSettings settings);
  Daemon(const Daemon&) = delete;
  Daemon& operator=(const Daemon&) = delete;
  ~Daemon();  ///< as drain()

  unsigned short port() const;

  /// Lets nobody in any more (/healthz says 503), tells every session to go on elsewhere, and
  /// returns when all have gone, after limits.drainSeconds at the latest. Recordings are complete
  /// then. Once.
  void drain();

 private:
  explicit Daemon(std::unique_ptr<Shared> shared);
  std::unique_ptr<Shared> shared_;
};

}  // namespace forewalk::daemon
