// Clients that go too far: each limit says its name, and those who walk beside them notice nothing.
#include "service/daemon/limits.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <string>
#include <thread>
#include <vector>

#include "service/timing.h"
#include "tests/service/daemon_support.h"

namespace forewalk::testing {
namespace {

using namespace std::chrono_literals;

// Without a controller, whose room would take long to study in slow builds.
const std::string kHello = R"({"format":"forewalk.hello/1","session":{"controller":"none"}})";

std::string sampleOf(unsigned short port, const std::string& name) {
  const std::string metrics = httpGet(port, "/metrics").body;
  const std::size_t at = metrics.find("\n" + name + " ");
  if (at == std::string::npos) return "";
  const std::size_t from = at + name.size() + 2;
  return metrics.substr(from, metrics.find('\n', from) - from);
}

std::string refusedOf(unsigned short port, const std::string& code) {
  return sampleOf(port, "forewalk_refused_total{code=\"" + code + "\"}");
}

TEST(DaemonLimits, OnTheSizeOfAMessage) {
  daemon::DaemonSettings settings;
  settings.limits.messageBytes = 1000;
  const auto daemon = startDaemon(settings);
  Walker walker(daemon->port(), sessionWith("none"));
  ASSERT_TRUE(walker.welcomed());
  EXPECT_TRUE(walker.client.send(std::string(1001, ' '), true));
  EXPECT_EQ(codeOf(walker.client.receive()), "limit.message_bytes");
  EXPECT_FALSE(walker.client.receive());
  EXPECT_EQ(walker.client.closeCode(), 1009u);
  EXPECT_EQ(refusedOf(daemon->port(), "limit.message_bytes"), "1");
  // In pieces too, and however large it says it will be.
  BareSocket pieces(daemon->port());
  ASSERT_TRUE(pieces.upgrade());
  pieces.send(BareSocket::frame(0x01, std::string(600, ' ')));
  pieces.send(BareSocket::frame(0x00, std::string(600, ' ')));
  EXPECT_NE(pieces.readAll(3.0).find("limit.message_bytes"), std::string::npos);
  BareSocket huge(daemon->port());
  ASSERT_TRUE(huge.upgrade());
  huge.send(std::string("\x81\xff\x0f\xff\xff\xff\xff\xff\xff\xff\0\0\0\0", 14) +
            std::string(5000, ' '));
  huge.readAll(3.0);
  EXPECT_TRUE(huge.endsWithin(5.0));
}

TEST(DaemonLimits, OnMessagesPerSecond) {
  daemon::DaemonSettings settings;
  settings.limits.messagesPerSecond = 50;
  settings.limits.idleSeconds = settings.limits.handshakeSeconds = 60.0;
  const auto daemon = startDaemon(settings);
  Walker walker(daemon->port(), sessionWith("none"));
  ASSERT_TRUE(walker.welcomed());
  // All at once, so that a slow machine is no excuse.
  Body body;
  for (int i = 0; i < 400; ++i) {
    walker.client.send(daemon::frameBytes(body.next(false)), false);
  }
  std::string code;
  int answered = 0;
  while (const auto message = walker.client.receive(30.0)) {
    if (walker.client.receivedText()) {
      code = codeOf(message);
    } else {
      ++answered;
    }
  }
  EXPECT_EQ(code, "limit.messages_per_second");
  EXPECT_GE(answered, 45);
  // Pings and small pieces of a message count, too.
  for (const unsigned char first : {0x89, 0x00}) {
    BareSocket flood(daemon->port());
    ASSERT_TRUE(flood.upgrade());
    std::string bytes = first == 0x00 ? BareSocket::frame(0x01, "") : "";
    for (int i = 0; i < 500; ++i) bytes += BareSocket::frame(first, "x");
    flood.send(bytes);
    EXPECT_TRUE(flood.endsWithin(30.0)) << int{first};
  }
  EXPECT_EQ(refusedOf(daemon->port(), "limit.messages_per_second"), "3");
}

TEST(DaemonLimits, OnSessions) {
  daemon::DaemonSettings settings;
  settings.limits.sessions = 3;
  settings.limits.spareConnections = 4;
  const auto daemon = startDaemon(settings);
  std::vector<Walker> walkers;
  for (int i = 0; i < 3; ++i) walkers.emplace_back(daemon->port(), sessionWith("none"));
  for (const Walker& walker : walkers) EXPECT_TRUE(walker.welcomed());
  const WebClient refused(daemon->port());
  EXPECT_EQ(refused.status(), 503u);
  EXPECT_EQ(refusedOf(daemon->port(), "limit.sessions"), "1");
  // A place that is left is free again.
  walkers.pop_back();
  bool free = false;
  for (int i = 0; i < 200 && !free; ++i) {
    std::this_thread::sleep_for(20ms);
    free = Walker(daemon->port(), sessionWith("none")).welcomed();
  }
  EXPECT_TRUE(free);
}

TEST(DaemonLimits, OnConnections) {
  daemon::DaemonSettings settings;
  settings.limits.sessions = 2;
  settings.limits.spareConnections = 2;
  settings.limits.handshakeSeconds = 60.0;
  const auto daemon = startDaemon(settings);
  std::vector<std::unique_ptr<BareSocket>> idle;
  for (int i = 0; i < 4; ++i) idle.push_back(std::make_unique<BareSocket>(daemon->port()));
  std::this_thread::sleep_for(100ms);
  const HttpAnswer refused = httpGet(daemon->port(), "/healthz");
  EXPECT_EQ(refused.status, 503u);
  EXPECT_NE(refused.body.find("limit.connections"), std::string::npos);
}

TEST(DaemonLimits, OnTimes) {
  daemon::DaemonSettings settings;
  settings.limits.idleSeconds = 0.5;
  settings.limits.handshakeSeconds = 0.5;
  settings.limits.sendSeconds = 0.5;
  const auto daemon = startDaemon(settings);
  const unsigned short port = daemon->port();
  // No request; half of one; no hello; half of one; no frame.
  BareSocket silent(port), half(port), noHello(port), halfHello(port);
  half.send("GET /healthz HTT");
  ASSERT_TRUE(noHello.upgrade());
  ASSERT_TRUE(halfHello.upgrade());
  halfHello.send(BareSocket::frame(0x01, "{\"format\":"));
  Walker idle(port, sessionWith("none"));
  ASSERT_TRUE(idle.welcomed());
  EXPECT_EQ(codeOf(idle.client.receive()), "limit.idle_seconds");
  EXPECT_FALSE(idle.client.receive());
  EXPECT_EQ(idle.client.closeCode(), 1001u);
  for (BareSocket* socket : {&silent, &half, &noHello, &halfHello}) {
    EXPECT_NE(socket->readAll(5.0).find("limit.handshake_seconds"), std::string::npos);
    EXPECT_TRUE(socket->endsWithin(5.0));
  }
  EXPECT_EQ(refusedOf(port, "limit.handshake_seconds"), "4");
  EXPECT_EQ(sampleOf(port, "forewalk_sessions"), "0");
}

TEST(DaemonLimits, OnTheTimeToTakeAnAnswer) {
  daemon::DaemonSettings settings;
  settings.limits.sendSeconds = 0.5;
  settings.limits.messagesPerSecond = 1e6;
  const auto daemon = startDaemon(settings);
  BareSocket deaf(daemon->port());
  ASSERT_TRUE(deaf.upgrade());
  deaf.send(BareSocket::frame(0x81, kHello));
  // Frames without end, and not one answer read: the pipes fill, and nothing else does.
  Body body;
  const std::string frame = BareSocket::frame(0x82, daemon::frameBytes(body.next(false)));
  std::string many;
  for (int i = 0; i < 1000; ++i) many += frame;
  for (int i = 0; i < 1000 && deaf.send(many, 1.0) == many.size(); ++i) {
  }
  for (int i = 0; i < 100 && refusedOf(daemon->port(), "limit.send_seconds") != "1"; ++i) {
    std::this_thread::sleep_for(100ms);
  }
  EXPECT_EQ(refusedOf(daemon->port(), "limit.send_seconds"), "1")
      << httpGet(daemon->port(), "/metrics").body;
}

TEST(DaemonLimits, AreNotPassedByBrokenMessages) {
  const auto daemon = startDaemon();
  const unsigned short port = daemon->port();
  const auto said = [&](const std::string& request) {
    BareSocket socket(port);
    socket.send(request);
    const std::string answer = socket.readAll(5.0);
    EXPECT_TRUE(socket.endsWithin(5.0)) << request.substr(0, 40);
    return answer.substr(0, answer.find("\r\n"));
  };
  EXPECT_EQ(said("hello\r\n\r\n"), "HTTP/1.1 400 Bad Request");
  EXPECT_EQ(said(std::string(200, '\0')), "HTTP/1.1 400 Bad Request");
  EXPECT_EQ(said("GET / HTTP/1.1\r\nX: " + std::string(9000, 'x') + "\r\n\r\n"),
            "HTTP/1.1 400 Bad Request");
  EXPECT_EQ(said("POST / HTTP/1.1\r\nContent-Length: 5000\r\n\r\nx"), "HTTP/1.1 400 Bad Request");
  // Frames that WebSocket forbids, before the hello and in the middle of a session.
  for (const std::string& bytes :
       {std::string("\x81\x05hello"),                    // not masked
        BareSocket::frame(0x83, "x"),                    // no such kind
        BareSocket::frame(0xf1, "x"),                    // reserved bits
        BareSocket::frame(0x00, "x"),                    // goes on with nothing
        BareSocket::frame(0x89, std::string(126, 'x')),  // a ping too long
        BareSocket::frame(0x81, "\xff\xfe"),             // no UTF-8
        BareSocket::frame(0x88, "x")}) {                 // half a close code
    BareSocket early(port);
    ASSERT_TRUE(early.upgrade());
    early.send(bytes);
    EXPECT_TRUE(early.endsWithin(30.0));
    BareSocket late(port);
    ASSERT_TRUE(late.upgrade());
    late.send(BareSocket::frame(0x81, kHello) + bytes);
    EXPECT_TRUE(late.endsWithin(30.0));
  }
  for (const auto& [bytes, isText] : std::vector<std::pair<std::string, bool>>{
           {"{}", true},
           {"", true},
           {"", false},
           {std::string(44, 'x'), false},
           {"[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[", true}}) {
    Walker walker(port, sessionWith("none"));
    ASSERT_TRUE(walker.welcomed());
    ASSERT_TRUE(walker.client.send(bytes, isText));
    EXPECT_EQ(codeOf(walker.client.receive()), "message") << bytes;
    EXPECT_FALSE(walker.client.receive());
    EXPECT_EQ(walker.client.closeCode(), 1007u);
  }
  EXPECT_TRUE(Walker(port, sessionWith("none")).welcomed());
}

/// Everything above, again and again.
void beHostile(unsigned short port, const std::atomic<bool>& stop, std::uint64_t& attacks) {
  std::vector<std::unique_ptr<BareSocket>> halfOpen;
  for (int i = 0; i < 30; ++i) halfOpen.push_back(std::make_unique<BareSocket>(port));
  const std::string hello = BareSocket::frame(0x81, kHello);
  const std::string predictive = BareSocket::frame(
      0x81, R"({"format":"forewalk.hello/1","session":{"controller":"s2c-predictive"}})");
  std::string pings, frames;
  Body body;
  for (int i = 0; i < 400; ++i) pings += BareSocket::frame(0x89, "");
  for (int i = 0; i < 400; ++i) {
    frames += BareSocket::frame(0x82, daemon::frameBytes(body.next(false)));
  }
  const std::string attempts[] = {pings,
                                  hello + frames,
                                  BareSocket::frame(0x81, std::string(70000, 'x')),
                                  hello + BareSocket::frame(0x81, std::string(70000, ' ')),
                                  BareSocket::frame(0x01, std::string(60000, '[')),
                                  predictive,
                                  std::string("\x81\x05hello")};
  std::vector<std::unique_ptr<BareSocket>> open;
  for (std::size_t i = 0; !stop && i < 5000; ++i, ++attacks) {
    auto socket = std::make_unique<BareSocket>(port);
    if (i % 8 == 7) {
      socket->send(std::string(4000, '\0'), 0.05);
    } else if (socket->upgrade()) {
      socket->send(attempts[i % 8], 0.05);
    }
    open.push_back(std::move(socket));  // and let none of it be read
    if (open.size() > 20) open.erase(open.begin());
    std::this_thread::sleep_for(5ms);
  }
}

/// Rounds of a frame in each session, 90 a second; milliseconds of the frames.
std::vector<double> walkTogether(std::vector<Walker>& walkers, std::vector<Body>& bodies,
                                 int rounds) {
  std::vector<double> milliseconds;
  auto due = std::chrono::steady_clock::now();
  for (int round = 0; round < rounds; ++round) {
    for (std::size_t i = 0; i < walkers.size(); ++i) {
      const service::Stopwatch watch;
      const auto answer = walkers[i].frame(bodies[i].next(false));
      EXPECT_TRUE(answer) << walkers[i].last;
      if (!answer) return milliseconds;
      milliseconds.push_back(1e-3 * watch.microseconds());
    }
    std::this_thread::sleep_until(due += 11ms);
  }
  return milliseconds;
}

TEST(DaemonLimits, KeepHostileClientsFromThoseWhoWalk) {
  daemon::DaemonSettings settings;
  settings.limits.handshakeSeconds = 1.0;
  settings.limits.sendSeconds = 1.0;
  const auto daemon = startDaemon(settings);
  std::vector<Walker> walkers;
  std::vector<Body> bodies;
  for (unsigned i = 0; i < 10; ++i) {
    walkers.emplace_back(daemon->port(), sessionWith("s2c"));
    bodies.emplace_back(i);
    ASSERT_TRUE(walkers.back().welcomed());
  }
  std::vector<double> alone = walkTogether(walkers, bodies, 200);
  std::atomic<bool> stop{false};
  std::uint64_t attacks = 0;
  std::thread hostile([&] { beHostile(daemon->port(), stop, attacks); });
  std::vector<double> together = walkTogether(walkers, bodies, 400);
  stop = true;
  hostile.join();
  EXPECT_EQ(alone.size() + together.size(), 6000u);
  EXPECT_GT(attacks, 20u);
  const double p50 = service::quantile(alone, 0.5), p99 = service::quantile(alone, 0.99);
  const double p50Hostile = service::quantile(together, 0.5);
  const double p99Hostile = service::quantile(together, 0.99);
  std::printf(
      "10 sessions: p50 %.3f ms, p99 %.3f ms; beside %llu hostile connections: p50 %.3f ms, "
      "p99 %.3f ms; no frame lost\n",
      p50, p99, static_cast<unsigned long long>(attacks), p50Hostile, p99Hostile);
  // Generous, for machines with much else to do; what is measured is printed above.
  EXPECT_LT(p50Hostile, std::max(20.0, 20.0 * p50));
}

}  // namespace
}  // namespace forewalk::testing
