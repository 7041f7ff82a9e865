// forewalk serve as a process: started, killed, drained, behind nginx, under load, replayed.
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include "service/daemon/replay.h"
#include "service/timing.h"
#include "tests/service/daemon_support.h"
#include "tests/support/child.h"

namespace forewalk::testing {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;

struct Serve {
  explicit Serve(std::vector<std::string> more = {}, bool quiet = true)
      : child(arguments(std::move(more)), quiet) {
    const std::string line = child.line();
    port = static_cast<unsigned short>(std::atoi(line.c_str() + line.rfind(':') + 1));
    EXPECT_GT(port, 0) << line;
  }
  static std::vector<std::string> arguments(std::vector<std::string> more) {
    ::setenv("FOREWALK_STATE_KEY", kKey, 1);
    std::vector<std::string> all = {FOREWALK_PROGRAM, "serve", office().file};
    if (std::find(more.begin(), more.end(), "--port") == more.end())
      more.insert(more.end(), {"--port", "0"});
    all.insert(all.end(), more.begin(), more.end());
    return all;
  }
  Child child;
  unsigned short port = 0;
};

fs::path emptyFolder(const std::string& name) {
  const fs::path folder =
      fs::temp_directory_path() / ("forewalk_serve_" + name + std::to_string(::getpid()));
  fs::remove_all(folder);
  fs::create_directories(folder);
  return folder;
}

std::string textOf(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::stringstream text;
  text << in.rdbuf();
  return text.str();
}

/// A user who connects again when they are cut off, with the token of the last answer they got.
struct Traveller {
  explicit Traveller(unsigned number) : body(number) {}

  bool connect(unsigned short port) {
    walker.emplace(port, sessionWith("s2c"), token);
    return walker->client.open() && walker->welcomed();
  }
  /// A frame, and whether what the user sees moved no further than gains allow for their own step.
  bool step() {
    const daemon::Frame frame = body.next(turning);
    const auto answer = walker->frame(frame);
    if (!answer) return false;
    if (answers > 0) {
      // 1.26 times the way since the last pose that was answered, and rounding.
      const float walked = glm::distance(glm::vec2(frame.head.position.x, frame.head.position.z),
                                         glm::vec2(before.x, before.z));
      const float seen = glm::distance(glm::vec2(answer->position.x, answer->position.z),
                                       glm::vec2(seenBefore.x, seenBefore.z));
      worstJump = std::max(worstJump, seen - 1.26f * walked);
    }
    before = frame.head.position;
    seenBefore = answer->position;
    turning = answer->resetting;
    token = walker->token;
    ++answers;
    return true;
  }

  Body body;
  std::optional<Walker> walker;
  std::string token;
  bool turning = false;
  int answers = 0;
  float worstJump = 0.0f;
  glm::vec3 before{0.0f}, seenBefore{0.0f};
};

TEST(Serve, SaysWhereItListensAndEndsWithStatusZero) {
  Serve serve;
  Walker walker(serve.port, sessionWith("none"));
  ASSERT_TRUE(walker.frame(Body().next(false)));
  serve.child.signal(SIGTERM);
  EXPECT_EQ(codeOf(walker.client.receive()), "draining");
  walker.client.receive();
  EXPECT_EQ(serve.child.wait(), 0);
}

TEST(Serve, EndsWithSessionsThatDoNotLeave) {
  Serve serve({"--drain", "0.2"});
  BareSocket stubborn(serve.port);
  ASSERT_TRUE(stubborn.upgrade());
  serve.child.signal(SIGTERM);
  EXPECT_EQ(serve.child.wait(), 0);
}

TEST(Serve, RefusesWhatIsNotSafe) {
  const auto ends = [](std::vector<std::string> more) {
    return Child(Serve::arguments(std::move(more))).wait();
  };
  EXPECT_EQ(ends({"--listen", "0.0.0.0"}), 1);
  EXPECT_EQ(ends({"--inspector", "/there/is/no/such/folder"}), 1);
  EXPECT_EQ(ends({"--key-file", "/there/is/no/such/file"}), 1);
  EXPECT_EQ(ends({"--record", "/proc/no"}), 1);
  EXPECT_EQ(ends({"--max-sessions", "-1"}), 2);
}

TEST(Serve, WritesNoPoseIntoItsLog) {
  const fs::path folder = emptyFolder("log");
  const fs::path log = folder / "log";
  Child shell({"/bin/sh", "-c",
               std::string("exec ") + FOREWALK_PROGRAM + " serve " + office().file +
                   " --port 0 2>" + log.string()});
  const std::string line = shell.line();
  const auto port = static_cast<unsigned short>(std::atoi(line.c_str() + line.rfind(':') + 1));
  {
    Walker walker(port, sessionWith("none"));
    daemon::Frame frame = Body().next(false);
    frame.head.position = {1.2345678f, 1.7654321f, 0.5432109f};
    ASSERT_TRUE(walker.frame(frame));
    EXPECT_TRUE(walker.client.send("nonsense 1.2345678", true));
    walker.client.receive();
  }
  shell.signal(SIGTERM);
  EXPECT_EQ(shell.wait(), 0);
  const std::string text = textOf(log);
  for (const char* event :
       {"listening on", "session ", " begins", "ends after 1 frames", "draining", "ended"}) {
    EXPECT_NE(text.find(event), std::string::npos) << event << "\n" << text;
  }
  for (const char* pose : {"1.23", "1.76", "0.54"}) {
    EXPECT_EQ(text.find(pose), std::string::npos) << text;
  }
  fs::remove_all(folder);
}

TEST(Serve, LosesNothingButFramesUnderWayWhenItIsKilled) {
  constexpr unsigned kSessions = 50;
  auto first = std::make_unique<Serve>();
  Serve second;
  std::vector<Traveller> users;
  for (unsigned i = 0; i < kSessions; ++i) {
    users.emplace_back(i);
    ASSERT_TRUE(users.back().connect(first->port));
  }
  const auto walkAll = [&](int frames) {
    for (int i = 0; i < frames; ++i) {
      for (Traveller& user : users) {
        if (!user.walker->client.open()) continue;
        user.step();
      }
      std::this_thread::sleep_for(5ms);
    }
  };
  walkAll(150);
  // In the middle of it: some have a frame under way.
  std::thread killer([&] {
    std::this_thread::sleep_for(30ms);
    first->child.signal(SIGKILL);
  });
  walkAll(10);
  killer.join();
  EXPECT_EQ(first->child.wait(), -SIGKILL);
  walkAll(1);
  std::map<int, int> lost;
  const service::Stopwatch watch;
  for (Traveller& user : users) {
    ASSERT_FALSE(user.walker->client.open());
    ASSERT_TRUE(user.connect(second.port)) << user.walker->welcome;
    EXPECT_TRUE(user.walker->welcome["resumed"].get<bool>());
  }
  const double seconds = 1e-6 * watch.microseconds();
  walkAll(100);
  float jump = 0.0f;
  for (Traveller& user : users) {
    EXPECT_TRUE(user.walker->client.open());
    jump = std::max(jump, user.worstJump);
    const auto sent = static_cast<int>(user.body.next(false).sequence);
    ++lost[sent - user.answers];
    EXPECT_LE(sent - user.answers, 1) << "more than the frame under way";
  }
  // Virtual coordinates are floats some tens of metres from the origin.
  EXPECT_LT(jump, 1e-4f);
  std::printf("%u sessions killed and gone on in %.2f s: worst jump beyond the gains %.1e m;",
              kSessions, seconds, static_cast<double>(std::max(jump, 0.0f)));
  for (const auto& [frames, count] : lost) std::printf(" %d lost %d frames;", count, frames);
  std::printf("\n");
}

TEST(Serve, LosesATenthOfASecondOfItsRecordingsWhenItIsKilled) {
  const fs::path folder = emptyFolder("killed");
  Serve serve({"--record", folder.string()});
  Walker walker(serve.port, sessionWith("s2o"));
  ASSERT_TRUE(walker.welcomed());
  Body body;
  std::vector<std::chrono::steady_clock::time_point> answeredAt;
  for (int i = 0; i < 300; ++i) {
    ASSERT_TRUE(walker.frame(body.next(false)));
    answeredAt.push_back(std::chrono::steady_clock::now());
    std::this_thread::sleep_for(5ms);
  }
  const auto killedAt = std::chrono::steady_clock::now();
  serve.child.signal(SIGKILL);
  serve.child.wait();
  const std::string text =
      textOf(folder / (walker.welcome["session"].get<std::string>() + "-0.jsonl"));
  const auto replayed = daemon::replay(text, office().world, office().hash);
  ASSERT_TRUE(replayed) << replayed.error().message;
  EXPECT_FALSE(replayed->firstDifference);
  ASSERT_GT(replayed->frames, 0u);
  const double lost =
      replayed->frames == answeredAt.size()
          ? 0.0
          : std::chrono::duration<double>(killedAt - answeredAt[replayed->frames]).count();
  std::printf(
      "killed: %zu of %zu frames recorded, the first that is missing was answered %.0f ms "
      "before\n",
      replayed->frames, answeredAt.size(), 1e3 * lost);
  // 50 ms by design; the rest is for machines with much else to do.
  EXPECT_LE(lost, 0.1);
  // And as a command, which finds the scene by itself.
  Child replay({FOREWALK_PROGRAM, "replay",
                (folder / (walker.welcome["session"].get<std::string>() + "-0.jsonl")).string()});
  EXPECT_NE(replay.line().find("all the same to the last bit"), std::string::npos);
  EXPECT_EQ(replay.wait(), 0);
  struct stat owner {};
  ::stat((folder / (walker.welcome["session"].get<std::string>() + "-0.jsonl")).c_str(), &owner);
  EXPECT_EQ(owner.st_mode & 0777, 0600u);
  fs::remove_all(folder);
}

TEST(Serve, StandsBehindNginx) {
  const char* program = "/usr/sbin/nginx";
  if (!fs::exists(program)) GTEST_SKIP() << "there is no nginx here: apt-get install nginx-light";
  auto first = std::make_unique<Serve>();
  auto second = std::make_unique<Serve>();
  // The configuration that is shipped, with ports that are free here.
  unsigned short port = 0;
  {
    const auto free = startDaemon();
    port = free->port();
  }
  std::string site = textOf(FOREWALK_SOURCE "/service/daemon/nginx.conf");
  const auto replace = [&](const std::string& what, unsigned short with) {
    const std::string old = "127.0.0.1:" + what;
    std::size_t count = 0;
    for (std::size_t at; (at = site.find(old)) != std::string::npos; ++count) {
      site.replace(at, old.size(), "127.0.0.1:" + std::to_string(with));
    }
    EXPECT_EQ(count, 1u) << what;
  };
  replace("9101", first->port);
  replace("9102", second->port);
  replace("8080", port);
  const fs::path folder = emptyFolder("nginx");
  std::ofstream(folder / "site.conf") << site;
  std::ofstream(folder / "nginx.conf")
      << "daemon off; worker_processes 1; pid " << (folder / "pid").string() << "; error_log "
      << (folder / "error.log").string() << ";\n"
      << "events { worker_connections 256; }\nhttp { access_log off; client_body_temp_path "
      << (folder / "a").string() << "; proxy_temp_path " << (folder / "b").string()
      << "; fastcgi_temp_path " << (folder / "c").string() << "; uwsgi_temp_path "
      << (folder / "d").string() << "; scgi_temp_path " << (folder / "e").string() << "; include "
      << (folder / "site.conf").string() << "; }\n";
  Child nginx({program, "-p", folder.string(), "-c", (folder / "nginx.conf").string(), "-e",
               (folder / "error.log").string()});
  bool up = false;
  for (int i = 0; i < 200 && !up; ++i) {
    up = httpGet(port, "/healthz", {{"Connection", "close"}}).status == 200;
    if (!up) std::this_thread::sleep_for(50ms);
  }
  ASSERT_TRUE(up) << textOf(folder / "error.log");
  EXPECT_EQ(httpGet(port, "/metrics", {{"Connection", "close"}}).status, 404u);

  std::vector<Traveller> users;
  for (unsigned i = 0; i < 10; ++i) {
    users.emplace_back(i);
    ASSERT_TRUE(users.back().connect(port)) << users.back().walker->client.status();
  }
  const auto walkAll = [&](int frames) {
    for (int i = 0; i < frames; ++i) {
      for (Traveller& user : users) {
        if (user.walker->client.open()) user.step();
      }
    }
  };
  walkAll(60);
  first->child.signal(SIGKILL);
  EXPECT_EQ(first->child.wait(), -SIGKILL);
  std::size_t moved = 0;
  for (Traveller& user : users) {
    user.step();
    if (user.walker->client.open()) continue;
    ASSERT_TRUE(user.connect(port)) << user.walker->client.status() << "\n"
                                    << textOf(folder / "error.log");
    EXPECT_TRUE(user.walker->welcome["resumed"].get<bool>());
    ++moved;
  }
  EXPECT_GT(moved, 0u);
  EXPECT_LT(moved, users.size());
  walkAll(60);
  for (Traveller& user : users) {
    EXPECT_TRUE(user.walker->client.open());
    EXPECT_LT(user.worstJump, 1e-4f);
  }
  // One that drains says 503, and a new one in its place is found.
  Serve third({"--port", std::to_string(first->port)});
  second->child.signal(SIGTERM);
  EXPECT_EQ(second->child.wait(), 0);
  for (Traveller& user : users) {
    user.step();
    ASSERT_TRUE(user.connect(port)) << user.walker->client.status() << "\n"
                                    << textOf(folder / "error.log");
  }
  walkAll(10);
  for (Traveller& user : users) EXPECT_LT(user.worstJump, 1e-4f);
  nginx.signal(SIGTERM);
  nginx.wait();
  fs::remove_all(folder);
}

TEST(Serve, CarriesManySessions) {
  // The short form; README says how the long one is measured.
  Child load({FOREWALK_PROGRAM, "load", office().file, "--sessions", "10,40", "--seconds", "2",
              "--session", sessionWith("s2c")},
             false);
  std::string lines;
  for (std::string line; !(line = load.line()).empty();) lines += line + "\n";
  std::printf("%s", lines.c_str());
  EXPECT_EQ(load.wait(), 0);
  EXPECT_NE(lines.find("answers worked out again: 0 differ"), std::string::npos);
}

}  // namespace
}  // namespace forewalk::testing
