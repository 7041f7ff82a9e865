#include "service/capi/axes.h"

#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <string>

#include "rdw/walk_file.h"
#include "tests/service/capi_support.h"

namespace forewalk::capi {
namespace {

using rdw::HeadPose;
using testing::TimedHead;

constexpr forewalk_axes kAll[] = {FOREWALK_AXES_OPENXR, FOREWALK_AXES_UNITY, FOREWALK_AXES_UNREAL};

void expectSame(forewalk_vec3 a, forewalk_vec3 b) {
  EXPECT_EQ(a.x, b.x);
  EXPECT_EQ(a.y, b.y);
  EXPECT_EQ(a.z, b.z);
}

// How any engine turns a vector by a quaternion: the formula knows no handedness.
forewalk_vec3 turned(forewalk_quat q, forewalk_vec3 v) {
  const glm::vec3 result = glm::quat(q.w, q.x, q.y, q.z) * glm::vec3(v.x, v.y, v.z);
  return {result.x, result.y, result.z};
}

TEST(CapiAxes, KnowEachEnginesDirections) {
  const glm::vec3 right(1, 0, 0), up(0, 1, 0), forward(0, 0, -1);
  expectSame(positionToUnity(right), {1, 0, 0});
  expectSame(positionToUnity(up), {0, 1, 0});
  expectSame(positionToUnity(forward), {0, 0, 1});
  expectSame(positionToUnreal(right), {0, 100, 0});
  expectSame(positionToUnreal(up), {0, 0, 100});
  expectSame(positionToUnreal(forward), {100, 0, 0});
  EXPECT_EQ(positionFromUnity({0, 0, 1}), forward);
  EXPECT_EQ(positionFromUnreal({100, 0, 0}), forward);
  EXPECT_EQ(positionFromUnreal({0, 100, 0}), right);
}

TEST(CapiAxes, TurnRightByAPositiveYawInTheLeftHandedTwo) {
  const float half = 0.5f * static_cast<float>(rdw::kPi) / 2.0f;
  // A quarter turn to the left in ours.
  const glm::quat left(std::cos(half), 0.0f, std::sin(half), 0.0f);
  const forewalk_quat unity = orientationToUnity(left);
  EXPECT_LT(unity.y * unity.w, 0.0f);
  EXPECT_NEAR(turned(unity, {0, 0, 1}).x, -1.0f, 1e-6f);  // forward becomes left
  const forewalk_quat unreal = orientationToUnreal(left);
  EXPECT_LT(unreal.z * unreal.w, 0.0f);
  EXPECT_NEAR(turned(unreal, {1, 0, 0}).y, -1.0f, 1e-6f);
  EXPECT_EQ(angleSign(FOREWALK_AXES_OPENXR), 1.0f);
  EXPECT_EQ(angleSign(FOREWALK_AXES_UNITY), -1.0f);
  EXPECT_EQ(angleSign(FOREWALK_AXES_UNREAL), -1.0f);
}

TEST(CapiAxes, ConvertThereAndBackWithoutLoss) {
  for (const TimedHead& head : testing::wander(1, 2000)) {
    for (const forewalk_axes axes : kAll) {
      const HeadPose back = poseFrom(axes, poseTo(axes, head.pose));
      EXPECT_EQ(back.orientation, head.pose.orientation);
      const float tolerance = axes == FOREWALK_AXES_UNREAL ? 2.5e-7f : 0.0f;
      EXPECT_LE(glm::distance(back.position, head.pose.position), tolerance);
    }
  }
}

TEST(CapiAxes, KeepWhatCentimetresHoldToTheBit) {
  for (int i = -50000; i <= 50000; i += 7) {
    const glm::vec3 position(static_cast<float>(i) / 1024.0f, 1.75f,
                             static_cast<float>(3 * i) / 1024.0f);
    EXPECT_EQ(positionFromUnreal(positionToUnreal(position)), position);
  }
}

// Turning a vector and converting it is converting both and turning it there.
TEST(CapiAxes, AgreeAboutWhatARotationDoes) {
  std::mt19937_64 rng(2);
  const auto random = [&] { return static_cast<float>(2.0 * navmesh::uniform(rng) - 1.0); };
  for (int i = 0; i < 1000; ++i) {
    const glm::quat q = glm::normalize(glm::quat(random(), random(), random(), random()));
    const glm::vec3 v(random(), random(), random());
    for (const forewalk_axes axes : kAll) {
      const forewalk_pose theirs = poseTo(axes, {glm::vec3(0.0f), q});
      const forewalk_vec3 there = turned(theirs.orientation, positionTo(axes, v));
      EXPECT_LE(glm::distance(positionFrom(axes, there), q * v), 2e-6f);
    }
  }
}

// --- the same walk, told in three languages

struct Told {
  HeadPose pose;  // ours
  float curvature, yaw, translation;
  std::uint32_t flags, resets, nodes;
};

std::vector<Told> tell(forewalk_axes axes, const testing::NavMeshHandle& navmesh,
                       forewalk_session_settings settings, const std::vector<TimedHead>& heads) {
  const float unit = unitsPerMetre(axes);
  settings.axes = axes;
  settings.width *= unit;
  settings.depth *= unit;
  const forewalk_vec3 floor = settings.start_floor;
  settings.start_floor = positionTo(axes, {floor.x, floor.y, floor.z});
  settings.start_heading *= angleSign(axes);
  const testing::SessionHandle session = testing::makeSession(navmesh, settings);
  std::vector<Told> told;
  for (const TimedHead& head : heads) {
    const forewalk_pose theirs = poseTo(axes, head.pose);
    forewalk_frame_out out{};
    out.struct_size = sizeof out;
    EXPECT_EQ(
        forewalk_frame(session.get(), theirs.position, theirs.orientation, head.seconds, &out),
        FOREWALK_OK);
    told.push_back({poseFrom(axes, out.virtual_pose), angleSign(axes) * out.curvature,
                    angleSign(axes) * out.injected_yaw, out.translation, out.flags, out.reset_count,
                    out.graph_nodes});
  }
  return told;
}

void expectTheSameWalk(const std::vector<Told>& a, const std::vector<Told>& b, float tolerance) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    ASSERT_EQ(a[i].curvature, b[i].curvature) << i;
    ASSERT_EQ(a[i].yaw, b[i].yaw) << i;
    ASSERT_EQ(a[i].translation, b[i].translation) << i;
    ASSERT_EQ(a[i].flags, b[i].flags) << i;
    ASSERT_EQ(a[i].resets, b[i].resets) << i;
    ASSERT_EQ(a[i].nodes, b[i].nodes) << i;
    ASSERT_EQ(a[i].pose.orientation, b[i].pose.orientation) << i;
    ASSERT_LE(glm::distance(a[i].pose.position, b[i].pose.position), tolerance) << i;
  }
}

// Positions on a grid of 1/1024 m, which centimetres hold without rounding: then nothing of a
// session's inside depends on the axes.
std::vector<TimedHead> onGrid(std::vector<TimedHead> heads) {
  for (TimedHead& head : heads)
    head.pose.position = glm::round(1024.0f * head.pose.position) / 1024.0f;
  return heads;
}

void expectMirrored(const testing::NavMeshHandle& navmesh, forewalk_session_settings settings,
                    const std::vector<TimedHead>& heads, std::uint32_t leastResets) {
  for (const forewalk_controller controller :
       {FOREWALK_CONTROLLER_S2C_PREDICTIVE, FOREWALK_CONTROLLER_S2O}) {
    settings.controller = controller;
    const auto ours = tell(FOREWALK_AXES_OPENXR, navmesh, settings, heads);
    EXPECT_GE(ours.back().resets, leastResets);
    expectTheSameWalk(ours, tell(FOREWALK_AXES_UNITY, navmesh, settings, heads), 0.0f);
    // Rounded to centimetres on its way in, the walk drifts from ours by a hundredth of a
    // millimetre.
    const auto unreal = tell(FOREWALK_AXES_UNREAL, navmesh, settings, heads);
    for (std::size_t i = 0; i < ours.size(); ++i) {
      ASSERT_LE(glm::distance(unreal[i].pose.position, ours[i].pose.position), 1e-4f) << i;
      ASSERT_EQ(unreal[i].resets, ours[i].resets) << i;
    }
    const auto grid = onGrid(heads);
    // What comes out is rounded to a float of centimetres: 4e-6 m at 50 m.
    expectTheSameWalk(tell(FOREWALK_AXES_OPENXR, navmesh, settings, grid),
                      tell(FOREWALK_AXES_UNREAL, navmesh, settings, grid), 4e-6f);
  }
}

TEST(CapiAxes, DoNotChangeTheVirtualWalkOfAMadeUpUser) {
  const testing::NavMeshHandle navmesh = testing::makeNavMesh(testing::twoRooms(0.9f));
  forewalk_session_settings settings = testing::defaultSettings();
  settings.width = settings.depth = 4.0f;
  settings.has_start = 1;
  settings.start_floor = {3.0f, 0.0f, 2.0f};
  settings.start_heading = 0.5f;
  expectMirrored(navmesh, settings, testing::wander(3, 5000), 1);
}

TEST(CapiAxes, DoNotChangeTheVirtualWalkOfARecordedUser) {
  const std::string folder = std::string(FOREWALK_SHARED_DATA) + "/walks/searching-a/";
  std::ifstream file(folder + "walks.csv", std::ios::binary);
  if (!file) GTEST_SKIP() << "no recorded walks under " << FOREWALK_SHARED_DATA;
  const std::string text(std::istreambuf_iterator<char>(file), {});
  const auto walks = rdw::parseWalks(std::as_bytes(std::span(text)), "walks.csv");
  ASSERT_TRUE(walks) << walks.error().message;
  forewalk_navmesh* made = nullptr;
  ASSERT_EQ(forewalk_navmesh_from_file((folder + "scene.obj").c_str(), nullptr, &made), FOREWALK_OK)
      << forewalk_last_error();
  const testing::NavMeshHandle navmesh(made);
  forewalk_session_settings settings = testing::defaultSettings();
  settings.width = settings.depth = 10.0f;  // smaller than the walk, so that there are resets
  settings.limits = FOREWALK_LIMITS_LABORATORY;
  std::vector<TimedHead> heads = testing::recordedHeads(walks->front(), 30.0);
  heads.resize(std::min<std::size_t>(heads.size(), 1800));
  expectMirrored(navmesh, settings, heads, 1);
}

}  // namespace
}  // namespace forewalk::capi
