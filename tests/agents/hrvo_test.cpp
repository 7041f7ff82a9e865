#include "agents/models/hrvo.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "agents/crowd.h"
#include "agents/overlaps.h"
#include "agents/scenes.h"
#include "agents/velocity_cones.h"
#include "navmesh/plan.h"
#include "navmesh/random.h"

namespace forewalk::agents {
namespace {

glm::vec2 randomVector(std::mt19937_64& rng, double size) {
  const double x = navmesh::uniform(rng, -size, size);
  return glm::vec2(x, navmesh::uniform(rng, -size, size));
}

TEST(Hrvo, ApexLiesOnOneSideOfEachOfTheTwoCones) {
  std::mt19937_64 rng(1);
  for (int k = 0; k < 2000; ++k) {
    const glm::vec2 apart = randomVector(rng, 5.0);
    const float reach = static_cast<float>(navmesh::uniform(rng, 0.1, 0.9)) * glm::length(apart);
    const glm::vec2 v = randomVector(rng, 2.0), theirs = randomVector(rng, 2.0);
    const VelocityCone cone = coneOfDisc(apart, reach, theirs, 0.0f);
    const glm::vec2 mean = 0.5f * (v + theirs);
    const glm::vec2 left = hybridApex(apart, reach, v, theirs, true);
    const glm::vec2 right = hybridApex(apart, reach, v, theirs, false);
    // Left of the centre line: on the right side of VO's cone and the left side of RVO's.
    const float scale = 1e-3f * (1.0f + glm::length(left) + glm::length(right));
    ASSERT_NEAR(navmesh::cross(cone.right, left - theirs), 0.0f, scale);
    ASSERT_NEAR(navmesh::cross(cone.left, left - mean), 0.0f, scale);
    ASSERT_NEAR(navmesh::cross(cone.left, right - theirs), 0.0f, scale);
    ASSERT_NEAR(navmesh::cross(cone.right, right - mean), 0.0f, scale);
  }
}

TEST(VelocityCones, ForbidExactlyWhatCollidesWithinTheHorizon) {
  std::mt19937_64 rng(2);
  int forbidden = 0;
  for (int k = 0; k < 20000; ++k) {
    const glm::vec2 apart = randomVector(rng, 4.0), v = randomVector(rng, 3.0);
    const float reach = static_cast<float>(navmesh::uniform(rng, 0.1, 0.9)) * glm::length(apart);
    const VelocityCone cone = coneOfDisc(apart, reach, glm::vec2(0.0f), 0.0f);
    const float when = glm::dot(apart, v) / std::max(1e-9f, glm::dot(v, v));
    const float nearest = when > 0.0f ? glm::distance(apart, when * v) : glm::length(apart);
    if (std::abs(nearest - reach) < 1e-3f) continue;
    ASSERT_EQ(cone.forbids(v), nearest < reach);
    forbidden += nearest < reach;
  }
  EXPECT_GT(forbidden, 1000);
}

TEST(VelocityCones, NearestFreeIsFreeAndAtLeastAsNearAsAFineGrid) {
  std::mt19937_64 rng(3);
  ConeScratch scratch;
  int found = 0;
  for (int k = 0; k < 400; ++k) {
    std::vector<VelocityCone> cones;
    for (int c = navmesh::uniformInt(rng, 8); c >= 0; --c) {
      const glm::vec2 apart = randomVector(rng, 4.0);
      cones.push_back(coneOfDisc(apart, 0.7f * glm::length(apart), randomVector(rng, 1.0),
                                 navmesh::uniformInt(rng, 2) ? 3.0f : 0.0f));
    }
    const glm::vec2 preferred = randomVector(rng, 1.0);
    glm::vec2 v;
    const bool free = nearestFree(cones, preferred, 2.0f, 1.0f, scratch, v);
    if (free) {
      ++found;
      EXPECT_LE(glm::length(v), 2.0f + 1e-3f);
      for (const VelocityCone& cone : cones) {
        // A border's width inside is rounding.
        VelocityCone narrower = cone;
        narrower.apex += 2e-3f * (cone.left + cone.right) / glm::length(cone.left + cone.right);
        EXPECT_FALSE(narrower.forbids(v));
      }
    }
    const float best = free ? glm::distance(v, preferred) : 1e30f;
    for (float x = -2.0f; x <= 2.0f; x += 0.04f) {
      for (float y = -2.0f; y <= 2.0f; y += 0.04f) {
        if (x * x + y * y > 4.0f || glm::distance({x, y}, preferred) > best - 1e-3f) continue;
        bool forbidden = false;
        for (const VelocityCone& cone : cones) forbidden = forbidden || cone.forbids({x, y});
        ASSERT_TRUE(forbidden) << "round " << k << " at " << x << ", " << y << ", best " << best;
      }
    }
  }
  EXPECT_GT(found, 100);
}

TEST(Hrvo, TheThesisFormWalksItsPreferredVelocityThroughEverything) {
  HrvoParameters parameters;
  parameters.preferredOnly = true;
  CrowdSettings settings;
  settings.symmetryBreak = 0.0f;
  settings.unknot = 0.0f;
  Crowd crowd(settings);
  const CrowdScene scene = headOnScene();
  populate(scene, crowd.addModel(makeHrvo(parameters)), crowd);
  float deepest = 0.0f;
  OverlapCounter counter;
  for (int k = 0; k < 80; ++k) {
    crowd.step(0.1f);
    deepest = std::max(deepest, counter.count(crowd.view()).deepest);
  }
  EXPECT_GT(deepest, 0.5f);
  EXPECT_NEAR(crowd.view().position[0].x, 4.0f, 0.2f);
}

TEST(Hrvo, CrossesTheBlocksSoonerThanRvo2AndEntersNoWall) {
  const CrowdScene scene = blocksScene(5);
  Crowd crowd;
  const std::vector<AgentId> ids = populate(scene, crowd.addModel(makeHrvo()), crowd);
  double seconds = 0.0;
  std::uint64_t walls = 0;
  while (!allArrived(scene, ids, crowd) && seconds < 781.0) {
    crowd.step(scene.seconds);
    seconds += static_cast<double>(scene.seconds);
    walls += countWallsEntered(crowd.view(), crowd.walls(), 0.01f);
  }
  EXPECT_LT(seconds, 781.0);
  EXPECT_EQ(walls, 0u);
}

}  // namespace
}  // namespace forewalk::agents
