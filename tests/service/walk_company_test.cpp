// A redirected user among agents: who is in whose way, and what that does to the ways ahead.
#include "service/walk_company.h"

#include <gmock/gmock.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "rdw/simulation.h"
#include "service/parallel.h"
#include "service/simulation_file.h"

namespace forewalk::service {
namespace {

using ::testing::HasSubstr;

/// Walkable radius of the tests' navmeshes, metres.
constexpr float kRadius = 0.25f;

/// Two rooms of 6 m x 4 m with a doorway between them, 1 m x 1 m, that is a polygon of its own.
std::shared_ptr<const navmesh::World> rooms() {
  navmesh::PolygonMesh mesh;
  const auto polygon = [&](std::vector<std::uint32_t> ring) {
    mesh.ring.insert(mesh.ring.end(), ring.begin(), ring.end());
    mesh.ringStart.push_back(static_cast<std::uint32_t>(mesh.ring.size()));
  };
  for (const glm::vec2 xz : {glm::vec2{0, 0},
                             {0, 4},
                             {6, 4},
                             {6, 2.5f},
                             {6, 1.5f},
                             {6, 0},
                             {7, 0},
                             {7, 1.5f},
                             {7, 2.5f},
                             {7, 4},
                             {13, 4},
                             {13, 0}}) {
    mesh.vertices.emplace_back(xz.x, 0.0f, xz.y);
  }
  polygon({0, 1, 2, 3, 4, 5});
  polygon({4, 3, 8, 7});
  polygon({6, 7, 8, 9, 10, 11});
  return std::make_shared<const navmesh::World>(navmesh::makeWorld(*navmesh::makeNavGraph(mesh)));
}

/// A user who is never steered or stopped, and walks these points of the floor.
LoadedSimulation walkOf(std::shared_ptr<const navmesh::World> world, std::vector<glm::vec3> points,
                        const std::string& agents) {
  LoadedSimulation loaded;
  loaded.world = std::move(world);
  loaded.walkerRadius = kRadius;
  rdw::SimulationConfig& config = loaded.config;
  config.session.controller = "none";
  config.session.resets = false;
  config.session.horizon = 20.0f;
  config.user.plan = rdw::Waypoints{std::move(points), false};
  config.stop.seconds = 60.0;
  config.rate = 30.0;
  if (agents.empty()) return loaded;
  auto company = parseCompany(agents, "walk.json", loaded.world ? "rooms" : "", 1);
  EXPECT_TRUE(company.has_value()) << (company ? "" : company.error().message);
  loaded.company = std::move(*company);
  return loaded;
}

rdw::SimulationResult walked(const LoadedSimulation& loaded, const navmesh::ForEach& forEach = {}) {
  auto result = simulate(loaded, {}, forEach);
  EXPECT_TRUE(result.has_value()) << (result ? "" : result.error().message);
  return std::move(*result);
}

/// To and fro in the left room, in sight of the door.
const std::vector<glm::vec3> kLeftRoom{{2, 0, 2}, {4, 0, 1.5}, {2, 0, 2.5}, {4, 0, 2}, {2, 0, 2}};

std::vector<rdw::FrameRecord> withoutCompany(std::vector<rdw::FrameRecord> frames) {
  for (rdw::FrameRecord& frame : frames) frame.company.reset();
  return frames;
}

TEST(WalkCompany, ChangesNothingFromAfar) {
  for (const char* avoids : {"true", "false"}) {
    const auto alone = walked(walkOf(nullptr, kLeftRoom, ""));
    const auto among = walked(
        walkOf(nullptr, kLeftRoom,
               std::string(R"({"groups": [{"count": 9, "start": {"area": [500, 500, 520, 520]},
                    "goal": {"area": [600, 500, 620, 520]}}], "user": {"avoids": )") +
                   avoids + "}}"));
    EXPECT_EQ(rdw::traceCsv(alone.frames), rdw::traceCsv(withoutCompany(among.frames)));
    EXPECT_EQ(among.summary.company->collisions, 0u);
    EXPECT_GT(among.summary.company->minimumSeparation, 600.0);
  }
}

TEST(WalkCompany, IsAbsentFromTracesAndSummariesOfThoseWhoWalkAlone) {
  const auto alone = walked(walkOf(nullptr, kLeftRoom, ""));
  EXPECT_THAT(rdw::traceCsv(alone.frames), ::testing::Not(HasSubstr("agent")));
  EXPECT_THAT(rdw::summaryJson(alone.summary), ::testing::Not(HasSubstr("agents")));
  const auto among =
      walked(walkOf(nullptr, kLeftRoom, R"({"groups": [{"start": {"points": [[50, 50]]}}]})"));
  EXPECT_THAT(rdw::traceCsv(among.frames), HasSubstr("agent_clearance"));
  EXPECT_THAT(rdw::summaryJson(among.summary), HasSubstr("minimum_separation"));
}

TEST(WalkCompany, WalksIntoWhoeverStandsThereUnlessItMakesWay) {
  for (const char* model : {"orca", "hrvo", "social-forces", "golaem", "caacd"}) {
    for (const bool avoids : {false, true}) {
      const auto result = walked(
          walkOf(nullptr, {{0, 0, 0}, {8, 0, 0}},
                 fmt::format(R"({{"groups": [{{"start": {{"points": [[4, 0.05]]}}, "human": true}}],
                           "user": {{"avoids": {}, "model": "{}"}}}})",
                             avoids, model)));
      SCOPED_TRACE(fmt::format("{} {}", model, avoids));
      // Forces balance in front of whoever stands exactly in the way: that user waits.
      if (std::string(model) != "social-forces" || !avoids) {
        EXPECT_EQ(result.summary.end, rdw::WalkEnd::kFinished);
      }
      EXPECT_EQ(result.summary.company->collisions, avoids ? 0u : 1u);
      EXPECT_EQ(result.summary.company->minimumSeparation < -0.3, !avoids);
      EXPECT_EQ(result.summary.company->collisionSeconds > 0.5, !avoids);
    }
  }
}

TEST(WalkCompany, IsAvoidedByAgentsWhoNeverExpectItToYield) {
  const auto result = walked(
      walkOf(nullptr, {{-8, 0, 0}, {8, 0, 0}},
             R"({"groups": [{"count": 3, "start": {"points": [[8, 0.1], [9, 0.8], [9, -0.8]]},
                      "goal": {"points": [[-9, 0.1], [-9, 0.8], [-9, -0.8]]}}],
          "user": {"avoids": false}})"));
  EXPECT_EQ(result.summary.company->collisions, 0u);
  EXPECT_LT(result.summary.company->minimumSeparation, 1.5);
}

// Somebody stands in the door until second 5, then goes on into the right room.
constexpr const char* kInTheDoor =
    R"({"groups": [{"radius_m": 0.35, "start": {"points": [[6.5, 2]]}, "depart_s": 5,
                    "goal": {"points": [[10, 2]]}}], "user": {"avoids": false}})";

TEST(WalkCompany, ClosesTheDoorwayItStandsInToPredictionAndGivesItBack) {
  const auto world = rooms();
  for (const auto method : {prediction::Method::kPolygon, prediction::Method::kFront}) {
    LoadedSimulation alone = walkOf(world, kLeftRoom, "");
    LoadedSimulation among = walkOf(world, kLeftRoom, kInTheDoor);
    alone.config.session.method = among.config.session.method = method;
    // What the graphs are with the door closed by hand, all along.
    std::vector<navmesh::PolygonCost> blocked;
    navmesh::blockedBy(world->graph, world->locations,
                       {{6.5f, 0.0f, 2.0f}, kRadius + 0.35f, navmesh::kClosed}, blocked);
    ASSERT_FALSE(blocked.empty());
    LoadedSimulation shut = alone;
    shut.config.session.states = std::make_shared<const navmesh::PolygonStates>(
        *navmesh::makePolygonStates(world->graph, {}, {}, blocked));

    const auto open = walked(alone).frames, closed = walked(shut).frames;
    const auto result = walked(among);
    ASSERT_EQ(result.frames.size(), open.size());
    std::size_t whileBlocked = 0, before = 0, after = 0;
    for (std::size_t k = 0; k < open.size(); ++k) {
      ASSERT_EQ(result.frames[k].virtualPosition, open[k].virtualPosition);
      // A frame's company is that after it: its graph is from before.
      const std::uint32_t there = k == 0 ? 0 : result.frames[k - 1].company->blockedPolygons;
      ASSERT_EQ(result.frames[k].graphNodes, there > 0 ? closed[k].graphNodes : open[k].graphNodes)
          << "frame " << k;
      whileBlocked += there > 0 && closed[k].graphNodes != open[k].graphNodes;
      before += there == 0 && whileBlocked == 0;
      after += there == 0 && whileBlocked > 0;
    }
    EXPECT_GT(whileBlocked, 60u);  // two seconds
    EXPECT_GT(before, 20u);        // it stands for a second before it counts
    EXPECT_GT(after, 60u);
    EXPECT_GE(result.summary.company->stateChanges, 2u);
    EXPECT_NEAR(result.summary.company->blockedSeconds, 4.0, 0.7);
  }
}

TEST(WalkCompany, PricesWaysWhereThatIsAskedForAndNoneWhereWaysAreFree) {
  const auto world = rooms();
  const auto with = [&](const std::string& blocking) {
    std::string agents = R"({"groups": [{"radius_m": 0.35, "start": {"points": [[6.5, 2]]}}],
                             "user": {"avoids": false}, "blocking": )";
    return walked(walkOf(world, kLeftRoom, agents + blocking + "}"));
  };
  const auto alone = walked(walkOf(world, kLeftRoom, ""));
  const auto free = with(R"({"cost": "free"})");
  EXPECT_EQ(rdw::traceCsv(withoutCompany(free.frames)), rdw::traceCsv(alone.frames));
  EXPECT_EQ(free.summary.company->stateChanges, 0u);
  const auto one = with(R"({"cost": 1})");  // a price that is none
  EXPECT_GT(one.summary.company->blockedPolygons, 0u);
  EXPECT_EQ(rdw::traceCsv(withoutCompany(one.frames)), rdw::traceCsv(alone.frames));
  const auto closed = with(R"({"cost": "closed"})"), dear = with(R"({"cost": 1000000})");
  EXPECT_GT(closed.summary.company->blockedSeconds, 3.0);
  EXPECT_LT(closed.summary.meanGraphNodes, alone.summary.meanGraphNodes);
  EXPECT_GE(dear.summary.meanGraphNodes, closed.summary.meanGraphNodes);
}

TEST(WalkCompany, IsTheSameForTheSameSeedOnAnyNumberOfThreads) {
  const auto world = rooms();
  const auto walk = [&](std::uint64_t seed, const navmesh::ForEach& forEach) {
    LoadedSimulation loaded = walkOf(world, {{2, 0, 2}, {10, 0, 2}, {2, 0, 1}},
                                     R"({"groups": [{"count": 10, "start": "anywhere",
                                         "goal": "anywhere", "radius_m": 0.2}]})");
    loaded.company->crowd.seed = seed;
    const auto result = walked(loaded, forEach);
    return rdw::traceCsv(result.frames) + rdw::summaryJson(result.summary);
  };
  const std::string once = walk(1, {});
  EXPECT_EQ(walk(1, {}), once);
  EXPECT_EQ(walk(1, onThreads(2)), once);
  EXPECT_EQ(walk(1, onThreads(4)), once);
  EXPECT_NE(walk(2, {}), once);
}

TEST(WalkCompany, LeavesRoomForTheUserAtTheStart) {
  LoadedSimulation loaded =
      walkOf(nullptr, {{0, 0, 0}, {1, 0, 0}},
             R"({"groups": [{"count": 14, "start": {"area": [-1.2, -1.2, 1.2, 1.2]}}]})");
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    loaded.company->crowd.seed = seed;
    loaded.config.stop.seconds = 0.05;
    const auto result = simulate(loaded);
    if (!result) continue;
    EXPECT_GE(result->frames[0].company->clearance, -1e-6) << seed;
  }
}

TEST(WalkCompany, RefusesWhatCannotBe) {
  const auto messageOf = [](const std::string& json) {
    const auto parsed = parseCompany(json, "walk.json", "", 1);
    return parsed ? std::string("accepted") : parsed.error().message;
  };
  EXPECT_THAT(messageOf("{}"), HasSubstr("agents.groups"));
  EXPECT_THAT(messageOf(R"({"groups": [{"start": "anywhere"}]})"),
              HasSubstr("agents.groups[0] is put \"anywhere\", which needs a scene"));
  EXPECT_THAT(messageOf(R"({"groups": [{"start": {"points": [[0, 0]]}}], "blocking":
                            {"cost": 0.5}})"),
              HasSubstr("agents.blocking.cost is 0.5, it has to lie in [1, 1e+06]"));
  EXPECT_THAT(messageOf(R"({"groups": [{"start": {"points": [[0, 0]]}}], "user":
                            {"model": "orcas"}})"),
              HasSubstr("orca"));
  EXPECT_THAT(messageOf(R"({"group": []})"), HasSubstr("groups"));
  // No room at the start is told by the walk, which knows where the user begins.
  auto full = simulate(walkOf(nullptr, {{0, 0, 0}, {1, 0, 0}},
                              R"({"groups": [{"start": {"area": [-0.1, -0.1, 0.1, 0.1]}}]})"));
  ASSERT_FALSE(full);
  EXPECT_THAT(full.error().message, HasSubstr("no room for an agent"));
}

// The bundled walk, its first metres.
TEST(WalkCompany, OfTheMuseumsVisitorsWalksAsItsFileSays) {
  auto loaded = loadSimulation(FOREWALK_ASSETS "/simulations/museum_visitors.json");
  ASSERT_TRUE(loaded) << loaded.error().message;
  ASSERT_TRUE(loaded->company);
  loaded->config.stop.virtualMetres = 6.0;
  const auto one = walked(*loaded), two = walked(*loaded, onThreads(2));
  ASSERT_GT(one.frames.size(), 100u);
  EXPECT_EQ(rdw::traceCsv(one.frames), rdw::traceCsv(two.frames));
  ASSERT_TRUE(one.summary.company);
  EXPECT_EQ(one.summary.company->others, 48u);
  for (const rdw::FrameRecord& frame : one.frames) {
    ASSERT_TRUE(frame.company);
    ASSERT_TRUE(std::isfinite(frame.company->clearance));
  }
}

}  // namespace
}  // namespace forewalk::service
