#include "service/live_world.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <new>
#include <random>
#include <set>
#include <thread>

#include "navmesh/plan.h"
#include "navmesh/random.h"
#include "tests/support/block_scene.h"
#include "tests/support/random_obstacle.h"
#include "tests/support/same_graph.h"

namespace forewalk::service {
namespace {

// What the calling thread asks the heap for and gives back to it.
thread_local std::uint64_t heapCalls = 0;

}  // namespace
}  // namespace forewalk::service

[[gnu::noinline]] void* operator new(std::size_t size) {
  ++forewalk::service::heapCalls;
  if (void* memory = std::malloc(size == 0 ? 1 : size)) return memory;
  throw std::bad_alloc();
}
[[gnu::noinline]] void operator delete(void* memory) noexcept {
  if (memory != nullptr) ++forewalk::service::heapCalls;
  std::free(memory);
}
[[gnu::noinline]] void operator delete(void* memory, std::size_t) noexcept {
  operator delete(memory);
}

namespace forewalk::service {
namespace {

using navmesh::CylinderObstacle;
using navmesh::ObstacleChange;
using navmesh::ObstacleId;
using ::testing::HasSubstr;

constexpr glm::vec3 kLeft{3.0f, 0.0f, 2.0f};
constexpr glm::vec3 kRight{9.0f, 0.0f, 2.0f};
const navmesh::PlanArea kDoorway{{{5.7f, -2.7f}, {6.5f, -2.7f}, {6.5f, -1.3f}, {5.7f, -1.3f}}};

std::unique_ptr<LiveWorld> made(navmesh::Scene scene = testing::twoRooms(1.2f)) {
  LiveWorldSettings settings;
  settings.build.tile = 4.0f;
  settings.outlines = {navmesh::PrismObstacle{kDoorway.corners, kDoorway.bottom, kDoorway.top}};
  auto live = LiveWorld::make(std::move(scene), settings);
  if (!live) throw std::runtime_error(live.error().message);
  return std::move(*live);
}

ObstacleChange put(std::uint32_t id, glm::vec3 foot, float radius = 0.3f) {
  return {ObstacleId{id}, CylinderObstacle{foot, radius, 1.8f}};
}
ObstacleChange gone(std::uint32_t id) { return {ObstacleId{id}, std::nullopt}; }

void changeAndWait(LiveWorld& live, const std::vector<ObstacleChange>& changes) {
  const auto taken = live.change(changes);
  if (!taken) throw std::runtime_error(taken.error().message);
  live.waitUntilDone();
}

bool onGround(const WorldVersion& version, glm::vec3 place) {
  return navmesh::locate(version.world->graph, version.world->locations, place, {0.0f, 0.3f, 0.3f})
      .has_value();
}

/// Whether it comes true within ten seconds.
bool comesTrue(const std::function<bool()>& what) {
  for (int i = 0; i < 1000; ++i) {
    if (what()) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  return false;
}

rdw::HeadPose head(double x, double z) {
  return {{static_cast<float>(x), 1.7f, static_cast<float>(z)}, glm::quat(1, 0, 0, 0)};
}

rdw::Session sessionIn(const WorldVersion& version, glm::vec3 start) {
  rdw::SessionSettings settings;
  settings.start = rdw::VirtualStart{start, 0.0f};
  settings.horizon = 5.0f;
  settings.controller = "none";
  settings.prediction.polygons = 256;
  settings.states = version.states;
  return std::move(*rdw::Session::make(version.world, settings));
}

/// Whether one of the ways out comes into the other room, beyond the wall at x = 6.
bool seesTheOtherRoom(const rdw::FrameResult& result) {
  for (const prediction::Node& node : result.graph->nodes) {
    if (node.plan.x > 6.6f) return true;
  }
  return false;
}

prediction::PredictionLimits smallLimits() {
  prediction::PredictionLimits limits;
  limits.polygons = 256;
  return limits;
}

TEST(LiveWorld, FailsWhereTheStaticBuildFails) {
  const auto none = LiveWorld::make({});
  ASSERT_FALSE(none);
  EXPECT_EQ(none.error().code, ErrorCode::kSceneEmpty);
}

TEST(LiveWorld, EndsAtOnceWhateverIsUnderWay) {
  for (int i = 0; i < 20; ++i) {
    const auto live = made();
    WorldReader reader = live->reader();
    for (int k = 0; k <= i; ++k) {
      ASSERT_TRUE(live->change(std::vector{put(1, kLeft + glm::vec3(0.05f * k, 0.0f, 0.0f))}));
    }
  }
}

TEST(LiveWorld, HasNothingNewUntilSomethingChanges) {
  const auto live = made();
  WorldReader reader = live->reader();
  EXPECT_EQ(reader.version().number, 1u);
  EXPECT_TRUE(onGround(reader.version(), kLeft));
  EXPECT_FALSE(reader.update());
  changeAndWait(*live, {gone(7)});  // was never there
  EXPECT_FALSE(reader.update());
}

TEST(LiveWorld, ShowsAMovedObstacleWithTheNextUpdateAndNotBefore) {
  const auto live = made();
  WorldReader reader = live->reader();
  std::weak_ptr<const navmesh::World> first = reader.version().world;
  changeAndWait(*live, {put(1, kLeft)});
  EXPECT_TRUE(onGround(reader.version(), kLeft)) << "the reader has not let go of its version";
  ASSERT_TRUE(reader.update());
  EXPECT_FALSE(reader.update());
  EXPECT_FALSE(onGround(reader.version(), kLeft));
  EXPECT_TRUE(onGround(reader.version(), kRight));
  EXPECT_TRUE(comesTrue([&] { return first.expired(); })) << "its end is the thread's work";
  changeAndWait(*live, {put(1, kRight)});
  ASSERT_TRUE(reader.update());
  EXPECT_TRUE(onGround(reader.version(), kLeft));
  EXPECT_FALSE(onGround(reader.version(), kRight));
  EXPECT_EQ(live->status().failure, "");
  EXPECT_GE(live->status().tilesBuilt, 2u);
}

TEST(LiveWorld, SkipsWhatASlowReaderDidNotTake) {
  const auto live = made();
  WorldReader slow = live->reader();
  WorldReader quick = live->reader();
  std::vector<std::weak_ptr<const navmesh::World>> worlds;
  for (int i = 0; i < 20; ++i) {
    changeAndWait(*live, {put(1, kLeft + glm::vec3(0.1f * static_cast<float>(i), 0.0f, 0.0f))});
    ASSERT_TRUE(quick.update());
    worlds.push_back(quick.version().world);
  }
  EXPECT_EQ(slow.version().number, 1u);
  ASSERT_TRUE(slow.update());
  EXPECT_EQ(slow.version().number, quick.version().number);
  EXPECT_EQ(slow.version().world, quick.version().world);
  EXPECT_FALSE(slow.update());
  worlds.pop_back();
  EXPECT_TRUE(comesTrue([&] {
    return std::all_of(worlds.begin(), worlds.end(), [](const auto& w) { return w.expired(); });
  }));
}

TEST(LiveWorld, RefusesWhatCannotBeAndGoesOn) {
  const auto live = made();
  WorldReader reader = live->reader();
  const auto refused = live->change(std::vector{put(1, kLeft), put(2, kRight, -1.0f)});
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().message, HasSubstr("radius is -1 m"));
  live->waitUntilDone();
  EXPECT_FALSE(reader.update()) << "all or nothing";
  EXPECT_FALSE(live->setArea(AreaId{1}, {kDoorway, 0.5f}));
  EXPECT_FALSE(reader.update());
  ASSERT_TRUE(live->setArea(AreaId{1}, {kDoorway, 2.0f}));
  EXPECT_FALSE(live->setArea(AreaId{1}, {{{{0, 0}, {1, 0}}}, 2.0f}));
  ASSERT_TRUE(reader.update());
  EXPECT_EQ(
      *std::max_element(reader.version().states->cost.begin(), reader.version().states->cost.end()),
      2.0f);
}

TEST(LiveWorld, ClosesADoorAtOnceAndKeepsItClosedInLaterWorlds) {
  const auto live = made();
  WorldReader reader = live->reader();
  const auto closedPolygons = [&] {
    const auto& cost = reader.version().states->cost;
    return std::count(cost.begin(), cost.end(), navmesh::kClosed);
  };
  const auto world = reader.version().world;
  ASSERT_TRUE(live->setArea(AreaId{1}, {kDoorway, navmesh::kClosed}));
  ASSERT_TRUE(reader.update());
  EXPECT_EQ(reader.version().world, world) << "nothing is rebuilt";
  EXPECT_GT(closedPolygons(), 0);
  // No way from room to room but through what is closed.
  const navmesh::NavGraph& graph = world->graph;
  const auto from = navmesh::locate(graph, world->locations, kLeft);
  const auto to = navmesh::locate(graph, world->locations, kRight);
  ASSERT_TRUE(from && to);
  EXPECT_EQ(graph.component[index(from->polygon)], graph.component[index(to->polygon)]);
  std::vector<bool> reached(graph.polygonCount(), false);
  std::vector<navmesh::PolygonId> open{from->polygon};
  reached[index(from->polygon)] = true;
  while (!open.empty()) {
    const std::uint32_t p = index(open.back());
    open.pop_back();
    for (std::uint32_t h = graph.portalStart[p]; h < graph.portalStart[p + 1]; ++h) {
      const navmesh::PolygonId next = graph.portalTo[h];
      if (reached[index(next)] || reader.version().states->isClosed(next)) continue;
      reached[index(next)] = true;
      open.push_back(next);
    }
  }
  EXPECT_FALSE(reached[index(to->polygon)]);

  changeAndWait(*live, {put(1, kLeft)});
  ASSERT_TRUE(reader.update());
  EXPECT_NE(reader.version().world, world);
  EXPECT_EQ(reader.version().states->cost.size(), reader.version().world->graph.polygonCount());
  EXPECT_GT(closedPolygons(), 0);
  live->removeArea(AreaId{1});
  ASSERT_TRUE(reader.update());
  EXPECT_EQ(closedPolygons(), 0);
}

TEST(LiveWorld, TakesASessionAlongThroughEveryWorld) {
  const auto live = made();
  WorldReader reader = live->readerForSession(smallLimits());
  rdw::Session session = sessionIn(reader.version(), kLeft);
  session.frame(head(0, 0), 0.0);
  changeAndWait(*live, {put(1, kLeft)});
  // A version without another world comes before the reader looks: the world is not lost.
  ASSERT_TRUE(live->setArea(AreaId{1}, {kDoorway, navmesh::kClosed}));
  ASSERT_TRUE(reader.update(session));
  EXPECT_EQ(&session.world(), reader.version().world.get());
  EXPECT_FALSE(reader.version().states->cost.empty());
  EXPECT_NE(session.frame(head(0, 0), 0.02).flags & rdw::kGroundTaken, 0u);
  // Nor is it entered twice.
  live->removeArea(AreaId{1});
  ASSERT_TRUE(reader.update(session));
  EXPECT_EQ(&session.world(), reader.version().world.get());
  changeAndWait(*live, {gone(1)});
  ASSERT_TRUE(reader.update(session));
  EXPECT_EQ(&session.world(), reader.version().world.get());
  EXPECT_EQ(session.frame(head(0, 0), 0.04).flags & rdw::kGroundTaken, 0u);
}

TEST(LiveWorld, HandsOnToASessionWhatIsClosedInItsWorld) {
  const auto live = made();
  WorldReader reader = live->readerForSession(smallLimits());
  rdw::Session session = sessionIn(reader.version(), kLeft);
  auto frame = [&, i = 0]() mutable -> const rdw::FrameResult& {
    return session.frame(head(0, 0), 0.02 * i++);
  };
  const std::uint64_t open = prediction::hashOf(*frame().graph);
  EXPECT_TRUE(seesTheOtherRoom(session.result()));
  ASSERT_TRUE(live->setArea(AreaId{1}, {kDoorway, navmesh::kClosed}));
  EXPECT_EQ(prediction::hashOf(*frame().graph), open) << "not before the session takes it";
  ASSERT_TRUE(reader.update(session));
  EXPECT_FALSE(seesTheOtherRoom(frame()));
  // A world that comes with the door closed has it closed.
  changeAndWait(*live, {put(1, kRight)});
  ASSERT_TRUE(reader.update(session));
  EXPECT_FALSE(seesTheOtherRoom(frame()));
  changeAndWait(*live, {gone(1)});
  live->removeArea(AreaId{1});
  ASSERT_TRUE(reader.update(session));
  EXPECT_EQ(prediction::hashOf(*frame().graph), open);
  EXPECT_FALSE(reader.update(session));
  // Whoever joins while it is closed finds it closed.
  ASSERT_TRUE(live->setArea(AreaId{1}, {kDoorway, navmesh::kClosed}));
  WorldReader late = live->readerForSession(smallLimits());
  rdw::Session joined = sessionIn(late.version(), kLeft);
  EXPECT_FALSE(seesTheOtherRoom(joined.frame(head(0, 0), 0.0)));
}

TEST(LiveWorld, LeavesTheEndOfOldStatesToItsThread) {
  const auto live = made();
  WorldReader reader = live->readerForSession(smallLimits());
  rdw::Session session = sessionIn(reader.version(), kLeft);
  std::weak_ptr<const navmesh::PolygonStates> first = reader.version().states;
  session.frame(head(0, 0), 0.0);
  ASSERT_TRUE(live->setArea(AreaId{1}, {kDoorway, navmesh::kClosed}));
  const std::uint64_t heap = heapCalls;
  ASSERT_TRUE(reader.update(session));
  EXPECT_EQ(heapCalls, heap);
  EXPECT_TRUE(comesTrue([&] {
    const std::vector none{gone(9)};
    return live->change(none) && first.expired();
  }));
}

TEST(LiveWorld, ServesSessionsThatPredictByFronts) {
  const auto live = made();
  WorldReader reader = live->readerForSession(smallLimits(), prediction::Method::kFront);
  rdw::SessionSettings settings;
  settings.start = rdw::VirtualStart{kLeft, 0.0f};
  settings.controller = "none";
  settings.prediction = smallLimits();
  settings.method = prediction::Method::kFront;
  rdw::Session session = std::move(*rdw::Session::make(reader.version().world, settings));
  for (int i = 0; i < 4; ++i) {
    changeAndWait(*live, {i % 2 == 0 ? put(1, kRight) : gone(1)});
    ASSERT_TRUE(reader.update(session));
    const rdw::FrameResult& result = session.frame(head(0, 0), 0.02 * i);
    EXPECT_EQ(&session.world(), reader.version().world.get());
    ASSERT_NE(result.graph, nullptr);
    EXPECT_EQ(result.graph->method, prediction::Method::kFront);
    EXPECT_GT(result.graph->nodes.size(), 1u);
  }
}

TEST(LiveWorld, IsOutlivedByItsReaders) {
  auto live = made();
  WorldReader reader = live->reader();
  ASSERT_TRUE(live->change(std::vector{put(1, kLeft)}));
  live->waitUntilDone();
  live.reset();
  EXPECT_TRUE(reader.update());
  EXPECT_FALSE(onGround(reader.version(), kLeft));
  EXPECT_FALSE(reader.update());
}

// One of two pillars stands, never both, never none: whoever sees another picture has seen half a
// change. Readers walk while the writer changes; afterwards one world is left.
TEST(LiveWorld, ShowsOnlyWholeChangesToReadersThatWalkMeanwhile) {
  constexpr int kReaders = 3;
  constexpr int kChanges = 150;
  auto live = made();
  changeAndWait(*live, {put(0, kLeft)});
  std::atomic<bool> over{false};
  std::atomic<int> ready{0};
  struct Seen {
    int versions = 0, halves = 0, backwards = 0, lost = 0;
    std::uint64_t heap = 0, frames = 0;
    std::vector<std::weak_ptr<const navmesh::World>> worlds;
  };
  std::vector<Seen> seen(kReaders);
  std::vector<std::thread> readers;
  for (int r = 0; r < kReaders; ++r) {
    readers.emplace_back([&, r] {
      Seen& mine = seen[static_cast<std::size_t>(r)];
      mine.worlds.reserve(10000);
      WorldReader reader = live->readerForSession(smallLimits());
      rdw::Session session = sessionIn(reader.version(), {1.0f, 0.0f, 1.0f});
      session.frame(head(0, 0), 0.0);
      ++ready;
      for (std::uint64_t frame = 1; !over || reader.version().number < live->status().version;
           ++frame) {
        const double t = static_cast<double>(frame) / 90.0;
        const std::uint64_t last = reader.version().number;
        const std::uint64_t heap = heapCalls;
        const bool fresh = reader.update(session);
        const rdw::FrameResult& result =
            session.frame(head(0.3 * std::sin(t), 0.3 * std::cos(t)), t);
        mine.heap += heapCalls - heap;
        ++mine.frames;
        mine.lost += (result.flags & rdw::kOffNavMesh) != 0 ? 1 : 0;
        mine.lost += &session.world() != reader.version().world.get() ? 1 : 0;
        if (!fresh) continue;
        ++mine.versions;
        mine.worlds.push_back(reader.version().world);
        mine.backwards += reader.version().number <= last ? 1 : 0;
        mine.halves +=
            onGround(reader.version(), kLeft) == onGround(reader.version(), kRight) ? 1 : 0;
        const auto& cost = reader.version().states->cost;
        const bool fits =
            cost.empty() || cost.size() == reader.version().world->graph.centroid.size();
        mine.halves += fits ? 0 : 1;
      }
    });
  }
  while (ready < kReaders) std::this_thread::yield();
  std::mt19937_64 rng(11);
  for (int i = 0; i < kChanges; ++i) {
    const bool right = i % 2 == 0;
    std::vector<ObstacleChange> changes;
    changes.push_back(right ? gone(0) : put(0, kLeft));
    changes.push_back(right ? put(1, kRight) : gone(1));
    ASSERT_TRUE(live->change(changes));
    if (navmesh::uniformInt(rng, 4) == 0) {
      const float cost = navmesh::uniformInt(rng, 2) == 0 ? navmesh::kClosed : 1.5f;
      ASSERT_TRUE(live->setArea(AreaId{1}, {kDoorway, cost}));
    }
    if (navmesh::uniformInt(rng, 3) != 0) live->waitUntilDone();
  }
  live->waitUntilDone();
  over = true;
  for (std::thread& reader : readers) reader.join();
  for (const Seen& one : seen) {
    EXPECT_GT(one.versions, 0);
    EXPECT_EQ(one.halves, 0) << "of " << one.versions;
    EXPECT_EQ(one.backwards, 0);
    EXPECT_EQ(one.lost, 0) << "of " << one.frames;
    EXPECT_EQ(one.heap, 0u) << "a frame neither allocates nor frees";
  }
  const auto alive = [&] {
    std::set<const navmesh::World*> worlds;
    for (const Seen& one : seen) {
      for (const auto& world : one.worlds) {
        if (const auto held = world.lock()) worlds.insert(held.get());
      }
    }
    return worlds.size();
  };
  EXPECT_TRUE(comesTrue([&] { return alive() == 1; })) << alive();
  live.reset();
  EXPECT_EQ(alive(), 0u);
}

TEST(LiveWorld, ClosesADoorwayAtOnceForWhoeverStandsInIt) {
  const auto live = made();
  WorldReader reader = live->reader();
  const auto before = live->status();
  const navmesh::Standing away{kLeft, 0.6f};
  EXPECT_FALSE(*live->setStanding(std::vector{away})) << "in the room nobody is in the way";
  EXPECT_EQ(live->status().version, before.version);
  const navmesh::Standing inDoor{{6.1f, 0.0f, 2.0f}, 0.6f};
  ASSERT_TRUE(*live->setStanding(std::vector{away, inDoor}));
  ASSERT_TRUE(reader.update());
  EXPECT_FALSE(reader.version().states->allOpen());
  const std::shared_ptr<const navmesh::World> world = reader.version().world;
  const auto closed = [&] {
    std::size_t count = 0;
    for (std::uint32_t p = 0; p < world->graph.polygonCount(); ++p) {
      count += reader.version().states->isClosed(navmesh::PolygonId{p});
    }
    return count;
  };
  EXPECT_GT(closed(), 0u);
  // Shifting from one foot to the other is no news.
  navmesh::Standing shifted = inDoor;
  shifted.foot.z += 0.01f;
  EXPECT_FALSE(*live->setStanding(std::vector{shifted, away}));
  navmesh::Standing priced = inDoor;
  priced.cost = 5.0f;
  ASSERT_TRUE(*live->setStanding(std::vector{priced}));
  ASSERT_TRUE(reader.update());
  EXPECT_EQ(closed(), 0u);
  EXPECT_FALSE(reader.version().states->allOpen());
  ASSERT_TRUE(*live->setStanding({}));
  ASSERT_TRUE(reader.update());
  EXPECT_TRUE(reader.version().states->allOpen());
  EXPECT_EQ(reader.version().world, world) << "no tile was built";
  priced.radius = -1.0f;
  EXPECT_THAT(live->setStanding(std::vector{priced}).error().message, HasSubstr("radius"));
}

TEST(LiveWorld, FindsItsLinksAgainInEveryWorld) {
  const auto live = made();
  WorldReader reader = live->reader();
  const navmesh::Link lift{navmesh::LinkId{5}, kLeft, kRight, 2.0f, true, true};
  ASSERT_TRUE(live->setLink(lift));
  ASSERT_TRUE(reader.update());
  EXPECT_EQ(reader.version().states->links.ways.size(), 2u);
  navmesh::Link off = lift;
  off.id = navmesh::LinkId{6};
  off.exit = {90.0f, 0.0f, 0.0f};
  EXPECT_THAT(live->setLink(off).error().message, HasSubstr("link 6: its exit"));
  // An obstacle elsewhere, and one on its end.
  ASSERT_TRUE(live->change(std::vector{put(1, {3.0f, 0.0f, 3.3f})}));
  live->waitUntilDone();
  ASSERT_TRUE(reader.update());
  EXPECT_EQ(reader.version().states->links.ways.size(), 2u);
  EXPECT_EQ(live->status().linksWithoutGround, 0u);
  ASSERT_TRUE(live->change(std::vector{put(1, kLeft, 0.8f)}));
  live->waitUntilDone();
  ASSERT_TRUE(reader.update());
  EXPECT_TRUE(reader.version().states->links.empty());
  EXPECT_EQ(live->status().linksWithoutGround, 1u);
  ASSERT_TRUE(live->change(std::vector{gone(1)}));
  live->waitUntilDone();
  ASSERT_TRUE(reader.update());
  EXPECT_EQ(reader.version().states->links.ways.size(), 2u);
  navmesh::Link shut = lift;
  shut.open = false;
  ASSERT_TRUE(live->setLink(shut));
  ASSERT_TRUE(reader.update());
  EXPECT_TRUE(reader.version().states->allOpen());
  live->removeLink(lift.id);
  ASSERT_TRUE(reader.update());
}

}  // namespace
}  // namespace forewalk::service
