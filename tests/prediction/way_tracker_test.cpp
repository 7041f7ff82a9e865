#include "prediction/way_tracker.h"

#include <gtest/gtest.h>

#include <map>
#include <random>
#include <set>

#include "navmesh/random.h"
#include "prediction/front_graph.h"
#include "prediction/predict.h"
#include "tests/support/count_allocations.h"
#include "tests/support/line_world.h"
#include "tests/support/map_mesh.h"
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

/// Somebody who walks over a floor drawn with characters, seeing it by fronts. What a tracker tells
/// is added up.
class Walk {
 public:
  Walk(const std::vector<std::string_view>& rows, float horizon)
      : graph_(*navmesh::makeNavGraph(testing::mapMesh(rows, 0.5f, testing::Cutting::kSquares))),
        locations_(navmesh::makeLocationIndex(graph_)),
        index_(makeFrontIndex(graph_)),
        scratch_(graph_, index_),
        horizon_(horizon) {}

  /// Goes straight from one place to another, 5 cm a frame, both included.
  void go(WayTracker& tracker, glm::vec2 from, glm::vec2 to) {
    const int steps = std::max(1, static_cast<int>(glm::distance(from, to) / 0.05f));
    for (int i = 0; i <= steps; ++i) {
      const glm::vec2 plan = glm::mix(from, to, static_cast<float>(i) / static_cast<float>(steps));
      const auto here = navmesh::locate(graph_, locations_, navmesh::toSpace(plan, 0.0f));
      ASSERT_TRUE(here);
      tracker.update(predictFronts(graph_, *here, horizon_, scratch_));
      for (const WayEvent& event : tracker.events()) {
        if (frames > 0) told[event.change].push_back({event, walked});
      }
      ++frames;
      if (i < steps) walked += 0.05f;
    }
  }

  struct Told {
    WayEvent event;
    float walked;  ///< metres until then
  };
  std::map<WayChange, std::vector<Told>> told;  ///< all but the first frame's births
  int frames = 0;
  float walked = 0.0f;

 private:
  navmesh::NavGraph graph_;
  navmesh::LocationIndex locations_;
  FrontIndex index_;
  FrontScratch scratch_;
  float horizon_;
};

// A corridor of 1 m, with a side corridor at its middle; 0.5 m a character.
const std::vector<std::string_view> kSideCorridor{
    "                    ..                    ", "                    ..                    ",
    "                    ..                    ", "                    ..                    ",
    "                    ..                    ", "                    ..                    ",
    "                    ..                    ", "                    ..                    ",
    "..........................................", ".........................................."};

TEST(WayTracker, TellsOfASideCorridorWhenItIsInViewAndNoLongerThan) {
  WayTracker tracker;
  Walk walk(kSideCorridor, 3.0f);
  walk.go(tracker, {4.02f, 0.52f}, {17.0f, 0.52f});
  EXPECT_TRUE(walk.told[WayChange::kBirth].empty());
  EXPECT_TRUE(walk.told[WayChange::kDeath].empty());
  ASSERT_EQ(walk.told[WayChange::kSplit].size(), 1u);
  ASSERT_EQ(walk.told[WayChange::kMerge].size(), 1u);
  // The front parts at the far corner, (11, 1), and is two ways when it is 0.75 m beyond it.
  const float until = 11.0f - 4.02f - (3.0f - 0.75f);
  EXPECT_NEAR(walk.told[WayChange::kSplit][0].walked, until, 0.15f);
  // Behind the walker it is a way of its own until it is that near the horizon again; then it may
  // come back for two more metres.
  const float gone = 10.0f - 4.02f + (3.0f - 0.75f) + WayTrackerSettings{}.linger;
  EXPECT_NEAR(walk.told[WayChange::kMerge][0].walked, gone, 0.15f);
  EXPECT_EQ(walk.told[WayChange::kMerge][0].event.way, walk.told[WayChange::kSplit][0].event.way);
  // The way behind has kept its name all along, and so has the one ahead.
  ASSERT_EQ(tracker.ways().size(), 2u);
  std::set<std::uint32_t> ids{index(tracker.ways()[0].id), index(tracker.ways()[1].id)};
  EXPECT_EQ(ids, (std::set<std::uint32_t>{0, 1}));
}

TEST(WayTracker, GivesANewNameToASideCorridorThatIsSeenAgainLongAfter) {
  WayTracker tracker;
  Walk walk(kSideCorridor, 3.0f);
  walk.go(tracker, {4.02f, 0.52f}, {17.0f, 0.52f});
  walk.go(tracker, {17.0f, 0.52f}, {4.02f, 0.52f});
  EXPECT_EQ(walk.told[WayChange::kSplit].size(), 2u);
  EXPECT_EQ(walk.told[WayChange::kMerge].size(), 2u);
  EXPECT_TRUE(walk.told[WayChange::kBirth].empty());
}

TEST(WayTracker, KeepsTheNameOfAWayThatComesAndGoesAtTheEdgeOfTheHorizon) {
  WayTracker tracker;
  Walk walk(kSideCorridor, 3.0f);
  const glm::vec2 near{9.3f, 0.52f}, far{8.3f, 0.52f};
  walk.go(tracker, far, near);
  const std::size_t splits = walk.told[WayChange::kSplit].size();
  EXPECT_EQ(splits, 1u);
  for (int i = 0; i < 10; ++i) {
    walk.go(tracker, near, far);
    walk.go(tracker, far, near);
  }
  EXPECT_EQ(walk.told[WayChange::kSplit].size(), splits);
  EXPECT_GE(walk.told[WayChange::kReturn].size(), 5u);
  EXPECT_TRUE(walk.told[WayChange::kMerge].empty());
  EXPECT_TRUE(walk.told[WayChange::kBirth].empty());
}

TEST(WayTracker, TellsWithinTwoMetresThatAWayIsClosed) {
  // The same corridor, its side walled up while somebody stands before it and then walks on.
  std::vector<std::string_view> walled(kSideCorridor.begin() + 7, kSideCorridor.end());
  walled[0] = "";
  Walk open(kSideCorridor, 6.0f), closed(walled, 6.0f);
  WayTracker tracker;
  open.go(tracker, {8.0f, 0.52f}, {8.1f, 0.52f});
  ASSERT_EQ(tracker.ways().size(), 3u);
  closed.go(tracker, {8.1f, 0.52f}, {9.0f, 0.52f});
  EXPECT_EQ(tracker.ways().size(), 2u);
  EXPECT_TRUE(closed.told[WayChange::kDeath].empty());
  closed.go(tracker, {9.0f, 0.52f}, {10.3f, 0.52f});
  ASSERT_EQ(closed.told[WayChange::kDeath].size(), 1u);
  EXPECT_LE(closed.told[WayChange::kDeath][0].walked, WayTrackerSettings{}.linger + 0.1f);
}

TEST(WayTracker, KeepsANameWhereWaysThatMetGoOnAsOne) {
  // Around a block: the two ways meet behind it, then go on as one.
  const std::vector<std::string_view> block{
      "..................................", "..................................",
      "............        ..............", "............        ..............",
      "............        ..............", "............        ..............",
      "..................................", ".................................."};
  WayTracker tracker;
  Walk walk(block, 9.0f);
  walk.go(tracker, {1.02f, 2.03f}, {3.5f, 2.03f});
  EXPECT_TRUE(walk.told[WayChange::kBirth].empty());
  EXPECT_TRUE(walk.told[WayChange::kDeath].empty());
}

TEST(WayTracker, KeepsANameWhereTwoFrontsBecomeOne) {
  // Two pieces of a circle of 5 m, then all of it between their outer ends: its middle is new.
  const auto at = [](float angle) { return 5.0f * glm::vec2(std::cos(angle), std::sin(angle)); };
  const auto graphOf = [&](std::vector<std::pair<float, float>> pieces) {
    std::vector<LineWay> ways;
    for (const auto& [from, to] : pieces) ways.push_back({{at(0.5f * (from + to))}});
    PredictionGraph graph = lineGraph({0, 0}, 5.0f, ways);
    for (const auto& [from, to] : pieces) {
      graph.fronts.push_back({at(from), at(to), 5.0f * (to - from)});
    }
    return graph;
  };
  WayTracker tracker;
  tracker.update(graphOf({{0.0f, 1.4f}, {1.6f, 2.6f}}));
  const std::vector<WayId> two = idsOf(tracker);
  tracker.update(graphOf({{0.0f, 2.6f}}));
  ASSERT_EQ(tracker.ways().size(), 1u);
  EXPECT_EQ(tracker.ways()[0].id, two[0]);  // the middle is on it
  tracker.update(graphOf({{0.0f, 1.4f}, {1.6f, 2.6f}}));
  EXPECT_EQ(idsOf(tracker), two);
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
