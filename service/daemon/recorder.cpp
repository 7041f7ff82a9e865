#include "service/daemon/recorder.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <utility>

namespace forewalk::daemon {

struct RecordingFile {
  RecordingFile(int opened, std::string path) : descriptor(opened), name(std::move(path)) {}
  RecordingFile(const RecordingFile&) = delete;
  RecordingFile& operator=(const RecordingFile&) = delete;
  ~RecordingFile() { ::close(descriptor); }

  int descriptor;
  std::string name;
  bool failed = false;  // the recorder's thread alone
};

tl::expected<std::unique_ptr<Recorder>, Error> Recorder::make(const std::filesystem::path& folder) {
  std::error_code failure;
  std::filesystem::create_directories(folder, failure);
  if (failure || ::access(folder.c_str(), W_OK | X_OK) != 0) {
    const std::string reason = failure ? failure.message() : std::strerror(errno);
    return tl::unexpected(Error{ErrorCode::kFileUnwritable,
                                fmt::format("--record {}: cannot be written to: {}. Give another "
                                            "folder.",
                                            folder.string(), reason)});
  }
  return std::unique_ptr<Recorder>(new Recorder(folder));
}

Recorder::Recorder(std::filesystem::path folder)
    : folder_(std::move(folder)), thread_([this] { run(); }) {}

Recorder::~Recorder() {
  {
    const std::lock_guard lock(mutex_);
    stop_ = true;
  }
  came_.notify_one();
  thread_.join();
}

tl::expected<std::shared_ptr<RecordingFile>, Error> Recorder::open(std::string_view sessionId) {
  constexpr int kMost = 100000;  // a session that resumes so often is a fault elsewhere
  for (int n = 0; n < kMost; ++n) {
    const std::string name = (folder_ / fmt::format("{}-{}.jsonl", sessionId, n)).string();
    // Poses of people: for the owner's eyes.
    const int opened =
        ::open(name.c_str(), O_WRONLY | O_APPEND | O_CREAT | O_EXCL | O_CLOEXEC, 0600);
    if (opened >= 0) return std::make_shared<RecordingFile>(opened, name);
    if (errno != EEXIST) {
      ++failures_;
      return tl::unexpected(
          Error{ErrorCode::kFileUnwritable,
                fmt::format("{}: cannot be made: {}.", name, std::strerror(errno))});
    }
  }
  ++failures_;
  return tl::unexpected(
      Error{ErrorCode::kTooLarge, fmt::format("{}: more than {} recordings of session {}.",
                                              folder_.string(), kMost, sessionId)});
}

void Recorder::write(std::shared_ptr<RecordingFile> file, std::string lines) {
  {
    const std::lock_guard lock(mutex_);
    pending_.push_back({std::move(file), std::move(lines)});
  }
  came_.notify_one();
}

void Recorder::run() {
  std::vector<Piece> taken;
  std::unique_lock lock(mutex_);
  while (true) {
    came_.wait(lock, [this] { return stop_ || !pending_.empty(); });
    if (pending_.empty()) return;
    std::swap(taken, pending_);
    lock.unlock();
    for (const Piece& piece : taken) writeNow(piece);
    taken.clear();
    lock.lock();
  }
}

void Recorder::writeNow(const Piece& piece) {
  RecordingFile& file = *piece.file;
  std::string_view left = piece.lines;
  while (!left.empty() && !file.failed) {
    const ssize_t written = ::write(file.descriptor, left.data(), left.size());
    if (written >= 0) {
      left.remove_prefix(static_cast<std::size_t>(written));
      bytes_ += static_cast<std::uint64_t>(written);
    } else if (errno != EINTR) {
      file.failed = true;
      ++failures_;
      spdlog::error("recording {} ends early: {}", file.name, std::strerror(errno));
    }
  }
}

}  // namespace forewalk::daemon
