#include "service/daemon/daemon.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <algorithm>
#include <boost/asio/post.hpp>
#include <utility>

#include "service/daemon/connection.h"
#include "service/daemon/shared.h"
#include "service/parallel.h"

namespace forewalk::daemon {
namespace {

constexpr auto kSweepEvery = std::chrono::milliseconds(250);

tl::unexpected<Error> cannotStart(std::string message) {
  return tl::unexpected(Error{ErrorCode::kSettingOutOfRange, std::move(message)});
}

void runWorker(Worker& worker) {
  while (!worker.io.stopped()) {
    try {
      worker.io.run();
    } catch (const std::exception& failure) {
      // Whose handler it was is gone with it; the others go on.
      worker.counters.refuse(Refusal::kInternal);
      spdlog::error("a connection ends: internal: {}", failure.what());
    }
  }
}

void acceptNext(Shared& shared) {
  Worker& worker = **std::min_element(
      shared.workers.begin(), shared.workers.end(),
      [](const auto& a, const auto& b) { return a->load.load() < b->load.load(); });
  shared.acceptor->async_accept(
      worker.io, [&shared, &worker](const boost::system::error_code& failure, Socket socket) {
        if (failure == asio::error::operation_aborted) return;
        if (failure) {
          // Out of descriptors, most likely: not at once again, or this thread would do nothing
          // else.
          spdlog::error("a connection could not be accepted: {}", failure.message());
          auto wait = std::make_shared<asio::steady_timer>(shared.workers.front()->io,
                                                           std::chrono::milliseconds(100));
          wait->async_wait([&shared, wait](const boost::system::error_code& ended) {
            if (!ended) acceptNext(shared);
          });
          return;
        }
        ++worker.load;
        ++shared.connections;
        asio::post(worker.io, [&shared, &worker, socket = std::move(socket)]() mutable {
          std::make_shared<Connection>(shared, worker, std::move(socket))->start();
          startSweeping(worker);
        });
        acceptNext(shared);
      });
}

// A connection may end while it is visited, and others with it never do: visit a copy.
template <typename Visit>
void forEachConnection(Worker& worker, const Visit& visit) {
  std::vector<std::shared_ptr<Connection>> all;
  all.reserve(worker.connections.size());
  for (Connection* connection : worker.connections) {
    if (auto alive = connection->weak_from_this().lock()) all.push_back(std::move(alive));
  }
  for (const auto& connection : all) visit(*connection);
}

tl::expected<Tcp::endpoint, Error> listen(Shared& shared) {
  const Access& access = shared.settings.access;
  boost::system::error_code failure;
  const Tcp::endpoint endpoint(asio::ip::make_address(access.address), access.port);
  Tcp::acceptor& acceptor = shared.acceptor.emplace(shared.workers.front()->io);
  acceptor.open(endpoint.protocol(), failure);
  if (!failure) acceptor.set_option(Tcp::acceptor::reuse_address(true), failure);
  if (!failure) acceptor.bind(endpoint, failure);
  if (!failure) acceptor.listen(asio::socket_base::max_listen_connections, failure);
  if (failure) {
    return cannotStart(
        fmt::format("--listen {} --port {}: {}. Give another one, or port 0 for any.",
                    access.address, access.port, failure.message()));
  }
  return acceptor.local_endpoint();
}

}  // namespace

bool Shared::enterSession() {
  const std::lock_guard lock(sessionsMutex_);
  if (sessions_ >= settings.limits.sessions) return false;
  ++sessions_;
  return true;
}

void Shared::leaveSession() {
  {
    const std::lock_guard lock(sessionsMutex_);
    --sessions_;
  }
  sessionsLeft_.notify_all();
}

bool Shared::waitForSessions(double seconds) {
  std::unique_lock lock(sessionsMutex_);
  return sessionsLeft_.wait_for(lock, std::chrono::duration<double>(seconds),
                                [this] { return sessions_ == 0; });
}

std::shared_ptr<const prediction::FrontIndex> Shared::frontIndex() {
  std::call_once(frontOnce_, [this] { frontIndex_ = rdw::makeFrontIndex(*world); });
  return frontIndex_;
}

void startSweeping(Worker& worker) {
  if (worker.sweeping || worker.connections.empty()) return;
  worker.sweeping = true;
  worker.sweepTimer.expires_after(kSweepEvery);
  worker.sweepTimer.async_wait([&worker](const boost::system::error_code& failure) {
    worker.sweeping = false;
    if (failure) return;
    const Clock::time_point now = Clock::now();
    forEachConnection(worker, [now](Connection& connection) { connection.sweep(now); });
    startSweeping(worker);
  });
}

void startRecording(Worker& worker) {
  if (worker.recording || worker.connections.empty()) return;
  worker.recording = true;
  worker.recordTimer.expires_after(std::chrono::duration_cast<Clock::duration>(
      std::chrono::duration<double>(kRecordEverySeconds)));
  worker.recordTimer.async_wait([&worker](const boost::system::error_code& failure) {
    worker.recording = false;
    if (failure) return;
    for (Connection* connection : worker.connections) connection->flushRecording();
    startRecording(worker);
  });
}

tl::expected<std::unique_ptr<Daemon>, Error> Daemon::start(
    std::shared_ptr<const navmesh::World> world, const NavMeshHash& navMesh,
    DaemonSettings settings) {
  if (auto sound = validate(settings.access); !sound) return tl::unexpected(sound.error());
  if (settings.stateKey.empty()) settings.stateKey = randomBytes(kLeastKeyBytes);
  if (settings.stateKey.size() < kLeastKeyBytes) {
    return cannotStart(
        fmt::format("state key: {} bytes; give at least {}, for example from: openssl "
                    "rand -hex 32",
                    settings.stateKey.size(), kLeastKeyBytes));
  }
  auto shared = std::make_unique<Shared>();
  shared->settings = std::move(settings);
  shared->world = std::move(world);
  shared->navMesh = navMesh;
  shared->navMeshText = textOf(navMesh);
  if (!shared->settings.recordings.empty()) {
    auto recorder = Recorder::make(shared->settings.recordings);
    if (!recorder) return tl::unexpected(std::move(recorder.error()));
    shared->recorder = std::move(*recorder);
  }
  const unsigned threads =
      shared->settings.threads > 0 ? shared->settings.threads : service::coreCount();
  for (unsigned i = 0; i < threads; ++i) {
    shared->workers.push_back(std::make_unique<Worker>(shared->settings.stateKey, navMesh));
  }
  const auto endpoint = listen(*shared);
  if (!endpoint) return tl::unexpected(endpoint.error());
  shared->port = endpoint->port();
  shared->loading = std::make_unique<asio::thread_pool>(threads);
  acceptNext(*shared);
  for (const auto& worker : shared->workers) {
    worker->thread = std::thread([&worker = *worker] { runWorker(worker); });
  }
  spdlog::info("listening on {} port {}, navmesh {}, {} threads", shared->settings.access.address,
               shared->port, shared->navMeshText, threads);
  return std::unique_ptr<Daemon>(new Daemon(std::move(shared)));
}

Daemon::Daemon(std::unique_ptr<Shared> shared) : shared_(std::move(shared)) {}

Daemon::~Daemon() { drain(); }

unsigned short Daemon::port() const { return shared_->port; }

void Daemon::drain() {
  if (shared_->draining.exchange(true)) return;
  spdlog::info("draining: sessions have {:g} s to go on elsewhere",
               shared_->settings.limits.drainSeconds);
  for (const auto& worker : shared_->workers) {
    asio::post(worker->io, [&worker = *worker] {
      forEachConnection(worker, [](Connection& connection) { connection.drain(); });
    });
  }
  const bool all = shared_->waitForSessions(shared_->settings.limits.drainSeconds);
  for (const auto& worker : shared_->workers) worker->io.stop();
  for (const auto& worker : shared_->workers) worker->thread.join();
  // Hellos that wait own their connections, as the handlers of the workers do; connections hand
  // over their last frames when they end.
  shared_->loading->stop();
  shared_->loading->join();
  shared_->loading.reset();
  shared_->acceptor.reset();
  shared_->workers.clear();
  shared_->recorder.reset();
  spdlog::info("ended{}", all ? "" : ", with sessions still open");
}

}  // namespace forewalk::daemon
