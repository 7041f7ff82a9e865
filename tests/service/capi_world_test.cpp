// Links, people in doorways and other worlds through the C interface.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "tests/service/capi_support.h"
#include "tests/support/block_scene.h"

namespace forewalk {
namespace {

using testing::frame;
using ::testing::HasSubstr;
using testing::makeNavMesh;
using testing::makeSession;

/// Two rooms of 4 m, 6 m apart.
navmesh::Scene islands() {
  return testing::BlockScene("islands").floor({0, 0, 4, 4}).floor({10, 0, 14, 4}).scene();
}

forewalk_session_settings at(float x, float z) {
  forewalk_session_settings settings = testing::defaultSettings();
  settings.has_start = 1;
  settings.start_floor = {x, 0.0f, z};
  settings.horizon = 20.0f;
  settings.always_predict = 1;
  return settings;
}

testing::TimedHead stands(double seconds) {
  return {{{0.0f, 1.7f, 0.0f}, glm::quat(1, 0, 0, 0)}, seconds};
}

float farthestX(const testing::SessionHandle& session) {
  forewalk_graph_view view{};
  view.struct_size = sizeof view;
  EXPECT_EQ(forewalk_graph(session.get(), &view), FOREWALK_OK);
  float farthest = 0.0f;
  for (std::uint32_t i = 0; i < view.node_count; ++i)
    farthest = std::max(farthest, view.nodes[i].position.x);
  return farthest;
}

TEST(CapiLinks, LeadToTheOtherRoom) {
  const auto navmesh = makeNavMesh(islands());
  const auto session = makeSession(navmesh, at(2.0f, 2.0f));
  frame(session, stands(0.0));
  EXPECT_LT(farthestX(session), 4.0f);
  forewalk_link lift{3, {1.0f, 0.0f, 1.0f}, {13.0f, 0.0f, 1.0f}, 2.5f, 0, 0};
  ASSERT_EQ(forewalk_session_set_links(session.get(), &lift, 1), FOREWALK_OK);
  frame(session, stands(0.1));
  EXPECT_GT(farthestX(session), 10.0f);
  lift.closed = 1;
  ASSERT_EQ(forewalk_session_set_links(session.get(), &lift, 1), FOREWALK_OK);
  frame(session, stands(0.2));
  EXPECT_LT(farthestX(session), 4.0f);
  lift.exit.y = 9.0f;
  EXPECT_EQ(forewalk_session_set_links(session.get(), &lift, 1),
            FOREWALK_ERROR_POSITION_OFF_NAVMESH);
  EXPECT_THAT(forewalk_last_error(), HasSubstr("link 3: its exit"));
  EXPECT_EQ(forewalk_session_set_links(session.get(), nullptr, 1), FOREWALK_ERROR_ARGUMENT);
  EXPECT_EQ(forewalk_session_set_links(session.get(), nullptr, 0), FOREWALK_OK);
}

TEST(CapiLinks, LeadGraphsByFrontsToTheOtherRoom) {
  const auto navmesh = makeNavMesh(islands());
  forewalk_session_settings settings = at(2.0f, 2.0f);
  settings.method = FOREWALK_METHOD_FRONT;
  const auto session = makeSession(navmesh, settings);
  frame(session, stands(0.0));
  EXPECT_LT(farthestX(session), 4.0f);
  forewalk_link lift{3, {1.0f, 0.0f, 1.0f}, {13.0f, 0.0f, 1.0f}, 2.5f, 0, 0};
  ASSERT_EQ(forewalk_session_set_links(session.get(), &lift, 1), FOREWALK_OK);
  frame(session, stands(0.1));
  EXPECT_GT(farthestX(session), 10.0f);
  forewalk_graph_view view{};
  view.struct_size = sizeof view;
  ASSERT_EQ(forewalk_graph(session.get(), &view), FOREWALK_OK);
  EXPECT_EQ(view.method, FOREWALK_METHOD_FRONT);
  // In some path the two ends of the link follow each other.
  const auto isNear = [](const forewalk_vec3& place, float x) {
    return std::abs(place.x - x) < 0.01f && std::abs(place.z - 1.0f) < 0.01f;
  };
  bool through = false;
  for (std::uint32_t e = 0; e < view.edge_count; ++e) {
    const forewalk_vec3* path = view.points + view.edges[e].path_start;
    for (std::uint32_t i = 0; i + 1 < view.edges[e].path_count; ++i) {
      through = through || (isNear(path[i], 13.0f) && isNear(path[i + 1], 1.0f));
    }
  }
  EXPECT_TRUE(through);
  lift.closed = 1;
  ASSERT_EQ(forewalk_session_set_links(session.get(), &lift, 1), FOREWALK_OK);
  frame(session, stands(0.2));
  EXPECT_LT(farthestX(session), 4.0f);
}

// What it closes is tested with LiveWorld, whose ground is cut along the doorway.
TEST(CapiStanding, IsTakenAndRefused) {
  const auto navmesh = makeNavMesh(testing::twoRooms(1.2f));
  const auto session = makeSession(navmesh, at(3.0f, 2.0f));
  forewalk_standing person{{6.1f, 0.0f, 2.0f}, 0.6f, 0.0f};
  ASSERT_EQ(forewalk_session_set_standing(session.get(), &person, 1), FOREWALK_OK);
  frame(session, stands(0.0));
  ASSERT_EQ(forewalk_session_set_standing(session.get(), nullptr, 0), FOREWALK_OK);
  frame(session, stands(0.1));
  EXPECT_GT(farthestX(session), 7.0f);
  person.radius = -1.0f;
  EXPECT_EQ(forewalk_session_set_standing(session.get(), &person, 1),
            FOREWALK_ERROR_SETTING_OUT_OF_RANGE);
  EXPECT_EQ(forewalk_session_set_standing(session.get(), nullptr, 1), FOREWALK_ERROR_ARGUMENT);
}

TEST(CapiWorlds, ReportAUserWhoseGroundWasTaken) {
  const auto navmesh = makeNavMesh(testing::BlockScene("hall").floor({0, 0, 8, 8}).scene());
  const auto session = makeSession(navmesh, at(4.0f, 4.0f));
  EXPECT_EQ(frame(session, stands(0.0)).flags & FOREWALK_FLAG_GROUND_TAKEN, 0u);
  const auto crate = makeNavMesh(
      testing::BlockScene("crate").floor({0, 0, 8, 8}).box({3, 3, 5.5f, 5}, 0, 1.5f).scene());
  ASSERT_EQ(forewalk_session_enter(session.get(), crate.get()), FOREWALK_OK);
  const forewalk_frame_out inside = frame(session, stands(0.1));
  EXPECT_NE(inside.flags & FOREWALK_FLAG_GROUND_TAKEN, 0u);
  forewalk_graph_view view{};
  view.struct_size = sizeof view;
  ASSERT_EQ(forewalk_graph(session.get(), &view), FOREWALK_OK);
  ASSERT_GT(view.node_count, 1u);
  const forewalk_vec3 source = view.nodes[0].position;
  EXPECT_LT(std::hypot(source.x - 4.0f, source.z - 4.0f), 1.7f) << "the nearest ground";
  EXPECT_TRUE(source.z < 3.0f || source.z > 5.0f || source.x < 3.0f || source.x > 5.5f);
  ASSERT_EQ(forewalk_session_enter(session.get(), navmesh.get()), FOREWALK_OK);
  EXPECT_EQ(frame(session, stands(0.2)).flags & FOREWALK_FLAG_GROUND_TAKEN, 0u);
  EXPECT_EQ(forewalk_session_enter(session.get(), nullptr), FOREWALK_ERROR_ARGUMENT);
}

}  // namespace
}  // namespace forewalk
