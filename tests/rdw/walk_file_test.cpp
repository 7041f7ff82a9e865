#include "rdw/walk_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <numbers>
#include <string>

namespace forewalk::rdw {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

constexpr double kPi = std::numbers::pi;

tl::expected<std::vector<Walk>, Error> parse(const std::string& text) {
  return parseWalks(std::as_bytes(std::span(text)), "w.csv");
}

std::string refusal(const std::string& text) {
  const auto walks = parse(text);
  return walks ? "accepted" : walks.error().message;
}

Walk walkThrough(std::vector<WalkSample> samples) { return {"w", std::move(samples)}; }

TEST(ParseWalks, RefusesAFileWithNoWalkInIt) {
  for (const char* text :
       {"", "\n", "\xEF\xBB\xBF", "  \r\n\r\n", "t,x,z", "t,x,z\n", "t,x,z\n\n \n"}) {
    const auto walks = parse(text);
    ASSERT_FALSE(walks) << text;
    EXPECT_EQ(walks.error().code, ErrorCode::kSceneEmpty) << text;
    EXPECT_THAT(walks.error().message, HasSubstr("w.csv"));
  }
}

TEST(ParseWalks, NamesTheColumnThatIsMissingOrDoubled) {
  EXPECT_THAT(refusal("walker_id,t,x\nu,0,1\n"), HasSubstr("no column z"));
  EXPECT_THAT(refusal("x,z\n0,1\n"), HasSubstr("no column t"));
  EXPECT_THAT(refusal("0,1,2\n1,2,3\n"), HasSubstr("w.csv:1: the first line has no column t"));
  EXPECT_THAT(refusal("t,x,z,x\n0,1,2,3\n"), HasSubstr("column x is named twice"));
}

TEST(ParseWalks, DoesWithoutTimesWhereItMay) {
  const auto parsePaths = [](const std::string& text) {
    return parseWalks(std::as_bytes(std::span(text)), "w.csv", WalkTimes::kOptional);
  };
  const auto paths = parsePaths("x,z,walker_id\n0,0,a\n300,-1,a\n5,5,b\n0,0,a\n5,5,b\n");
  ASSERT_TRUE(paths) << paths.error().message;  // a jump of 300 m: nobody knows how long it took
  ASSERT_EQ(paths->size(), 2u);
  ASSERT_EQ((*paths)[0].samples.size(), 3u);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ((*paths)[0].samples[i].seconds, i);
  EXPECT_EQ((*paths)[0].samples[1].plan, glm::dvec2(300, 1));
  // Where times are given they hold.
  const auto timed = parsePaths("t,x,z\n0,0,0\n0.1,300,0\n");
  ASSERT_FALSE(timed);
  EXPECT_THAT(timed.error().message, HasSubstr("faster than 12 m/s"));
  EXPECT_THAT(parsePaths("x,y\n0,0\n").error().message,
              AllOf(HasSubstr("no column z"), HasSubstr("or x,z")));
}

TEST(ParseWalks, NamesLineAndValueOfEveryBadNumber) {
  for (const char* bad :
       {"nan", "NaN", "inf", "-inf", "1e999", "", "-", "1.2.3", "1x", "0x10", "1 2"}) {
    const std::string text = std::string("x,z,t\n0,0,0\n0,0,") + bad + "\n";
    EXPECT_THAT(refusal(text),
                AllOf(HasSubstr("w.csv:3: t is \""), HasSubstr("not a finite number")))
        << bad;
  }
  EXPECT_THAT(refusal("t,x,z\n0,0,0\n1,0,nan\n"), HasSubstr("w.csv:3: z is \"nan\""));
  EXPECT_THAT(refusal("t,x,z\n0,0,0\n1,2e6,0\n"), HasSubstr("w.csv:3: x is 2000000 m"));
}

TEST(ParseWalks, RefusesARowThatEndsEarly) {
  EXPECT_THAT(refusal("t,x,z\n0,0,0\n0.1,0"),
              HasSubstr("w.csv:3: the row has 2 fields, 3 are needed"));
  EXPECT_THAT(refusal("t,x,z,walker_id\n0,0,0,a\n0.1,0,0\n"), HasSubstr("3 fields, 4 are needed"));
}

TEST(ParseWalks, RefusesTimeThatStandsStillOrRunsBackwards) {
  EXPECT_THAT(refusal("t,x,z\n0,0,0\n0.2,0,0\n\n0.1,0,0\n"),
              HasSubstr("w.csv:5: t is 0.1 s, not after 0.2 s in line 3"));
  EXPECT_THAT(refusal("t,x,z\n0,0,0\n0,0,0\n"), HasSubstr("not after 0 s in line 2"));
  EXPECT_THAT(refusal("t,x,z\n0,0,0\n100000,0,0\n"), HasSubstr("are these seconds?"));
}

TEST(ParseWalks, RefusesATeleportAndALoneRow) {
  EXPECT_THAT(refusal("t,x,z\n0,0,0\n0.1,3,0\n"), HasSubstr("moves 3 m in 0.1 s"));
  EXPECT_THAT(refusal("t,x,z\n0,0,0\n0.001,0.02,0\n"), "accepted");  // jitter of the tracking
  EXPECT_THAT(refusal("walker_id,t,x,z\na,0,0,0\nb,0,0,0\na,1,0,0\n"),
              HasSubstr("w.csv:3: walker \"b\" has one row only"));
}

TEST(ParseWalks, KeepsMessagesOnOneLineOfPlainText) {
  const std::string message =
      refusal(std::string("t,x,z\n0,0,0\n1,\"\x01\xFF") + std::string(500, 'y') + "\",0\n");
  EXPECT_LT(message.size(), 200u);
  for (const char c : message) EXPECT_TRUE(c >= ' ' && c <= '~') << static_cast<int>(c);
}

TEST(ParseWalks, TakesColumnsInAnyOrderAndWalkersInterleaved) {
  const auto walks = parse(
      "\xEF\xBB\xBFz , note,t,walker_id,x\r\n"
      "1,hello,0,b,2\r\n"
      "0,,5,a,0\r\n"
      "\r\n"
      "1.5,,0.5,b,2.25\r\n"
      "0,,5.1,a,-0.125");
  ASSERT_TRUE(walks) << walks.error().message;
  ASSERT_EQ(walks->size(), 2u);
  EXPECT_EQ((*walks)[0].walker, "b");
  EXPECT_EQ((*walks)[1].walker, "a");
  ASSERT_EQ((*walks)[0].samples.size(), 2u);
  EXPECT_EQ((*walks)[0].samples[1].seconds, 0.5);
  EXPECT_EQ((*walks)[0].samples[1].plan, glm::dvec2(2.25, -1.5));
  EXPECT_EQ((*walks)[1].samples[1].plan, glm::dvec2(-0.125, 0.0));
}

TEST(ParseWalks, DoesWithoutWalkerIds) {
  const auto walks = parse("t,x,z\n0,0,0\n1,0,-1\n");
  ASSERT_TRUE(walks);
  ASSERT_EQ(walks->size(), 1u);
  EXPECT_EQ(walks->front().walker, "");
}

TEST(ParseWalks, NeverCrashesOnATruncatedFile) {
  const std::string whole =
      "walker_id,t,x,z\nu0,0.0,-1.25,2e-1\nu0,0.1,-1.24,0.2\nu1,3,0,0\nu1,4,0,1\n";
  for (std::size_t length = 0; length <= whole.size(); ++length) {
    const auto walks = parse(whole.substr(0, length));
    if (!walks) continue;
    for (const Walk& walk : *walks) EXPECT_GE(walk.samples.size(), 2u) << length;
  }
}

TEST(ParseWalks, ReadsTheRecordedWalks) {
  for (const char* folder : {"searching-a", "searching-b", "open-plane"}) {
    const std::filesystem::path file =
        std::filesystem::path(FOREWALK_SHARED_DATA) / "walks" / folder / "walks.csv";
    std::ifstream stream(file, std::ios::binary);
    if (!stream) GTEST_SKIP() << "no recorded walks at " << file;
    const std::string text{std::istreambuf_iterator<char>(stream), {}};
    const auto walks = parse(text);
    ASSERT_TRUE(walks) << walks.error().message;
    std::size_t rows = 1;
    for (const Walk& walk : *walks) rows += walk.samples.size();
    EXPECT_EQ(rows, static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'))) << folder;
    EXPECT_EQ(walks->size(), std::string(folder) == "open-plane" ? 36u : 6u);

    // Headings agree with where the walker goes: over a second of brisk walking, the way walked
    // lies mostly along the mean heading.
    const std::vector<WalkFrame> frames = resample(walks->front(), 90.0);
    double along = 0.0;
    double walked = 0.0;
    for (std::size_t k = 1; k < frames.size(); ++k) {
      const glm::dvec2 step = frames[k].plan - frames[k - 1].plan;
      along +=
          glm::dot(step, glm::dvec2(-std::sin(frames[k].heading), std::cos(frames[k].heading)));
      walked += glm::length(step);
    }
    EXPECT_GT(along, 0.95 * walked) << folder;
  }
}

TEST(Resample, KeepsAWalkThatNeverMovesFacingForward) {
  const auto frames = resample(walkThrough({{3.0, {1, 2}}, {3.5, {1, 2}}}), 10.0);
  ASSERT_EQ(frames.size(), 6u);
  for (const WalkFrame& frame : frames) {
    EXPECT_EQ(frame.plan, glm::dvec2(1, 2));
    EXPECT_EQ(frame.heading, 0.0);
  }
}

TEST(Resample, PassesThroughEverySampleAtItsTime) {
  const Walk walk =
      walkThrough({{10.0, {0, 0}}, {10.25, {0.25, 0}}, {11.0, {0.25, 0.75}}, {11.5, {0, 0.5}}});
  for (const double rate : {4.0, 20.0, 90.0 * 4.0}) {
    const auto frames = resample(walk, rate);
    EXPECT_EQ(frames.size(), 1 + static_cast<std::size_t>(1.5 * rate));
    for (const WalkSample& sample : walk.samples) {
      const auto k = static_cast<std::size_t>(std::lround((sample.seconds - 10.0) * rate));
      EXPECT_NEAR(glm::distance(frames[k].plan, sample.plan), 0.0, 1e-12) << rate;
    }
  }
}

TEST(Resample, FacesWhereTheWalkerGoes) {
  for (double heading = -3.1; heading < 3.1; heading += 0.3) {
    const glm::dvec2 way{-std::sin(heading), std::cos(heading)};
    for (const WalkFrame& frame : resample(walkThrough({{0, {0, 0}}, {2.0, 2.0 * way}}), 30.0)) {
      EXPECT_NEAR(frame.heading, heading, 1e-9);
    }
  }
}

TEST(Resample, TurnsTheShorterWayWhileStanding) {
  // Backwards (heading pi) along plan -y, a stop of two seconds, then on with a slight right turn,
  // whose heading is just under -pi/2 on the other side of the seam.
  const Walk walk = walkThrough({{0, {0, 2}}, {2, {0, 0}}, {4, {0, 0}}, {6, {2, 0}}});
  const auto frames = resample(walk, 50.0);
  for (std::size_t k = 1; k < frames.size(); ++k) {
    EXPECT_LT(std::abs(std::remainder(frames[k].heading - frames[k - 1].heading, 2 * kPi)), 0.2)
        << k;
  }
  EXPECT_NEAR(std::abs(frames[0].heading), kPi, 1e-9);
  EXPECT_NEAR(frames.back().heading, -kPi / 2, 1e-9);
  // From pi to -pi/2 the shorter way passes -3pi/4, a left turn.
  EXPECT_NEAR(frames[150].heading, -3 * kPi / 4, 0.1);
}

TEST(Resample, IsTheSameWalkBackwards) {
  const Walk walk = walkThrough({{0, {0, 0}}, {1, {1, 0.5}}, {2, {1, 2}}, {3, {-1, 2}}});
  Walk back = walk;
  std::reverse(back.samples.begin(), back.samples.end());
  for (WalkSample& sample : back.samples) sample.seconds = 3.0 - sample.seconds;
  const auto there = resample(walk, 60.0);
  const auto again = resample(back, 60.0);
  ASSERT_EQ(there.size(), again.size());
  for (std::size_t k = 0; k < there.size(); ++k) {
    const WalkFrame& mirrored = again[there.size() - 1 - k];
    EXPECT_NEAR(glm::distance(there[k].plan, mirrored.plan), 0.0, 1e-9) << k;
    EXPECT_NEAR(std::abs(std::remainder(there[k].heading - mirrored.heading, 2 * kPi)), kPi, 1e-6)
        << k;
  }
}

}  // namespace
}  // namespace forewalk::rdw
