// A session's frames on their way to a file: forewalk_session_record.
//
// The frame puts what it was told and answered into a ring and goes on; a thread of the recording's
// own makes text of it and writes. Nothing of the frame allocates, locks or waits.
#pragma once

#include <array>
#include <atomic>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <tl/expected.hpp>
#include <vector>

#include "rdw/session.h"
#include "service/capi/session_handle.h"
#include "service/daemon/message.h"

namespace forewalk::capi {

class SessionRecording final : public FrameRecorder {
 public:
  /// Makes the file, in the place of one of that name, and starts the thread. Fails
  /// (kFileUnwritable) with the system's reason.
  [[nodiscard]] static tl::expected<std::unique_ptr<SessionRecording>, Error> make(
      const std::filesystem::path& file, std::string scene, std::string settings,
      std::uint32_t session);
  SessionRecording(const SessionRecording&) = delete;
  SessionRecording& operator=(const SessionRecording&) = delete;
  ~SessionRecording() override;  ///< writes what it was given

  enum class Phase : std::uint8_t {
    kWaiting,  ///< for the session's first frame
    kRunning,
    kOver  ///< the disk has failed, or not kept up
  };
  Phase phase() const { return phase_; }

  /// Goes on from the state that the session is in as every other would that resumes it, and
  /// records its frames from now on.
  void begin(forewalk_session& session);

  /// Begins where it waits; else puts the frame into the ring. Where the disk has not kept up for
  /// kRoom frames, or has failed, gives up, and the log hears of it. Wait-free, but for the
  /// beginning.
  void frame(forewalk_session& session, const rdw::HeadPose& head, double seconds) override;
  void teleport(const rdw::VirtualStart& to) override;
  void worldChange() override;

  static constexpr std::size_t kRoom = 1024;  ///< frames on their way, 11 s at 90 Hz

 private:
  struct Entry {
    enum class Kind : std::uint8_t { kFrame, kTeleport, kWorldChange } kind = Kind::kFrame;
    rdw::HeadPose head;
    double seconds = 0.0;
    std::optional<glm::vec3> gaze, chest;
    std::array<rdw::OtherUser, rdw::kMostOthers> others{};
    std::size_t otherCount = 0;
    daemon::Answer answer;
    rdw::VirtualStart teleport;
  };
  explicit SessionRecording(std::FILE* file, std::string name);
  void giveUp();
  Entry* next();  // to be filled in and handed over by advance(); null: given up
  void advance();
  void run();
  void drain(std::string& text);
  void write(const std::string& text);

  std::FILE* file_;
  std::string name_;
  std::string scene_, settings_;
  std::uint32_t session_ = 0;
  Phase phase_ = Phase::kWaiting;  // the session's thread alone
  std::uint32_t sequence_ = 0;
  std::vector<Entry> ring_;
  std::atomic<std::size_t> written_{0}, read_{0};  // entries, ever
  std::atomic<bool> failed_{false};
  std::mutex mutex_;
  std::condition_variable ends_;
  bool stop_ = false;
  std::string head_;    // the first line, for the thread
  std::thread thread_;  // last, so that it finds all the others
};

}  // namespace forewalk::capi
