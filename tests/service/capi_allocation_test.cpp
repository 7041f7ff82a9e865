// What a frame does not do: allocate, take a lock, or call the system.
#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <string>

#include "tests/service/capi_support.h"

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define FOREWALK_SANITIZED 1
// Of <sanitizer/allocator_interface.h>, which GCC does not bring along.
extern "C" int __sanitizer_install_malloc_and_free_hooks(void (*onMalloc)(const volatile void*,
                                                                          std::size_t),
                                                         void (*onFree)(const volatile void*));
#else
#define FOREWALK_SANITIZED 0
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstddef>
#include <iterator>
#endif

namespace {
std::atomic<std::uint64_t> allocations{0};
}  // namespace

// Counted below operator new, so that the library's own allocations count, whichever way it makes
// them.
#if FOREWALK_SANITIZED
namespace {
const bool hooked = [] {
  __sanitizer_install_malloc_and_free_hooks(
      [](const volatile void*, std::size_t) { ++allocations; }, [](const volatile void*) {});
  return true;
}();
}  // namespace
#else
extern "C" {
void* __libc_malloc(std::size_t size);
void* __libc_calloc(std::size_t count, std::size_t size);
void* __libc_realloc(void* memory, std::size_t size);
void* __libc_memalign(std::size_t alignment, std::size_t size);

void* malloc(std::size_t size) noexcept {
  ++allocations;
  return __libc_malloc(size);
}
void* calloc(std::size_t count, std::size_t size) noexcept {
  ++allocations;
  return __libc_calloc(count, size);
}
void* realloc(void* memory, std::size_t size) noexcept {
  ++allocations;
  return __libc_realloc(memory, size);
}
void* aligned_alloc(std::size_t alignment, std::size_t size) noexcept {
  ++allocations;
  return __libc_memalign(alignment, size);
}
void* memalign(std::size_t alignment, std::size_t size) noexcept {
  ++allocations;
  return __libc_memalign(alignment, size);
}
int posix_memalign(void** memory, std::size_t alignment, std::size_t size) noexcept {
  ++allocations;
  *memory = __libc_memalign(alignment, size);
  return *memory == nullptr ? 12 : 0;
}
}
#endif

namespace forewalk::capi {
namespace {

std::uint64_t allocationsSince() { return allocations.exchange(0); }

testing::NavMeshHandle loaded(const char* path) {
  forewalk_navmesh* navmesh = nullptr;
  EXPECT_EQ(forewalk_navmesh_from_file(path, nullptr, &navmesh), FOREWALK_OK)
      << forewalk_last_error();
  return testing::NavMeshHandle(navmesh);
}

struct Walk {
  testing::NavMeshHandle navmesh = testing::makeNavMesh(testing::twoStoreys());
  testing::SessionHandle session;
  std::vector<testing::TimedHead> heads = testing::wander(4, 6000);

  explicit Walk(forewalk_controller controller, forewalk_method method = FOREWALK_METHOD_POLYGON,
                std::int32_t resets = 1) {
    forewalk_session_settings settings = testing::defaultSettings();
    settings.controller = controller;
    settings.method = method;
    settings.resets = resets;
    settings.horizon = 30.0f;
    settings.has_start = 1;
    settings.start_floor = {3.0f, 0.0f, 2.0f};
    session = testing::makeSession(navmesh, settings);
  }

  // Plain calls, nothing of the test's own. The sum keeps the frames from being left out.
  float frames(std::size_t from, std::size_t to) const {
    float sum = 0.0f;
    forewalk_frame_out out{};
    out.struct_size = sizeof out;
    forewalk_graph_view view{};
    view.struct_size = sizeof view;
    for (std::size_t i = from; i < to; ++i) {
      const auto& [p, q] = heads[i].pose;
      forewalk_frame(session.get(), {p.x, p.y, p.z}, {q.x, q.y, q.z, q.w}, heads[i].seconds, &out);
      forewalk_graph(session.get(), &view);
      sum += out.virtual_pose.position.x + static_cast<float>(view.point_count);
    }
    return sum;
  }
};

TEST(CapiFrame, AllocatesNothingFromTheFirstOn) {
  for (forewalk_controller controller = FOREWALK_CONTROLLER_NONE;
       controller <= FOREWALK_CONTROLLER_S2O_PREDICTIVE; ++controller) {
    const Walk walk(controller);
    EXPECT_GT(allocationsSince(), 10u) << "what the library allocates is not seen";
    const float sum = walk.frames(0, walk.heads.size());
    EXPECT_EQ(allocationsSince(), 0u) << controller;
    EXPECT_TRUE(std::isfinite(sum));
  }
}

// Graphs by fronts have no bound that is known beforehand: buffers grow to the largest seen.
TEST(CapiFrame, AllocatesNothingByFrontsWhereItHasBeen) {
  Walk walk(FOREWALK_CONTROLLER_NONE, FOREWALK_METHOD_FRONT, 0);
  float sum = walk.frames(0, walk.heads.size());
  ASSERT_EQ(forewalk_session_teleport(walk.session.get(), {3.0f, 0.0f, 2.0f}, 0.0f), FOREWALK_OK);
  const double later = walk.heads.back().seconds + 0.02;
  for (testing::TimedHead& head : walk.heads) head.seconds += later;
  allocationsSince();
  sum += walk.frames(0, walk.heads.size());
  EXPECT_EQ(allocationsSince(), 0u);
  EXPECT_TRUE(std::isfinite(sum));
}

TEST(CapiFrame, AllocatesNothingToComplain) {
  const Walk walk(FOREWALK_CONTROLLER_S2C);
  walk.frames(0, 1);
  forewalk_frame_out out{};
  out.struct_size = sizeof out;
  forewalk_frame_out unset{};
  const float nan = std::nanf("");
  allocationsSince();
  forewalk_frame(nullptr, {}, {}, 0.0, &out);
  forewalk_frame(walk.session.get(), {}, {}, 0.0, nullptr);
  forewalk_frame(walk.session.get(), {}, {}, 0.0, &unset);
  forewalk_frame(walk.session.get(), {nan, nan, nan}, {nan, nan, nan, nan},
                 static_cast<double>(nan), &out);
  forewalk_frame(walk.session.get(), {}, {0, 0, 0, 0}, -1e300, &out);
  forewalk_last_error();
  EXPECT_EQ(allocationsSince(), 0u);
}

// Walks along `waypoints` (x and z of the floor) and back, the room laid over the building, and
// asks for the graph in every frame. The memory must be what the session was made with.
void walkAndLook(const testing::NavMeshHandle& navmesh, std::vector<glm::vec2> waypoints,
                 float horizon) {
  forewalk_session_settings settings = testing::defaultSettings();
  settings.controller = FOREWALK_CONTROLLER_NONE;
  settings.horizon = horizon;
  settings.resets = 0;
  const testing::SessionHandle session = testing::makeSession(navmesh, settings);
  for (std::size_t i = waypoints.size(); i-- > 0;) waypoints.push_back(waypoints[i]);
  forewalk_frame_out out{};
  out.struct_size = sizeof out;
  forewalk_graph_view view{};
  view.struct_size = sizeof view;
  float lowest = 1e9f, highest = -1e9f;
  std::uint32_t mostPoints = 0, mostNodes = 0;
  int frames = 0;
  allocationsSince();
  for (std::size_t leg = 0; leg + 1 < waypoints.size(); ++leg) {
    const glm::vec2 walk = waypoints[leg + 1] - waypoints[leg];
    const int steps = static_cast<int>(glm::length(walk) / 0.05f) + 1;
    for (int step = 0; step < steps; ++step, ++frames) {
      const glm::vec2 at =
          waypoints[leg] + static_cast<float>(step) / static_cast<float>(steps) * walk;
      forewalk_frame(session.get(), {at.x, 1.7f, at.y}, {0, 0, 0, 1}, frames / 45.0, &out);
      forewalk_graph(session.get(), &view);
      lowest = std::min(lowest, out.virtual_pose.position.y);
      highest = std::max(highest, out.virtual_pose.position.y);
      mostNodes = std::max(mostNodes, view.node_count);
      mostPoints = std::max(mostPoints, view.point_count);
    }
  }
  EXPECT_EQ(allocationsSince(), 0u) << mostPoints << " points, " << mostNodes << " nodes at most";
  EXPECT_GT(highest - lowest, 1.5f) << "the user was to climb";
  EXPECT_GT(mostPoints, mostNodes);
}

TEST(CapiGraph, AllocatesNothingOnTheStairs) {
  const testing::NavMeshHandle blocks = testing::makeNavMesh(testing::twoStoreys());
  const testing::NavMeshHandle house = loaded(FOREWALK_ASSETS "/scenes/two_storey.obj");
  for (const float horizon : {3.0f, 8.0f, 40.0f}) {
    SCOPED_TRACE(horizon);
    walkAndLook(blocks, {{0.5f, 5.0f}, {13.0f, 5.0f}, {9.0f, 2.0f}}, horizon);
    walkAndLook(
        house,
        {{7.8f, 8.5f}, {7.18f, 5.0f}, {7.18f, 0.8f}, {8.53f, 0.8f}, {8.53f, 4.8f}, {10.3f, 5.5f}},
        horizon);
  }
}

// Ground whose height changes everywhere: paths over it have far more points than corners.
TEST(CapiGraph, AllocatesNothingOnRoughGround) {
  constexpr int kSide = 48;  // squares of half a metre
  testing::SceneArrays hills;
  for (int z = 0; z <= kSide; ++z) {
    for (int x = 0; x <= kSide; ++x) {
      const float right = 0.5f * static_cast<float>(x), near = 0.5f * static_cast<float>(z);
      hills.vertices.insert(
          hills.vertices.end(),
          {right, 0.5f * std::sin(1.1f * right) + 0.5f * std::cos(0.9f * near), near});
    }
  }
  for (std::uint32_t z = 0; z < kSide; ++z) {
    for (std::uint32_t x = 0; x < kSide; ++x) {
      const std::uint32_t corner = z * (kSide + 1) + x, across = corner + kSide + 1;
      hills.indices.insert(hills.indices.end(),
                           {corner, across, corner + 1, corner + 1, across, across + 1});
    }
  }
  const testing::NavMeshHandle navmesh = testing::makeNavMesh(hills);
  for (const float horizon : {3.0f, 8.0f, 40.0f}) {
    SCOPED_TRACE(horizon);
    walkAndLook(navmesh, {{2.0f, 2.0f}, {22.0f, 21.0f}, {3.0f, 20.0f}}, horizon);
  }
}

// Frames and graphs at random places within `low` to `high`, whatever the polygon limit.
void lookAround(const testing::NavMeshHandle& navmesh, glm::vec3 low, glm::vec3 high) {
  std::mt19937_64 rng(11);
  for (const std::uint32_t limit : {1u, 5u, 40u, 16384u}) {
    forewalk_session_settings settings = testing::defaultSettings();
    settings.controller = FOREWALK_CONTROLLER_NONE;
    settings.horizon = 60.0f;
    settings.polygon_limit = limit;
    const testing::SessionHandle session = testing::makeSession(navmesh, settings);
    forewalk_frame_out out{};
    out.struct_size = sizeof out;
    forewalk_graph_view view{};
    view.struct_size = sizeof view;
    int looks = 0;
    std::uint64_t allocated = 0;
    for (int i = 0; i < 20000 && looks < 300; ++i) {
      const auto between = [&](float a, float b) {
        return a + static_cast<float>(navmesh::uniform(rng)) * (b - a);
      };
      const forewalk_vec3 floor = {between(low.x, high.x), between(low.y, high.y),
                                   between(low.z, high.z)};
      if (forewalk_session_teleport(session.get(), floor, 0.0f) != FOREWALK_OK) continue;
      allocationsSince();
      forewalk_frame(session.get(), {0.0f, 1.7f, 0.0f}, {0, 0, 0, 1}, i, &out);
      forewalk_graph(session.get(), &view);
      allocated += allocationsSince();
      ++looks;
    }
    EXPECT_EQ(allocated, 0u) << "polygon limit " << limit;
    EXPECT_EQ(looks, 300);
  }
}

TEST(CapiGraph, AllocatesNothingAnywhereInTheBundledBuildings) {
  for (const char* scene : {"office", "museum", "two_storey", "maze"}) {
    SCOPED_TRACE(scene);
    lookAround(loaded((std::string(FOREWALK_ASSETS "/scenes/") + scene + ".obj").c_str()),
               {0.0f, 0.0f, 0.0f}, {40.0f, 3.5f, 40.0f});
  }
}

TEST(CapiGraph, AllocatesNothingAnywhereInRecastsTestScene) {
  const char* scene = FOREWALK_SHARED_DATA "/scenes/nav_test.obj";
  if (!std::filesystem::exists(scene)) GTEST_SKIP() << scene << " is not here";
  lookAround(loaded(scene), {-30.0f, -5.0f, -50.0f}, {65.0f, 20.0f, 30.0f});
}

#if !FOREWALK_SANITIZED
// The kernel ends the child at its first system call, but for the exit: nothing that blocks, waits
// for a contended lock, maps memory or starts a thread gets past it. Returns the exit status, 128
// plus the signal that ended it, or 3 where the kernel has no such mode.
int withoutSystemCalls(const std::function<void()>& body) {
  sock_filter exitOnly[] = {
      BPF_STMT(BPF_LD | BPF_W | BPF_ABS, offsetof(seccomp_data, nr)),
      BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, SYS_exit, 0, 1),
      BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ALLOW),
      BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_KILL_PROCESS),
  };
  const sock_fprog program{static_cast<unsigned short>(std::size(exitOnly)), exitOnly};
  const pid_t child = fork();
  if (child == 0) {
    if (prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) != 0 ||
        prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &program) != 0) {
      _exit(3);
    }
    body();
    syscall(SYS_exit, 0);
  }
  int status = 0;
  waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

TEST(CapiFrame, CallsNoSystem) {
  const int clock = withoutSystemCalls([] { (void)std::chrono::steady_clock::now(); });
  if (clock == 3) GTEST_SKIP() << "no seccomp filter is to be had here";
  if (clock != 0) GTEST_SKIP() << "reading the clock is a system call here";
  ASSERT_EQ(withoutSystemCalls([] { (void)getppid(); }), 128 + SIGSYS)
      << "calls get past the filter";
  for (const forewalk_controller controller :
       {FOREWALK_CONTROLLER_S2C, FOREWALK_CONTROLLER_S2O_PREDICTIVE}) {
    const Walk walk(controller);
    EXPECT_EQ(withoutSystemCalls([&] { walk.frames(0, walk.heads.size()); }), 0) << controller;
  }
}
#endif

}  // namespace
}  // namespace forewalk::capi
