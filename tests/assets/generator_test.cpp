// The scenes and scenarios in the repository are what the generator writes.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>

#include "floor_plan.h"
#include "maze.h"
#include "scenes.h"

namespace forewalk::assets {
namespace {

std::string contentOf(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

TEST(Generator, WritesTheFilesOfTheRepositoryByteForByte) {
  for (const File& file : generateScenes()) {
    // Not EXPECT_EQ: a difference of half a megabyte would be printed in full.
    EXPECT_TRUE(contentOf(std::filesystem::path(FOREWALK_ASSETS) / file.path) == file.text)
        << file.path << " differs. Run: build/release/assets/generate_scenes assets";
  }
}

TEST(Generator, WritesEverySceneAndScenarioThatIsThere) {
  std::set<std::string> written, there;
  for (const File& file : generateScenes()) written.insert(file.path);
  for (const char* folder : {"scenes", "scenarios"}) {
    for (const auto& entry :
         std::filesystem::directory_iterator(std::filesystem::path(FOREWALK_ASSETS) / folder)) {
      there.insert(std::string(folder) + "/" + entry.path().filename().string());
    }
  }
  EXPECT_EQ(written, there);
}

TEST(Generator, KeepsEveryFileBelowAMegabyte) {
  for (const File& file : generateScenes()) EXPECT_LT(file.text.size(), 1000000u) << file.path;
}

TEST(FloorPlan, RefusesADoorBesideItsWall) {
  FloorPlan plan(0, 2800, {});
  const auto a = plan.room("a", {0, 0, 4000, 4000});
  const auto b = plan.room("b", {4000, 0, 8000, 4000});
  const auto c = plan.room("c", {9000, 0, 12000, 4000});
  EXPECT_THROW(plan.door(a, b, 4000, 900), std::logic_error);
  EXPECT_THROW(plan.door(a, c, 2000, 900), std::logic_error);
  EXPECT_NO_THROW(plan.door(a, b, 2000, 900));
}

TEST(FloorPlan, CountsALoopPerDoorTooManyAndPerIsland) {
  FloorPlan plan(0, 2800, {});
  const auto a = plan.room("a", {0, 0, 4000, 4000});
  const auto b = plan.room("b", {4000, 0, 8000, 4000});
  plan.door(a, b, 1000, 900);
  EXPECT_EQ(plan.loops(), 0);
  plan.door(a, b, 3000, 900);
  EXPECT_EQ(plan.loops(), 1);
  plan.island();
  EXPECT_EQ(plan.loops(), 2);
}

TEST(Maze, ReachesEveryCellAndAddsOneLoopPerWallTakenAway) {
  for (const int extra : {0, 1, 5}) {
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
      const Maze maze(8, 6, extra, seed);
      EXPECT_EQ(maze.loops(), extra) << "seed " << seed;
      EXPECT_THAT(maze.steps({0, 0}), testing::Each(testing::Ge(0))) << "seed " << seed;
    }
  }
}

TEST(Maze, BoundsAStraightPassageByItsLength) {
  // One row of cells: the walk from the first middle to the last is a straight line.
  const Maze maze(9, 1, 0, 1);
  const Maze::Bounds bounds = maze.shortestWalk({0, 0}, {8, 0}, 1.65, 0.15, 0.25);
  EXPECT_DOUBLE_EQ(bounds.upper, 8 * 1.65);
  EXPECT_LE(bounds.lower, 8 * 1.65);
  EXPECT_GE(bounds.lower, 8 * 1.65 - 9 * 0.03);
}

}  // namespace
}  // namespace forewalk::assets
