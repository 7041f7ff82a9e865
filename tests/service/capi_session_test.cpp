// The C interface against the library below it, and against whatever else may come in.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <limits>
#include <string>

#include "navmesh/locate.h"
#include "rdw/session.h"
#include "tests/service/capi_support.h"

namespace forewalk::capi {
namespace {

using testing::defaultSettings;
using testing::frame;
using testing::makeNavMesh;
using testing::makeSession;
using testing::NavMeshHandle;
using testing::SessionHandle;
using testing::TimedHead;
using testing::wander;

forewalk_session_settings inTheWestRoom() {
  forewalk_session_settings settings = defaultSettings();
  settings.has_start = 1;
  settings.start_floor = {3.0f, 0.0f, 2.0f};
  settings.start_heading = 0.3f;
  return settings;
}

// What the first version of these structs ended with.
constexpr std::uint32_t kFirstSettings = offsetof(forewalk_session_settings, method);
constexpr std::uint32_t kFirstView = offsetof(forewalk_graph_view, fronts);

template <typename T>
std::array<unsigned char, sizeof(T)> bytesOf(const T& value) {
  std::array<unsigned char, sizeof(T)> bytes;
  std::memcpy(bytes.data(), &value, sizeof value);
  return bytes;
}

TEST(CapiSession, GivesTheBytesOfTheLibrary) {
  for (const navmesh::Scene& scene : {testing::twoRooms(0.9f), testing::twoStoreys()}) {
    const NavMeshHandle navmesh = makeNavMesh(scene);
    const auto world = testing::makeWorld(scene);
    ASSERT_EQ(forewalk_navmesh_polygon_count(navmesh.get()), world->graph.polygonCount());
    for (forewalk_controller controller = 0; controller <= FOREWALK_CONTROLLER_FORCE;
         ++controller) {
      forewalk_session_settings settings = inTheWestRoom();
      settings.controller = controller;
      settings.limits = FOREWALK_LIMITS_LABORATORY;
      const SessionHandle session = makeSession(navmesh, settings);

      rdw::SessionSettings same;
      same.space = *rdw::TrackedSpace::rectangle(4.0, 4.0);
      same.controller = rdw::controllerNames()[static_cast<std::size_t>(controller)];
      same.limits = *rdw::gainLimitsByName("laboratory");
      same.start = rdw::VirtualStart{{3.0f, 0.0f, 2.0f}, 0.3f};
      auto library = rdw::Session::make(world, same);
      ASSERT_TRUE(library) << library.error().message;

      std::uint32_t resets = 0;
      for (const TimedHead& head : wander(5, 3000)) {
        const forewalk_frame_out out = frame(session, head);
        const rdw::FrameResult& result = library->frame(head.pose, head.seconds);
        const auto& [p, q] = result.virtualPose;
        const forewalk_pose pose{{p.x, p.y, p.z}, {q.x, q.y, q.z, q.w}};
        ASSERT_EQ(bytesOf(out.virtual_pose), bytesOf(pose));
        ASSERT_EQ(out.flags, result.flags);
        ASSERT_EQ(out.translation, result.gains.translation);
        ASSERT_EQ(out.rotation, result.gains.rotation);
        ASSERT_EQ(out.curvature, result.gains.curvature);
        ASSERT_EQ(out.bending, result.gains.bending);
        ASSERT_EQ(out.injected_yaw, static_cast<float>(result.injectedYaw));
        ASSERT_EQ(out.injected_translation.x, static_cast<float>(result.injectedTranslation.x));
        ASSERT_EQ(out.injected_translation.z, -static_cast<float>(result.injectedTranslation.y));
        ASSERT_EQ(out.resetting != 0, result.reset.turning);
        ASSERT_EQ(out.instruction, static_cast<int>(result.reset.instruction));
        ASSERT_EQ(out.reset_remaining, static_cast<float>(result.reset.remaining));
        ASSERT_EQ(out.reset_turned, static_cast<float>(result.reset.progress));
        ASSERT_EQ(out.graph_nodes, result.graph->nodes.size());
        resets = out.reset_count;
        ASSERT_EQ(resets, result.resetCount);
      }
      EXPECT_GT(resets, 0u);
    }
  }
}

float lengthOnPlan(std::span<const forewalk_vec3> points) {
  float length = 0.0f;
  for (std::size_t i = 1; i < points.size(); ++i) {
    length += std::hypot(points[i].x - points[i - 1].x, points[i].z - points[i - 1].z);
  }
  return length;
}

TEST(CapiGraph, IsTheLibrarysWithItsPathsOnTheFloor) {
  const navmesh::Scene scene = testing::twoStoreys();
  const NavMeshHandle navmesh = makeNavMesh(scene);
  const auto world = testing::makeWorld(scene);
  forewalk_session_settings settings = inTheWestRoom();
  settings.horizon = 25.0f;
  const SessionHandle session = makeSession(navmesh, settings);
  prediction::Scratch scratch(world->graph);
  forewalk_graph_view view{};
  view.struct_size = sizeof view;
  ASSERT_EQ(forewalk_graph(session.get(), &view), FOREWALK_OK);
  EXPECT_EQ(view.node_count, 0u);  // no frame yet

  rdw::SessionSettings same;
  same.space = *rdw::TrackedSpace::rectangle(4.0, 4.0);
  same.horizon = 25.0f;
  same.start = rdw::VirtualStart{{3.0f, 0.0f, 2.0f}, 0.3f};
  auto library = rdw::Session::make(world, same);
  float highest = 0.0f;
  int frames = 0;
  for (const TimedHead& head : wander(6, 900)) {
    const forewalk_frame_out out = frame(session, head);
    const prediction::PredictionGraph& graph = *library->frame(head.pose, head.seconds).graph;
    if (frames++ % 30 != 0) continue;
    ASSERT_EQ(forewalk_graph(session.get(), &view), FOREWALK_OK);
    EXPECT_EQ(view.struct_size, sizeof view);
    EXPECT_EQ(view.horizon, 25.0f);
    EXPECT_EQ(view.complete_to, graph.completeTo);
    ASSERT_EQ(view.node_count, out.graph_nodes);
    ASSERT_EQ(view.node_count, graph.nodes.size());
    ASSERT_EQ(view.edge_count, graph.edges.size());
    for (std::uint32_t i = 0; i < view.node_count; ++i) {
      const forewalk_node& node = view.nodes[i];
      const prediction::Node& expected = graph.nodes[i];
      EXPECT_EQ(bytesOf(node.position), bytesOf(expected.position()));
      EXPECT_EQ(node.distance, expected.distance);
      EXPECT_EQ(node.prev, prediction::index(expected.prev));
      EXPECT_EQ(node.polygon, navmesh::index(expected.polygon));
      EXPECT_EQ(node.kind, static_cast<int>(expected.kind));
      EXPECT_EQ(node.reason, static_cast<int>(expected.reason));
      EXPECT_EQ(node.branch != 0, expected.branch);
    }
    std::uint32_t next = 0;
    for (std::uint32_t i = 0; i < view.edge_count; ++i) {
      const forewalk_edge& edge = view.edges[i];
      EXPECT_EQ(edge.from, prediction::index(graph.edges[i].from));
      EXPECT_EQ(edge.to, prediction::index(graph.edges[i].to));
      EXPECT_EQ(edge.loop != 0, graph.edges[i].kind == prediction::EdgeKind::kLoop);
      EXPECT_EQ(edge.length, graph.edges[i].length);
      ASSERT_EQ(edge.path_start, next);
      next += edge.path_count;
      ASSERT_LE(next, view.point_count);
      const std::span<const forewalk_vec3> path(view.points + edge.path_start, edge.path_count);
      EXPECT_NEAR(lengthOnPlan(path), edge.length, 1e-3f);
      const forewalk_vec3 from = view.nodes[edge.from].position, to = view.nodes[edge.to].position;
      EXPECT_NEAR(path.front().x, from.x, 1e-4f);
      EXPECT_NEAR(path.front().z, from.z, 1e-4f);
      EXPECT_NEAR(path.back().x, to.x, 1e-4f);
      EXPECT_NEAR(path.back().z, to.z, 1e-4f);
      for (const forewalk_vec3& point : path) {
        // The floor lies within the 2 cm by which a lifted path may leave it.
        EXPECT_TRUE(navmesh::locate(world->graph, world->locations, {point.x, point.y, point.z},
                                    {0.01f, 0.03f, 0.03f}))
            << point.x << " " << point.y << " " << point.z;
        highest = std::max(highest, point.y);
      }
    }
    EXPECT_EQ(next, view.point_count);
    // Asked again in the same frame it is the same.
    forewalk_graph_view again{};
    again.struct_size = sizeof again;
    ASSERT_EQ(forewalk_graph(session.get(), &again), FOREWALK_OK);
    EXPECT_EQ(bytesOf(again), bytesOf(view));
  }
  EXPECT_NEAR(highest, 3.0f, 0.1f);  // some way led up the stairs
}

TEST(CapiGraph, HasFrontsAndWidthsByFronts) {
  const navmesh::Scene scene = testing::twoStoreys();
  const NavMeshHandle navmesh = makeNavMesh(scene);
  const auto world = testing::makeWorld(scene);
  forewalk_session_settings settings = inTheWestRoom();
  settings.horizon = 15.0f;
  settings.method = FOREWALK_METHOD_FRONT;
  settings.persistence = 0.3f;
  const SessionHandle session = makeSession(navmesh, settings);
  rdw::SessionSettings same;
  same.space = *rdw::TrackedSpace::rectangle(4.0, 4.0);
  same.horizon = 15.0f;
  same.start = rdw::VirtualStart{{3.0f, 0.0f, 2.0f}, 0.3f};
  same.method = prediction::Method::kFront;
  same.front.persistence = 0.3f;
  auto library = rdw::Session::make(world, same);
  ASSERT_TRUE(library) << library.error().message;
  std::uint32_t branches = 0;
  int frames = 0;
  for (const TimedHead& head : wander(6, 900)) {
    const forewalk_frame_out out = frame(session, head);
    const rdw::FrameResult& result = library->frame(head.pose, head.seconds);
    const prediction::PredictionGraph& graph = *result.graph;
    const auto& [p, q] = result.virtualPose;
    ASSERT_EQ(bytesOf(out.virtual_pose),
              bytesOf(forewalk_pose{{p.x, p.y, p.z}, {q.x, q.y, q.z, q.w}}));
    if (frames++ % 30 != 0) continue;
    forewalk_graph_view view{};
    view.struct_size = sizeof view;
    ASSERT_EQ(forewalk_graph(session.get(), &view), FOREWALK_OK);
    EXPECT_EQ(view.method, FOREWALK_METHOD_FRONT);
    ASSERT_EQ(view.node_count, graph.nodes.size());
    ASSERT_EQ(view.edge_count, graph.edges.size());
    ASSERT_EQ(view.front_count, graph.terminals.size());
    for (std::uint32_t i = 0; i < view.node_count; ++i) {
      EXPECT_EQ(bytesOf(view.nodes[i].position), bytesOf(graph.nodes[i].position()));
      EXPECT_EQ(view.nodes[i].kind, static_cast<int>(graph.nodes[i].kind));
      EXPECT_EQ(view.nodes[i].reason, static_cast<int>(graph.nodes[i].reason));
      branches += view.nodes[i].branch;
    }
    for (std::uint32_t i = 0; i < view.edge_count; ++i) {
      EXPECT_EQ(view.widths[i], graph.edges[i].width);
      const forewalk_edge& edge = view.edges[i];
      const std::span<const forewalk_vec3> path(view.points + edge.path_start, edge.path_count);
      EXPECT_NEAR(lengthOnPlan(path), edge.length, 1e-2f);
    }
    for (std::uint32_t i = 0; i < view.front_count; ++i) {
      const forewalk_front& front = view.fronts[i];
      const forewalk_node& node = view.nodes[front.node];
      EXPECT_EQ(front.node, prediction::index(graph.terminals[i]));
      EXPECT_EQ(front.length, graph.fronts[i].length);
      EXPECT_EQ(front.length > 0.0f, node.reason == FOREWALK_REASON_HORIZON);
      EXPECT_EQ(front.from.x, graph.fronts[i].from.x);
      EXPECT_EQ(front.to.z, -graph.fronts[i].to.y);
      EXPECT_EQ(front.to.y, node.position.y);
    }
  }
  EXPECT_GT(branches, 0u);
}

TEST(CapiGraph, HasNoFrontsByPolygons) {
  const NavMeshHandle navmesh = makeNavMesh(testing::twoRooms(0.9f));
  const SessionHandle session = makeSession(navmesh, inTheWestRoom());
  frame(session, {});
  forewalk_graph_view view{};
  view.struct_size = sizeof view;
  ASSERT_EQ(forewalk_graph(session.get(), &view), FOREWALK_OK);
  EXPECT_EQ(view.method, FOREWALK_METHOD_POLYGON);
  EXPECT_EQ(view.front_count, 0u);
  for (std::uint32_t i = 0; i < view.edge_count; ++i) EXPECT_EQ(view.widths[i], 0.0f);
}

// --- what is refused

struct Refusal {
  const char* what;
  std::function<void(forewalk_session_settings&)> spoil;
  forewalk_status status;
};

TEST(CapiSession, RefusesSettingsThatCannotWork) {
  const NavMeshHandle navmesh = makeNavMesh(testing::twoRooms(0.9f));
  const float nan = std::nanf("");
  static const forewalk_point2 square[] = {{-2, -2}, {2, -2}, {2, 2}, {-2, 2}};
  static const std::size_t noPoints[] = {0};
  static const std::size_t wild[] = {std::numeric_limits<std::size_t>::max()};
  const Refusal refusals[] = {
      {"axes", [](auto& s) { s.axes = 3; }, FOREWALK_ERROR_ARGUMENT},
      {"axes", [](auto& s) { s.axes = -1; }, FOREWALK_ERROR_ARGUMENT},
      {"controller", [](auto& s) { s.controller = FOREWALK_CONTROLLER_FORCE + 1; },
       FOREWALK_ERROR_ARGUMENT},
      {"reset", [](auto& s) { s.reset = FOREWALK_RESET_AHEAD + 1; }, FOREWALK_ERROR_ARGUMENT},
      {"controller", [](auto& s) { s.controller = -1; }, FOREWALK_ERROR_ARGUMENT},
      {"limits", [](auto& s) { s.limits = 5; }, FOREWALK_ERROR_ARGUMENT},
      {"method", [](auto& s) { s.method = 2; }, FOREWALK_ERROR_ARGUMENT},
      {"method", [](auto& s) { s.method = -1; }, FOREWALK_ERROR_ARGUMENT},
      {"persistence", [&](auto& s) { s.persistence = nan; }, FOREWALK_ERROR_SETTING_OUT_OF_RANGE},
      {"persistence", [](auto& s) { s.persistence = -1; }, FOREWALK_ERROR_SETTING_OUT_OF_RANGE},
      {"horizon", [](auto& s) { s.horizon = 0; }, FOREWALK_ERROR_SETTING_OUT_OF_RANGE},
      {"horizon", [&](auto& s) { s.horizon = nan; }, FOREWALK_ERROR_SETTING_OUT_OF_RANGE},
      {"horizon", [](auto& s) { s.horizon = 1e30f; }, FOREWALK_ERROR_SETTING_OUT_OF_RANGE},
      {"", [](auto& s) { s.width = -4; }, FOREWALK_ERROR_SETTING_OUT_OF_RANGE},
      {"", [&](auto& s) { s.depth = nan; }, FOREWALK_ERROR_SETTING_OUT_OF_RANGE},
      {"", [](auto& s) { s.axes = FOREWALK_AXES_UNREAL, s.width = 4; },
       FOREWALK_ERROR_SETTING_OUT_OF_RANGE},
      {"null", [](auto& s) { s.border_count = 4; }, FOREWALK_ERROR_ARGUMENT},
      {"", [](auto& s) { s.border = square, s.border_count = 2; }, FOREWALK_ERROR_DATA_DAMAGED},
      {"4096", [](auto& s) { s.border = square, s.border_count = SIZE_MAX; },
       FOREWALK_ERROR_TOO_LARGE},
      {"null", [](auto& s) { s.hole_count = 1; }, FOREWALK_ERROR_ARGUMENT},
      {"border", [](auto& s) { s.hole_points = square, s.hole_sizes = noPoints, s.hole_count = 1; },
       FOREWALK_ERROR_SETTING_OUT_OF_RANGE},
      {"",
       [](auto& s) {
         s.border = square, s.border_count = 4;
         s.hole_points = square, s.hole_sizes = noPoints, s.hole_count = 1;
       },
       FOREWALK_ERROR_DATA_DAMAGED},
      {"4096",
       [](auto& s) {
         s.border = square, s.border_count = 4;
         s.hole_points = square, s.hole_sizes = wild, s.hole_count = 1;
       },
       FOREWALK_ERROR_TOO_LARGE},
      {"start",
       [](auto& s) {
         s.has_start = 1, s.start_floor = {500, 0, 0};
       },
       FOREWALK_ERROR_POSITION_OFF_NAVMESH},
      {"",
       [&](auto& s) {
         s.has_start = 1, s.start_floor = {nan, nan, nan};
       },
       FOREWALK_ERROR_POSITION_OFF_NAVMESH},
      {"", [](auto& s) { s.limits = FOREWALK_LIMITS_CUSTOM, s.rotation_min = 2; },
       FOREWALK_ERROR_SETTING_OUT_OF_RANGE},
      {"", [](auto& s) { s.limits = FOREWALK_LIMITS_CUSTOM, s.bending_max = 0; },
       FOREWALK_ERROR_SETTING_OUT_OF_RANGE},
      {"polygon", [](auto& s) { s.polygon_limit = 0; }, FOREWALK_ERROR_SETTING_OUT_OF_RANGE},
      {"struct_size", [](auto& s) { s.struct_size = 0; }, FOREWALK_ERROR_ARGUMENT},
      {"struct_size", [](auto& s) { s.struct_size = kFirstSettings - 4; }, FOREWALK_ERROR_ARGUMENT},
      {"struct_size", [](auto& s) { s.struct_size = 0xccccccccu; }, FOREWALK_ERROR_ARGUMENT},
  };
  for (const Refusal& refusal : refusals) {
    forewalk_session_settings settings = defaultSettings();
    refusal.spoil(settings);
    auto* session = reinterpret_cast<forewalk_session*>(0x1);
    EXPECT_EQ(forewalk_session_create(navmesh.get(), &settings, &session), refusal.status)
        << refusal.what << ": " << forewalk_last_error();
    EXPECT_EQ(session, nullptr);
    EXPECT_NE(std::string(forewalk_last_error()).find(refusal.what), std::string::npos)
        << forewalk_last_error();
  }
  // What is absurd, but can be.
  forewalk_session_settings settings = defaultSettings();
  settings.polygon_limit = std::numeric_limits<std::uint32_t>::max();
  settings.horizon = 1000.0f;
  settings.has_start = 1;
  settings.start_floor = {3, 0, 2};
  settings.start_heading = 1e30f;
  EXPECT_TRUE(testing::isFinite(frame(makeSession(navmesh, settings), {})));
}

TEST(CapiInterface, RefusesNull) {
  const NavMeshHandle navmesh = makeNavMesh(testing::twoRooms(0.9f));
  const SessionHandle session = makeSession(navmesh, defaultSettings());
  const testing::SceneArrays scene = testing::arraysOf(testing::twoRooms(0.9f));
  forewalk_navmesh* made = nullptr;
  forewalk_session* opened = nullptr;
  forewalk_frame_out out{};
  out.struct_size = sizeof out;
  std::size_t size = 0;
  const float* v = scene.vertices.data();
  const std::uint32_t* i = scene.indices.data();
  EXPECT_EQ(forewalk_navmesh_from_file(nullptr, nullptr, &made), FOREWALK_ERROR_ARGUMENT);
  EXPECT_EQ(forewalk_navmesh_from_file("x.obj", nullptr, nullptr), FOREWALK_ERROR_ARGUMENT);
  EXPECT_EQ(forewalk_navmesh_from_triangles(nullptr, 4, i, 6, 0, nullptr, &made),
            FOREWALK_ERROR_ARGUMENT);
  EXPECT_EQ(forewalk_navmesh_from_triangles(v, 4, nullptr, 6, 0, nullptr, &made),
            FOREWALK_ERROR_ARGUMENT);
  EXPECT_EQ(forewalk_navmesh_from_triangles(v, 4, i, 6, 0, nullptr, nullptr),
            FOREWALK_ERROR_ARGUMENT);
  EXPECT_EQ(forewalk_navmesh_from_triangles(nullptr, 0, nullptr, 0, 0, nullptr, &made),
            FOREWALK_ERROR_SCENE_EMPTY);
  EXPECT_EQ(forewalk_navmesh_from_fwmesh(nullptr, 10, &made), FOREWALK_ERROR_ARGUMENT);
  EXPECT_EQ(forewalk_navmesh_from_fwmesh("FWMESH", 6, nullptr), FOREWALK_ERROR_ARGUMENT);
  EXPECT_EQ(forewalk_navmesh_save(nullptr, nullptr, &size), FOREWALK_ERROR_ARGUMENT);
  EXPECT_EQ(forewalk_navmesh_save(navmesh.get(), nullptr, nullptr), FOREWALK_ERROR_ARGUMENT);
  EXPECT_EQ(forewalk_session_create(nullptr, nullptr, &opened), FOREWALK_ERROR_ARGUMENT);
  EXPECT_EQ(forewalk_session_create(navmesh.get(), nullptr, nullptr), FOREWALK_ERROR_ARGUMENT);
  EXPECT_EQ(forewalk_frame(nullptr, {}, {}, 0, &out), FOREWALK_ERROR_ARGUMENT);
  EXPECT_EQ(forewalk_frame(session.get(), {}, {}, 0, nullptr), FOREWALK_ERROR_ARGUMENT);
  EXPECT_EQ(forewalk_session_teleport(nullptr, {}, 0), FOREWALK_ERROR_ARGUMENT);
  EXPECT_EQ(forewalk_graph(session.get(), nullptr), FOREWALK_ERROR_ARGUMENT);
  forewalk_graph_view view{};
  view.struct_size = sizeof view;
  EXPECT_EQ(forewalk_graph(nullptr, &view), FOREWALK_ERROR_ARGUMENT);
  EXPECT_NE(std::string(forewalk_last_error()), "");
  EXPECT_EQ(forewalk_navmesh_polygon_count(nullptr), 0u);
  forewalk_navmesh_retain(nullptr);
  forewalk_navmesh_release(nullptr);
  forewalk_session_destroy(nullptr);
  forewalk_build_settings_init(nullptr, 0);
  forewalk_session_settings_init(nullptr, 0);
  // Null settings are the defaults.
  EXPECT_EQ(forewalk_session_create(navmesh.get(), nullptr, &opened), FOREWALK_OK);
  forewalk_session_destroy(opened);
}

// --- structs of other versions

struct NewerFrameOut {
  forewalk_frame_out known;
  std::uint32_t added[8];
};
struct NewerSettings {
  forewalk_session_settings known;
  std::uint64_t added[8];
};

TEST(CapiStructs, OfANewerCallerAreFilledAsFarAsTheyAreKnown) {
  const NavMeshHandle navmesh = makeNavMesh(testing::twoRooms(0.9f));
  NewerSettings settings;
  std::memset(&settings, 0xab, sizeof settings);
  settings.known = inTheWestRoom();
  settings.known.struct_size = sizeof settings;
  const SessionHandle session = makeSession(navmesh, settings.known);
  const SessionHandle same = makeSession(navmesh, inTheWestRoom());
  NewerFrameOut out;
  std::memset(&out, 0xcd, sizeof out);
  out.known.struct_size = sizeof out;
  const TimedHead head = wander(7, 1).front();
  const auto& [p, q] = head.pose;
  ASSERT_EQ(forewalk_frame(session.get(), {p.x, p.y, p.z}, {q.x, q.y, q.z, q.w}, 0.0, &out.known),
            FOREWALK_OK);
  const forewalk_frame_out expected = frame(same, {head.pose, 0.0});
  EXPECT_EQ(bytesOf(out.known.virtual_pose), bytesOf(expected.virtual_pose));
  EXPECT_EQ(out.known.graph_nodes, expected.graph_nodes);
  EXPECT_EQ(out.known.struct_size, sizeof out);
  for (const std::uint32_t word : out.added) EXPECT_EQ(word, 0xcdcdcdcdu);
}

TEST(CapiStructs, OfAnOlderCallerAreReadAndFilledAsFarAsTheyGo) {
  const NavMeshHandle navmesh = makeNavMesh(testing::twoRooms(0.9f));
  forewalk_session_settings settings = inTheWestRoom();
  // What lies behind an older caller's struct is anything.
  settings.method = 0x55555555;
  settings.persistence = std::nanf("");
  settings.struct_size = kFirstSettings;
  const SessionHandle session = makeSession(navmesh, settings);
  const SessionHandle same = makeSession(navmesh, inTheWestRoom());
  const TimedHead head = wander(7, 1).front();
  EXPECT_EQ(frame(session, head).graph_nodes, frame(same, head).graph_nodes);
  forewalk_graph_view view;
  std::memset(&view, 0xcd, sizeof view);
  const auto before = bytesOf(view);
  view.struct_size = kFirstView;
  ASSERT_EQ(forewalk_graph(session.get(), &view), FOREWALK_OK);
  EXPECT_GT(view.node_count, 0u);
  EXPECT_EQ(view.complete_to, 10.0f);
  EXPECT_EQ(view.struct_size, kFirstView);
  const auto after = bytesOf(view);
  EXPECT_TRUE(std::equal(after.begin() + kFirstView, after.end(), before.begin() + kFirstView));
}

TEST(CapiStructs, AreInitialisedAsFarAsTheCallerKnowsThem) {
  const forewalk_session_settings whole = inTheWestRoom();
  forewalk_session_settings older;
  std::memset(&older, 0xcd, sizeof older);
  const auto before = bytesOf(older);
  forewalk_session_settings_init(&older, kFirstSettings);
  const auto after = bytesOf(older);
  EXPECT_EQ(older.struct_size, kFirstSettings);
  EXPECT_EQ(older.horizon, whole.horizon);
  EXPECT_TRUE(
      std::equal(after.begin() + kFirstSettings, after.end(), before.begin() + kFirstSettings));

  NewerSettings newer;
  std::memset(&newer, 0xcd, sizeof newer);
  forewalk_session_settings_init(&newer.known, sizeof newer);
  EXPECT_EQ(newer.known.struct_size, sizeof newer);
  EXPECT_EQ(newer.known.horizon, whole.horizon);
  for (const std::uint64_t word : newer.added) EXPECT_EQ(word, 0u);

  // No version's size: nothing but the size is written, and no call takes it.
  for (const std::uint32_t size : {4u, 8u, 4097u, 0xffffffffu}) {
    forewalk_session_settings odd;
    std::memset(&odd, 0xcd, sizeof odd);
    forewalk_session_settings_init(&odd, size);
    EXPECT_EQ(odd.struct_size, 0u);
    odd.struct_size = 0xcdcdcdcdu;
    EXPECT_EQ(bytesOf(odd), before);
  }
}

TEST(CapiStructs, OfSizesThatNoVersionHadAreLeftAlone) {
  const NavMeshHandle navmesh = makeNavMesh(testing::twoRooms(0.9f));
  const SessionHandle session = makeSession(navmesh, inTheWestRoom());
  for (const std::uint32_t size : {0u, 4u, 36u, 99u, 4097u, 0xffffffffu}) {
    forewalk_frame_out out;
    std::memset(&out, 0xcd, sizeof out);
    out.struct_size = size;
    const auto before = bytesOf(out);
    EXPECT_EQ(forewalk_frame(session.get(), {0, 1.7f, 0}, {0, 0, 0, 1}, 0.0, &out),
              FOREWALK_ERROR_ARGUMENT);
    EXPECT_EQ(bytesOf(out), before);
    forewalk_graph_view view;
    std::memset(&view, 0xcd, sizeof view);
    view.struct_size = size == 99u ? 47u : size;
    EXPECT_EQ(forewalk_graph(session.get(), &view), FOREWALK_ERROR_ARGUMENT);
  }
  // The frame did not take place.
  EXPECT_NE(frame(session, {}).flags & FOREWALK_FLAG_FIRST_FRAME, 0u);
}

// --- odd frames

TEST(CapiFrame, ReportsOddInputAndGoesOn) {
  const NavMeshHandle navmesh = makeNavMesh(testing::twoRooms(0.9f));
  const float nan = std::nanf(""), inf = std::numeric_limits<float>::infinity();
  const double nand = std::nan("");
  struct Odd {
    forewalk_vec3 position;
    forewalk_quat orientation;
    double after;  // seconds
    std::uint32_t flag;
  };
  const forewalk_vec3 here{0, 1.7f, 0};
  const forewalk_quat ahead{0, 0, 0, 1};
  const Odd odds[] = {
      {{nan, 1.7f, 0}, ahead, 0.01, FOREWALK_FLAG_POSE_NOT_FINITE},
      {{0, inf, 0}, ahead, 0.01, FOREWALK_FLAG_POSE_NOT_FINITE},
      {{0, 1.7f, -3e38f}, ahead, 0.01, FOREWALK_FLAG_POSE_NOT_FINITE},
      {{500.0f, 1.7f, 0}, ahead, 0.01, FOREWALK_FLAG_TRACKING_JUMP},
      {here, {0, 0, 0, 0}, 0.01, FOREWALK_FLAG_ORIENTATION_UNUSABLE},
      {here, {nan, nan, nan, nan}, 0.01, FOREWALK_FLAG_ORIENTATION_UNUSABLE},
      {here, {inf, 0, 0, 1}, 0.01, FOREWALK_FLAG_ORIENTATION_UNUSABLE},
      {here, {0, 0, 0, 7}, 0.01, FOREWALK_FLAG_ORIENTATION_NOT_UNIT},
      {here, {0, 3e38f, 0, 3e38f}, 0.01, FOREWALK_FLAG_ORIENTATION_UNUSABLE},
      {here, {0, 1e-4f, 0, 1e-4f}, 0.01, FOREWALK_FLAG_ORIENTATION_NOT_UNIT},
      {here, ahead, 0.0, FOREWALK_FLAG_TIME_STOOD_STILL},
      {here, ahead, -5.0, FOREWALK_FLAG_TIME_RAN_BACKWARDS},
      {here, ahead, nand, FOREWALK_FLAG_TIME_RAN_BACKWARDS},
      {here, ahead, 1e9, FOREWALK_FLAG_TIME_GAP},
  };
  for (forewalk_axes axes = 0; axes < 3; ++axes) {
    for (const Odd& odd : odds) {
      forewalk_session_settings settings = defaultSettings();
      settings.axes = axes;
      if (axes > 0) settings.controller = FOREWALK_CONTROLLER_S2O;  // soon made
      const SessionHandle session = makeSession(navmesh, settings);
      forewalk_frame_out out{};
      out.struct_size = sizeof out;
      double seconds = 100.0;
      const float unit = axes == FOREWALK_AXES_UNREAL ? 100.0f : 1.0f;
      const auto step = [&](forewalk_vec3 p, const forewalk_quat& q, double time) {
        if (axes == FOREWALK_AXES_UNREAL) p = {-unit * p.z, unit * p.x, unit * p.y};
        EXPECT_EQ(forewalk_frame(session.get(), p, q, time, &out), FOREWALK_OK);
        EXPECT_TRUE(testing::isFinite(out));
      };
      for (int i = 0; i < 5; ++i) step(here, ahead, seconds += 0.01);
      step(odd.position, odd.orientation, seconds + odd.after);
      EXPECT_EQ(out.flags & odd.flag, odd.flag) << "axes " << axes << ", flags " << out.flags;
      // From a new beginning the session is as usable as ever.
      for (int i = 0; i < 5; ++i) step(here, ahead, seconds = 2e9 + i * 0.01);
      constexpr std::uint32_t kOdd =
          FOREWALK_FLAG_TIME_STOOD_STILL | FOREWALK_FLAG_TIME_RAN_BACKWARDS |
          FOREWALK_FLAG_TIME_GAP | FOREWALK_FLAG_TRACKING_JUMP | FOREWALK_FLAG_POSE_NOT_FINITE |
          FOREWALK_FLAG_ORIENTATION_NOT_UNIT | FOREWALK_FLAG_ORIENTATION_UNUSABLE;
      EXPECT_EQ(out.flags & kOdd, 0u);
      EXPECT_LE(std::abs(out.virtual_pose.orientation.w), 1.0f + 1e-3f);
    }
  }
}

TEST(CapiFrame, IsSafeBeforeAnyPoseWasSound) {
  const NavMeshHandle navmesh = makeNavMesh(testing::twoRooms(0.9f));
  const SessionHandle session = makeSession(navmesh, defaultSettings());
  const float nan = std::nanf("");
  forewalk_frame_out out{};
  out.struct_size = sizeof out;
  EXPECT_EQ(
      forewalk_frame(session.get(), {nan, nan, nan}, {nan, nan, nan, nan}, std::nan(""), &out),
      FOREWALK_OK);
  EXPECT_TRUE(testing::isFinite(out));
  forewalk_graph_view view{};
  view.struct_size = sizeof view;
  EXPECT_EQ(forewalk_graph(session.get(), &view), FOREWALK_OK);
}

// --- ownership

TEST(CapiNavMesh, MayBeReleasedBeforeItsSessions) {
  NavMeshHandle navmesh = makeNavMesh(testing::twoRooms(0.9f));
  const SessionHandle first = makeSession(navmesh, inTheWestRoom());
  const SessionHandle second = makeSession(navmesh, inTheWestRoom());
  forewalk_navmesh_retain(navmesh.get());
  forewalk_navmesh_release(navmesh.get());
  navmesh.reset();
  for (const TimedHead& head : wander(8, 200)) {
    EXPECT_EQ(bytesOf(frame(first, head).virtual_pose), bytesOf(frame(second, head).virtual_pose));
  }
}

TEST(CapiLastError, IsValidUtf8WhateverTheFileIsCalled) {
  forewalk_navmesh* made = nullptr;
  EXPECT_NE(forewalk_navmesh_from_file("no \xff\xc3[ such \xe2\x82.obj", nullptr, &made),
            FOREWALK_OK);
  const std::string error = forewalk_last_error();
  EXPECT_NE(error.find("no ??[ such ??.obj"), std::string::npos) << error;
  EXPECT_NE(forewalk_navmesh_from_file("no s\xc3\xbc\xe2\x82\xacht.obj", nullptr, &made),
            FOREWALK_OK);
  EXPECT_NE(std::string(forewalk_last_error()).find("s\xc3\xbc\xe2\x82\xacht.obj"),
            std::string::npos);
}

// --- starts, teleports, tracked spaces

TEST(CapiSession, StartsWhereItIsToldInEveryAxes) {
  const NavMeshHandle navmesh = makeNavMesh(testing::twoRooms(0.9f));
  struct Start {
    forewalk_axes axes;
    forewalk_vec3 floor;
    float heading;
    forewalk_vec3 head;  // physical
    forewalk_vec3 expected;
  };
  const float quarter = static_cast<float>(rdw::kPi) / 2.0f;
  // Always the west room's middle, looking left.
  const Start starts[] = {
      {FOREWALK_AXES_OPENXR, {3, 0, 2}, quarter, {0.5f, 1.7f, 0.5f}, {3, 1.7f, 2}},
      {FOREWALK_AXES_UNITY, {3, 0, -2}, -quarter, {0.5f, 1.7f, -0.5f}, {3, 1.7f, -2}},
      {FOREWALK_AXES_UNREAL, {-200, 300, 0}, -quarter, {-50, 50, 170}, {-200, 300, 170}},
  };
  for (const Start& start : starts) {
    forewalk_session_settings settings = defaultSettings();
    settings.axes = start.axes;
    settings.has_start = 1;
    settings.start_floor = start.floor;
    settings.start_heading = start.heading;
    const SessionHandle session = makeSession(navmesh, settings);
    forewalk_frame_out out{};
    out.struct_size = sizeof out;
    const auto expectThere = [&] {
      const forewalk_vec3 p = out.virtual_pose.position;
      const float unit = start.axes == FOREWALK_AXES_UNREAL ? 100.0f : 1.0f;
      EXPECT_NEAR(p.x, start.expected.x, 0.06f * unit);  // the floor's height is Recast's
      EXPECT_NEAR(p.y, start.expected.y, 0.06f * unit);
      EXPECT_NEAR(p.z, start.expected.z, 0.06f * unit);
      const forewalk_quat q = out.virtual_pose.orientation;
      const float axis = start.axes == FOREWALK_AXES_UNREAL ? q.z : q.y;
      EXPECT_NEAR(2.0f * std::atan2(axis, q.w), start.heading, 1e-5f);
    };
    ASSERT_EQ(forewalk_frame(session.get(), start.head, {0, 0, 0, 1}, 0.0, &out), FOREWALK_OK);
    expectThere();
    // Elsewhere, and back by teleport.
    EXPECT_EQ(forewalk_session_teleport(session.get(), {9000, 9000, 9000}, 0.0f),
              FOREWALK_ERROR_POSITION_OFF_NAVMESH);
    EXPECT_EQ(forewalk_session_teleport(session.get(), start.floor, std::nanf("")),
              FOREWALK_ERROR_SETTING_OUT_OF_RANGE);
    forewalk_vec3 elsewhere = start.head;
    elsewhere.x += start.axes == FOREWALK_AXES_UNREAL ? 80.0f : 0.8f;
    ASSERT_EQ(forewalk_frame(session.get(), elsewhere, {0, 0, 0, 1}, 0.1, &out), FOREWALK_OK);
    ASSERT_EQ(forewalk_session_teleport(session.get(), start.floor, start.heading), FOREWALK_OK);
    ASSERT_EQ(forewalk_frame(session.get(), elsewhere, {0, 0, 0, 1}, 0.2, &out), FOREWALK_OK);
    expectThere();
  }
}

TEST(CapiSession, TakesATrackedSpaceWithHolesInItsOwnUnit) {
  const NavMeshHandle navmesh = makeNavMesh(testing::twoRooms(0.9f));
  for (const forewalk_axes axes :
       {FOREWALK_AXES_OPENXR, FOREWALK_AXES_UNITY, FOREWALK_AXES_UNREAL}) {
    const float u = axes == FOREWALK_AXES_UNREAL ? 100.0f : 1.0f;
    // Wide to the right, with a pillar ahead on the right.
    const forewalk_point2 border[] = {
        {-1 * u, -2 * u}, {5 * u, -2 * u}, {5 * u, 2 * u}, {-1 * u, 2 * u}};
    const forewalk_point2 holes[] = {{2 * u, 0.5f * u}, {3 * u, 0.5f * u}, {3 * u, 1 * u},
                                     {2 * u, 1 * u},    {4 * u, -1 * u},   {4.5f * u, -1 * u},
                                     {4 * u, -0.5f * u}};
    const std::size_t sizes[] = {4, 3};
    forewalk_session_settings settings = defaultSettings();
    settings.axes = axes;
    settings.border = border;
    settings.border_count = 4;
    settings.hole_points = holes;
    settings.hole_sizes = sizes;
    settings.hole_count = 2;
    const SessionHandle session = makeSession(navmesh, settings);
    const auto outside = [&](float right, float forward) {
      forewalk_frame_out out{};
      out.struct_size = sizeof out;
      const forewalk_vec3 head = axes == FOREWALK_AXES_OPENXR ? forewalk_vec3{right, 1.7f, -forward}
                                 : axes == FOREWALK_AXES_UNITY
                                     ? forewalk_vec3{right, 1.7f, forward}
                                     : forewalk_vec3{100 * forward, 100 * right, 170};
      EXPECT_EQ(forewalk_frame(session.get(), head, {0, 0, 0, 1}, 0.0, &out), FOREWALK_OK);
      return (out.flags & FOREWALK_FLAG_OUTSIDE_SPACE) != 0;
    };
    EXPECT_FALSE(outside(0, 0));
    EXPECT_FALSE(outside(4.7f, 1.8f));
    EXPECT_TRUE(outside(-1.5f, 0));
    EXPECT_TRUE(outside(2.5f, 0.8f));
    EXPECT_FALSE(outside(2.5f, -0.8f));
    EXPECT_TRUE(outside(4.1f, -0.9f));
    EXPECT_FALSE(outside(4.4f, -0.6f));
  }
}

TEST(CapiSession, PredictsOnlyWhereAskedIfSetSo) {
  const NavMeshHandle navmesh = makeNavMesh(testing::twoRooms(0.9f));
  forewalk_session_settings settings = inTheWestRoom();
  settings.always_predict = 0;
  settings.controller = FOREWALK_CONTROLLER_S2C;
  EXPECT_EQ(frame(makeSession(navmesh, settings), {}).graph_nodes, 0u);
  settings.controller = FOREWALK_CONTROLLER_S2C_PREDICTIVE;
  EXPECT_GT(frame(makeSession(navmesh, settings), {}).graph_nodes, 0u);
}

TEST(CapiSession, NeverStopsAUserWithoutResets) {
  const NavMeshHandle navmesh = makeNavMesh(testing::twoRooms(0.9f));
  forewalk_session_settings settings = inTheWestRoom();
  settings.width = settings.depth = 2.0f;
  settings.resets = 0;
  const SessionHandle without = makeSession(navmesh, settings);
  settings.resets = 1;
  const SessionHandle with = makeSession(navmesh, settings);
  forewalk_frame_out a{}, b{};
  for (const TimedHead& head : wander(9, 2000)) {
    a = frame(without, head);
    b = frame(with, head);
  }
  EXPECT_EQ(a.reset_count, 0u);
  EXPECT_GT(b.reset_count, 0u);
}

}  // namespace
}  // namespace forewalk::capi
