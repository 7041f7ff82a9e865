#include "service/capi/session_recording.h"

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <span>
#include <utility>

#include "service/capi/log.h"
#include "service/capi/status.h"
#include "service/daemon/recording_format.h"
#include "service/daemon/session_bytes.h"

namespace forewalk::capi {

namespace {

// A process that is killed loses no more.
constexpr std::chrono::milliseconds kWriteEvery{50};

}  // namespace

tl::expected<std::unique_ptr<SessionRecording>, Error> SessionRecording::make(
    const std::filesystem::path& file, std::string scene, std::string settings,
    std::uint32_t session) {
  std::FILE* opened = std::fopen(file.string().c_str(), "wb");
  if (opened == nullptr) {
    return tl::unexpected(Error{ErrorCode::kFileUnwritable,
                                file.string() + ": cannot be written: " + std::strerror(errno) +
                                    ". Give a file in a folder that is there."});
  }
  std::unique_ptr<SessionRecording> made(new SessionRecording(opened, file.string()));
  made->scene_ = std::move(scene);
  made->settings_ = std::move(settings);
  made->session_ = session;
  return made;
}

SessionRecording::SessionRecording(std::FILE* file, std::string name)
    : file_(file), name_(std::move(name)), ring_(kRoom), thread_([this] { run(); }) {}

SessionRecording::~SessionRecording() {
  {
    const std::lock_guard lock(mutex_);
    stop_ = true;
  }
  ends_.notify_one();
  thread_.join();
  std::fclose(file_);
}

void SessionRecording::begin(forewalk_session& session) {
  const rdw::SessionState state = session.session.state();
  if (!session.session.resume(state)) return giveUp();
  daemon::NavMeshHash ground;
  for (std::size_t i = 0; i < ground.size(); ++i) {
    ground[i] = static_cast<std::uint8_t>(session.groundHash >> (8 * (ground.size() - 1 - i)));
  }
  std::string head = daemon::recordingHead(
      std::to_string(session_), scene_,
      session.groundHash == 0 ? std::string(daemon::kMovingWorld) : daemon::textOf(ground),
      settings_, daemon::stateBytes({session.number, state}, ground));
  const std::lock_guard lock(mutex_);
  head_ = std::move(head);
  phase_ = Phase::kRunning;
}

void SessionRecording::giveUp() {
  phase_ = Phase::kOver;
  tell(FOREWALK_LOG_WARNING,
       "session {}: its recording ends: the disk has failed or did not keep up with the frames.",
       session_);
}

SessionRecording::Entry* SessionRecording::next() {
  if (phase_ != Phase::kRunning) return nullptr;
  const std::size_t written = written_.load(std::memory_order_relaxed);
  if (failed_.load(std::memory_order_relaxed) ||
      written - read_.load(std::memory_order_acquire) == kRoom) {
    giveUp();
    return nullptr;
  }
  return &ring_[written % kRoom];
}

void SessionRecording::advance() {
  written_.store(written_.load(std::memory_order_relaxed) + 1, std::memory_order_release);
}

void SessionRecording::frame(forewalk_session& session, const rdw::HeadPose& head, double seconds) {
  if (phase_ == Phase::kWaiting) return begin(session);
  Entry* entry = next();
  if (entry == nullptr) return;
  entry->kind = Entry::Kind::kFrame;
  entry->head = head;
  entry->seconds = seconds;
  entry->gaze = session.gaze;
  entry->chest = session.chest;
  const std::span<const rdw::OtherUser> others = session.session.others();
  entry->otherCount = others.size();
  std::copy(others.begin(), others.end(), entry->others.begin());
  entry->answer = daemon::answerOf(sequence_++, session.session.result());
  advance();
}

void SessionRecording::teleport(const rdw::VirtualStart& to) {
  Entry* entry = next();
  if (entry == nullptr) return;
  entry->kind = Entry::Kind::kTeleport;
  entry->teleport = to;
  advance();
}

void SessionRecording::worldChange() {
  Entry* entry = next();
  if (entry == nullptr) return;
  entry->kind = Entry::Kind::kWorldChange;
  advance();
}

void SessionRecording::drain(std::string& text) {
  daemon::Frame frame;
  const std::size_t written = written_.load(std::memory_order_acquire);
  for (std::size_t at = read_.load(std::memory_order_relaxed); at != written; ++at) {
    const Entry& entry = ring_[at % kRoom];
    switch (entry.kind) {
      case Entry::Kind::kFrame:
        frame.sequence = entry.answer.sequence;
        frame.seconds = entry.seconds;
        frame.head = entry.head;
        frame.gaze = entry.gaze;
        frame.chest = entry.chest;
        frame.others.assign(entry.others.begin(),
                            entry.others.begin() + static_cast<std::ptrdiff_t>(entry.otherCount));
        daemon::appendRecordedFrame(frame, entry.answer, text);
        break;
      case Entry::Kind::kTeleport:
        daemon::appendRecordedTeleport(entry.teleport, text);
        break;
      case Entry::Kind::kWorldChange:
        daemon::appendRecordedWorldChange(text);
        break;
    }
    read_.store(at + 1, std::memory_order_release);
  }
}

void SessionRecording::write(const std::string& text) {
  if (text.empty() || failed_) return;
  if (std::fwrite(text.data(), 1, text.size(), file_) == text.size() && std::fflush(file_) == 0) {
    return;
  }
  failed_ = true;
  tell(FOREWALK_LOG_WARNING, "session {}: {} could not be written: {}.", session_, name_,
       std::strerror(errno));
}

void SessionRecording::run() {
  std::string text;
  std::unique_lock lock(mutex_);
  while (true) {
    const bool ends = ends_.wait_for(lock, kWriteEvery, [this] { return stop_; });
    text = std::exchange(head_, {});
    lock.unlock();
    drain(text);
    write(text);
    lock.lock();
    if (ends) return;
  }
}

}  // namespace forewalk::capi

using namespace forewalk;
using namespace forewalk::capi;

extern "C" forewalk_status forewalk_session_record(forewalk_session* session, const char* path) {
  if (session == nullptr) {
    return failLiteral(FOREWALK_ERROR_ARGUMENT, "forewalk_session_record: session is null.");
  }
  return guarded([&]() -> forewalk_status {
    session->recorder.reset();
    if (path == nullptr) return FOREWALK_OK;
    const std::u8string name(path, path + std::strlen(path));
    auto recording =
        SessionRecording::make(std::filesystem::path(name), session->scene,
                               daemon::settingsText(session->session.settings()), session->number);
    if (!recording) return fail(recording.error());
    if (session->framed) (*recording)->begin(*session);
    session->recorder = std::move(*recording);
    return FOREWALK_OK;
  });
}
