#include "service/daemon/metrics.h"

#include <fmt/format.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <iterator>
#include <memory>

namespace forewalk::daemon {
namespace {

constexpr std::string_view kNames[] = {"message",
                                       "token",
                                       "settings",
                                       "access",
                                       "origin",
                                       "request",
                                       "limit.message_bytes",
                                       "limit.messages_per_second",
                                       "limit.sessions",
                                       "limit.connections",
                                       "limit.idle_seconds",
                                       "limit.handshake_seconds",
                                       "limit.send_seconds",
                                       "draining",
                                       "internal"};
static_assert(std::size(kNames) == static_cast<std::size_t>(Refusal::kCount));

/// Bytes of memory that the process has in use; 0 where the system does not say.
std::uint64_t residentBytes() {
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen("/proc/self/statm", "r"),
                                                             &std::fclose);
  unsigned long long size = 0, resident = 0;
  if (!file || std::fscanf(file.get(), "%llu %llu", &size, &resident) != 2) return 0;
  return resident * static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE));
}

class MetricsText {
 public:
  void family(std::string_view name, std::string_view kind, std::string_view help) {
    fmt::format_to(at_, "# HELP {0} {2}\n# TYPE {0} {1}\n", name, kind, help);
  }
  template <typename Number>
  void sample(std::string_view name, std::string_view labels, Number value) {
    fmt::format_to(at_, "{}{} {}\n", name, labels, value);
  }
  template <typename Number>
  void one(std::string_view name, std::string_view kind, std::string_view help, Number value) {
    family(name, kind, help);
    sample(name, "", value);
  }
  std::string text() && { return std::move(text_); }

 private:
  std::string text_;
  std::back_insert_iterator<std::string> at_{text_};
};

}  // namespace

double processorSeconds() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  const auto seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

std::string_view nameOf(Refusal refusal) { return kNames[static_cast<std::size_t>(refusal)]; }

void Counters::frame(std::uint64_t nanoseconds) {
  frames.add();
  frameNanoseconds.add(nanoseconds);
  const double seconds = 1e-9 * static_cast<double>(nanoseconds);
  const auto bin = std::lower_bound(kLatencyBins.begin(), kLatencyBins.end(), seconds);
  latency[static_cast<std::size_t>(bin - kLatencyBins.begin())].add();
}

std::string metricsText(std::span<const Counters* const> threads, const DaemonFacts& facts) {
  const auto sum = [&](auto counter) {
    std::uint64_t total = 0;
    for (const Counters* counters : threads) total += counter(*counters).value();
    return total;
  };
  const auto begun = sum([](const Counters& c) -> const Counter& { return c.sessionsBegun; });
  const auto ended = sum([](const Counters& c) -> const Counter& { return c.sessionsEnded; });
  MetricsText page;
  page.family("forewalk_build_info", "gauge", "Version, and hash of the navmesh.");
  page.sample("forewalk_build_info",
              fmt::format(R"({{version="{}",navmesh="{}"}})", facts.version, facts.navMesh), 1);
  page.one("forewalk_sessions", "gauge", "Sessions that walk now.", begun - std::min(begun, ended));
  page.one("forewalk_sessions_begun_total", "counter", "Sessions that began, resumed ones too.",
           begun);
  page.one("forewalk_sessions_resumed_total", "counter", "Sessions that went on from a token.",
           sum([](const Counters& c) -> const Counter& { return c.sessionsResumed; }));
  page.one("forewalk_connections", "gauge", "Connections open now.", facts.connections);
  page.one("forewalk_threads", "gauge", "Threads that run sessions.", threads.size());
  page.one("forewalk_draining", "gauge", "1 after SIGTERM.", facts.draining ? 1 : 0);

  const std::string_view seconds = "forewalk_frame_seconds";
  page.family(seconds, "histogram", "From a frame's last byte to its answer handed to the system.");
  std::uint64_t upTo = 0;
  for (std::size_t bin = 0; bin < kLatencyBins.size() + 1; ++bin) {
    upTo += sum([bin](const Counters& c) -> const Counter& { return c.latency[bin]; });
    page.sample("forewalk_frame_seconds_bucket",
                bin < kLatencyBins.size() ? fmt::format(R"({{le="{}"}})", kLatencyBins[bin])
                                          : std::string(R"({le="+Inf"})"),
                upTo);
  }
  const auto nanoseconds =
      sum([](const Counters& c) -> const Counter& { return c.frameNanoseconds; });
  page.sample("forewalk_frame_seconds_sum", "", 1e-9 * static_cast<double>(nanoseconds));
  page.sample("forewalk_frame_seconds_count", "", upTo);
  page.one("forewalk_frames_total", "counter", "Frames answered.", upTo);

  page.family("forewalk_refused_total", "counter", "Clients refused or let go, by error code.");
  for (std::size_t i = 0; i < std::size(kNames); ++i) {
    page.sample("forewalk_refused_total", fmt::format(R"({{code="{}"}})", kNames[i]),
                sum([i](const Counters& c) -> const Counter& { return c.refused[i]; }));
  }
  page.one("forewalk_recording_bytes_total", "counter", "Written to recordings.",
           facts.recordingBytes);
  page.one("forewalk_recording_failures_total", "counter", "Recordings that could not go on.",
           facts.recordingFailures);
  page.one("process_cpu_seconds_total", "counter", "Processor time used.", processorSeconds());
  page.one("process_resident_memory_bytes", "gauge", "Memory in use.", residentBytes());
  return std::move(page).text();
}

}  // namespace forewalk::daemon
