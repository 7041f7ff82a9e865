// A crowd in several places: what lateness and loss may do, and what they may not.
#include "agents/network.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "agents/models/social_forces.h"
#include "agents/published_scenes.h"

namespace forewalk::agents {
namespace {

NetworkSettings settingsWith(std::uint32_t clients, float delay, float loss) {
  NetworkSettings settings;
  settings.clients = clients;
  settings.delay = delay;
  settings.loss = loss;
  return settings;
}

NetworkMetrics ran(const CrowdScene& scene, const NetworkSettings& settings, double seconds) {
  auto metrics = runNetwork(scene, settings, seconds);
  EXPECT_TRUE(metrics);
  return *metrics;
}

TEST(Link, DelaysByItsTicksAndKeepsTheOrder) {
  Link<int> link(3, 0.0f, 1);
  link.send(10, 1);
  link.send(10, 2);
  link.send(11, 3);
  std::vector<int> got;
  const auto take = [&](int message) { got.push_back(message); };
  link.receive(12, take);
  EXPECT_TRUE(got.empty());
  link.receive(13, take);
  EXPECT_EQ(got, (std::vector<int>{1, 2}));
  link.receive(20, take);
  EXPECT_EQ(got, (std::vector<int>{1, 2, 3}));
}

TEST(Link, LosesItsShareAndTheSameOnesEveryTime) {
  const auto lost = [](float loss, std::uint64_t seed) {
    Link<int> link(0, loss, seed);
    std::vector<int> got;
    for (int k = 0; k < 10000; ++k) link.send(0, k);
    link.receive(0, [&](int message) { got.push_back(message); });
    return got;
  };
  EXPECT_EQ(lost(0.0f, 1).size(), 10000u);
  EXPECT_NEAR(static_cast<double>(lost(0.05f, 1).size()), 9500.0, 90.0);
  EXPECT_TRUE(lost(1.0f, 1).empty());
  EXPECT_EQ(lost(0.05f, 7), lost(0.05f, 7));
  EXPECT_NE(lost(0.05f, 7), lost(0.05f, 8));
}

// One client that is told everything at once plans as the crowd would by itself.
TEST(Network, OfOneClientWithoutDelayWalksAsOneCrowd) {
  CrowdScene scene = circleScene(8);
  NetworkSettings settings = settingsWith(1, 0.0f, 0.0f);
  auto session = NetworkSession::make(scene, settings, 10.0);
  ASSERT_TRUE(session);
  NetworkClient client(session->welcome(0));
  CrowdSettings plain;
  plain.project = true;
  Crowd crowd(plain);
  const auto ids = populate(scene, crowd.addModel(makeSocialForces()), crowd);
  // The server's first tick has no commands yet.
  for (int tick = 0; tick < 60; ++tick) {
    session->stepServer();
    for (std::size_t k = 0; k < ids.size(); ++k) {
      const glm::vec2 there = session->server().crowd().view().position[k];
      ASSERT_LT(glm::distance(there, crowd.view().position[k]), 2e-3f) << "tick " << tick;
    }
    session->due(0, [&](const NetworkSnapshot& snapshot) { client.receive(snapshot); });
    session->answer(0, client.step());
    crowd.step(settings.seconds);
  }
}

TEST(Network, RunsTheSameTwiceAndOtherwiseWithOtherLosses) {
  const CrowdScene scene = cityBlockScene(1);
  NetworkSettings settings = settingsWith(2, 0.1f, 0.05f);
  settings.cells = cityBlockCells();
  const NetworkMetrics once = ran(scene, settings, 6.0);
  EXPECT_EQ(ran(scene, settings, 6.0).hash, once.hash);
  settings.seed = 2;
  EXPECT_NE(ran(scene, settings, 6.0).hash, once.hash);
}

// A lone walker: whatever is late or lost, the two agree in the end, and it gets there.
TEST(Network, BringsALoneWalkerToItsGoalAndBothSidesAgree) {
  for (const float delay : {0.0f, 0.1f, 0.25f, 0.5f}) {
    for (const float loss : {0.0f, 0.05f, 0.3f}) {
      CrowdScene scene;
      SceneAgent agent;
      agent.goal = {12.0f, 5.0f};
      agent.spec.goalRadius = 0.1f;
      scene.agents.push_back(agent);
      scene.arrivalRadius = 0.0f;  // walks on until the time is over
      auto session = NetworkSession::make(scene, settingsWith(1, delay, loss), 25.0);
      ASSERT_TRUE(session);
      NetworkClient client(session->welcome(0));
      while (!session->done()) {
        session->stepServer();
        session->due(0, [&](const NetworkSnapshot& s) { client.receive(s); });
        session->answer(0, client.step());
      }
      const glm::vec2 there = session->server().crowd().view().position[0];
      EXPECT_LT(glm::distance(there, agent.goal), 0.4f) << delay << " s, loss " << loss;
      EXPECT_LT(glm::distance(there, client.crowd().view().position[0]), 0.15f)
          << delay << " s, loss " << loss;
    }
  }
}

// Without loss a client is never corrected: the server does what it was told.
TEST(Network, DelayAloneMovesALoneWalkersArrivalByTheRoundTripAndNoMore) {
  CrowdScene scene;
  SceneAgent agent;
  agent.goal = {12.0f, 0.0f};
  scene.agents.push_back(agent);
  scene.arrivalRadius = 0.5f;
  const double prompt = ran(scene, settingsWith(1, 0.0f, 0.0f), 30.0).meanArrival;
  for (const float delay : {0.1f, 0.25f, 0.5f}) {
    const NetworkMetrics late = ran(scene, settingsWith(1, delay, 0.0f), 30.0);
    EXPECT_NEAR(late.meanArrival - prompt, 2.0 * static_cast<double>(delay), 0.11);
    EXPECT_GT(late.efficiency, 0.99);  // the last tick's way counts as walked
  }
}

TEST(Network, LeavesNoOverlapWhereTheServerResolvesContacts) {
  const CrowdScene scene = meetingScene(18, 8.0f, 1);
  for (const float delay : {0.0f, 0.25f, 0.5f}) {
    NetworkSettings settings = settingsWith(2, delay, 0.05f);
    const NetworkMetrics metrics = ran(scene, settings, 60.0);
    EXPECT_EQ(metrics.left.pairSteps, 0u) << delay;
    EXPECT_EQ(metrics.arrived, metrics.agents) << delay;
  }
}

TEST(Network, DrivesItsHumansAndNobodyElseMovesThem) {
  const CrowdScene scene = cityBlockScene(3);
  NetworkSettings settings = settingsWith(2, 0.1f, 0.0f);
  settings.cells = cityBlockCells();
  auto session = NetworkSession::make(scene, settings, 20.0);
  ASSERT_TRUE(session);
  const std::vector<Wall> walls = session->welcome(0).walls;
  std::vector<NetworkClient> clients;
  for (std::uint32_t c = 0; c < 2; ++c) clients.emplace_back(session->welcome(c));
  std::vector<float> walked(3, 0.0f);
  std::vector<glm::vec2> last;
  for (int k = 0; k < 3; ++k)
    last.push_back(scene.agents[static_cast<std::size_t>(k)].spec.position);
  for (int tick = 0; tick < 400; ++tick) {
    session->stepServer();
    for (std::uint32_t c = 0; c < 2; ++c) {
      session->due(c, [&](const NetworkSnapshot& s) { clients[c].receive(s); });
      session->answer(c, clients[c].step());
    }
    const AgentsView view = session->server().crowd().view();
    for (std::size_t k = 0; k < 3; ++k) {
      ASSERT_TRUE(view.flags[k] & kHuman);
      walked[k] += glm::distance(view.position[k], last[k]);
      last[k] = view.position[k];
    }
    EXPECT_EQ(countWallsEntered(view, walls, 0.02f), 0u);
  }
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_NEAR(walked[k], 20.0f * scene.agents[k].spec.preferredSpeed, 0.2f);
  }
}

TEST(Network, IgnoresWhatIsNotTheSendersOrNotANumber) {
  const CrowdScene scene = circleScene(4);
  auto server = NetworkServer::make(scene, settingsWith(2, 0.0f, 0.0f));
  ASSERT_TRUE(server);
  const float nan = std::numeric_limits<float>::quiet_NaN();
  NetworkCommand command;
  command.number = 1;
  command.motions = {{1, {1.0f, 0.0f}, 0.0f}, {0, {nan, 0.0f}, 0.0f}, {99, {1.0f, 0.0f}, 0.0f}};
  server->receive(0, command);
  server->receive(7, command);
  server->step();
  for (std::size_t k = 0; k < 4; ++k) {
    EXPECT_EQ(server->crowd().view().position[k], scene.agents[k].spec.position);
  }
  // And a client likewise.
  NetworkClient client(server->welcome(0));
  NetworkSnapshot snapshot;
  snapshot.tick = 1;
  snapshot.answered = 77;
  snapshot.states = {{1, {nan, 0.0f}, {0.0f, 0.0f}, 0.0f}, {44, {0.0f, 0.0f}, {0.0f, 0.0f}, 0.0f}};
  snapshot.ways = {{1, 3, {}, nan}, {0, 99, {}, 0.0f}, {88, 1, {}, 0.0f}};
  const std::uint64_t before = client.crowd().hash();
  client.receive(snapshot);
  EXPECT_EQ(client.crowd().hash(), before);
}

TEST(PublishedScenes, OfTheThesisLeadToEveryObjectAroundAllOthers) {
  const std::size_t objects[] = {2, 5, 8, 10, 20};
  ASSERT_EQ(avatarScenes().size(), 5u);
  for (std::size_t s = 0; s < 5; ++s) {
    const AvatarScene& scene = avatarScenes()[s];
    EXPECT_EQ(scene.objects.size(), objects[s]);
    AvatarNavigation avatar = populate(scene);
    for (const std::uint32_t target : scene.visits) {
      ASSERT_TRUE(avatar.walkTo(ObjectId{target}));
      int ticks = 0;
      while (!avatar.arrived() && ++ticks < 3000) {
        avatar.step(0.1f);
        for (std::uint32_t k = 0; k < scene.objects.size(); ++k) {
          if (k + 1 == target) continue;
          const AvatarObject& object = scene.objects[k];
          const float c = std::cos(object.heading), sn = std::sin(object.heading);
          const glm::vec2 off = avatar.position() - object.centre;
          const glm::vec2 local(c * off.x + sn * off.y, c * off.y - sn * off.x);
          const glm::vec2 outside = glm::max(glm::abs(local) - object.halfSize, glm::vec2(0.0f));
          ASSERT_GT(glm::length(outside), 0.0f) << scene.name << ", object " << k + 1;
        }
      }
      EXPECT_TRUE(avatar.arrived()) << scene.name << ", to object " << target;
    }
  }
}

TEST(PublishedScenes, CityBlockHasItsPeopleOnFreeGround) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const CrowdScene scene = cityBlockScene(seed);
    Crowd crowd;
    const auto ids = populate(scene, crowd.addModel(makeSocialForces()), crowd);
    ASSERT_EQ(ids.size(), 21u);
    EXPECT_EQ(countWallsEntered(crowd.view(), crowd.walls(), 0.0f), 0u) << seed;
    int humans = 0;
    for (const SceneAgent& agent : scene.agents) {
      humans += (agent.spec.flags & kHuman) != 0;
      EXPECT_FALSE(entersWall(agent.goal, 0.0f, agent.spec.radius, crowd.walls(), 0.0f)) << seed;
    }
    EXPECT_EQ(humans, 3);
    OverlapCounter counter;
    EXPECT_EQ(counter.count(crowd.view()).pairSteps, 0u);
  }
}

}  // namespace
}  // namespace forewalk::agents
