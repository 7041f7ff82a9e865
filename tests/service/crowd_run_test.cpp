// Crowds from files: refused in one clear line, walked the same on any number of threads, written
// so that others can read them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sqlite3.h>
#include <unistd.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "rdw/walk_file.h"
#include "service/crowd_config.h"
#include "service/crowd_drawing.h"
#include "service/crowd_files.h"
#include "service/crowd_models.h"
#include "service/crowd_run.h"
#include "service/files.h"
#include "service/parallel.h"
#include "tests/support/xml_fault.h"

namespace forewalk::service {
namespace {

using ::testing::HasSubstr;

tl::expected<CrowdConfig, Error> parsed(const std::string& text) {
  return parseCrowd(std::as_bytes(std::span(text.data(), text.size())), "a.json");
}

std::string file(const std::string& rest, const std::string& groups) {
  return "{\"format\": \"forewalk.crowd/1\"" + rest + ", \"groups\": [" + groups + "]}";
}

const std::string kRing =
    R"({"name": "ring", "count": 12, "start": {"ring": [1, 2], "radius_m": 4}, "goal": "opposite"})";

CrowdResult walked(const std::string& text, unsigned threads = 1) {
  const auto config = parsed(text);
  EXPECT_TRUE(config.has_value()) << config.error().message;
  CrowdRun run;
  run.record = true;
  if (threads != 1) run.forEach = onThreads(threads);
  auto result = runCrowd(*config, nullptr, 0.3f, run);
  EXPECT_TRUE(result.has_value()) << result.error().message;
  return std::move(*result);
}

TEST(CrowdConfig, RefusesInOneLineThatSaysWhatToDo) {
  struct Case {
    std::string text, saying;
  };
  const Case cases[] = {
      {"{", "a.json:1"},
      {"{}", "\"format\" is missing"},
      {file(", \"modell\": \"orca\"", kRing), "did you mean \"model\"?"},
      {file(", \"model\": \"orka\"", kRing), "did you mean \"orca\"?"},
      {file(", \"tick_s\": 0", kRing), "tick_s is 0, it has to lie in [0.001, 10]"},
      {file(", \"models\": {\"orca\": {\"mass\": 1}}", kRing), "models.orca.mass"},
      {file("", ""), "groups has to be a list of at least one"},
      {file("", R"({"start": {"points": [[0, 0]]}, "goal": "opposite"})"),
       "needs a start on a ring"},
      {file("", R"({"count": 3, "start": {"points": [[0, 0]]}})"), "list of 3 to"},
      {file("", R"({"start": "anywhere"})"), "needs a scene"},
      {file("", R"({"start": {"points": [[0, 0]]}, "goal": {"follow": "me"}})"), "no group before"},
      {file("", R"({"radius_m": [0.3, 0.2], "start": {"points": [[0, 0]]}})"), "range [low, high]"},
      {file(R"(, "obstacles": [{"circle": [0, 0], "box": [1, 1]}])", kRing), "one of circle, box"},
      {file(R"(, "obstacles": [{"circle": [0, 0], "from_s": 9, "until_s": 5}])", kRing),
       "until_s has to be later than from_s"},
      {file(R"(, "measure": {"area": [0, 0, 0, 1]})", kRing), "measure.area"},
  };
  for (const Case& one : cases) {
    const auto config = parsed(one.text);
    ASSERT_FALSE(config.has_value()) << one.text;
    EXPECT_THAT(config.error().message, HasSubstr(one.saying));
    EXPECT_EQ(config.error().message.rfind("a.json", 0), 0u) << config.error().message;
  }
}

// A corridor 2 m wide that somebody walks along, and a door in its middle, shut for a while.
TEST(CrowdRun, ADoorHoldsUpWhoComesWhileItIsShut) {
  const auto secondsWith = [](const std::string& door) {
    const CrowdResult result =
        walked(file(R"(, "seconds": 60, "room": [[-10, -1], [10, -1], [10, 1], [-10, 1]],
                  "obstacles": [)" +
                        door + "]",
                    R"({"start": {"points": [[-9, 0]]}, "goal": {"points": [[9, 0]]}})"));
    for (std::size_t frame = 0; frame < result.recording.frames(); ++frame) {
      // Nobody is in the shut door: it is 0.2 m thick.
      const double seconds = 0.1 * static_cast<double>(frame);
      const float x = result.recording.at(frame, 0).plan.x;
      if (door.find("30") != std::string::npos && seconds > 2.1 && seconds < 29.9) {
        EXPECT_LT(x, 0.0f) << seconds;
      }
    }
    return result.metrics.arrived == 1 ? result.metrics.arrivals.front() : 1e9;
  };
  const double open = secondsWith("");
  EXPECT_LT(open, 16.0);
  const std::string wall = R"({"box": [0, 0], "size": [0.2, 2.2])";
  EXPECT_EQ(secondsWith(wall + "}"), 1e9);
  const double held = secondsWith(wall + R"(, "from_s": 2, "until_s": 30})");
  EXPECT_GT(held, 30.0);
  EXPECT_LT(held, 30.0 + open);
  // Shut before anybody comes, or after.
  EXPECT_EQ(secondsWith(wall + R"(, "until_s": 1})"), open);
  EXPECT_EQ(secondsWith(wall + R"(, "from_s": 40})"), open);
}

TEST(CrowdConfig, RefusesAnAreaThatIsTooSmall) {
  const auto config =
      parsed(file("", R"({"name": "many", "count": 50, "start": {"area": [0, 0, 1, 1]}})"));
  ASSERT_TRUE(config.has_value());
  const auto result = runCrowd(*config, nullptr, 0.3f);
  ASSERT_FALSE(result.has_value());
  EXPECT_THAT(result.error().message, HasSubstr("groups[0] \"many\": no room"));
}

TEST(CrowdRun, ArrivesWithEveryModelAndTheSameOnAnyNumberOfThreads) {
  for (const RegisteredModel& model : registeredModels()) {
    const std::string text = file(", \"model\": \"" + std::string(model.name) + "\"", kRing);
    const CrowdResult one = walked(text), four = walked(text, 4);
    EXPECT_EQ(one.metrics.arrived, 12u) << model.name;
    EXPECT_EQ(one.metrics.collisions, 0u) << model.name;
    EXPECT_EQ(one.metrics.hash, four.metrics.hash) << model.name;
    EXPECT_EQ(metricsJson(one.metrics), metricsJson(four.metrics)) << model.name;
    for (const double share : one.metrics.efficiency) {
      EXPECT_GT(share, 0.5) << model.name;
      EXPECT_LE(share, 1.0) << model.name;
    }
  }
}

TEST(CrowdRun, WalksStraightWhenAlone) {
  const CrowdResult result = walked(
      file("", R"({"start": {"points": [[0, 0]]}, "goal": {"points": [[13, 0]]}, "depart_s": 2})"));
  ASSERT_EQ(result.metrics.arrivals.size(), 1u);
  EXPECT_NEAR(result.metrics.arrivals[0], (13.0 - 0.5) / 1.3, 0.3);
  EXPECT_GT(result.metrics.efficiency.at(0), 0.999);
  EXPECT_EQ(result.recording.at(19, 0).plan, glm::vec2(0.0f));  // until it departs
}

TEST(CrowdRun, VisitsInOrderFollowsAndLeavesHumansTheirWay) {
  const CrowdResult result = walked(
      file(", \"seconds\": 20",
           R"({"name": "user", "human": true, "speed_m_per_s": 1, "start": {"points": [[0, 0]]},
          "goal": {"visit": [[5, 0], [5, -5]], "loop": true}},
         {"start": {"points": [[-2, 0]]}, "goal": {"follow": "user", "distance_m": 1}})"));
  const CrowdRecording& recording = result.recording;
  float farthest = 0.0f;
  for (std::size_t frame = 0; frame < recording.frames(); ++frame) {
    const CrowdSample& user = recording.at(frame, 0);
    EXPECT_LE(user.speed, 1.001f);
    farthest = std::max(farthest, user.plan.y);
    if (frame > 60) {
      EXPECT_LT(glm::distance(user.plan, recording.at(frame, 1).plan), 3.5f) << frame;
    }
  }
  EXPECT_NEAR(farthest, 5.0f, 0.6f);  // z = -5
}

TEST(CrowdFiles, TrajectoriesAreWalksThatOtherVerbsRead) {
  const CrowdResult result = walked(file(", \"seconds\": 3", kRing));
  const auto config = parsed(file("", kRing));
  const std::string csv = trajectoriesCsv(result.recording, *config);
  const auto walks = rdw::parseWalks(std::as_bytes(std::span(csv.data(), csv.size())), "csv");
  ASSERT_TRUE(walks.has_value()) << walks.error().message;
  ASSERT_EQ(walks->size(), 12u);
  ASSERT_EQ(walks->at(3).samples.size(), result.recording.frames());
  const glm::dvec2 read = walks->at(3).samples[7].plan;
  EXPECT_LT(glm::distance(read, glm::dvec2(result.recording.at(7, 3).plan)), 1e-5);
}

TEST(CrowdFiles, DatabaseHasJuPedSimsTables) {
  const CrowdResult result =
      walked(file(R"(, "seconds": 2, "room": [[-9, -9], [9, -9], [9, 9], [-9, 9]],
              "obstacles": [{"box": [-7, -7], "size": [1, 1]}])",
                  kRing));
  const std::filesystem::path path = std::filesystem::temp_directory_path() /
                                     ("forewalk_crowd_" + std::to_string(getpid()) + ".db");
  for (int twice = 0; twice < 2; ++twice) {  // the second replaces the first
    const auto written = writeTrajectoryDatabase(path, result.recording, result.walls);
    ASSERT_TRUE(written.has_value()) << written.error().message;
  }
  sqlite3* database = nullptr;
  ASSERT_EQ(sqlite3_open(path.string().c_str(), &database), SQLITE_OK);
  const auto answer = [&](const char* sql) {
    sqlite3_stmt* statement = nullptr;
    std::string text;
    if (sqlite3_prepare_v2(database, sql, -1, &statement, nullptr) != SQLITE_OK) {
      return std::string(sqlite3_errmsg(database));
    }
    if (sqlite3_step(statement) == SQLITE_ROW) {
      text = reinterpret_cast<const char*>(sqlite3_column_text(statement, 0));
    }
    sqlite3_finalize(statement);
    return text;
  };
  EXPECT_EQ(answer("SELECT value FROM metadata WHERE key = 'version'"), "2");
  EXPECT_EQ(answer("SELECT value FROM metadata WHERE key = 'fps'"), "10");
  EXPECT_EQ(answer("SELECT count(*) FROM trajectory_data"),
            std::to_string(result.recording.samples.size()));
  EXPECT_EQ(answer("SELECT count(*) FROM frame_data JOIN geometry ON geometry_hash = hash"),
            std::to_string(result.recording.frames()));
  EXPECT_EQ(
      answer("SELECT abs(pos_x - 5) < 1e-4 AND abs(pos_y + 2) < 1e-4 AND abs(ori_x + 1) < 1e-4 "
             "FROM trajectory_data WHERE frame = 0 AND id = 0"),
      "1");
  EXPECT_THAT(answer("SELECT wkt FROM geometry"), ::testing::StartsWith("POLYGON (("));
  EXPECT_THAT(answer("SELECT wkt FROM geometry"), HasSubstr("), ("));  // the box is a hole
  sqlite3_close(database);
  std::filesystem::remove(path);
}

TEST(CrowdFiles, DiagramKeepsTheMeans) {
  const std::vector<DensitySample> samples{{0.1f, 1.0f}, {0.2f, 2.0f}, {1.0f, 0.5f}};
  const auto rows = fundamentalDiagram(samples);
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_NEAR(rows[0].density, 0.15, 1e-6);
  EXPECT_NEAR(rows[0].speed, 1.5, 1e-6);
  EXPECT_NEAR(rows[0].flow, 0.25, 1e-6);
  EXPECT_EQ(rows[1].samples, 1u);
}

TEST(CrowdDrawing, IsSoundXmlThatMovesEverybody) {
  const std::string text = file(", \"seconds\": 3, \"walls\": [[[-9, 9], [9, 9]]]",
                                R"({"name": "a <b> & c", "count": 5,
                                    "start": {"ring": [0, 0], "radius_m": 4}, "goal": "opposite"})");
  const CrowdResult result = walked(text);
  const auto config = parsed(text);
  const std::string plan = crowdPlan(result, *config, nullptr, "A <plan>", "& more");
  const std::string moving = animateCrowd(result, *config, nullptr, {}, "A <plan>", "& more");
  EXPECT_EQ(testing::faultOf(plan), "");
  EXPECT_EQ(testing::faultOf(moving), "");
  std::size_t count = 0;
  for (std::size_t at = moving.find("<animateTransform"); at != moving.npos;
       at = moving.find("<animateTransform", at + 1)) {
    ++count;
  }
  EXPECT_EQ(count, 5u);
}

TEST(CrowdAssets, AreReadAndHaveWhoTheySay) {
  struct Case {
    const char* name;
    std::uint32_t agents, humans;
  };
  for (const Case one :
       {Case{"circle", 50, 0}, Case{"city_block", 18, 3}, Case{"campus_tour", 18, 2}}) {
    const std::filesystem::path path =
        std::filesystem::path(FOREWALK_ASSETS) / "crowds" / (std::string(one.name) + ".json");
    const auto config = parseCrowd(*readFile(path), one.name);
    ASSERT_TRUE(config.has_value()) << config.error().message;
    std::uint32_t agents = 0, humans = 0;
    for (const CrowdGroup& group : config->groups) (group.human ? humans : agents) += group.count;
    EXPECT_EQ(agents, one.agents) << one.name;
    EXPECT_EQ(humans, one.humans) << one.name;
  }
}

}  // namespace
}  // namespace forewalk::service
