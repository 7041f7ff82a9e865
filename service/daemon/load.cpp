#include "service/daemon/load.h"

#include <fmt/format.h>

#include <algorithm>
#include <boost/asio/connect.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/http/empty_body.hpp>
#include <boost/beast/http/read.hpp>
#include <boost/beast/http/string_body.hpp>
#include <boost/beast/http/write.hpp>
#include <boost/beast/websocket/stream.hpp>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <deque>
#include <functional>
#include <optional>
#include <utility>

#include "service/daemon/metrics.h"
#include "service/timing.h"

namespace forewalk::daemon {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
namespace websocket = beast::websocket;
using Tcp = asio::ip::tcp;
using Clock = std::chrono::steady_clock;
using Socket = asio::basic_stream_socket<Tcp, asio::io_context::executor_type>;
using Failure = boost::system::error_code;

double secondsBetween(Clock::time_point from, Clock::time_point to) {
  return std::chrono::duration<double>(to - from).count();
}

tl::unexpected<Error> unreachable(const LoadSettings& settings, const std::string& why) {
  return tl::unexpected(Error{ErrorCode::kFileUnreadable,
                              fmt::format("{} port {}: {}. Is forewalk serve running there?",
                                          settings.address, settings.port, why)});
}

/// The daemon's own numbers; nothing where it cannot be asked.
std::optional<std::string> metricsOf(const LoadSettings& settings) {
  Failure failure;
  asio::io_context io;
  Socket socket(io);
  socket.connect({asio::ip::make_address(settings.address, failure), settings.port}, failure);
  if (failure) return std::nullopt;
  http::request<http::empty_body> request(http::verb::get, "/metrics", 11);
  request.set(http::field::host, settings.address);
  if (!settings.accessToken.empty()) {
    request.set(http::field::authorization, "Bearer " + settings.accessToken);
  }
  http::write(socket, request, failure);
  beast::flat_buffer buffer;
  http::response<http::string_body> response;
  if (!failure) http::read(socket, buffer, response, failure);
  if (failure || response.result() != http::status::ok) return std::nullopt;
  return std::move(response.body());
}

double sampleOf(const std::optional<std::string>& metrics, const std::string& name) {
  const std::size_t at = metrics ? metrics->find("\n" + name + " ") : std::string::npos;
  return at == std::string::npos ? 0.0
                                 : std::strtod(metrics->c_str() + at + name.size() + 2, nullptr);
}

struct Round;

/// One user's connection.
struct Client : std::enable_shared_from_this<Client> {
  Client(Round& round, unsigned number);
  void start();
  void fail(const std::string& why);
  void readWelcome();
  void due(Clock::time_point when);
  void sendNext();
  void read();
  void onAnswer();

  Round& round;
  unsigned number;
  websocket::stream<Socket, false> stream;
  beast::flat_buffer buffer;
  MadeUpBody body;
  Clock::time_point nextDue;
  std::deque<Clock::time_point> waiting;  ///< due, not yet sent
  std::deque<Clock::time_point> sent;     ///< when those were due that no answer has come to
  std::string out;
  std::uint32_t expected = 0;
  bool writing = false, begun = false, dead = false, turning = false;
  std::vector<std::pair<Frame, Answer>> checked;
  std::deque<Frame> asked;  ///< of checked sessions
};

struct Round {
  explicit Round(const LoadSettings& chosen) : settings(chosen) {}
  const LoadSettings& settings;
  asio::io_context io{1};
  asio::steady_timer tick{io};
  std::vector<std::shared_ptr<Client>> clients;
  LoadResult result;
  std::vector<double> milliseconds;
  unsigned begun = 0;
  std::size_t next = 0;  ///< whose frame is due next
  bool ending = false;
  std::function<void()> onAllBegun;

  void settled() {
    if (begun + result.failed == clients.size() && onAllBegun) std::exchange(onAllBegun, {})();
  }
};

Client::Client(Round& in, unsigned n) : round(in), number(n), stream(in.io), body(n) {}

void Client::start() {
  const LoadSettings& settings = round.settings;
  const Tcp::endpoint there(asio::ip::make_address(settings.address), settings.port);
  stream.next_layer().async_connect(there, [self = shared_from_this()](const Failure& failure) {
    if (failure) return self->fail(failure.message());
    Failure ignored;
    self->stream.next_layer().set_option(Tcp::no_delay(true), ignored);
    const std::string token = self->round.settings.accessToken;
    self->stream.set_option(
        websocket::stream_base::decorator([token](websocket::request_type& request) {
          if (!token.empty()) request.set(http::field::authorization, "Bearer " + token);
        }));
    self->stream.async_handshake(
        self->round.settings.address, "/v1/session", [self](const Failure& refused) {
          if (refused) return self->fail(refused.message());
          self->out = fmt::format(R"({{"format":"forewalk.hello/1","session":{}}})",
                                  self->round.settings.session);
          self->stream.text(true);
          self->stream.async_write(asio::buffer(self->out),
                                   [self](const Failure& lost, std::size_t) {
                                     if (lost) return self->fail(lost.message());
                                     self->readWelcome();
                                   });
        });
  });
}

void Client::fail(const std::string& why) {
  if (dead || round.ending) return;
  dead = true;
  if (begun) --round.begun;
  ++round.result.failed;
  if (round.result.failure.empty()) round.result.failure = why;
  round.settled();
}

void Client::readWelcome() {
  stream.async_read(buffer, [self = shared_from_this()](const Failure& failure, std::size_t) {
    if (failure) return self->fail(failure.message());
    const std::string welcome(static_cast<const char*>(self->buffer.data().data()),
                              self->buffer.size());
    self->buffer.clear();
    if (welcome.find("forewalk.welcome/1") == std::string::npos) return self->fail(welcome);
    self->begun = true;
    ++self->round.begun;
    self->read();
    self->round.settled();
  });
}

void Client::due(Clock::time_point when) {
  if (dead) return;
  waiting.push_back(when);
  if (!writing) sendNext();
}

void Client::sendNext() {
  const LoadSettings& settings = round.settings;
  const Clock::time_point when = waiting.front();
  waiting.pop_front();
  const Frame frame = body.next(1.0 / settings.rate, turning);
  out = settings.json ? frameText(frame) : frameBytes(frame);
  if (number < settings.checked) asked.push_back(frame);
  if (secondsBetween(when, Clock::now()) > 1.0 / settings.rate) ++round.result.late;
  ++round.result.sent;
  sent.push_back(when);
  writing = true;
  stream.text(settings.json);
  stream.async_write(asio::buffer(out),
                     [self = shared_from_this()](const Failure& failure, std::size_t) {
                       self->writing = false;
                       if (failure) return self->fail(failure.message());
                       if (!self->waiting.empty()) self->sendNext();
                     });
}

void Client::read() {
  stream.async_read(buffer, [self = shared_from_this()](const Failure& failure, std::size_t) {
    if (failure) return self->fail(failure.message());
    self->onAnswer();
    self->buffer.clear();
    if (!self->dead) self->read();
  });
}

void Client::onAnswer() {
  const std::string_view bytes(static_cast<const char*>(buffer.data().data()), buffer.size());
  if (sent.empty()) return fail(fmt::format("an answer to nothing: {}", bytes));
  const double ms = 1e3 * secondsBetween(sent.front(), Clock::now());
  sent.pop_front();
  if (round.settings.json) {
    // Enough to go on: whose turn it is, and whether it is in order.
    const std::string start = fmt::format(R"({{"sequence":{},)", expected);
    if (bytes.substr(0, start.size()) != start) return fail(std::string(bytes));
    turning = bytes.find("\"turning\":true") != std::string_view::npos;
  } else {
    const auto read = parseAnswerBytes(bytes);
    if (!read) return fail(std::string(bytes.substr(0, 300)));
    if (read->answer.sequence != expected) {
      return fail(
          fmt::format("answer {} came in the place of {}", read->answer.sequence, expected));
    }
    turning = read->answer.resetting;
    if (!asked.empty()) {
      checked.emplace_back(asked.front(), read->answer);
      asked.pop_front();
    }
  }
  ++expected;
  ++round.result.answered;
  round.milliseconds.push_back(ms);
}

/// Sends what is due. Phases are spread over a frame's time, so that the clients come round in
/// turn.
void tickOn(Round& round, Clock::time_point end) {
  round.tick.expires_at(std::min(end, round.clients[round.next]->nextDue));
  round.tick.async_wait([&round, end](const Failure& failure) {
    if (failure) return;
    const Clock::time_point now = Clock::now();
    const auto frame = std::chrono::duration_cast<Clock::duration>(
        std::chrono::duration<double>(1.0 / round.settings.rate));
    while (true) {
      Client& client = *round.clients[round.next];
      if (client.nextDue > now || client.nextDue >= end) break;
      client.due(client.nextDue);
      client.nextDue += frame;
      round.next = (round.next + 1) % round.clients.size();
    }
    if (now < end) return tickOn(round, end);
    // What is under way has two more seconds.
    round.tick.expires_after(std::chrono::seconds(2));
    round.tick.async_wait([&round](const Failure&) {
      round.ending = true;
      round.io.stop();
    });
  });
}

void startFrames(Round& round) {
  const Clock::time_point now = Clock::now();
  const double frame = 1.0 / round.settings.rate;
  for (const auto& client : round.clients) {
    const double phase = frame * client->number / static_cast<double>(round.clients.size());
    client->nextDue =
        now + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(phase));
  }
  tickOn(round, now + std::chrono::duration_cast<Clock::duration>(
                          std::chrono::duration<double>(round.settings.seconds)));
}

/// The checked sessions again, in here.
tl::expected<void, Error> check(Round& round, std::shared_ptr<const navmesh::World> world) {
  LoadResult& result = round.result;
  result.hash = 14695981039346656037u;  // FNV-1a
  for (const auto& client : round.clients) {
    if (client->checked.empty()) continue;
    auto settings = parseSettings(round.settings.session);
    if (!settings) return tl::unexpected(settings.error());
    auto session = rdw::Session::make(world, std::move(*settings));
    if (!session) return tl::unexpected(std::move(session.error()));
    std::string bytes;
    for (const auto& [frame, answer] : client->checked) {
      const Answer ours = answerOf(frame.sequence, session->frame(frame.head, frame.seconds));
      ++result.checkedFrames;
      if (!(ours == answer)) ++result.wrongFrames;
      bytes.clear();
      appendAnswerBytes(answer, {}, bytes);
      for (const char byte : bytes) {
        result.hash = (result.hash ^ static_cast<unsigned char>(byte)) * 1099511628211u;
      }
    }
  }
  return {};
}

}  // namespace

Frame MadeUpBody::next(double dt, bool turning) {
  seconds_ += dt;
  if (turning) {
    heading_ += 1.8 * dt;
  } else {
    heading_ += 0.5 * std::sin(0.4 * seconds_ + phase_) * dt;
    position_ += 1.1 * dt * rdw::directionOf(heading_);
  }
  Frame frame;
  frame.sequence = sequence_++;
  frame.seconds = seconds_;
  frame.head.position = navmesh::toSpace(glm::vec2(position_), 1.7f);
  frame.head.orientation =
      glm::quat(glm::dquat(std::cos(0.5 * heading_), 0.0, std::sin(0.5 * heading_), 0.0));
  return frame;
}

tl::expected<LoadResult, Error> runLoad(const LoadSettings& settings,
                                        std::shared_ptr<const navmesh::World> world) {
  if (auto sound = parseSettings(settings.session); !sound) return tl::unexpected(sound.error());
  Failure failure;
  asio::ip::make_address(settings.address, failure);
  if (failure) return unreachable(settings, "no IP address");
  if (!metricsOf(settings)) return unreachable(settings, "no answer to GET /metrics");

  Round round(settings);
  round.milliseconds.reserve(
      static_cast<std::size_t>(settings.sessions * settings.rate * settings.seconds * 1.01));
  for (unsigned i = 0; i < settings.sessions; ++i) {
    round.clients.push_back(std::make_shared<Client>(round, i));
  }
  std::optional<std::string> before;
  double processorBefore = 0.0;
  const Clock::time_point start = Clock::now();
  Clock::time_point began = start;
  round.onAllBegun = [&] {
    began = Clock::now();
    before = metricsOf(settings);
    processorBefore = processorSeconds();
    startFrames(round);
  };
  for (const auto& client : round.clients) client->start();
  round.io.run();
  LoadResult& result = round.result;
  const auto after = metricsOf(settings);
  result.connectSeconds = secondsBetween(start, began);
  result.clientCores = (processorSeconds() - processorBefore) / settings.seconds;
  result.daemonCores = (sampleOf(after, "process_cpu_seconds_total") -
                        sampleOf(before, "process_cpu_seconds_total")) /
                       settings.seconds;
  constexpr double kMiB = 1024.0 * 1024.0;
  result.daemonMiBBefore = sampleOf(before, "process_resident_memory_bytes") / kMiB;
  result.daemonMiBAfter = sampleOf(after, "process_resident_memory_bytes") / kMiB;
  result.lost = result.sent - result.answered;
  result.medianMs = service::quantile(round.milliseconds, 0.5);
  result.p99Ms = service::quantile(round.milliseconds, 0.99);
  result.p999Ms = service::quantile(round.milliseconds, 0.999);
  result.worstMs = service::quantile(round.milliseconds, 1.0);
  if (world) {
    if (auto checked = check(round, std::move(world)); !checked) {
      return tl::unexpected(checked.error());
    }
  }
  for (const auto& client : round.clients) client->dead = true;
  return result;
}

}  // namespace forewalk::daemon
