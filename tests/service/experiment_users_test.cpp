// Experiments with several users at once, with walks of OpenRDW, and with the quality of
// predictions measured; what goes wrong before and while they run.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <string>
#include <vector>

#include "service/files.h"
#include "tests/service/experiment_support.h"

namespace forewalk::service {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

constexpr const char* kTogether = R"(
    "walk": {"limits": "toolkit", "stop": {"virtual_m": 25}, "rate_hz": 30},
    "rooms": [{"name": "8 m", "rectangle": [8, 8]}, {"name": "L", "shape": "L", "area_m2": 70}],
    "users": [{"name": "one", "kind": "legs"},
              {"name": "three", "kind": "legs", "count": 3},
              {"name": "apart", "kind": "legs", "count": 2, "share": "world"},
              {"name": "mixed", "together": [{"kind": "circle"}, {"kind": "sawtooth"}]}],
    "controllers": ["s2c", "messinger"], "resets": ["r2g"], "seeds": 2)";

TEST_F(ExperimentTest, SeveralUsersGiveTheSameBytesOnAnyNumberOfThreads) {
  const auto experiment = loaded(kTogether);
  ASSERT_TRUE(experiment) << experiment.error().message;
  EXPECT_TRUE(carriedOut(*experiment, "one", on(1)).finished());
  EXPECT_TRUE(carriedOut(*experiment, "four", on(4)).finished());
  expectSameResults("one", "four");
  EXPECT_EQ(text("one/users.csv"), text("four/users.csv"));
  EXPECT_TRUE(std::filesystem::exists(folder_ / "one/traces" / "04-3.csv"));
}

TEST_F(ExperimentTest, ARunOfSeveralUsersIsTheSumOfThem) {
  const auto experiment = loaded(kTogether);
  ASSERT_TRUE(experiment) << experiment.error().message;
  carriedOut(*experiment, "out");
  const auto results = readResults(folder_ / "out");
  ASSERT_TRUE(results) << results.error().message;
  const std::size_t count[] = {1, 3, 2, 2};
  std::size_t lines = 0;
  for (const Row& row : results->rows) {
    ASSERT_FALSE(row.failed()) << row.reason;
    const std::size_t entry =
        results->plan.choicesOf(row.run)[static_cast<std::size_t>(Axis::kUser)];
    ASSERT_EQ(row.users.size(), count[entry]) << row.run;
    lines += row.users.size() > 1 ? row.users.size() : 0;
    double resets = 0.0, metres = 0.0, longest = 0.0, least = 1e9;
    for (const UserRow& user : row.users) {
      resets += user[Metric::kResets];
      metres += user[Metric::kVirtualMetres];
      longest = std::max(longest, user[Metric::kSeconds]);
      least = std::min(least, user[Metric::kBorderLeast]);
    }
    EXPECT_DOUBLE_EQ(row[Metric::kResets], resets);
    EXPECT_DOUBLE_EQ(row[Metric::kVirtualMetres], metres);
    EXPECT_DOUBLE_EQ(row[Metric::kResetsPer100Metres], 100.0 * resets / metres);
    EXPECT_DOUBLE_EQ(row[Metric::kSeconds], longest);
    EXPECT_DOUBLE_EQ(row[Metric::kBorderLeast], least);
    EXPECT_GT(metres, 24.0 * static_cast<double>(row.users.size()));
  }
  const std::string table = text("out/users.csv");
  EXPECT_EQ(static_cast<std::size_t>(std::count(table.begin(), table.end(), '\n')), lines + 1);
}

TEST_F(ExperimentTest, AUserAloneIsTheFirstOfSeveralWhoShareNothing) {
  // Seeds of users follow from the run's; rooms of their own, and too far apart to meet.
  const auto experiment = loaded(R"(
    "walk": {"stop": {"virtual_m": 10}, "rate_hz": 30}, "rooms": [{"name": "8 m", "rectangle": [8, 8]}],
    "users": [{"name": "one", "kind": "waypoints", "waypoints": [[0, 0, 0], [0, 0, -30]]},
              {"name": "two", "share": "world", "together": [
                {"kind": "waypoints", "waypoints": [[0, 0, 0], [0, 0, -30]]},
                {"kind": "waypoints", "waypoints": [[90, 0, 0], [90, 0, -30]]}]}],
    "controllers": ["s2c"])");
  ASSERT_TRUE(experiment) << experiment.error().message;
  carriedOut(*experiment, "out");
  const auto results = readResults(folder_ / "out");
  ASSERT_TRUE(results);
  const UserRow& alone = results->rows[0].users[0];
  const UserRow& first = results->rows[1].users[0];
  for (std::size_t i = 0; i < kMetrics; ++i) {
    if (std::isnan(alone.values[i])) continue;
    EXPECT_EQ(alone.values[i], first.values[i]) << i;
  }
}

TEST_F(ExperimentTest, WalksRecordingsAndWaypointsOfOpenRdw) {
  std::string path, times, points;
  for (int i = 0; i <= 100; ++i) {
    path += std::to_string(0.04 * i) + ", " + std::to_string(0.1 * std::sin(0.1 * i)) + "\n";
    times += "0.04\n";
  }
  write("user_virtual_positions.csv", path);
  write("sampling_intervals.csv", times);
  write("waypoints.csv", "0,0\n3,0\n3,4\n");
  write("room.txt", "4,4\n-4,4\n-4,-4\n4,-4\n\n1,1\n1,2\n2,2\n2,1\n");
  const auto experiment = loaded(R"(
    "walk": {"rate_hz": 30}, "rooms": ["room.txt"], "controllers": ["none"],
    "users": [{"name": "recorded", "kind": "recorded", "walks": "user_virtual_positions.csv",
               "intervals": "sampling_intervals.csv"},
              {"name": "waypoints", "kind": "waypoints", "waypoints": "waypoints.csv"}])");
  ASSERT_TRUE(experiment) << experiment.error().message;
  carriedOut(*experiment, "out");
  const auto results = readResults(folder_ / "out");
  ASSERT_TRUE(results);
  ASSERT_EQ(results->rows.size(), 2u);
  EXPECT_NEAR(results->rows[0][Metric::kSeconds], 4.0, 0.1);
  EXPECT_NEAR(results->rows[0][Metric::kVirtualMetres], 4.1, 0.15);
  EXPECT_NEAR(results->rows[1][Metric::kVirtualMetres], 7.0, 0.3);
  std::vector<std::string> files;
  for (const InputFile& input : results->manifest.inputs) files.push_back(input.name);
  EXPECT_THAT(files,
              ::testing::UnorderedElementsAre("room.txt", "sampling_intervals.csv",
                                              "user_virtual_positions.csv", "waypoints.csv"));
  ASSERT_EQ(results->manifest.rooms.size(), 1u);
  EXPECT_EQ(results->manifest.rooms[0].rings.size(), 2u) << "border and obstacle, for drawings";
}

TEST_F(ExperimentTest, UsersInRoomsOfTheirOwnMayHaveDifferentRooms) {
  write("hall.txt", "9,9\n-9,9\n-9,-9\n9,-9\n");
  const auto experiment = loaded(R"(
    "walk": {"stop": {"virtual_m": 40}, "rate_hz": 30}, "rooms": [{"name": "4 m", "rectangle": [4, 4]}],
    "users": [{"name": "pair", "share": "world", "together": [
                {"kind": "legs"}, {"kind": "legs", "space": "hall.txt"},
                {"kind": "legs", "space": {"rectangle": [7, 5]}}]}], "controllers": ["none"])");
  ASSERT_TRUE(experiment) << experiment.error().message;
  carriedOut(*experiment, "out");
  const auto results = readResults(folder_ / "out");
  ASSERT_TRUE(results);
  const std::vector<UserRow>& users = results->rows[0].users;
  ASSERT_EQ(users.size(), 3u);
  EXPECT_EQ(users[0][Metric::kRoomArea], 16.0);
  EXPECT_EQ(users[1][Metric::kRoomArea], 324.0);
  EXPECT_EQ(users[2][Metric::kRoomArea], 35.0);
  const auto refused = loaded(R"(
    "walk": {"stop": {"seconds": 1}}, "users": [{"name": "pair", "together": [
      {"kind": "legs"}, {"kind": "legs", "space": "hall.txt"}]}])");
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().message, HasSubstr("user.together[1].space has to be left out"));
}

TEST_F(ExperimentTest, WalksEveryPathOfTheToolkits) {
  const auto experiment = loaded(R"(
    "walk": {"limits": "toolkit", "stop": {"virtual_m": 60}, "rate_hz": 30},
    "rooms": [{"name": "trapezoid", "shape": "trapezoid", "area_m2": 60}],
    "users": [{"name": "90-degree turns", "kind": "legs"},
              {"name": "random turns", "kind": "legs", "turn": "uniform", "turn_deg": 180},
              {"name": "straight", "kind": "legs", "turn_deg": 0}, {"name": "sawtooth", "kind": "sawtooth"},
              {"name": "circle", "kind": "circle"}, {"name": "eight", "kind": "figure-eight"},
              {"name": "corridors", "kind": "corridors"}], "controllers": ["s2c"], "resets": ["r2g"])");
  ASSERT_TRUE(experiment) << experiment.error().message;
  EXPECT_EQ(carriedOut(*experiment, "out").stuck, 0u);
  const auto results = readResults(folder_ / "out");
  ASSERT_TRUE(results);
  EXPECT_EQ(results->rows.size(), 7u);
  for (const Row& row : results->rows) {
    EXPECT_FALSE(row.failed()) << row.reason;
    EXPECT_GT(row[Metric::kVirtualMetres], 59.0) << row.run;
    EXPECT_EQ(row[Metric::kViolations], 0.0) << row.run;
  }
}

TEST_F(ExperimentTest, AControllerMayBringItsResetAlong) {
  const std::string rest = R"("walk": {"stop": {"virtual_m": 60}, "rate_hz": 30},
    "users": [{"name": "legs", "kind": "legs"}], "seeds": 2,
    "rooms": [{"name": "4 m", "rectangle": [4, 4]}], )";
  const auto pairs = loaded(rest + R"("controllers": [
      {"name": "s2c, 2:1", "controller": "s2c", "reset": "two-one-turn"},
      {"name": "p2r, r2g", "controller": "p2r", "reset": "r2g"}])");
  ASSERT_TRUE(pairs) << pairs.error().message;
  EXPECT_EQ(carriedOut(*pairs, "pairs").failed, 0u);
  const auto product =
      loaded(rest + R"("controllers": ["s2c", "p2r"], "resets": ["two-one-turn", "r2g"])");
  ASSERT_TRUE(product) << product.error().message;
  carriedOut(*product, "product");
  const auto together = readResults(folder_ / "pairs"), apart = readResults(folder_ / "product");
  ASSERT_TRUE(together && apart);
  ASSERT_EQ(together->rows.size(), 4u);
  ASSERT_EQ(apart->rows.size(), 8u);
  // Each pair's walks are those of the product that have both.
  const auto walked = [](const Row& row) {
    return std::vector{row[Metric::kResets], row[Metric::kPhysicalMetres], row[Metric::kSeconds]};
  };
  for (const Row& row : together->rows) {
    EXPECT_EQ(1, std::count_if(apart->rows.begin(), apart->rows.end(),
                               [&](const Row& other) { return walked(other) == walked(row); }))
        << row.run;
  }
  EXPECT_THAT(text("pairs/results.csv"), HasSubstr("\"p2r, r2g\""));

  const auto refused = loaded(rest + R"("controllers": [{"name": "x", "controller": "s2c",
                                                         "rest": "r2g"}])");
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().message, HasSubstr("did you mean \"reset\"?"));
}

TEST_F(ExperimentTest, MeasuresPredictionsWhereTheyAreLookedAt) {
  const char* plan = R"(
    "walk": {"limits": "laboratory", "stop": {"virtual_m": 60}, "rate_hz": 30, "horizon_m": 6},
    "scenes": ["office.obj"], "rooms": [{"name": "5 m", "rectangle": [5, 5]}],
    "users": [{"name": "visitor", "kind": "wander"}], "controllers": ["s2c", "s2c-predictive"])";
  std::filesystem::copy_file(FOREWALK_ASSETS "/scenes/office.obj", folder_ / "office.obj");
  const auto used = loaded(plan);
  ASSERT_TRUE(used) << used.error().message;
  carriedOut(*used, "used");
  const auto all = loaded(std::string(plan) + R"(, "prediction_quality": "all")");
  ASSERT_TRUE(all) << all.error().message;
  carriedOut(*all, "all");
  const auto some = readResults(folder_ / "used");
  const auto every = readResults(folder_ / "all");
  ASSERT_TRUE(some && every);
  EXPECT_TRUE(std::isnan(some->rows[0][Metric::kWayInGraph])) << "nobody looked";
  const Row& row = some->rows[1];
  EXPECT_GT(row[Metric::kWaySamples], 20.0);
  EXPECT_GT(row[Metric::kWayInGraph], 0.8);
  EXPECT_LE(row[Metric::kWayInGraph], 1.0);
  EXPECT_GT(row[Metric::kWayJunctions], 5.0);
  EXPECT_GT(row[Metric::kWayNll], 0.0);
  EXPECT_GE(row[Metric::kWayRank], 1.0);
  EXPECT_GE(row[Metric::kWayFirst], 0.0);
  EXPECT_LE(row[Metric::kWayFirst], 1.0);
  EXPECT_GT(every->rows[0][Metric::kWaySamples], 20.0);
  EXPECT_TRUE(every->rows[1].sameAs(row)) << "what is measured changes no walk";
}

TEST_F(ExperimentTest, WritesWhatReadersOfOpenRdwExpect) {
  const auto experiment = loaded(kTogether);
  ASSERT_TRUE(experiment) << experiment.error().message;
  carriedOut(*experiment, "out");
  const auto results = readResults(folder_ / "out");
  ASSERT_TRUE(results);
  std::istringstream lines(text("out/openrdw.csv"));
  std::string line;
  ASSERT_TRUE(std::getline(lines, line));
  EXPECT_EQ(line, "sep=;");
  const auto cells = [](const std::string& of) {
    std::vector<std::string> found;
    std::istringstream rest(of);
    for (std::string one; std::getline(rest, one, ';');) found.push_back(one);
    return found;
  };
  for (const Row& row : results->rows) {
    ASSERT_TRUE(std::getline(lines, line));
    EXPECT_EQ(line, "TrialId = " + std::to_string(row.run) + ";EndState = Normal");
    ASSERT_TRUE(std::getline(lines, line));
    const auto header = cells(line);
    const auto column = [&](const std::string& name) {
      const auto found = std::find(header.begin(), header.end(), name);
      EXPECT_NE(found, header.end()) << name;
      return static_cast<std::size_t>(found - header.begin());
    };
    for (const UserRow& user : row.users) {
      ASSERT_TRUE(std::getline(lines, line));
      const auto values = cells(line);
      ASSERT_EQ(values.size(), header.size());
      const auto at = [&](const std::string& name) { return std::stod(values[column(name)]); };
      EXPECT_EQ(at("reset_count"), user[Metric::kResets]);
      EXPECT_EQ(at("sum_virtual_distance_travelled(IN METERS)"), user[Metric::kVirtualMetres]);
      EXPECT_NEAR(at("virtual_distance_between_resets_average") * (at("reset_count") + 1.0),
                  user[Metric::kVirtualMetres], 1e-9);
      EXPECT_LE(at("min_g_t"), at("max_g_t"));
      EXPECT_LE(std::abs(at("max_g_c")), 1.0 / 7.5 + 1e-6);
      // What was injected into the way is the difference of the two ways.
      EXPECT_NEAR(at("sum_virtual_distance_travelled(IN METERS)"),
                  at("sum_real_distance_travelled(IN METERS)"),
                  at("sum_injected_translation(IN METERS)") + 0.5);
    }
    std::getline(lines, line);
    EXPECT_EQ(line, "");
  }
}

TEST_F(ExperimentTest, RefusesUsersWhoCannotBeBeforeAnythingRuns) {
  write("wall.obj", "v 0 0 0\nv 4 0 0\nv 4 3 0\nv 0 3 0\nf 1 2 3 4\n");
  write("short.csv", "0,0\n");
  write("path.csv", "0,0\n1,0\n");
  const std::string stop = R"("walk": {"stop": {"seconds": 1}}, )";
  struct Case {
    std::string rest, saying;
  };
  const Case cases[] = {
      {stop + R"("users": [{"name": "u", "kind": "legs", "count": 17}])", "user.count is 17"},
      {stop + R"("users": [{"name": "u", "kind": "legs", "count": 2, "share": "house"}])",
       "user.share is \"house\""},
      {stop + R"("users": [{"name": "u", "together": []}])", "user.together has to be a list"},
      {stop + R"("users": [{"name": "u", "together": [{"kind": "legs", "sped": 2}]}])",
       "user.together[0].sped"},
      {stop + R"("users": [{"name": "u", "kind": "legs", "count": 9}],
                 "rooms": [{"name": "2 m", "rectangle": [2, 2]}])",
       "the room of 4.0 m^2 has no place for 9 users"},
      {R"("walk": {"stop": {"seconds": 1}, "physical_start": {"position": [0, 0]}},
          "users": [{"name": "u", "kind": "legs", "count": 2}])",
       "physical_start: is for one user"},
      {stop +
           R"("users": [{"name": "u", "kind": "recorded", "walks": "path.csv", "intervals": "short.csv"}])",
       "is no interval"},
      {stop + R"("users": [{"name": "u", "kind": "waypoints", "waypoints": "none.csv"}])",
       "none.csv"},
      {stop + R"("users": [{"name": "u", "kind": "wander"}], "scenes": ["wall.obj"])", "wall.obj"},
      {R"("walk": {"stop": {"seconds": 1}, "start": {"position": [500, 0, 0]}},
          "users": [{"name": "u", "kind": "wander"}], "scenes": ["corridor.obj"])",
       "start 500,0,0 has no walkable polygon"},
      {R"("walk": {"stop": {"seconds": 1}, "physical_start": {"position": [1.5, -1.5]}},
          "users": [{"name": "u", "kind": "legs"}],
          "rooms": [{"name": "pillar", "polygon": [[-3, -3], [3, -3], [3, 3], [-3, 3]],
                     "holes": [[[1, -1], [2, -1], [2, -2], [1, -2]]]}])",
       "lies outside the room, or in an obstacle"},
      {stop + R"("users": [{"name": "u", "kind": "legs"}], "prediction_quality": "some")",
       "prediction_quality is \"some\""},
  };
  for (const Case& c : cases) {
    const auto experiment = loaded(c.rest);
    ASSERT_FALSE(experiment) << c.rest;
    const std::string& message = experiment.error().message;
    EXPECT_THAT(message, AllOf(HasSubstr(c.saying), HasSubstr(folder_.string())));
    EXPECT_EQ(message.find('\n'), message.npos) << message;
  }
}

/// No file may grow beyond this while it lives: what a full disk does to whoever writes.
class FullDisk {
 public:
  explicit FullDisk(rlim_t bytes) {
    std::signal(SIGXFSZ, SIG_IGN);
    getrlimit(RLIMIT_FSIZE, &before_);
    rlimit full = before_;
    full.rlim_cur = bytes;
    setrlimit(RLIMIT_FSIZE, &full);
  }
  ~FullDisk() {
    setrlimit(RLIMIT_FSIZE, &before_);
    std::signal(SIGXFSZ, SIG_DFL);
  }
  FullDisk(const FullDisk&) = delete;
  FullDisk& operator=(const FullDisk&) = delete;

 private:
  rlimit before_{};
};

TEST_F(ExperimentTest, LosesNothingThatRanWhenTheDiskIsFull) {
  const auto experiment = loaded(std::string(kSmall) + R"(, "traces": "none")");
  ASSERT_TRUE(experiment);
  carriedOut(*experiment, "whole");
  CampaignSettings settings = on(1);
  settings.out = folder_ / "parts";
  settings.version = "test";
  {
    const FullDisk full(12'000);  // some rows
    const auto refused = experiment->carryOut(settings);
    ASSERT_FALSE(refused);
    EXPECT_THAT(refused.error().message, AllOf(HasSubstr("rows.jsonl: cannot be written"),
                                               HasSubstr("what is done is kept")));
  }
  const auto end = experiment->carryOut(settings);
  ASSERT_TRUE(end) << end.error().message;
  EXPECT_TRUE(end->finished());
  EXPECT_GT(end->before, 0u);
  EXPECT_LT(end->before, 16u);
  expectSameResults("whole", "parts");
}

TEST(CheckSpace, SaysHowMuchThereIs) {
  const auto temporary = std::filesystem::temp_directory_path();
  EXPECT_TRUE(checkSpace(temporary, 0));
  const auto refused = checkSpace(temporary, std::uintmax_t{1} << 62);
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().message, AllOf(HasSubstr("the disk has"), HasSubstr("are needed")));
}

// --- Metrics of frames ---

/// Frames of a walk along x at 1 m/s, 10 a second, whose gains `set` chooses.
template <typename Set>
rdw::SimulationResult straight(int frames, const Set& set) {
  rdw::SimulationResult result;
  for (int i = 0; i < frames; ++i) {
    rdw::FrameRecord& frame = result.frames.emplace_back();
    frame.t = 0.1 * i;
    frame.physicalPosition = {0.1 * i, 0.0};
    set(i, frame);
  }
  return result;
}

TEST(RowOf, CountsTheShareOfTheTimeOverTheThreshold) {
  const rdw::TrackedSpace space = *rdw::TrackedSpace::rectangle(40, 40);
  const rdw::TrackedSpace* const spaces[] = {&space};
  const auto over = [&](const rdw::SimulationResult& result) {
    return rowOf(0, {&result, 1}, spaces)[Metric::kOverThreshold];
  };
  EXPECT_EQ(over(straight(101, [](int, rdw::FrameRecord&) {})), 0.0);
  // Half of the time; twice as long in half of the other half, which is a reset and does not count.
  EXPECT_NEAR(over(straight(101,
                            [](int i, rdw::FrameRecord& frame) {
                              frame.gains.curvature = i % 2 == 0 ? 0.1f : 0.04f;
                            })),
              0.5, 1e-9);
  EXPECT_NEAR(over(straight(121,
                            [](int i, rdw::FrameRecord& frame) {
                              frame.reset = i > 100;
                              frame.gains.translation = i % 4 == 0 || frame.reset ? 1.3f : 1.2f;
                            })),
              0.25, 1e-9);
  // A rotation gain does nothing to who walks straight on.
  EXPECT_EQ(over(straight(101, [](int, rdw::FrameRecord& frame) { frame.gains.rotation = 1.5f; })),
            0.0);
}

TEST(OpenRdwValues, AreWhatTheGainsInjected) {
  const auto value = [](const OpenRdwValues& of, OpenRdwValue which) {
    return of[static_cast<std::size_t>(which)];
  };
  using V = OpenRdwValue;
  const double degrees = 180.0 / rdw::kPi;
  const auto neutral = openRdwValues(straight(101, [](int, rdw::FrameRecord&) {}).frames);
  EXPECT_EQ(value(neutral, V::kInjectedTranslation), 0.0);
  EXPECT_EQ(value(neutral, V::kInjectedByCurvature), 0.0);
  EXPECT_EQ(value(neutral, V::kTranslationMost), 1.0);
  EXPECT_TRUE(std::isnan(value(neutral, V::kRotationMost))) << "nobody turned";
  EXPECT_NEAR(value(neutral, V::kRealX), 5.0, 1e-9);

  const auto reset = openRdwValues(straight(101, [](int i, rdw::FrameRecord& frame) {
                                     // A reset turns, and is still at work in the frame it ends in.
                                     frame.reset = i >= 40 && i < 60;
                                     frame.gains.rotation = i >= 40 && i <= 60 ? 2.0f : 1.0f;
                                     frame.physicalHeading = rdw::kPi / 200.0 * i;
                                   }).frames);
  EXPECT_EQ(value(reset, V::kInjectedByRotation), 0.0);
  EXPECT_EQ(value(reset, V::kRotationMost), 1.0);

  const auto steered = openRdwValues(straight(101, [](int i, rdw::FrameRecord& frame) {
                                       frame.gains.translation = 1.25f;
                                       frame.gains.curvature = i <= 50 ? 0.1f : -0.1f;
                                       frame.gains.rotation = 1.5f;
                                       frame.physicalHeading = rdw::kPi / 200.0 * i;
                                     }).frames);
  EXPECT_NEAR(value(steered, V::kInjectedTranslation), 0.25 * 10.0, 1e-6);
  EXPECT_NEAR(value(steered, V::kInjectedByCurvature), 0.1 * 10.0 * degrees, 1e-4);
  EXPECT_NEAR(value(steered, V::kInjectedByRotation), 0.5 * 90.0, 1e-6);
  EXPECT_NEAR(value(steered, V::kCurvatureLeast), -0.1, 1e-6);
  EXPECT_NEAR(value(steered, V::kCurvatureMean), 0.1, 1e-6) << "of absolute values";
  EXPECT_NEAR(value(steered, V::kCurvatureChangeMost), 0.2 / 0.1, 1e-4);
  EXPECT_NEAR(value(steered, V::kSampleSeconds), 0.1, 1e-12);
}

}  // namespace
}  // namespace forewalk::service
