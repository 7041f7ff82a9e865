#include "service/likeness.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <random>
#include <span>

#include "agents/evaluation/dtw.h"
#include "navmesh/build/build.h"
#include "navmesh/random.h"
#include "service/files.h"
#include "tests/support/block_scene.h"
#include "tests/support/xml_fault.h"

namespace forewalk::service {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;

// A hall of 30 x 20 m with a block of 4 x 8 m in its middle.
std::shared_ptr<const navmesh::World> hall() {
  const auto scene = forewalk::testing::BlockScene()
                         .floor({-15, -10, 15, 10})
                         .box({-2, -4, 2, 4}, 0.0f, 3.0f)
                         .scene();
  return *makeWorld(*navmesh::buildNavMesh(scene));
}

// Six people who go round the block from west to east and on to the north, each with a sway of
// their own and their own distance from the wall.
RecordedBuilding recorded(std::uint64_t seed, int people = 6) {
  RecordedBuilding building{"hall", {}, hall(), 0.25f};
  std::mt19937_64 rng(seed);
  for (int k = 0; k < people; ++k) {
    rdw::Walk walk{"u" + std::to_string(k), {}};
    const double wide = navmesh::uniform(rng, 0.0, 0.8), phase = navmesh::uniform(rng, 0.0, 6.0);
    const double speed = navmesh::uniform(rng, 0.8, 1.2);
    const auto stay = [&](glm::dvec2 at) {
      for (int i = 0; i < 60; ++i) walk.samples.push_back({0.0, at + 0.01 * std::sin(0.4 * i)});
    };
    const auto go = [&](glm::dvec2 from, glm::dvec2 to) {
      const double length = glm::distance(from, to);
      const glm::dvec2 along = (to - from) / length, left(-along.y, along.x);
      const int steps = static_cast<int>(20.0 * length / speed);
      for (int i = 1; i <= steps; ++i) {
        const double share = static_cast<double>(i) / steps;
        const double sway =
            0.05 * std::sin(6.0 * share * length + phase) * std::sin(3.14159 * share);
        walk.samples.push_back({0.0, from + share * length * along + sway * left});
      }
    };
    const glm::dvec2 west(-9.0 + 0.3 * wide, 0.2), bend(0.0, 5.0 + wide), east(9.0, 0.3 * wide);
    const glm::dvec2 north(9.0 + 0.4 * wide, 8.0);
    stay(west);
    go(west, bend);
    go(bend, east);
    stay(east);
    go(east, north);
    stay(north);
    for (std::size_t i = 0; i < walk.samples.size(); ++i) {
      walk.samples[i].seconds = 0.05 * static_cast<double>(i);
    }
    building.walks.push_back(std::move(walk));
  }
  return building;
}

/// Walks as the person did, moved aside by `shift`.
SentWalker replay(const std::string& name, glm::dvec2 shift = glm::dvec2(0.0)) {
  return {name, [shift](const RecordedBuilding& building, const WalkLeg& leg, const Errand&) {
            LonePath path{{}, 1.0, true};
            const auto& samples = building.walks[leg.walk].samples;
            for (std::size_t i = leg.first; i <= leg.last; ++i) {
              path.points.push_back(samples[i].plan + shift);
            }
            return path;
          }};
}

Likeness compared(const std::vector<RecordedBuilding>& buildings,
                  const std::vector<SentWalker>& walkers, unsigned threads = 1) {
  ComparisonSettings settings;
  settings.threads = threads;
  auto likeness = compareWithPeople(buildings, walkers, {}, settings);
  EXPECT_TRUE(likeness) << likeness.error().message;
  return *std::move(likeness);
}

// Walked once: they take seconds.
const std::vector<SceneLikeness>& scenesWalked() {
  static const std::vector<SceneLikeness> scenes = compareInScenes(0.2, 2);
  return scenes;
}

TEST(Likeness, OfAReplayIsThatOfAPersonAndOfAShiftedOneIsNot) {
  const Likeness likeness =
      compared({recorded(1)}, {replay("replay"), replay("shifted", {0.0, 2.0})});
  ASSERT_EQ(likeness.sets.size(), 2u);
  for (std::size_t t = 0; t < 2; ++t) {
    const OverallLikeness& same = likeness.walkers[0].overall[t];
    EXPECT_DOUBLE_EQ(same.ratio, 1.0);
    EXPECT_EQ(same.matched.superiority, 0.5);
    EXPECT_EQ(same.farther, 1.0);
    EXPECT_EQ(same.apart, 1.0);
    EXPECT_EQ(same.toldApart, 0u);
  }
  const OverallLikeness& shifted = likeness.walkers[1].overall[1];  // normalised
  EXPECT_GT(shifted.ratio, 2.0);
  EXPECT_GT(shifted.matched.superiority, 0.95);
  // The true labels, and all of them swapped; and two walkers were asked about.
  EXPECT_DOUBLE_EQ(shifted.matched.farther, 2.0 / 64.0);
  EXPECT_DOUBLE_EQ(shifted.farther, 4.0 / 64.0);
  EXPECT_DOUBLE_EQ(shifted.matched.apart, 2.0 / 64.0);
  EXPECT_EQ(shifted.toldApart, likeness.sets.size());
  EXPECT_DOUBLE_EQ(likeness.walkers[0].detour, likeness.peopleDetour);
}

TEST(Likeness, DoesNotSeeTheOrderOfWalksNorTheThreads) {
  const std::vector<RecordedBuilding> plain{recorded(2)};
  std::vector<RecordedBuilding> turned = plain;
  std::reverse(turned[0].walks.begin(), turned[0].walks.end());
  const std::vector<SentWalker> walkers{replay("shifted", {0.3, 0.2}), sentWalkers()[0]};
  const Likeness one = compared(plain, walkers, 1);
  EXPECT_EQ(toJson(one), toJson(compared(plain, walkers, 3)));
  const Likeness other = compared(turned, walkers);
  ASSERT_EQ(other.sets.size(), one.sets.size());
  for (std::size_t w = 0; w < 2; ++w) {
    for (std::size_t t = 0; t < 2; ++t) {
      const OverallLikeness& a = one.walkers[w].overall[t];
      const OverallLikeness& b = other.walkers[w].overall[t];
      EXPECT_NEAR(a.ratio, b.ratio, 1e-12);
      EXPECT_NEAR(a.matched.superiority, b.matched.superiority, 1e-12);
      EXPECT_EQ(a.matched.farther, b.matched.farther);
      EXPECT_EQ(a.matched.apart, b.matched.apart);
      EXPECT_EQ(a.toldApart, b.toldApart);
    }
  }
}

TEST(Likeness, TakesPeopleOfTwoBuildingsForDifferentPeople) {
  std::vector<RecordedBuilding> two{recorded(3), recorded(4)};
  two[1].name = "other";
  const Likeness likeness = compared(two, {replay("shifted", {0.0, 2.0})});
  EXPECT_EQ(likeness.sets.size(), 4u);
  EXPECT_EQ(likeness.walkers[0].overall[1].matched.labellings, 4096u);
}

TEST(Likeness, SaysWhereNothingCanBeCompared) {
  const auto none = compareWithPeople({recorded(5, 3)}, {replay("replay")}, {}, {});
  ASSERT_FALSE(none);
  EXPECT_THAT(none.error().message, HasSubstr("no 4 people walked 4 m or more"));
}

TEST(Likeness, GivesTextCsvJsonAndPlansOfTheSameNumbers) {
  const std::vector<RecordedBuilding> buildings{recorded(6)};
  Likeness likeness = compared(buildings, {replay("replay"), sentWalkers()[0]});
  likeness.scenes = scenesWalked();
  const std::string text = toText(likeness);
  EXPECT_THAT(text, HasSubstr("hall: 6 walks, 18 rests, 3 regions, 2 sets, 12 legs"));
  EXPECT_THAT(text, HasSubstr("test 3, 20 objects: no people were recorded in it"));
  const json report = json::parse(toJson(likeness));
  EXPECT_EQ(report["format"], "forewalk.likeness/1");
  EXPECT_EQ(report["sets"].size(), 2u);
  EXPECT_EQ(report["walkers"][1]["normalised"]["superiority"],
            likeness.walkers[1].overall[1].matched.superiority);
  EXPECT_EQ(report["scenes"].size(), 3u);
  const std::string csv = toCsv(likeness);
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 1 + 2 * 2 * 2 + 2 * 2);
  const auto commas = std::count(csv.begin(), csv.begin() + static_cast<long>(csv.find('\n')), ',');
  for (std::size_t begin = 0; begin < csv.size();) {
    const std::size_t end = csv.find('\n', begin);
    EXPECT_EQ(std::count(csv.begin() + static_cast<long>(begin),
                         csv.begin() + static_cast<long>(end), ','),
              commas);
    begin = end + 1;
  }
  // Its paths can be compared again.
  const std::string paths = toPathsCsv(likeness);
  const auto read = rdw::parseWalks(std::as_bytes(std::span(paths.data(), paths.size())), "p.csv",
                                    rdw::WalkTimes::kOptional);
  ASSERT_TRUE(read) << read.error().message;
  std::size_t expected = 0;
  for (const ComparedSet& set : likeness.sets) expected += set.paths.size();
  for (const SceneLikeness& scene : likeness.scenes) expected += scene.walked.size();
  EXPECT_EQ(read->size(), expected);
  EXPECT_EQ(testing::faultOf(likenessPlan(likeness, 0, buildings[0].world->graph)), "");
  EXPECT_EQ(testing::faultOf(scenePlan(likeness.scenes[2])), "");
}

TEST(LoneWalks, EveryModelArrivesAndGoesAroundTheBlock) {
  const auto world = hall();
  const Errand errand{{-9.0, 0.2}, {9.0, 0.1}, -1.57, 1.1, 25.0};
  const auto taut = tautPath(*world, errand.from, errand.to);
  ASSERT_GE(taut.size(), 3u);
  const double shortest = agents::pathLength(taut);
  EXPECT_GT(shortest, 18.5);
  for (const LoneModel& model : loneModels()) {
    const LonePath path = walkErrand(world, 0.25f, model, errand);
    EXPECT_TRUE(path.arrived) << model.name;
    EXPECT_EQ(path.points.front(), errand.from);
    EXPECT_LT(glm::distance(path.points.back(), errand.to), 0.2) << model.name;
    EXPECT_GT(agents::pathLength(path.points), shortest - 0.3) << model.name;
    EXPECT_LT(agents::pathLength(path.points), 1.2 * shortest) << model.name;
    // As many samples as its seconds ask for, and none in the block.
    EXPECT_NEAR(static_cast<double>(path.points.size() - 1), 25.0 * path.seconds, 1.0);
    for (const glm::dvec2 point : path.points) {
      EXPECT_FALSE(std::abs(point.x) < 2.0 && std::abs(point.y) < 4.0) << model.name;
    }
  }
  EXPECT_TRUE(tautPath(*world, errand.from, {100.0, 0.0}).empty());
}

TEST(LoneWalks, ScenesOfTheThesisAreWalkedToTheEndThroughNoBox) {
  for (const SceneLikeness& scene : scenesWalked()) {
    EXPECT_EQ(scene.walkers.back(), "thesis");
    for (std::size_t w = 0; w < scene.walkers.size(); ++w) {
      EXPECT_TRUE(scene.walked[w].arrived) << scene.scene->name << ", " << scene.walkers[w];
      for (const glm::dvec2 point : scene.walked[w].points) {
        for (const agents::AvatarObject& box : scene.scene->objects) {
          const double c = std::cos(static_cast<double>(box.heading));
          const double s = std::sin(static_cast<double>(box.heading));
          const glm::dvec2 off = point - glm::dvec2(box.centre);
          const glm::dvec2 inBox(c * off.x + s * off.y, c * off.y - s * off.x);
          EXPECT_FALSE(std::abs(inBox.x) < static_cast<double>(box.halfSize.x) &&
                       std::abs(inBox.y) < static_cast<double>(box.halfSize.y))
              << scene.scene->name << ", " << scene.walkers[w];
        }
      }
    }
    const std::size_t n = scene.walkers.size();
    for (std::size_t i = 0; i < n; ++i) {
      EXPECT_EQ(scene.normalised.at(i, i), 0.0);
      for (std::size_t j = 0; j < n; ++j) {
        EXPECT_EQ(scene.normalised.at(i, j), scene.normalised.at(j, i));
      }
    }
  }
}

}  // namespace
}  // namespace forewalk::service
