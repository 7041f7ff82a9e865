// Several users in one room through one shared space.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <thread>
#include <vector>

#include "tests/service/capi_support.h"

namespace forewalk {
namespace {

using ::testing::HasSubstr;

struct SpaceRelease {
  void operator()(forewalk_space* space) const { forewalk_space_release(space); }
};
using SpaceHandle = std::unique_ptr<forewalk_space, SpaceRelease>;

SpaceHandle makeSpace(float width, float depth, std::uint32_t users = 16,
                      forewalk_axes axes = FOREWALK_AXES_OPENXR) {
  forewalk_space_settings settings;
  forewalk_space_settings_init(&settings, sizeof settings);
  settings.axes = axes;
  settings.width = width;
  settings.depth = depth;
  settings.user_limit = users;
  forewalk_space* space = nullptr;
  EXPECT_EQ(forewalk_space_create(&settings, &space), FOREWALK_OK) << forewalk_last_error();
  return SpaceHandle(space);
}

navmesh::Scene plain() { return testing::BlockScene("plain").floor({-30, -30, 30, 30}).scene(); }

forewalk_session_settings in(const SpaceHandle& space, forewalk_axes axes = FOREWALK_AXES_OPENXR) {
  forewalk_session_settings settings = testing::defaultSettings();
  settings.axes = axes;
  settings.space = space.get();
  settings.controller = FOREWALK_CONTROLLER_S2C;
  return settings;
}

/// A user of the room, by what the session tells them; `left` is how they turn.
struct Body {
  glm::dvec2 position;
  double heading;
  double left = 1.0;

  testing::TimedHead step(const forewalk_frame_out& last, int frame) {
    constexpr double kDt = 1.0 / 90.0;
    if (last.resetting != 0) {
      heading += left * 1.5 * kDt;
    } else if (frame > 0) {
      position += 1.0 * kDt * rdw::directionOf(heading);
    }
    const auto half = 0.5 * heading;
    return {{navmesh::toSpace(glm::vec2(position), 1.7f),
             glm::quat(glm::dquat(std::cos(half), 0.0, std::sin(half), 0.0))},
            frame * kDt};
  }
};

TEST(CapiSpace, OfOneUserIsARoomOfTheirOwn) {
  const auto navmesh = testing::makeNavMesh(plain());
  const SpaceHandle space = makeSpace(5.0f, 6.0f);
  const auto shared = testing::makeSession(navmesh, in(space));
  forewalk_session_settings settings = testing::defaultSettings();
  settings.controller = FOREWALK_CONTROLLER_S2C;
  settings.width = 5.0f;
  settings.depth = 6.0f;
  const auto alone = testing::makeSession(navmesh, settings);
  std::uint32_t resets = 0;
  for (const testing::TimedHead& head : testing::wander(7, 4000)) {
    const forewalk_frame_out a = testing::frame(shared, head);
    const forewalk_frame_out b = testing::frame(alone, head);
    ASSERT_EQ(std::memcmp(&a.virtual_pose, &b.virtual_pose, sizeof a.virtual_pose), 0);
    ASSERT_EQ(a.flags, b.flags);
    resets = a.reset_count;
  }
  EXPECT_GT(resets, 0u);
}

/// How near two people come who walk towards each other along a room of 12 m for ten seconds.
double nearest(const testing::SessionHandle& a, const testing::SessionHandle& b) {
  Body one{{0.0, -4.0}, 0.0}, two{{0.1, 4.0}, rdw::kPi};
  forewalk_frame_out outOne{}, outTwo{};
  double nearest = 1e9;
  for (int frame = 0; frame < 900; ++frame) {
    outOne = testing::frame(a, one.step(outOne, frame));
    outTwo = testing::frame(b, two.step(outTwo, frame));
    nearest = std::min(nearest, glm::distance(one.position, two.position));
  }
  return nearest;
}

TEST(CapiSpace, KeepsItsUsersApart) {
  const auto navmesh = testing::makeNavMesh(plain());
  const SpaceHandle space = makeSpace(6.0f, 12.0f);
  EXPECT_GT(
      nearest(testing::makeSession(navmesh, in(space)), testing::makeSession(navmesh, in(space))),
      0.5);
  // They would have met: each in a room of their own.
  const SpaceHandle mine = makeSpace(6.0f, 12.0f), yours = makeSpace(6.0f, 12.0f);
  EXPECT_LT(
      nearest(testing::makeSession(navmesh, in(mine)), testing::makeSession(navmesh, in(yours))),
      0.3);
}

TEST(CapiSpace, HasRoomForSoManyAndNoMore) {
  const auto navmesh = testing::makeNavMesh(plain());
  SpaceHandle space = makeSpace(6.0f, 6.0f, 2);
  const forewalk_session_settings settings = in(space);
  auto first = testing::makeSession(navmesh, settings);
  const auto second = testing::makeSession(navmesh, settings);
  forewalk_session* third = nullptr;
  EXPECT_EQ(forewalk_session_create(navmesh.get(), &settings, &third), FOREWALK_ERROR_TOO_LARGE);
  EXPECT_THAT(forewalk_last_error(), HasSubstr("user_limit"));
  EXPECT_EQ(third, nullptr);
  first.reset();
  const auto again = testing::makeSession(navmesh, settings);
  EXPECT_NE(again, nullptr);
  // Settings that fail give their place back.
  space = makeSpace(6.0f, 6.0f, 1);
  forewalk_session_settings wrong = in(space);
  wrong.horizon = -1.0f;
  EXPECT_EQ(forewalk_session_create(navmesh.get(), &wrong, &third),
            FOREWALK_ERROR_SETTING_OUT_OF_RANGE);
  EXPECT_NE(testing::makeSession(navmesh, in(space)), nullptr);
}

TEST(CapiSpace, IsOneRoomWhateverAxesItsUsersSpeak) {
  const auto navmesh = testing::makeNavMesh(plain());
  const SpaceHandle metres = makeSpace(6.0f, 12.0f);
  const SpaceHandle centimetres = makeSpace(600.0f, 1200.0f, 16, FOREWALK_AXES_UNREAL);
  const auto a = testing::makeSession(navmesh, in(metres));
  const auto b = testing::makeSession(navmesh, in(metres));
  const auto c = testing::makeSession(navmesh, in(centimetres));
  const auto d = testing::makeSession(navmesh, in(centimetres, FOREWALK_AXES_UNITY));
  Body one{{0.0, -4.0}, 0.0}, two{{0.1, 4.0}, rdw::kPi};
  forewalk_frame_out outOne{}, outTwo{};
  int resets = 0;
  for (int frame = 0; frame < 900; ++frame) {
    const testing::TimedHead first = one.step(outOne, frame), second = two.step(outTwo, frame);
    outOne = testing::frame(a, first);
    outTwo = testing::frame(b, second);
    const forewalk_frame_out likeOne = testing::frame(c, first);
    forewalk_frame_out likeTwo{};
    likeTwo.struct_size = sizeof likeTwo;
    const auto& [p, q] = second.pose;
    ASSERT_EQ(
        forewalk_frame(d.get(), {p.x, p.y, -p.z}, {-q.x, -q.y, q.z, q.w}, second.seconds, &likeTwo),
        FOREWALK_OK);
    ASSERT_EQ(std::memcmp(&likeOne.virtual_pose, &outOne.virtual_pose, sizeof(forewalk_pose)), 0);
    ASSERT_EQ(likeTwo.virtual_pose.position.x, outTwo.virtual_pose.position.x);
    ASSERT_EQ(likeTwo.virtual_pose.position.z, -outTwo.virtual_pose.position.z);
    ASSERT_EQ(likeTwo.reset_count, outTwo.reset_count);
    resets += static_cast<int>(outTwo.reset_count);
  }
  EXPECT_GT(resets, 0);
}

TEST(CapiSpace, IsReadAndWrittenByManyThreads) {
  const auto navmesh = testing::makeNavMesh(plain());
  SpaceHandle space = makeSpace(8.0f, 8.0f);
  std::vector<std::thread> threads;
  std::vector<int> unsound(6, 0);
  for (std::size_t user = 0; user < unsound.size(); ++user) {
    threads.emplace_back([&, user] {
      for (int round = 0; round < 3; ++round) {
        const auto session = testing::makeSession(navmesh, in(space));
        for (const testing::TimedHead& head : testing::wander(user + 1, 300)) {
          if (!testing::isFinite(testing::frame(session, head))) ++unsound[user];
        }
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_THAT(unsound, ::testing::Each(0));
}

TEST(CapiSpace, SaysWhatCannotWork) {
  forewalk_space_settings settings;
  forewalk_space_settings_init(&settings, sizeof settings);
  forewalk_space* space = nullptr;
  EXPECT_EQ(forewalk_space_create(&settings, nullptr), FOREWALK_ERROR_ARGUMENT);
  settings.body_radius = -1.0f;
  EXPECT_EQ(forewalk_space_create(&settings, &space), FOREWALK_ERROR_SETTING_OUT_OF_RANGE);
  EXPECT_THAT(forewalk_last_error(), HasSubstr("body_radius of -1"));
  forewalk_space_settings_init(&settings, sizeof settings);
  settings.user_limit = 65;
  EXPECT_EQ(forewalk_space_create(&settings, &space), FOREWALK_ERROR_SETTING_OUT_OF_RANGE);
  EXPECT_THAT(forewalk_last_error(), HasSubstr("user_limit of 65"));
  forewalk_space_settings_init(&settings, sizeof settings);
  settings.axes = 3;
  EXPECT_EQ(forewalk_space_create(&settings, &space), FOREWALK_ERROR_ARGUMENT);
  settings.struct_size = 3;
  EXPECT_EQ(forewalk_space_create(&settings, &space), FOREWALK_ERROR_ARGUMENT);
  EXPECT_THAT(forewalk_last_error(), HasSubstr("forewalk_space_settings_init"));
  EXPECT_EQ(space, nullptr);

  const auto navmesh = testing::makeNavMesh(plain());
  const SpaceHandle sound = makeSpace(5.0f, 5.0f);
  forewalk_session_settings both = in(sound);
  both.width = 5.0f;
  forewalk_session* session = nullptr;
  EXPECT_EQ(forewalk_session_create(navmesh.get(), &both, &session), FOREWALK_ERROR_ARGUMENT);
  EXPECT_THAT(forewalk_last_error(), HasSubstr("Give one of the two"));
}

}  // namespace
}  // namespace forewalk
