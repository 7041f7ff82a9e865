#include "service/trajectory_picture.h"

#include <gtest/gtest.h>

#include <string>

namespace forewalk::service {
namespace {

std::size_t countOf(const std::string& text, const std::string& part) {
  std::size_t count = 0;
  for (std::size_t at = text.find(part); at != text.npos; at = text.find(part, at + 1)) ++count;
  return count;
}

TEST(TrajectoryPicture, DrawsEveryTrajectoryOnceAndTheChosenOneOnTop) {
  TrajectoryPictureSettings settings;
  settings.parameters.dual = false;
  const auto svg = pictureTrajectories(agents::headOnScene(), settings);
  ASSERT_TRUE(svg.has_value());
  const std::size_t dismissed = countOf(*svg, "stroke=\"#c3c9d1\" stroke-width=\"0.7\"");
  const std::size_t free = countOf(*svg, "stroke-opacity=\"0.8\"");
  EXPECT_EQ(dismissed + free, 150u);
  EXPECT_GT(free, 0u);
  EXPECT_GT(svg->find("stroke=\"#ffffff\" stroke-width=\"8\""),
            svg->rfind("stroke-opacity=\"0.8\""));
}

TEST(TrajectoryPicture, RefusesAnAgentThatIsNotThere) {
  TrajectoryPictureSettings settings;
  settings.agent = 2;
  EXPECT_EQ(pictureTrajectories(agents::headOnScene(), settings).error().message,
            "agent is 2, the scene head-on has 2. Give 0 to 1.");
}

}  // namespace
}  // namespace forewalk::service
