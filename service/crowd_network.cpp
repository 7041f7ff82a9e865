#include "service/crowd_network.h"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <utility>
#include <vector>

#include "service/crowd_wire.h"

extern char** environ;

namespace forewalk::service {
namespace {

using agents::NetworkCommand;
using agents::NetworkSnapshot;
using agents::NetworkWelcome;

tl::unexpected<Error> broken(std::string sentence) {
  return tl::unexpected(Error{ErrorCode::kDataDamaged, std::move(sentence)});
}

/// A socket that closes itself.
class Socket {
 public:
  explicit Socket(int handle = -1) : handle_(handle) {}
  Socket(Socket&& other) noexcept : handle_(std::exchange(other.handle_, -1)) {}
  Socket& operator=(Socket&& other) noexcept {
    std::swap(handle_, other.handle_);
    return *this;
  }
  ~Socket() {
    if (handle_ >= 0) close(handle_);
  }
  int handle() const { return handle_; }
  explicit operator bool() const { return handle_ >= 0; }

 private:
  int handle_;
};

/// Whole messages over a connected socket. Buffers are kept from message to message.
class Connection {
 public:
  Connection(Socket socket, double patience) : socket_(std::move(socket)), patience_(patience) {
    const int on = 1;
    setsockopt(socket_.handle(), IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
  }

  tl::expected<void, Error> send(const NetworkMessage& message) {
    encode(message, bytes_);
    if (bytes_.size() > std::size_t{kLongestMessage} + 4) {
      return broken(fmt::format("a message of {} bytes is longer than the {} that are allowed",
                                bytes_.size() - 4, kLongestMessage));
    }
    for (std::size_t sent = 0; sent < bytes_.size();) {
      if (!ready(POLLOUT)) return broken(fmt::format("no answer for {} s", patience_));
      const ssize_t n = ::send(socket_.handle(), bytes_.data() + sent, bytes_.size() - sent,
                               MSG_NOSIGNAL | MSG_DONTWAIT);
      if (n < 0 && (errno == EINTR || errno == EAGAIN || errno == EWOULDBLOCK)) continue;
      if (n <= 0) return broken(fmt::format("the connection broke ({})", std::strerror(errno)));
      sent += static_cast<std::size_t>(n);
    }
    return {};
  }

  tl::expected<NetworkMessage, Error> receive() {
    std::byte head[4];
    if (auto got = fill(head); !got) return tl::unexpected(std::move(got.error()));
    const auto length = payloadLength(head);
    if (!length) return tl::unexpected(length.error());
    bytes_.resize(*length);
    if (auto got = fill(bytes_); !got) return tl::unexpected(std::move(got.error()));
    return decode(bytes_);
  }

 private:
  bool ready(short what) const {
    pollfd wait{socket_.handle(), what, 0};
    int n = 0;
    do {
      n = poll(&wait, 1, static_cast<int>(1000.0 * patience_));
    } while (n < 0 && errno == EINTR);
    return n > 0;
  }
  tl::expected<void, Error> fill(std::span<std::byte> room) {
    for (std::size_t got = 0; got < room.size();) {
      if (!ready(POLLIN)) return broken(fmt::format("nothing came for {} s", patience_));
      const ssize_t n = recv(socket_.handle(), room.data() + got, room.size() - got, MSG_DONTWAIT);
      if (n < 0 && (errno == EINTR || errno == EAGAIN || errno == EWOULDBLOCK)) continue;
      if (n == 0) return broken("it left");
      if (n < 0) return broken(fmt::format("the connection broke ({})", std::strerror(errno)));
      got += static_cast<std::size_t>(n);
    }
    return {};
  }

  Socket socket_;
  double patience_;
  std::vector<std::byte> bytes_;
};

tl::expected<sockaddr_in, Error> addressOf(const std::string& address, std::uint16_t port) {
  sockaddr_in at{};
  at.sin_family = AF_INET;
  at.sin_port = htons(port);
  if (inet_pton(AF_INET, address.c_str(), &at.sin_addr) == 1) return at;
  return tl::unexpected(
      Error{ErrorCode::kSettingOutOfRange,
            fmt::format("\"{}\" is no IPv4 address. Give one like 127.0.0.1.", address)});
}

struct Listener {
  Socket socket;
  std::uint16_t port;
};

tl::expected<Listener, Error> listenAt(const NetworkHost& host, int clients) {
  auto at = addressOf(host.address, host.port);
  if (!at) return tl::unexpected(std::move(at.error()));
  Socket socket(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0));
  const int on = 1;
  setsockopt(socket.handle(), SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
  socklen_t size = sizeof(sockaddr_in);
  auto* generic = reinterpret_cast<sockaddr*>(&*at);
  if (!socket || bind(socket.handle(), generic, size) != 0 ||
      listen(socket.handle(), clients) != 0 || getsockname(socket.handle(), generic, &size) != 0) {
    return broken(fmt::format("cannot listen at {}:{} ({}). Try another port.", host.address,
                              host.port, std::strerror(errno)));
  }
  return Listener{std::move(socket), ntohs(at->sin_port)};
}

Error ofClient(std::uint32_t client, std::uint64_t tick, const Error& error) {
  return {error.code, fmt::format("crowd client {} at tick {}: {}.", client, tick, error.message)};
}

}  // namespace

tl::expected<agents::NetworkMetrics, Error> serveNetwork(const agents::CrowdScene& scene,
                                                         const agents::NetworkSettings& settings,
                                                         double seconds, const NetworkHost& host) {
  auto session = agents::NetworkSession::make(scene, settings, seconds);
  if (!session) return tl::unexpected(std::move(session.error()));
  auto listener = listenAt(host, static_cast<int>(settings.clients));
  if (!listener) return tl::unexpected(std::move(listener.error()));
  if (host.listening) {
    if (auto begun = host.listening(listener->port); !begun) {
      return tl::unexpected(std::move(begun.error()));
    }
  }
  std::vector<Connection> clients;
  for (std::uint32_t c = 0; c < settings.clients; ++c) {
    pollfd wait{listener->socket.handle(), POLLIN, 0};
    const int n = poll(&wait, 1, static_cast<int>(1000.0 * host.patience));
    Socket come(n > 0 ? accept4(listener->socket.handle(), nullptr, nullptr, SOCK_CLOEXEC) : -1);
    if (!come) {
      return broken(fmt::format("{} of {} crowd clients came to {}:{} within {} s.", c,
                                settings.clients, host.address, listener->port, host.patience));
    }
    clients.emplace_back(std::move(come), host.patience);
    if (auto sent = clients.back().send(session->welcome(c)); !sent) {
      return tl::unexpected(ofClient(c, 0, sent.error()));
    }
  }
  while (!session->done()) {
    session->stepServer();
    const std::uint64_t tick = session->server().tick();
    // All are told before any is waited for: they plan at the same time.
    for (std::uint32_t c = 0; c < settings.clients; ++c) {
      tl::expected<void, Error> sent;
      session->due(c, [&](const NetworkSnapshot& snapshot) {
        if (sent) sent = clients[c].send(snapshot);
      });
      if (sent) sent = clients[c].send(NetworkTick{});
      if (!sent) return tl::unexpected(ofClient(c, tick, sent.error()));
    }
    for (std::uint32_t c = 0; c < settings.clients; ++c) {
      auto answer = clients[c].receive();
      if (!answer) return tl::unexpected(ofClient(c, tick, answer.error()));
      auto* command = std::get_if<NetworkCommand>(&*answer);
      if (!command) {
        return tl::unexpected(
            ofClient(c, tick, {ErrorCode::kDataDamaged, "it sent something else than a command"}));
      }
      session->answer(c, std::move(*command));
    }
  }
  for (Connection& client : clients) (void)client.send(NetworkBye{});
  return session->metrics();
}

tl::expected<void, Error> joinNetwork(const std::string& address, std::uint16_t port,
                                      double patience) {
  const auto at = addressOf(address, port);
  if (!at) return tl::unexpected(at.error());
  Socket socket(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0));
  if (!socket ||
      connect(socket.handle(), reinterpret_cast<const sockaddr*>(&*at), sizeof *at) != 0) {
    return broken(
        fmt::format("no crowd server at {}:{} ({}). Start one with forewalk network "
                    "--listen {}.",
                    address, port, std::strerror(errno), port));
  }
  Connection server(std::move(socket), patience);
  const auto ofServer = [&](const std::string& sentence) {
    return broken(fmt::format("crowd server at {}:{}: {}.", address, port, sentence));
  };
  auto first = server.receive();
  if (!first) return ofServer(first.error().message);
  const auto* welcome = std::get_if<NetworkWelcome>(&*first);
  if (!welcome) return ofServer("it sent no welcome");
  agents::NetworkClient client(*welcome);
  for (;;) {
    auto message = server.receive();
    if (!message) return ofServer(message.error().message);
    if (const auto* snapshot = std::get_if<NetworkSnapshot>(&*message)) {
      client.receive(*snapshot);
    } else if (std::holds_alternative<NetworkTick>(*message)) {
      if (auto sent = server.send(client.step()); !sent) return ofServer(sent.error().message);
    } else if (std::holds_alternative<NetworkBye>(*message)) {
      return {};
    } else {
      return ofServer("it sent something that is not for clients");
    }
  }
}

tl::expected<agents::NetworkMetrics, Error> runNetworkInProcesses(
    const agents::CrowdScene& scene, const agents::NetworkSettings& settings, double seconds,
    const std::filesystem::path& program, double patience) {
  std::vector<pid_t> children;
  NetworkHost host;
  host.patience = patience;
  host.listening = [&](std::uint16_t port) -> tl::expected<void, Error> {
    std::string words[] = {program.string(), "network", "--join",
                           fmt::format("127.0.0.1:{}", port)};
    char* arguments[] = {words[0].data(), words[1].data(), words[2].data(), words[3].data(),
                         nullptr};
    for (std::uint32_t c = 0; c < settings.clients; ++c) {
      pid_t child = 0;
      const int fault = posix_spawn(&child, program.c_str(), nullptr, nullptr, arguments, environ);
      if (fault != 0) {
        return broken(fmt::format("cannot start {} as a crowd client ({}).", program.string(),
                                  std::strerror(fault)));
      }
      children.push_back(child);
    }
    return {};
  };
  auto metrics = serveNetwork(scene, settings, seconds, host);
  int bad = 0;
  for (const pid_t child : children) {
    if (!metrics) kill(child, SIGTERM);
    int status = 0;
    while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
    }
    bad += !WIFEXITED(status) || WEXITSTATUS(status) != 0;
  }
  if (metrics && bad > 0) return broken(fmt::format("{} crowd clients ended badly.", bad));
  return metrics;
}

}  // namespace forewalk::service
