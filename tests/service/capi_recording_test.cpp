// Sessions recorded through the C interface, walked again by the daemon's replay.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <mutex>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include "service/daemon/replay.h"
#include "service/daemon/session_bytes.h"
#include "tests/service/capi_support.h"

namespace forewalk {
namespace {

using ::testing::HasSubstr;

navmesh::Scene scene() { return testing::twoStoreys(); }

/// What the library below walks a recording in.
struct Ground {
  navmesh::NavMesh navMesh = *navmesh::buildNavMesh(scene());
  std::shared_ptr<const navmesh::World> world = testing::makeWorld(scene());
  daemon::NavMeshHash hash = daemon::hashOf(navMesh);
};

std::string fileOf(const std::string& name) {
  return (std::filesystem::temp_directory_path() / ("forewalk_" + name + ".jsonl")).string();
}

std::string contentOf(const std::string& file) {
  std::ifstream in(file, std::ios::binary);
  std::stringstream text;
  text << in.rdbuf();
  return text.str();
}

/// Until the file has so many lines. The recording's thread writes every 50 ms and has room for 11
/// s of a real walk; tests walk faster.
void waitForLines(const std::string& file, std::ptrdiff_t lines) {
  const auto written = [&] {
    const std::string text = contentOf(file);
    return std::count(text.begin(), text.end(), '\n');
  };
  for (int i = 0; i < 1000 && written() < lines; ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  EXPECT_GE(written(), lines);
}

/// Of a whole recording. `frames` are those that a replay gets to.
void expectReplays(const Ground& ground, const std::string& file, std::size_t frames) {
  const auto replayed = daemon::replay(contentOf(file), ground.world, ground.hash);
  ASSERT_TRUE(replayed) << file << ": " << replayed.error().message;
  EXPECT_EQ(replayed->frames, frames);
  EXPECT_EQ(replayed->cutOff, 0u);
  EXPECT_FALSE(replayed->firstDifference) << file << " line " << *replayed->firstDifference << "\n"
                                          << replayed->recorded << "\n"
                                          << replayed->replayed;
}

forewalk_session_settings settingsOf(forewalk_controller controller, forewalk_reset reset) {
  forewalk_session_settings settings = testing::defaultSettings();
  settings.controller = controller;
  settings.reset = reset;
  settings.has_start = 1;
  settings.start_floor = {3.0f, 0.0f, 2.0f};
  settings.start_heading = 0.7f;
  return settings;
}

TEST(CapiRecording, IsWalkedAgainToTheLastBit) {
  const Ground ground;
  const auto navmesh = testing::makeNavMesh(scene());
  for (std::int32_t i = 0; i <= FOREWALK_CONTROLLER_FORCE; ++i) {
    const auto session =
        testing::makeSession(navmesh, settingsOf(i, i % (FOREWALK_RESET_AHEAD + 1)));
    const std::string file = fileOf("controller_" + std::to_string(i));
    const std::size_t begin = i % 2 == 0 ? 0 : 431;  // from the start, or switched on in between
    const auto heads = testing::wander(static_cast<std::uint64_t>(i) + 1, 1500);
    for (std::size_t frame = 0; frame < heads.size(); ++frame) {
      if (frame == begin) {
        ASSERT_EQ(forewalk_session_record(session.get(), file.c_str()), FOREWALK_OK)
            << forewalk_last_error();
      }
      testing::frame(session, heads[frame]);
      if (frame == begin + 800) waitForLines(file, 800);
    }
    ASSERT_EQ(forewalk_session_record(session.get(), nullptr), FOREWALK_OK);
    expectReplays(ground, file, heads.size() - std::max<std::size_t>(begin, 1));
    std::filesystem::remove(file);
  }
}

TEST(CapiRecording, HoldsWhatElseASessionWasTold) {
  const Ground ground;
  const auto navmesh = testing::makeNavMesh(scene());
  forewalk_space* made = nullptr;
  ASSERT_EQ(forewalk_space_create(nullptr, &made), FOREWALK_OK);
  const std::unique_ptr<forewalk_space, decltype(&forewalk_space_release)> space(
      made, &forewalk_space_release);
  forewalk_session_settings settings =
      settingsOf(FOREWALK_CONTROLLER_FORESIGHT, FOREWALK_RESET_R2G);
  settings.space = space.get();
  settings.heading_source = FOREWALK_HEADING_CHEST;
  settings.axes = FOREWALK_AXES_UNREAL;
  settings.start_floor = {-200.0f, 300.0f, 0.0f};  // centimetres: forward, right, up
  const auto session = testing::makeSession(navmesh, settings);
  forewalk_session_settings other = settingsOf(FOREWALK_CONTROLLER_S2C, FOREWALK_RESET_R2C);
  other.space = space.get();
  const auto company = testing::makeSession(navmesh, other);
  const std::string file = fileOf("told");
  ASSERT_EQ(forewalk_session_record(session.get(), file.c_str()), FOREWALK_OK);
  const auto heads = testing::wander(5, 2000), others = testing::wander(6, 2000);
  for (std::size_t frame = 0; frame < heads.size(); ++frame) {
    testing::frame(company, others[frame]);
    const float turn = 0.01f * static_cast<float>(frame);
    const forewalk_vec3 gaze{std::cos(turn), std::sin(turn), -0.2f}, chest{1.0f, 0.3f, 0.0f};
    forewalk_session_set_gaze(session.get(), frame % 500 < 300 ? &gaze : nullptr);
    forewalk_session_set_chest(session.get(), frame % 700 < 500 ? &chest : nullptr);
    if (frame == 900) {
      ASSERT_EQ(forewalk_session_teleport(session.get(), {-250.0f, 400.0f, 0.0f}, 1.1f),
                FOREWALK_OK)
          << forewalk_last_error();
    }
    forewalk_frame_out out{};
    out.struct_size = sizeof out;
    const auto& [p, q] = heads[frame].pose;
    // OpenXR's pose in Unreal's axes.
    forewalk_frame(session.get(), {-100.0f * p.z, 100.0f * p.x, 100.0f * p.y},
                   {q.z, -q.x, -q.y, q.w}, heads[frame].seconds, &out);
    if (frame % 800 == 799) waitForLines(file, static_cast<std::ptrdiff_t>(frame));
  }
  ASSERT_EQ(forewalk_session_record(session.get(), nullptr), FOREWALK_OK);
  const std::string text = contentOf(file);
  EXPECT_THAT(text, HasSubstr("\"others\":[["));
  EXPECT_THAT(text, HasSubstr("\"gaze\":["));
  EXPECT_THAT(text, HasSubstr("{\"teleport\":"));
  expectReplays(ground, file, heads.size() - 1);
  std::filesystem::remove(file);
}

TEST(CapiRecording, EndsWhereTheWorldChanges) {
  const Ground ground;
  const auto navmesh = testing::makeNavMesh(scene());
  const auto session =
      testing::makeSession(navmesh, settingsOf(FOREWALK_CONTROLLER_S2C, FOREWALK_RESET_R2C));
  const std::string file = fileOf("world");
  ASSERT_EQ(forewalk_session_record(session.get(), file.c_str()), FOREWALK_OK);
  const auto heads = testing::wander(5, 300);
  for (std::size_t frame = 0; frame < heads.size(); ++frame) {
    if (frame == 200) {
      ASSERT_EQ(forewalk_session_enter(session.get(), navmesh.get()), FOREWALK_OK);
    }
    testing::frame(session, heads[frame]);
  }
  forewalk_session_record(session.get(), nullptr);
  const auto replayed = daemon::replay(contentOf(file), ground.world, ground.hash);
  ASSERT_TRUE(replayed) << replayed.error().message;
  EXPECT_EQ(replayed->frames, 199u);
  EXPECT_EQ(replayed->worldChanged, 201u);  // line, after the head's
  // And what begins after it says so at once.
  ASSERT_EQ(forewalk_session_record(session.get(), file.c_str()), FOREWALK_OK);
  testing::frame(session, {heads.back().pose, heads.back().seconds + 0.01});
  forewalk_session_record(session.get(), nullptr);
  const auto moving = daemon::replay(contentOf(file), ground.world, ground.hash);
  ASSERT_FALSE(moving);
  EXPECT_THAT(moving.error().message, HasSubstr("world that moves"));
  std::filesystem::remove(file);
}

TEST(CapiRecording, IsThereSoonWhateverHappens) {
  const auto navmesh = testing::makeNavMesh(scene());
  auto session =
      testing::makeSession(navmesh, settingsOf(FOREWALK_CONTROLLER_NONE, FOREWALK_RESET_R2C));
  const std::string file = fileOf("soon");
  ASSERT_EQ(forewalk_session_record(session.get(), file.c_str()), FOREWALK_OK);
  for (const testing::TimedHead& head : testing::wander(5, 20)) testing::frame(session, head);
  waitForLines(file, 20);  // within 100 ms on a machine that has time; this one may be busy
  const auto lines = [&] {
    const std::string text = contentOf(file);
    return std::count(text.begin(), text.end(), '\n');
  };
  EXPECT_EQ(lines(), 20);  // the head, and all frames but the first
  session.reset();
  EXPECT_EQ(lines(), 20);
  std::filesystem::remove(file);
}

TEST(CapiRecording, EndsWhereTheDiskIsFull) {
  if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "there is no /dev/full here";
  std::vector<std::string> told;
  std::mutex telling;
  struct Ear {
    std::vector<std::string>& told;
    std::mutex& telling;
  } ear{told, telling};
  forewalk_set_log(
      [](void* user, forewalk_log_level, const char* message) {
        const auto& listens = *static_cast<Ear*>(user);
        const std::lock_guard lock(listens.telling);
        listens.told.emplace_back(message);
      },
      &ear, FOREWALK_LOG_WARNING);
  const auto navmesh = testing::makeNavMesh(scene());
  const auto session =
      testing::makeSession(navmesh, settingsOf(FOREWALK_CONTROLLER_NONE, FOREWALK_RESET_R2C));
  ASSERT_EQ(forewalk_session_record(session.get(), "/dev/full"), FOREWALK_OK);
  const auto heads = testing::wander(5, 4000);
  const auto times = [&](const std::string& part) {
    const std::lock_guard lock(telling);
    return std::count_if(told.begin(), told.end(), [&](const std::string& line) {
      return line.find(part) != std::string::npos;
    });
  };
  for (std::size_t frame = 0; frame < heads.size(); ++frame) {
    EXPECT_TRUE(testing::isFinite(testing::frame(session, heads[frame])));
    if (frame == 10) {
      for (int i = 0; i < 1000 && times("could not be written") == 0; ++i)
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
  }
  forewalk_session_record(session.get(), nullptr);
  EXPECT_EQ(times("/dev/full could not be written: No space left on device."), 1);
  EXPECT_EQ(times("its recording ends"), 1);
  forewalk_set_log(nullptr, nullptr, FOREWALK_LOG_OFF);
}

TEST(CapiRecording, SaysWhereItCannotWrite) {
  const auto navmesh = testing::makeNavMesh(scene());
  const auto session =
      testing::makeSession(navmesh, settingsOf(FOREWALK_CONTROLLER_NONE, FOREWALK_RESET_R2C));
  EXPECT_EQ(forewalk_session_record(session.get(), "/no-such-folder/a.jsonl"),
            FOREWALK_ERROR_FILE_UNWRITABLE);
  EXPECT_THAT(forewalk_last_error(), HasSubstr("/no-such-folder/a.jsonl: cannot be written"));
  EXPECT_EQ(forewalk_session_record(nullptr, nullptr), FOREWALK_ERROR_ARGUMENT);
  EXPECT_EQ(forewalk_session_record(session.get(), nullptr), FOREWALK_OK);  // none: nothing to end
}

}  // namespace
}  // namespace forewalk
