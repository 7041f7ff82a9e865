// A connection once it is a WebSocket: hello, frames, farewell.
#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <boost/asio/buffer.hpp>
#include <boost/asio/post.hpp>
#include <boost/beast/core/error.hpp>
#include <boost/beast/websocket/error.hpp>
#include <cstring>
#include <utility>

#include "prediction/dump.h"
#include "service/daemon/connection.h"
#include "service/daemon/recording_format.h"

namespace forewalk::daemon {

namespace websocket = beast::websocket;

namespace {


websocket::close_code closeCodeOf(Refusal refusal) {
  switch (refusal) {
    case Refusal::kMessageBytes:
      return websocket::close_code::too_big;
    case Refusal::kMessage:
      return websocket::close_code::bad_payload;
    case Refusal::kIdle:
    case Refusal::kDraining:
      return websocket::close_code::going_away;
    case Refusal::kInternal:
      return websocket::close_code::internal_error;
    default:
      return websocket::close_code::policy_error;
  }
}

/// Frames first: a thread that prepares sessions gives way to those that walk.
void giveWay() {
  [[maybe_unused]] static thread_local const int once =
      ::setpriority(PRIO_PROCESS, static_cast<id_t>(::gettid()), 10);
}

std::string idText(std::uint64_t id) { return fmt::format("{:016x}", id); }

}  // namespace

/// What a hello became.
struct Connection::Loaded {
  std::optional<rdw::Session> session;
  std::uint64_t id = 0;
  bool resumed = false;
  std::shared_ptr<RecordingFile> recording;
  std::string head;  ///< of the recording
  Refusal refusal = Refusal::kCount;
  std::string message;
};

void Connection::read() {
  const std::size_t room = shared_.settings.limits.messageBytes + 1 - buffer_.size();
  webSocket_->async_read_some(
      buffer_, room, [self = shared_from_this()](const Failure& failure, std::size_t bytes) {
        if (self->phase_ == Phase::kClosing) {
          // What still comes is not looked at; the read only waits for the close.
          self->buffer_.clear();
          if (!failure) self->read();
          return;
        }
        if (failure) return self->lost(failure);
        self->onRead(bytes);
      });
}

void Connection::onRead(std::size_t bytes) {
  constexpr std::size_t kSmallPiece = 512;  // many of these are as costly as messages
  const Limits& limits = shared_.settings.limits;
  const bool done = webSocket_->is_message_done();
  frameAt_ = Clock::now();
  if ((done || bytes < kSmallPiece) && !admit()) {
    return refuse(Refusal::kMessagesPerSecond,
                  fmt::format("more than {:g} messages or pieces of one a second.",
                              limits.messagesPerSecond));
  }
  if (buffer_.size() > limits.messageBytes) {
    return refuse(Refusal::kMessageBytes,
                  fmt::format("a message of more than {} bytes.", limits.messageBytes));
  }
  if (!done) return read();
  const std::string_view message(static_cast<const char*>(buffer_.data().data()), buffer_.size());
  const bool isText = webSocket_->got_text();
  if (phase_ == Phase::kHello) {
    onHello(message, isText);
  } else {
    onFrame(message, isText);
  }
}

// A bucket that fills at the rate and holds a second's worth.
bool Connection::admit() {
  const double rate = shared_.settings.limits.messagesPerSecond;
  const Clock::time_point now = Clock::now();
  const std::chrono::duration<double> since = now - allowanceAt_;
  allowance_ = std::min(rate, allowance_ + rate * since.count());
  allowanceAt_ = now;
  if (allowance_ < 1.0) return false;
  allowance_ -= 1.0;
  return true;
}

void Connection::onHello(std::string_view text, bool isText) {
  if (!isText) {
    return refuse(Refusal::kMessage, "the first message has to be a hello, which is JSON text.");
  }
  phase_ = Phase::kLoading;
  // Rooms of many corners and predictive controllers take long to prepare: not on this thread,
  // where others walk.
  asio::post(*shared_.loading, [self = shared_from_this(), hello = std::string(text)]() mutable {
    giveWay();
    auto loaded = std::make_shared<Loaded>();
    try {
      *loaded = load(self->shared_, hello);
    } catch (const std::exception& failure) {
      loaded->refusal = Refusal::kInternal;
      loaded->message = failure.what();
    }
    Worker& worker = self->worker_;
    asio::post(worker.io, [self = std::move(self), loaded] { self->onLoaded(std::move(*loaded)); });
  });
  buffer_.clear();
}

Connection::Loaded Connection::load(Shared& shared, const std::string& hello) {
  Loaded loaded;
  const auto refused = [&](Refusal refusal, std::string message) {
    loaded.refusal = refusal;
    loaded.message = std::move(message);
    loaded.session.reset();
    return std::move(loaded);
  };
  auto parsed = parseHello(hello);
  if (!parsed) return refused(Refusal::kMessage, parsed.error().message);
  std::optional<TokenState> state;
  if (parsed->token) {
    const auto raw = fromBase64Url(*parsed->token);
    if (!raw) return refused(Refusal::kToken, "token: no base64url. Give it as it was received.");
    auto opened = TokenSigner(shared.settings.stateKey, shared.navMesh).open(*raw);
    if (!opened) return refused(Refusal::kToken, opened.error().message);
    state = std::move(*opened);
  }
  if (parsed->settings.method == prediction::Method::kFront) {
    parsed->settings.frontIndex = shared.frontIndex();
  }
  auto session = rdw::Session::make(shared.world, std::move(parsed->settings));
  if (!session) return refused(Refusal::kSettings, session.error().message);
  loaded.session = std::move(*session);
  if (state) {
    if (!loaded.session->resume(state->state)) {
      return refused(Refusal::kToken,
                     "token: its place is not on this navmesh. Begin without one.");
    }
    loaded.id = state->sessionId;
    loaded.resumed = true;
  } else {
    const std::string random = randomBytes(sizeof loaded.id);
    std::memcpy(&loaded.id, random.data(), sizeof loaded.id);
  }
  if (shared.recorder) {
    if (auto file = shared.recorder->open(idText(loaded.id))) {
      loaded.recording = std::move(*file);
      loaded.head = recordingHead(idText(loaded.id), shared.settings.scene, shared.navMeshText,
                                  parsed->settingsText,
                                  state ? stateBytes(*state, shared.navMesh) : std::string());
    } else {
      spdlog::error("session {} is not recorded: {}", idText(loaded.id), file.error().message);
    }
  }
  return loaded;
}

void Connection::onLoaded(Loaded loaded) {
  // The reads below go on in this phase, so that a refusal has its close answered.
  phase_ = Phase::kFrames;
  setDeadline(shared_.settings.limits.idleSeconds);
  if (loaded.refusal != Refusal::kCount) {
    refuse(loaded.refusal, loaded.message);
    return read();
  }
  session_ = std::move(loaded.session);
  id_ = loaded.id;
  recording_ = std::move(loaded.recording);
  recorded_ = std::move(loaded.head);
  if (recording_) startRecording(worker_);
  began_ = true;
  worker_.counters.sessionsBegun.add();
  if (loaded.resumed) worker_.counters.sessionsResumed.add();
  spdlog::info("session {} {} for {}", idText(id_), loaded.resumed ? "goes on" : "begins", peer_);
  if (shared_.draining) {
    refuse(Refusal::kDraining, "this daemon is about to end: go to another one.");
    return read();
  }
  out_ = welcomeText(idText(id_), shared_.navMeshText, loaded.resumed);
  send(true, &Connection::onAnswered);
}

void Connection::onFrame(std::string_view bytes, bool isText) {
  const auto frame = parseFrame(bytes, isText);
  if (!frame) {
    refuse(Refusal::kMessage, frame.error().message);
    return read();
  }
  const rdw::FrameResult& result = walk(*session_, *frame);
  const Answer answer = answerOf(frame->sequence, result);
  worker_.signer.sign({id_, session_->state()}, token_);
  out_.clear();
  if (isText) {
    const bool drawn = frame->graph && result.graph != nullptr;
    appendAnswerText(
        answer, token_,
        drawn ? prediction::toJson(session_->world().graph, *result.graph, 0.0) : std::string(),
        out_);
  } else {
    appendAnswerBytes(answer, token_, out_);
  }
  if (recording_) appendRecordedFrame(*frame, answer, recorded_);
  ++frames_;
  buffer_.clear();
  send(isText, &Connection::onAnswered);
}

void Connection::send(bool isText, void (Connection::*then)()) {
  webSocket_->text(isText);
  writing_ = true;
  setDeadline(shared_.settings.limits.sendSeconds);
  webSocket_->async_write(asio::buffer(out_),
                          [self = shared_from_this(), then](const Failure& failure, std::size_t) {
                            self->writing_ = false;
                            if (failure) return self->lost(failure);
                            (self.get()->*then)();
                          });
}

void Connection::onAnswered() {
  if (phase_ != Phase::kFrames) return;
  const Clock::time_point now = Clock::now();
  if (frames_ > 0) {
    worker_.counters.frame(static_cast<std::uint64_t>(
        std::chrono::duration_cast<std::chrono::nanoseconds>(now - frameAt_).count()));
  }
  setDeadline(shared_.settings.limits.idleSeconds);
  if (drainAfterWrite_) {
    drain();
  }
  read();
}

void Connection::drain() {
  switch (phase_) {
    case Phase::kHello:
    case Phase::kFrames:
      if (writing_) {
        drainAfterWrite_ = true;
      } else {
        refuse(Refusal::kDraining,
               "this daemon ends: go on with the last answer's token at another one.");
      }
      break;
    case Phase::kRequest:
    case Phase::kResponding:
    case Phase::kUpgrading:
    case Phase::kLoading:
    case Phase::kClosing:
      break;  // asked again when they come further, or on their way out already
  }
}

/// Says why, and closes. A read may be under way, or follow, so that the client's close is seen; no
/// write is.
void Connection::refuse(Refusal refusal, const std::string& message) {
  worker_.counters.refuse(refusal);
  ended(fmt::format("{}: {}", nameOf(refusal), message));
  refusal_ = refusal;
  phase_ = Phase::kClosing;
  buffer_.clear();
  out_ = errorText(nameOf(refusal), message);
  send(true, &Connection::close);
  setDeadline(kClosingSeconds);
}

void Connection::close() {
  const std::string_view name = nameOf(refusal_);
  webSocket_->async_close(
      websocket::close_reason(closeCodeOf(refusal_), beast::string_view(name.data(), name.size())),
      [self = shared_from_this()](const Failure&) {});
}

void Connection::lost(const Failure& failure) {
  if (phase_ == Phase::kClosing) return;
  phase_ = Phase::kClosing;
  setDeadline(kClosingSeconds);
  if (failure == websocket::error::closed) return ended("closed by the client");
  if (failure.category() == make_error_code(websocket::error::closed).category()) {
    // Not WebSocket's rules; Beast has told the client so.
    worker_.counters.refuse(Refusal::kMessage);
    return ended(fmt::format("{}: {}", nameOf(Refusal::kMessage), failure.message()));
  }
  ended(fmt::format("the connection is lost ({})", failure.message()));
  closeSocket();
}

void Connection::ended(std::string_view why) {
  if (began_) {
    spdlog::info("session {} ends after {} frames: {}", idText(id_), frames_, why);
  } else {
    spdlog::warn("{} refused: {}", peer_, why);
  }
}

void Connection::flushRecording() {
  if (!recording_ || recorded_.empty()) return;
  shared_.recorder->write(recording_, std::exchange(recorded_, {}));
}

}  // namespace forewalk::daemon
