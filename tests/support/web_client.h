// Clients of the daemon, for tests: a polite one that speaks WebSocket and HTTP, and a bare socket
// for what a polite one would not do. Everything ends within its time.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace forewalk::testing {

using Headers = std::vector<std::pair<std::string, std::string>>;

class WebClient {
 public:
  /// Connects and asks for a session; `open()` says whether it was let in.
  explicit WebClient(unsigned short port, const Headers& headers = {});
  WebClient(WebClient&&) noexcept;
  WebClient& operator=(WebClient&&) noexcept;
  ~WebClient();  ///< drops the connection

  bool open() const;
  unsigned status() const;   ///< of the HTTP answer: 101 where it was let in; 0 without one
  std::string body() const;  ///< of the HTTP answer, where it was not
  std::string header(const std::string& name) const;

  bool send(std::string_view message, bool isText);
  bool ping();
  /// The next message; nothing where the connection ends first, or no message comes in time.
  std::optional<std::string> receive(double seconds = 10.0);
  bool receivedText() const;   ///< whether the last message was text
  unsigned closeCode() const;  ///< of the daemon's close; 0: none came
  void drop();                 ///< ends the connection without a word

 private:
  struct State;
  std::unique_ptr<State> state_;
};

struct HttpAnswer {
  unsigned status = 0;  ///< 0: none
  std::string head, body;
};
HttpAnswer httpGet(unsigned short port, std::string_view target, const Headers& headers = {},
                   std::string_view method = "GET");

class BareSocket {
 public:
  explicit BareSocket(unsigned short port);
  BareSocket(const BareSocket&) = delete;
  BareSocket& operator=(const BareSocket&) = delete;
  ~BareSocket();

  bool connected() const { return socket_ >= 0; }
  /// What could be sent of it without waiting longer than `seconds`.
  std::size_t send(std::string_view bytes, double seconds = 5.0);
  /// All that comes until the other side ends, or nothing comes for so long.
  std::string readAll(double quietSeconds);
  /// Whether the other side ended the connection within so long.
  bool endsWithin(double seconds);
  /// Makes it a WebSocket; true where the daemon said 101.
  bool upgrade();
  /// A client's frame, masked with zeros.
  static std::string frame(unsigned char firstByte, std::string_view payload);

 private:
  int socket_ = -1;
};

}  // namespace forewalk::testing
