// What a frame does not do: allocate, take a lock, or call the system.
#include <gtest/gtest.h>

#include <atomic>
#include <cstdlib>
#include <functional>

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

struct Walk {
  testing::NavMeshHandle navmesh = testing::makeNavMesh(testing::twoStoreys());
  testing::SessionHandle session;
  std::vector<testing::TimedHead> heads = testing::wander(4, 6000);

  explicit Walk(forewalk_controller controller) {
    forewalk_session_settings settings = testing::defaultSettings();
    settings.controller = controller;
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
    for (std::size_t i = from; i < to; ++i) {
      const auto& [p, q] = heads[i].pose;
      forewalk_frame(session.get(), {p.x, p.y, p.z}, {q.x, q.y, q.z, q.w}, heads[i].seconds, &out);
      sum += out.virtual_pose.position.x;
    }
    return sum;
  }
};

TEST(CapiFrame, AllocatesNothingAfterTheFirst) {
  for (forewalk_controller controller = FOREWALK_CONTROLLER_NONE;
       controller <= FOREWALK_CONTROLLER_S2O_PREDICTIVE; ++controller) {
    const Walk walk(controller);
    EXPECT_GT(allocationsSince(), 10u) << "what the library allocates is not seen";
    float sum = walk.frames(0, 1);
    allocationsSince();
    sum += walk.frames(1, walk.heads.size());
    EXPECT_EQ(allocationsSince(), 0u) << controller;
    EXPECT_TRUE(std::isfinite(sum));
  }
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

TEST(CapiGraph, AllocatesNothingOnLevelGround) {
  const Walk walk(FOREWALK_CONTROLLER_S2C_PREDICTIVE);
  walk.frames(0, 1);
  forewalk_graph_view view{};
  view.struct_size = sizeof view;
  forewalk_graph(walk.session.get(), &view);
  const std::uint32_t points = view.point_count;
  allocationsSince();
  forewalk_graph(walk.session.get(), &view);
  EXPECT_EQ(allocationsSince(), 0u);
  EXPECT_GT(points, 0u);
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
