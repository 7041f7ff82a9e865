#include "agents/locomotion.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "agents/clip_triangulation.h"
#include "agents/command_samples.h"
#include "tests/agents/trajectory_situations.h"

namespace forewalk::agents {
namespace {

std::vector<MotionClip> clipsAt(std::vector<Command> motions) {
  std::vector<MotionClip> clips;
  for (const Command& motion : motions) clips.push_back({"", motion});
  return clips;
}

void expectBlendGivesBack(const LocomotionDatabase& clips, Command motion) {
  const auto blend = clips.blend(motion);
  ASSERT_TRUE(blend.has_value()) << motion.linear << " m/s, " << motion.angular << " rad/s";
  float sum = 0.0f;
  for (const float weight : blend->weight) {
    EXPECT_GE(weight, 0.0f);
    sum += weight;
  }
  EXPECT_NEAR(sum, 1.0f, 1e-6f);
  EXPECT_NEAR(clips.motionOf(*blend).linear, motion.linear, 3.0f * kClipTolerance);
  EXPECT_NEAR(clips.motionOf(*blend).angular, motion.angular, 3.0f * kClipTolerance);
}

TEST(Locomotion, BuiltInTrianglesAreThoseOfDelaunay) {
  const auto& built = *builtInClips();
  const auto made =
      triangulateClips(std::vector<MotionClip>(built.clips().begin(), built.clips().end()));
  ASSERT_TRUE(made.has_value());
  EXPECT_TRUE(std::equal(built.triangles().begin(), built.triangles().end(),
                         made->triangles().begin(), made->triangles().end()));
}

// No clip lies inside the circle through the corners of any triangle, and the triangles cover the
// hull: that is what Delaunay means, and no other library is asked.
TEST(Locomotion, TrianglesOfRandomClipsAreDelaunay) {
  testing::Dice dice(7);
  for (int round = 0; round < 50; ++round) {
    std::vector<MotionClip> clips;
    const std::uint32_t count = 3 + dice.upTo(40);
    for (std::uint32_t c = 0; c < count; ++c) {
      clips.push_back({"", {dice.between(0.0f, 3.0f), dice.between(-2.0f, 2.0f)}});
    }
    const auto made = triangulateClips(clips);
    ASSERT_TRUE(made.has_value());
    for (const ClipTriangle& t : made->triangles()) {
      const auto at = [&](std::size_t k) {
        return glm::dvec2(clips[t[k]].motion.linear, clips[t[k]].motion.angular);
      };
      for (const MotionClip& clip : clips) {
        const glm::dvec2 p(clip.motion.linear, clip.motion.angular);
        const glm::dvec2 a = at(0) - p, b = at(1) - p, c = at(2) - p;
        const double in = glm::dot(a, a) * (b.x * c.y - b.y * c.x) -
                          glm::dot(b, b) * (a.x * c.y - a.y * c.x) +
                          glm::dot(c, c) * (a.x * b.y - a.y * b.x);
        EXPECT_LE(in, 1e-9);  // counter-clockwise corners
      }
    }
    // Any mean of clips lies in some triangle.
    for (int k = 0; k < 20; ++k) {
      const Command a = clips[dice.upTo(count - 1)].motion, b = clips[dice.upTo(count - 1)].motion;
      const float s = dice.between(0.0f, 1.0f);
      expectBlendGivesBack(
          *made, {a.linear + s * (b.linear - a.linear), a.angular + s * (b.angular - a.angular)});
    }
  }
}

TEST(Locomotion, WhatLiesOutsideCannotBePlayed) {
  EXPECT_FALSE(builtInClips()->blend({3.1f, 0.0f}));
  EXPECT_FALSE(builtInClips()->blend({3.0f, 0.6f}));
  EXPECT_FALSE(builtInClips()->blend({0.5f, -2.0f}));
  EXPECT_TRUE(builtInClips()->blend({3.0f, 0.5f}));
}

TEST(Locomotion, LimitsOfTurningAreThoseOfTheTriangles) {
  testing::Dice dice(8);
  for (int k = 0; k < 300; ++k) {
    const float linear = dice.between(0.0f, 3.0f);
    const auto [low, high] = builtInClips()->angularAt(linear);
    EXPECT_EQ(low, -high);
    EXPECT_TRUE(builtInClips()->blend({linear, high - 1e-5f}));
    EXPECT_FALSE(builtInClips()->blend({linear, high + 0.01f}));
  }
  const auto [low, high] = builtInClips()->angularAt(3.5f);
  EXPECT_GT(low, high);
}

TEST(Locomotion, ClipsOnOneLineMakeAChain) {
  const auto chain = triangulateClips(
      clipsAt({{1.3f, 0.0f}, {0.0f, 0.0f}, {2.0f, 0.0004f}, {0.7f, -0.0004f}, {1.3f, 0.0f}}));
  ASSERT_TRUE(chain.has_value());
  EXPECT_TRUE(chain->triangles().empty());
  ASSERT_EQ(chain->chain().size(), 4u);
  for (const float speed : {0.0f, 0.3f, 0.7f, 1.0f, 1.3f, 1.9f, 2.0f}) {
    expectBlendGivesBack(*chain, {speed, 0.0f});
  }
  EXPECT_FALSE(chain->blend({1.0f, 0.1f}));
  EXPECT_FALSE(chain->blend({2.1f, 0.0f}));
  EXPECT_FALSE(
      triangulateClips(clipsAt({{0.0f, 0.0f}, {1.0f, 0.0f}, {2.0f, 0.01f}}))->triangles().empty());
}

TEST(Locomotion, OneClipPlaysItself) {
  const auto one = triangulateClips(clipsAt({{1.0f, 0.5f}}));
  ASSERT_TRUE(one.has_value());
  expectBlendGivesBack(*one, {1.0f, 0.5f});
  EXPECT_FALSE(one->blend({1.1f, 0.5f}));
  std::vector<Command> commands;
  sampleCommands(*one, {}, commands);
  EXPECT_EQ(commands, (std::vector<Command>{{1.0f, 0.5f}}));
}

TEST(Locomotion, RefusesWhatCannotBePlayedWithOneClearLine) {
  const auto message = [](std::vector<Command> motions) {
    return triangulateClips(clipsAt(std::move(motions))).error().message;
  };
  EXPECT_EQ(message({}), "there are no motion clips: give one or more.");
  EXPECT_EQ(message({{1.0f, 0.0f}, {-0.5f, 0.0f}}),
            "motion clip 1 (\"\") walks at -0.5 m/s: it has to be 0 m/s or more.");
  EXPECT_EQ(message({{1.0f, NAN}}),
            "motion clip 0 (\"\") turns at nan rad/s: it has to be finite.");
  EXPECT_EQ(
      LocomotionDatabase::make(clipsAt({{0, 0}, {1, 0}, {1, 1}}), {{0, 1, 3}}).error().message,
      "a triangle of motion clips names clip 3, there are 3.");
}

TEST(Locomotion, ReplaysWithinWhatLooksNatural) {
  EXPECT_FLOAT_EQ(replayRatio(1.0f, 1.25f), 0.8f);
  EXPECT_FLOAT_EQ(replayRatio(0.1f, 1.0f), 0.3f);
  EXPECT_FLOAT_EQ(replayRatio(3.0f, 1.0f), 1.2f);
  EXPECT_FLOAT_EQ(replayRatio(1.0f, 0.0f), 1.0f);
}

TEST(CommandSamples, AreHyperbolicAndKeepStraightAhead) {
  const LocomotionDatabase clips = testing::rectangularClips();
  CommandSampling sampling;
  sampling.linearSamples = 1;
  sampling.angularSamples = 5;
  std::vector<Command> commands;
  sampleCommands(clips, sampling, commands);
  ASSERT_EQ(commands.size(), 5u);
  const float half = 2.0f * std::sinh(1.25f) / std::sinh(2.5f);
  for (const auto& [k, turn] :
       {std::pair{0u, -2.0f}, {1u, -half}, {2u, 0.0f}, {3u, half}, {4u, 2.0f}}) {
    EXPECT_FLOAT_EQ(commands[k].angular, turn);
  }
}

TEST(CommandSamples, LieToTheSideOfTheirOffset) {
  const LocomotionDatabase clips = testing::rectangularClips();
  std::vector<Command> commands;
  const auto toTheLeft = [&](float offset) {
    CommandSampling sampling;
    sampling.sideOffset = offset;
    sampleCommands(clips, sampling, commands);
    return std::count_if(commands.begin(), commands.end(),
                         [](Command c) { return c.angular > 0.0f; }) /
           static_cast<double>(commands.size());
  };
  EXPECT_GT(toTheLeft(0.3f), toTheLeft(0.0f));
  EXPECT_LT(toTheLeft(-0.3f), toTheLeft(0.0f));
}

TEST(CommandSamples, CanBeReachedAndPlayed) {
  testing::Dice dice(9);
  std::vector<Command> commands;
  for (int k = 0; k < 500; ++k) {
    CommandSampling sampling;
    sampling.present = {dice.between(0.0f, 2.0f), dice.between(-0.8f, 0.8f)};
    sampling.reach = {dice.between(0.05f, 0.5f), dice.between(0.1f, 1.0f)};
    sampling.comfortSpeed = 1.3f;
    sampling.fastest = 2.0f;
    sampleCommands(*builtInClips(), sampling, commands);
    EXPECT_GT(commands.size(), 10u);
    for (const Command& command : commands) {
      EXPECT_LE(std::abs(command.linear - sampling.present.linear), sampling.reach.linear + 1e-5f);
      EXPECT_LE(std::abs(command.angular - sampling.present.angular),
                sampling.reach.angular + 1e-5f);
      EXPECT_TRUE(builtInClips()->blend(command));
    }
    const bool comfort = std::abs(sampling.present.linear - 1.3f) < sampling.reach.linear;
    EXPECT_EQ(comfort, std::any_of(commands.begin(), commands.end(),
                                   [](Command c) { return c.linear == 1.3f; }));
  }
}

TEST(CommandSamples, OfAChainLieAlongIt) {
  const auto chain = triangulateClips(clipsAt({{0.0f, 0.0f}, {1.0f, 0.0f}, {2.0f, 0.0f}}));
  CommandSampling sampling;
  sampling.present = {1.0f, 0.0f};
  sampling.reach = {0.25f, 0.5f};
  sampling.linearSamples = 6;
  sampling.comfortSpeed = 1.1f;
  std::vector<Command> commands;
  sampleCommands(*chain, sampling, commands);
  ASSERT_EQ(commands.size(), 6u);
  EXPECT_FLOAT_EQ(commands.front().linear, 0.75f);
  EXPECT_FLOAT_EQ(commands.back().linear, 1.25f);
  EXPECT_TRUE(std::any_of(commands.begin(), commands.end(),
                          [](Command c) { return std::abs(c.linear - 1.1f) < 1e-6f; }));
}

}  // namespace
}  // namespace forewalk::agents
