#include "rdw/openrdw_walk.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>
#include <string>

#include "navmesh/random.h"

namespace forewalk::rdw {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

std::span<const std::byte> bytesOf(const std::string& text) {
  return std::as_bytes(std::span(text));
}

tl::expected<Walk, Error> walkOf(const std::string& path, const std::string& times) {
  return parseOpenRdwWalk(bytesOf(path), "p.csv", bytesOf(times), "t.csv");
}

std::string refusal(const std::string& path, const std::string& times) {
  const auto walk = walkOf(path, times);
  return walk ? "accepted" : walk.error().message;
}

TEST(OpenRdwPath, IsAPointALineHoweverItIsSpaced) {
  const std::string text = "\xEF\xBB\xBF-0.01198855, -0.1055848\r\n1,2\n\n  3 ,\t-4  \n1e1,5";
  const auto path = parseOpenRdwPath(bytesOf(text), "p.csv");
  ASSERT_TRUE(path) << path.error().message;
  EXPECT_EQ(*path, (std::vector<glm::dvec2>{{-0.01198855, -0.1055848}, {1, 2}, {3, -4}, {10, 5}}));
}

TEST(OpenRdwPath, NamesLineAndValueOfWhatIsNoPoint) {
  for (const char* bad : {"1", "1;2", "1,", ",2", "1,nan", "inf,2", "1,2,3", "1,2 3", "x,y"}) {
    const std::string text = "0,0\n" + std::string(bad) + "\n1,1\n";
    const auto path = parseOpenRdwPath(bytesOf(text), "p.csv");
    ASSERT_FALSE(path) << bad;
    EXPECT_THAT(path.error().message, AllOf(HasSubstr("p.csv:2: "), HasSubstr(bad)));
  }
  const std::string far = "0,0\n0,200000\n";
  EXPECT_THAT(parseOpenRdwPath(bytesOf(far), "p.csv").error().message,
              HasSubstr("p.csv:2: (0, 200000) m lies farther out"));
  for (const std::string empty : {"", "\n \n"}) {
    const auto path = parseOpenRdwPath(bytesOf(empty), "p.csv");
    ASSERT_FALSE(path);
    EXPECT_EQ(path.error().code, ErrorCode::kSceneEmpty);
  }
}

TEST(OpenRdwWalk, BeginsAtItsFirstPointWhateverTheFirstIntervalIs) {
  for (const char* first : {"0.5", "0", "-1", "17"}) {
    const auto walk = walkOf("0,0\n0,1\n2,1\n", std::string(first) + "\n1\n2.5\n");
    ASSERT_TRUE(walk) << walk.error().message;
    ASSERT_EQ(walk->samples.size(), 3u);
    EXPECT_EQ(walk->samples[0].seconds, 0.0);
    EXPECT_EQ(walk->samples[1].seconds, 1.0);
    EXPECT_EQ(walk->samples[2].seconds, 3.5);
    EXPECT_EQ(walk->samples[2].plan, glm::dvec2(2, 1));
  }
}

TEST(OpenRdwWalk, IsTheSameWalkAsOneWithTimesAndWorldAxes) {
  std::mt19937_64 rng(7);
  std::string path, times, csv = "t,x,z\n";
  double seconds = 0.0;
  glm::dvec2 at(0.0);
  for (int i = 0; i < 200; ++i) {
    const double interval = navmesh::uniform(rng, 0.03, 0.05);
    if (i > 0) {
      seconds += interval;
      at += glm::dvec2(navmesh::uniform(rng, -0.05, 0.05), navmesh::uniform(rng, -0.05, 0.05));
    }
    path += std::to_string(at.x) + ", " + std::to_string(at.y) + "\n";
    times += std::to_string(interval) + "\n";
    csv +=
        std::to_string(seconds) + "," + std::to_string(at.x) + "," + std::to_string(-at.y) + "\n";
  }
  const auto theirs = walkOf(path, times);
  ASSERT_TRUE(theirs) << theirs.error().message;
  const auto ours = parseWalks(bytesOf(csv), "w.csv");
  ASSERT_TRUE(ours) << ours.error().message;
  ASSERT_EQ(theirs->samples.size(), ours->front().samples.size());
  for (std::size_t i = 0; i < theirs->samples.size(); ++i) {
    EXPECT_NEAR(theirs->samples[i].seconds, ours->front().samples[i].seconds, 2e-4);
    EXPECT_EQ(theirs->samples[i].plan, ours->front().samples[i].plan) << i;
  }
}

TEST(OpenRdwWalk, RefusesTimesThatDoNotFit) {
  EXPECT_THAT(refusal("0,0\n1,0\n", "1\n"),
              HasSubstr("t.csv: 1 intervals for the 2 points of p.csv"));
  EXPECT_THAT(refusal("0,0\n", "1\n"), HasSubstr("two or more points"));
  EXPECT_THAT(refusal("0,0\n1,0\n2,0\n", "1\n1\n0\n"), HasSubstr("t.csv:3: \"0\" is no interval"));
  EXPECT_THAT(refusal("0,0\n1,0\n2,0\n", "1\n1\nx\n"), HasSubstr("t.csv:3: \"x\" is no interval"));
  EXPECT_THAT(refusal("0,0\n1,0\n", "1\n1e9\n"), HasSubstr("are these seconds?"));
  EXPECT_THAT(refusal("0,0\n1,0\n4,0\n", "1\n1\n0.1\n"),
              HasSubstr("p.csv:3: the walker moves 3 m in 0.1 s, faster than 12 m/s"));
}

}  // namespace
}  // namespace forewalk::rdw
