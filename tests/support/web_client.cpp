#include "tests/support/web_client.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <boost/asio/connect.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/websocket/stream.hpp>
#include <chrono>
#include <cstdlib>
#include <functional>

namespace forewalk::testing {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace websocket = beast::websocket;
using Tcp = asio::ip::tcp;
using Socket = asio::basic_stream_socket<Tcp, asio::io_context::executor_type>;
using Failure = boost::system::error_code;

constexpr double kPatience = 20.0;  // seconds; on a machine with much else to do

}  // namespace

struct WebClient::State {
  asio::io_context io;
  websocket::stream<Socket, false> stream{io};
  websocket::response_type response;
  beast::flat_buffer buffer;
  bool open = false, text = false;

  /// Starts an operation and waits for it; its failure, or that it took too long.
  Failure await(double seconds, const std::function<void(std::function<void(Failure)>)>& begin) {
    std::optional<Failure> done;
    begin([&](Failure failure) { done = failure; });
    io.restart();
    const auto end = std::chrono::steady_clock::now() +
                     std::chrono::duration_cast<std::chrono::steady_clock::duration>(
                         std::chrono::duration<double>(seconds));
    while (!done && std::chrono::steady_clock::now() < end) {
      if (io.run_one_until(end) == 0) break;
    }
    if (done) return *done;
    Failure ignored;
    stream.next_layer().close(ignored);
    io.restart();
    io.run();
    open = false;
    return asio::error::timed_out;
  }
};

WebClient::WebClient(unsigned short port, const Headers& headers)
    : state_(std::make_unique<State>()) {
  State& s = *state_;
  Failure failure;
  s.stream.next_layer().connect({asio::ip::address_v4::loopback(), port}, failure);
  if (failure) return;
  s.stream.next_layer().set_option(Tcp::no_delay(true), failure);
  s.stream.set_option(
      websocket::stream_base::decorator([headers](websocket::request_type& request) {
        for (const auto& [name, value] : headers) request.set(name, value);
      }));
  failure = s.await(kPatience, [&](auto done) {
    s.stream.async_handshake(s.response, "localhost", "/v1/session", done);
  });
  s.open = !failure;
}
WebClient::WebClient(WebClient&&) noexcept = default;
WebClient& WebClient::operator=(WebClient&&) noexcept = default;
WebClient::~WebClient() {
  if (state_) drop();
}

bool WebClient::open() const { return state_->open; }
unsigned WebClient::status() const { return state_->response.result_int(); }
std::string WebClient::body() const { return state_->response.body(); }
std::string WebClient::header(const std::string& name) const {
  return std::string(state_->response[name]);
}

bool WebClient::send(std::string_view message, bool isText) {
  State& s = *state_;
  if (!s.open) return false;
  s.stream.text(isText);
  const Failure failure = s.await(kPatience, [&](auto done) {
    s.stream.async_write(asio::buffer(message.data(), message.size()),
                         [done](Failure ended, std::size_t) { done(ended); });
  });
  return !failure;
}

bool WebClient::ping() {
  State& s = *state_;
  return s.open && !s.await(kPatience, [&](auto done) { s.stream.async_ping({}, done); });
}

std::optional<std::string> WebClient::receive(double seconds) {
  State& s = *state_;
  if (!s.open) return std::nullopt;
  s.buffer.clear();
  const Failure failure = s.await(seconds, [&](auto done) {
    s.stream.async_read(s.buffer, [done](Failure ended, std::size_t) { done(ended); });
  });
  if (failure) {
    s.open = false;
    return std::nullopt;
  }
  s.text = s.stream.got_text();
  return std::string(static_cast<const char*>(s.buffer.data().data()), s.buffer.size());
}

bool WebClient::receivedText() const { return state_->text; }
unsigned WebClient::closeCode() const { return state_->stream.reason().code; }

void WebClient::drop() {
  Failure ignored;
  state_->stream.next_layer().close(ignored);
  state_->open = false;
}

HttpAnswer httpGet(unsigned short port, std::string_view target, const Headers& headers,
                   std::string_view method) {
  BareSocket socket(port);
  std::string request =
      std::string(method) + " " + std::string(target) + " HTTP/1.1\r\nHost: localhost\r\n";
  for (const auto& [name, value] : headers) request += name + ": " + value + "\r\n";
  socket.send(request + "\r\n");
  const std::string text = socket.readAll(kPatience);
  HttpAnswer answer;
  const std::size_t end = text.find("\r\n\r\n");
  if (text.substr(0, 9) != "HTTP/1.1 " || end == std::string::npos) return answer;
  answer.status = static_cast<unsigned>(std::strtoul(text.c_str() + 9, nullptr, 10));
  answer.head = text.substr(0, end);
  answer.body = text.substr(end + 4);
  return answer;
}

BareSocket::BareSocket(unsigned short port) {
  socket_ = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(port);
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  if (::connect(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) {
    ::close(socket_);
    socket_ = -1;
  }
}

BareSocket::~BareSocket() {
  if (socket_ >= 0) ::close(socket_);
}

std::size_t BareSocket::send(std::string_view bytes, double seconds) {
  std::size_t sent = 0;
  if (socket_ < 0) return 0;
  while (sent < bytes.size()) {
    pollfd ready{socket_, POLLOUT, 0};
    if (::poll(&ready, 1, static_cast<int>(1000 * seconds)) != 1) break;
    const ssize_t more =
        ::send(socket_, bytes.data() + sent, bytes.size() - sent, MSG_NOSIGNAL | MSG_DONTWAIT);
    if (more <= 0) break;
    sent += static_cast<std::size_t>(more);
  }
  return sent;
}

std::string BareSocket::readAll(double quietSeconds) {
  std::string all;
  if (socket_ < 0) return all;
  char chunk[4096];
  while (true) {
    pollfd ready{socket_, POLLIN, 0};
    if (::poll(&ready, 1, static_cast<int>(1000 * quietSeconds)) != 1) break;
    const ssize_t more = ::recv(socket_, chunk, sizeof chunk, 0);
    if (more <= 0) break;
    all.append(chunk, static_cast<std::size_t>(more));
  }
  return all;
}

bool BareSocket::endsWithin(double seconds) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
  char chunk[4096];
  while (true) {
    const std::chrono::duration<double, std::milli> left = end - std::chrono::steady_clock::now();
    if (left.count() <= 0) return false;
    pollfd ready{socket_, POLLIN, 0};
    if (::poll(&ready, 1, static_cast<int>(left.count()) + 1) != 1) return false;
    if (::recv(socket_, chunk, sizeof chunk, 0) <= 0) return true;
  }
}

bool BareSocket::upgrade() {
  send(
      "GET /v1/session HTTP/1.1\r\nHost: localhost\r\nUpgrade: websocket\r\nConnection: "
      "Upgrade\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\nSec-WebSocket-Version: "
      "13\r\n\r\n");
  std::string answer;
  while (answer.find("\r\n\r\n") == std::string::npos) {
    pollfd ready{socket_, POLLIN, 0};
    char byte = 0;
    if (::poll(&ready, 1, static_cast<int>(1000 * kPatience)) != 1 ||
        ::recv(socket_, &byte, 1, 0) != 1) {
      return false;
    }
    answer += byte;
  }
  return answer.find(" 101 ") != std::string::npos;
}

std::string BareSocket::frame(unsigned char firstByte, std::string_view payload) {
  std::string bytes(1, static_cast<char>(firstByte));
  const std::size_t size = payload.size();
  if (size < 126) {
    bytes += static_cast<char>(0x80u | size);
  } else if (size < 65536) {
    bytes += static_cast<char>(0x80u | 126u);
    for (int shift = 8; shift >= 0; shift -= 8) bytes += static_cast<char>(size >> shift & 255u);
  } else {
    bytes += static_cast<char>(0x80u | 127u);
    for (int shift = 56; shift >= 0; shift -= 8) bytes += static_cast<char>(size >> shift & 255u);
  }
  return bytes + std::string(4, '\0') + std::string(payload);
}

}  // namespace forewalk::testing
