// The linear programs of ORCA against fine grids, and ORCA's own promises.
#include "agents/half_planes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "agents/crowd.h"
#include "agents/models/orca.h"
#include "agents/overlaps.h"
#include "agents/scenes.h"
#include "navmesh/plan.h"
#include "navmesh/random.h"

namespace forewalk::agents {
namespace {

/// How far `v` lies outside a plane, m/s; negative inside.
float outside(const HalfPlane& plane, glm::vec2 v) {
  return navmesh::cross(plane.direction, plane.point - v);
}

std::vector<HalfPlane> randomPlanes(std::mt19937_64& rng, int count, double depth) {
  std::vector<HalfPlane> planes;
  for (int k = 0; k < count; ++k) {
    const glm::vec2 direction =
        navmesh::directionOf(static_cast<float>(navmesh::uniform(rng, -3.14, 3.14)));
    const glm::vec2 inward(-direction.y, direction.x);
    planes.push_back({inward * static_cast<float>(navmesh::uniform(rng, -1.5, depth)), direction});
  }
  return planes;
}

TEST(HalfPlanes, FindTheNearestAllowedVelocityAsAFineGridDoes) {
  std::mt19937_64 rng(1);
  std::vector<HalfPlane> scratch;
  int feasible = 0;
  for (int round = 0; round < 400; ++round) {
    const std::vector<HalfPlane> planes = randomPlanes(rng, navmesh::uniformInt(rng, 9), 0.4);
    const glm::vec2 preferred(navmesh::uniform(rng, -2.0, 2.0), navmesh::uniform(rng, -2.0, 2.0));
    const VelocityChoice choice = nearestAllowed(planes, 0, preferred, 1.5f, scratch);
    ASSERT_LE(glm::length(choice.velocity), 1.5f + 1e-3f);
    float deepest = 0.0f;
    for (const HalfPlane& plane : planes)
      deepest = std::max(deepest, outside(plane, choice.velocity));
    if (choice.feasible) {
      ++feasible;
      ASSERT_LT(deepest, 1e-3f);
    }
    for (float x = -1.5f; x <= 1.5f; x += 0.03f) {
      for (float y = -1.5f; y <= 1.5f; y += 0.03f) {
        if (x * x + y * y > 2.25f) continue;
        float worst = 0.0f;
        for (const HalfPlane& plane : planes) worst = std::max(worst, outside(plane, {x, y}));
        if (choice.feasible && worst <= 0.0f) {
          ASSERT_GE(glm::distance({x, y}, preferred),
                    glm::distance(choice.velocity, preferred) - 1e-3f);
        }
        // Where none is allowed, none is less forbidden.
        if (!choice.feasible) {
          ASSERT_GE(worst, deepest - 2e-3f) << "round " << round;
        }
      }
    }
  }
  EXPECT_GT(feasible, 50);
  EXPECT_LT(feasible, 390);
}

TEST(HalfPlanes, KeepTheHardOnesWhereNothingIsAllowed) {
  std::mt19937_64 rng(2);
  std::vector<HalfPlane> scratch;
  for (int round = 0; round < 2000; ++round) {
    // A wall that the standstill respects, and others that contradict each other.
    std::vector<HalfPlane> planes = randomPlanes(rng, 1, -0.1);
    const std::vector<HalfPlane> soft = randomPlanes(rng, 6, 1.4);
    planes.insert(planes.end(), soft.begin(), soft.end());
    const VelocityChoice choice = nearestAllowed(planes, 1, {1.0f, 0.0f}, 1.5f, scratch);
    ASSERT_LT(outside(planes[0], choice.velocity), 1e-3f);
  }
}

TEST(Orca, TwoTakeHalfOfTheAvoidanceEach) {
  CrowdSettings settings;
  settings.symmetryBreak = 0.0f;
  Crowd crowd(settings);
  const CrowdScene scene = [] {
    CrowdScene s = headOnScene();
    s.agents[0].spec.position.y = s.agents[0].goal.y = 0.1f;
    s.agents[1].spec.position.y = s.agents[1].goal.y = -0.1f;
    return s;
  }();
  populate(scene, crowd.addModel(makeOrca()), crowd);
  float deepest = 0.0f;
  OverlapCounter counter;
  for (int k = 0; k < 60; ++k) {
    crowd.step(0.1f);
    deepest = std::max(deepest, counter.count(crowd.view()).deepest);
    // The scene turned by half a circle is itself, and stays so.
    ASSERT_LT(glm::length(crowd.view().position[0] + crowd.view().position[1]), 1e-4f);
  }
  EXPECT_LT(deepest, 0.01f);
}

TEST(Orca, NeverEntersWalls) {
  const CrowdScene scene = blocksScene(5);
  OrcaParameters parameters;
  parameters.wallHorizon = 2.0f;
  Crowd crowd;
  populate(scene, crowd.addModel(makeOrca(parameters)), crowd);
  std::uint64_t walls = 0;
  for (int k = 0; k < 2000; ++k) {
    crowd.step(scene.seconds);
    walls += countWallsEntered(crowd.view(), crowd.walls(), 0.01f);
  }
  EXPECT_EQ(walls, 0u);
}

}  // namespace
}  // namespace forewalk::agents
