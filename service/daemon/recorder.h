// Sessions as files that are only ever appended to, a line a frame, and a thread that writes them.
//
//   {"format":"forewalk.session/1","session":"…","scene":"…","navmesh":"…","settings":{…},"state":"…"}
//   {"in":{"sequence":0,"seconds":0.0,"position":[…],"orientation":[…]},"out":{…}}
//
// "in" and "out" are a frame and its answer as in PROTOCOL.md, without the token. Floats are the
// shortest text that reads back to the same float. "state" is null for a session that began here,
// else base64url of the state it went on from. Lines reach the system within 50 ms, so that a
// process that is killed loses no more (a machine that loses power may). A last line that is cut
// off is left out when it is read.
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
#include "service/daemon/message.h"

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

/// The first line of a recording, with its end.
std::string recordingHead(std::string_view sessionId, std::string_view scene,
                          std::string_view navMeshHash, std::string_view settingsText,
                          std::string_view state);

/// Appends a frame's line, with its end.
void appendRecordedFrame(const Frame& frame, const Answer& answer, std::string& out);

}  // namespace forewalk::daemon
