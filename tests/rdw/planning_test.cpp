// Laws of the planning controllers, of the reset that looks ahead, and of the ceiling.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <thread>
#include <vector>

#include "navmesh/random.h"
#include "navmesh/world.h"
#include "prediction/predict.h"
#include "rdw/clairvoyant.h"
#include "rdw/foresight.h"
#include "rdw/mpcred.h"
#include "rdw/reset_ahead.h"
#include "rdw/simulation.h"
#include "tests/support/count_allocations.h"
#include "tests/support/motions.h"
#include "tests/support/random_mesh.h"

namespace forewalk::rdw {
namespace {

using navmesh::uniform;
using testing::turningOnTheSpot;
using testing::walking;

constexpr std::array<const char*, 3> kPlanners{"foresight", "mpcred", "force"};

std::unique_ptr<Controller> prepared(const char* name, const TrackedSpace& room,
                                     const GainLimits& limits) {
  auto controller = makeController(name);
  EXPECT_TRUE(controller) << name;
  (*controller)->prepare(room, limits);
  return std::move(*controller);
}

TrackedSpace furnished(double mirror = 1.0) {
  std::vector<glm::dvec2> border{{-3, -3}, {3, -3}, {3, 2}, {1, 2}, {1, 3}, {-3, 3}};
  std::vector<std::vector<glm::dvec2>> table(1);
  table[0] = {{-1.5, -1}, {-0.6, -1}, {-0.6, 0.2}, {-1.5, 0.2}};
  for (glm::dvec2& p : border) p.x *= mirror;
  for (glm::dvec2& p : table[0]) p.x *= mirror;
  return *TrackedSpace::polygon(border, table);
}

TEST(Planners, KeepWithinTheLimitsWhateverTheFrame) {
  auto graph = navmesh::makeNavGraph(testing::randomMesh(3, 12, 12));
  ASSERT_TRUE(graph);
  prediction::Scratch scratch(*graph);
  const TrackedSpace room = furnished();
  for (const char* preset : {"steinicke", "toolkit"}) {
    const GainLimits limits = *gainLimitsByName(preset);
    for (const char* name : kPlanners) {
      const auto controller = prepared(name, room, limits);
      std::mt19937_64 rng(9);
      for (int i = 0; i < 300; ++i) {
        const auto polygon = static_cast<navmesh::PolygonId>(
            navmesh::uniformInt(rng, static_cast<int>(graph->polygonCount())));
        const navmesh::Location source{polygon, graph->centroid[navmesh::index(polygon)], 0.0f,
                                       false};
        const auto& ways = prediction::predict(*graph, source, 6.0f, scratch);
        // Likelihoods as they come, zeros among them.
        std::vector<double> likely(ways.terminals.size());
        for (double& each : likely) each = std::max(0.0, uniform(rng, -0.3, 1.0));
        const double heading = uniform(rng, -3, 3);
        const Motion motion = i % 2 == 0 ? walking(directionOf(heading))
                                         : turningOnTheSpot(uniform(rng, -0.05, 0.05));
        const PlanarPose body{{uniform(rng, -3.2, 3.2), uniform(rng, -3.2, 3.2)}, heading};
        const PlanarPose seen{glm::dvec2(source.plan), heading};
        const Redirection map = alignment(body, seen);
        SteerInput input{motion, body, seen, room, limits, map, i % 3 == 0 ? nullptr : &ways};
        input.likelihoods = {likely, 0.1};
        const Gains gains = controller->steer(input);
        ASSERT_EQ(clamped(gains, limits), gains) << name << ' ' << i;
      }
    }
  }
}

/// Frames of a walk straight along plan x (virtual) by somebody in `room`, the body on an arc.
std::vector<Gains> steeredWithoutGraph(const char* name, const TrackedSpace& room, double mirror,
                                       bool turning) {
  const GainLimits limits = *gainLimitsByName("toolkit");
  const auto controller = prepared(name, room, limits);
  std::vector<Gains> gains;
  for (int i = 0; i < 90; ++i) {
    const double heading = mirror * (0.4 + 0.01 * i);
    const PlanarPose body{{mirror * (1.1 - 0.012 * i), -1.3 + 0.013 * i}, heading};
    const Redirection map = alignment(body, {{0, 0}, mirror * 0.3});
    const PlanarPose seen = map.toVirtual(body);
    const Motion motion = turning ? turningOnTheSpot(mirror * 0.02) : walking(directionOf(heading));
    gains.push_back(controller->steer({motion, body, seen, room, limits, map, nullptr}));
  }
  return gains;
}

TEST(Planners, SteerAMirroredWalkInAMirroredRoomTheMirroredWay) {
  for (const char* name : kPlanners) {
    for (const bool turning : {false, true}) {
      const auto left = steeredWithoutGraph(name, furnished(), 1.0, turning);
      const auto right = steeredWithoutGraph(name, furnished(-1.0), -1.0, turning);
      for (std::size_t i = 0; i < left.size(); ++i) {
        ASSERT_FLOAT_EQ(left[i].rotation, right[i].rotation) << name << ' ' << i;
        ASSERT_FLOAT_EQ(left[i].curvature, -right[i].curvature) << name << ' ' << i;
        ASSERT_FLOAT_EQ(left[i].translation, right[i].translation) << name << ' ' << i;
      }
    }
  }
}

TEST(Planners, SteerWithoutAGraphAndAllocateNothing) {
  const TrackedSpace room = *TrackedSpace::rectangle(5, 5);
  const GainLimits limits = *gainLimitsByName("toolkit");
  for (const char* name : kPlanners) {
    const auto controller = prepared(name, room, limits);
    EXPECT_TRUE(controller->steersWithoutGraph());
    const Redirection map;
    bool steered = false;
    testing::allocationsSince();
    for (int i = 0; i < 60; ++i) {
      // Along a wall, toward another.
      const PlanarPose body{{1.9, -0.5 + i / 60.0}, 0.0};
      steered |=
          controller->steer({walking({0, 1}), body, body, room, limits, map, nullptr}) != Gains{};
    }
    EXPECT_EQ(testing::allocationsSince(), 0u) << name;
    EXPECT_TRUE(steered) << name;
  }
}

SimulationConfig walkOnThePlane(const char* controller, double room, std::uint64_t seed) {
  SimulationConfig config;
  config.session.space = *TrackedSpace::rectangle(room, room);
  config.session.limits = *gainLimitsByName("toolkit");
  config.session.controller = controller;
  config.session.resetPolicy = "ahead";
  config.user.plan = Legs{2.0, 8.0, kPi, false};
  config.stop.virtualMetres = 60.0;
  config.rate = 30.0;
  config.seed = seed;
  return config;
}

TEST(Planners, WalkTheSameOnAnyThread) {
  const auto hashOf = [] {
    const auto result = simulate(nullptr, walkOnThePlane("foresight", 5.0, 3));
    return result ? result->summary.traceHash : 0;
  };
  const std::uint64_t here = hashOf();
  ASSERT_NE(here, 0u);
  std::array<std::uint64_t, 2> there{};
  std::thread first([&] { there[0] = hashOf(); });
  std::thread second([&] { there[1] = hashOf(); });
  first.join();
  second.join();
  EXPECT_EQ(there[0], here);
  EXPECT_EQ(there[1], here);
}

TEST(WaySearch, WithOneWayIsNoWorseForMoreNodes) {
  const TrackedSpace room = furnished();
  const GainLimits limits = *gainLimitsByName("toolkit");
  const RoomValueSettings prior = buildingValue();
  const RoomValue value(room, limits, SteerRule::kCentre, prior);
  const double curvature = static_cast<double>(limits.curvatureMax);
  const std::array<Choice, 3> choices{{{1.26, 1, 0}, {1.26, 1, -curvature}, {1.26, 1, curvature}}};
  std::mt19937_64 rng(5);
  for (int i = 0; i < 100; ++i) {
    WaysAhead ahead;
    ahead.count = 1;
    ahead.ways[0].weight = 1.0;
    ahead.ways[0].count = 4;
    for (int p = 0; p < 4; ++p) {
      ahead.ways[0].pieces[static_cast<std::size_t>(p)] = {p == 2 ? uniform(rng, -2, 2) : 0.0, 1.5};
    }
    const ThoughtPose pose{{uniform(rng, -2.5, 0.5), uniform(rng, 0.4, 2.5)}, uniform(rng, -3, 3)};
    std::array<double, 3> greedy, wide;
    WaySearchSettings settings;
    settings.nodes = 1;
    WaySearch(room, limits, value, prior, settings).costs(pose, ahead, false, choices, greedy);
    settings.nodes = 20000;
    WaySearch(room, limits, value, prior, settings).costs(pose, ahead, false, choices, wide);
    for (std::size_t c = 0; c < 3; ++c) EXPECT_LE(wide[c], greedy[c]);
  }
}

TEST(WaySearch, KeepsToItsBudgetBeyondTheFirstPass) {
  const TrackedSpace room = furnished();
  const GainLimits limits;
  const RoomValueSettings prior = buildingValue();
  const RoomValue value(room, limits, SteerRule::kCentre, prior);
  const WaysAhead ahead = waysAhead(nullptr, {}, {0, 1}, {0, 1}, {});
  const std::array<Choice, 1> choices{};
  std::array<double, 1> costs;
  WaySearchSettings settings;
  settings.nodes = 60;
  EXPECT_LE(WaySearch(room, limits, value, prior, settings)
                .costs({{0, 1}, 0.0}, ahead, false, choices, costs),
            60);
}

TEST(WaySearch, WithEverythingFreeCostsWhatTheBestFirstChoiceDoes) {
  const TrackedSpace room = furnished();
  const GainLimits limits = *gainLimitsByName("toolkit");
  const RoomValueSettings prior = buildingValue();
  const RoomValue value(room, limits, SteerRule::kCentre, prior);
  const double curvature = static_cast<double>(limits.curvatureMax);
  const std::array<Choice, 3> choices{{{1.26, 1, 0}, {1.26, 1, -curvature}, {1.26, 1, curvature}}};
  WaySearchSettings settings;
  settings.nodes = 20000;
  const WaySearch search(room, limits, value, prior, settings);
  std::mt19937_64 rng(6);
  for (int i = 0; i < 100; ++i) {
    // Two pieces: the widest beam leaves nothing out.
    WaysAhead ahead;
    ahead.count = 1;
    ahead.ways[0].weight = 1.0;
    ahead.ways[0].count = 2;
    ahead.ways[0].pieces[0] = {0.0, 1.5};
    ahead.ways[0].pieces[1] = {0.0, 1.0};
    const ThoughtPose pose{{uniform(rng, -2.5, 0.5), uniform(rng, 0.4, 2.5)}, uniform(rng, -3, 3)};
    std::array<double, 3> costs;
    search.costs(pose, ahead, false, choices, costs);
    const double free = search.cost(pose, ahead, 1.26, WaySearch::kWidest);
    EXPECT_DOUBLE_EQ(free, *std::min_element(costs.begin(), costs.end())) << i;
    EXPECT_LE(free, search.cost(pose, ahead, 1.26, 1)) << i;
  }
}

/// MPCRed's J by trying everything, without a bound: somebody walks straight on from `position`.
double plainCost(const TrackedSpace& room, const GainLimits& limits, const MpcredSettings& settings,
                 glm::dvec2 position, double heading, int side, int depth) {
  RoomValueSettings thought;
  thought.stopsBefore = settings.stopsBefore;
  thought.stopping = 0.0;
  double cost = side != 0 ? settings.actionCost : 0.0;
  for (double left = settings.stageSeconds * settings.speed; left > 1e-6;) {
    const ThoughtStep step =
        stepInThought(room, position, heading, std::min(left, 1.0),
                      side * static_cast<double>(limits.curvatureMax), thought);
    position = step.position;
    heading = step.heading;
    left -= step.walked;
    if (step.reset) cost += settings.resetCost;
  }
  if (depth == 1) return cost;
  double least = INFINITY;
  for (int next = -1; next <= 1; ++next) {
    least = std::min(least, plainCost(room, limits, settings, position, heading, next, depth - 1));
  }
  return cost + settings.discount * least;
}

TEST(Mpcred, ChoosesWhatTryingEverythingChooses) {
  const TrackedSpace room = furnished();
  const GainLimits limits = *gainLimitsByName("toolkit");
  const MpcredSettings settings;
  std::mt19937_64 rng(7);
  int bent = 0;
  for (int i = 0; i < 200; ++i) {
    const double heading = uniform(rng, -3, 3);
    const PlanarPose body{{uniform(rng, -2.9, 0.9), uniform(rng, 0.3, 2.9)}, heading};
    std::array<double, 3> costs{};  // straight on, right, left: of equal ones the first is taken
    for (int c = 0; c < 3; ++c) {
      costs[static_cast<std::size_t>(c)] = plainCost(room, limits, settings, body.position, heading,
                                                     c == 0 ? 0 : 2 * c - 3, settings.depth);
    }
    int best = 0;
    for (int c = 1; c < 3; ++c) {
      if (costs[static_cast<std::size_t>(c)] < costs[static_cast<std::size_t>(best)] - 1e-9)
        best = c;
    }
    const auto controller = makeMpcred();
    controller->prepare(room, limits);
    const Gains gains = controller->steer(
        {walking(directionOf(heading)), body, body, room, limits, Redirection{}, nullptr});
    const int side = gains.curvature > 0.0f ? 2 : gains.curvature < 0.0f ? 1 : 0;
    EXPECT_EQ(side, best) << i;
    bent += side != 0;
  }
  EXPECT_GT(bent, 20);
}

TEST(Foresight, ScalesABendThatIsWalkedInsteadOfBendingIt) {
  const TrackedSpace room = *TrackedSpace::rectangle(5, 5);
  const GainLimits limits = *gainLimitsByName("toolkit");
  // Along a wall at a walk, toward another.
  const PlanarPose body{{1.9, -0.5}, 0.0};
  double side = 0.0;  // to which the walk is bent
  const auto after = [&](double turn) {
    const auto controller = prepared("foresight", room, limits);
    Motion motion = walking({0, 1});
    Gains gains;
    for (int i = 0; i < 10; ++i) {
      gains = controller->steer({motion, body, body, room, limits, Redirection{}, nullptr});
    }
    side = static_cast<double>(gains.curvature);
    motion.turn = turn;
    motion.turnRate = turn / motion.dt;
    return controller->steer({motion, body, body, room, limits, Redirection{}, nullptr});
  };
  for (const double turn : {0.02, -0.02}) {
    const Gains gains = after(turn);
    ASSERT_NE(side, 0.0);
    EXPECT_EQ(gains.rotation, turn * side > 0.0 ? limits.rotationMin : limits.rotationMax) << turn;
    EXPECT_EQ(gains.curvature, 0.0f);
    EXPECT_GT(gains.translation, 1.0f);
  }
}

TEST(ResetAhead, TurnsAwayFromTheWall) {
  const TrackedSpace room = *TrackedSpace::rectangle(5, 5);
  const ResetAhead reset(room, *gainLimitsByName("toolkit"));
  for (int i = 0; i < 8; ++i) {
    const double heading = i * kPi / 4.0;
    const glm::dvec2 out = directionOf(heading);
    const glm::dvec2 place = 2.2 / std::max(std::abs(out.x), std::abs(out.y)) * out;
    const double turned = reset.heading({room, place, {0, 1}, nullptr, {}});
    EXPECT_GT(room.distanceAlong(place, directionOf(turned)), 2.5) << heading;
  }
}

TEST(Clairvoyant, NeverNeedsMoreResetsThanAnyController) {
  for (const double room : {4.0, 6.0}) {
    for (std::uint64_t seed = 1; seed <= 2; ++seed) {
      for (const char* name : {"none", "s2c", "foresight"}) {
        const SimulationConfig config = walkOnThePlane(name, room, seed);
        const auto walked = simulate(nullptr, config);
        ASSERT_TRUE(walked);
        // The walk is what was walked virtually, resets left out.
        std::vector<glm::dvec2> path;
        for (const FrameRecord& frame : walked->frames) {
          if (frame.reset) continue;
          if (path.empty() || glm::distance(path.back(), frame.virtualPosition) > 0.2) {
            path.push_back(frame.virtualPosition);
          }
        }
        ClairvoyantSettings settings;
        settings.width = 300;
        const ClairvoyantWalk ceiling =
            clairvoyant(path, walked->frames[0].virtualHeading, PlanarPose{}, config.session.space,
                        config.session.limits, settings);
        EXPECT_LE(ceiling.resets.size(), walked->summary.resets) << name << ' ' << room;
        EXPECT_NEAR(ceiling.metres, 60.0, 3.0);
      }
    }
  }
}

TEST(Clairvoyant, NeedsNoResetWhereTheWalkFitsTheRoom) {
  const std::vector<glm::dvec2> path{{0, 0}, {0, 4}, {3, 4}, {3, -2}};
  const ClairvoyantWalk walk =
      clairvoyant(path, 0.0, PlanarPose{}, *TrackedSpace::rectangle(12, 12), GainLimits{});
  EXPECT_TRUE(walk.resets.empty());
  EXPECT_NEAR(walk.metres, 13.0, 1e-9);
}

}  // namespace
}  // namespace forewalk::rdw
