#include "navmesh/build/obstacle.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <random>

#include "navmesh/random.h"
#include "tests/support/random_obstacle.h"

namespace forewalk::navmesh {
namespace {

using ::testing::HasSubstr;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

std::string refusal(const Obstacle& obstacle, ErrorCode code) {
  const auto valid = validate(obstacle);
  if (valid) return "it was accepted";
  EXPECT_EQ(valid.error().code, code) << valid.error().message;
  return valid.error().message;
}

PrismObstacle prismOf(std::vector<glm::vec2> corners) { return {std::move(corners), 0.0f, 1.0f}; }

TEST(Obstacle, IsRefusedWithoutANumberSizeOrPlace) {
  BoxObstacle box;
  box.halfSize.y = 0.0f;
  EXPECT_THAT(refusal(box, ErrorCode::kSettingOutOfRange), HasSubstr("halfSize.y is 0 m"));
  box.halfSize.y = 2000.0f;
  EXPECT_THAT(refusal(box, ErrorCode::kSettingOutOfRange), HasSubstr("2000 m"));
  box = {};
  box.heading = kNan;
  EXPECT_THAT(refusal(box, ErrorCode::kDataDamaged), HasSubstr("heading"));
  CylinderObstacle cylinder;
  cylinder.foot.z = kNan;
  EXPECT_THAT(refusal(cylinder, ErrorCode::kDataDamaged), HasSubstr("foot.z"));
  cylinder = {};
  cylinder.foot.x = 2e6f;
  EXPECT_THAT(refusal(cylinder, ErrorCode::kSettingOutOfRange), HasSubstr("foot.x is 2e+06 m"));
  cylinder = {};
  cylinder.radius = -1.0f;
  EXPECT_THAT(refusal(cylinder, ErrorCode::kSettingOutOfRange), HasSubstr("radius is -1 m"));
}

TEST(Obstacle, IsRefusedWhereItsOutlineIsNotConvexAndCounterClockwise) {
  EXPECT_THAT(refusal(prismOf({}), ErrorCode::kSettingOutOfRange), HasSubstr("0 corners"));
  EXPECT_THAT(refusal(prismOf({{0, 0}, {1, 0}}), ErrorCode::kSettingOutOfRange),
              HasSubstr("2 corners"));
  EXPECT_THAT(refusal(prismOf({{0, 0}, {1, 0}, {2, 0}}), ErrorCode::kSettingOutOfRange),
              HasSubstr("0 m^2"));
  EXPECT_THAT(refusal(prismOf({{0, 0}, {0, 1}, {1, 1}, {1, 0}}), ErrorCode::kSettingOutOfRange),
              HasSubstr("-1 m^2"));
  EXPECT_THAT(
      refusal(prismOf({{0, 0}, {2, 0}, {0.5f, 0.5f}, {0, 2}}), ErrorCode::kSettingOutOfRange),
      HasSubstr("not convex"));
  std::vector<glm::vec2> star;  // every corner turns left, twice around
  for (int i = 0; i < 5; ++i) {
    const double angle = 2.0 * std::numbers::pi * 2.0 * i / 5.0;
    star.push_back({std::cos(angle), std::sin(angle)});
  }
  EXPECT_THAT(refusal(prismOf(star), ErrorCode::kSettingOutOfRange), HasSubstr("not convex"));
  EXPECT_THAT(refusal(prismOf(std::vector<glm::vec2>(65)), ErrorCode::kSettingOutOfRange),
              HasSubstr("65 corners"));
}

TEST(Obstacle, OfAnyRandomShapeIsAccepted) {
  std::mt19937_64 rng(1);
  for (int i = 0; i < 2000; ++i) {
    const Obstacle obstacle = testing::randomObstacle(rng, {{-9, -9, -9}, {9, 9, 9}}, 3.0);
    const auto valid = validate(obstacle);
    ASSERT_TRUE(valid) << i << ": " << valid.error().message;
  }
}

TEST(Obstacle, OutlineOfABoxTurnsCounterClockwiseSeenFromAbove) {
  const BoxObstacle box{{3.0f, 1.0f, -2.0f}, {2.0f, 0.5f, 1.0f}, 0.25f * std::numbers::pi_v<float>};
  const ObstacleOutline outline = outlineOf(box);
  EXPECT_NEAR(outline.bottom, 0.5, 1e-6);
  EXPECT_NEAR(outline.top, 1.5, 1e-6);
  ASSERT_EQ(outline.corners.size(), 4u);
  // Its longer side, along x, has turned toward -z, which is plan +y.
  const glm::dvec2 longer = outline.corners[1] - outline.corners[0];
  EXPECT_NEAR(longer.x, 4.0 * std::sqrt(0.5), 1e-6);
  EXPECT_NEAR(longer.y, 4.0 * std::sqrt(0.5), 1e-6);
  glm::dvec2 mean(0.0);
  double twiceArea = 0.0;
  for (std::size_t i = 0; i < 4; ++i) {
    const glm::dvec2 a = outline.corners[i], b = outline.corners[(i + 1) % 4];
    mean += 0.25 * a;
    twiceArea += a.x * b.y - a.y * b.x;
  }
  EXPECT_NEAR(mean.x, 3.0, 1e-6);
  EXPECT_NEAR(mean.y, 2.0, 1e-6);
  EXPECT_NEAR(twiceArea, 2.0 * 8.0, 1e-6);
}

}  // namespace
}  // namespace forewalk::navmesh
