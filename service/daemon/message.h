// The daemon's messages, version 1: what goes over the WebSocket, to values and back.
//
// The schema for people is PROTOCOL.md beside this file. No socket, no clock, no session in here:
// bytes in, values or a refusal out. A frame's answer has the form of its question, binary or JSON.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <tl/expected.hpp>
#include <vector>

#include "navmesh/error.h"
#include "rdw/session.h"

namespace forewalk::daemon {

inline constexpr std::uint8_t kProtocolVersion = 1;
inline constexpr std::string_view kSubprotocol = "forewalk.1";
inline constexpr std::size_t kFrameBytes = 44;   ///< of a binary frame
inline constexpr std::size_t kAnswerBytes = 88;  ///< of a binary answer, before its token

/// What a client says first.
struct Hello {
  rdw::SessionSettings settings;
  std::string settingsText;          ///< the JSON object that `settings` came from
  std::optional<std::string> token;  ///< of the session to go on with, as text
};

/// Reads `forewalk.hello/1`. Fails as rdw::parseSimulation does, whose keys its "session" shares.
[[nodiscard]] tl::expected<Hello, Error> parseHello(std::string_view text);

/// The "session" object of a hello, or of a recording, as settings. Fails as parseHello.
[[nodiscard]] tl::expected<rdw::SessionSettings, Error> parseSettings(std::string_view text);

/// The other way round: parseSettings gives settings that make the same frames from a state on. Not
/// among them: `start`, and what a hello cannot say.
std::string settingsText(const rdw::SessionSettings& settings);

/// The answer to a hello.
std::string welcomeText(std::string_view sessionId, std::string_view navMeshHash, bool resumed);

/// Why a client is let go, as `forewalk.error/1`. Any bytes in, valid JSON out.
std::string errorText(std::string_view code, std::string_view message);

/// One frame's question. Numbers need not be finite: the session says what is odd.
struct Frame {
  std::uint32_t sequence = 0;  ///< the client's; comes back with the answer
  double seconds = 0.0;
  rdw::HeadPose head;
  // In JSON only:
  bool graph = false;                    ///< add the prediction graph to the answer
  std::optional<glm::vec3> gaze, chest;  ///< directions in the tracked space, of any length
  std::vector<rdw::OtherUser> others;    ///< who else is in the room, kMostOthers at most
};

/// Hands `frame` to the session that it is of.
const rdw::FrameResult& walk(rdw::Session& session, const Frame& frame);

/// Fails (kDataDamaged, kFormatUnsupported) with what is wrong, and with how many bytes were
/// expected. A binary frame costs nothing to read, one in JSON some microseconds.
[[nodiscard]] tl::expected<Frame, Error> parseFrame(std::string_view bytes, bool isText);

std::string frameBytes(const Frame& frame);
std::string frameText(const Frame& frame);

/// One frame's answer: floats as they go over the wire, so that both forms and recordings hold the
/// same to the last bit.
struct Answer {
  std::uint32_t sequence = 0;
  std::uint32_t flags = 0;  ///< rdw::FrameFlags
  glm::vec3 position{0.0f};
  glm::quat orientation{1.0f, 0.0f, 0.0f, 0.0f};
  rdw::Gains gains;
  float injectedYaw = 0.0f;
  glm::vec2 injectedTranslation{0.0f};  ///< world x, z
  bool resetting = false;
  rdw::ResetInstruction instruction = rdw::ResetInstruction::kNone;
  float resetRemaining = 0.0f;
  float resetTurned = 0.0f;
  std::uint32_t resetCount = 0;
  std::uint32_t graphNodes = 0;

  bool operator==(const Answer&) const = default;
};

Answer answerOf(std::uint32_t sequence, const rdw::FrameResult& result);

/// Appends to `out`, which keeps its memory from frame to frame. `token` is raw bytes; `graph` a
/// JSON value, empty for none.
void appendAnswerBytes(const Answer& answer, std::string_view token, std::string& out);
void appendAnswerText(const Answer& answer, std::string_view token, std::string_view graph,
                      std::string& out);

/// An answer as a client reads it. `token` views into `bytes`.
struct ReadAnswer {
  Answer answer;
  std::string_view token;
};
[[nodiscard]] tl::expected<ReadAnswer, Error> parseAnswerBytes(std::string_view bytes);

/// base64url without padding (RFC 4648 section 5), for tokens in text.
std::string toBase64Url(std::string_view bytes);
std::optional<std::string> fromBase64Url(std::string_view text);

}  // namespace forewalk::daemon
