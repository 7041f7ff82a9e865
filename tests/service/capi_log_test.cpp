// What the log function is told.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "tests/service/capi_support.h"

namespace forewalk {
namespace {

using ::testing::HasSubstr;

struct Line {
  forewalk_log_level level;
  std::string text;
};

/// Listens while it lives.
class Log {
 public:
  explicit Log(forewalk_log_level most) {
    forewalk_set_log(
        [](void* user, forewalk_log_level level, const char* message) {
          static_cast<Log*>(user)->lines.push_back({level, message});
        },
        this, most);
  }
  Log(const Log&) = delete;
  Log& operator=(const Log&) = delete;
  ~Log() { forewalk_set_log(nullptr, nullptr, FOREWALK_LOG_OFF); }

  std::size_t count(const std::string& part) const {
    return static_cast<std::size_t>(
        std::count_if(lines.begin(), lines.end(),
                      [&](const Line& line) { return line.text.find(part) != std::string::npos; }));
  }

  std::vector<Line> lines;
};

navmesh::Scene plain() { return testing::BlockScene("plain").floor({-30, -30, 30, 30}).scene(); }

TEST(CapiLog, HearsEveryRefusalAsTheCallerDoes) {
  const Log log(FOREWALK_LOG_ERROR);
  forewalk_navmesh* navmesh = nullptr;
  forewalk_navmesh_from_file("no-such-file.obj", nullptr, &navmesh);
  ASSERT_EQ(log.lines.size(), 1u);
  EXPECT_EQ(log.lines[0].level, FOREWALK_LOG_ERROR);
  EXPECT_EQ(log.lines[0].text, forewalk_last_error());
  forewalk_frame(nullptr, {}, {}, 0.0, nullptr);
  ASSERT_EQ(log.lines.size(), 2u);
  EXPECT_EQ(log.lines[1].text, forewalk_last_error());
  testing::makeNavMesh(plain());  // went well: nothing to say at this level
  EXPECT_EQ(log.lines.size(), 2u);
}

TEST(CapiLog, HearsWhatIsMadeAndEveryReset) {
  const Log log(FOREWALK_LOG_INFO);
  const auto navmesh = testing::makeNavMesh(plain());
  EXPECT_EQ(log.count("navmesh: "), 1u);
  const auto session = testing::makeSession(navmesh, testing::defaultSettings());
  EXPECT_EQ(log.count("made, with controller s2c-predictive and a horizon of 10 m."), 1u);
  forewalk_frame_out out{};
  for (const testing::TimedHead& head : testing::wander(3, 4000)) {
    out = testing::frame(session, head);
  }
  ASSERT_GT(out.reset_count, 1u);
  EXPECT_EQ(log.count(" begins."), out.reset_count);
  EXPECT_EQ(log.count(" ends."), out.reset_count - (out.resetting != 0 ? 1u : 0u));
  for (const Line& line : log.lines) {
    EXPECT_FALSE(line.text.empty());
    EXPECT_NE(line.text.back(), '\n');
    EXPECT_EQ(line.text.back(), '.') << line.text;
  }
}

TEST(CapiLog, HearsOfTroubleOnce) {
  const auto navmesh = testing::makeNavMesh(plain());
  const auto session = testing::makeSession(navmesh, testing::defaultSettings());
  const Log log(FOREWALK_LOG_WARNING);
  testing::TimedHead head{{{0.0f, 1.7f, 0.0f}, glm::quat(1, 0, 0, 0)}, 0.0};
  testing::frame(session, head);
  EXPECT_TRUE(log.lines.empty());
  for (int lost = 0; lost < 50; ++lost) {
    head.seconds += 0.01;
    head.pose.position.x = std::numeric_limits<float>::quiet_NaN();
    testing::frame(session, head);
  }
  EXPECT_EQ(log.count("a position was not finite"), 1u);
  head.seconds += 0.01;
  head.pose.position.x = 0.0f;
  testing::frame(session, head);
  head.seconds += 0.01;
  head.pose.position.x = std::numeric_limits<float>::quiet_NaN();
  testing::frame(session, head);
  EXPECT_EQ(log.count("a position was not finite"), 2u);  // it had been well in between
}

TEST(CapiLog, IsQuietWhenItIsOff) {
  Log log(FOREWALK_LOG_OFF);
  forewalk_frame(nullptr, {}, {}, 0.0, nullptr);
  EXPECT_TRUE(log.lines.empty());
}

}  // namespace
}  // namespace forewalk
