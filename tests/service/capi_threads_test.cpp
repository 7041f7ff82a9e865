// Many users on one navmesh, each on a thread of its own.
#include <gtest/gtest.h>

#include <atomic>
#include <cstring>
#include <string>
#include <thread>
#include <vector>

#include "tests/service/capi_support.h"

namespace forewalk::capi {
namespace {

struct Result {
  std::vector<forewalk_pose> poses;
  std::uint32_t points = 0;
};

Result walk(forewalk_navmesh* navmesh, std::uint64_t seed, int frames) {
  forewalk_session_settings settings = testing::defaultSettings();
  settings.has_start = 1;
  settings.start_floor = {3.0f, 0.0f, 2.0f};
  settings.controller = static_cast<forewalk_controller>(seed % 5);
  forewalk_session* made = nullptr;
  Result result;
  if (forewalk_session_create(navmesh, &settings, &made) != FOREWALK_OK) return result;
  const testing::SessionHandle session(made);
  forewalk_graph_view view{};
  view.struct_size = sizeof view;
  for (const testing::TimedHead& head : testing::wander(seed, frames)) {
    result.poses.push_back(testing::frame(session, head).virtual_pose);
    if (result.poses.size() % 50 == 0 && forewalk_graph(session.get(), &view) == FOREWALK_OK) {
      result.points += view.point_count;
    }
  }
  return result;
}

TEST(CapiSessions, OnManyThreadsShareANavMesh) {
  constexpr int kUsers = 12;
  constexpr int kFrames = 600;
  testing::NavMeshHandle navmesh = testing::makeNavMesh(testing::twoStoreys());
  std::vector<Result> alone;
  for (int user = 0; user < kUsers; ++user) {
    alone.push_back(walk(navmesh.get(), static_cast<std::uint64_t>(user), kFrames));
    ASSERT_EQ(alone.back().poses.size(), static_cast<std::size_t>(kFrames));
  }
  std::vector<Result> together(kUsers);
  std::vector<std::thread> threads;
  for (int user = 0; user < kUsers; ++user) {
    forewalk_navmesh_retain(navmesh.get());
    threads.emplace_back([&, user, shared = navmesh.get()] {
      together[static_cast<std::size_t>(user)] =
          walk(shared, static_cast<std::uint64_t>(user), kFrames);
      forewalk_navmesh_release(shared);
    });
  }
  navmesh.reset();  // the last thread ends it
  for (std::thread& thread : threads) thread.join();
  for (std::size_t user = 0; user < kUsers; ++user) {
    ASSERT_EQ(together[user].poses.size(), alone[user].poses.size());
    EXPECT_EQ(std::memcmp(together[user].poses.data(), alone[user].poses.data(),
                          alone[user].poses.size() * sizeof(forewalk_pose)),
              0)
        << "user " << user;
    EXPECT_EQ(together[user].points, alone[user].points);
  }
}

TEST(CapiLastError, BelongsToItsThread) {
  EXPECT_EQ(forewalk_navmesh_save(nullptr, nullptr, nullptr), FOREWALK_ERROR_ARGUMENT);
  const std::string mine = forewalk_last_error();
  std::atomic<int> wrong{0};
  std::vector<std::thread> threads;
  for (int i = 0; i < 8; ++i) {
    threads.emplace_back([&wrong, i] {
      if (*forewalk_last_error() != '\0') ++wrong;  // nothing has failed here yet
      const std::string name = "no-such-file-" + std::to_string(i) + ".obj";
      forewalk_navmesh* navmesh = nullptr;
      for (int round = 0; round < 20; ++round) {
        forewalk_navmesh_from_file(name.c_str(), nullptr, &navmesh);
        if (std::string(forewalk_last_error()).find(name) == std::string::npos) ++wrong;
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(wrong, 0);
  EXPECT_EQ(forewalk_last_error(), mine);
}

}  // namespace
}  // namespace forewalk::capi
