// The example of agents/README.md, compiled and run; the last test sees that the two stay equal.
#include <gmock/gmock.h>

#include <string>

#include "tests/support/random_mesh.h"
#include "tests/support/readme.h"

// clang-format off
#include "agents/crowd.h"
#include "agents/models/orca.h"

using namespace forewalk;

// Seconds until somebody has walked across a building in which the redirected user walks too.
float secondsAcross(std::shared_ptr<const navmesh::World> world, glm::vec2 from, glm::vec2 to,
                    glm::vec2 user) {
  agents::Crowd crowd;
  crowd.setWorld(std::move(world));
  agents::AgentSpec walker;
  walker.model = crowd.addModel(agents::makeOrca());
  walker.position = from;
  agents::AgentSpec human;
  human.flags = agents::kHuman;
  human.position = user;
  const auto id = crowd.add(walker), userId = crowd.add(human);
  if (!id || !userId) return -1.0f;
  crowd.setGoal(*id, to);
  float seconds = 0.0f;
  while (!crowd.arrived(*id) && seconds < 600.0f) {
    crowd.place(*userId, user, 0.0f, 0.0f, glm::vec2(0.0f));  // wherever tracking says
    crowd.step(0.1f);
    seconds += 0.1f;
  }
  return seconds;
}
// clang-format on

namespace {

TEST(AgentsReadme, WalksAcrossAHallAroundTheUser) {
  const auto world = std::make_shared<const navmesh::World>(
      navmesh::makeWorld(*navmesh::makeNavGraph(forewalk::testing::gridMesh(10, 4, 2.0f))));
  const glm::vec2 from = world->graph.centroid.front(), to = world->graph.centroid.back();
  const float seconds = secondsAcross(world, from, to, 0.5f * (from + to));
  EXPECT_GT(seconds, glm::distance(from, to) / 1.3f - 0.2f);
  EXPECT_LT(seconds, glm::distance(from, to) / 1.3f + 5.0f);
}

TEST(AgentsReadme, ShowsTheExampleThatIsCompiledHere) {
  using forewalk::testing::contentsOf;
  EXPECT_THAT(
      contentsOf(FOREWALK_SOURCE "/tests/agents/agents_readme_test.cpp"),
      ::testing::HasSubstr(forewalk::testing::firstExampleIn(FOREWALK_SOURCE "/agents/README.md")));
}

}  // namespace
