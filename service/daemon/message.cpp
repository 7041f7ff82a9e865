#include "service/daemon/message.h"

#include <fmt/format.h>

#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <iterator>
#include <limits>
#include <nlohmann/json.hpp>
#include <span>
#include <utility>

#include "rdw/json_fields.h"
#include "rdw/json_text.h"
#include "rdw/simulation_config.h"

namespace forewalk::daemon {
namespace {

using rdw::Fields;
using rdw::Json;
using rdw::Problem;

static_assert(std::endian::native == std::endian::little,
              "binary messages are little-endian; a big-endian machine has to swap here");

constexpr std::uint8_t kKindFrame = 1, kKindAnswer = 2;
constexpr std::string_view kInstructions[] = {
    "none", "turn_around", "keep_turning", "walk_back", "step_back", "turn_left", "turn_right"};
static_assert(std::size(kInstructions) == static_cast<std::size_t>(rdw::kLastInstruction) + 1);

tl::unexpected<Error> refuse(std::string message, ErrorCode code = ErrorCode::kDataDamaged) {
  return tl::unexpected(Error{code, std::move(message)});
}

template <typename T>
void append(std::string& bytes, T value) {
  char raw[sizeof value];
  std::memcpy(raw, &value, sizeof value);
  bytes.append(raw, sizeof raw);
}

/// Takes values off the front; the caller has checked the length.
class Taker {
 public:
  explicit Taker(std::string_view bytes) : bytes_(bytes) {}
  template <typename T>
  T take() {
    T value;
    std::memcpy(&value, bytes_.data(), sizeof value);
    bytes_.remove_prefix(sizeof value);
    return value;
  }
  glm::vec3 vector() {
    const float x = take<float>(), y = take<float>(), z = take<float>();
    return {x, y, z};
  }
  glm::quat quaternion() {
    const float x = take<float>(), y = take<float>(), z = take<float>(), w = take<float>();
    return {w, x, y, z};
  }

 private:
  std::string_view bytes_;
};

/// Shortest text that reads back to the same number; what is not finite has none in JSON.
template <typename Real>
void appendNumber(std::string& out, Real value) {
  if (value == Real{0} && std::signbit(value)) {
    out += "-0.0";  // "-0" is an integer to JSON readers, and they have but one zero
  } else if (std::isfinite(value)) {
    fmt::format_to(std::back_inserter(out), "{}", value);
  } else {
    out += "null";
  }
}

void appendNumbers(std::string& out, std::initializer_list<float> values) {
  out += '[';
  for (const float value : values) {
    if (out.back() != '[') out += ',';
    appendNumber(out, value);
  }
  out += ']';
}

void appendVector(std::string& out, glm::vec3 v) { appendNumbers(out, {v.x, v.y, v.z}); }
void appendQuaternion(std::string& out, const glm::quat& q) {
  appendNumbers(out, {q.x, q.y, q.z, q.w});
}

/// A number, or null for one that was lost, which sessions know to deal with.
std::optional<double> numberOrLost(const Json& json) {
  if (json.is_null()) return std::numeric_limits<double>::quiet_NaN();
  if (!json.is_number()) return std::nullopt;
  return json.get<double>();
}

template <std::size_t Count>
void readNumbers(Fields& fields, std::string_view name, std::string_view shape,
                 std::array<float, Count>& values) {
  const Json* field = fields.find(name);
  bool sound = field != nullptr && field->is_array() && field->size() == Count;
  for (std::size_t i = 0; sound && i < Count; ++i) {
    const auto number = numberOrLost((*field)[i]);
    sound = number.has_value();
    // Beyond the range of floats a conversion is undefined; it is as good as lost.
    if (sound) {
      values[i] = std::abs(*number) <= static_cast<double>(std::numeric_limits<float>::max())
                      ? static_cast<float>(*number)
                      : std::numeric_limits<float>::quiet_NaN();
    }
  }
  if (!sound) fields.wrongKind(name, fmt::format("{} numbers {}", Count, shape));
}

void readDirection(Fields& fields, std::string_view name, std::optional<glm::vec3>& direction) {
  if (fields.find(name) == nullptr) return;
  std::array<float, 3> d{};
  readNumbers(fields, name, "[x, y, z], a direction", d);
  direction = glm::vec3(d[0], d[1], d[2]);
}

void readOthers(Fields& fields, std::vector<rdw::OtherUser>& others) {
  const Json* list = fields.find("others");
  if (list == nullptr) return;
  bool sound = list->is_array() && list->size() <= rdw::kMostOthers;
  for (std::size_t i = 0; sound && i < list->size(); ++i) {
    const Json& one = (*list)[i];
    std::array<double, 7> n{};
    sound = one.is_array() && one.size() == n.size();
    for (std::size_t k = 0; sound && k < n.size(); ++k) {
      const auto number = numberOrLost(one[k]);
      sound = number.has_value();
      if (sound) n[k] = *number;
    }
    sound = sound && n[6] > 0.0;
    if (sound) others.push_back({{n[0], -n[1]}, {n[2], -n[3]}, {n[4], -n[5]}, n[6]});
  }
  if (!sound) {
    fields.wrongKind("others", fmt::format("at most {} lists [x, z, velocity x, z, facing x, z, "
                                           "radius above 0], metres",
                                           rdw::kMostOthers));
  }
}

tl::expected<Frame, Error> parseFrameText(std::string_view text) {
  const auto json = rdw::parseJson(text, "frame");
  if (!json) return tl::unexpected(json.error());
  Problem problem("frame");
  Frame frame;
  Fields fields(*json, "", problem, "in a frame");
  fields.integer("sequence", 0, 0xffffffffu, frame.sequence);
  const Json* seconds = fields.find("seconds");
  const auto time = seconds == nullptr ? std::nullopt : numberOrLost(*seconds);
  if (time) {
    frame.seconds = *time;
  } else {
    fields.wrongKind("seconds", "the time of the pose, a number");
  }
  std::array<float, 3> p{};
  std::array<float, 4> q{};
  readNumbers(fields, "position", "[x, y, z], metres", p);
  readNumbers(fields, "orientation", "[x, y, z, w], a unit quaternion", q);
  frame.head = {{p[0], p[1], p[2]}, {q[3], q[0], q[1], q[2]}};
  fields.boolean("graph", frame.graph);
  readDirection(fields, "gaze", frame.gaze);
  readDirection(fields, "chest", frame.chest);
  readOthers(fields, frame.others);
  fields.finish();
  if (problem.error()) return tl::unexpected(*problem.error());
  return frame;
}

tl::expected<Frame, Error> parseFrameBytes(std::string_view bytes) {
  if (bytes.size() != kFrameBytes) {
    return refuse(fmt::format("frame: {} bytes; a binary frame of version {} has {}.", bytes.size(),
                              kProtocolVersion, kFrameBytes));
  }
  Taker in(bytes);
  const auto version = in.take<std::uint8_t>();
  const auto kind = in.take<std::uint8_t>();
  const auto reserved = in.take<std::uint16_t>();
  if (version != kProtocolVersion) {
    return refuse(
        fmt::format("frame: version {}; this daemon speaks {}.", version, kProtocolVersion),
        ErrorCode::kFormatUnsupported);
  }
  if (kind != kKindFrame || reserved != 0) {
    return refuse(
        fmt::format("frame: kind {} and {} in the reserved bytes; a frame has kind {} and 0.", kind,
                    reserved, kKindFrame));
  }
  Frame frame;
  frame.sequence = in.take<std::uint32_t>();
  frame.seconds = in.take<double>();
  frame.head.position = in.vector();
  frame.head.orientation = in.quaternion();
  return frame;
}

}  // namespace

tl::expected<rdw::SessionSettings, Error> parseSettings(std::string_view text) {
  auto json = rdw::parseJson(text, "session");
  if (!json) return tl::unexpected(json.error());
  Problem problem("session");
  Fields fields(*json, "", problem, "in a session");
  for (const std::string_view name :
       {"limits", "controller", "horizon_m", "predict_always", "polygon_limit", "method",
        "persistence_m", "heading", "resets", "reset", "start"}) {
    fields.find(name);
  }
  // Simulations may name a file with the space; nobody names this machine's files from afar.
  const Json* space = fields.find("space");
  if (space != nullptr && !space->is_object()) fields.wrongKind("space", "an object {...}");
  fields.finish();
  if (problem.error()) return tl::unexpected(*problem.error());

  // The rest is a simulation's, with its ranges and its words.
  if (!json->contains("predict_always")) (*json)["predict_always"] = false;
  (*json)["format"] = "forewalk.simulation/1";
  (*json)["user"] = {{"kind", "wander"}};
  const std::string simulation = json->dump(-1, ' ', true, Json::error_handler_t::replace);
  auto parsed = rdw::parseSimulation(std::as_bytes(std::span(simulation)), "session");
  if (!parsed) return tl::unexpected(std::move(parsed.error()));
  rdw::SessionSettings settings = std::move(parsed->simulation.session);
  const rdw::WalkStart& start = parsed->simulation.start;
  if (start.floor) {
    settings.start =
        rdw::VirtualStart{*start.floor, static_cast<float>(start.heading.value_or(0.0))};
  }
  return settings;
}

std::string settingsText(const rdw::SessionSettings& settings) {
  const auto pairs = [](std::span<const glm::dvec2> ring) {
    Json list = Json::array();
    for (const glm::dvec2 corner : ring) list.push_back({corner.x, -corner.y});
    return list;
  };
  Json holes = Json::array();
  for (std::size_t i = 1; i < settings.space.ringCount(); ++i) {
    holes.push_back(pairs(settings.space.ring(i)));
  }
  // Floats as the shortest text that reads back to the same float, not as the doubles they become.
  const auto number = [](float value) { return Json::parse(fmt::format("{}", value)); };
  const rdw::GainLimits& limits = settings.limits;
  const Json json = {
      {"space", {{"polygon", pairs(settings.space.ring(0))}, {"holes", holes}}},
      {"limits",
       {{"translation_min", number(limits.translationMin)},
        {"translation_max", number(limits.translationMax)},
        {"rotation_min", number(limits.rotationMin)},
        {"rotation_max", number(limits.rotationMax)},
        {"curvature_max_per_m", number(limits.curvatureMax)},
        {"bending_min", number(limits.bendingMin)},
        {"bending_max", number(limits.bendingMax)}}},
      {"controller", settings.controller},
      {"horizon_m", number(settings.horizon)},
      {"predict_always", settings.alwaysPredict},
      {"polygon_limit", settings.prediction.polygons},
      {"method", settings.method == prediction::Method::kFront ? "front" : "polygon"},
      {"persistence_m", number(settings.front.persistence)},
      {"heading", settings.heading == rdw::HeadingSource::kHead    ? "head"
                  : settings.heading == rdw::HeadingSource::kChest ? "chest"
                                                                   : "walking"},
      {"resets", settings.resets},
      {"reset",
       {{"policy", settings.resetPolicy},
        {"reaction_s", settings.reset.reactionTime},
        {"deceleration_m_per_s2", settings.reset.deceleration},
        {"clearance_m", settings.reset.clearance},
        {"warning_s", settings.reset.warningTime},
        {"trigger", settings.reset.trigger == rdw::ResetTrigger::kBorder ? "border" : "ahead"}}}};
  return json.dump(-1, ' ', true, Json::error_handler_t::replace);
}

tl::expected<Hello, Error> parseHello(std::string_view text) {
  const auto json = rdw::parseJson(text, "hello");
  if (!json) return tl::unexpected(json.error());
  Problem problem("hello");
  Hello hello;
  Fields fields(*json, "", problem, "in a hello");
  rdw::requireFormat(fields, "forewalk.hello/1");
  const Json* session = fields.find("session");
  std::string token;
  fields.text("token", token);
  fields.finish();
  if (problem.error()) return tl::unexpected(*problem.error());
  if (json->contains("token")) hello.token = std::move(token);
  hello.settingsText =
      session == nullptr ? "{}" : session->dump(-1, ' ', true, Json::error_handler_t::replace);
  auto settings = parseSettings(hello.settingsText);
  if (!settings) return tl::unexpected(std::move(settings.error()));
  hello.settings = std::move(*settings);
  return hello;
}

std::string welcomeText(std::string_view sessionId, std::string_view navMeshHash, bool resumed) {
  return fmt::format(
      R"({{"format":"forewalk.welcome/1","session":"{}","navmesh":"{}","resumed":{}}})", sessionId,
      navMeshHash, resumed);
}

std::string errorText(std::string_view code, std::string_view message) {
  const Json json = {{"format", "forewalk.error/1"}, {"code", code}, {"message", message}};
  return json.dump(-1, ' ', true, Json::error_handler_t::replace);
}

tl::expected<Frame, Error> parseFrame(std::string_view bytes, bool isText) {
  return isText ? parseFrameText(bytes) : parseFrameBytes(bytes);
}

std::string frameBytes(const Frame& frame) {
  std::string out;
  append(out, kProtocolVersion);
  append(out, kKindFrame);
  append(out, std::uint16_t{0});
  append(out, frame.sequence);
  append(out, frame.seconds);
  const glm::vec3& p = frame.head.position;
  const glm::quat& q = frame.head.orientation;
  for (const float value : {p.x, p.y, p.z, q.x, q.y, q.z, q.w}) append(out, value);
  return out;
}

std::string frameText(const Frame& frame) {
  std::string out = fmt::format(R"({{"sequence":{},"seconds":)", frame.sequence);
  appendNumber(out, frame.seconds);
  out += ",\"position\":";
  appendVector(out, frame.head.position);
  out += ",\"orientation\":";
  appendQuaternion(out, frame.head.orientation);
  if (frame.graph) out += ",\"graph\":true";
  if (frame.gaze) {
    out += ",\"gaze\":";
    appendVector(out, *frame.gaze);
  }
  if (frame.chest) {
    out += ",\"chest\":";
    appendVector(out, *frame.chest);
  }
  if (!frame.others.empty()) {
    out += ",\"others\":[";
    for (const rdw::OtherUser& other : frame.others) {
      if (out.back() != '[') out += ',';
      out += '[';
      for (const double value :
           {other.position.x, -other.position.y, other.velocity.x, -other.velocity.y,
            other.facing.x, -other.facing.y, other.radius}) {
        if (out.back() != '[') out += ',';
        appendNumber(out, value);
      }
      out += ']';
    }
    out += ']';
  }
  out += '}';
  return out;
}

const rdw::FrameResult& walk(rdw::Session& session, const Frame& frame) {
  constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
  session.setGaze(frame.gaze ? rdw::headingOf(*frame.gaze) : kUnknown);
  session.setChest(frame.chest ? rdw::headingOf(*frame.chest) : kUnknown);
  session.setOthers(frame.others);
  return session.frame(frame.head, frame.seconds);
}

Answer answerOf(std::uint32_t sequence, const rdw::FrameResult& result) {
  Answer answer;
  answer.sequence = sequence;
  answer.flags = result.flags;
  answer.position = result.virtualPose.position;
  answer.orientation = result.virtualPose.orientation;
  answer.gains = result.gains;
  answer.injectedYaw = static_cast<float>(result.injectedYaw);
  const glm::vec3 push = navmesh::toSpace(glm::vec2(result.injectedTranslation), 0.0f);
  answer.injectedTranslation = {push.x, push.z};
  answer.resetting = result.reset.turning;
  answer.instruction = result.reset.instruction;
  answer.resetRemaining = static_cast<float>(result.reset.remaining);
  answer.resetTurned = static_cast<float>(result.reset.progress);
  answer.resetCount = static_cast<std::uint32_t>(result.resetCount);
  answer.graphNodes =
      result.graph == nullptr ? 0 : static_cast<std::uint32_t>(result.graph->nodes.size());
  return answer;
}

void appendAnswerBytes(const Answer& answer, std::string_view token, std::string& out) {
  append(out, kProtocolVersion);
  append(out, kKindAnswer);
  append(out, static_cast<std::uint16_t>(token.size()));
  append(out, answer.sequence);
  append(out, answer.flags);
  const glm::vec3& p = answer.position;
  const glm::quat& q = answer.orientation;
  const rdw::Gains& g = answer.gains;
  for (const float value :
       {p.x, p.y, p.z, q.x, q.y, q.z, q.w, g.translation, g.rotation, g.curvature, g.bending,
        answer.injectedYaw, answer.injectedTranslation.x, answer.injectedTranslation.y}) {
    append(out, value);
  }
  append(out, static_cast<std::uint8_t>(answer.resetting));
  append(out, static_cast<std::uint8_t>(answer.instruction));
  append(out, std::uint16_t{0});
  append(out, answer.resetRemaining);
  append(out, answer.resetTurned);
  append(out, answer.resetCount);
  append(out, answer.graphNodes);
  out += token;
}

tl::expected<ReadAnswer, Error> parseAnswerBytes(std::string_view bytes) {
  if (bytes.size() < kAnswerBytes) {
    return refuse(fmt::format("answer: {} bytes; one of version {} has at least {}.", bytes.size(),
                              kProtocolVersion, kAnswerBytes));
  }
  Taker in(bytes);
  const auto version = in.take<std::uint8_t>();
  const auto kind = in.take<std::uint8_t>();
  const auto tokenBytes = in.take<std::uint16_t>();
  if (version != kProtocolVersion || kind != kKindAnswer ||
      bytes.size() != kAnswerBytes + tokenBytes) {
    return refuse(
        fmt::format("answer: version {}, kind {}, {} bytes with a token of {}; expected {}, {}.",
                    version, kind, bytes.size(), tokenBytes, kProtocolVersion, kKindAnswer));
  }
  ReadAnswer read;
  Answer& answer = read.answer;
  answer.sequence = in.take<std::uint32_t>();
  answer.flags = in.take<std::uint32_t>();
  answer.position = in.vector();
  answer.orientation = in.quaternion();
  answer.gains.translation = in.take<float>();
  answer.gains.rotation = in.take<float>();
  answer.gains.curvature = in.take<float>();
  answer.gains.bending = in.take<float>();
  answer.injectedYaw = in.take<float>();
  answer.injectedTranslation.x = in.take<float>();
  answer.injectedTranslation.y = in.take<float>();
  answer.resetting = in.take<std::uint8_t>() != 0;
  const auto instruction = in.take<std::uint8_t>();
  if (instruction >= std::size(kInstructions)) {
    return refuse(fmt::format("answer: instruction {} is not known.", instruction));
  }
  answer.instruction = static_cast<rdw::ResetInstruction>(instruction);
  in.take<std::uint16_t>();
  answer.resetRemaining = in.take<float>();
  answer.resetTurned = in.take<float>();
  answer.resetCount = in.take<std::uint32_t>();
  answer.graphNodes = in.take<std::uint32_t>();
  read.token = bytes.substr(kAnswerBytes);
  return read;
}

void appendAnswerText(const Answer& answer, std::string_view token, std::string_view graph,
                      std::string& out) {
  const auto at = std::back_inserter(out);
  fmt::format_to(at, R"({{"sequence":{},"flags":{},"position":)", answer.sequence, answer.flags);
  appendVector(out, answer.position);
  out += ",\"orientation\":";
  appendQuaternion(out, answer.orientation);
  fmt::format_to(at, R"(,"gains":{{"translation":{},"rotation":{},"curvature":{},"bending":{}}})",
                 answer.gains.translation, answer.gains.rotation, answer.gains.curvature,
                 answer.gains.bending);
  out += ",\"injected_yaw\":";
  appendNumber(out, answer.injectedYaw);
  out += ",\"injected_translation\":";
  appendNumbers(out, {answer.injectedTranslation.x, 0.0f, answer.injectedTranslation.y});
  fmt::format_to(
      at, R"(,"reset":{{"turning":{},"instruction":"{}","remaining":{},"turned":{},"count":{}}})",
      answer.resetting, kInstructions[static_cast<std::size_t>(answer.instruction)],
      answer.resetRemaining, answer.resetTurned, answer.resetCount);
  fmt::format_to(at, R"(,"graph_nodes":{})", answer.graphNodes);
  if (!graph.empty()) {
    out += ",\"graph\":";
    out += graph;
  }
  if (!token.empty()) {
    out += ",\"token\":\"";
    out += toBase64Url(token);
    out += '"';
  }
  out += '}';
}

namespace {
constexpr std::string_view kLetters =
    "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-_";
}

std::string toBase64Url(std::string_view bytes) {
  std::string text;
  text.reserve((bytes.size() * 4 + 2) / 3);
  std::uint32_t bits = 0;
  int held = 0;
  for (const char byte : bytes) {
    bits = bits << 8 | static_cast<unsigned char>(byte);
    for (held += 8; held >= 6; held -= 6) text += kLetters[bits >> (held - 6) & 63u];
  }
  if (held > 0) text += kLetters[bits << (6 - held) & 63u];
  return text;
}

std::optional<std::string> fromBase64Url(std::string_view text) {
  std::string bytes;
  std::uint32_t bits = 0;
  int held = 0;
  for (const char letter : text) {
    const std::size_t value = kLetters.find(letter);
    if (value == std::string_view::npos) return std::nullopt;
    bits = bits << 6 | static_cast<std::uint32_t>(value);
    held += 6;
    if (held >= 8) {
      held -= 8;
      bytes += static_cast<char>(bits >> held & 255u);
    }
  }
  // One text per sequence of bytes: no letter too many, no bits left over.
  if (held >= 6 || (bits & ((1u << held) - 1u)) != 0) return std::nullopt;
  return bytes;
}

}  // namespace forewalk::daemon
