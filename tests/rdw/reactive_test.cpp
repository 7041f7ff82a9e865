// Every reactive controller with every reset, by laws.

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <random>
#include <set>
#include <utility>

#include "navmesh/random.h"
#include "navmesh/sight.h"
#include "rdw/course.h"
#include "rdw/free_way.h"
#include "rdw/potential_field.h"
#include "rdw/room_shapes.h"
#include "rdw/simulation.h"
#include "tests/support/count_allocations.h"

namespace forewalk::rdw {
namespace {

constexpr std::string_view kReactive[] = {"none",        "s2c",     "s2o", "s2mt",
                                          "s2mt+c",      "zigzag",  "p2r", "messinger",
                                          "dynamic-apf", "haptics", "arc", "visibility"};

TrackedSpace withPillar() {
  const std::vector<glm::dvec2> border{{-4, -4}, {4, -4}, {4, 0}, {0.5, 0}, {0.5, 5}, {-4, 5}};
  const std::vector<std::vector<glm::dvec2>> holes{{{-2, -2}, {-1, -2}, {-1, -1}, {-2, -1}}};
  return *TrackedSpace::polygon(border, holes);
}

/// The published walker: at full speed at once, stops at once.
SimulationConfig toolkit(std::string_view controller, std::string_view reset, TrackedSpace space) {
  SimulationConfig config;
  config.session.space = std::move(space);
  config.session.limits = *gainLimitsByName("toolkit");
  config.session.controller = controller;
  config.session.resetPolicy = reset;
  config.session.reset = {0.0, 1e9, 0.5, 1.0, ResetTrigger::kBorder};
  config.session.alwaysPredict = false;
  config.user.plan = Legs{};
  config.user.walker.reactionTime = 0.0;
  config.user.walker.acceleration = 1e9;
  config.user.walker.deceleration = 1e9;
  config.rate = 60.0;
  config.stop.virtualMetres = 100.0;
  return config;
}

SimulationResult run(const SimulationConfig& config) {
  auto result = simulate(nullptr, config);
  EXPECT_TRUE(result) << (result ? "" : result.error().message);
  return result ? std::move(*result) : SimulationResult{};
}

TEST(Reactive, AnyWithAnyResetStaysInANonConvexRoomWithAPillar) {
  for (const std::string_view controller : kReactive) {
    for (const std::string_view reset : resetNames()) {
      SimulationConfig config = toolkit(controller, reset, withPillar());
      config.session.reset = {};
      config.user.walker = {};
      const SimulationResult result = run(config);
      EXPECT_NE(result.summary.end, WalkEnd::kStuck) << controller << " with " << reset;
      // Whose bent path sweeps over a corner is seen late: then the middle of the head gets past
      // the border by some of what is left of stopping.
      EXPECT_LT(result.summary.violationDepth, 0.05) << controller << " with " << reset;
      EXPECT_GT(result.summary.resets, 0u) << controller << " with " << reset;
      const GainLimits& limits = config.session.limits;
      bool wasReset = false;  // the frame in which one ends still turns the world
      for (const FrameRecord& frame : result.frames) {
        if (!frame.reset && !wasReset) {
          ASSERT_EQ(frame.gains, clamped(frame.gains, limits)) << controller;
        }
        wasReset = frame.reset;
      }
    }
  }
}

// The side by curvature and by rotation alike: a left turn that is sped up steers to the right. A
// rotation gain that stays above 1, or below, while the head turns back is no change.
TEST(Reactive, TurnsTheSideAtMostOnceASecond) {
  for (const std::string_view controller : kReactive) {
    SimulationConfig config = toolkit(controller, "r2g", withPillar());
    config.user.walker.lookAmplitude = 0.6;
    config.user.walker.sway = 0.03;
    config.user.plan = Legs{1.0, 5.0, kPi, false};
    config.seed = 7;
    double since = 10.0;
    int last = 0, lastSense = 0;
    double heading = 0.0;
    int byRotation = 0;
    bool wasReset = false;  // the frame in which one ends still turns the world
    for (const FrameRecord& frame : run(config).frames) {
      since += 1.0 / 60.0;
      const double turn =
          wrapAngle(frame.physicalHeading - std::exchange(heading, frame.physicalHeading));
      if (std::exchange(wasReset, frame.reset) || frame.reset) {
        since = 10.0;
        last = lastSense = 0;
        continue;
      }
      const int sense = frame.gains.rotation > 1 ? 1 : frame.gains.rotation < 1 ? -1 : 0;
      const int curved = frame.gains.curvature > 0 ? 1 : frame.gains.curvature < 0 ? -1 : 0;
      const auto steered = [&](int side) {
        if (last != 0 && side != last) {
          ASSERT_GE(since, 1.0 - 1.5 / 60.0) << controller << " at " << frame.t;
        }
        if (side != last) since = 0.0;
        last = side;
      };
      if (sense != 0 && turn != 0.0) {
        ++byRotation;
        if (sense != lastSense) steered(turn > 0.0 ? -sense : sense);
        lastSense = sense;
      }
      if (curved != 0) {
        steered(curved);
        if (sense == 0) lastSense = 0;
      }
    }
    EXPECT_GT(byRotation, controller == "none" ? -1 : 100) << controller;
  }
}

/// Gains of frames along a random walk in `space`, mapped by `map` and turned by `sign`.
std::vector<Gains> gainsAlong(std::string_view name, const TrackedSpace& space, double mirror,
                              double turned) {
  auto controller = *makeController(name);
  const GainLimits limits = *gainLimitsByName("toolkit");
  controller->prepare(space, limits);
  std::mt19937_64 rng(5);
  std::vector<Gains> gains;
  glm::dvec2 at(0.3, 0.2);
  double heading = 0.4;
  const auto map = [&](glm::dvec2 p) { return rotated({mirror * p.x, p.y}, turned); };
  for (int i = 0; i < 600; ++i) {
    const double turn = navmesh::uniform(rng, -0.03, 0.035);
    heading += turn;
    const glm::dvec2 step = directionOf(heading) * (at.x * at.x + at.y * at.y > 4.0 ? 0.0 : 0.015);
    at += step;
    if (i % 150 == 149) {
      at = {0.3, 0.2};
      controller->restart();
    }
    Motion motion;
    motion.dt = 1.0 / 60.0;
    motion.step = map(step);
    motion.distance = glm::length(step);
    motion.turn = mirror * turn;
    motion.turnRate = motion.turn * 60.0;
    motion.speed = motion.distance * 60.0;
    motion.walking = motion.speed > 0.3;
    if (motion.walking) motion.walkingDirection = motion.step / motion.distance;
    const PlanarPose pose{map(at), wrapAngle(mirror * heading + turned)};
    const OtherUser other{map({1.5, -1.0}), map({0.4, 0.8}), map(directionOf(1.0)), 0.5};
    gains.push_back(controller->steer(
        {motion, pose, pose, space, limits, Redirection{}, nullptr, {}, {&other, 1}}));
  }
  return gains;
}

TrackedSpace roomOf(double mirror, double turned) {
  std::vector<glm::dvec2> corners;
  for (glm::dvec2 c : {glm::dvec2(-3.1, -3), {3.4, -2.6}, {3, 3.2}, {0, 2.5}, {-2.7, 3.6}})
    corners.push_back(rotated({mirror * c.x, c.y}, turned));
  return *TrackedSpace::polygon(corners);
}

// Targets that are searched for agree to a millimetre, so that gains do to a little.
TEST(Reactive, IsTheSameInAMirror) {
  for (const std::string_view name : kReactive) {
    const auto plain = gainsAlong(name, roomOf(1, 0), 1, 0);
    const auto mirrored = gainsAlong(name, roomOf(-1, 0), -1, 0);
    int off = 0;
    for (std::size_t i = 0; i < plain.size(); ++i) {
      off += std::abs(plain[i].curvature + mirrored[i].curvature) > 2e-3f ||
             std::abs(plain[i].rotation - mirrored[i].rotation) > 1e-2f ||
             std::abs(plain[i].translation - mirrored[i].translation) > 1e-2f;
    }
    EXPECT_LE(off, 12) << name;
  }
}

TEST(Reactive, IsTheSameInARoomThatIsTurned) {
  for (const std::string_view name : kReactive) {
    const auto plain = gainsAlong(name, roomOf(1, 0), 1, 0);
    const auto turned = gainsAlong(name, roomOf(1, 1.1), 1, 1.1);
    int off = 0;
    for (std::size_t i = 0; i < plain.size(); ++i) {
      off += std::abs(plain[i].curvature - turned[i].curvature) > 2e-3f ||
             std::abs(plain[i].rotation - turned[i].rotation) > 1e-2f ||
             std::abs(plain[i].translation - turned[i].translation) > 1e-2f;
    }
    EXPECT_LE(off, 12) << name;
  }
}

/// A walk and turn fed to a session frame by frame; the world's turn in all.
double injectedAt(std::string_view controller, double rate) {
  navmesh::PolygonMesh square;
  for (const auto& [x, z] : {std::pair{-500.0f, 500.0f}, {500, 500}, {500, -500}, {-500, -500}}) {
    square.vertices.push_back({x, 0, z});
    square.ring.push_back(static_cast<std::uint32_t>(square.ring.size()));
  }
  square.ringStart.push_back(4);
  const auto world =
      std::make_shared<const navmesh::World>(navmesh::makeWorld(*navmesh::makeNavGraph(square)));
  SessionSettings settings;
  settings.space = *TrackedSpace::rectangle(12, 9);
  settings.limits = *gainLimitsByName("toolkit");
  settings.controller = controller;
  settings.alwaysPredict = false;
  settings.resets = false;
  Session session = std::move(*Session::make(world, settings));
  double injected = 0.0;
  // 4 m to the left of straight on, a turn of 1 rad within 2 s, 3 m on.
  for (int i = 0; i <= static_cast<int>(9.0 * rate); ++i) {
    const double t = i / rate;
    const double heading = -0.3 + 0.5 * std::clamp(t - 4.0, 0.0, 2.0);
    const double first = std::min(t, 4.0);
    const double second = std::max(0.0, t - 6.0);
    const glm::dvec2 at =
        glm::dvec2(1.0, -3.0) + first * directionOf(-0.3) + second * directionOf(0.7);
    HeadPose head;
    head.position = navmesh::toSpace(glm::vec2(at), 1.7f);
    head.orientation = glm::quat(static_cast<float>(std::cos(0.5 * heading)), 0.0f,
                                 static_cast<float>(std::sin(0.5 * heading)), 0.0f);
    injected += std::abs(session.frame(head, t).injectedYaw);
  }
  return injected;
}

TEST(Reactive, InjectsTheSameAtAnyFrameRate) {
  for (const std::string_view name : kReactive) {
    const double reference = injectedAt(name, 90.0);
    for (const double rate : {20.0, 60.0, 144.0}) {
      const double injected = injectedAt(name, rate);
      std::printf("%-12s %3.0f Hz %.4f rad, 90 Hz %.4f rad\n", std::string(name).c_str(), rate,
                  injected, reference);
      EXPECT_NEAR(injected, reference, 0.02 * reference) << name << " at " << rate;
    }
  }
}

// With resets a walk is chaotic: a trigger seen a frame later is another walk. So the mean over
// many: within 2 % where two standard errors of the difference do not say more.
TEST(Reactive, IsStoppedAsOftenAtAnyFrameRate) {
  constexpr int kSeeds = 12;
  for (const auto& [controller, reset] :
       {std::pair{"s2c", "two-one-turn"}, std::pair{"p2r", "r2g"}}) {
    const auto resetsAt = [&](double rate) {
      double sum = 0.0, squares = 0.0;
      for (int seed = 1; seed <= kSeeds; ++seed) {
        SimulationConfig config = toolkit(controller, reset, *TrackedSpace::rectangle(6, 6));
        config.session.reset = {};
        config.user.walker = {};
        config.user.plan = Legs{2.0, 8.0, kPi, false};
        config.stop.virtualMetres = 400.0;
        config.rate = rate;
        config.keepFrames = false;
        config.seed = static_cast<std::uint64_t>(seed);
        const double resets = static_cast<double>(run(config).summary.resets);
        sum += resets;
        squares += resets * resets;
      }
      const double mean = sum / kSeeds;
      return std::pair{mean, (squares - sum * mean) / (kSeeds - 1) / kSeeds};
    };
    const auto [reference, variance] = resetsAt(90.0);
    for (const double rate : {20.0, 30.0, 60.0, 144.0}) {
      const auto [mean, own] = resetsAt(rate);
      std::printf("%-4s %3.0f Hz %.1f resets, 90 Hz %.1f: %+.1f %%\n", controller, rate, mean,
                  reference, 100.0 * (mean / reference - 1.0));
      EXPECT_NEAR(mean, reference, 0.02 * reference + 2.0 * std::sqrt(variance + own))
          << controller << " at " << rate;
    }
  }
}

TEST(Reactive, AllocatesNothingInAFrameAndRestartsLikeNew) {
  const TrackedSpace space = withPillar();
  const GainLimits limits = *gainLimitsByName("toolkit");
  for (const std::string_view name : kReactive) {
    auto used = *makeController(name);
    auto fresh = *makeController(name);
    used->prepare(space, limits);
    fresh->prepare(space, limits);
    const OtherUser other{{1, -1}, {0, 1}, {0, 1}, 0.5};
    Motion motion;
    motion.dt = 1.0 / 90.0;
    motion.step = {0.0, 0.011};
    motion.distance = 0.011;
    motion.walking = true;
    motion.speed = 1.0;
    motion.walkingDirection = {0, 1};
    const auto steer = [&](Controller& controller, int i) {
      const PlanarPose pose{{-3.0 + 0.01 * i, -3.0}, 0.02 * i};
      motion.turn = 0.01 * (i % 3);
      motion.turnRate = motion.turn * 90.0;
      return controller.steer(
          {motion, pose, pose, space, limits, Redirection{}, nullptr, {}, {&other, 1}});
    };
    steer(*used, 0);
    testing::allocationsSince();
    for (int i = 0; i < 100; ++i) steer(*used, i);
    EXPECT_EQ(testing::allocationsSince(), 0u) << name;
    used->restart();
    for (int i = 0; i < 100; ++i) ASSERT_EQ(steer(*used, i), steer(*fresh, i)) << name << i;
  }
}

TEST(Resets, EndFacingWhatTheyPromiseAndTheSameVirtualWay) {
  const TrackedSpace room = *TrackedSpace::rectangle(6, 6);
  const std::map<std::string_view, glm::dvec2> faced{
      {"r2c", {-1, 0}}, {"mr2c", {-1, 0}}, {"r2g", {-1, 0}}, {"sfr2g", {-1, 0}}};
  for (const auto& [name, direction] : faced) {
    auto policy = *makeReset(name);
    Motion motion;
    motion.walking = true;
    motion.walkingDirection = directionOf(-kPi / 2 + 0.4);
    const PlanarPose pose{{2.8, 0.0}, -kPi / 2 + 0.4};
    const GainLimits limits;
    const ResetPlan plan = policy->plan({motion, pose, pose, room, limits, Redirection{}, nullptr});
    const double turn = std::isfinite(plan.left) ? plan.left : -plan.right;
    const glm::dvec2 end = rotated(motion.walkingDirection, turn);
    EXPECT_NEAR(glm::distance(end, direction), 0.0, 1e-3) << name;
    EXPECT_GE(std::abs(turn), kPi);
    EXPECT_LE(std::abs(turn), 2.0 * kPi) << name;
    EXPECT_DOUBLE_EQ(plan.seen, 2.0 * kPi);
  }
}

TEST(Resets, StopForSomebodyElse) {
  const TrackedSpace room = *TrackedSpace::rectangle(10, 10);
  auto policy = *makeReset("two-one-turn");
  const GainLimits limits;
  double stoppedAt[2];
  for (const double towards : {0.0, 1.0}) {
    Reset reset;
    double y = -4.0;
    for (; y < 4.0; y += 1.0 / 60.0) {
      Motion motion;
      motion.dt = 1.0 / 60.0;
      motion.step = {0, 1.0 / 60.0};
      motion.distance = motion.step.y;
      motion.speed = 1.0;
      motion.walking = true;
      motion.walkingDirection = {0, 1};
      const OtherUser other{{0.1, 1.0}, {0, -towards}, {0, -1}, 0.5};
      const PlanarPose pose{{0, y}, 0.0};
      if (reset
              .frame({motion, pose, pose, room, limits, Redirection{}, nullptr, {}, {&other, 1}},
                     *policy)
              .began)
        break;
    }
    stoppedAt[static_cast<int>(towards)] = y;
    EXPECT_LT(y, 0.5 - 0.2);
    EXPECT_GT(y, -1.5);
  }
  EXPECT_LT(stoppedAt[1], stoppedAt[0] - 0.3) << "earlier for somebody who comes closer";
}

TEST(PotentialField, IsTheGradientOfTheInverseDistances) {
  const TrackedSpace room = *TrackedSpace::rectangle(6, 4);
  const auto energy = [](glm::dvec2 p) {
    return 1 / (3 - p.x) + 1 / (3 + p.x) + 1 / (2 - p.y) + 1 / (2 + p.y);
  };
  std::mt19937_64 rng(3);
  for (int i = 0; i < 100; ++i) {
    const glm::dvec2 p(navmesh::uniform(rng, -2.7, 2.7), navmesh::uniform(rng, -1.7, 1.7));
    const double h = 1e-5;
    const glm::dvec2 slope((energy(p + glm::dvec2(h, 0)) - energy(p - glm::dvec2(h, 0))) / (2 * h),
                           (energy(p + glm::dvec2(0, h)) - energy(p - glm::dvec2(0, h))) / (2 * h));
    EXPECT_NEAR(glm::distance(repulsion(room, {}, p), -slope), 0.0,
                1e-4 * (1 + glm::length(slope)));
  }
}

TEST(RoomShapes, HaveTheAreaAskedFor) {
  for (const std::string_view name : roomShapeNames()) {
    const auto room = roomShape(name, 36.0);
    ASSERT_TRUE(room) << name;
    EXPECT_NEAR(room->area(), 36.0, 1e-9) << name;
    EXPECT_GT(room->signedDistance(room->centre()), 0.5) << name;
  }
  EXPECT_FALSE(roomShape("star", 36.0));
  EXPECT_FALSE(roomShape("L", 0.0));
}

TEST(Courses, CloseTheirCircles) {
  std::mt19937_64 rng(1);
  for (const CourseKind kind : {CourseKind::kCircle, CourseKind::kFigureEight}) {
    CoursePoints points({kind, 3.0}, {});
    glm::dvec2 at(0.0);
    double furthest = 0.0;
    for (int i = 0; i < 144; ++i) {
      at = points.next(rng);
      furthest = std::max(furthest, glm::length(at));
    }
    EXPECT_NEAR(glm::length(at), 0.0, 1e-9);
    EXPECT_NEAR(furthest, 6.0, 0.01);
  }
}

}  // namespace
}  // namespace forewalk::rdw
