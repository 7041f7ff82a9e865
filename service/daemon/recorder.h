// A thread that writes recordings (recording_format.h) of sessions, a file each, for the daemon.
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <thread>
#include <tl/expected.hpp>
#include <vector>

#include "navmesh/error.h"

namespace forewalk::daemon {

/// How often the daemon's threads hand over what their sessions have to record, seconds.
inline constexpr double kRecordEverySeconds = 0.05;

/// A recording that is being written. The last owner closes it.
struct RecordingFile;

class Recorder {
 public:
  /// Into `folder`, which is made. Fails (kFileUnwritable) where it cannot be written to.
  [[nodiscard]] static tl::expected<std::unique_ptr<Recorder>, Error> make(
      const std::filesystem::path& folder);
  Recorder(const Recorder&) = delete;
  Recorder& operator=(const Recorder&) = delete;
  ~Recorder();  ///< writes what it was given, and ends its thread

  /// A new file, FOLDER/SESSION-N.jsonl, whatever others write there. Any thread; opens a file.
  /// Fails (kFileUnwritable) with the system's reason.
  [[nodiscard]] tl::expected<std::shared_ptr<RecordingFile>, Error> open(
      std::string_view sessionId);

  /// Takes lines over, to be written soon. Any thread; does not wait for the disk. Lines of a file
  /// that failed are dropped.
  void write(std::shared_ptr<RecordingFile> file, std::string lines);

  std::uint64_t bytes() const { return bytes_; }        ///< written so far
  std::uint64_t failures() const { return failures_; }  ///< files that could not go on

 private:
  struct Piece {
    std::shared_ptr<RecordingFile> file;
    std::string lines;
  };
  explicit Recorder(std::filesystem::path folder);
  void run();
  void writeNow(const Piece& piece);

  std::filesystem::path folder_;
  std::atomic<std::uint64_t> bytes_{0}, failures_{0};
  std::mutex mutex_;
  std::condition_variable came_;
  std::vector<Piece> pending_;
  bool stop_ = false;
  std::thread thread_;  // last, so that it finds all the others
};

}  // namespace forewalk::daemon
