// One client's connection: an HTTP request, which is answered or becomes a WebSocket with a
// session.
//
//   kRequest -> kResponding
//            -> kUpgrading -> kHello -> kLoading -> kFrames -> kClosing
//
// Lives on its worker's thread alone (a hello is made into a session elsewhere, and comes back).
// Alive as long as an operation of it is under way. One message is read, answered and only then the
// next one read: answers are in order, and a client that does not read them fills its own pipe.
#pragma once

#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/http/parser.hpp>
#include <boost/beast/http/string_body.hpp>
#include <boost/beast/websocket/stream.hpp>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "service/daemon/message.h"
#include "service/daemon/shared.h"

namespace forewalk::daemon {

namespace beast = boost::beast;

inline constexpr double kClosingSeconds = 1.0;  ///< for a client to take its leave

class Connection : public std::enable_shared_from_this<Connection> {
 public:
  Connection(Shared& shared, Worker& worker, Socket socket);
  ~Connection();
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;

  void start();
  void sweep(Clock::time_point now);  ///< lets go of who is past their time
  void drain();                       ///< tells them to go on elsewhere
  void flushRecording();

 private:
  enum class Phase { kRequest, kResponding, kUpgrading, kHello, kLoading, kFrames, kClosing };
  using WebSocket = beast::websocket::stream<Socket, false>;
  using Failure = boost::system::error_code;

  // HTTP (connection.cpp).
  void onRequest();
  void answerPage(std::string_view path, bool bodyWanted);
  bool mayUpgrade();
  void upgrade();
  void respond(unsigned status, std::string_view type, std::string body, bool bodyWanted = true);
  void refuseRequest(unsigned status, Refusal refusal, const std::string& message);
  void linger();

  // WebSocket (connection_session.cpp).
  void read();
  void onRead(std::size_t bytes);
  bool admit();
  void onHello(std::string_view text, bool isText);
  struct Loaded;
  static Loaded load(Shared& shared, const std::string& hello);
  void onLoaded(Loaded loaded);
  void onFrame(std::string_view bytes, bool isText);
  void send(bool isText, void (Connection::*then)());
  void onAnswered();
  void refuse(Refusal refusal, const std::string& message);
  void close();
  void lost(const Failure& failure);
  void ended(std::string_view why);

  void setDeadline(double seconds);
  void closeSocket();
  std::string header(beast::http::field field) const;

  Shared& shared_;
  Worker& worker_;
  Phase phase_ = Phase::kRequest;
  Clock::time_point deadline_;
  std::string peer_;

  std::optional<Socket> socket_;  ///< until it is a WebSocket's
  std::optional<WebSocket> webSocket_;
  beast::flat_buffer buffer_;
  std::optional<beast::http::request_parser<beast::http::string_body>> parser_;
  std::string response_;

  bool entered_ = false;  ///< counts as a session
  bool began_ = false;
  bool writing_ = false;
  bool drainAfterWrite_ = false;
  double allowance_;  ///< messages that may come at once
  Clock::time_point allowanceAt_, frameAt_;
  Refusal refusal_ = Refusal::kCount;  ///< why it is being closed
  std::uint64_t id_ = 0;
  std::uint64_t frames_ = 0;
  std::optional<rdw::Session> session_;
  std::string out_, token_, recorded_;
  std::shared_ptr<RecordingFile> recording_;
};

}  // namespace forewalk::daemon
