#include "rdw/trace.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <nlohmann/json.hpp>
#include <random>
#include <sstream>

#include "navmesh/random.h"

namespace forewalk::rdw {
namespace {

using ::testing::StartsWith;

std::uint64_t hashOf(const std::vector<FrameRecord>& frames) {
  TraceHash hash;
  for (const FrameRecord& frame : frames) hash.add(frame);
  return hash.value();
}

std::vector<std::vector<std::string>> rowsOf(const std::string& csv) {
  std::vector<std::vector<std::string>> rows;
  std::istringstream lines(csv);
  for (std::string line; std::getline(lines, line);) {
    std::istringstream fields(line);
    rows.emplace_back();
    for (std::string field; std::getline(fields, field, ',');) rows.back().push_back(field);
  }
  return rows;
}

TEST(TraceCsv, OfNoFramesIsTheHeader) {
  EXPECT_EQ(traceCsv({}), std::string(traceHeader()) + "\n");
}

TEST(TraceCsv, BeginsWithTheColumnsThatOthersRelyOn) {
  EXPECT_THAT(
      std::string(traceHeader()),
      StartsWith("t,virtual_x,virtual_z,virtual_heading,physical_x,physical_z,physical_heading,"
                 "translation,rotation,curvature,injected_yaw,reset,graph_nodes,predict_us,"
                 "steer_us"));
}

TEST(TraceCsv, WritesWorldAxesAndAFieldForEveryColumn) {
  FrameRecord frame;
  frame.t = 0.5;
  frame.virtualPosition = {1.0, 2.0};
  frame.physicalPosition = {-3.0, -4.0};
  frame.virtualHeading = 0.25;
  frame.gains.curvature = -0.125f;
  frame.reset = true;
  frame.graphNodes = 7;
  frame.borderDistance = -0.5;
  const auto rows = rowsOf(traceCsv(std::vector{frame, FrameRecord{}}));
  ASSERT_EQ(rows.size(), 3u);
  for (const auto& row : rows) EXPECT_EQ(row.size(), rows[0].size());
  const auto field = [&](std::size_t row, const char* column) {
    const auto at = std::find(rows[0].begin(), rows[0].end(), column) - rows[0].begin();
    return std::stod(rows[row][static_cast<std::size_t>(at)]);
  };
  EXPECT_EQ(field(1, "t"), 0.5);
  EXPECT_EQ(field(1, "virtual_x"), 1.0);
  EXPECT_EQ(field(1, "virtual_z"), -2.0);
  EXPECT_EQ(field(1, "physical_x"), -3.0);
  EXPECT_EQ(field(1, "physical_z"), 4.0);
  EXPECT_EQ(field(1, "virtual_heading"), 0.25);
  EXPECT_EQ(field(1, "translation"), 1.0);
  EXPECT_EQ(field(1, "curvature"), -0.125);
  EXPECT_EQ(field(1, "reset"), 1.0);
  EXPECT_EQ(field(1, "graph_nodes"), 7.0);
  EXPECT_EQ(field(1, "border_distance"), -0.5);
  EXPECT_FALSE(std::signbit(field(2, "virtual_z")));  // z = -y must not write "-0.000000"
}

TEST(TraceHash, NoticesEveryFieldButTheTimesSpent) {
  using Change = std::function<void(FrameRecord&)>;
  const std::uint64_t before = hashOf({FrameRecord{}});
  for (const Change& change : std::vector<Change>{
           [](FrameRecord& f) { f.t = 1e-9; }, [](FrameRecord& f) { f.virtualPosition.x = 1e-9; },
           [](FrameRecord& f) { f.virtualPosition.y = 1e-9; },
           [](FrameRecord& f) { f.virtualHeading = 1e-9; },
           [](FrameRecord& f) { f.physicalPosition.x = 1e-9; },
           [](FrameRecord& f) { f.physicalPosition.y = 1e-9; },
           [](FrameRecord& f) { f.physicalHeading = 1e-9; },
           [](FrameRecord& f) { f.gains.translation = 1.01f; },
           [](FrameRecord& f) { f.gains.rotation = 1.01f; },
           [](FrameRecord& f) { f.gains.curvature = 0.01f; },
           [](FrameRecord& f) { f.gains.bending = 1.01f; },
           [](FrameRecord& f) { f.injectedYaw = 1e-9; }, [](FrameRecord& f) { f.reset = true; },
           [](FrameRecord& f) { f.graphNodes = 1; },
           [](FrameRecord& f) { f.borderDistance = 1e-9; }}) {
    FrameRecord changed;
    change(changed);
    EXPECT_NE(hashOf({changed}), before);
  }
  FrameRecord timed;
  timed.predictMicroseconds = timed.steerMicroseconds = timed.frameMicroseconds = 3.0;
  EXPECT_EQ(hashOf({timed}), before);
  FrameRecord negativeZero;
  negativeZero.virtualHeading = -0.0;
  EXPECT_EQ(hashOf({negativeZero}), before);
}

TEST(TraceHash, DependsOnTheOrderOfFrames) {
  FrameRecord a, b;
  a.t = 1.0;
  b.t = 2.0;
  EXPECT_NE(hashOf({a, b}), hashOf({b, a}));
  EXPECT_NE(hashOf({a}), hashOf({a, a}));
}

TEST(QuantilesOf, NothingIsNothing) {
  std::vector<double> none;
  const Quantiles q = quantilesOf(none);
  EXPECT_EQ(q.median, 0.0);
  EXPECT_EQ(q.p99, 0.0);
  EXPECT_EQ(q.worst, 0.0);
}

TEST(QuantilesOf, HoldTheirShareOfTheValues) {
  std::mt19937_64 rng(5);
  for (const std::size_t n : {1u, 2u, 3u, 99u, 100u, 101u, 1000u}) {
    std::vector<double> values(n);
    for (double& value : values) value = navmesh::uniform(rng);
    std::vector<double> copy = values;
    const Quantiles q = quantilesOf(copy);
    const auto notAbove = [&](double limit) {
      return static_cast<double>(
          std::count_if(values.begin(), values.end(), [&](double v) { return v <= limit; }));
    };
    const auto below = [&](double limit) {
      return static_cast<double>(
          std::count_if(values.begin(), values.end(), [&](double v) { return v < limit; }));
    };
    const double count = static_cast<double>(n);
    EXPECT_GE(notAbove(q.median), 0.5 * count) << n;
    EXPECT_LT(below(q.median), 0.5 * count) << n;
    EXPECT_GE(notAbove(q.p99), 0.99 * count) << n;
    EXPECT_LT(below(q.p99), 0.99 * count) << n;
    EXPECT_EQ(notAbove(q.worst), count) << n;
  }
}

TEST(SummaryJson, SaysEverythingOnceAndLeavesOutTimesNobodyTook) {
  Summary summary;
  summary.controller = "s2c";
  summary.limits = gainPresets()[1].limits;
  summary.virtualMetres = 250.0;
  summary.resets = 5;
  summary.end = WalkEnd::kStuck;
  summary.seed = ~std::uint64_t{0};
  summary.traceHash = 0xabc;
  auto json = nlohmann::json::parse(summaryJson(summary));
  EXPECT_EQ(json["format"], "forewalk.summary/1");
  EXPECT_EQ(json["controller"], "s2c");
  EXPECT_EQ(json["limits"]["preset"], std::string(gainPresets()[1].name));
  EXPECT_EQ(json["resets_per_100m"], 2.0);
  EXPECT_EQ(json["metres_between_resets"], 50.0);
  EXPECT_EQ(json["stuck"], true);
  EXPECT_EQ(json["seed"], ~std::uint64_t{0});
  EXPECT_EQ(json["trace_hash"], "0000000000000abc");
  EXPECT_TRUE(json["graph_us"].is_null());

  summary.timed = true;
  summary.graphMicroseconds.median = 7.5;
  summary.limits.curvatureMax = 0.1234f;  // nobody's preset
  json = nlohmann::json::parse(summaryJson(summary));
  EXPECT_EQ(json["graph_us"]["median"], 7.5);
  EXPECT_FALSE(json["limits"].contains("preset"));
  EXPECT_EQ(json["limits"]["curvature_max"], 0.1234);
}

TEST(Summary, OfAWalkThatWentNowhereDividesByNothing) {
  const Summary summary;
  EXPECT_EQ(summary.resetsPer100Metres(), 0.0);
  EXPECT_EQ(summary.metresBetweenResets(), 0.0);
}

}  // namespace
}  // namespace forewalk::rdw
