#include "prediction/likelihood.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <random>

#include "navmesh/random.h"
#include "tests/support/count_allocations.h"
#include "tests/support/line_world.h"

namespace forewalk::prediction {
namespace {

using testing::lineGraph;
using testing::LineWay;

constexpr double kPi = 3.14159265358979323846;

glm::dvec2 along(double angle) { return {std::cos(angle), std::sin(angle)}; }

WayFacts factsToward(double angle) {
  WayFacts way;
  way.near = way.far = along(angle);
  way.distance = 5.0;
  return way;
}

double total(std::span<const double> probabilities, double none) {
  return std::accumulate(probabilities.begin(), probabilities.end(), none);
}

/// Walks to a T and looks into both arms: at (6, 0), then on a curve to the left.
glm::vec2 walkAt(double seconds) {
  const double s = 1.0 * seconds;
  if (s < 4.0) return {static_cast<float>(s), 0.0f};
  const double turn = std::min(s - 4.0, 2.0);
  return {static_cast<float>(4.0 + std::sin(turn * 0.6) / 0.6),
          static_cast<float>((1.0 - std::cos(turn * 0.6)) / 0.6)};
}

/// Ways of somebody at `plan` before a T at x = 8.
PredictionGraph graphAt(glm::vec2 plan, bool mirrored = false) {
  const float beyond = 5.0f - glm::distance(plan, glm::vec2(8, 0));
  std::vector<LineWay> ways{{{{plan.x - 5.0f, 0.0f}}}};
  if (beyond > 0.0f) {
    ways.push_back({{{8, 0}, {8, beyond}}});
    ways.push_back({{{8, 0}, {8, -beyond}}});
  } else {
    ways.push_back({{{plan.x + 5.0f, 0}}});
  }
  if (mirrored) {
    plan.y = -plan.y;
    for (LineWay& way : ways) {
      for (glm::vec2& point : way.points) point.y = -point.y;
    }
  }
  return lineGraph(plan, 5.0f, ways);
}

TEST(WayFilter, GivesAllToNoneWhereThereIsNoWay) {
  WayFilter filter(4);
  filter.step({}, {1.0, 1.0, {1, 0}, {}, {}}, {});
  EXPECT_EQ(filter.none(), 1.0);
  EXPECT_TRUE(filter.probabilities().empty());
}

TEST(WayFilter, GivesNothingToADeadEndThatTheUserStandsIn) {
  WayFacts here = factsToward(0.0);
  here.deadEnd = true;
  here.distance = 0.5 * kArrived;
  WayFilter filter(2);
  const std::vector<WayFacts> ways{here, factsToward(kPi)};
  filter.step(ways, {1.0, 1.0, {1, 0}, {}, {}}, {});
  EXPECT_EQ(filter.probabilities()[0], 0.0);
  EXPECT_GT(filter.probabilities()[1], 0.0);
}

TEST(WayFilter, SumsToOneWhateverHappens) {
  std::mt19937_64 rng(1);
  WayFilter filter(20);
  std::size_t last = 0;
  for (int round = 0; round < 2000; ++round) {
    std::vector<WayFacts> ways(static_cast<std::size_t>(navmesh::uniformInt(rng, 20)));
    for (WayFacts& way : ways) {
      way = factsToward(navmesh::uniform(rng, -kPi, kPi));
      way.far = along(navmesh::uniform(rng, -kPi, kPi));
      way.distance = navmesh::uniform(rng, 0.0, 20.0);
      way.deadEnd = navmesh::uniform(rng) < 0.3;
      way.retrace = navmesh::uniform(rng);
      way.before = navmesh::uniformInt(rng, static_cast<int>(last) + 1) - 1;
    }
    Walked walked{navmesh::uniform(rng, 0.0, 3.0),
                  navmesh::uniform(rng, 0.0, 3.0),
                  along(navmesh::uniform(rng, -kPi, kPi)),
                  {},
                  {}};
    if (round % 3 == 0) walked.head = along(navmesh::uniform(rng, -kPi, kPi));
    if (round % 5 == 0) walked = {};
    filter.step(ways, walked, {});
    for (const double p : filter.probabilities()) {
      EXPECT_GE(p, 0.0);
      EXPECT_LE(p, 1.0);
    }
    EXPECT_NEAR(total(filter.probabilities(), filter.none()), 1.0, 1e-12);
    last = ways.size();
  }
}

TEST(WayFilter, WeighsDirectionsByADensityOnTheCircle) {
  // Odds of a way against none, averaged over all walking directions, are those of the prior: a
  // density over the uniform one has mean 1.
  for (const double concentration : {0.0, 0.7, 3.0, 3.8, 12.0}) {
    LikelihoodParameters parameters;
    parameters.concentration = concentration;
    parameters.steady = 1.0;
    double sum = 0.0;
    constexpr int kDirections = 3600;
    for (int i = 0; i < kDirections; ++i) {
      WayFilter filter(1);
      const std::vector<WayFacts> ways{factsToward(0.3)};
      filter.step(ways, {1.0, 0.0, along(2.0 * kPi * i / kDirections), {}, {}}, parameters);
      sum += filter.probabilities()[0] / filter.none() * parameters.noneShare;
    }
    EXPECT_NEAR(sum / kDirections, 1.0, 1e-6) << "concentration " << concentration;
  }
}

TEST(WayFilter, IsTheSameInOneStepAndInAHundred) {
  std::vector<WayFacts> ways{factsToward(0.2), factsToward(1.5), factsToward(-2.0)};
  WayFilter once(3), often(3);
  for (WayFilter* filter : {&once, &often}) filter->step(ways, {0.5, 0.5, along(1.0), {}, {}}, {});
  for (std::size_t i = 0; i < ways.size(); ++i) ways[i].before = static_cast<std::int32_t>(i);
  const Walked walked{0.8, 1.2, along(-0.5), along(0.9), {}};
  once.step(ways, walked, {});
  Walked part = walked;
  part.metres /= 100.0;
  part.seconds /= 100.0;
  for (int i = 0; i < 100; ++i) often.step(ways, part, {});
  for (std::size_t i = 0; i < ways.size(); ++i) {
    EXPECT_NEAR(once.probabilities()[i], often.probabilities()[i], 1e-9);
  }
}

TEST(WayFilter, AddsUpEvidence) {
  std::vector<WayFacts> ways{factsToward(0.4), factsToward(-0.4)};
  WayFilter filter(2);
  filter.step(ways, {}, {});
  EXPECT_DOUBLE_EQ(filter.probabilities()[0], filter.probabilities()[1]);
  for (std::size_t i = 0; i < 2; ++i) ways[i].before = static_cast<std::int32_t>(i);
  double last = filter.probabilities()[0];
  for (int i = 0; i < 30; ++i) {
    filter.step(ways, {0.02, 0.02, along(0.4), {}, {}}, {});
    EXPECT_GT(filter.probabilities()[0], last);
    last = filter.probabilities()[0];
  }
}

TEST(WayFilter, IsNotResetByStandingStill) {
  std::vector<WayFacts> ways{factsToward(0.6), factsToward(-0.6)};
  WayFilter filter(2);
  filter.step(ways, {2.0, 2.0, along(0.6), {}, {}}, {});
  for (std::size_t i = 0; i < 2; ++i) ways[i].before = static_cast<std::int32_t>(i);
  const double walked = std::log(filter.probabilities()[0] / filter.probabilities()[1]);
  // Turning on the spot has a direction, but no metres.
  for (int i = 0; i < 60; ++i) filter.step(ways, {0.0, 0.05, along(0.1 * i), {}, {}}, {});
  const double stood = std::log(filter.probabilities()[0] / filter.probabilities()[1]);
  EXPECT_NEAR(stood / walked, std::exp(-3.0 / LikelihoodParameters{}.forgetSeconds), 1e-9);
  EXPECT_GT(stood / walked, 0.6);
}

TEST(WayFilter, BelievesHeadAndGazeWhereThereAreAny) {
  const std::vector<WayFacts> ways{factsToward(0.6), factsToward(-0.6)};
  WayFilter plain(2), head(2), gaze(2);
  plain.step(ways, {0.0, 0.1, {}, {}, {}}, {});
  head.step(ways, {0.0, 0.1, {}, along(0.6), {}}, {});
  gaze.step(ways, {0.0, 0.1, {}, {}, along(-0.6)}, {});
  EXPECT_DOUBLE_EQ(plain.probabilities()[0], plain.probabilities()[1]);
  EXPECT_GT(head.probabilities()[0], head.probabilities()[1]);
  EXPECT_LT(gaze.probabilities()[0], gaze.probabilities()[1]);
}

TEST(WayFilter, KeepsMassBehindTheUser) {
  const std::vector<WayFacts> ways{factsToward(0.0), factsToward(kPi)};
  WayFilter filter(2);
  filter.step(ways, {100.0, 100.0, along(0.0), {}, {}}, {});
  EXPECT_GT(filter.probabilities()[1], 0.01);
  EXPECT_LT(filter.probabilities()[1], 0.4);
}

TEST(WayLikelihood, IsMirroredInAMirroredScene) {
  WayLikelihood one, other;
  for (int f = 0; f < 90; ++f) {
    const glm::vec2 plan = walkAt(f / 15.0);
    const Evidence evidence{f == 0 ? 0.0 : 1.0 / 15.0, along(0.3), {}};
    Evidence mirrored = evidence;
    mirrored.head->y = -mirrored.head->y;
    one.update(graphAt(plan), evidence);
    other.update(graphAt(plan, true), mirrored);
    ASSERT_EQ(one.probabilities().size(), other.probabilities().size());
    for (std::size_t i = 0; i < one.probabilities().size(); ++i) {
      EXPECT_DOUBLE_EQ(one.probabilities()[i], other.probabilities()[i]) << "frame " << f;
    }
  }
}

TEST(WayLikelihood, HardlyDependsOnTheFrameRate) {
  std::vector<std::vector<double>> atEnd;
  for (const int rate : {15, 30, 60}) {
    WayLikelihood likelihood;
    for (int f = 0; f <= 5 * rate; ++f) {
      likelihood.update(graphAt(walkAt(static_cast<double>(f) / rate)),
                        {f == 0 ? 0.0 : 1.0 / rate, {}, {}});
    }
    atEnd.emplace_back(likelihood.probabilities().begin(), likelihood.probabilities().end());
    EXPECT_EQ(atEnd.back().size(), 3u);
  }
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_NEAR(atEnd[0][i], atEnd[2][i], 0.02);
    EXPECT_NEAR(atEnd[1][i], atEnd[2][i], 0.01);
  }
}

TEST(WayLikelihood, ReplaysToTheLastBitAndFromARestart) {
  WayLikelihood one, other;
  for (int f = 0; f < 20; ++f)
    other.update(graphAt({0.1f * static_cast<float>(f), 1.0f}), {0.1, {}, {}});
  other.restart();
  for (int f = 0; f < 90; ++f) {
    const PredictionGraph graph = graphAt(walkAt(f / 15.0));
    one.update(graph, {1.0 / 15.0, {}, {}});
    other.update(graph, {1.0 / 15.0, {}, {}});
    ASSERT_EQ(one.probabilities().size(), other.probabilities().size());
    for (std::size_t i = 0; i < one.probabilities().size(); ++i) {
      EXPECT_EQ(one.probabilities()[i], other.probabilities()[i]);
    }
    EXPECT_EQ(one.none(), other.none());
    EXPECT_EQ(one.placeAfter(graph, 2.0), other.placeAfter(graph, 2.0));
  }
}

TEST(WayLikelihood, FavoursTheArmThatIsWalkedInto) {
  WayLikelihood likelihood;
  for (int f = 0; f <= 90; ++f) likelihood.update(graphAt(walkAt(f / 15.0)), {1.0 / 15.0, {}, {}});
  ASSERT_EQ(likelihood.probabilities().size(), 3u);
  // Behind was just walked.
  EXPECT_LT(likelihood.probabilities()[0], 0.2);
}

TEST(WayLikelihood, AllocatesNothingOnceItIsMade) {
  std::vector<PredictionGraph> frames;
  for (int f = 0; f < 90; ++f) frames.push_back(graphAt(walkAt(f / 15.0)));
  WayLikelihood likelihood;
  testing::allocationsSince();
  for (const PredictionGraph& frame : frames) {
    likelihood.update(frame, {1.0 / 15.0, along(0.1), along(0.2)});
    EXPECT_TRUE(std::isfinite(likelihood.placeAfter(frame, 3.2).x));
  }
  EXPECT_EQ(testing::allocationsSince(), 0u);
}

TEST(WalkingMotion, FindsASteadyVelocityAtAnyFrameRate) {
  for (const int rate : {5, 15, 60, 200}) {
    WalkingMotion motion;
    for (int f = 0; f <= 3 * rate; ++f) {
      const float s = static_cast<float>(f) / static_cast<float>(rate);
      motion.update({1.2f * s, -0.5f * s}, 1.0 / rate);
    }
    EXPECT_NEAR(motion.velocity().x, 1.2, 1e-4);
    EXPECT_NEAR(motion.velocity().y, -0.5, 1e-4);
    EXPECT_NEAR(glm::length(motion.direction()), 1.0, 1e-12);
  }
}

TEST(WalkingMotion, KeepsItsDirectionWhileStanding) {
  WalkingMotion motion;
  EXPECT_EQ(motion.direction(), glm::dvec2(0.0));
  for (int f = 0; f < 30; ++f) motion.update({0.05f * static_cast<float>(f), 0.0f}, 0.05);
  for (int f = 0; f < 100; ++f) motion.update({1.45f, 0.0f}, 0.05);
  EXPECT_NEAR(motion.direction().x, 1.0, 1e-9);
  EXPECT_LT(glm::length(motion.velocity()), 1e-3);
}

TEST(PathSoFar, KnowsWhereTheUserWasAndForgetsWhatIsTooFarBack) {
  PathSoFar path;
  EXPECT_EQ(path.beenAt({0, 0}).recent, 0.0);
  for (int i = 0; i <= 1000; ++i) path.add({0.1f * static_cast<float>(i), 0.0f});
  EXPECT_EQ(path.beenAt({98.0f, 0.2f}).recent, 1.0);
  EXPECT_EQ(path.beenAt({98.0f, 0.2f}).earlier, 0.0);
  EXPECT_EQ(path.beenAt({80.0f, 0.2f}).recent, 0.0);
  EXPECT_EQ(path.beenAt({80.0f, 0.2f}).earlier, 1.0);
  EXPECT_EQ(path.beenAt({80.0f, 2.0f}).earlier, 0.0);
  EXPECT_EQ(path.beenAt({100.0f - 70.0f, 0.0f}).earlier, 0.0);
}

TEST(PathSoFar, IsTheSameInLongSteps) {
  PathSoFar small, large;
  for (int i = 0; i <= 300; ++i) small.add({0.1f * static_cast<float>(i), 0.0f});
  for (int i = 0; i <= 10; ++i) large.add({3.0f * static_cast<float>(i), 0.0f});
  for (float x = 0.0f; x < 32.0f; x += 0.7f) {
    EXPECT_NEAR(small.beenAt({x, 0.5f}).recent, large.beenAt({x, 0.5f}).recent, 1e-4) << x;
    EXPECT_NEAR(small.beenAt({x, 0.5f}).earlier, large.beenAt({x, 0.5f}).earlier, 1e-4) << x;
  }
}

TEST(Progress, IsConstantSpeedForWhoWalksAtCruise) {
  LikelihoodParameters parameters;
  for (const double t : {0.0, 0.3, 2.0, 10.0}) {
    EXPECT_NEAR(progress(parameters.cruise, t, parameters), parameters.cruise * t, 1e-12);
    EXPECT_LE(progress(0.0, t, parameters), parameters.cruise * t);
    EXPECT_GE(progress(2.0, t, parameters), parameters.cruise * t);
  }
}

TEST(ExpectedPlace, IsOnTheWayWhereThereIsOneAndTheWalkFollowsIt) {
  LikelihoodParameters parameters;
  parameters.cruise = 1.0;
  const std::vector<double> sure{1.0};
  const auto straight = [](std::size_t, double s) { return glm::dvec2(2.0 + s, 3.0); };
  for (const double t : {0.0, 0.5, 3.0}) {
    const glm::dvec2 place = expectedPlace({2, 3}, {1, 0}, sure, 0.0, t, parameters, straight);
    EXPECT_NEAR(place.x, 2.0 + t, 1e-9);
    EXPECT_NEAR(place.y, 3.0, 1e-9);
  }
}

}  // namespace
}  // namespace forewalk::prediction
