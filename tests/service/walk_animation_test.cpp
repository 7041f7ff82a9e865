// Walks as moving pictures: one picture of the ways for every step, the walker where they were.
#include "service/walk_animation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <string>
#include <string_view>
#include <vector>

#include "prediction/plan_drawing.h"
#include "tests/support/random_mesh.h"
#include "tests/support/xml_fault.h"

namespace forewalk::service {
namespace {

// Rooms of 3 m in a row, and a walk through them at 1 m/s.
navmesh::World hall() {
  return navmesh::makeWorld(std::move(*navmesh::makeNavGraph(testing::gridMesh(8, 2, 3.0f))));
}

rdw::Walk through(double seconds, double speed = 1.0) {
  rdw::Walk walk{"u7", {}};
  for (double t = 0.0; t <= seconds; t += 0.1) {
    walk.samples.push_back({100.0 + t, {1.0 + speed * t, 2.0 + 0.3 * std::sin(t)}});
  }
  return walk;
}

std::string animated(const navmesh::World& world, const rdw::Walk& walk,
                     const WalkAnimationSettings& settings) {
  return animateWalk(world, walk, frontMethod, {}, settings, "A <walk>", "& more");
}

// The beginning of the ends of ways in a picture that has some.
constexpr std::string_view kAnEnd = "fill=\"#1f9d55\" stroke=\"#fff\">\n<circle";

std::vector<std::string> attributes(std::string_view text, std::string_view name) {
  std::vector<std::string> values;
  const std::string opening = std::string(name) + "=\"";
  for (std::size_t at = text.find(opening); at != text.npos; at = text.find(opening, at + 1)) {
    const std::size_t begin = at + opening.size();
    values.emplace_back(text.substr(begin, text.find('"', begin) - begin));
  }
  return values;
}

std::vector<double> numbers(const std::string& text) {
  std::vector<double> values;
  for (const char* at = text.c_str(); *at != '\0';) {
    char* after = nullptr;
    const double value = std::strtod(at, &after);
    if (after == at) {
      ++at;
    } else {
      values.push_back(value);
      at = after;
    }
  }
  return values;
}

TEST(AnimateWalk, IsAPlanWithoutAWalkerWhereTheWalkIsOverBefore) {
  WalkAnimationSettings settings;
  settings.from = 60.0;
  const std::string text = animated(hall(), through(5.0), settings);
  EXPECT_EQ(testing::faultOf(text), "");
  EXPECT_EQ(text.find("<animate"), text.npos);
}

TEST(AnimateWalk, ShowsNoWaysBesideTheNavmesh) {
  rdw::Walk walk{"lost", {{0.0, {-50.0, -50.0}}, {3.0, {-49.0, -50.0}}}};
  WalkAnimationSettings settings;
  settings.seconds = 2.0;
  const std::string text = animated(hall(), walk, settings);
  EXPECT_EQ(testing::faultOf(text), "");
  EXPECT_NE(text.find("none of these: 100 %"), text.npos);
  EXPECT_EQ(text.find(kAnEnd), text.npos);
}

TEST(AnimateWalk, ShowsOnePictureAfterAnotherWithoutGap) {
  WalkAnimationSettings settings;
  settings.seconds = 6.0;
  settings.step = 0.4;
  const std::string text = animated(hall(), through(10.0), settings);
  EXPECT_EQ(testing::faultOf(text), "");
  EXPECT_EQ(text, animated(hall(), through(10.0), settings));
  EXPECT_NE(text.find(kAnEnd), text.npos);
  const auto times = attributes(text, "keyTimes");
  ASSERT_EQ(times.size() % 2, 0u);  // ways, and what is told of them
  const std::size_t steps = times.size() / 2;
  EXPECT_EQ(steps, 16u);
  double shownTo = 0.0;
  for (std::size_t i = 0; i < steps; ++i) {
    std::vector<double> at = numbers(times[i]);
    EXPECT_EQ(times[i], times[steps + i]);
    if (i > 0) at.erase(at.begin());  // hidden before
    EXPECT_EQ(at.front(), shownTo);
    if (i + 1 == steps) {
      EXPECT_EQ(at.size(), 1u);  // until the end
    } else {
      ASSERT_EQ(at.size(), 2u);
      shownTo = at.back();
    }
  }
  for (const std::string& duration : attributes(text, "dur")) EXPECT_EQ(duration, "6.4s");
}

TEST(AnimateWalk, LeadsTheWalkerAsFarAsTheyWalked) {
  WalkAnimationSettings settings;
  settings.from = 2.0;
  settings.seconds = 8.0;
  const std::string text = animated(hall(), through(12.0), settings);
  const std::size_t at = text.find("type=\"translate\"");
  ASSERT_NE(at, text.npos);
  const std::vector<double> places = numbers(attributes(text.substr(at), "values").front());
  ASSERT_EQ(places.size(), 2u * 42u);  // 0 s to 8 s, and the last again
  double walked = 0.0;
  for (std::size_t i = 2; i < places.size(); i += 2) {
    walked += std::hypot(places[i] - places[i - 2], places[i + 1] - places[i - 1]);
  }
  // The trail grows by just that.
  const std::size_t dash = text.find("attributeName=\"stroke-dashoffset\"");
  const std::vector<double> rest = numbers(attributes(text.substr(dash), "values").front());
  EXPECT_NEAR(rest.front() - rest.back(), walked, 0.5);
  const double eastward = places[places.size() - 2] - places[0];
  EXPECT_GT(eastward, 0.0);
  EXPECT_NEAR(walked / eastward, 1.02, 0.03);  // 8 m east, in a gentle wave
}

TEST(AnimateWalk, TurnsTheShorterWayRound) {
  // Round and round: the heading passes half a turn again and again.
  rdw::Walk walk{"u1", {}};
  for (double t = 0.0; t < 30.0; t += 0.1) {
    walk.samples.push_back({t, {9.0 + 1.5 * std::cos(t), 3.0 + 1.5 * std::sin(t)}});
  }
  WalkAnimationSettings settings;
  settings.seconds = 25.0;
  const std::string text = animated(hall(), walk, settings);
  const std::size_t at = text.find("type=\"rotate\"");
  const std::vector<double> turns = numbers(attributes(text.substr(at), "values").front());
  for (std::size_t i = 1; i < turns.size(); ++i) EXPECT_LT(std::abs(turns[i] - turns[i - 1]), 40.0);
  // A left turn of 25 rad is counter-clockwise on the page: SVG's angles fall.
  EXPECT_NEAR(turns.back() - turns.front(), -25.0 * 180.0 / 3.14159265, 25.0);
}

}  // namespace
}  // namespace forewalk::service
