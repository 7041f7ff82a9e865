// Worlds that move, through the C interface.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <thread>
#include <vector>

#include "tests/service/capi_support.h"

namespace forewalk {
namespace {

using ::testing::HasSubstr;

struct WorldRelease {
  void operator()(forewalk_world* world) const { forewalk_world_release(world); }
};
using WorldHandle = std::unique_ptr<forewalk_world, WorldRelease>;

/// Two rooms of 6 m x 6 m side by side with an opening of 2 m between them, its door at x = 6 to
/// 6.4.
navmesh::Scene rooms() {
  return testing::BlockScene("rooms")
      .floor({0, 0, 6, 6})
      .floor({6, 2, 6.4f, 4})
      .floor({6.4f, 0, 12, 6})
      .scene();
}

constexpr float kOtherRoom = 8.0f;  // x of places in it

constexpr forewalk_vec3 kDoor[] = {{6.0f, 0, 2}, {6.4f, 0, 2}, {6.4f, 0, 4}, {6.0f, 0, 4}};

forewalk_door doorway(bool open) {
  forewalk_door door{};
  door.id = 4;
  door.open = open ? 1 : 0;
  door.corners = kDoor;
  door.corner_count = 4;
  return door;
}

WorldHandle makeWorld(bool open, forewalk_axes axes = FOREWALK_AXES_OPENXR) {
  const testing::SceneArrays arrays = testing::arraysOf(rooms());
  const forewalk_door door = doorway(open);
  forewalk_world_settings settings;
  forewalk_world_settings_init(&settings, sizeof settings);
  settings.axes = axes;
  settings.doors = &door;
  settings.door_count = 1;
  forewalk_world* world = nullptr;
  EXPECT_EQ(forewalk_world_from_triangles(arrays.vertices.data(), arrays.vertices.size() / 3,
                                          arrays.indices.data(), arrays.indices.size(), &settings,
                                          &world),
            FOREWALK_OK)
      << forewalk_last_error();
  return WorldHandle(world);
}

testing::SessionHandle makeSession(const WorldHandle& world,
                                   forewalk_method method = FOREWALK_METHOD_POLYGON) {
  forewalk_session_settings settings = testing::defaultSettings();
  settings.has_start = 1;
  settings.start_floor = {2.0f, 0.0f, 3.0f};
  settings.horizon = 30.0f;
  settings.method = method;
  forewalk_session* session = nullptr;
  EXPECT_EQ(forewalk_session_create_in_world(world.get(), &settings, &session), FOREWALK_OK)
      << forewalk_last_error();
  return testing::SessionHandle(session);
}

/// How far in x the session's next graph reaches.
float reach(const testing::SessionHandle& session, double seconds) {
  testing::frame(session, {{{0.0f, 1.7f, 0.0f}, glm::quat(1, 0, 0, 0)}, seconds});
  forewalk_graph_view view{};
  view.struct_size = sizeof view;
  EXPECT_EQ(forewalk_graph(session.get(), &view), FOREWALK_OK);
  float farthest = 0.0f;
  for (std::uint32_t i = 0; i < view.node_count; ++i)
    farthest = std::max(farthest, view.nodes[i].position.x);
  return farthest;
}

TEST(CapiLiveWorld, OpensAndClosesItsDoors) {
  for (const forewalk_method method : {FOREWALK_METHOD_POLYGON, FOREWALK_METHOD_FRONT}) {
    const WorldHandle world = makeWorld(false);
    const auto session = makeSession(world, method);
    EXPECT_LT(reach(session, 0.0), 6.1f);
    const std::uint64_t before = forewalk_world_version(world.get());
    forewalk_door door = doorway(true);
    ASSERT_EQ(forewalk_world_set_door(world.get(), &door), FOREWALK_OK) << forewalk_last_error();
    EXPECT_GT(forewalk_world_version(world.get()), before);
    EXPECT_GT(reach(session, 0.1), kOtherRoom);
    door.open = 0;
    std::vector<forewalk_vec3> clockwise(std::rbegin(kDoor), std::rend(kDoor));
    door.corners = clockwise.data();
    ASSERT_EQ(forewalk_world_set_door(world.get(), &door), FOREWALK_OK);
    EXPECT_LT(reach(session, 0.2), 6.1f);
    EXPECT_GT(reach(makeSession(makeWorld(true), method), 0.0), kOtherRoom);
  }
}

TEST(CapiLiveWorld, LetsObstaclesComeMoveAndGo) {
  const WorldHandle world = makeWorld(true);
  const auto session = makeSession(world);
  EXPECT_GT(reach(session, 0.0), kOtherRoom);
  const forewalk_vec3 corners[] = {
      {5.8f, 0, 1.5f}, {6.6f, 0, 1.5f}, {6.6f, 0, 4.5f}, {5.8f, 0, 4.5f}};
  forewalk_obstacle box{}, pillar{}, prism{};
  box.position = {6.2f, 1.0f, 3.0f};
  box.half_size = {1.5f, 1.0f, 0.4f};
  box.heading = static_cast<float>(rdw::kPi / 2.0);  // turned across the opening
  pillar.shape = FOREWALK_SHAPE_CYLINDER;
  pillar.position = {6.2f, 0.0f, 3.0f};
  pillar.radius = 1.0f;
  pillar.height = 2.0f;
  prism.shape = FOREWALK_SHAPE_PRISM;
  prism.corners = corners;
  prism.corner_count = 4;
  prism.height = 2.0f;
  double seconds = 0.1;
  for (forewalk_obstacle obstacle : {box, pillar, prism}) {
    obstacle.id = 7;
    ASSERT_EQ(forewalk_world_set_obstacles(world.get(), &obstacle, 1), FOREWALK_OK)
        << forewalk_last_error();
    ASSERT_EQ(forewalk_world_wait(world.get()), FOREWALK_OK);
    EXPECT_LT(reach(session, seconds += 0.1), 6.3f) << obstacle.shape;
    ASSERT_EQ(forewalk_world_remove_obstacle(world.get(), 7), FOREWALK_OK);
    ASSERT_EQ(forewalk_world_wait(world.get()), FOREWALK_OK);
    EXPECT_GT(reach(session, seconds += 0.1), kOtherRoom) << obstacle.shape;
  }
}

TEST(CapiLiveWorld, IsToldInItsOwnAxes) {
  // The rooms as Unity has them: z forward, so that everything is mirrored in z.
  testing::SceneArrays arrays = testing::arraysOf(rooms());
  for (std::size_t i = 2; i < arrays.vertices.size(); i += 3) arrays.vertices[i] *= -1.0f;
  std::vector<forewalk_vec3> corners(std::begin(kDoor), std::end(kDoor));
  for (forewalk_vec3& corner : corners) corner.z = -corner.z;
  for (std::size_t i = 0; i + 2 < arrays.indices.size(); i += 3)
    std::swap(arrays.indices[i + 1], arrays.indices[i + 2]);
  forewalk_door door = doorway(false);
  door.corners = corners.data();
  forewalk_world_settings settings;
  forewalk_world_settings_init(&settings, sizeof settings);
  settings.axes = FOREWALK_AXES_UNITY;
  settings.doors = &door;
  settings.door_count = 1;
  forewalk_world* made = nullptr;
  ASSERT_EQ(
      forewalk_world_from_triangles(arrays.vertices.data(), arrays.vertices.size() / 3,
                                    arrays.indices.data(), arrays.indices.size(), &settings, &made),
      FOREWALK_OK)
      << forewalk_last_error();
  const WorldHandle world(made);
  const auto session = makeSession(world);  // speaks OpenXR's
  EXPECT_LT(reach(session, 0.0), 6.1f);
  door.open = 1;
  ASSERT_EQ(forewalk_world_set_door(world.get(), &door), FOREWALK_OK);
  EXPECT_GT(reach(session, 0.1), kOtherRoom);
  forewalk_obstacle box{};
  box.position = {6.2f, 1.0f, -3.0f};
  box.half_size = {0.4f, 1.0f, 1.5f};
  ASSERT_EQ(forewalk_world_set_obstacles(world.get(), &box, 1), FOREWALK_OK);
  ASSERT_EQ(forewalk_world_wait(world.get()), FOREWALK_OK);
  EXPECT_LT(reach(session, 0.2), 6.3f);
}

TEST(CapiLiveWorld, KnowsLinksAndWhoStandsWhere) {
  const WorldHandle world = makeWorld(false);
  const auto session = makeSession(world);
  forewalk_link lift{3, {1.0f, 0.0f, 1.0f}, {11.0f, 0.0f, 1.0f}, 2.5f, 0, 0};
  ASSERT_EQ(forewalk_world_set_link(world.get(), &lift), FOREWALK_OK) << forewalk_last_error();
  EXPECT_GT(reach(session, 0.1), kOtherRoom);
  ASSERT_EQ(forewalk_world_remove_link(world.get(), 3), FOREWALK_OK);
  EXPECT_LT(reach(session, 0.2), 6.1f);
  const forewalk_door open = doorway(true);
  ASSERT_EQ(forewalk_world_set_door(world.get(), &open), FOREWALK_OK);
  EXPECT_GT(reach(session, 0.3), kOtherRoom);
  const forewalk_standing guard{{6.2f, 0.0f, 3.0f}, 1.2f, 0.0f};
  ASSERT_EQ(forewalk_world_set_standing(world.get(), &guard, 1), FOREWALK_OK);
  EXPECT_LT(reach(session, 0.4), 6.5f);
  ASSERT_EQ(forewalk_world_set_standing(world.get(), nullptr, 0), FOREWALK_OK);
  EXPECT_GT(reach(session, 0.5), kOtherRoom);
}

TEST(CapiLiveWorld, ChangesWhileOthersWalk) {
  WorldHandle world = makeWorld(true);
  std::atomic<bool> done{false};
  std::thread builder([&, kept = (forewalk_world_retain(world.get()), world.get())] {
    for (int i = 0; i < 40; ++i) {
      forewalk_obstacle pillar{};
      pillar.shape = FOREWALK_SHAPE_CYLINDER;
      pillar.position = {1.0f + 0.25f * static_cast<float>(i), 0.0f, 1.0f};
      pillar.radius = 0.3f;
      pillar.height = 2.0f;
      EXPECT_EQ(forewalk_world_set_obstacles(kept, &pillar, 1), FOREWALK_OK);
      const forewalk_door door = doorway(i % 2 == 0);
      EXPECT_EQ(forewalk_world_set_door(kept, &door), FOREWALK_OK);
      EXPECT_EQ(forewalk_world_wait(kept), FOREWALK_OK);
    }
    done = true;
    forewalk_world_release(kept);
  });
  std::vector<std::thread> walkers;
  std::atomic<int> unsound{0};
  for (std::uint64_t user = 0; user < 3; ++user) {
    walkers.emplace_back([&, user] {
      const auto session = makeSession(world);
      const auto heads = testing::wander(user + 1, 600);
      do {
        for (const testing::TimedHead& head : heads)
          if (!testing::isFinite(testing::frame(session, head))) ++unsound;
      } while (!done);
    });
  }
  builder.join();
  for (std::thread& walker : walkers) walker.join();
  EXPECT_EQ(unsound, 0);
  // A session outlives the caller's handle.
  const auto session = makeSession(world);
  world.reset();
  EXPECT_GT(reach(session, 0.0), 3.0f);
}

TEST(CapiLiveWorld, SaysWhatCannotWork) {
  const WorldHandle world = makeWorld(true);
  const auto session = makeSession(world);
  EXPECT_EQ(forewalk_session_set_links(session.get(), nullptr, 0), FOREWALK_ERROR_ARGUMENT);
  EXPECT_THAT(forewalk_last_error(), HasSubstr("forewalk_world_set_link"));
  EXPECT_EQ(forewalk_session_set_standing(session.get(), nullptr, 0), FOREWALK_ERROR_ARGUMENT);
  const auto navmesh = testing::makeNavMesh(rooms());
  EXPECT_EQ(forewalk_session_enter(session.get(), navmesh.get()), FOREWALK_ERROR_ARGUMENT);

  forewalk_door door = doorway(true);
  door.corner_count = 2;
  EXPECT_EQ(forewalk_world_set_door(world.get(), &door), FOREWALK_ERROR_SETTING_OUT_OF_RANGE);
  EXPECT_THAT(forewalk_last_error(), HasSubstr("door 4: 2 corners"));
  door = doorway(false);
  door.height = -1.0f;
  EXPECT_EQ(forewalk_world_set_door(world.get(), &door), FOREWALK_ERROR_SETTING_OUT_OF_RANGE);
  door = doorway(false);
  door.cost = 0.5f;
  EXPECT_EQ(forewalk_world_set_door(world.get(), &door), FOREWALK_ERROR_SETTING_OUT_OF_RANGE);
  forewalk_obstacle wrong{};
  wrong.shape = 9;
  EXPECT_EQ(forewalk_world_set_obstacles(world.get(), &wrong, 1),
            FOREWALK_ERROR_SETTING_OUT_OF_RANGE);
  EXPECT_THAT(forewalk_last_error(), HasSubstr("shape 9"));
  wrong.shape = FOREWALK_SHAPE_CYLINDER;
  EXPECT_EQ(forewalk_world_set_obstacles(world.get(), &wrong, 1),
            FOREWALK_ERROR_SETTING_OUT_OF_RANGE);
  forewalk_world* none = nullptr;
  EXPECT_EQ(forewalk_world_from_file("no-such.obj", nullptr, &none),
            FOREWALK_ERROR_FILE_UNREADABLE);
  EXPECT_EQ(forewalk_world_from_file("built.fwmesh", nullptr, &none),
            FOREWALK_ERROR_FORMAT_UNSUPPORTED);
  EXPECT_THAT(forewalk_last_error(), HasSubstr("needs the scene"));
  EXPECT_EQ(none, nullptr);
  EXPECT_EQ(forewalk_world_version(nullptr), 0u);
  // All of it went by without a trace.
  EXPECT_GT(reach(session, 0.0), kOtherRoom);
}

}  // namespace
}  // namespace forewalk
