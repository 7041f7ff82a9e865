#include "service/daemon/connection.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <boost/asio/buffer.hpp>
#include <boost/asio/write.hpp>
#include <boost/beast/http/read.hpp>
#include <boost/beast/websocket/rfc6455.hpp>
#include <utility>

#include "navmesh/file_text.h"

namespace forewalk::daemon {

namespace http = beast::http;
namespace websocket = beast::websocket;

namespace {

constexpr std::string_view kSessionPath = "/v1/session";
constexpr std::string_view kNavMeshPath = "/v1/navmesh";
constexpr std::string_view kPlain = "text/plain; charset=utf-8";

std::string_view viewOf(beast::string_view text) { return {text.data(), text.size()}; }

std::string_view reasonOf(unsigned status) {
  return viewOf(http::obsolete_reason(static_cast<http::status>(status)));
}

}  // namespace

Connection::Connection(Shared& shared, Worker& worker, Socket socket)
    : shared_(shared),
      worker_(worker),
      socket_(std::move(socket)),
      buffer_(std::max(kRequestBytes, shared.settings.limits.messageBytes + 1)),
      allowance_(shared.settings.limits.messagesPerSecond) {
  worker_.connections.insert(this);
  boost::system::error_code unknown;
  const auto peer = socket_->remote_endpoint(unknown);
  peer_ = unknown ? "gone" : peer.address().to_string();
}

Connection::~Connection() {
  flushRecording();
  if (began_) worker_.counters.sessionsEnded.add();
  if (entered_) shared_.leaveSession();
  worker_.connections.erase(this);
  --worker_.load;
  --shared_.connections;
}

void Connection::setDeadline(double seconds) {
  deadline_ = Clock::now() +
              std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds));
}

void Connection::closeSocket() {
  boost::system::error_code ignored;
  if (webSocket_) {
    webSocket_->next_layer().close(ignored);
  } else {
    socket_->close(ignored);
  }
}

void Connection::start() {
  setDeadline(shared_.settings.limits.handshakeSeconds);
  boost::system::error_code ignored;
  socket_->set_option(Tcp::no_delay(true), ignored);
  if (shared_.connections >
      shared_.settings.limits.sessions + shared_.settings.limits.spareConnections) {
    return refuseRequest(503, Refusal::kConnections,
                         fmt::format("{} connections are open; more are not served "
                                     "(--max-sessions). Try again later.",
                                     shared_.connections - 1));
  }
  parser_.emplace();
  parser_->header_limit(static_cast<std::uint32_t>(kRequestBytes));
  parser_->body_limit(0);
  http::async_read(*socket_, buffer_, *parser_,
                   [self = shared_from_this()](const Failure& failure, std::size_t) {
                     if (self->phase_ != Phase::kRequest) return;
                     if (failure == http::error::end_of_stream || failure == asio::error::eof ||
                         failure == asio::error::connection_reset ||
                         failure == asio::error::operation_aborted) {
                       return;
                     }
                     if (failure) {
                       return self->refuseRequest(
                           400, Refusal::kRequest,
                           fmt::format("this is no HTTP request that the daemon reads ({}; {} "
                                       "bytes at most, without a body).",
                                       failure.message(), kRequestBytes));
                     }
                     self->onRequest();
                   });
}

std::string Connection::header(http::field field) const {
  return std::string(viewOf(parser_->get()[field]));
}

void Connection::onRequest() {
  const auto& request = parser_->get();
  const std::string target(viewOf(request.target()));
  const std::string path = target.substr(0, target.find_first_of("?#"));
  if (path == kSessionPath) {
    if (mayUpgrade()) upgrade();
    return;
  }
  if (request.method() != http::verb::get && request.method() != http::verb::head) {
    return refuseRequest(405, Refusal::kRequest, "GET and HEAD are all that is served here.");
  }
  answerPage(path, request.method() == http::verb::get);
}

void Connection::answerPage(std::string_view path, bool bodyWanted) {
  if (path == "/healthz") {
    return shared_.draining ? respond(503, kPlain, "draining\n", bodyWanted)
                            : respond(200, kPlain, "ok\n", bodyWanted);
  }
  if (path == "/metrics" || path == kNavMeshPath) {
    if (!tokenGiven(shared_.settings.access, header(http::field::authorization), {})) {
      return refuseRequest(401, Refusal::kAccess,
                           fmt::format("{} needs the access token: send Authorization: Bearer "
                                       "TOKEN.",
                                       path));
    }
  }
  if (path == kNavMeshPath && !shared_.settings.fwmesh.empty()) {
    return respond(200, "application/octet-stream", shared_.settings.fwmesh, bodyWanted);
  }
  if (path == "/metrics") {
    std::vector<const Counters*> threads;
    for (const auto& worker : shared_.workers) threads.push_back(&worker->counters);
    DaemonFacts facts{FOREWALK_VERSION, shared_.navMeshText, shared_.connections, 0, 0,
                      shared_.draining};
    if (shared_.recorder) {
      facts.recordingBytes = shared_.recorder->bytes();
      facts.recordingFailures = shared_.recorder->failures();
    }
    return respond(200, "text/plain; version=0.0.4; charset=utf-8", metricsText(threads, facts),
                   bodyWanted);
  }
  const auto page = shared_.settings.pages.find(path);
  if (page != shared_.settings.pages.end()) {
    return respond(200, page->second.type, page->second.bytes, bodyWanted);
  }
  if (path == "/" && shared_.settings.pages.empty()) {
    return respond(404, kPlain,
                   "forewalk serves sessions at /v1/session. The inspector page is not installed "
                   "here: start forewalk serve with --inspector DIR.\n",
                   bodyWanted);
  }
  refuseRequest(404, Refusal::kRequest,
                fmt::format("there is no {}; there are /healthz, /metrics, /v1/session, "
                            "/v1/navmesh and the inspector at /.",
                            inQuotes(path)));
}

bool Connection::mayUpgrade() {
  const auto& request = parser_->get();
  const Access& access = shared_.settings.access;
  std::optional<std::string> origin;
  if (request.find(http::field::origin) != request.end()) origin = header(http::field::origin);
  const std::string offered = header(http::field::sec_websocket_protocol);
  Access here = access;
  here.port = shared_.port;
  if (!websocket::is_upgrade(request)) {
    refuseRequest(426, Refusal::kRequest, "sessions are WebSockets: connect with one.");
  } else if (!originAllowed(here, origin)) {
    refuseRequest(403, Refusal::kOrigin,
                  fmt::format("pages from {} may not open sessions here: start forewalk serve with "
                              "--origin for them.",
                              inQuotes(*origin)));
  } else if (!tokenGiven(access, header(http::field::authorization), offered)) {
    refuseRequest(401, Refusal::kAccess,
                  "the access token is missing or another: send Authorization: Bearer TOKEN, or "
                  "from a browser the subprotocols forewalk.1 and token.TOKEN.");
  } else if (!offered.empty() && !offers(offered, kSubprotocol)) {
    refuseRequest(400, Refusal::kRequest,
                  fmt::format("the subprotocols {} are not spoken here; {} is.", inQuotes(offered),
                              kSubprotocol));
  } else if (shared_.draining) {
    refuseRequest(503, Refusal::kDraining, "this daemon is about to end: go to another one.");
  } else if (!shared_.enterSession()) {
    refuseRequest(503, Refusal::kSessions,
                  fmt::format("{} sessions walk here; more are not served (--max-sessions). Try "
                              "again later, or another daemon.",
                              shared_.settings.limits.sessions));
  } else {
    entered_ = true;
    return true;
  }
  return false;
}

void Connection::upgrade() {
  phase_ = Phase::kUpgrading;
  webSocket_.emplace(std::move(*socket_));
  socket_.reset();
  // Each has its deadline from the sweep, which costs no timer an operation.
  webSocket_->set_option(websocket::stream_base::timeout{websocket::stream_base::none(),
                                                         websocket::stream_base::none(), false});
  webSocket_->read_message_max(0);  // read() looks after the size, so as to say which limit
  const bool offered = !header(http::field::sec_websocket_protocol).empty();
  webSocket_->set_option(
      websocket::stream_base::decorator([offered](websocket::response_type& response) {
        response.set(http::field::server, "forewalk/" FOREWALK_VERSION);
        if (offered) {
          response.set(http::field::sec_websocket_protocol,
                       beast::string_view(kSubprotocol.data(), kSubprotocol.size()));
        }
      }));
  webSocket_->control_callback([this](websocket::frame_type, beast::string_view) {
    // A flood of pings is one of messages.
    if (phase_ == Phase::kClosing || admit()) return;
    worker_.counters.refuse(Refusal::kMessagesPerSecond);
    ended(fmt::format("{}: a flood of pings", nameOf(Refusal::kMessagesPerSecond)));
    phase_ = Phase::kClosing;
    closeSocket();
  });
  buffer_.clear();
  webSocket_->async_accept(parser_->get(), [self = shared_from_this()](const Failure& failure) {
    if (failure) return;
    self->parser_.reset();
    self->phase_ = Phase::kHello;
    self->setDeadline(self->shared_.settings.limits.handshakeSeconds);
    if (self->shared_.draining) return self->drain();
    self->read();
  });
}

void Connection::refuseRequest(unsigned status, Refusal refusal, const std::string& message) {
  worker_.counters.refuse(refusal);
  spdlog::warn("{} refused: {}: {}", peer_, nameOf(refusal), message);
  respond(status, "application/json", errorText(nameOf(refusal), message) + "\n");
}

void Connection::respond(unsigned status, std::string_view type, std::string body,
                         bool bodyWanted) {
  phase_ = Phase::kResponding;
  setDeadline(shared_.settings.limits.sendSeconds);
  response_ = fmt::format(
      "HTTP/1.1 {} {}\r\nServer: forewalk/{}\r\nContent-Type: {}\r\nContent-Length: {}\r\n"
      "X-Content-Type-Options: nosniff\r\nX-Frame-Options: DENY\r\nCache-Control: no-cache\r\n{}"
      "Connection: close\r\n\r\n",
      status, reasonOf(status), FOREWALK_VERSION, type, body.size(),
      status == 401 ? "WWW-Authenticate: Bearer\r\n" : "");
  if (bodyWanted) response_ += body;
  asio::async_write(*socket_, asio::buffer(response_),
                    [self = shared_from_this()](const Failure& failure, std::size_t) {
                      if (failure) return;
                      boost::system::error_code ignored;
                      self->socket_->shutdown(Tcp::socket::shutdown_send, ignored);
                      self->setDeadline(kClosingSeconds);
                      self->linger();
                    });
}

// What has come and was not read would take the answer with it, were the socket closed now.
void Connection::linger() {
  buffer_.clear();
  socket_->async_read_some(buffer_.prepare(1024),
                           [self = shared_from_this()](const Failure& failure, std::size_t) {
                             if (!failure) self->linger();
                           });
}

void Connection::sweep(Clock::time_point now) {
  if (now < deadline_) return;
  const Limits& limits = shared_.settings.limits;
  switch (phase_) {
    case Phase::kRequest:
      refuseRequest(408, Refusal::kHandshake,
                    fmt::format("no whole request within {:g} s.", limits.handshakeSeconds));
      break;
    case Phase::kHello:
      refuse(Refusal::kHandshake, fmt::format("no hello within {:g} s.", limits.handshakeSeconds));
      break;
    case Phase::kFrames:
      if (writing_) {
        worker_.counters.refuse(Refusal::kSend);
        ended(fmt::format("{}: an answer was not taken within {:g} s", nameOf(Refusal::kSend),
                          limits.sendSeconds));
        phase_ = Phase::kClosing;
        closeSocket();
      } else {
        refuse(Refusal::kIdle, fmt::format("no frame within {:g} s. Connect again with the last "
                                           "answer's token.",
                                           limits.idleSeconds));
      }
      break;
    case Phase::kLoading:
      break;  // our own work takes what it takes
    case Phase::kResponding:
    case Phase::kUpgrading:
    case Phase::kClosing:
      closeSocket();
      break;
  }
}

}  // namespace forewalk::daemon
