// What the daemon counts: one set of counters a thread, summed up where somebody asks.
//
// A counter is written by its own thread alone, so that counting costs an addition and no lock.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace forewalk::daemon {

/// Upper ends of the latency histogram's bins, seconds; beyond the last: +Inf.
inline constexpr std::array<double, 14> kLatencyBins = {
    10e-6, 20e-6, 50e-6, 100e-6, 200e-6, 500e-6, 1e-3, 2e-3, 5e-3, 10e-3, 20e-3, 50e-3, 0.1, 1.0};

/// Why clients are refused or let go. The names are those of forewalk.error/1.
enum class Refusal : std::uint8_t {
  kMessage,       ///< `message`: not the schema
  kToken,         ///< `token`: of another key or navmesh, or damaged
  kSettings,      ///< `settings`: a session cannot be made of them
  kAccess,        ///< `access`: no or a wrong access token
  kOrigin,        ///< `origin`
  kRequest,       ///< `request`: not HTTP, or no such page
  kMessageBytes,  ///< and so on: limits.h
  kMessagesPerSecond,
  kSessions,
  kConnections,
  kIdle,
  kHandshake,
  kSend,
  kDraining,  ///< `draining`
  kInternal,  ///< `internal`
  kCount
};
std::string_view nameOf(Refusal refusal);

/// Processor time that this process has used, seconds.
double processorSeconds();

/// A number that one thread counts and others read.
class Counter {
 public:
  void add(std::uint64_t more = 1) {
    value_.store(value_.load(std::memory_order_relaxed) + more, std::memory_order_relaxed);
  }
  std::uint64_t value() const { return value_.load(std::memory_order_relaxed); }

 private:
  std::atomic<std::uint64_t> value_{0};
};

struct Counters {
  Counter sessionsBegun, sessionsResumed, sessionsEnded;
  Counter frames;
  Counter frameNanoseconds;  ///< their latencies summed up
  std::array<Counter, kLatencyBins.size() + 1> latency;
  std::array<Counter, static_cast<std::size_t>(Refusal::kCount)> refused;

  /// From the last byte of a frame until its answer was handed to the system.
  void frame(std::uint64_t nanoseconds);
  void refuse(Refusal refusal) { refused[static_cast<std::size_t>(refusal)].add(); }
};

/// What only the daemon as a whole knows.
struct DaemonFacts {
  std::string_view version;
  std::string_view navMesh;  ///< its hash
  std::uint64_t connections = 0;
  std::uint64_t recordingBytes = 0;
  std::uint64_t recordingFailures = 0;
  bool draining = false;
};

/// Prometheus' text format, version 0.0.4. Reads /proc/self for memory and processor time.
std::string metricsText(std::span<const Counters* const> threads, const DaemonFacts& facts);

}  // namespace forewalk::daemon
