#include "agents/crowd.h"

#include <gtest/gtest.h>

#include "agents/models/orca.h"
#include "agents/scenes.h"

namespace forewalk::agents {
namespace {

TEST(Crowd, WalksEverybodyAcrossTheCircle) {
  const CrowdScene scene = circleScene(50);
  Crowd crowd;
  const std::vector<AgentId> ids = populate(scene, crowd.addModel(makeOrca()), crowd);
  int steps = 0;
  while (!allArrived(scene, ids, crowd) && steps < 600) {
    crowd.step(scene.seconds);
    ++steps;
  }
  EXPECT_LT(steps, 600);
  EXPECT_GT(steps, 80);
}

}  // namespace
}  // namespace forewalk::agents
