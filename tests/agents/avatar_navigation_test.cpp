#include "agents/avatar_navigation.h"

#include <gtest/gtest.h>

#include <cmath>

#include "agents/walls.h"

namespace forewalk::agents {
namespace {

/// Depth of the avatar's body in a box that is not turned, metres; negative: the gap.
float depthIn(glm::vec2 at, float radius, glm::vec2 centre, glm::vec2 half) {
  const glm::vec2 off = glm::max(glm::abs(at - centre) - half, glm::vec2(0.0f));
  return radius - glm::length(off);
}

TEST(AvatarNavigation, StopsAndSlowsAtTheDistancesOfTheThesis) {
  EXPECT_FLOAT_EQ(stopDistance(0.1f), 0.5f);
  EXPECT_FLOAT_EQ(stopDistance(9.0f), 3.0f);
  EXPECT_FLOAT_EQ(slowDistance(0.1f), 3.0f);
  EXPECT_FLOAT_EQ(slowDistance(9.0f), 5.0f);
}

TEST(AvatarNavigation, WalksAroundABoxToItsTargetWhichIsNoObstacle) {
  AvatarNavigation avatar({0.0f, 0.0f});
  const glm::vec2 half(1.0f, 0.5f);
  ASSERT_TRUE(avatar.setObject(ObjectId{1}, {0.3f, 8.0f}, half));
  ASSERT_TRUE(avatar.setObject(ObjectId{2}, {0.0f, 16.0f}, {0.5f, 0.5f}));
  ASSERT_TRUE(avatar.walkTo(ObjectId{2}));
  float deepest = -1e30f, farthestAside = 0.0f;
  int frames = 0;
  while (!avatar.arrived() && ++frames < 3000) {
    const AvatarMotion motion = avatar.step(1.0f / 30.0f);
    EXPECT_GE(motion.speed, 0.0f);
    EXPECT_LE(motion.speed, 2.001f);
    deepest = std::max(deepest, depthIn(avatar.position(), 1.0f, {0.3f, 8.0f}, half));
    farthestAside = std::max(farthestAside, std::abs(avatar.position().x));
  }
  EXPECT_TRUE(avatar.arrived()) << avatar.position().x << ", " << avatar.position().y;
  EXPECT_LE(glm::distance(avatar.position(), {0.0f, 16.0f}), stopDistance(16.0f));
  EXPECT_LT(deepest, 0.02f);
  EXPECT_GT(farthestAside, 0.5f);
}

TEST(AvatarNavigation, TakesObjectsThatAppearMoveAndGoWhileItWalks) {
  AvatarNavigation avatar({0.0f, 0.0f});
  ASSERT_TRUE(avatar.setObject(ObjectId{9}, {0.0f, 20.0f}, {0.5f, 0.5f}));
  ASSERT_TRUE(avatar.walkTo(ObjectId{9}));
  for (int k = 0; k < 1500 && !avatar.arrived(); ++k) {
    if (k == 30) {
      ASSERT_TRUE(avatar.setObject(ObjectId{3}, {0.0f, 9.0f}, {1.0f, 0.5f}));
    }
    if (k == 90) {
      ASSERT_TRUE(avatar.setObject(ObjectId{3}, {2.5f, 11.0f}, {1.0f, 0.5f}));
    }
    if (k == 200) {
      EXPECT_TRUE(avatar.removeObject(ObjectId{3}));
    }
    avatar.step(1.0f / 30.0f);
  }
  EXPECT_TRUE(avatar.arrived());
  EXPECT_FALSE(avatar.removeObject(ObjectId{3}));
  // The target goes: it stands still.
  EXPECT_TRUE(avatar.removeObject(ObjectId{9}));
  EXPECT_EQ(avatar.step(0.1f).speed, 0.0f);
  EXPECT_FALSE(avatar.walkTo(ObjectId{9}));
}

TEST(AvatarNavigation, RefusesABoxWithoutSizeAndStandsStillAmongNoObjects) {
  AvatarNavigation avatar({0.0f, 0.0f});
  EXPECT_EQ(avatar.step(0.1f, true).speed, 0.0f);
  EXPECT_FALSE(avatar.setObject(ObjectId{1}, {NAN, 0.0f}, {1.0f, 1.0f}));
  EXPECT_EQ(avatar.objectCount(), 0u);
}

TEST(AvatarNavigation, WandersToTheSamePlacesForTheSameSeed) {
  const auto end = [](std::uint64_t seed) {
    AvatarNavigation avatar({0.0f, 0.0f}, {}, seed);
    for (std::uint32_t k = 0; k < 8; ++k) {
      const float angle = 0.785f * static_cast<float>(k);
      (void)avatar.setObject(ObjectId{k}, 10.0f * glm::vec2(std::cos(angle), std::sin(angle)),
                             {0.5f, 0.5f});
    }
    for (int k = 0; k < 1200; ++k) avatar.step(1.0f / 30.0f, true);
    return avatar.position();
  };
  EXPECT_EQ(end(1), end(1));
  EXPECT_NE(end(1), end(2));
}

}  // namespace
}  // namespace forewalk::agents
