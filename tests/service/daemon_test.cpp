// The daemon over real sockets: sessions, tokens, pages, recordings, the way out.
#include "service/daemon/daemon.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <limits>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include "navmesh/build/fwmesh.h"
#include "service/daemon/replay.h"
#include "tests/service/daemon_support.h"

namespace forewalk::testing {
namespace {

namespace fs = std::filesystem;

fs::path emptyFolder(const std::string& name) {
  const fs::path folder =
      fs::temp_directory_path() / ("forewalk_daemon_" + name + std::to_string(::getpid()));
  fs::remove_all(folder);
  fs::create_directories(folder);
  return folder;
}

TEST(Daemon, AnswersAsASessionOfOurOwn) {
  const auto daemon = startDaemon();
  for (const char* controller : {"none", "s2o", "s2c-predictive"}) {
    Walker walker(daemon->port(), sessionWith(controller));
    ASSERT_TRUE(walker.welcomed()) << walker.welcome;
    EXPECT_FALSE(walker.welcome["resumed"].get<bool>());
    EXPECT_EQ(walker.welcome["navmesh"], daemon::textOf(office().hash));
    rdw::Session ours = ourSession(sessionWith(controller));
    Body body;
    for (int i = 0; i < 300; ++i) {
      const daemon::Frame frame = body.next(ours.result().reset.turning);
      const daemon::Answer expected =
          daemon::answerOf(frame.sequence, ours.frame(frame.head, frame.seconds));
      if (i % 3 != 0) {
        const auto answer = walker.frame(frame);
        ASSERT_TRUE(answer) << walker.last;
        ASSERT_EQ(*answer, expected) << controller << " " << i;
      } else {
        ASSERT_TRUE(walker.client.send(daemon::frameText(frame), true));
        const auto json = nlohmann::json::parse(walker.client.receive().value_or("{}"));
        EXPECT_TRUE(walker.client.receivedText());
        std::string text;
        daemon::appendAnswerText(expected, *daemon::fromBase64Url(json.value("token", "")), {},
                                 text);
        ASSERT_EQ(json, nlohmann::json::parse(text)) << controller << " " << i;
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(4));  // below the limit of the rate
    }
  }
}

TEST(Daemon, DrawsTheGraphForWhoAsks) {
  const auto daemon = startDaemon();
  Walker walker(daemon->port(), "{\"predict_always\":true," + kStart + "}");
  ASSERT_TRUE(walker.welcomed());
  daemon::Frame frame = Body().next(false);
  frame.graph = true;
  ASSERT_TRUE(walker.client.send(daemon::frameText(frame), true));
  const auto json = nlohmann::json::parse(walker.client.receive().value_or("{}"));
  EXPECT_EQ(json["graph"]["format"], "forewalk.prediction/1");
  EXPECT_EQ(json["graph"]["nodes"].size(), json["graph_nodes"].get<std::size_t>());
}

TEST(Daemon, AnswersInOrderHoweverManyAreUnderWay) {
  const auto daemon = startDaemon();
  std::vector<Walker> walkers;
  for (unsigned i = 0; i < 8; ++i) walkers.emplace_back(daemon->port(), sessionWith("s2c"));
  constexpr unsigned kFrames = 200;
  for (Walker& walker : walkers) {
    Body body;
    for (unsigned i = 0; i < kFrames; ++i) {
      ASSERT_TRUE(walker.client.send(daemon::frameBytes(body.next(false)), false));
    }
  }
  for (Walker& walker : walkers) {
    for (unsigned i = 0; i < kFrames; ++i) {
      const std::string bytes = walker.client.receive().value_or("");
      const auto read = daemon::parseAnswerBytes(bytes);
      ASSERT_TRUE(read) << bytes;
      EXPECT_EQ(read->answer.sequence, i);
    }
  }
}

TEST(Daemon, GoesOnWhereAnotherOneStopped) {
  // Without a controller the whole state is in the token: to the bit the same walk, whoever serves
  // it, dropped at any frame, in the middle of resets too.
  const auto one = startDaemon(), other = startDaemon();
  rdw::Session ours = ourSession(sessionWith("none"));
  Body body;
  std::string token;
  int frames = 0;
  bool droppedInReset = false;
  for (int part = 0; part < 9; ++part) {
    Walker walker((part % 2 == 0 ? one : other)->port(), sessionWith("none"), token);
    ASSERT_TRUE(walker.welcomed()) << walker.welcome;
    EXPECT_EQ(walker.welcome["resumed"].get<bool>(), part > 0);
    for (int i = 0; i < 110; ++i, ++frames) {
      const daemon::Frame frame = body.next(ours.result().reset.turning);
      const auto answer = walker.frame(frame);
      ASSERT_TRUE(answer) << walker.last;
      ASSERT_EQ(*answer, daemon::answerOf(frame.sequence, ours.frame(frame.head, frame.seconds)))
          << "part " << part << " frame " << i;
    }
    droppedInReset = droppedInReset || ours.result().reset.turning;
    token = walker.token;
    walker.client.drop();
  }
  EXPECT_GE(ours.result().resetCount, 2u);
  EXPECT_TRUE(droppedInReset);
}

TEST(Daemon, RefusesTokensThatAreNotItsOwn) {
  daemon::DaemonSettings settings;
  settings.stateKey = "another key that is long enough 12345";
  const auto one = startDaemon(), other = startDaemon(settings);
  Walker walker(one->port(), sessionWith("none"));
  ASSERT_TRUE(walker.frame(Body().next(false)));
  EXPECT_EQ(Walker(other->port(), sessionWith("none"), walker.token).error(), "token");
  std::string changed = walker.token;
  changed[40] = changed[40] == 'A' ? 'B' : 'A';
  Walker refused(one->port(), sessionWith("none"), changed);
  EXPECT_EQ(refused.error(), "token");
  EXPECT_FALSE(refused.client.receive());
  EXPECT_EQ(refused.client.closeCode(), 1008u);
  EXPECT_EQ(Walker(one->port(), sessionWith("none"), "!").error(), "token");
  EXPECT_TRUE(Walker(one->port(), sessionWith("none"), walker.token).welcomed());
}

TEST(Daemon, SaysWhatIsWrongWithAHello) {
  const auto daemon = startDaemon();
  EXPECT_EQ(Walker(daemon->port(), "{\"controller\":\"s3c\"}").error(), "message");
  EXPECT_EQ(Walker(daemon->port(), R"({"start":{"position":[1000,0,0]}})").error(), "settings");
  Walker predictive(daemon->port(), sessionWith("s2c"));
  EXPECT_TRUE(predictive.welcomed()) << "and goes on serving";
}

TEST(Daemon, ServesHealthMetricsAndPages) {
  const fs::path folder = emptyFolder("pages");
  fs::create_directories(folder / "assets");
  std::ofstream(folder / "index.html") << "<p>inspector</p>";
  std::ofstream(folder / "assets" / "main.js") << "run()";
  std::ofstream(folder / ".secret.html") << "hidden";
  std::ofstream(folder / "key") << "no type";
  daemon::DaemonSettings settings;
  settings.pages = daemon::loadPages(folder).value();
  fs::remove_all(folder);  // served from memory
  const auto daemon = startDaemon(settings);
  const unsigned short port = daemon->port();
  EXPECT_EQ(httpGet(port, "/healthz").body, "ok\n");
  EXPECT_EQ(httpGet(port, "/").body, "<p>inspector</p>");
  EXPECT_EQ(httpGet(port, "/index.html?x=1").body, "<p>inspector</p>");
  const HttpAnswer script = httpGet(port, "/assets/main.js");
  EXPECT_EQ(script.body, "run()");
  EXPECT_NE(script.head.find("text/javascript"), std::string::npos);
  EXPECT_NE(script.head.find("nosniff"), std::string::npos);
  EXPECT_EQ(httpGet(port, "/", {}, "HEAD").body, "");
  for (const char* target : {"/.secret.html", "/key", "/../../etc/passwd", "/%2e%2e/etc/passwd",
                             "//etc/passwd", "/assets"}) {
    EXPECT_EQ(httpGet(port, target).status, 404u) << target;
  }
  EXPECT_EQ(httpGet(port, "/", {}, "POST").status, 405u);
  EXPECT_EQ(httpGet(port, "/v1/session").status, 426u);

  Walker walker(port, sessionWith("none"));
  ASSERT_TRUE(walker.frame(Body().next(false)));
  std::string metrics;
  for (int tries = 0; tries < 500; ++tries) {  // a frame is counted once its answer is written
    metrics = httpGet(port, "/metrics").body;
    if (metrics.find("\nforewalk_frames_total 1\n") != std::string::npos) break;
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  for (const char* line : {"forewalk_sessions 1", "forewalk_frames_total 1",
                           "forewalk_refused_total{code=\"request\"} 8", "forewalk_draining 0"}) {
    EXPECT_NE(metrics.find(std::string("\n") + line + "\n"), std::string::npos) << line << "\n"
                                                                                << metrics;
  }
}

TEST(Daemon, ServesTheNavMeshThatSessionsWalkIn) {
  const std::vector<std::byte> fwmesh =
      navmesh::saveFwmesh(service::loadNavMesh(office().file).value());
  daemon::DaemonSettings settings;
  settings.fwmesh.assign(reinterpret_cast<const char*>(fwmesh.data()), fwmesh.size());
  settings.access.token = "0123456789abcdef";
  const auto daemon = startDaemon(settings);
  const Headers token = {{"Authorization", "Bearer 0123456789abcdef"}};
  const HttpAnswer answer = httpGet(daemon->port(), "/v1/navmesh", token);
  EXPECT_EQ(answer.status, 200u);
  EXPECT_EQ(daemon::hashOf(std::as_bytes(std::span(answer.body))), office().hash);
  EXPECT_EQ(httpGet(daemon->port(), "/v1/navmesh", token, "HEAD").body, "");
  EXPECT_EQ(httpGet(daemon->port(), "/v1/navmesh").status, 401u);
  EXPECT_EQ(httpGet(startDaemon()->port(), "/v1/navmesh").status, 404u) << "of a daemon without";
}

TEST(Daemon, SaysPlainlyThatThereIsNoInspector) {
  const auto daemon = startDaemon();
  const HttpAnswer answer = httpGet(daemon->port(), "/");
  EXPECT_EQ(answer.status, 404u);
  EXPECT_NE(answer.body.find("--inspector"), std::string::npos);
  const auto missing = daemon::loadPages("/there/is/no/such/folder");
  ASSERT_FALSE(missing);
  EXPECT_NE(missing.error().message.find("/there/is/no/such/folder"), std::string::npos);
  const fs::path folder = emptyFolder("no_index");
  EXPECT_FALSE(daemon::loadPages(folder));
  fs::remove_all(folder);
}

TEST(Daemon, LetsOnlyThoseInWhoMay) {
  daemon::DaemonSettings settings;
  settings.access.token = "0123456789abcdef";
  settings.access.origins = {"https://lab.example.org"};
  const auto daemon = startDaemon(settings);
  const unsigned short port = daemon->port();
  const auto status = [&](const Headers& headers) { return WebClient(port, headers).status(); };
  EXPECT_EQ(status({}), 401u);
  EXPECT_EQ(status({{"Authorization", "Bearer 0123456789abcdee"}}), 401u);
  EXPECT_EQ(status({{"Authorization", "Bearer 0123456789abcdef"}}), 101u);
  EXPECT_EQ(status({{"Authorization", "Bearer 0123456789abcdef"},
                    {"Origin", "https://evil.example.org"}}),
            403u);
  WebClient browser(port, {{"Sec-WebSocket-Protocol", "forewalk.1, token.0123456789abcdef"},
                           {"Origin", "https://lab.example.org"}});
  EXPECT_EQ(browser.status(), 101u);
  EXPECT_EQ(browser.header("Sec-WebSocket-Protocol"), "forewalk.1");
  EXPECT_EQ(
      status({{"Authorization", "Bearer 0123456789abcdef"}, {"Sec-WebSocket-Protocol", "chat"}}),
      400u);
  EXPECT_EQ(httpGet(port, "/metrics").status, 401u);
  EXPECT_EQ(httpGet(port, "/metrics", {{"Authorization", "Bearer 0123456789abcdef"}}).status, 200u);
  EXPECT_EQ(httpGet(port, "/healthz").status, 200u);
}

TEST(Daemon, RefusesAddressesBeyondTheMachineWithoutAToken) {
  daemon::DaemonSettings settings;
  settings.access.address = "0.0.0.0";
  const auto started = daemon::Daemon::start(office().world, office().hash, settings);
  ASSERT_FALSE(started);
  EXPECT_NE(started.error().message.find("0.0.0.0"), std::string::npos);
  settings = {};
  settings.stateKey = "short";
  EXPECT_FALSE(daemon::Daemon::start(office().world, office().hash, settings));
  const auto first = startDaemon();
  settings = {};
  settings.access.port = first->port();
  const auto second = daemon::Daemon::start(office().world, office().hash, settings);
  ASSERT_FALSE(second);
  EXPECT_NE(second.error().message.find(std::to_string(first->port())), std::string::npos);
}

TEST(Daemon, TellsSessionsToGoOnElsewhereWhenItEnds) {
  const auto daemon = startDaemon(), next = startDaemon();
  std::vector<Walker> walkers;
  std::vector<Body> bodies;
  for (unsigned i = 0; i < 10; ++i) {
    walkers.emplace_back(daemon->port(), sessionWith("none"));
    bodies.emplace_back(i);
    ASSERT_TRUE(walkers.back().frame(bodies.back().next(false)));
  }
  std::thread ends([&] { daemon->drain(); });
  for (Walker& walker : walkers) {
    EXPECT_EQ(codeOf(walker.client.receive()), "draining");
    EXPECT_FALSE(walker.client.receive());
    EXPECT_EQ(walker.client.closeCode(), 1001u);
  }
  ends.join();
  EXPECT_EQ(httpGet(daemon->port(), "/healthz").status, 0u);
  for (unsigned i = 0; i < walkers.size(); ++i) {
    Walker again(next->port(), sessionWith("none"), walkers[i].token);
    EXPECT_TRUE(again.welcomed());
    EXPECT_TRUE(again.frame(bodies[i].next(false)));
  }
}

TEST(Daemon, RecordsWhatReplaysToTheLastBit) {
  const fs::path folder = emptyFolder("recordings");
  daemon::DaemonSettings settings;
  settings.recordings = folder;
  auto daemon = startDaemon(settings);
  Body body;
  std::string token, id;
  for (int part = 0; part < 2; ++part) {
    Walker walker(daemon->port(), sessionWith("s2o"), token);
    ASSERT_TRUE(walker.welcomed());
    id = walker.welcome["session"];
    bool turning = false;
    for (int i = 0; i < 240; ++i) {
      daemon::Frame frame = body.next(turning);
      // Odd input is recorded and replayed as it was.
      if (i == 50) frame.head.position.x = std::numeric_limits<float>::quiet_NaN();
      if (i == 60) frame.head.orientation = {0, 0, 0, 0};
      if (i == 70) frame.seconds = std::numeric_limits<double>::infinity();
      const auto answer = walker.frame(frame);
      ASSERT_TRUE(answer);
      turning = answer->resetting;
    }
    token = walker.token;
  }
  daemon.reset();
  for (int part = 0; part < 2; ++part) {
    const fs::path file = folder / (id + "-" + std::to_string(part) + ".jsonl");
    const auto bytes = service::readFile(file);
    ASSERT_TRUE(bytes) << bytes.error().message;
    std::string text(reinterpret_cast<const char*>(bytes->data()), bytes->size());
    EXPECT_EQ(text.find(token.substr(0, 60)), std::string::npos);
    const auto replayed = daemon::replay(text, office().world, office().hash);
    ASSERT_TRUE(replayed) << replayed.error().message;
    EXPECT_EQ(replayed->frames, 240u);
    EXPECT_FALSE(replayed->firstDifference) << replayed->recorded << "\n" << replayed->replayed;
    // A last line that is cut off is left out, another number is found.
    const auto cut =
        daemon::replay(text.substr(0, text.size() - 30), office().world, office().hash);
    ASSERT_TRUE(cut);
    EXPECT_EQ(cut->frames, 239u);
    EXPECT_GT(cut->cutOff, 0u);
    const std::size_t at = text.rfind("\"flags\":");
    text.replace(at, 9, "\"flags\":9");
    const auto changed = daemon::replay(text, office().world, office().hash);
    ASSERT_TRUE(changed);
    EXPECT_EQ(changed->firstDifference, 241u);
    EXPECT_FALSE(daemon::replay(text, office().world, {}));
  }
  fs::remove_all(folder);
}

}  // namespace
}  // namespace forewalk::testing
