#include "prediction/way_tracker.h"

#include <gtest/gtest.h>

#include <map>
#include <random>
#include <set>

#include "navmesh/random.h"
#include "prediction/predict.h"
#include "tests/support/count_allocations.h"
#include "tests/support/line_world.h"
#include "tests/support/random_mesh.h"
#include "tests/support/random_start.h"

namespace forewalk::prediction {
namespace {

using testing::lineGraph;
using testing::LineWay;

std::vector<WayId> idsOf(const WayTracker& tracker) {
  std::vector<WayId> ids;
  for (const TrackedWay& way : tracker.ways()) ids.push_back(way.id);
  return ids;
}

std::size_t countOf(const WayTracker& tracker, WayChange change) {
  std::size_t count = 0;
  for (const WayEvent& event : tracker.events()) count += event.change == change;
  return count;
}

/// Somebody who strolls about a random mesh: the graph of each frame is given to `visit`.
template <typename Visit>
void stroll(const navmesh::NavGraph& graph, std::uint64_t seed, int frames, float horizon,
            Visit visit) {
  Scratch scratch(graph);
  std::mt19937_64 rng(seed);
  const std::vector<navmesh::Location> starts = testing::randomStarts(graph, 1, seed);
  const navmesh::LocationIndex index = navmesh::makeLocationIndex(graph);
  navmesh::Location here = starts[0];
  double heading = 0.0;
  for (int f = 0; f < frames; ++f) {
    visit(predict(graph, here, horizon, scratch));
    heading += navmesh::uniform(rng, -0.5, 0.5);
    const glm::vec2 next = here.plan + 0.05f * glm::vec2(std::cos(heading), std::sin(heading));
    navmesh::SnapLimits limits;
    limits.distance = 0.2f;
    if (const auto moved =
            navmesh::locateFrom(graph, index, here, navmesh::toSpace(next, 0.0f), limits)) {
      here = *moved;
    }
  }
}

TEST(WayTracker, NamesNothingWhereThereIsNoWay) {
  WayTracker tracker;
  tracker.update(lineGraph({0, 0}, 5.0f, {}));
  EXPECT_TRUE(tracker.ways().empty());
  EXPECT_TRUE(tracker.events().empty());
}

TEST(WayTracker, KeepsNamesWhateverTheOrder) {
  std::vector<LineWay> ways{{{{5, 0}}},
                            {{{-5, 0}}},
                            {{{0, 5}}},
                            {{{3, 0}, {3, 2}}},
                            {{{0, -2}}, TerminalReason::kDeadEnd}};
  std::mt19937_64 rng(7);
  WayTracker tracker;
  std::map<std::pair<float, float>, WayId> nameOf;
  for (int round = 0; round < 20; ++round) {
    tracker.update(lineGraph({0, 0}, 5.0f, ways));
    for (std::size_t i = 0; i < ways.size(); ++i) {
      const glm::vec2 end = ways[i].points.back();
      const WayId id = tracker.ways()[i].id;
      const auto known = nameOf.insert({{end.x, end.y}, id}).first;
      EXPECT_EQ(known->second, id) << "round " << round;
    }
    for (std::size_t i = ways.size() - 1; i > 0; --i) {
      std::swap(ways[i],
                ways[static_cast<std::size_t>(navmesh::uniformInt(rng, static_cast<int>(i) + 1))]);
    }
  }
  EXPECT_EQ(nameOf.size(), ways.size());
}

TEST(WayTracker, KeepsNamesAlongAStraightCorridorThereAndBack) {
  WayTracker tracker;
  tracker.update(lineGraph({0, 0}, 5.0f, testing::waysBeforeT(0, 100, 5)));
  const std::vector<WayId> first = idsOf(tracker);
  ASSERT_EQ(first.size(), 2u);
  for (int f = 1; f < 400; ++f) {
    const float x = 0.05f * static_cast<float>(f < 200 ? f : 400 - f);
    tracker.update(lineGraph({x, 0}, 5.0f, testing::waysBeforeT(x, 100, 5)));
    EXPECT_EQ(idsOf(tracker), first) << "frame " << f;
    EXPECT_TRUE(tracker.events().empty()) << "frame " << f;
  }
}

TEST(WayTracker, ReportsASplitWhereTheWaysPartAndAMergeOnTheWayBack) {
  WayTracker tracker;
  std::size_t splits = 0, merges = 0, births = 0, deaths = 0;
  for (int f = 0; f < 400; ++f) {
    const float x = 0.05f * static_cast<float>(f < 200 ? f : 400 - f);
    tracker.update(lineGraph({x, 0}, 5.0f, testing::waysBeforeT(x, 10, 5)));
    splits += countOf(tracker, WayChange::kSplit);
    merges += countOf(tracker, WayChange::kMerge);
    births += countOf(tracker, WayChange::kBirth);
    deaths += countOf(tracker, WayChange::kDeath);
  }
  EXPECT_EQ(births, 2u);  // the first frame's
  EXPECT_EQ(splits, 1u);
  EXPECT_EQ(merges, 1u);
  EXPECT_EQ(deaths, 0u);
}

TEST(WayTracker, ReportsADeathOnlyWhenAWayDoesNotComeBack) {
  const std::vector<LineWay> both{{{{5, 0}}}, {{{0, 5}}}}, one{{{{5, 0}}}};
  WayTracker tracker;
  tracker.update(lineGraph({0, 0}, 5.0f, both));
  const std::vector<WayId> first = idsOf(tracker);
  tracker.update(lineGraph({0, 0}, 5.0f, one));
  EXPECT_TRUE(tracker.events().empty());
  tracker.update(lineGraph({0, 0}, 5.0f, both));
  EXPECT_EQ(idsOf(tracker), first);
  EXPECT_EQ(countOf(tracker, WayChange::kReturn), 1u);
  std::size_t deaths = 0;
  for (int f = 0; f < 60; ++f) {
    const float x = 0.1f * static_cast<float>(f);
    tracker.update(lineGraph({x, 0}, 5.0f, {{{{x + 5, 0}}}}));
    deaths += countOf(tracker, WayChange::kDeath);
    EXPECT_EQ(tracker.ways()[0].id, first[0]);
  }
  EXPECT_EQ(deaths, 1u);
}

TEST(WayTracker, KeepsNamesWhileTheUserIsOffTheNavmesh) {
  const std::vector<LineWay> ways{{{{5, 0}}}, {{{0, 5}}}};
  WayTracker tracker;
  tracker.update(lineGraph({0, 0}, 5.0f, ways));
  const std::vector<WayId> first = idsOf(tracker);
  PredictionGraph nowhere = lineGraph({0, 0}, 5.0f, {});
  nowhere.flags = kSourceOffMesh;
  for (int f = 0; f < 10; ++f) {
    tracker.update(nowhere);
    EXPECT_TRUE(tracker.ways().empty());
  }
  tracker.update(lineGraph({0, 0}, 5.0f, ways));
  EXPECT_EQ(idsOf(tracker), first);
}

TEST(WayTracker, TellsStoreysApart) {
  PredictionGraph below = lineGraph({0, 0}, 5.0f, {{{{5, 0}}}});
  PredictionGraph above = below;
  above.nodes[1].height = 3.0f;
  WayTracker tracker;
  tracker.update(below);
  const WayId first = tracker.ways()[0].id;
  tracker.update(above);
  EXPECT_NE(tracker.ways()[0].id, first);
}

TEST(WayTracker, SaysWhenThereAreMoreWaysThanItCanName) {
  WayTrackerSettings settings;
  settings.ways = 2;
  WayTracker tracker(settings);
  tracker.update(lineGraph({0, 0}, 5.0f, {{{{5, 0}}}, {{{-5, 0}}}, {{{0, 5}}}}));
  EXPECT_EQ(tracker.ways().size(), 2u);
  EXPECT_TRUE(tracker.limitReached());
}

TEST(WayTracker, NamesEveryWayOnceOnRandomMeshes) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const navmesh::NavGraph graph = *navmesh::makeNavGraph(testing::randomMesh(seed, 12, 12));
    WayTracker tracker;
    std::set<WayId> alive;
    stroll(graph, seed, 200, 4.0f, [&](const PredictionGraph& ahead) {
      tracker.update(ahead);
      ASSERT_EQ(tracker.ways().size(), ahead.terminals.size());
      std::set<WayId> now;
      for (std::size_t i = 0; i < ahead.terminals.size(); ++i) {
        EXPECT_EQ(tracker.ways()[i].terminal, ahead.terminals[i]);
        now.insert(tracker.ways()[i].id);
      }
      EXPECT_EQ(now.size(), ahead.terminals.size());
      // Every change is told: who is new was born or split off, who is back had lingered.
      std::set<WayId> told;
      for (const WayEvent& event : tracker.events()) {
        const bool isNew = event.change == WayChange::kBirth || event.change == WayChange::kSplit;
        if (isNew || event.change == WayChange::kReturn) told.insert(event.way);
        if (!isNew && event.change != WayChange::kReturn) {
          EXPECT_EQ(now.count(event.way), 0u);
        }
      }
      for (const WayId id : now) EXPECT_TRUE(alive.count(id) == 1 || told.count(id) == 1);
      alive = now;
    });
  }
}

TEST(WayTracker, GivesTheSameNamesInAMirroredWorldAndOnReplay) {
  const auto mirrored = [](std::vector<LineWay> ways) {
    for (LineWay& way : ways) {
      for (glm::vec2& point : way.points) point.x = -point.x;
    }
    return ways;
  };
  std::mt19937_64 rng(3);
  WayTracker one, other, again;
  std::vector<LineWay> ways;
  for (int i = 0; i < 12; ++i) {
    const auto at = [&] { return static_cast<float>(navmesh::uniform(rng, -3.0, 3.0)); };
    ways.push_back({{{at(), at()}, {at(), at()}}});
  }
  for (int round = 0; round < 100; ++round) {
    for (LineWay& way : ways) {
      way.points.back().x += static_cast<float>(navmesh::uniform(rng, -0.2, 0.2));
      way.points.back().y += static_cast<float>(navmesh::uniform(rng, -0.2, 0.2));
    }
    one.update(lineGraph({0, 0}, 5.0f, ways));
    again.update(lineGraph({0, 0}, 5.0f, ways));
    other.update(lineGraph({0, 0}, 5.0f, mirrored(ways)));
    EXPECT_EQ(idsOf(one), idsOf(other)) << "round " << round;
    EXPECT_EQ(idsOf(one), idsOf(again)) << "round " << round;
  }
}

TEST(WayTracker, AllocatesNothingOnceItIsMade) {
  std::vector<PredictionGraph> frames;
  const navmesh::NavGraph graph = *navmesh::makeNavGraph(testing::randomMesh(4, 12, 12));
  stroll(graph, 4, 100, 6.0f, [&](const PredictionGraph& ahead) { frames.push_back(ahead); });
  WayTracker tracker;
  testing::allocationsSince();
  std::size_t ways = 0;
  for (const PredictionGraph& frame : frames) {
    tracker.update(frame);
    ways += tracker.ways().size();
  }
  EXPECT_EQ(testing::allocationsSince(), 0u);
  EXPECT_GT(ways, 100u);
}

}  // namespace
}  // namespace forewalk::prediction
