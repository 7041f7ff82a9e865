// What the daemon's threads and connections share. For service/daemon alone.
#pragma once

#include <atomic>
#include <boost/asio/executor_work_guard.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/thread_pool.hpp>
#include <chrono>
#include <condition_variable>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <unordered_set>
#include <vector>

#include "prediction/front_graph.h"
#include "service/daemon/daemon.h"
#include "service/daemon/metrics.h"
#include "service/daemon/recorder.h"

namespace forewalk::daemon {

namespace asio = boost::asio;
using Tcp = asio::ip::tcp;
using Clock = std::chrono::steady_clock;
using Socket = asio::basic_stream_socket<Tcp, asio::io_context::executor_type>;

class Connection;

/// A thread of the pool with all that only it touches.
struct Worker {
  Worker(const std::string& key, const NavMeshHash& navMesh) : signer(key, navMesh) {}

  // For all threads.
  Counters counters;
  std::atomic<unsigned> load{0};  ///< connections

  TokenSigner signer;
  std::unordered_set<Connection*> connections;  ///< order of no consequence: each for itself
  bool sweeping = false, recording = false;     ///< the timers run only while they are needed

  // Ends before what is above, and its handlers, which own the connections, with it.
  asio::io_context io{1};
  asio::executor_work_guard<asio::io_context::executor_type> work{io.get_executor()};
  asio::steady_timer sweepTimer{io}, recordTimer{io};
  std::thread thread;
};

struct Shared {
  DaemonSettings settings;
  std::shared_ptr<const navmesh::World> world;
  NavMeshHash navMesh;
  std::string navMeshText;
  unsigned short port = 0;
  std::unique_ptr<Recorder> recorder;  ///< null: nothing is recorded
  std::vector<std::unique_ptr<Worker>> workers;
  std::unique_ptr<asio::thread_pool> loading;
  std::optional<Tcp::acceptor> acceptor;  ///< of the first worker
  std::atomic<bool> draining{false};
  std::atomic<unsigned> connections{0};

  /// A place for one more session, to be left again; false where the limit is reached.
  bool enterSession();
  void leaveSession();
  /// True when all have left in this time.
  bool waitForSessions(double seconds);

  /// Made where the first session by fronts asks; any thread.
  std::shared_ptr<const prediction::FrontIndex> frontIndex();

 private:
  std::mutex sessionsMutex_;
  std::condition_variable sessionsLeft_;
  unsigned sessions_ = 0;
  std::once_flag frontOnce_;
  std::shared_ptr<const prediction::FrontIndex> frontIndex_;
};

/// The worker's regular rounds, while it has connections, or recordings.
void startSweeping(Worker& worker);
void startRecording(Worker& worker);

}  // namespace forewalk::daemon
