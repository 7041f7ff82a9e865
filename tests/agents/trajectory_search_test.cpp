#include "agents/trajectory_search.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/agents/trajectory_situations.h"

namespace forewalk::agents {
namespace {

using testing::Dice;
using testing::randomSituation;
using Kind = TrajectoryChoice::Kind;

#ifdef NDEBUG
constexpr int kSmall = 6000, kFull = 250;
#else
constexpr int kSmall = 1500, kFull = 8;  // with sanitizers
#endif

void expectSameChoice(Dice& dice, bool full, int situations, int (&kinds)[3]) {
  TrajectorySearch search;
  TrajectorySituation situation;
  for (int s = 0; s < situations; ++s) {
    randomSituation(dice, full, situation);
    search.prepare(situation.problem);
    const TrajectoryChoice quick = search.best();
    const TrajectoryChoice slow = search.bestByScores();
    ++kinds[static_cast<int>(slow.kind)];
    ASSERT_EQ(quick.kind, slow.kind) << "situation " << s;
    ASSERT_EQ(quick.first, slow.first) << "situation " << s;
    ASSERT_EQ(quick.second, slow.second) << "situation " << s;
    ASSERT_EQ(quick.penalty, slow.penalty) << "situation " << s;
    ASSERT_EQ(quick.hitPoint, slow.hitPoint) << "situation " << s;
  }
}

TEST(TrajectorySearch, ChoosesWhatRatingAllOfThemChooses) {
  Dice dice(1);
  int kinds[3] = {};
  expectSameChoice(dice, false, kSmall, kinds);
  for (const int kind : kinds) EXPECT_GT(kind, kSmall / 200);  // every kind of choice was met
}

TEST(TrajectorySearch, ChoosesTheSameAmong22500) {
  Dice dice(2);
  int kinds[3] = {};
  expectSameChoice(dice, true, kFull, kinds);
  EXPECT_GT(kinds[0], kFull / 4);
}

TEST(TrajectorySearch, SamplesAllOfThemWhenFull) {
  Dice dice(3);
  TrajectorySituation situation;
  randomSituation(dice, true, situation);
  EXPECT_EQ(situation.first.size() * situation.second.size(), 22500u);
}

// The same, written down again without tables, in double precision and on true arcs.
struct Plain {
  double course = 0, speed = 0, agents = 0, obstacles = 0;
  double nearest = 1e30;  // least (distance - hit) of all, metres; below 0 something is hit
};

double pointToSegment(glm::dvec2 p, glm::dvec2 a, glm::dvec2 b) {
  const glm::dvec2 edge = b - a;
  const double squared = glm::dot(edge, edge);
  const double t = squared > 0 ? std::clamp(glm::dot(p - a, edge) / squared, 0.0, 1.0) : 0.0;
  return glm::distance(p, a + t * edge);
}

Plain plainly(const TrajectoryProblem& problem, std::uint32_t first, std::uint32_t second) {
  const std::uint32_t n = problem.points;
  const std::uint32_t half = problem.second.empty() ? n : (n + 1) / 2;
  const glm::dvec2 towards(problem.towards);
  const bool somewhere = problem.towards != glm::vec2(0.0f);
  const double comfort = somewhere ? problem.comfortSpeed : 0.0;
  const double angular =
      problem.weights.angular && somewhere ? factorOfWeight(problem.weights.angularWeight) : 0.0;
  double fastest = 0;
  for (const Command& c : problem.first) fastest = std::max<double>(fastest, c.linear);
  if (half < n) {
    for (const Command& c : problem.second) fastest = std::max<double>(fastest, c.linear);
  }
  double heading = navmesh::headingOf(problem.heading), walked = 0;
  glm::dvec2 place(0.0);
  Plain sum;
  double worstCourse = 0, worstSpeed = 0;
  for (std::uint32_t k = 1; k <= n; ++k) {
    const Command command = k <= half ? problem.first[first] : problem.second[second];
    const glm::dvec2 before = place;
    const double t = problem.step, w = command.angular, v = command.linear;
    if (std::abs(w) < 1e-9) {
      place += v * t * glm::dvec2(-std::sin(heading), std::cos(heading));
    } else {
      place += v / w *
               glm::dvec2(std::cos(heading + w * t) - std::cos(heading),
                          std::sin(heading + w * t) - std::sin(heading));
    }
    heading += w * t;
    const glm::dvec2 looks(-std::sin(heading), std::cos(heading));
    const double last = factorOfWeight(problem.weights.futureWeight);
    const double weight = n > 1 ? 1.0 + (last - 1.0) * (k - 1) / (n - 1) : 1.0;
    const double now = std::min<double>(comfort * t * k, problem.remaining);
    sum.course +=
        weight * (glm::distance(place, towards * now) + angular * glm::distance(looks, towards));
    sum.speed += std::abs(v - (now - walked) / t);
    worstCourse += weight * (now + fastest * t * k + 2.0 * angular);
    worstSpeed += std::max((now - walked) / t, std::abs(fastest - (now - walked) / t));
    walked = now;
    // What is in the way, at a hundred moments.
    for (const PredictedDisc& disc : problem.discs) {
      const auto off = [&](double share) {
        return glm::distance(
            glm::mix(before, place, share),
            glm::dvec2(disc.position) + glm::dvec2(disc.velocity) * (t * (k - 1 + share)));
      };
      for (int m = 0; m <= 100; ++m) sum.nearest = std::min(sum.nearest, off(0.01 * m) - disc.hit);
      sum.nearest = std::min(sum.nearest, off(1.0) - disc.keep);
      const double space = disc.agent ? problem.weights.agentSpace : problem.weights.obstacleSpace;
      double& worst = disc.agent ? sum.agents : sum.obstacles;
      worst = std::max(worst, std::max(1.0 - (off(1.0) - disc.contact) / space, 0.0));
    }
    for (const PredictedWall& wall : problem.walls) {
      const auto off = [&](double share) {
        const glm::dvec2 by = glm::dvec2(wall.velocity) * (t * (k - 1 + share));
        return pointToSegment(glm::mix(before, place, share), glm::dvec2(wall.from) + by,
                              glm::dvec2(wall.to) + by);
      };
      for (int m = 0; m <= 100; ++m) sum.nearest = std::min(sum.nearest, off(0.01 * m) - wall.hit);
      sum.nearest = std::min(sum.nearest, off(1.0) - wall.keep);
      sum.obstacles =
          std::max(sum.obstacles,
                   std::max(1.0 - (off(1.0) - wall.contact) / problem.weights.obstacleSpace, 0.0));
    }
  }
  sum.course /= worstCourse;
  sum.speed /= worstSpeed;
  return sum;
}

TEST(TrajectoryScore, IsWhatTheFormulasSay) {
  Dice dice(4);
  TrajectorySearch search;
  TrajectorySituation situation;
  int free = 0, hit = 0;
  for (int s = 0; s < kSmall / 3; ++s) {
    randomSituation(dice, false, situation);
    if (situation.first.empty()) continue;
    search.prepare(situation.problem);
    const std::uint32_t i = dice.upTo(static_cast<std::uint32_t>(situation.first.size() - 1));
    const std::uint32_t j =
        situation.second.empty()
            ? 0
            : dice.upTo(static_cast<std::uint32_t>(situation.second.size() - 1));
    const TrajectoryScore score = search.score(i, j);
    const Plain plain = plainly(situation.problem, i, j);
    EXPECT_NEAR(score.course, plain.course, 2e-5);
    EXPECT_NEAR(score.speed, plain.speed, 2e-5);
    for (const float one : {score.course, score.speed}) {
      EXPECT_GE(one, 0.0f);
      EXPECT_LE(one, 1.0f + 1e-5f);
    }
    if (plain.nearest > 0.01) {  // the moments are some centimetres apart, the capsules are exact
      EXPECT_EQ(score.hitPoint, 0u);
      EXPECT_NEAR(score.agents, plain.agents, 1e-3);
      EXPECT_NEAR(score.obstacles, plain.obstacles, 1e-3);
      ++free;
    } else if (plain.nearest < -1e-3) {
      EXPECT_NE(score.hitPoint, 0u);
      ++hit;
    }
  }
  EXPECT_GT(free, kSmall / 20);
  EXPECT_GT(hit, kSmall / 20);
}

TEST(TrajectorySearch, IsTheMirroredChoiceInAMirror) {
  Dice dice(5);
  TrajectorySearch search;
  TrajectorySituation there, mirror;
  const auto flip = [](glm::vec2 v) { return glm::vec2(-v.x, v.y); };
  for (int s = 0; s < kSmall / 3; ++s) {
    randomSituation(dice, false, there);
    mirror = there;
    for (Command& command : mirror.first) command.angular = -command.angular;
    for (Command& command : mirror.second) command.angular = -command.angular;
    for (PredictedDisc& disc : mirror.discs) {
      disc.position = flip(disc.position);
      disc.velocity = flip(disc.velocity);
    }
    for (PredictedWall& wall : mirror.walls) {
      wall = {flip(wall.from), flip(wall.to), flip(wall.velocity),
              wall.contact,    wall.hit,      wall.keep};
    }
    mirror.problem.heading = flip(mirror.problem.heading);
    mirror.problem.towards = flip(mirror.problem.towards);
    mirror.problem.first = mirror.first;
    mirror.problem.second = mirror.second;
    mirror.problem.discs = mirror.discs;
    mirror.problem.walls = mirror.walls;
    search.prepare(there.problem);
    const TrajectoryChoice one = search.best();
    search.prepare(mirror.problem);
    const TrajectoryChoice other = search.best();
    EXPECT_EQ(one.kind, other.kind);
    EXPECT_EQ(one.penalty, other.penalty);
    EXPECT_EQ(one.first, other.first);
    EXPECT_EQ(one.second, other.second);
  }
}

TEST(TrajectorySearch, WalksStraightAtComfortSpeedOnOpenGround) {
  TrajectorySituation situation;
  CommandSampling sampling;
  sampling.comfortSpeed = 1.3f;
  sampleCommands(*builtInClips(), sampling, situation.first);
  situation.second = situation.first;
  situation.problem.first = situation.first;
  situation.problem.second = situation.second;
  situation.problem.towards = situation.problem.heading;
  situation.problem.comfortSpeed = 1.3f;
  situation.problem.remaining = 100.0f;
  TrajectorySearch search;
  search.prepare(situation.problem);
  const TrajectoryChoice choice = search.best();
  EXPECT_EQ(choice.kind, Kind::free);
  EXPECT_EQ(situation.first[choice.first], (Command{1.3f, 0.0f}));
  EXPECT_EQ(situation.second[choice.second], (Command{1.3f, 0.0f}));
  EXPECT_NEAR(choice.penalty, 0.0f, 1e-6f);
}

TEST(TrajectorySearch, GivesNothingWhereThereIsNothingToChooseFrom) {
  TrajectorySearch search;
  search.prepare({});
  EXPECT_EQ(search.best().kind, Kind::none);
  EXPECT_EQ(search.bestByScores().kind, Kind::none);
}

TEST(TrajectorySearch, WeightsAreTheSourcesFactors) {
  EXPECT_FLOAT_EQ(factorOfWeight(0.0f), 1.0f);
  EXPECT_FLOAT_EQ(factorOfWeight(1.0f), 1.1f);
  EXPECT_FLOAT_EQ(factorOfWeight(-5.0f), 1.0f / 1.5f);
}

}  // namespace
}  // namespace forewalk::agents
