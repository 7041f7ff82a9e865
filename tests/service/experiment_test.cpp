// Experiments: refused in one clear line before anything runs, and the same bytes however they were
// carried out: on one thread or four, in one go or after an interruption, in one process or in
// shards.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "service/experiment/campaign.h"
#include "service/experiment/report.h"
#include "service/experiment/statistics.h"
#include "service/files.h"
#include "tests/service/experiment_support.h"

namespace forewalk::service {
namespace {

using ::testing::HasSubstr;

TEST_F(ExperimentTest, TakesEveryCombinationOnce) {
  const Experiment experiment = small();
  const ExperimentPlan& plan = experiment.plan();
  EXPECT_EQ(plan.runCount(), 16u);
  std::set<std::pair<std::array<std::size_t, kAxes>, std::uint64_t>> seen;
  for (std::size_t run = 0; run < plan.runCount(); ++run) {
    seen.emplace(plan.choicesOf(run), plan.seedOf(run));
  }
  EXPECT_EQ(seen.size(), 16u);
}

TEST_F(ExperimentTest, GivesTheSameBytesOnAnyNumberOfThreads) {
  const Experiment experiment = small();
  EXPECT_TRUE(carriedOut(experiment, "one", on(1)).finished());
  EXPECT_TRUE(carriedOut(experiment, "four", on(4)).finished());
  expectSameResults("one", "four");
  const auto results = readResults(folder_ / "one");
  ASSERT_TRUE(results);
  for (const Row& row : results->rows) {
    EXPECT_FALSE(row.failed()) << row.reason;
    EXPECT_GT(row[Metric::kVirtualMetres], 19.0);
  }
}

TEST_F(ExperimentTest, GoesOnWhereItWasInterrupted) {
  const Experiment experiment = small();
  carriedOut(experiment, "whole");
  std::atomic<int> asked = 0;
  CampaignSettings settings;
  settings.threads = 1;
  settings.interrupted = [&] { return ++asked > 60; };
  const CampaignEnd stopped = carriedOut(experiment, "parts", settings);
  EXPECT_FALSE(stopped.finished());
  EXPECT_GT(stopped.done, 0u);
  // A kill in the middle of a line is the same as a kill before it.
  { std::ofstream(folder_ / "parts/rows.jsonl", std::ios::app) << R"({"run": 15, "end": "met)"; }
  const CampaignEnd end = carriedOut(experiment, "parts");
  EXPECT_TRUE(end.finished());
  EXPECT_EQ(end.before, stopped.done);
  expectSameResults("whole", "parts");
}

TEST_F(ExperimentTest, JoinsShardsToWhatOneProcessGives) {
  const Experiment experiment = small();
  carriedOut(experiment, "whole");
  std::vector<std::filesystem::path> shards;
  for (std::size_t i = 1; i <= 3; ++i) {
    CampaignSettings settings;
    settings.shard = i;
    settings.shards = 3;
    shards.push_back(folder_ / std::to_string(i));
    EXPECT_TRUE(carriedOut(experiment, std::to_string(i), settings).finished());
  }
  const auto merged = mergeShards(shards, folder_ / "merged");
  ASSERT_TRUE(merged) << merged.error().message;
  expectSameResults("whole", "merged");
  std::size_t traces = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder_ / "whole/traces")) {
    const auto name = entry.path().filename();
    EXPECT_EQ(text("whole/traces" / name), text("merged/traces" / name)) << name;
    ++traces;
  }
  EXPECT_GT(traces, 8u);

  const auto missing = mergeShards(std::vector{shards[0], shards[2]}, folder_ / "no");
  ASSERT_FALSE(missing);
  EXPECT_THAT(missing.error().message, HasSubstr("5 of 16 runs are missing: 1, 4, 7, 10, 13"));
  EXPECT_THAT(missing.error().message, HasSubstr("shard 2 of 3"));
  const auto doubled =
      mergeShards(std::vector{shards[0], shards[1], shards[2], shards[0]}, folder_ / "no");
  ASSERT_FALSE(doubled);
  EXPECT_THAT(doubled.error().message, HasSubstr("run 0 is both in"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "no"));
}

TEST_F(ExperimentTest, RecordsARunThatFailsAndGoesOn) {
  // What only shows where a room and a variant meet is not tried before.
  const auto experiment = loaded(R"(
    "walk": {"stop": {"virtual_m": 5}},
    "users": [{"name": "legs", "kind": "legs"}], "controllers": ["none"],
    "rooms": [{"name": "8 m", "rectangle": [8, 8]}, {"name": "2 m", "rectangle": [2, 2]}],
    "variants": [{"name": "middle"}, {"name": "aside", "physical_start": {"position": [3, 0]}}])");
  ASSERT_TRUE(experiment) << experiment.error().message;
  const CampaignEnd end = carriedOut(*experiment, "out");
  EXPECT_TRUE(end.finished());
  EXPECT_EQ(end.failed, 1u);
  const auto results = readResults(folder_ / "out");
  ASSERT_TRUE(results);
  const Row& row = results->rows[3];
  EXPECT_TRUE(row.failed());
  EXPECT_THAT(row.reason, HasSubstr("room 2 m"));
  EXPECT_THAT(row.reason, HasSubstr("lies outside the room"));
  EXPECT_THAT(text("out/results.csv"), HasSubstr("failed"));
}

TEST_F(ExperimentTest, RefusesBadPlansInOneLineBeforeAnythingRuns) {
  const std::string user =
      R"("users": [{"name": "u", "kind": "legs"}], "walk": {"stop": {"seconds": 1}})";
  struct Case {
    std::string rest, saying;
  };
  const Case cases[] = {
      {user + R"(, "controllers": ["s2x"])", "did you mean \"s2"},
      {user + R"(, "controlers": ["s2c"])", "did you mean \"controllers\"?"},
      {user + R"(, "rooms": [{"rectangle": [4, 4]}])", "rooms[0] needs a \"name\""},
      {user + R"(, "rooms": [{"name": "a", "rectangle": [4, 4]}, {"name": "a", "circle": 2}])",
       "rooms[1] is named \"a\", as another before it"},
      {user + R"(, "rooms": [{"name": "cupboard", "rectangle": [0.4, 3]}])",
       "room cupboard, user u): the room is nowhere more than 0.20 m from a wall"},
      {user + R"(, "rooms": ["there_is_none.txt"])", "there_is_none.txt"},
      {user + R"(, "scenes": ["there_is_none.obj"])", "there_is_none.obj"},
      {user + R"(, "seeds": 0)", "seeds is 0, it has to lie in [1, 10000000]"},
      {user + R"(, "seeds": [1, 2, 1])", "seeds: 1 is there twice"},
      {user + R"(, "seeds": 4000000, "limits": ["toolkit", "steinicke", "neth"])", "runs"},
      {user + R"(, "controllers": ["s2c-predictive"])", "needs a navmesh"},
      {R"("walk": {"seed": 3})", "walk.seed: seeds are given by the list"},
      {R"("walk": {"stop": {"seconds": 1}, "physical_start": {"position": [9, 9]}},
          "users": [{"name": "u", "kind": "legs"}])",
       "physical_start (9.00, 9.00) lies outside the room, or in an obstacle, by"},
      {R"("walk": {"stop": {"seconds": 1}}, "users": [{"name": "u", "kind": "legs", "speed_m_per_s": -1}])",
       "user.speed_m_per_s is -1, it has to lie in"},
      {R"("walk": {"stop": {"seconds": 1}}, "users": [{"name": "u", "kind": "wander"}])",
       "navmesh"},
  };
  for (const Case& c : cases) {
    const auto experiment = loaded(c.rest);
    ASSERT_FALSE(experiment) << c.rest;
    const std::string& message = experiment.error().message;
    EXPECT_THAT(message, HasSubstr(c.saying));
    EXPECT_THAT(message, HasSubstr(folder_.string())) << "the file at fault is named";
    EXPECT_EQ(message.find('\n'), message.npos) << message;
  }
}

TEST_F(ExperimentTest, DoesNotMixResultsOfDifferentPlans) {
  carriedOut(small(), "out");
  const auto other = loaded(std::string(kSmall) + R"(, "traces": "none")");
  ASSERT_TRUE(other);
  CampaignSettings settings;
  settings.out = folder_ / "out";
  settings.version = "test";
  const auto refused = other->carryOut(settings);
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().message, HasSubstr("holds results of another plan"));
}

TEST_F(ExperimentTest, SaysWhereItCannotWrite) {
  const Experiment experiment = small();
  std::ofstream(folder_ / "taken") << "a file";
  CampaignSettings settings;
  settings.out = folder_ / "taken";
  const auto refused = experiment.carryOut(settings);
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().message, HasSubstr("taken"));
}

TEST_F(ExperimentTest, RowsAreReadAsTheyWereWritten) {
  const Experiment experiment = small();
  carriedOut(experiment, "out");
  const auto results = readResults(folder_ / "out");
  ASSERT_TRUE(results);
  for (const Row& row : results->rows) {
    const auto again = parseRow(lineOf(row), "line");
    ASSERT_TRUE(again);
    EXPECT_TRUE(row.sameAs(*again));
    EXPECT_EQ(row.times, again->times);
  }
  for (const char* line :
       {"", "{}", "[1]", "{\"run\": 1, \"end\": \"metres\"}", "{\"run\": -1, \"end\": 3}"}) {
    EXPECT_FALSE(parseRow(line, "line")) << line;
  }
}

TEST_F(ExperimentTest, ReportsOnOnePageThatNeedsNoOtherFile) {
  const Experiment experiment = small();
  carriedOut(experiment, "out");
  const auto results = readResults(folder_ / "out");
  ASSERT_TRUE(results);
  const auto figures = writeReport(*results, folder_ / "out", "", folder_ / "report");
  ASSERT_TRUE(figures) << figures.error().message;
  const std::string page = text("report/index.html");
  std::size_t pictures = 0;
  for (std::size_t at = page.find("src=\""); at != page.npos; at = page.find("src=\"", at + 1)) {
    EXPECT_EQ(page.compare(at + 5, 19, "data:image/svg+xml,"), 0);
    ++pictures;
  }
  EXPECT_EQ(pictures, *figures);
  std::size_t files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder_ / "report/figures")) {
    EXPECT_GT(entry.file_size(), 0u);
    ++files;
  }
  EXPECT_EQ(files, 2 * *figures);
  const auto unknown = writeReport(*results, folder_ / "out", "s2d", folder_ / "report");
  ASSERT_FALSE(unknown);
  EXPECT_THAT(unknown.error().message, HasSubstr("it has none, s2c."));
}

// --- Statistics ---

TEST(ExperimentStatistics, IntervalIsStudents) {
  // t(0.975, 4) = 2.776445: tables.
  const std::vector<double> values{1, 2, 3, 4, 5};
  const Estimate e = estimate(values);
  EXPECT_DOUBLE_EQ(e.mean, 3.0);
  EXPECT_NEAR(e.deviation, std::sqrt(2.5), 1e-12);
  EXPECT_NEAR(e.high - e.mean, 2.776445 * std::sqrt(2.5 / 5.0), 1e-5);
  EXPECT_NEAR(e.mean - e.low, e.high - e.mean, 1e-12);
  EXPECT_TRUE(std::isnan(estimate(std::vector{1.0}).low));
  EXPECT_TRUE(std::isnan(estimate({}).mean));
}

TEST(ExperimentStatistics, SignedRankCountsAllSigns) {
  const std::vector<double> zero(6, 0.0);
  const std::vector<double> differences{1.5, -0.5, 2.5, 3.5, -4.5, 5.5};
  // Ranks 2, -1, 3, 4, -5, 6. By brute force over all 64 signs, two-sided.
  const int ranks[] = {1, 2, 3, 4, 5, 6};
  int atMost = 0;
  for (int signs = 0; signs < 64; ++signs) {
    int sum = 0;
    for (int i = 0; i < 6; ++i) sum += (signs >> i & 1) != 0 ? ranks[i] : 0;
    atMost += sum <= 6 ? 1 : 0;
  }
  const Comparison c = compare(zero, differences);
  EXPECT_NEAR(c.signedRank, 2.0 * atMost / 64.0, 1e-12);
  EXPECT_DOUBLE_EQ(compare(differences, zero).signedRank, c.signedRank);
  EXPECT_DOUBLE_EQ(compare(zero, zero).signedRank, 1.0);
  EXPECT_DOUBLE_EQ(compare(zero, zero).tTest, 1.0);
}

TEST(ExperimentStatistics, SignedRankByTheNormalIsCloseToExact) {
  std::vector<double> zero(25, 0.0), differences;
  for (int i = 1; i <= 25; ++i) differences.push_back(i % 3 == 0 ? -i : i);
  const double exact = compare(zero, differences).signedRank;
  differences.back() = differences[23] < 0 ? 24.0 : -24.0;  // a tie: now by the normal
  const double normal = compare(zero, differences).signedRank;
  EXPECT_NEAR(exact, normal, 0.12);
}

TEST(ExperimentStatistics, HolmIsMonotoneAndNoLessThanAsked) {
  const std::vector<double> p{0.04, 0.01, 0.03, 0.005};
  const std::vector<double> expected{0.06, 0.03, 0.06, 0.02};
  const std::vector<double> adjusted = holm(p);
  for (std::size_t i = 0; i < p.size(); ++i) EXPECT_NEAR(adjusted[i], expected[i], 1e-12);
}

}  // namespace
}  // namespace forewalk::service
